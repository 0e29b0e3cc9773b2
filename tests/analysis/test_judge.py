"""What counts as a schedule in the verdict, and the rule for rollers."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict.judge import in_touch, is_scheduled, roller_verdict
from gearidae.records import EventKind, Extremes

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
    found = Extremes(final_speed=speed)
    assert roller_verdict(found, "finished", impacts, in_touch(pieces)) == expected
    assert roller_verdict(found, "fold", impacts, in_touch(pieces)) == "unfinished"
    assert roller_verdict(None, "finished", impacts, in_touch(pieces)) == "unfinished"
