"""The law of hubs and pin by its formula, in units of the engine, and what follows from their declarations."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.engine.setup.build import make_problem
from gearidae.laws.frictions import FRICTION_LAWS
from gearidae.laws.joint_law import aged_friction, fresh_friction, friction_rate, rise_at
from gearidae.laws.joints import JOINT_LAWS, JOINTS, PIN, SHAFT_OF_JOINT
from gearidae.laws.law import DRIVE, LOAD
from gearidae.records import JOINT_FRICTION, JOINT_LOADS
from gearidae.records.energy import LOSSES, SLIDING
from gearidae.scene.joints import joints

CASE = gd.load_case(Path(__file__).parents[2] / "cases" / "microengine.toml").replace(
    {
        "gears.hub_friction": 0.2,
        "gears.hub_friction_rise": 0.5,
        "gears.pinion_hub_adhesion": 1e-6,
        "gears.gear_hub_adhesion": 2e-6,
        "gears.pinion_axial_load": 3e-6,
        "gears.pinion_dimple_radius": 1e-5,
        "gears.gear_axial_load": 4e-6,
        "gears.gear_dimple_radius": 2e-5,
        "drive.pin_friction": 0.1,
        "drive.pin_friction_rise": 0.3,
        "drive.pin_ageing_time": 2e-4,
    }
)
RADII = CASE.geometry.base_radius_pinion, CASE.geometry.base_radius_gear


@pytest.fixture(scope="module")
def model():
    return make_problem(CASE).model


@given(age=st.floats(0.0, 1e-2), load=st.floats(0.0, 1e-4), number=st.sampled_from(range(len(JOINTS))))
def test_friction_is_the_torque_of_the_scene_over_the_base_radius(model, age, load, number):
    """mu(theta) (r (N + A) + r_d P), of a joint whose contacts have an age."""
    joint = joints(CASE)[number]
    rise = rise_at(model.scene.friction.joint[number], age / float(model.scene.time_unit))
    friction, unit = aged_friction(model, number, rise), float(model.scene.force_unit)
    torque = (friction.by_load * load + friction.constant * unit) * RADII[SHAFT_OF_JOINT[number]]
    assert joint.name == JOINTS[number].name
    # some differences of numbers of one size
    assert torque == pytest.approx(joint.of_age(age).torque(load), rel=1e-13, abs=0)
    assert fresh_friction(model, number) == aged_friction(model, number, 0.0)


@pytest.mark.parametrize("number", range(len(JOINTS)))
def test_the_rate_of_friction_is_its_slope_along_the_motion(model, number):
    """Central differences of the age, whose rate is 1 - |v| theta/D; an error of 1e-8 is left."""
    constants, age, speed = model.scene.friction.joint[number], 0.7, 0.3
    age /= float(constants.ageing_rate)
    speed /= age * float(constants.forgetting)
    h = 1e-4 * age
    step = h * (1.0 - speed * float(constants.forgetting) * age)
    before, after = (aged_friction(model, number, rise_at(constants, age + way)) for way in (-step, step))
    slopes = [(last - first) / (2.0 * h) for first, last in zip(before, after, strict=True)]
    assert [*friction_rate(model, number, age, speed)] == pytest.approx(slopes, rel=1e-7, abs=0)


def test_a_hub_has_the_number_of_its_shaft_and_the_pin_comes_last():
    assert [joint.name for joint in JOINTS] == ["pinion hub", "gear hub", "pin"]
    assert (JOINTS[DRIVE].shaft, JOINTS[LOAD].shaft, JOINTS[PIN].shaft) == (DRIVE, LOAD, DRIVE)
    assert len(JOINTS) == PIN + 1


def test_samples_losses_and_sums_follow_from_the_declarations():
    assert [column.name for column in JOINT_LOADS] == ["pinion_hub_load", "gear_hub_load", "pin_load"]
    assert [column.name for column in JOINT_FRICTION] == [
        "pinion_hub_friction",
        "gear_hub_friction",
        "pin_friction",
    ]
    assert [name for name in LOSSES if LOSSES[name].name == "joint_loss"] == [
        "pinion_hub_loss",
        "gear_hub_loss",
        "pin_loss",
    ]
    assert SLIDING == ("pinion_hub_sliding", "gear_hub_sliding", "pin_sliding")


def test_no_two_laws_say_that_they_hold_by_one_number():
    numbers = [
        holder.number for laws in (FRICTION_LAWS, JOINT_LAWS) for law in laws for holder in law.holders
    ]
    assert len(set(numbers)) == len(numbers)
