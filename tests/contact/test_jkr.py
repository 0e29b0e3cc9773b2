import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.contact import jkr
from gearidae.errors import SceneError
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
    tip = jkr.asperity_of(silicon)
    got = jkr.asperity_load(dimensional.jkr_displacement(radius, silicon), tip)
    want = dimensional.jkr_force(radius, silicon)
    # Near the fold a displacement rounded to 1e-16 fixes the radius no better than 1e-16 over its distance, 5e-4.
    assert got == pytest.approx(want, rel=1e-12, abs=5e-12 * tip.pull_off)


def test_silicon_asperity(silicon):
    tip = jkr.asperity_of(silicon)
    assert tip.modulus == pytest.approx(84.996e9, rel=1e-5, abs=0)
    assert tip.pull_off == pytest.approx(1.5 * math.pi * 450e-9 * 3.0, rel=1e-15, abs=0)
    fold = dimensional.jkr_fold(silicon)
    assert tip.stretch_limit == pytest.approx(-dimensional.jkr_displacement(fold, silicon), rel=1e-13, abs=0)


def test_pull_off_is_root_three_times_hertz_at_the_stretch_limit(silicon):
    tip = jkr.asperity_of(silicon)
    assert tip.pull_off == pytest.approx(
        math.sqrt(3) * tip.hertz_factor * tip.stretch_limit**1.5, rel=1e-14, abs=0
    )


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


def test_without_energy_an_asperity_is_hertzian(silicon):
    bare = jkr.Asperity(80e9, 4e-7, 0.0, 0.0, 0.0)
    delta = np.array([-1e-9, 0.0, 1e-9, 5e-9])
    hertz = 4 / 3 * 80e9 * math.sqrt(4e-7) * np.maximum(delta, 0.0) ** 1.5
    for law in jkr.ASPERITY_LAWS:
        assert jkr.asperity_load(delta, bare, law) == pytest.approx(hertz, rel=1e-14, abs=0)


def test_dmt_adheres_without_stretching(silicon):
    tip = jkr.asperity_of(silicon)
    touch, away, deep = jkr.asperity_load([0.0, -1e-15, 1e-8], tip, "dmt")
    assert touch == pytest.approx(-2 * math.pi * 450e-9 * 3.0, rel=1e-14, abs=0)
    assert away == 0.0
    assert deep - touch == pytest.approx(float(jkr.asperity_load(1e-8, tip, "hertz")), rel=1e-13, abs=0)


def test_unknown_law_is_named(silicon):
    with pytest.raises(SceneError, match=r"contact\.asperity = maugis: must be one of jkr, dmt, hertz"):
        jkr.asperity_load(0.0, jkr.asperity_of(silicon), "maugis")


def test_tabor_parameter(silicon, coated):
    # Preset's asperity radius was chosen for mu = 5 at 0.165 nm; mu goes with energy to the power 2/3.
    assert jkr.tabor_parameter(silicon) == pytest.approx(5.0, abs=0.005)
    assert jkr.tabor_parameter(coated) == pytest.approx(5.0 / 15 ** (2 / 3), rel=1e-3, abs=0)
    assert jkr.tabor_parameter(silicon, eps=0.33e-9) == pytest.approx(jkr.tabor_parameter(silicon) / 2)


@pytest.mark.parametrize(
    ("mu", "regime"),
    [(50.0, "jkr"), (4.5, "jkr"), (4.49, "transition"), (0.15, "transition"), (0.149, "dmt"), (0.0, "dmt")],
)
def test_tabor_regime(mu, regime):
    """Bounds of one digit, 5 and 0.1 (Johnson and Greenwood 1997), told from the numbers that round to them."""
    assert jkr.tabor_regime(mu) == regime


def test_regimes_of_the_paper(silicon, coated):
    """Bare silicon is where JKR holds, to the digit that the bound has; the monolayer is not."""
    assert jkr.tabor_regime(jkr.tabor_parameter(silicon)) == "jkr"
    assert jkr.tabor_regime(jkr.tabor_parameter(coated)) == "transition"
