"""Wear of joints: Archard's law, volumes of the tops of a rough surface, lognormal lives, the first joint."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, stats

import gearidae as gd
from gearidae.wear.lives.hub_wear import (
    drawn_factors,
    first_shares,
    joint_area,
    lognormal_quantile,
    read_threshold,
    tops_volume,
    turns_to,
)

SURFACE = gd.preset("teodorescu2009").surface
PIN = float(joint_area(1.25e-6, 2e-6))


@pytest.mark.parametrize(
    ("radius", "depth", "volume"),
    [(450e-9, 2.0, 7.8e-22), (160e-9, 2.0, 2.8e-22), (450e-9, 1.0, 1.02e-20), (160e-9, 1.0, 3.6e-21)],
)
def test_tops_of_a_pin(radius, depth, volume):
    """A pin of 1.25 um, 2 um long: to the two or three digits that were given."""
    surface = SURFACE.model_copy(update={"asperity_radius": radius})
    assert tops_volume(surface, depth, PIN) == pytest.approx(volume, rel=0.02, abs=0)
    areas = joint_area([1.25e-6, 2.5e-6], 2e-6)
    assert read_threshold(f"{depth:g} sigma").of(surface, areas) == pytest.approx(
        [tops_volume(surface, depth, PIN), 2.0 * tops_volume(surface, depth, PIN)], rel=1e-12, abs=0
    )


@pytest.mark.parametrize("depth", [0.0, 0.7, 3.0, 6.0])
def test_tops_are_caps_of_paraboloids_added_up_over_gaussian_heights(depth):
    caps, _ = integrate.quad(
        lambda z: math.pi * 450e-9 * ((z - depth) * 6e-9) ** 2 * stats.norm.pdf(z) * 1e18,
        depth,
        np.inf,
        epsabs=0.0,
        epsrel=1e-10,
    )
    assert tops_volume(SURFACE, depth, 1.0) == pytest.approx(169e12 * caps * 1e-18, rel=1e-8, abs=0)


def test_the_life_of_a_pin_at_constant_force():
    """V / (k 2 pi r F0), 1.27e5 turns with the numbers of the example."""
    sliding = 2.0 * math.pi * 1.25e-6 * 10e-6
    assert turns_to(1e-21, 1e-16, sliding) == pytest.approx(1.27e5, rel=5e-3)
    assert turns_to(1e-21, 1e-16, [sliding, 0.0]).tolist() == [turns_to(1e-21, 1e-16, sliding), math.inf]


@pytest.mark.parametrize(
    ("text", "volume"), [("1e-21 m^3", 1e-21), (1e-21, 1e-21), ("1e-3 um^3", 1e-21), ("0.001 um**3", 1e-21)]
)
def test_thresholds_as_volumes(text, volume):
    threshold = read_threshold(text)
    assert threshold.of(SURFACE, PIN) == pytest.approx(volume, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    "bad", ["2 m", "-1 sigma", "9 sigma", 0.0, -1e-21, "many", "x sigma", None, math.nan]
)
def test_other_thresholds_are_refused(bad):
    with pytest.raises(gd.SceneError, match="threshold"):
        read_threshold(bad)


def test_lognormal_quantiles():
    shares = np.array([0.1, 0.5, 0.9])
    expected = stats.lognorm.ppf(shares, math.log(2.0), scale=3e5)
    np.testing.assert_allclose(lognormal_quantile(3e5, 2.0, shares), expected, rtol=1e-12)
    assert lognormal_quantile(3e5, 1.0, shares).tolist() == [3e5] * 3


def test_drawn_coefficients_are_lognormal_and_each_joint_has_its_own():
    factors = drawn_factors(2.0, 4000, 3)
    logs = np.log2(factors)
    # four standard deviations of mean, spread and correlation of 4000 draws
    assert np.abs(logs.mean(axis=0)).max() < 4.0 / math.sqrt(4000)
    assert np.abs(logs.std(axis=0) - 1.0).max() < 4.0 / math.sqrt(8000)
    assert np.abs(np.corrcoef(logs.T) - np.eye(3)).max() < 4.0 / math.sqrt(4000)
    np.testing.assert_array_equal(drawn_factors(2.0, 10, 3), factors[:10])
    assert (drawn_factors(1.0, 5, 3) == 1.0).all()


def test_which_joint_is_the_first():
    lives = np.array([[1.0, 2.0, math.inf], [3.0, 2.0, math.inf], [2.0, 2.0, 5.0], [math.inf] * 3])
    assert first_shares(lives).tolist() == [(1.0 + 0.5) / 4.0, (1.0 + 0.5) / 4.0, 0.0]


def test_the_share_of_the_first_of_two_lognormal_lives():
    """The ratio of two lives is lognormal with sqrt(2) of the spread's logarithm; four standard deviations of 4000."""
    lives = turns_to([1.0, 1.5], drawn_factors(2.0, 4000, 2), 1.0)
    expected = stats.norm.cdf(math.log(1.5) / (math.sqrt(2.0) * math.log(2.0)))
    assert first_shares(lives)[0] == pytest.approx(expected, abs=4.0 * math.sqrt(0.25 / 4000))
