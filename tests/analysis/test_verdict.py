"""Verdicts on runs whose motion is known."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import IRREGULAR_ABOVE, outcomes
from gearidae.archive import combine, to_dataset
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS, EventKind, Events, Extremes, Solution, Statistics
from reference.sampled_extremes import with_extremes

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 201})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 201})
SCHEDULED = LOW.replace({"drive.schedule": [[0.0, 0.0], [0.1, 1e-18]]})
AT = np.linspace(0.0, 1.0, 201)


def solution_of(scene, *, reached=1.0, status="finished", impacts=3):
    """Make a solution at rest, with contacts made and broken in turn."""
    time = np.linspace(0.0, scene.run.duration, scene.run.samples)[: round(reached * scene.run.samples)]
    names = GEAR_COLUMNS if scene.roller is None else ROLLER_COLUMNS
    kinds = np.array([EventKind.ONSET, EventKind.SEPARATION] * impacts, dtype=np.int8)
    size = len(kinds)
    events = Events(
        np.arange(size) * 1e-9, kinds, np.zeros(size, np.int64), np.zeros(size, np.int8), np.zeros(size)
    )
    statistics = Statistics(1, 1, 1, 0, 0, 0, 1, 0.1, "native")
    return Solution(time, {name: np.zeros(len(time)) for name in names}, events, statistics, status, "")


def gear_run(speed, scene=LOW, **options):
    solution = solution_of(scene, **options)
    speed = speed[: len(solution.time)]
    solution.samples["gear_speed"] = speed
    solution.samples["gear_angle"] = np.cumsum(speed) * scene.run.duration / (scene.run.samples - 1)
    return to_dataset(scene, with_extremes(scene, solution))


def ripple(share):
    """Speeds about 1.5 rad/s whose spread is `share` of their mean."""
    return 1.5 * (1.0 + 0.5 * share * np.cos(40 * np.pi * AT))


@pytest.mark.parametrize(
    ("speed", "verdict"),
    [
        (ripple(0.9 * IRREGULAR_ABOVE), "turns smoothly"),
        (ripple(1.1 * IRREGULAR_ABOVE), "irregular"),
        (np.where(AT < 0.04, ripple(1.5), 1.5), "turns smoothly"),  # bounces at the start only
        (1.5 - 2.0 * AT, "sticks"),
        (np.maximum(1.5 - 2.0 * AT, 0.0), "sticks"),
        (1.5 * np.abs(1.0 - 2.0 * AT), "irregular"),  # at rest for an instant, and turns on
        (np.zeros(201), "sticks"),  # never gets going
        (np.where(AT < 0.01, 0.0, 1.5), "turns smoothly"),  # starts from rest
        (np.where(AT < 0.04, 20 * AT * np.cos(80 * np.pi * AT), 1.5), "turns smoothly"),  # and bounces there
        (2.0 * AT, "running up"),
        (2.0 - 1.9 * AT, "running down"),
        (np.minimum(6.0 * AT, 1.5), "turns smoothly"),  # up to speed by the second half
        (-1.5 * AT, "runs back"),
        (np.where(AT < 0.04, 20 * AT, 1.5 - 2.0 * AT), "sticks"),  # from rest, and comes to rest again
    ],
)
def test_gear_verdicts(speed, verdict):
    (outcome,) = outcomes(gear_run(speed))
    assert outcome.verdict == verdict
    assert (outcome.min_speed, outcome.max_speed) == (speed.min(), speed.max())


@pytest.mark.parametrize(
    ("speed", "verdict"),
    [
        (10 * AT, "runs"),
        (10 * np.maximum(0.8 - AT, 0.0), "sticks"),
        (10 * np.maximum(0.96 - AT, -0.01), "sticks"),  # turned back by less than half a pitch
        (100 * (0.5 - AT), "runs back"),
        (-100 * np.ones(201), "runs back"),
        (1e3 * np.abs(0.96 - AT), "irregular"),  # at rest for an instant, and turns on
    ],
)
def test_a_schedule_may_change_the_speed(speed, verdict):
    (outcome,) = outcomes(gear_run(speed, SCHEDULED))
    assert outcome.verdict == verdict


def test_a_run_cut_short_is_unfinished_unless_it_had_stuck():
    early = {"reached": 0.5, "status": "chatter"}
    (turning,) = outcomes(gear_run(ripple(0.01), **early))
    (stuck,) = outcomes(gear_run(1.5 - 4.0 * AT, **early))
    assert (turning.verdict, turning.status) == ("unfinished", "chatter")
    assert (stuck.verdict, stuck.status) == ("sticks", "chatter")


EXTREMES = Extremes(
    min_gear_speed=1.4,
    max_gear_speed=1.6,
    settled_gear_speed=1.5,
    settled_spread=0.2,
    speed_fall=0.2,
    speed_rise=0.2,
    late_gear_speed=1.5,
    late_spread=0.2,
    last_min_gear_speed=1.4,
    reversals=0,
    stick_time=math.nan,
    stick_exits=5,
    turned_back=0.0,
    turn_backs=0,
    time_adhering=0.0,
    mesh_exits=5,
    largest_mesh_force=3e-13,
    largest_mesh_force_time=0.1,
    smallest_mesh_force=-4e-13,
    smallest_mesh_force_time=0.2,
    smallest_separation=3e-8,
    final_speed=1.5,
)
STUCK = {"stick_time": 0.2124, "stick_exits": 4, "mesh_exits": 9, "reversals": 3}


@pytest.mark.parametrize(
    ("extremes", "verdict", "words"),
    [
        ({}, "turns smoothly", "turned smoothly through 5 mesh exits in 0.3 s"),
        (STUCK, "sticks", "sticks at 0.212 s (4 mesh exits)"),
        (STUCK | {"stick_exits": 1, "stick_time": 0.0123}, "sticks", "sticks at 12.3 ms (1 mesh exit)"),
        (STUCK | {"turned_back": 0.6}, "runs back", "runs back at 0.212 s (4 mesh exits)"),
        (
            {"stick_time": 0.0, "stick_exits": 2, "turned_back": 9.0},
            "runs back",
            "runs back from the start (2 mesh exits)",
        ),
        ({"stick_time": 0.0, "stick_exits": 0}, "sticks", "does not start in 0.3 s"),
        (
            {"settled_spread": 0.5, "speed_fall": 0.5, "speed_rise": 0.4},
            "irregular",
            "turned irregularly through 5 mesh exits in 0.3 s",
        ),
        (
            {"settled_spread": 0.5, "speed_fall": 0.3, "speed_rise": 0.5, "late_spread": 0.4},
            "running up",
            "was still running up through 5 mesh exits in 0.3 s",
        ),
        (
            {"settled_spread": 0.5, "speed_fall": 0.5, "speed_rise": 0.3, "late_spread": 0.4},
            "running down",
            "was still running down through 5 mesh exits in 0.3 s",
        ),
    ],
)
def test_a_verdict_follows_from_the_extremes_and_not_from_the_samples(extremes, verdict, words):
    solution = dataclasses.replace(solution_of(LOW), extremes=Extremes(EXTREMES, **extremes))
    solution.samples["gear_speed"] = np.full(len(solution.time), -3.0)
    (outcome,) = outcomes(to_dataset(LOW, solution))
    assert (outcome.verdict, outcome.words) == (verdict, words)
    assert (outcome.min_speed, outcome.max_speed) == (1.4, 1.6)


@pytest.mark.parametrize("fraction", [1.0, 0.5, 0.47])
def test_a_verdict_is_the_same_however_a_run_is_sampled_and_to_whatever_tolerance(fraction):
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": fraction})
    ways = [{"samples": 5}, {"samples": 301}, {"samples": 30001}, {"samples": "off"}]
    ways += [{"samples": 5, "rtol": rtol} for rtol in (1e-5, 1e-7, 1e-9)]
    sentences = {outcomes(gd.simulate(scene, t_end=0.3, **way))[0].words for way in ways}
    assert len(sentences) == 1, sentences


def test_impacts_are_counted_run_by_run():
    fractions = [1.0, 0.5]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [solution_of(scene, impacts=count) for scene, count in zip(scenes, (2, 7), strict=True)]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    assert [(outcome.label, outcome.impacts) for outcome in outcomes(ds)] == [
        ({"sam_fraction": 1.0}, 2),
        ({"sam_fraction": 0.5}, 7),
    ]
    assert [outcome.impacts for outcome in outcomes(ds.sel(sam_fraction=0.5))] == [7]


def roller_run(speed, force, *, impacts, lets_go):
    solution = solution_of(ROLLER, impacts=impacts)
    solution.samples.update(speed=speed, force=force)
    if impacts and not lets_go:
        events = solution.events
        kept = {name: getattr(events, name)[:-1] for name in events.columns}
        assert kept["kind"][-1] == EventKind.ONSET
        solution = dataclasses.replace(solution, events=Events(**kept))
    return to_dataset(ROLLER, with_extremes(ROLLER, solution))


def test_roller_rebounds_with_the_restitution_of_its_speeds():
    speed = np.where(AT < 0.5, -0.01, 0.004)
    force = 2e-5 * np.sin(2 * np.pi * AT) * (AT < 0.75)
    (outcome,) = outcomes(roller_run(speed, force, impacts=1, lets_go=True))
    assert outcome.verdict == "rebounds"
    assert outcome.restitution == pytest.approx(0.4, rel=1e-15, abs=0)
    assert outcome.peak_force == force.max()
    assert outcome.pull_off_force == -force.min()


def test_roller_that_is_still_in_touch_sticks():
    (outcome,) = outcomes(roller_run(1e-4 * np.cos(50 * AT), -1e-6 * AT, impacts=1, lets_go=False))
    assert outcome.verdict == "sticks"
    assert np.isnan(outcome.restitution)
    assert outcome.peak_force == 0.0


def test_roller_that_has_not_arrived_flies():
    (outcome,) = outcomes(roller_run(np.full(201, -0.01), np.zeros(201), impacts=0, lets_go=False))
    assert outcome.verdict == "flies"
    assert outcome.pull_off_force == 0.0


def test_what_is_no_dataset_of_ours_is_refused():
    ds = gear_run(ripple(0.1))
    del ds.attrs["scene"]
    with pytest.raises(gd.SceneError, match="must come from simulate"):
        outcomes(ds)
