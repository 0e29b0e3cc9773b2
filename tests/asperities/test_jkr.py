"""One JKR asperity: landmarks, the paper's polynomials, JKR's own equations in SI, limits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.asperities import AsperityLaw, asperity_load, jkr
from gearidae.asperities.tip import asperity_of
from reference import asperity as dimensional


@pytest.mark.parametrize(
    ("cube", "displacement", "load"),
    [(1 / 18, -1.0, -5 / 9), (1 / 2, -0.48075, -1.0), (8 / 9, 0.0, -8 / 9)],
    ids=["fold", "pull-off", "touch"],
)
def test_landmarks_of_the_branch(cube, displacement, load):
    s = cube ** (1 / 6)
    # -0.48075 is printed with five digits, the others are exact.
    assert jkr.displacement(s) == pytest.approx(displacement, abs=5e-6 if cube == 1 / 2 else 1e-15)
    assert jkr.load(s) == pytest.approx(load, abs=1e-15)
    assert jkr.jkr_load(jkr.displacement(s)) == pytest.approx(load, abs=1e-15 if cube != 1 / 18 else 1e-7)


def test_named_roots_are_the_fold_and_the_touch():
    assert jkr.displacement([jkr.S_FOLD, jkr.S_TOUCH]) == pytest.approx([-1.0, 0.0], abs=1e-15)
    assert jkr.jkr_root([-1.0, 0.0]) == pytest.approx([jkr.S_FOLD, jkr.S_TOUCH], rel=1e-15, abs=0)


def test_polynomials_are_the_papers():
    # Teodorescu et al. 2009, Eqs. 7-8, with 12^(1/3) for the radicand that print has lost.
    a = np.linspace(0.4, 9.0, 50)
    s = np.sqrt(a)
    paper = 12 ** (1 / 3) * a**2 * (1 - 2 * math.sqrt(2) / 3 * a**-1.5)
    assert jkr.displacement(s) == pytest.approx(paper, rel=1e-13, abs=1e-13)
    assert jkr.load(s) == pytest.approx(2 * (a**3 - np.sqrt(2 * a**3)), rel=1e-13, abs=1e-13)


@given(st.floats(min_value=-1.0, max_value=1e12))
def test_root_inverts_displacement(displacement):
    s = jkr.jkr_root(displacement)
    assert s >= jkr.S_FOLD * (1 - 1e-15)
    # With t = s/S_FOLD three times the displacement is t^4 - 4t: an ulp of s moves it by up to 8 ulp of t^4 = 3d + 4t,
    # and s, its scaling and its way back are rounded once each.
    assert jkr.displacement(s) == pytest.approx(displacement, rel=6e-15, abs=2e-14)


@given(st.floats(min_value=1e-15, max_value=1e-9))
def test_no_digit_is_lost_at_the_fold(distance):
    d = -1.0 + distance
    step = math.sqrt((d + 1.0) / 2.0)  # t - 1 to first order; the next order is 2/3 of its square
    assert jkr.jkr_load(d) + 5 / 9 == pytest.approx(-4 / 3 * step, rel=2 * step, abs=3e-16)


def test_si_load_agrees_with_johnson_kendall_roberts(silicon):
    radius = dimensional.jkr_fold(silicon) * np.geomspace(1.001, 300.0, 200)
    tip = asperity_of(silicon)
    got = asperity_load(dimensional.jkr_displacement(radius, silicon), tip)
    want = dimensional.jkr_force(radius, silicon)
    # Near the fold a displacement rounded to 1e-16 fixes the radius no better than 1e-16 over its distance, 5e-4.
    assert got == pytest.approx(want, rel=1e-12, abs=5e-12 * tip.pull_off)


@pytest.mark.parametrize("depth", [1e4, 1e6, 1e8])
def test_deep_compression_is_hertz(depth):
    # JKR falls short of Hertz by the share 2 (3/depth)^(3/4) to leading order (expand both in t).
    hertz = depth**1.5 / math.sqrt(3)
    assert 1 - jkr.jkr_load(depth) / hertz == pytest.approx(0.0, abs=4 * (3 / depth) ** 0.75)
    assert jkr.jkr_load(depth) < hertz


@given(st.floats(min_value=-0.999, max_value=1e4))
def test_slope_is_the_derivative_of_load(d):
    step = 1e-5 * (1 + d)
    difference = (jkr.jkr_load(d + step) - jkr.jkr_load(d - step)) / (2 * step)
    # The difference's own error: third derivative times step^2 (1e-10 relative), rounding 1e-16 * load / step.
    assert jkr.jkr_slope(d) == pytest.approx(float(difference), rel=1e-7, abs=1e-8)


def test_out_of_reach_and_extremes():
    assert jkr.jkr_load([-1.0 - 1e-12, -3.0, -np.inf]).tolist() == [0.0, 0.0, 0.0]
    assert jkr.jkr_slope([-2.0, -1.0]).tolist() == [0.0, -np.inf]
    assert jkr.jkr_load(np.inf) == np.inf
    assert jkr.jkr_slope(np.inf) == np.inf
    assert np.isnan(jkr.jkr_load(np.nan))
    assert jkr.jkr_load(np.zeros((2, 3))).shape == (2, 3)


@given(st.floats(min_value=1e-4, max_value=30.0), st.floats(min_value=-0.999, max_value=100.0))
def test_energy_is_the_integral_of_the_load(limit, share):
    law = jkr.Jkr(limit)
    # the inherited quadrature, which knows nothing of the polynomials: 48 nodes in sqrt(1 + displacement)
    inherited = AsperityLaw.energy(law, share * limit)
    size = law.pull_off * limit * (1 + abs(share)) ** 2.5
    assert law.energy(share * limit) == pytest.approx(float(inherited), rel=0, abs=1e-11 * size)
    assert law.loss == pytest.approx(-float(law.energy(0.0)), rel=1e-14, abs=0)


def test_quadrature_of_the_law_is_the_load_over_the_displacement():
    law, rule = jkr.Jkr(0.3), np.polynomial.legendre.leggauss(24)
    for low, high in ((-0.3, 0.0), (-0.1, 0.4), (0.0, 2.0)):
        place, weight = law.nodes(low, high, *rule)
        other, inherited = AsperityLaw.nodes(law, low, high, *np.polynomial.legendre.leggauss(60))
        assert np.all((place >= low) & (place <= high))
        assert weight @ np.cos(place) == pytest.approx(inherited @ np.cos(other), rel=1e-12, abs=0)
