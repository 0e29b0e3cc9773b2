"""Joints of a train whose friction grows with the time at rest: hubs of all shafts, and the pin of the drive."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from tests.mesh.test_slow_train import MICROENGINE, idle
from tests.reference.trains import HUBS, chain, split

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.train import end_of_train, solve_train
from gearidae.records import EventKind
from gearidae.runs.train_statics import starting_torque
from gearidae.scene import Scene
from gearidae.scene.joints import joints

SPEED, FORCE = 1e-7, 1e-5
AGEING = {"hub_friction_rise": 0.3, "hub_ageing_time": 2e-6, "hub_memory_length": 5e-8}
"""Of hubs that slide by some 12 mm/s: their contacts live for 4 us, and have most of the rise."""
PIN = {"drive.pin_friction": 0.2, "drive.pin_friction_rise": 0.4, "drive.pin_ageing_time": 5e-6}
PIN |= {"drive.pin_memory_length": 3e-8}
REST = 2e-5
"""Ten ageing times [s]."""
BACKENDS = ("native", "sksundae")


def ageing(tables, friction=0.2, **ages):
    """Tables of a train with hubs on all shafts, whose friction ages."""
    for shaft, radius in zip(tables["shafts"].values(), (*HUBS, HUBS[-1]), strict=False):
        shaft |= {"hub_friction": friction, "hub_radius": radius, **AGEING, **ages}
    return tables


def of_engine(tables):
    """A microengine drives, whose pin ages too."""
    scene = Scene.from_dict(ageing({**tables, "drive": MICROENGINE}, 0.1, hub_friction_rise=0.2))
    return scene.replace(PIN)


def as_pair(scene):
    """The first mesh of a train with its hubs and torques, as a pair."""
    tables = scene.to_dict()
    load = {key: value for key, value in tables["load"].items() if key != "shaft"}
    keys = dict.fromkeys(("hub_friction", *AGEING))
    gears = {f"gears.{key}": getattr(scene.shafts["input"], key) for key in keys}
    gears |= {
        f"gears.{side}_hub_radius": radius for side, radius in zip(("pinion", "gear"), HUBS, strict=False)
    }
    return scene.pair("first").replace({"drive": tables["drive"], "load": load, **gears})


SCENES = {
    "couple": lambda: Scene.from_dict(ageing(idle())),
    "pin": lambda: of_engine(idle()),
    "after a rest": lambda: Scene.from_dict(ageing(idle())).replace({"initial.rest_time": REST}),
}


@cache
def solutions(name):
    """A train whose second mesh never touches, and its first mesh as a pair."""
    scene = SCENES[name]().replace({"run.rtol": 1e-9})
    train = solve_train(scene, t_end=25e-6, samples=6)
    return train, solve(as_pair(scene), t_end=25e-6, samples=6)


def assert_closes(solution):
    energy = solution.energy
    assert solution.status == "finished"
    assert abs(energy["residual"]) < energy["residual_bound"] < 1e-4 * energy["throughput"]


@pytest.mark.parametrize("name", SCENES)
def test_joints_age_as_those_of_the_pair(name):
    """Another formula, other steps, other ways of the surfaces: the law of the age is the same."""
    train, pair = solutions(name)
    for i, side in enumerate(("pinion", "gear")):
        np.testing.assert_allclose(train.samples["shaft_speed"][i], pair.samples[f"{side}_speed"], rtol=SPEED)
        coefficient = train.samples["hub_friction"][i]
        np.testing.assert_allclose(coefficient, pair.samples[f"{side}_hub_friction"], rtol=FORCE)
        assert np.ptp(coefficient) > 1e-3
        for of_train, of_pair in (("hub_loss", "hub_loss"), ("hub_sliding", "hub_sliding")):
            expected = pair.balance[f"{side}_{of_pair}"]
            assert train.shaft_totals[of_train][i] == pytest.approx(expected, rel=1e-6, abs=0.0)
    np.testing.assert_array_equal(train.samples["mesh_force"][1], 0.0)
    if name == "pin":
        np.testing.assert_allclose(train.samples["pin_friction"], pair.samples["pin_friction"], rtol=FORCE)
        assert train.energy["pin_loss"] == pytest.approx(pair.balance["pin_loss"], rel=1e-6, abs=0.0)
    assert_closes(train)


def test_a_rest_before_the_start_lets_joints_begin_old():
    fresh, rested = (solutions(name)[0].samples["hub_friction"] for name in ("couple", "after a rest"))
    np.testing.assert_array_equal(fresh[:, 0], 0.2)
    np.testing.assert_allclose(rested[:, 0], 0.5 - 0.3 * math.exp(-10.0), rtol=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_balance_of_a_chain_and_of_a_loop_closes(backend):
    """Also with the friction of flanks, whose pairs and hubs act on each other."""
    flanks = ageing(chain(contact={"bodies": "rigid", "asperity": "hertz", "friction": 0.3}))
    for scene in (
        Scene.from_dict(ageing(chain())),
        of_engine(chain()),
        Scene.from_dict(ageing(split())),
        Scene.from_dict(flanks),
    ):
        end = 60e-6 if backend == "native" else 2e-6
        solution = solve_train(scene.replace({"run.rtol": 1e-8}), t_end=end, samples=2, backend=backend)
        assert_closes(solution)
        assert (solution.samples["hub_friction"][:, -1] > 0.2 - 0.1 * bool(scene.drive.law)).all()


@pytest.mark.parametrize("scene", [lambda: Scene.from_dict(ageing(chain())), lambda: of_engine(chain())])
def test_drivers_agree(scene):
    native, portable = (
        solve_train(scene().replace({"run.rtol": 1e-8}), t_end=4e-6, samples=5, backend=b) for b in BACKENDS
    )
    for name in ("shaft_speed", "hub_friction", "pin_friction"):
        np.testing.assert_allclose(portable.samples[name], native.samples[name], rtol=2e-7, err_msg=name)


def test_the_coefficient_converges_with_the_tolerance():
    """What a cubic of the way leaves in a step is below the errors of the motion."""
    scene = Scene.from_dict(ageing(chain()))
    coarse, fine = (solve_train(scene, rtol=rtol, t_end=50e-6, samples=6) for rtol in (1e-6, 1e-10))
    for name in ("shaft_speed", "hub_friction"):
        np.testing.assert_allclose(coarse.samples[name], fine.samples[name], rtol=2e-5, err_msg=name)


def test_steady_sliding_has_its_closed_form():
    """Ages are D/v at a constant speed; the contacts' small vibrations change the mean by less."""
    held = chain(drive={"speed": 3760.0, "speed_gain": 1e-13}, initial={"gear_speed": 940.0, "gap": 1.95e-8})
    scene = Scene.from_dict(ageing(held))
    samples = solve_train(scene, t_end=100e-6, samples=201).samples
    speeds, coefficients = (samples[name][:, 100:].mean(axis=1) for name in ("shaft_speed", "hub_friction"))
    for joint, speed, coefficient in zip(joints(scene), speeds, coefficients, strict=True):
        assert coefficient == pytest.approx(joint.aged(joint.sliding_age(speed)), rel=1e-3)


# -- rest ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rest", [0.0, 1e-3, 1.0])
def test_the_static_torque_is_that_of_the_aged_coefficients(rest):
    tables = chain("40 deg", hubs=0.2, load={"torque": 3e-11})
    scene = Scene.from_dict(ageing(tables, hub_friction_rise=0.1, hub_ageing_time=1e-3))
    aged = 0.2 - 0.1 * np.expm1(-rest / 1e-3)
    expected = starting_torque(Scene.from_dict(chain("40 deg", hubs=float(aged), load={"torque": 3e-11})))[0]
    torque = starting_torque(scene.replace({"initial.rest_time": rest}))[0]
    assert torque == pytest.approx(expected, rel=1e-12, abs=0.0)
    if rest == 1.0:
        assert torque == pytest.approx(8.0046985e-12, rel=1e-7, abs=0.0)


def test_a_study_takes_times_at_rest():
    tables = chain("40 deg", hubs=0.2, load={"torque": 3e-11})
    scene = Scene.from_dict(ageing(tables, hub_friction_rise=0.1, hub_ageing_time=1e-3))
    ds = gd.studies.starting_torque(scene, rest_time=["0 s", "1 ms", "1 s"], simulated=False)
    assert ds.static_torque.dims == ("rest_time",)
    torques = ds.static_torque.values
    assert (np.diff(torques) > 0.0).all()
    assert torques[-1] == pytest.approx(8.0046985e-12, rel=1e-7, abs=0.0)
    np.testing.assert_allclose(ds.parts.sum("part"), torques, rtol=1e-12)


RAMP = {"drive.torque": 0.0, "drive.schedule": [[0.0, 7e-12], [2e-3, 9e-12]]}
"""Slow beside the vibrations of the teeth, which damping of the meshes takes."""


@pytest.mark.parametrize("rest", [0.0, 1.0])
def test_a_ramp_breaks_away_at_the_torque_of_the_coefficients_of_the_instant(rest):
    """The train creeps as its teeth are pressed, by less than a memory length; its hubs age while it waits."""
    tables = chain("40 deg", hubs=0.2, load={"torque": 3e-11}, initial={"gear_speed": 0.0, "gap": 1.9e-8})
    scene = Scene.from_dict(ageing(tables, hub_friction_rise=0.1, hub_ageing_time=1e-3))
    scene = scene.replace({**RAMP, "mesh.damping": 3e-5, "run.samples": 4001, "run.duration": 2e-3})
    solution = solve_train(scene.replace({"initial.rest_time": rest}))
    assert_closes(solution)
    events, last = solution.events, scene.train.load
    slips = events["time"][(events["kind"] == EventKind.SLIP) & (events["shaft"] == last)]
    free = slips[-1]
    before = solution.time.searchsorted(free) - 1
    torque = np.interp(free, (0.0, 2e-3), (7e-12, 9e-12))
    coefficients = solution.samples["hub_friction"][:, before]
    of_instant = {
        f"shafts.{name}.hub_friction": float(mu) for name, mu in zip(scene.shafts, coefficients, strict=True)
    }
    none = {f"shafts.{name}.hub_friction_rise": 0.0 for name in scene.shafts}
    assert torque == pytest.approx(starting_torque(scene.replace(of_instant | none))[0], rel=2e-3, abs=0.0)
    if rest > 0.0:
        np.testing.assert_allclose(coefficients[last], 0.3, rtol=1e-2)


# -- runs that go on -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
def test_ages_go_on(backend):
    """Resumed from any block to the last bit, and continued within the tolerance, drive with another torque too."""
    end = 40e-6 if backend == "native" else 4e-6
    blocks = []
    scene = of_engine(chain()).replace({"run.rtol": 1e-9, "run.duration": end, "run.samples": 21})
    whole = solve_train(scene, backend=backend, on_block=blocks.append)
    again = solve_train(scene, backend=backend, blocks=blocks[:1])
    for name, values in whole.samples.items():
        np.testing.assert_array_equal(again.samples[name], values)
    half = scene.replace({"run.duration": 0.5 * end, "run.samples": 11})
    first = solve_train(half, backend=backend)
    start = end_of_train(half, first.checkpoint, 0.0)
    second = solve_train(half.replace({"initial.rest_time": 1.0}), backend=backend, start=start)
    for name in ("shaft_speed", "hub_friction", "pin_friction"):
        joined = np.concatenate([first.samples[name], second.samples[name][..., 1:]], axis=-1)
        np.testing.assert_allclose(joined, whole.samples[name], rtol=1e-6, err_msg=name)


# -- what a run leaves -----------------------------------------------------------------------------------------------


def test_coefficients_are_in_a_dataset_where_they_change():
    scene = of_engine(chain()).replace({"run.duration": 2e-6, "run.samples": 5})
    ds = gd.simulate(scene)
    assert ds.hub_friction.dims == ("shaft", "time")
    np.testing.assert_array_equal(ds.gear_hub_friction, ds.hub_friction.sel(shaft="output"))
    np.testing.assert_array_equal(ds.pinion_hub_friction, ds.hub_friction.sel(shaft="input"))
    assert float(ds.pin_friction[0]) == 0.2
    still = gd.simulate(Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": 2e-6, "run.samples": 5}))
    assert not {"hub_friction", "pin_friction", "gear_hub_friction"} & {*still.variables}
