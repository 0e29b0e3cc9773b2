import math

import numpy as np
import pytest

from gearidae_bench.error import run_error, time_at_error

TIME = np.linspace(0.0, 1.0, 11)
SPEED, POSITION = 100.0 + 2.0 * TIME, 3e-9 * TIME


def test_speed_is_held_against_its_fluctuation():
    # the speed swings by 2, so an error of 0.02 in one sample is 1 % whatever the mean
    other = SPEED.copy()
    other[4] -= 0.02
    assert run_error(SPEED, POSITION, other, POSITION, 6e-9) == pytest.approx(0.01)


def test_position_is_held_against_the_roughness():
    other = POSITION.copy()
    other[7] += 6e-12
    assert run_error(SPEED, POSITION, SPEED, other, 6e-9) == pytest.approx(1e-3)


def test_the_larger_error_counts():
    assert run_error(SPEED, POSITION, SPEED + 0.02, POSITION + 6e-9, 6e-9) == pytest.approx(1.0)


@pytest.mark.parametrize("broken", [SPEED[:5], np.full(11, np.nan)])
def test_a_run_that_broke_off_is_infinitely_wrong(broken):
    assert run_error(SPEED, POSITION, broken, POSITION[: broken.size], 6e-9) == math.inf


def test_equal_error_lies_on_a_power_law():
    errors = [1e-2, 1e-4, 1e-6]
    times = [e**-0.2 for e in errors]
    assert time_at_error(errors, times, 1e-5) == pytest.approx(1e-5**-0.2)


def test_an_error_that_was_not_reached_has_no_time():
    assert math.isnan(time_at_error([1e-2, 1e-4, math.inf], [1.0, 2.0, 9.0], 1e-5))


def test_a_method_more_accurate_than_asked_takes_as_long_as_its_loosest_run():
    assert time_at_error([1e-5, 1e-7], [2.0, 4.0], 1e-2) == 2.0


def test_runs_that_are_slower_and_less_accurate_do_not_count():
    # the run at 1e-3 is beaten by the one at 1e-4 in both respects
    assert time_at_error([1e-2, 1e-3, 1e-4], [1.0, 50.0, 4.0], 1e-3) == pytest.approx(2.0)
