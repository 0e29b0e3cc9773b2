"""Runs that go on from others: to the last bit where nothing has changed, consistently where something has."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.archive.end_state import end_state_of, packed_state
from gearidae.archive.run_summary import counted_over
from gearidae.cli.tables import show_summary
from gearidae.engine.continuing import checkpoint_of_start, end_of
from gearidae.engine.model.state import EMPTY
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.start import Start
from gearidae.errors import SceneError
from gearidae.records import EventKind
from gearidae.report.tables import summary_tables

# runs of trains do not go on from others
CASES = [
    path
    for path in sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))
    if path.stem != "transmission"
]
START_UP = next(case for case in CASES if case.stem == "start_up")
DRIVERS = ("native", "sksundae")
LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"run.duration": 2.0**-8, "run.samples": 65, "coating.sam_fraction": 0.6}
)
OVER_THE_CHAIN = (
    *("min_gear_speed", "max_gear_speed", "largest_mesh_force", "smallest_mesh_force"),
    *("stick_time", "mesh_exits", "reversals"),
)
SAMPLES = 65  # of each half; halves of powers of two make the times of samples equal to the last bit


def shortened(case, model, backend):
    """Scene of a case over a short time that both drivers get through within seconds; a power of two."""
    scene = gd.load_case(case)
    changes = {"contact.model": model, "run.samples": SAMPLES, "run.rtol": 1e-6}
    share = 2.0 ** -(4 + 4 * (model == "elastic") + 5 * (backend == "sksundae"))
    half = 2.0 ** math.floor(math.log2(share * scene.run.duration))
    if (
        case.stem == "microengine"
    ):  # at rest the times at which a law is looked at depend on the run's duration
        changes |= {"gears.hub_friction": 0.0, "gears.hub_friction_rise": 0.0}
    if scene.roller is not None:  # the impact is in the second half
        half = 2.0 ** math.floor(math.log2(0.6 * scene.roller.height / scene.roller.speed))
    return scene.replace(changes | {"run.duration": half}), half


def assert_same(joined, whole):
    np.testing.assert_array_equal(joined, whole)


def assert_continued(first, second, whole):
    """Both halves are the whole run, but for what is judged over each run's own time."""
    assert_same(np.concatenate([first.time, second.time[1:]]), whole.time)
    for name, variable in whole.data_vars.items():
        if variable.dims == ("time",):
            assert_same(np.concatenate([first[name], second[name][1:]]), variable)
        elif variable.dims == ("event",):
            assert_same(np.concatenate([first[name], second[name]]), variable)
    for name in OVER_THE_CHAIN:
        if name in whole:
            assert_same(second[name], whole[name])
    for name in ("steps", "restarts", "residual_evaluations", "guard_evaluations"):
        assert first.attrs[name] + second.attrs[name] == whole.attrs[name]
    assert second.gearidae.energy_balance == whole.gearidae.energy_balance
    words = [end_state_of(ds.attrs)[0] for ds in (second, whole)]
    assert words[0].size == words[1].size


PORTABLE = {"high_speed", "low_speed", "microengine", "roller_slow"}
"""Of the portable driver, whose steps end as those of the native one, four cases are enough."""
CUT = [
    pytest.param(case, model, backend, id=f"{case.stem}-{model}-{backend}")
    for case in CASES
    for model in ("asperity", "elastic")
    for backend in DRIVERS
    if backend == "native" or case.stem in PORTABLE
]


@pytest.mark.parametrize(("case", "model", "backend"), CUT)
def test_a_run_cut_in_two_is_the_uninterrupted_one_to_the_last_bit(case, model, backend):
    scene, half = shortened(case, model, backend)
    first = gd.simulate(scene, backend=backend)
    second = gd.simulate(scene, backend=backend, start=first)
    both = {"run.duration": 2 * half, "run.samples": 2 * SAMPLES - 1, "run.checkpoints": [half]}
    whole = gd.simulate(scene.replace(both), backend=backend)
    assert_continued(first, second, whole)
    assert second.attrs["start_time"] == half
    assert second.attrs["t_end"] == 2 * half


def test_a_run_with_friction_that_is_cut_where_a_pair_pulls_is_the_uninterrupted_one():
    """A pair that pulls has no friction at the cut, which is seen only with the forces of its stretched asperities."""
    half = 2.0**-4
    scene = LOW.replace({"contact.friction": 0.1, "run.duration": half})
    first = gd.simulate(scene)
    second = gd.simulate(scene, start=first)
    both = {"run.duration": 2 * half, "run.samples": 2 * SAMPLES - 1, "run.checkpoints": [half]}
    whole = gd.simulate(scene.replace(both))
    assert_continued(first, second, whole)
    assert (second.event_kind == EventKind.MESH_EXIT).any()


@pytest.mark.parametrize("backend", DRIVERS)
def test_a_knot_at_the_cut_is_an_event_of_the_second_part(backend):
    half = 2.0**-7
    knots = [(0.0, 0.0), (half, 1e-18), (1.5 * half, -1e-18)]
    scene = LOW.replace({"run.duration": half, "run.samples": SAMPLES, "drive.schedule": knots})
    first = gd.simulate(scene, backend=backend)
    second = gd.simulate(scene, backend=backend, start=first)
    both = {"run.duration": 2 * half, "run.samples": 2 * SAMPLES - 1, "run.checkpoints": [half]}
    whole = gd.simulate(scene.replace(both), backend=backend)
    assert_continued(first, second, whole)
    assert (second.event_kind[0], second.event_time[0]) == (
        EventKind.SCHEDULE_KNOT,
        whole.event_time[first.sizes["event"]],
    )


def test_a_joined_chain_is_the_uninterrupted_run():
    half = LOW.run.duration
    first = gd.simulate(LOW)
    joined = gd.concat([first, gd.simulate(LOW, start=first)], "time")
    both = {"run.duration": 2 * half, "run.samples": 2 * SAMPLES - 1, "run.checkpoints": [half]}
    whole = gd.simulate(LOW.replace(both))
    for name, variable in whole.data_vars.items():
        if variable.dims in (("time",), ("event",)):
            assert_same(joined[name], variable)
    assert_same(joined.time, whole.time)
    assert joined.attrs["steps"] == whole.attrs["steps"]
    assert float(joined.stick_time) == pytest.approx(float(whole.stick_time), nan_ok=True, rel=0, abs=0)


def test_a_checkpoint_is_no_event_and_changes_next_to_nothing():
    plain = gd.simulate(LOW)
    kept = gd.simulate(LOW.replace({"run.checkpoints": ["1 ms", "2 ms"]}))
    assert kept.attrs["restarts"] == plain.attrs["restarts"] + 2
    assert not (kept.event_kind == EventKind.SCHEDULE_KNOT).any()
    # some tens of tolerances, as between any two step sequences
    np.testing.assert_allclose(kept.gear_speed, plain.gear_speed, rtol=1e-4)


def test_memory_archive_and_chain_of_archives_are_the_same(tmp_path):
    first = gd.simulate(LOW, archive=tmp_path / "first.nc")
    kept = gd.simulate(LOW)
    assert first.attrs["end_state"] == kept.attrs["end_state"]
    second = gd.simulate(LOW, start=tmp_path / "first.nc", archive=tmp_path / "second.nc")
    again = gd.simulate(LOW, start=kept)
    for name in ("time", "gear_speed", "event_time", "event_pair"):
        assert_same(second[name], again[name])
    third = gd.simulate(LOW, start=tmp_path / "second.nc")
    assert third.time[0] == second.time[-1] == 2 * LOW.run.duration
    assert third.gear_speed[0] == pytest.approx(float(second.gear_speed[-1]), rel=1e-12)
    assert third.gear_angle[0] == pytest.approx(float(second.gear_angle[-1]), rel=1e-12)


def test_a_continued_run_is_resumed_with_its_start(tmp_path):
    target = tmp_path / "second.nc"
    first = gd.simulate(LOW)
    finished = gd.simulate(LOW, start=first, archive=target)
    assert gd.simulate(LOW, start=first, archive=target, resume=True).identical(finished)
    with pytest.raises(SceneError, match="began elsewhere"):
        gd.simulate(LOW, archive=target, resume=True)
    with pytest.raises(SceneError, match="began elsewhere"):
        gd.simulate(LOW, start=finished, archive=target, resume=True)


def balance_closes(ds):
    balance = ds.gearidae.energy_balance
    return abs(balance["residual"]) <= balance["residual_bound"]


CHANGES = {
    "torque": {"drive.torque": 9e-18},
    "load": {"load.torque": 2e-18, "load.viscous": 1e-18},
    "worn": {"coating.sam_fraction": 0.4},
    "fresh": {"coating.sam_fraction": 1.0},
    "bare": {"coating.sam_fraction": 0.0},
    "stickier": {"coating.energy": 0.3},
    "tolerance": {"run.rtol": 1e-8, "run.samples": "off"},
    "method": {"run.method": "bdf"},
    "speed": {"drive.torque": 0.0, "drive.speed": 6.0, "drive.speed_gain": 1e-17},
}


@pytest.mark.parametrize("model", ["asperity", "elastic"])
@pytest.mark.parametrize(("before", "after"), [(0.0, 0.6), (1.0, 0.0)])
def test_a_material_that_was_absent_begins_with_nothing_stretched(before, after, model):
    scene = LOW.replace({"contact.model": model, "run.duration": 2.0**-9})
    first = gd.simulate(scene.replace({"coating.sam_fraction": before}))
    second = gd.simulate(scene.replace({"coating.sam_fraction": after}), start=first)
    assert second.attrs["status"] == "finished"
    assert balance_closes(second)
    assert second.gearidae.energy_balance["model_change"] != 0.0


@pytest.mark.parametrize("model", ["asperity", "elastic"])
@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_scene_goes_on_from_the_same_motion(change, model):
    scene = LOW.replace({"contact.model": model, "run.duration": 2.0**-9})
    first = gd.simulate(scene)
    second = gd.simulate(scene.replace({"run.samples": 33} | CHANGES[change]), start=first)
    assert second.attrs["status"] == "finished"
    assert balance_closes(second)
    if second.sizes["time"]:
        for name in ("gear_speed", "pinion_speed", "gear_angle", "transmission_error"):
            assert float(second[name][0]) == pytest.approx(float(first[name][-1]), rel=1e-9, abs=1e-18)
        assert second.time[0] == first.time[-1]


def test_a_worn_run_does_what_its_coating_makes_it_do():
    """After a change of the coating the energy that contacts store has jumped, and that is booked."""
    first = gd.simulate(LOW)
    same = gd.simulate(LOW, start=first)
    worn = gd.simulate(LOW.replace({"coating.sam_fraction": 0.3}), start=first)
    change = [ds.gearidae.energy_balance["model_change"] for ds in (same, worn)]
    assert change[0] == 0.0
    assert change[1] != 0.0
    assert abs(worn.gear_speed - same.gear_speed).max() > 1e-3


def test_time_goes_on_for_torques():
    """A harmonic and a schedule of the second run are read at the time that goes on."""
    flight = LOW.replace(
        {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "drive.torque": 0.0, "load.drag": 0.0, "run.rtol": 1e-9}
    )
    t0, inertia = LOW.run.duration, LOW.gears.pinion_inertia
    first = gd.simulate(flight)
    knots = [(0.0, 0.0), (1.25 * t0, 0.0), (1.5 * t0, 2e-18)]
    wave = {"amplitude": 1e-18, "frequency": 300.0, "phase": 0.3}
    second = gd.simulate(flight.replace({"drive.schedule": knots, "drive.harmonic": wave}), start=first)
    omega = 2 * math.pi * 300
    swing = 1e-18 / omega * (math.sin(omega * 2 * t0 + 0.3) - math.sin(omega * t0 + 0.3))
    gained = (swing + 2e-18 * (0.125 + 0.5) * t0) / inertia
    assert float(second.pinion_speed[-1] - first.pinion_speed[-1]) == pytest.approx(gained, rel=1e-6)
    assert (second.event_kind == EventKind.SCHEDULE_KNOT).sum() == 2


REFUSED = [
    ({"surface.roughness": "7 nm"}, "surface.roughness"),
    ({"mesh.backlash": "0.3 um"}, "mesh.backlash"),
    ({"gears.pinion_inertia": 2e-20}, "gears.pinion_inertia"),
    ({"contact.asperity": "dmt"}, "contact.asperity"),
]


@pytest.mark.parametrize(("change", "key"), REFUSED, ids=[key for _, key in REFUSED])
def test_what_may_not_differ_is_named(change, key):
    first = gd.simulate(LOW)
    with pytest.raises(SceneError, match=f"{key}.*as in the run to go on from"):
        gd.simulate(LOW.replace(change), start=first)


def test_bad_starts(tmp_path):
    first = gd.simulate(LOW)
    with pytest.raises(SceneError, match=r"gears.*must be given, as in the run"):
        gd.simulate(gd.preset("roller_slow"), start=first)
    with pytest.raises(SceneError, match="cannot be read"):
        gd.simulate(LOW, start=tmp_path / "none.nc")
    with pytest.raises(SceneError, match="must be a dataset of a run"):
        gd.simulate(LOW, start=5)
    bare = first.copy()
    del bare.attrs["end_state"]
    with pytest.raises(SceneError, match="carries no state"):
        gd.simulate(LOW, start=bare)
    sweep = gd.sweep(LOW.replace({"run.duration": 1e-4}), {"coating.sam_fraction": [0.5, 1.0]})
    with pytest.raises(SceneError, match="must be a single run"):
        gd.simulate(LOW, start=sweep)
    with pytest.raises(SceneError, match=r"t_end.*must lie after"):
        gd.simulate(LOW, start=first, t_end=1e-4)
    ended = gd.simulate(LOW, start=first, t_end=1.5 * LOW.run.duration)
    assert ended.time[-1] == pytest.approx(1.5 * LOW.run.duration)


def test_a_damaged_state_is_refused_or_checked():
    """Text that is none, words cut short, another layout, another scene, and what is no number."""
    first = gd.simulate(LOW)
    words, _ = end_state_of(first.attrs)
    text = first.attrs["end_state"]

    def refused(**attributes):
        with pytest.raises(SceneError):
            gd.simulate(LOW, start=first.assign_attrs(attributes))

    refused(end_state="x")
    refused(end_state=7)
    refused(end_state=text[: len(text) // 2])
    refused(end_state=packed_state(words[:-3]))
    refused(start_time=float("nan"))
    refused(start_time="x")
    refused(scene=json.dumps(LOW.replace({"coating.sam_fraction": 0.7}).to_dict()))
    for place, value in ((0, 1.0), (1, 5.0), (5, 3.0), (6, 9.0)):
        changed = words.copy()
        changed[place] = value
        refused(end_state=packed_state(changed))
    changed = words.copy()
    changed[-1] = math.nan
    refused(end_state=packed_state(changed))


@pytest.mark.parametrize("backend", DRIVERS)
def test_a_stop_after_turns_is_exact_and_knows_no_samples(backend):
    """The gear has turned by N turns to the root's accuracy, whatever is sampled."""
    scene = LOW.replace({"run.duration": 0.05, "run.samples": 2001, "run.stop": "turns 0.004"})
    ends = []
    for samples in (2001, 11, "off"):
        ds = gd.simulate(scene, samples=samples, backend=backend)
        assert ds.attrs["status"] == "finished"
        ends.append(ds.attrs["t_end"])
        if samples == 2001:
            turned = float(ds.gear_angle[-1] - ds.gear_angle[0])
            assert turned <= 0.004 * 2 * math.pi
            assert turned == pytest.approx(0.004 * 2 * math.pi, rel=1e-2)
    assert len(set(ends)) == 1
    on = gd.simulate(scene, backend=backend)
    more = gd.simulate(scene, start=on, backend=backend)
    assert more.attrs["t_end"] > 1.9 * ends[0]
    # speeds differ by the ringing about the mean alone
    assert more.attrs["t_end"] - more.attrs["start_time"] == pytest.approx(ends[0], rel=0.02)


def test_a_gear_that_only_stops_does_not_end_a_run_that_is_to_end_where_it_sticks():
    """It comes to rest at the time that its closed form has, by its dry resistance, and is not driven."""
    inertia, dry, speed = 6.1052e-20, 3e-18, 1.5
    flight = LOW.replace(
        {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "drive.torque": 0.0, "load.drag": 0.0, "run.rtol": 1e-9}
    )
    scene = flight.replace({"load.torque": 40 * dry, "run.stop": "sticks", "run.duration": 0.02})
    ds = gd.simulate(scene)
    expected = inertia * speed / (40 * dry)
    assert ds.attrs["t_end"] == 0.02
    assert float(ds.stick_time) == pytest.approx(expected, rel=1e-7)
    assert outcomes(ds)[0].words.endswith(", held by dry resistance")


def test_runs_of_a_sweep_stop_each_for_itself():
    """A worn gear's run ends where free gears would have turned on by a pitch; a coated one's goes on to the end."""
    scene = LOW.replace({"run.duration": 0.3, "run.samples": 301, "run.stop": "sticks"})
    ds = gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.45]}, jobs=1)
    assert ds.status.values.tolist() == ["finished", "finished"]
    coated, worn = ds.reached.values
    assert (coated, np.isnan(ds.stick_time.values[0])) == (0.3, True)
    assert worn > float(ds.stick_time[1])
    assert float(ds.free_advance[1]) == pytest.approx(1.0, rel=1e-5)
    sampled = np.isfinite(ds.gear_speed.values)
    assert sampled[0].all()
    np.testing.assert_array_equal(sampled[1], ds.time.values <= worn)
    alone = gd.simulate(scene.replace({"coating.sam_fraction": 0.45}))
    assert alone.attrs["t_end"] == worn


def test_a_block_may_end_the_run(tmp_path):
    seen = []

    def enough(block):
        seen.append(block.time)
        return len(seen) == 2

    scene = LOW.replace({"run.duration": 0.5, "run.samples": 100_001})
    ds = gd.simulate(scene, on_block=enough, archive=tmp_path / "run.nc")
    assert ds.attrs["status"] == "stopped"
    assert len(seen) == 2
    assert 0 < ds.sizes["time"] < 100_001
    assert float(ds.time[-1]) <= seen[-1]
    assert gd.open_archive(tmp_path / "run.nc").attrs["status"] == "stopped"


BAD_STOPS = ["never", "turns", "turns -1", "turns x", "turns 1e99", 5, "turns nan"]


@pytest.mark.parametrize("stop", BAD_STOPS)
def test_bad_stops(stop):
    with pytest.raises(SceneError, match=r"run\.stop"):
        LOW.replace({"run.stop": stop})


# -- knots that the solver cannot tell from the cut --------------------------------------------------------------------

CUT = LOW.run.duration
NEAR_THE_CUT = {
    "before": [(0.0, 0.0), (CUT * (1.0 - 1e-13), 1e-18), (1.5 * CUT, 2e-18)],
    "after": [(0.0, 0.0), (CUT * (1.0 + 1e-13), 1e-18), (1.5 * CUT, 2e-18)],
}


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("key", ["drive.schedule", "load.schedule"])
@pytest.mark.parametrize("side", NEAR_THE_CUT)
def test_a_knot_next_to_the_cut_is_passed_once(side, key, interpolation):
    """The solver leaves such a knot out at the end of the first run; the second enters its segment."""
    time, value = zip(*NEAR_THE_CUT[side], strict=True)
    table = {"time": np.array(time), "value": np.array(value), "interpolation": interpolation}
    scene = LOW.replace({key: table})
    first = gd.simulate(scene)
    second = gd.simulate(scene, start=first)
    assert second.attrs["status"] == "finished"
    knots = np.concatenate(
        [ds.event_time[ds.event_kind == EventKind.SCHEDULE_KNOT] for ds in (first, second)]
    )
    expected = [1.0, 1.5] if interpolation == "linear" else [1.5]  # a cubic schedule has no knots inside
    assert knots == pytest.approx(np.array(expected) * CUT, rel=2e-13, abs=0)


# -- numbers that are carried over into other units --------------------------------------------------------------------

WORN = LOW.replace(
    {"coating.sam_fraction": 0.4, "run.exposures": 8, "run.samples": "off", "run.duration": "0.16 s"}
)
OF_EACH_RUN = {
    *("settled_gear_speed", "settled_spread", "speed_fall", "speed_rise", "late_gear_speed", "late_spread"),
    "last_min_gear_speed",
}
OF_THE_TORQUES = {"pitch_work", "speed_work", "torque_work"}  # bounds by the loads that a scene is about
UNITS = {
    "ten times the torque": {"drive.torque": 4.5e-17},
    "a schedule": {"drive.schedule": [(0.0, 1e-17), (1.0, 3e-18)]},
    "a held speed": {"drive.speed": 6.0, "drive.speed_gain": 1e-17},
    "dry load": {"load.torque": 2e-20},
    "another tolerance": {"drive.torque": 4.5e-18, "run.rtol": 1e-8},
}


def kept(scene, words, start):
    """Extremes, energy balance and the histories' rates (SI) in a checkpoint."""
    problem = make_problem(scene, start=Start(start, 0.0)).of_checkpoint(words)
    problem.prepare(scene.run.rtol, scene.run.sample_count)
    time, y = problem.restored(words)
    balance, extremes = problem.kept(time, y, np.zeros_like(y))
    scene_units, histories = problem.model.scene, problem.model.state.history
    speed = float(scene_units.length_unit / scene_units.time_unit)
    energy = float(scene_units.force_unit * scene_units.length_unit)
    used = histories[histories["pair"] != EMPTY]
    power = energy / float(scene_units.time_unit)
    scaled = {
        "gap_rate": speed,
        "adhesion_lag": energy,
        "adhesion_lag_power": power,
        "adhesion_lag_power_rate": power / float(scene_units.time_unit),
    }
    rates = {name: np.sort(used[name]) * unit for name, unit in scaled.items()}
    numbers = {**extremes} | {f"energy {name}": value for name, value in balance.items()} | rates
    numbers["standstill_list"] = np.nan_to_num(np.array(extremes.standstill_list))
    return {
        name: value
        for name, value in numbers.items()
        if name.removeprefix("energy ") not in OF_EACH_RUN | OF_THE_TORQUES
    }


def test_every_number_of_a_chain_is_the_same_in_other_units():
    """Torques set the units of time and force: what a run has kept is the same quantity in those of the next."""
    scene, run = WORN, gd.simulate(WORN)
    assert float(run.time_adhering) > 0.01
    for change in UNITS.values():
        words, start = end_state_of(run.attrs)
        before, at_end = kept(scene, words, start), end_of(scene, words, start)
        scene = WORN.replace({"run.duration": "1 ms"} | change)
        after = kept(scene, checkpoint_of_start(scene, at_end), at_end.time)
        for name, number in before.items():
            # sums are rounded as sums are: energies over all that was exchanged, times over the time of the chain
            size = {"energy": before["energy throughput"], "time": at_end.time}.get(
                re.split("[ _]", name)[0], 0.0
            )
            size = max(size, np.max(np.abs(number), initial=0.0))
            np.testing.assert_allclose(after[name], number, rtol=1e-12, atol=1e-12 * size, err_msg=name)
        run = gd.simulate(scene, start=run)
        grown = float(run.time_adhering) - before["time_adhering"]
        assert -1e-12 <= grown <= 1e-3 + 1e-12


def test_rows_of_a_continued_run_say_whether_they_are_of_the_chain(capsys):
    first = gd.simulate(LOW)
    second = gd.simulate(LOW.replace({"drive.torque": 9e-18}), start=first)
    rows = {
        name: counted_over(name, second.attrs) for name in ("time_at_rest", "time_adhering", "drive_work")
    }
    assert rows == {"time_at_rest": "the chain", "time_adhering": "the chain", "drive_work": "the chain"}
    assert counted_over("drive_work", first.attrs) == ""
    show_summary(second)
    printed = capsys.readouterr().out
    assert re.search("time to speed.*; this run", printed)
    assert re.search("drive work.*; the chain", printed)
    page = summary_tables(second)
    assert re.search("adhesion loss.*lost; the chain", page)


def test_time_at_rest_of_a_continued_run_is_that_of_the_chain():
    """The gear of a start-up is at rest for its first 3 ms: cut there, the second run counts on."""
    scene = gd.load_case(START_UP).replace({"run.duration": "1 ms", "run.samples": "off"})
    first = gd.simulate(scene)
    second = gd.simulate(scene.replace({"run.duration": "4 ms"}), start=first)
    rests = [run.gearidae.account.time_at_rest for run in (first, second)]
    slip = float(second.event_time[second.event_kind == EventKind.SLIP][0])
    assert rests[0] == pytest.approx(1e-3, rel=1e-12)
    assert rests[1] == pytest.approx(slip, rel=1e-9)
    still = gd.simulate(scene, start=first)  # held all the time, without an event of its own
    assert still.gearidae.account.time_at_rest == pytest.approx(2e-3, rel=1e-9)


def test_the_outcome_of_a_chain_names_its_window():
    """Exits and speeds are counted over the chain, and so is the time that the words give."""
    first = gd.simulate(LOW)
    second = gd.simulate(LOW, start=first)
    words = [outcomes(ds)[0].words for ds in (first, second, gd.concat([first, second], "time"))]
    assert words[0].endswith(" in 3.91 ms")
    assert words[1].endswith(" in 7.81 ms of the chain")
    assert words[2].endswith(" in 7.81 ms")
