"""What counts as a schedule in the verdict, the rules of standing and going back, and the rule for rollers."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict.judge import (
    gear_verdict,
    has_stuck,
    in_touch,
    is_scheduled,
    roller_verdict,
)
from gearidae.records import EventKind, Extremes
from gearidae.records.standing import Holding, stands

LOW = gd.preset("teodorescu2009_low_speed")
KNOTS = [(0.0, 5.0), (1.0, 6.0)]


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, False),
        ({"drive.speed": 6.0, "drive.speed_gain": 1e-18}, False),
        ({"drive.speed": KNOTS, "drive.speed_gain": 1e-18}, True),
        ({"drive.schedule": [(0.0, 1e-18), (1.0, 2e-18)]}, True),
        ({"load.schedule": [(0.0, 0.0), (1.0, 2e-18)]}, True),
    ],
)
def test_speeds_that_are_asked_to_change(changes, expected):
    assert is_scheduled(LOW.replace(changes).to_dict()) is expected


STANDS = Extremes(stick_time=0.2, free_advance=3.0, driven_time=0.1, followed_time=0.3, turned_back=0.0)
MOVES = Extremes(
    STANDS, stick_time=math.nan, settled_gear_speed=1.0, settled_spread=0.1, last_min_gear_speed=0.9
)
BACK = Extremes(MOVES, turned_back=12.0, free_turned_back=12.0, back_time=0.1)


@pytest.mark.parametrize("scheduled", [False, True])
@pytest.mark.parametrize(
    ("extremes", "verdict"),
    [
        (STANDS, "sticks"),
        (Extremes(STANDS, driven_time=0.0), "sticks"),  # free gears have moved by more than a tenth
        (Extremes(STANDS, free_advance=0.05), "sticks"),  # driven for more than a hundredth of the run
        (Extremes(STANDS, free_advance=0.05, driven_time=0.003), "stops"),
        (Extremes(STANDS, free_advance=0.0, driven_time=0.0), "stops"),
        (Extremes(STANDS, turned_back=12.0), "sticks"),  # standing goes before gone back
        (BACK, "turns back"),
        (Extremes(BACK, free_turned_back=6.0), "turns back"),
        (Extremes(BACK, free_turned_back=5.9), "runs back"),
        (Extremes(BACK, turned_back=0.4, free_turned_back=0.5), "turns back"),  # a little forward since
        (Extremes(BACK, turned_back=0.0, free_turned_back=0.0, back_time=math.nan), None),
    ],
)
def test_standing_is_judged_alike_for_every_torque(extremes, verdict, scheduled):
    wanted = verdict or ("runs" if scheduled else "turns smoothly")
    assert gear_verdict(extremes, "finished", scheduled=scheduled) == wanted
    assert has_stuck(extremes) is (verdict in ("sticks", "runs back"))


@pytest.mark.parametrize(
    ("fall", "verdict"),
    [
        (0.0, "running up"),  # started in the last twentieth
        (0.25, "running up"),
        (0.26, "irregular"),  # it had turned before
        (math.nan, "irregular"),
    ],
)
def test_a_scheduled_start_in_the_last_twentieth_is_a_running_up(fall, verdict):
    late = Extremes(MOVES, last_min_gear_speed=0.0, speed_fall=fall, speed_rise=4.0)
    assert gear_verdict(late, "finished", scheduled=True) == verdict


@pytest.mark.parametrize(
    ("advance", "free", "lasts", "expected"),
    [
        (0.3, 0.61, 0.002, True),
        (0.3, 0.6, 0.002, False),  # it has moved on by half as much
        (0.2, 0.0, 0.004, True),  # rocking in a well, undriven
        (0.2, 0.0, 0.002, False),  # for too short a time
        (0.0, 0.05, 0.002, False),
        (0.0, 0.05, 0.004, True),
        (0.05, 0.05, 0.2, False),  # just starting
    ],
)
def test_conditions_of_standing(advance, free, lasts, expected):
    assert stands(advance, free, lasts, 0.3, together=False) is expected


def test_a_gear_that_settles_with_free_gears_stands_and_stops():
    assert stands(0.42, 0.43, 0.2, 0.3, together=True)
    assert not stands(0.042, 0.043, 0.002, 0.3, together=True)  # for too short a time
    settled = Extremes(STANDS, free_advance=0.42, settled=1)
    assert gear_verdict(settled, "finished", scheduled=False) == "stops"
    assert not has_stuck(settled)


def test_what_holds_in_words():
    assert Holding(0).words == ""
    assert (Holding.DRY_RESISTANCE | Holding.ADHESION).words == "dry resistance and adhesion"


def test_a_scene_without_gears_has_no_schedule():
    assert not is_scheduled(gd.preset("roller_slow").to_dict())


@pytest.mark.parametrize(
    ("kinds", "speed", "expected"),
    [
        ([], -1.0, "flies"),
        ([EventKind.ONSET], -1.0, "sticks"),
        ([EventKind.ONSET, EventKind.SEPARATION], 1.0, "rebounds"),
        ([EventKind.ONSET, EventKind.SEPARATION], -1.0, "sticks"),
        ([EventKind.ONSET, EventKind.SEPARATION, EventKind.ONSET], 1.0, "sticks"),
    ],
)
def test_rollers(kinds, speed, expected):
    pieces = [
        np.array(kinds[:1], np.int8),
        np.array([EventKind.TURNING_POINT], np.int8),
        np.array(kinds[1:], np.int8),
    ]
    impacts = kinds.count(EventKind.ONSET)
    extremes = Extremes(final_speed=speed)
    assert roller_verdict(extremes, "finished", impacts, in_touch(pieces)) == expected
    assert roller_verdict(extremes, "fold", impacts, in_touch(pieces)) == "unfinished"
    assert roller_verdict(None, "finished", impacts, in_touch(pieces)) == "unfinished"
