"""Schedules that repeat, and schedules of a run's own time: what their knots do that are written out one by one."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

import gearidae as gd
from gearidae.errors import SceneError
from gearidae.records import EventKind
from gearidae.runs.estimates import mean_drive_torque
from gearidae.scene import Knots

CYCLE = 2.0**-10
KNOTS = [[0.0, 1e-18], [CYCLE / 4, 4e-18], [CYCLE / 2, 0.0]]
HALF = 2 * CYCLE
BASE = gd.preset("teodorescu2009_low_speed").replace(
    {"run.duration": 2 * HALF, "run.samples": 129, "coating.sam_fraction": 1.0}
)
DRIVERS = ("native", "sksundae")


def repeated(**settings):
    return {"knots": KNOTS, "repeat": CYCLE, **settings}


def written_out(cycles, offset=0.0):
    return [[offset + k * CYCLE + t, value] for k in range(cycles) for t, value in KNOTS]


def assert_same_runs(one, other):
    for name, variable in one.data_vars.items():
        if variable.dims in (("time",), ("event",)):
            np.testing.assert_array_equal(variable, other[name], err_msg=name)


@pytest.mark.parametrize("backend", DRIVERS)
@pytest.mark.parametrize("table", ["drive", "load"])
def test_a_schedule_that_repeats_is_its_knots_written_out(table, backend):
    """To the last bit, with an event at each knot but those at start and end."""
    one, other = (
        gd.simulate(BASE.replace({f"{table}.schedule": schedule}), backend=backend)
        for schedule in (repeated(), written_out(5))
    )
    assert_same_runs(one, other)
    knots = one.event_time[one.event_kind == EventKind.SCHEDULE_KNOT]
    np.testing.assert_allclose(knots, [t for t, _ in written_out(4)][1:], rtol=1e-12)
    if table == "drive":
        wanted = BASE.drive.torque + np.interp(one.time, *np.transpose(KNOTS), period=CYCLE)
        np.testing.assert_allclose(one.drive_torque, wanted, rtol=0, atol=1e-12 * 4e-18)


@pytest.mark.parametrize("backend", DRIVERS)
def test_a_cubic_that_repeats_has_no_corner_where_a_cycle_ends(backend):
    ds = gd.simulate(BASE.replace({"drive.schedule": repeated(interpolation="cubic")}), backend=backend)
    times, values = np.transpose([[t - CYCLE, value] for t, value in written_out(6)])
    wanted = BASE.drive.torque + PchipInterpolator(times, values)(ds.time)
    np.testing.assert_allclose(ds.drive_torque, wanted, rtol=0, atol=1e-12 * 4e-18)
    assert not (ds.event_kind == EventKind.SCHEDULE_KNOT).any()


@pytest.mark.parametrize("backend", DRIVERS)
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_held_speed_repeats(interpolation, backend):
    gain, first = 1e-17, float(BASE.initial.gear_speed) * 4
    speeds = [[t, first * (1 + value / 8e-18)] for t, value in KNOTS]
    held = {"knots": speeds, "repeat": CYCLE, "interpolation": interpolation}
    ds = gd.simulate(
        BASE.replace({"drive.speed": held, "drive.speed_gain": gain, "run.duration": HALF}), backend=backend
    )
    wanted = (ds.drive_torque - BASE.drive.torque) / gain + ds.pinion_speed
    times, values = np.transpose([[k * CYCLE + t, w] for k in range(-1, 4) for t, w in speeds])
    curve = (
        PchipInterpolator(times, values)
        if interpolation == "cubic"
        else lambda t: np.interp(t, times, values)
    )
    np.testing.assert_allclose(wanted, curve(ds.time), rtol=0, atol=1e-9 * first)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("backend", DRIVERS)
def test_cycles_in_a_chain_are_the_run_of_all_of_them(interpolation, backend):
    scene = BASE.replace({"drive.schedule": repeated(interpolation=interpolation), "load.torque": 5e-19})
    whole = gd.simulate(scene.replace({"run.checkpoints": [HALF]}), backend=backend)
    half = scene.replace({"run.duration": HALF, "run.samples": 65})
    first = gd.simulate(half, backend=backend)
    second = gd.simulate(half, start=first, backend=backend)
    for name in ("gear_speed", "transmission_error", "drive_torque", "load_torque"):
        np.testing.assert_array_equal(np.concatenate([first[name], second[name][1:]]), whole[name])
    (words,), (all_words,) = (gd.outcomes(ds) for ds in (second, whole))
    assert words.verdict == all_words.verdict


@pytest.mark.parametrize("backend", DRIVERS)
@pytest.mark.parametrize("table", ["drive", "load"])
@pytest.mark.parametrize("repeat", [False, True])
def test_times_of_a_run_count_from_its_start(table, repeat, backend):
    """The same scene goes on from itself: the second run does what knots on the clock of the chain do."""
    own = repeated(after="run") if repeat else {"knots": KNOTS, "after": "run"}
    begin = 1.25 * HALF  # where a schedule of the chain's time is in its middle
    scene = BASE.replace({"run.duration": begin, f"{table}.schedule": own})
    first = gd.simulate(scene, backend=backend)
    again = gd.simulate(scene, start=first, backend=backend)
    shifted = written_out(4 if repeat else 1, begin)
    other = gd.simulate(scene.replace({f"{table}.schedule": shifted}), start=first, backend=backend)
    assert_same_runs(again, other)
    chain = {"knots": KNOTS, "repeat": CYCLE} if repeat else KNOTS
    late = gd.simulate(scene.replace({f"{table}.schedule": chain}), start=first, backend=backend)
    assert not np.array_equal(again[f"{table}_torque"], late[f"{table}_torque"])


BAD = [
    ({"repeat": 0.0}, "repeat must be above 0 s"),
    ({"repeat": "1 m"}, "repeat"),
    ({"repeat": CYCLE / 4}, "more than the .* s after which they repeat"),
    ({"repeat": CYCLE / 2}, "must have its value, 1e-18"),
    ({"after": "start"}, "after 'start' must be 'chain' or 'run'"),
    ({"repeat": 0.6 * CYCLE, "every": 3}, "unknown key 'every'"),
]


@pytest.mark.parametrize(("settings", "message"), BAD)
def test_what_does_not_repeat(settings, message):
    with pytest.raises(SceneError, match=message) as error:
        BASE.replace({"drive.schedule": {"knots": KNOTS, **settings}})
    assert "drive.schedule" in str(error.value)


def test_more_cycles_than_a_run_may_have():
    with pytest.raises(SceneError, match=r"load.schedule.repeat .*100000"):
        BASE.replace(
            {"load.schedule": {"knots": [[0.0, 0.0], [1e-9, 1e-18]], "repeat": 2e-9}, "run.duration": 1.0}
        )


def test_the_last_knot_may_close_the_cycle():
    closed = Knots([*map(tuple, KNOTS), (CYCLE, KNOTS[0][1])], repeat=CYCLE)
    opened = Knots(map(tuple, KNOTS), repeat=CYCLE)
    assert closed != opened
    assert closed.during(0.0, 3 * CYCLE) == opened.during(0.0, 3 * CYCLE)


def test_one_knot_that_repeats_is_a_constant():
    held = BASE.replace({"drive.torque": 0.0, "drive.schedule": {"knots": [[0.0, 2e-18]], "repeat": CYCLE}})
    np.testing.assert_allclose(gd.simulate(held).drive_torque, 2e-18, rtol=1e-15)


@pytest.mark.parametrize("count", [3, 700])
def test_scenes_keep_what_repeats(count, tmp_path):
    times = np.linspace(0.0, CYCLE / 2, count)
    table = {"time": times, "value": 1e-18 * np.cos(times), "repeat": "2 ms", "after": "run"}
    scene = BASE.replace({"drive.schedule": table})
    assert (scene.drive.schedule.repeat, scene.drive.schedule.after) == (2e-3, "run")
    assert gd.Scene.from_dict(scene.to_dict()) == scene
    (tmp_path / "case.toml").write_text(gd.dump_case(scene))
    assert gd.load_case(tmp_path / "case.toml").drive == scene.drive
    assert scene != BASE.replace({"drive.schedule": {**table, "after": "chain"}})


def test_estimates_take_a_cycle_for_the_run():
    """A thousand cycles have the mean of one."""
    many = BASE.replace({"drive.torque": 0.0, "drive.schedule": repeated(), "run.duration": 1000.3 * CYCLE})
    assert mean_drive_torque(many) == pytest.approx(1.375e-18, rel=1e-3, abs=0)
