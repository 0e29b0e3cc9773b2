import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy import integrate, optimize, special

from gearidae.asperities.jkr import JOINING
from gearidae.asperities.tip import asperity_of
from gearidae.contact.rough import (
    adhesion_loss_per_asperity,
    maximum_tension,
    rough_pressure,
    rough_pressure_slopes,
)
from gearidae.errors import SceneError
from reference import heights as brute


def smoothed(surface, stretch_limit_in_roughnesses):
    """Return the surface with the roughness that makes its stretch limit this many roughnesses."""
    return replace(surface, roughness=asperity_of(surface).stretch_limit / stretch_limit_in_roughnesses)


@pytest.mark.parametrize("limit", [1e-4, 0.01, 0.22, 1.0, 10.0, 100.0])
@pytest.mark.parametrize("height", [-50.0, -9.4, -3.0, 0.0, 2.0, 5.0, 8.0, 12.0])
def test_pressure_against_brute_force(silicon, limit, height):
    surface = smoothed(silicon, limit)
    sigma, reach = surface.roughness, asperity_of(surface).stretch_limit
    for stretch in (0.0, 0.4 * reach, reach):
        want, scale = brute.pressure(height * sigma, stretch, surface)
        # 1e-12 is what is promised; the brute force itself rounds its displacements to 1e-16 of a few stretch limits,
        # which the density multiplies by H.
        tolerance = 1e-12 + 2e-15 * limit * abs(height)
        got = rough_pressure(height * sigma, stretch, surface)
        assert got == pytest.approx(want, rel=0, abs=tolerance * scale)


@pytest.mark.parametrize("height", [-30.0, -5.0, 0.0, 3.0, 12.0])
def test_hertz_and_dmt_closed_forms(silicon, height):
    tip = asperity_of(silicon)
    unit = silicon.asperity_density * tip.hertz_factor * silicon.roughness**1.5
    with mpmath.workdps(30):
        moment = math.gamma(2.5) * float(
            mpmath.exp(-(mpmath.mpf(height) ** 2) / 4)
            * mpmath.pcfd(-2.5, height)
            / mpmath.sqrt(2 * mpmath.pi)
        )
    hertz = rough_pressure(height * silicon.roughness, 0.0, silicon, "hertz")
    assert hertz == pytest.approx(unit * moment, rel=2e-13, abs=0)
    joined = special.ndtr(-height) * silicon.asperity_density * 4 / 3 * tip.pull_off
    dmt = rough_pressure(height * silicon.roughness, 0.0, silicon, "dmt")
    assert dmt == pytest.approx(float(hertz) - joined, rel=0, abs=1e-12 * (float(hertz) + joined))
    no_energy = replace(silicon, energy=0.0)
    assert rough_pressure(height * silicon.roughness, 1e-9, no_energy) == pytest.approx(
        float(hertz), rel=1e-14, abs=0
    )


# 1/Dc, parting, approaching: largest tension over N P_c. Printed with four digits from a scan in steps of 0.05
# roughnesses, which misses the valley's floor by up to 2e-4; the last figures are this module's own, confirmed by
# `test_tension_agrees_with_adaptive_quadrature`.
PRINTED = [
    (0.1, 0.9938, 0.7691),
    (0.5, 0.8123, 0.4056),
    (1.0, 0.5045, 0.1554),
    (1.5, 0.2809, 0.0501),
    (2.0, 0.1440, 0.0135),
    (3.0, 0.0299, 0.0006),
    (4.0, 0.0046, 1e-5),
    (5.0, 0.0005, 0.0),
]


@pytest.mark.parametrize(("roughness", "parting", "approaching"), PRINTED)
def test_table_of_maximum_tension(silicon, roughness, parting, approaching):
    surface = smoothed(silicon, 1 / roughness)
    unit = silicon.asperity_density * asperity_of(silicon).pull_off
    for motion, stretch, printed in (("parting", math.inf, parting), ("approaching", 0.0, approaching)):
        maximum = maximum_tension(surface, motion=motion)
        assert 0.0 <= maximum.tension / unit - printed + 5e-5 < 2.5e-4
        grid = np.arange(-4.0, 12.0, 0.05) * surface.roughness
        scanned = -rough_pressure(grid, stretch, surface).min() / unit
        assert scanned == pytest.approx(printed, abs=5.1e-5)
        assert -rough_pressure(maximum.gap, stretch, surface) == pytest.approx(
            maximum.tension, rel=1e-12, abs=0
        )


@pytest.mark.parametrize(
    ("limit", "parting", "approaching"), [(2.0, 0.81231121, 0.40572055), (1.0, 0.50465069, 0.15543385)]
)
def test_tension_agrees_with_adaptive_quadrature(silicon, limit, parting, approaching):
    # The paper's own scaled polynomials, scipy's adaptive rule and its minimiser.
    def pressure(height, start):
        def integrand(s):
            delta = limit * (12 ** (1 / 3) * s**4 - 4 / 3 * 18 ** (1 / 6) * s)
            rate = limit * (4 * 12 ** (1 / 3) * s**3 - 4 / 3 * 18 ** (1 / 6))
            return (
                2
                * (s**6 - math.sqrt(2) * s**3)
                * rate
                * math.exp(-0.5 * (height + delta) ** 2)
                / math.sqrt(2 * math.pi)
            )

        return integrate.quad(integrand, start, 6.0, epsabs=1e-12)[0]

    for start, want in (((1 / 18) ** (1 / 6), parting), ((8 / 9) ** (1 / 6), approaching)):
        lowest = optimize.minimize_scalar(
            lambda height, start=start: pressure(height, start), bounds=(-2, 5)
        ).fun
        assert -lowest == pytest.approx(want, abs=1e-8)
    surface = smoothed(silicon, limit)
    unit = silicon.asperity_density * asperity_of(silicon).pull_off
    assert maximum_tension(surface).tension == pytest.approx(parting * unit, rel=2e-8, abs=0)
    assert maximum_tension(surface, motion="approaching").tension == pytest.approx(
        approaching * unit, rel=2e-8, abs=0
    )


def test_very_rough_or_unadhesive_surfaces_never_pull(silicon):
    assert maximum_tension(silicon, "hertz").tension == 0.0
    assert maximum_tension(replace(silicon, energy=0.0)).tension == 0.0
    rough = maximum_tension(smoothed(silicon, 1 / 60), motion="approaching")
    assert rough.tension == 0.0
    assert math.isnan(rough.gap)


def test_adhesion_loss_is_the_work_of_stretching(silicon):
    tip = asperity_of(silicon)
    t = np.polynomial.Polynomial
    load, displacement = t([0, 0, 0, -6, 0, 0, 1]) / 9, t([0, -4, 0, 0, 1]) / 3
    work = (load * displacement.deriv()).integ()
    assert -(work(4 ** (1 / 3)) - work(1.0)) == pytest.approx(JOINING, rel=1e-15, abs=0)
    assert pytest.approx(0.93550, abs=5e-6) == JOINING
    assert adhesion_loss_per_asperity(silicon) == pytest.approx(
        JOINING * tip.pull_off * tip.stretch_limit, rel=1e-12, abs=0
    )


@pytest.mark.parametrize("lowest", [-1.0, 1.5])
def test_closed_loop_loses_what_its_asperities_lose(silicon, lowest):
    sigma, reach = silicon.roughness, asperity_of(silicon).stretch_limit
    bottom = lowest * sigma

    def lost(gap):
        stretch = min(gap - bottom, reach)
        return float(rough_pressure(gap, 0.0, silicon) - rough_pressure(gap, stretch, silicon))

    loop = integrate.quad(lost, bottom, bottom + reach, epsrel=1e-10)[0]
    loop += integrate.quad(lost, bottom + reach, 14 * sigma, epsrel=1e-10)[0]
    joined = silicon.asperity_density * special.ndtr(-lowest)
    # Limited by scipy's rule on the root of the stretch at the fold.
    assert loop == pytest.approx(adhesion_loss_per_asperity(silicon) * joined, rel=1e-7, abs=0)


@pytest.mark.parametrize("law", ["jkr", "dmt", "hertz"])
def test_slopes_are_derivatives(silicon, law):
    h, S = np.meshgrid(np.linspace(-2, 7, 7) * 6e-9, np.array([0.1, 0.5, 0.9]) * 1.3265e-9)
    by_gap, by_stretch = rough_pressure_slopes(h, S, silicon, law)
    step = 1e-13
    gap_difference = (
        rough_pressure(h + step, S, silicon, law) - rough_pressure(h - step, S, silicon, law)
    ) / (2 * step)
    stretch_difference = (
        rough_pressure(h, S + step, silicon, law) - rough_pressure(h, S - step, silicon, law)
    ) / (2 * step)
    # Rounding over the step: 1e-15 * p / 1e-13 m against slopes of p / 6e-9 m, times ten near sign changes.
    assert gap_difference == pytest.approx(by_gap, rel=1e-6, abs=1e-6 * np.abs(by_gap).max())
    scale = np.abs(rough_pressure(h, 0.0, silicon, law)).max()
    assert stretch_difference == pytest.approx(by_stretch, rel=1e-5, abs=1e-15 * scale / step)


def test_stretch_counts_up_to_its_limit(silicon):
    gap = np.linspace(0.0, 40e-9, 5)
    limit = asperity_of(silicon).stretch_limit
    assert np.array_equal(rough_pressure(gap, np.inf, silicon), rough_pressure(gap, limit, silicon))
    assert np.array_equal(
        rough_pressure(gap, np.inf, silicon, "dmt"), rough_pressure(gap, 0.0, silicon, "dmt")
    )
    assert np.all(rough_pressure(gap, limit, silicon) < rough_pressure(gap, 0.0, silicon))


def test_shapes_broadcast(silicon):
    assert rough_pressure(np.zeros((3, 1)), np.zeros(4), silicon).shape == (3, 4)
    assert rough_pressure(0.0, 0.0, silicon).shape == ()
    many = np.linspace(-50e-9, 50e-9, 9000)  # more than one chunk
    assert rough_pressure(many, 0.0, silicon)[::1000] == pytest.approx(
        rough_pressure(many[::1000], 0.0, silicon)
    )


@pytest.mark.parametrize(
    ("change", "gap", "stretch", "law", "key"),
    [
        ({}, np.nan, 0.0, "jkr", "gap = nan"),
        ({}, -np.inf, 0.0, "jkr", "gap = -inf"),
        ({}, 0.0, -1e-12, "jkr", "stretch = -1e-12"),
        ({}, 0.0, np.nan, "jkr", "stretch = nan"),
        ({}, 0.0, 0.0, "sphere", r"contact\.asperity = sphere"),
        ({"roughness": 0.0}, 0.0, 0.0, "jkr", r"surface\.roughness = 0\.0"),
        ({"energy": -0.1}, 0.0, 0.0, "jkr", r"surface\.energy = -0\.1"),
        ({"asperity_density": np.inf}, 0.0, 0.0, "jkr", r"surface\.asperity_density = inf"),
    ],
)
def test_bad_input_is_named(silicon, change, gap, stretch, law, key):
    with pytest.raises(SceneError, match=key):
        rough_pressure(gap, stretch, replace(silicon, **change), law)
