"""How fractions are compared with a record: chi-square of closed forms, torque from the speed, a bounded shift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearidae.monitor.fitting import COMMON, RingSet, first_explanation
from gearidae.monitor.map_model import BEFORE, Scatter
from reference.toy_map import FRACTIONS, IMPACTS, model, ring_set, sequences


@pytest.mark.parametrize("fraction", [0.6, 0.85, 0.99])
def test_the_true_fraction_has_no_misfit(fraction):
    fit = first_explanation(model(), ring_set(fraction), "auto")
    assert fit.history == "start"
    assert fit.chi2[fit.best] == pytest.approx(0.0, abs=1e-12)
    assert fit.fractions[fit.best] == pytest.approx(fraction, abs=1e-9)
    assert np.isnan(fit.torques).all()


def test_chi_square_is_that_of_correlated_errors():
    """The common error's minimum in closed form is the quadratic form of the inverse covariance."""
    record = ring_set(0.8)
    fit = first_explanation(model(), record, "start")
    covariance = np.diag(0.002**2 + 0.005**2 + (0.006 * np.arange(IMPACTS)) ** 2) + COMMON**2
    row = np.searchsorted(FRACTIONS, 0.77)
    deviation = np.log(record.frequency) - sequences()[row, BEFORE : BEFORE + IMPACTS]
    # the sums of squares differ by rounding alone
    assert fit.chi2[row] == pytest.approx(deviation @ np.linalg.solve(covariance, deviation), rel=1e-9, abs=0)


def test_a_record_without_its_start_is_placed_by_its_steps():
    late = ring_set(0.8, first=2.5)
    assert not first_explanation(model(), late, "start").explains
    fit = first_explanation(model(), late, "auto")
    assert fit.history == "unknown"
    assert fit.fractions[fit.best] == pytest.approx(0.8, abs=1e-3)


@pytest.mark.parametrize("torque", [0.75, 0.93, 1.0, 1.22])
def test_torque_is_found_from_the_speed(torque):
    fit = first_explanation(model([0.7, 1.0, 1.3]), ring_set(0.9, torque), "auto")
    assert fit.fractions[fit.best] == pytest.approx(0.9, abs=1e-3)
    assert fit.torques[fit.best] == pytest.approx(torque, rel=1e-6, abs=0)


@pytest.mark.parametrize("torque", [0.8, 0.9, 1.1, 1.2])
def test_a_shift_by_the_torque_stays_in_the_interval_of_a_map_at_one_torque(torque):
    """The shift is 0.4 ln(torque), within the bounds of 0 and 0.5 ln(torque); the interval reaches both."""
    fit = first_explanation(model(), ring_set(0.85, torque), "auto")
    assert fit.possible[0] < 0.85 < fit.possible[-1]
    exact = first_explanation(model(), ring_set(0.85), "auto").possible
    assert np.ptp(fit.possible) > np.ptp(exact) + 0.5 * abs(0.5 * np.log(torque)) / (4.0 + IMPACTS)


def test_an_unsteady_speed_widens_the_interval():
    record = ring_set(0.85)
    drifting = RingSet(record.numbers, record.frequency, record.uncertainty, record.speed, 0.03)
    for chart in (model(), model([0.7, 1.0, 1.3])):
        steady, widened = (first_explanation(chart, signal, "auto") for signal in (record, drifting))
        assert np.ptp(widened.possible) > 1.3 * np.ptp(steady.possible)


def test_scatter_between_gears_joins_the_covariance_and_widens_the_interval():
    """Chi-square is the quadratic form of the whole covariance, and its determinant counts where it differs."""
    worn = 1.0 - FRACTIONS
    steps = np.abs(np.subtract.outer(np.arange(IMPACTS), np.arange(IMPACTS)))
    between = (0.1 * worn[:, None, None]) ** 2 * 0.6**steps
    chart = replace(model(), scatter=Scatter(between[None], 20))
    record = ring_set(0.8)
    plain, wide = (first_explanation(one, record, "start") for one in (model(), chart))
    own = np.diag(0.002**2 + 0.005**2 + (0.006 * np.arange(IMPACTS)) ** 2) + COMMON**2
    determinants = np.linalg.slogdet(own + between)[1]
    row = np.searchsorted(FRACTIONS, 0.77)
    deviation = np.log(record.frequency) - sequences()[row, BEFORE : BEFORE + IMPACTS]
    expected = (
        deviation @ np.linalg.solve(own + between[row], deviation) + determinants[row] - determinants.min()
    )
    assert wide.chi2[row] == pytest.approx(expected, rel=1e-9, abs=0)
    assert wide.possible[0] < plain.possible[0]
    assert wide.possible[-1] > plain.possible[-1]


def test_no_scatter_changes_nothing():
    """Of a map over seeds whose gears are alike the intervals are those of a map of one."""
    chart = replace(model(), scatter=Scatter(np.zeros((1, len(FRACTIONS), IMPACTS, IMPACTS)), 20))
    for record in (ring_set(0.8), ring_set(0.8, first=2.5)):
        plain, same = (first_explanation(one, record, "auto") for one in (model(), chart))
        assert plain.history == same.history
        # a closed form of the common error against the inverse of the covariance
        np.testing.assert_allclose(same.chi2, plain.chi2, rtol=1e-9, atol=1e-9)
