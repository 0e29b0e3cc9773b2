"""Adams' formulas: exact for polynomials on any steps, the known ones on equal steps, left where they are no good."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.bench.error import run_error
from gearidae.bench.reference import load_reference
from gearidae.bench.scenes import SCENES
from gearidae.engine import adams, native
from gearidae.engine.problem import make_problem
from gearidae.engine.run import Tally

EPS = np.finfo(float).eps
REFERENCES = Path(__file__).parents[2] / "benchmarks" / "references"


def walk(times, state, rates, order):
    """A desk that has been through these times, the last one by a step of the formula."""
    desk = np.zeros(adams.DESK)
    n = state(times[0]).size
    adams.begin(desk, times[0], state(times[0]), rates(times[0]))
    for before, t in pairwise(times):
        cj = adams.rates_at_end(n, desk, t - before, order, state(t))
        wanted = desk[adams.PREDICTED_RATES : adams.PREDICTED_RATES + n].copy()
        desk[adams.NEW_STEP] = t - before
        desk[adams.NEW_STATE : adams.NEW_STATE + n] = state(t)
        desk[adams.NEW_RATES : adams.NEW_RATES + n] = rates(t)
        yp = np.empty(n)
        adams.keep(desk, t, yp)
        np.testing.assert_array_equal(yp, rates(t))
    return desk, cj, wanted


@pytest.mark.parametrize("n", [2, 4])
@given(
    steps=st.lists(st.floats(0.2, 2.0), min_size=6, max_size=9),
    coefficients=st.lists(st.floats(-1, 1), min_size=24, max_size=24),
    order=st.integers(1, 5),
)
def test_the_formula_is_exact_for_rates_of_its_order(n, steps, coefficients, order):
    """The polynomial through order known rates and the new one is the rates' own, if they are one of that degree."""
    of_rates = np.array(coefficients).reshape(4, 6)[:n, : order + 1]
    times = np.concatenate([[0.0], np.cumsum(steps)]) / sum(steps)
    powers = np.arange(order + 1)

    def rates(t):
        return of_rates @ t**powers

    def state(t):
        return of_rates @ (t ** (powers + 1) / (powers + 1))

    desk, _, wanted = walk(times, state, rates, order)
    # divided differences over steps down to a fiftieth of the whole magnify rounding
    closest = np.diff(times).min()
    rounding = 1e3 * EPS / closest ** (order - 1)
    np.testing.assert_allclose(wanted, rates(times[-1]), rtol=0, atol=rounding / closest)
    y, yp = np.empty(n), np.empty(n)
    for t in np.linspace(times[-2], times[-1], 7):
        adams.between(desk, t, y, yp)
        np.testing.assert_allclose(y, state(t), rtol=0, atol=rounding)
        np.testing.assert_allclose(yp, rates(t), rtol=0, atol=rounding / closest)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_equal_steps_give_the_formulas_of_adams_and_moulton(order):
    """Leading coefficients of the implicit formulas (Hairer, Norsett and Wanner, III.1): 1/2, 5/12, 9/24, ..."""
    leading = {1: 1 / 2, 2: 5 / 12, 3: 9 / 24, 4: 251 / 720, 5: 475 / 1440}[order]
    _, cj, _ = walk(0.1 * np.arange(9), lambda t: np.zeros(2), lambda t: np.zeros(2), order)
    assert 1.0 / (0.1 * cj) == pytest.approx(leading, rel=1e-12)


def test_the_first_step_has_one_rate_to_look_back_on():
    """The trapezoidal rule, whatever the order asked for."""
    _, cj, wanted = walk(np.array([0.0, 0.5]), lambda t: np.array([t, t]), lambda t: np.ones(2), 5)
    assert cj == pytest.approx(4.0)
    np.testing.assert_allclose(wanted, 1.0)


def test_a_step_that_was_not_accepted_leaves_no_trace():
    desk, _, _ = walk(0.1 * np.arange(5), np.atleast_1d, lambda t: np.ones(1), 3)
    before = desk.copy()
    adams.rates_at_end(1, desk, 0.3, 3, np.array([0.7]))
    adams.keep(desk, 0.7, np.empty(1))
    for part in (slice(adams.STATE, adams.AREA), slice(adams.TABLE, adams.DESK)):
        np.testing.assert_array_equal(desk[part], before[part])


def test_where_the_formulas_are_no_good_ida_has_its_own():
    desk = np.zeros(adams.DESK)
    adams.begin(desk, 1.0, np.ones(2), np.ones(2))
    desk[adams.FASTEST] = 4.0
    state, rates, weights = np.array([16.0, 0.1]), np.zeros(2), np.full(2, 1e9)
    assert adams.reaches(2, desk, 0.2, state, rates, weights)
    assert not adams.reaches(2, desk, 0.3, state, rates, weights)  # a tenth of the vibration's period
    assert not adams.reaches(2, desk, 0.2, state, rates, 1e5 * weights)  # a tolerance of three roundings
    slow = np.array([16.0, 1e-8])  # ten tolerances: at rest, unless it is where the vibration turns
    assert not adams.reaches(2, desk, 0.2, slow, rates, weights)
    assert adams.reaches(2, desk, 0.2, slow, np.array([0.0, 1e-7]), weights)


@pytest.mark.parametrize(("name", "gain"), [("low_sam", 3.0), ("high_bare", 5.0)])
def test_the_same_tolerance_means_a_smaller_error(name, gain):
    """Than with IDA's own formulas, in about as many steps: measured 4 to 60 times smaller at 1e-5 to 1e-8."""
    reference = load_reference(REFERENCES / f"{name}.npz")
    errors, steps = {}, {}
    for as_ida in (False, True):
        problem, tally = make_problem(SCENES[name].scene), Tally()
        samples = reference.time.size
        rows = np.concatenate([b.rows for b in native.run(problem, 1e-7, samples, tally, as_ida=as_ida)])
        speed, position = (rows[:, problem.columns.index(c)] for c in ("gear_speed", "transmission_error"))
        errors[as_ida] = run_error(reference.speed, reference.position, speed, position, reference.length)
        steps[as_ida] = tally.steps
    assert gain * errors[False] < errors[True]
    assert steps[False] < 1.1 * steps[True]


@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_what_vibrates_at_the_tolerance_comes_to_rest(rtol):
    """Both flanks touch, and every swing of the pinion turns eight histories: no tolerance is worth following them.

    Adams' formulas damp nothing; a run by them alone goes on for millions of steps.
    """
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "contact.model": "asperity",
            "surface.roughness": "40 nm",
            "coating.energy": "1e-4 J/m^2",
            "initial.gear_speed": 0.0,
            "initial.gap": "150 nm",
            "load.torque": "1e-9 N m",
            "run.duration": "20 ms",
        }
    )
    problem, tally = make_problem(scene), Tally()
    rows = np.concatenate([b.rows for b in native.run(problem, rtol, 2001, tally)])
    late = rows[1800:, problem.columns.index("transmission_error")]
    assert tally.steps < 200_000
    assert np.ptp(late) < rtol * 40e-9
