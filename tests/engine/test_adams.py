"""Adams' formulas: exact for polynomials on any steps, the known ones on equal steps, and what they are good for."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.engine import adams, native
from gearidae.engine.model.state import ADAMS, MOST_ORDERS
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import OWN_SAFETY
from gearidae.records import Statistics
from gearidae_bench.error import run_error
from gearidae_bench.reference import load_reference
from gearidae_bench.scenes import SCENES

EPS = np.finfo(float).eps
REFERENCES = Path(__file__).parents[2] / "benchmarks" / "references"


def walk(times, state, rates, order):
    """The record of formulas of one order that have been through these times.

    Also the last one's leading coefficient, the rates that it wanted, and its prediction.
    """
    a = np.zeros(1, ADAMS)[0]
    a.wanted = 1
    n = state(times[0]).size
    correction = np.empty(n)
    adams.begin(a, times[0], state(times[0]), rates(times[0]))
    for before, t in pairwise(times):
        cj = adams.rates_at_end(n, a, t - before, order, state(t), correction)
        wanted = a.predicted_rates[:n].copy()
        a.new_step = t - before
        a.new_state[:n] = state(t)
        a.new_differences[0, :n] = rates(t)
        adams.set_differences(a, t - before)
        yp = np.empty(n)
        adams.store_step(a, t, yp)
        np.testing.assert_array_equal(yp, rates(t))
    return a, cj, wanted, state(times[-1]) + correction


@pytest.mark.parametrize("n", [2, 4])
@given(
    steps=st.lists(st.floats(0.4, 1.2), min_size=9, max_size=12),
    coefficients=st.lists(st.floats(-1, 1), min_size=36, max_size=36),
    order=st.integers(1, MOST_ORDERS),
)
def test_the_formula_is_exact_for_rates_of_its_order(n, steps, coefficients, order):
    """The polynomial through so many known rates and the new one is the rates' own, if they are one of that degree.

    The prediction, by the known ones alone, is exact for one degree less.
    """
    of_rates = np.array(coefficients).reshape(4, 9)[:n, : order + 1]
    times = np.concatenate([[0.0], np.cumsum(steps)]) / sum(steps)
    powers = np.arange(order + 1)

    def rates(t):
        return of_rates @ t**powers

    def state(t):
        return of_rates @ (t ** (powers + 1) / (powers + 1))

    a, _, wanted, _ = walk(times, state, rates, order)
    # the weights of nine rates at steps that differ by a factor of three add up to some 1e5
    rounding, closest = 1e6 * EPS, np.diff(times).min()
    np.testing.assert_allclose(wanted, rates(times[-1]), rtol=0, atol=rounding / closest)
    of_rates[:, -1] = 0.0
    *_, prediction = walk(times, state, rates, order)
    np.testing.assert_allclose(prediction, state(times[-1]), rtol=0, atol=rounding)
    of_rates[:] = np.array(coefficients).reshape(4, 9)[:n, : order + 1]
    y, yp = np.empty(n), np.empty(n)
    for t in np.linspace(times[-2], times[-1], 7):
        adams.between(a, t, y, yp)
        np.testing.assert_allclose(y, state(t), rtol=0, atol=rounding)
        np.testing.assert_allclose(yp, rates(t), rtol=0, atol=rounding / closest)


LEADING = {1: 1 / 2, 2: 5 / 12, 3: 9 / 24, 4: 251 / 720, 5: 475 / 1440, 6: 19087 / 60480, 7: 36799 / 120960}


@pytest.mark.parametrize("order", LEADING)
def test_equal_steps_give_the_formulas_of_adams_and_moulton(order):
    """Leading coefficients of the implicit formulas (Hairer, Norsett and Wanner, III.1)."""
    _, cj, *_ = walk(0.1 * np.arange(12), lambda t: np.zeros(2), lambda t: np.zeros(2), order)
    assert 1.0 / (0.1 * cj) == pytest.approx(LEADING[order], rel=1e-12)


def test_the_first_step_has_one_rate_to_look_back_on():
    """The trapezoidal rule, whatever the order asked for."""
    _, cj, wanted, _ = walk(np.array([0.0, 0.5]), lambda t: np.array([t, t]), lambda t: np.ones(2), 5)
    assert cj == pytest.approx(4.0)
    np.testing.assert_allclose(wanted, 1.0)


def test_a_step_that_was_not_accepted_leaves_no_trace():
    a, *_ = walk(0.1 * np.arange(5), np.atleast_1d, lambda t: np.ones(1), 3)
    before = a.copy()
    adams.rates_at_end(1, a, 0.3, 3, np.array([0.7]), np.empty(1))
    adams.set_differences(a, 0.3)
    adams.store_step(a, 0.7, np.empty(1))
    for part in ("time", "last_step", "n_history", "state", "time_lags", "differences"):
        np.testing.assert_array_equal(a[part], before[part])


@pytest.mark.parametrize(("name", "gain"), [("low_sam", 3.0), ("high_bare", 4.0)])
def test_the_same_tolerance_means_a_smaller_error(name, gain):
    """Than with IDA's own formulas of the same tolerance of a step, in half the steps.

    It is 3 to 30 times smaller at 1e-4 to 1e-10.

    Rounding alone moves a single ratio by half of itself: the mean of six is within a third of 5 and of 9.
    """
    reference = load_reference(REFERENCES / f"{name}.npz")
    ratios = []
    for rtol in 10.0 ** -np.linspace(6.5, 8.0, 6):
        errors, steps = {}, {}
        for as_ida in (False, True):
            problem, statistics = make_problem(SCENES[name].scene), Statistics()
            of_run = rtol * OWN_SAFETY if as_ida else rtol
            blocks = native.run(problem, of_run, reference.time.size, statistics, as_ida=as_ida)
            rows = np.concatenate([b.rows for b in blocks])
            speed, position = (
                rows[:, problem.columns.index(c)] for c in ("gear_speed", "transmission_error")
            )
            errors[as_ida] = run_error(reference.speed, reference.position, speed, position, reference.length)
            steps[as_ida] = statistics.steps
        ratios.append(errors[True] / errors[False])
        assert steps[False] < 0.6 * steps[True]
    assert np.exp(np.mean(np.log(ratios))) > gain


@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_what_vibrates_at_the_tolerance_comes_to_rest(rtol):
    """Both flanks touch, and every swing of the pinion turns eight histories: no tolerance is worth following them.

    Adams' formulas damp nothing; a run by them alone goes on for millions of steps.
    """
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "contact.bodies": "rigid",
            "surface.roughness": "40 nm",
            "coating.energy": "1e-4 J/m^2",
            "initial.gear_speed": 0.0,
            "initial.gap": "150 nm",
            "load.torque": "1e-9 N m",
            "run.duration": "20 ms",
        }
    )
    problem, statistics = make_problem(scene), Statistics()
    rows = np.concatenate([b.rows for b in native.run(problem, rtol, 2001, statistics)])
    late = rows[1800:, problem.columns.index("transmission_error")]
    assert statistics.steps < 200_000
    assert np.ptp(late) < rtol * 40e-9
