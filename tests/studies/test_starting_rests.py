"""Starting torque against the time at rest, of hubs whose friction ages."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.mesh.friction import hub_starting_torque
from gearidae.scene import dump_case
from gearidae.studies.declared.starting_torque import (
    GEAR_RESTS,
    RESTS,
    picture_of_gears,
    picture_of_rests,
)
from gearidae.studies.products import answer, kind_of

AGEING = gd.preset("teodorescu2009").replace(
    {
        "drive.harmonic": None,
        "gears.hub_friction": 0.2,
        "gears.hub_friction_rise": 0.7,
        "gears.hub_ageing_time": "1 ms",
        "gears.hub_memory_length": "50 nm",
        "gears.pinion_hub_radius": "10 um",
        "gears.gear_hub_radius": "20 um",
        "gears.pinion_hub_adhesion": "1 uN",
        "contact.bodies": "rigid",
    }
)
TIMES = [0.0, 1e-3, 1.0]
OPTIONS = {"impacts": 1, "tolerance": 0.05}


@pytest.fixture(scope="module")
def rests():
    return gd.studies.starting_torque(AGEING, rest_time=["0 s", "1 ms", "1 s"], **OPTIONS)


def expected(time):
    mu = 0.2 - 0.7 * math.expm1(-time / 1e-3)
    return hub_starting_torque(AGEING.geometry, 3e-11, mu, (10e-6, 20e-6), (mu * 10e-6 * 1e-6, 0.0))


def test_static_torques_are_those_of_the_coefficients_after_the_rest(rests):
    """Adhesion of the teeth comes on top, over a ratio of torques that grows with the coefficient."""
    np.testing.assert_array_equal(rests.rest_time, TIMES)
    resting = [expected(time) for time in TIMES]
    teeth = rests.parts.sel(part="adhesion of teeth").values
    assert (teeth >= 0.0).all()
    hubs = rests.parts.sel(part=["dry resistance", "adhesion of teeth", "hubs"]).sum("part")
    np.testing.assert_allclose(rests.static_torque, hubs, rtol=1e-12)
    np.testing.assert_allclose(rests.static_torque, resting, rtol=0.1)
    assert (rests.static_torque.values >= np.array(resting) * (1.0 - 1e-12)).all()


def test_simulated_torques_grow_with_the_rest(rests):
    """What friction of the hubs holds at rest decides; the bracket is 5 % wide."""
    assert (np.diff(rests.simulated_torque) > 1e-12).all()
    np.testing.assert_allclose(rests.simulated_torque, rests.static_torque, rtol=0.12)
    assert (rests.message == "").all()


def test_its_file_says_what_it_is_and_is_drawn(rests, tmp_path):
    assert kind_of(rests) == "starting_rests"
    said = answer(rests, "starting_rests")
    assert said.sentence.startswith("The gear starts at ")
    assert "after no time at rest and at " in said.sentence
    assert any(row[0] == "after 1 ms at rest" for row in said.rows)
    ax = picture_of_rests(rests)
    assert ax.get_xscale() == "log"
    drawn = ax.get_lines()[0]
    np.testing.assert_allclose(drawn.get_xdata(), [1e-4, 1e-3, 1.0])
    np.testing.assert_allclose(drawn.get_ydata(), rests.static_torque)
    rests.to_netcdf(tmp_path / "rests.nc")
    assert RESTS.open(tmp_path / "rests.nc").sizes == rests.sizes


@pytest.mark.parametrize(
    ("changes", "more", "key"),
    [
        ({"gears.hub_friction_rise": 0.0}, {}, "rest_time"),
        ({}, {"sam_fraction": [1.0, 0.5]}, "sam_fraction"),
        ({"gears.hub_friction_rise": 0.0, "contact.roughness": "discrete"}, {}, "rest_time"),
        ({"contact.roughness": "discrete"}, {"sam_fraction": [1.0, 0.5]}, "sam_fraction"),
        ({}, {"rest_time": -1.0}, "initial.rest_time"),
        ({}, {"rest_time": "2 kg"}, "rest_time"),
    ],
)
def test_what_does_not_go_with_times_at_rest_is_refused(changes, more, key):
    with pytest.raises(gd.SceneError) as error:
        gd.studies.starting_torque(AGEING.replace(changes), **({"rest_time": [1.0]} | more))
    assert error.value.key == key


def test_the_command_takes_times_at_rest(tmp_path, capfd):
    case, target = tmp_path / "ageing.toml", tmp_path / "rests.nc"
    case.write_text(dump_case(AGEING))
    options = ["--rest", "1 ms,1 s", "--impacts", "1", "--tolerance", "0.5", "-o", str(target), "--jobs", "1"]
    assert main(["starting-torque", str(case), *options]) == 0
    assert "after 1 s at rest" in " ".join(capfd.readouterr().out.split())
    assert gd.open(target).rest_time.values.tolist() == [1e-3, 1.0]
    assert main(["plot", str(target), "-o", str(tmp_path / "rests.png")]) == 0


# -- populations -----------------------------------------------------------------------------------------------------

GEARS = AGEING.replace(
    {"contact.roughness": "discrete", "gears.hub_ageing_time": "1 s", "gears.pinion_hub_adhesion": "3 uN"}
)
"""Gears that age slowly: next to nothing while the torque rises."""
LONG = (0.0, 1.0, 1e3)


@pytest.fixture(scope="module")
def gears():
    return gd.studies.starting_torque(GEARS, rest_time=LONG, seeds=2, jobs=1)


def test_gears_of_a_population_start_later_after_a_rest(gears):
    """Torques are those of hubs of the age at the start, and what the teeth hold through them."""
    assert gears.starting_torque.dims == ("rest_time", "seed")
    np.testing.assert_array_equal(gears.rest_time, LONG)
    mu = 0.2 - 0.7 * np.expm1(-gears.age.values)
    hubs, constants = (10e-6, 20e-6), mu * 10e-6 * 3e-6
    resting = [
        hub_starting_torque(GEARS.geometry, 3e-11, m, hubs, (constant, 0.0))
        for m, constant in zip(mu.flat, constants.flat, strict=True)
    ]
    r1, r2 = GEARS.geometry.base_radius_pinion, GEARS.geometry.base_radius_gear
    through = (r1 + mu * hubs[0]) / (r2 - mu * hubs[1])
    teeth = gears.parts.sel(part="adhesion of teeth").values / (r1 / r2) * through
    np.testing.assert_allclose(gears.starting_torque, np.reshape(resting, mu.shape) + teeth, rtol=1e-9)
    assert (np.abs(teeth) < 0.1 * gears.starting_torque.values).all()
    assert float(gears.starting_torque[-1].min()) > 2.0 * float(gears.starting_torque[0].max())


def test_joints_of_a_population_age_while_the_torque_rises(gears):
    ramps = gears.age - gears.rest_time
    assert (ramps > 0.0).all()
    assert float(ramps.max()) < 0.5


def test_what_is_said_of_gears_that_have_stood(gears, tmp_path):
    assert kind_of(gears) == "starting_torques_rests"
    said = answer(gears, "starting_torques_rests")
    assert said.sentence.startswith("After 1 ks at rest: half of 2 gears of this design start at ")
    assert any(row[0] == "Starting torque of 2 gears, after no time at rest" for row in said.rows)
    assert any(row[0] == "age of the joints at the start" for row in said.rows)
    labels = [line.get_label() for line in picture_of_gears(gears).get_lines()]
    assert {"after no time at rest", "after 1 s at rest", "after 1 ks at rest"} <= set(labels)
    gears.to_netcdf(tmp_path / "gears.nc")
    assert GEAR_RESTS.open(tmp_path / "gears.nc").sizes == gears.sizes
