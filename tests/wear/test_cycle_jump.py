"""Cycle jump with rates that are known: closed forms, tolerances, and where the gear sticks."""

import math

import numpy as np
import pytest

from gearidae.wear.lives.cycle_jump import GearStuck, Life, jump


def decay(state):
    return -1e-9 * state


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_a_constant_rate_decays_exponentially(tolerance):
    start = np.array([1.0, 0.5])
    result = jump(decay, start, passages=2e9, tolerance=tolerance)
    assert (result.ending, result.passages[-1]) == ("passages", 2e9)
    assert math.isnan(result.sticks_by)
    expected = start * np.exp(-1e-9 * np.array(result.passages))[:, None]
    # each step may be out by the tolerance of the state then, and a tenth of it absolutely
    np.testing.assert_allclose(result.states, expected, rtol=2 * tolerance * len(result.passages))


def test_half_the_tolerance_halves_the_error_and_more():
    """The pair's error in a step goes with the third power of its length, as its estimate does."""
    errors = []
    for tolerance in (4e-3, 5e-4, 6.25e-5):
        result = jump(decay, np.ones(1), passages=2e9, tolerance=tolerance)
        errors.append(abs(result.states[-1][0] - math.exp(-2.0)))
    assert errors[1] < errors[0] / 4
    assert errors[2] < errors[1] / 4


def test_a_coverage_ends_it():
    result = jump(decay, np.ones(1), passages=1e12, tolerance=1e-5, least=0.5)
    assert result.ending == "coverage"
    assert result.states[-1].mean() == pytest.approx(0.5, abs=1e-9)
    assert result.passages[-1] == pytest.approx(1e9 * math.log(2.0), rel=1e-4)


@pytest.mark.parametrize("bracket", [0.02, 0.002])
def test_where_the_gear_sticks_is_bracketed(bracket):
    """It sticks below 0.3, that is from ln(1/0.3) on."""

    def rate(state):
        if state.mean() < 0.3:
            raise GearStuck
        return decay(state)

    result = jump(rate, np.ones(1), passages=1e12, tolerance=1e-6, bracket=bracket)
    truth = -1e9 * math.log(0.3)
    assert result.ending == "sticks"
    # the bracket is that of the trial states, which are Euler steps of this width
    assert result.passages[-1] <= truth * (1 + 1e-5)
    assert result.sticks_by == pytest.approx(truth, rel=2 * bracket)
    assert result.sticks_by - result.passages[-1] <= bracket * result.sticks_by


def test_what_sticks_from_the_start_has_no_life():
    def rate(state):
        raise GearStuck

    result = jump(rate, np.ones(1), passages=1e12, tolerance=1e-3)
    assert (result.ending, result.sticks_by, result.passages) == ("sticks", 0.0, [0.0])


def test_nothing_is_lost_without_a_rate():
    result = jump(np.zeros_like, np.ones(3), passages=1e6, tolerance=1e-3)
    assert result.passages == [0.0, 1e6]
    np.testing.assert_array_equal(result.states[-1], 1.0)


def test_archard_ends_at_zero():
    result = jump(lambda f: np.where(f > 0.0, -1e-6, 0.0), np.array([1.0]), passages=3e6, tolerance=1e-3)
    assert result.states[-1][0] == pytest.approx(0.0, abs=1e-3)
    assert min(state.min() for state in result.states) >= 0.0


def test_no_rate_is_asked_for_where_nothing_is_left():
    """A trial that loses more than there is costs a window of bare gears, which adhere most, and says nothing."""
    asked = []

    def rate(state):
        asked.append(float(state.mean()))
        if state.mean() < 0.3:
            raise GearStuck
        return -1e-9 / (state - 0.29) ** 2

    result = jump(rate, np.ones(1), passages=1e12, tolerance=0.03)
    assert result.ending == "sticks"
    # (f - 0.29)^3 / 3 falls evenly
    assert result.sticks_by == pytest.approx(1e9 * (0.71**3 - 0.01**3) / 3.0, rel=0.02)
    assert min(asked) > 0.0


def test_what_an_exception_interrupts_is_kept():
    asked = []

    def rate(state):
        asked.append(state)
        if len(asked) > 20:
            raise KeyboardInterrupt
        return decay(state)

    life = Life()
    with pytest.raises(KeyboardInterrupt):
        jump(rate, np.ones(1), passages=2e9, tolerance=1e-6, life=life)
    whole = jump(decay, np.ones(1), passages=2e9, tolerance=1e-6)
    assert life.ending == "interrupted"
    assert 2 < len(life.passages) < len(whole.passages)
    assert life.passages == whole.passages[: len(life.passages)]


class Steps:
    """Mesh cycles of a twentieth of a passage, of a rate that is known; the gear sticks below 0.3."""

    worth = 5.0

    def __init__(self, rate):
        self.rate, self.run = rate, 0

    def follow(self, n, state):
        while True:
            if state.mean() < 0.3:
                raise GearStuck(n + 0.05)
            yield n, state
            self.run += 1
            n, state = n + 0.05, state + 0.05 * self.rate(state)


def test_the_last_passages_are_followed_cycle_by_cycle():
    """(f - 1/4)^2 falls evenly, by 1/250 in a passage, and f ever faster: it is 0.3 after 140 passages."""

    def rate(state):
        if state.mean() < 0.3:
            raise GearStuck
        return -0.002 / (state - 0.25)

    direct = Steps(rate)
    result = jump(rate, np.ones(1), passages=1e12, tolerance=1e-4, direct=direct)
    assert result.ending == "sticks"
    # steps of h lag behind the rates by h/2 log(their ratio): 0.07 passages; the bracket is two cycles
    assert result.sticks_by == pytest.approx(140.0, abs=0.07 + 0.1)
    assert result.sticks_by - result.passages[-1] == pytest.approx(0.1)
    assert 100 < direct.run < 500  # 5 to 25 of 140 passages
    n = np.array(result.passages)
    truth = 0.25 + np.sqrt(0.5625 - 0.004 * n)
    np.testing.assert_allclose(np.array(result.states)[:, 0], truth, rtol=0.01)
    assert np.abs(np.diff(result.states, axis=0))[n[1:] > 135.0].max() < 0.012


def test_a_loss_that_slows_down_is_jumped_over_again():
    def rate(state):
        return -0.1 * state

    direct = Steps(rate)
    result = jump(rate, np.ones(1), passages=8.0, tolerance=1e-5, direct=direct)
    assert result.ending == "passages"
    assert result.passages[-1] == pytest.approx(8.0)
    assert result.states[-1][0] == pytest.approx(
        math.exp(-0.8), rel=0.1 * 0.05 * 0.5 * 8.0 + 1e-4
    )  # Euler's error
    late = Steps(lambda state: -1e-3 * state)
    result = jump(lambda state: -1e-3 * state, np.ones(1), passages=1e3, tolerance=1e-3, direct=late)
    assert late.run == 0
    slow = Steps(rate_that_fades)
    result = jump(rate_that_fades, np.full(1, 0.9), passages=1e4, tolerance=1e-3, direct=slow)
    assert result.passages[-1] == 1e4
    assert 0 < slow.run < 2000  # of 200 000 cycles
    assert result.states[-1][0] == pytest.approx(0.4, abs=1e-3)


def rate_that_fades(state):
    """Towards 0.4, at which nothing is lost any more."""
    return -0.05 * (state - 0.4)


@pytest.mark.parametrize("least", [0.6, 0.35])
def test_a_coverage_ends_cycles_too(least):
    direct = Steps(lambda state: -0.05 + 0.0 * state)
    result = jump(direct.rate, np.ones(1), passages=1e12, tolerance=1e-3, least=least, direct=direct)
    assert result.ending == "coverage"
    assert result.states[-1][0] == pytest.approx(least, abs=1e-9)
    assert result.passages[-1] == pytest.approx((1.0 - least) / 0.05, rel=1e-6)
