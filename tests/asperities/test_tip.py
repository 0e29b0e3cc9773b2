"""One tip of a rough surface: what follows from its elastic constants and energy."""

import math

import pytest

from gearidae.asperities.tip import asperity_of, tabor_parameter, tabor_regime
from reference import asperity as dimensional


def test_silicon_asperity(silicon):
    tip = asperity_of(silicon)
    assert tip.modulus == pytest.approx(84.996e9, rel=1e-5, abs=0)
    assert tip.pull_off == pytest.approx(1.5 * math.pi * 450e-9 * 3.0, rel=1e-15, abs=0)
    fold = dimensional.jkr_fold(silicon)
    assert tip.stretch_limit == pytest.approx(-dimensional.jkr_displacement(fold, silicon), rel=1e-13, abs=0)


def test_pull_off_is_root_three_times_hertz_at_the_stretch_limit(silicon):
    tip = asperity_of(silicon)
    assert tip.pull_off == pytest.approx(
        math.sqrt(3) * tip.hertz_factor * tip.stretch_limit**1.5, rel=1e-14, abs=0
    )


def test_tabor_parameter(silicon, coated):
    # Preset's asperity radius was chosen for mu = 5 at 0.165 nm; mu goes with energy to the power 2/3.
    assert tabor_parameter(silicon) == pytest.approx(5.0, abs=0.005)
    assert tabor_parameter(coated) == pytest.approx(5.0 / 15 ** (2 / 3), rel=1e-3, abs=0)
    assert tabor_parameter(silicon, eps=0.33e-9) == pytest.approx(tabor_parameter(silicon) / 2)


@pytest.mark.parametrize(
    ("mu", "regime"),
    [(50.0, "jkr"), (4.5, "jkr"), (4.49, "transition"), (0.15, "transition"), (0.149, "dmt"), (0.0, "dmt")],
)
def test_tabor_regime(mu, regime):
    """Bounds of one digit, 5 and 0.1 (Johnson and Greenwood 1997), unlike the numbers that round to them."""
    assert tabor_regime(mu) == regime


def test_regimes_of_the_paper(silicon, coated):
    """Bare silicon is where JKR holds, to the digit that the bound has; the monolayer is not."""
    assert tabor_regime(tabor_parameter(silicon)) == "jkr"
    assert tabor_regime(tabor_parameter(coated)) == "transition"
