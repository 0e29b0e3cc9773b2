"""The share of gears that have started by a time, against gears whose start is known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binomtest

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.shares import wilson

LOW = gd.preset("teodorescu2009_low_speed")
FREE = LOW.replace(
    {"initial.gear_speed": 0.0, "contact.asperity": "hertz", "mesh.damping": 1e-9, "load.drag": 0.0}
)
"""Without adhesion, drag and load: a constant torque turns the gear by a t^2 / 2."""
PITCH = 2.0 * math.pi / LOW.gears.gear_teeth
RATIO = LOW.gears.gear_teeth / LOW.gears.pinion_teeth
INERTIA = LOW.gears.gear_inertia + LOW.gears.pinion_inertia * RATIO**2
VARY = {"drive.torque": "uniform(1e-18 N m, 9e-18 N m)"}


def time_of(torque):
    return np.sqrt(2.0 * PITCH * INERTIA / (torque * RATIO))


@pytest.fixture(scope="module")
def found():
    return gd.studies.start_probability(FREE, VARY, 16, by=[time_of(3e-18), time_of(5e-18), 1e-3])


def test_gears_without_adhesion_start_when_their_torque_says(found):
    assert np.all(np.diff(found.by) > 0.0)
    exact = time_of(found.torque.values)
    begun = exact <= time_of(3e-18)
    assert np.array_equal(np.isfinite(found.start_time), begun)
    # the gear begins a gap later and bounces within the backlash, some thousandths of a pitch
    assert found.start_time.values[begun] == pytest.approx(exact[begun], rel=1e-2)
    # the points of a Sobol design have exactly half their number above the middle of a distribution, and so on
    assert found.probability.values.tolist() == [0.0, 0.5, 0.75]
    assert found.members.values.tolist() == [16, 16, 16]
    assert found.started.values.tolist() == [0, 8, 12]


def test_its_interval_is_that_of_wilson(found):
    interval = binomtest(8, 16).proportion_ci(method="wilson")
    assert [float(found.low[1]), float(found.high[1])] == pytest.approx([interval.low, interval.high])
    assert wilson(0, 0, 0.9) == (0.0, 1.0)
    assert "12 of 16 gears have started" in repr(found.gearidae)


def test_a_gear_that_is_turned_back_has_not_started():
    ds = gd.studies.start_probability(FREE, {"drive.torque": "uniform(-9e-18, -5e-18)"}, 2, by=["0.1 s"])
    assert int(ds.started[0]) == 0
    assert ds.members.values.tolist() == [2]


def test_a_member_that_fails_does_not_count_beyond_its_end(monkeypatch):
    from gearidae.studies.declared import start_probability as module

    whole = module.run_plan

    def one_fails(*arguments):
        ds = whole(*arguments)
        status, reached = ds["status"].values.copy(), ds["reached"].values.copy()
        status[0], reached[0] = "step_too_small", 2e-3
        return ds.assign(status=(ds["status"].dims, status), reached=(ds["reached"].dims, reached))

    monkeypatch.setattr(module, "run_plan", one_fails)
    ds = gd.studies.start_probability(FREE, VARY, 4, by=["1 ms", "3 ms"])
    assert ds.members.values.tolist() == [4, 3]


@pytest.mark.parametrize(
    ("key", "more"),
    [
        ("by", {"by": []}),
        ("by", {"by": ["2 kg"]}),
        ("by", {"by": [0.0]}),
        ("by", {"by": [math.nan]}),
        ("confidence", {"confidence": 1.0}),
        ("size", {"size": 0}),
        ("contact.seed", {"vary": {"contact.seed": "seeds"}}),
    ],
)
def test_what_it_refuses(key, more):
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.start_probability(FREE, **({"vary": VARY, "size": 2} | more))
    assert refused.value.key == key


def test_it_takes_gears():
    with pytest.raises(gd.SceneError, match="with gears"):
        gd.studies.start_probability(gd.preset("roller_slow"), {"roller.speed": "uniform(0.01, 0.02)"})


def test_its_picture_steps_where_gears_start(found):
    ax = gd.plot.start_probability(found)
    steps = ax.get_lines()[0]
    assert len(steps.get_xdata()) == 2 + int(found.started[-1])
    assert steps.get_ydata()[-1] == pytest.approx(float(found.probability[-1]))
    with pytest.raises(gd.SceneError, match="start-probability"):
        gd.plot.start_probability(found.drop_vars("start_time"))


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = ["start-probability", "low_speed", "--vary", "drive.torque=uniform(4e-18, 5e-18)"]
    command += ["--size", "2", "--by", "1 ms", "2 ms", "-o", "out.nc", "--set", "initial.gear_speed=0"]
    assert main(command) == 0
    assert "0 of 2 gears have started after 2 ms" in capsys.readouterr().out
