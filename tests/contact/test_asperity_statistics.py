"""Counts of asperities against quadrature, and the numbers of silicon in Teodorescu et al. (2009)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, stats

from gearidae.asperities import law_of
from gearidae.asperities.jkr import jkr_root
from gearidae.asperities.tip import asperity_of
from gearidae.contact.asperity_statistics import (
    asperities_for_mean,
    density_product,
    expected_asperities,
    half_spacing,
    mean_square_position,
    zero_load_radius,
)
from gearidae.contact.psi import psi
from reference.surface import PlainSurface

RADIUS, WIDTH = 1.01e-5, 2e-6
SILICON = PlainSurface()


@pytest.mark.parametrize(
    ("energy", "gap", "kappa"), [(0.1, 2.0, 1.726), (1.5, 2.0, 3.020), (1.5, 3.0, 6.143)]
)
def test_scatter_of_the_force_of_one_pair(energy, gap, kappa):
    """As an independent program found it, to the digits it printed."""
    surface = PlainSurface(energy=energy)
    needed = asperities_for_mean(gap * surface.roughness, [(surface, 1.0, 0.0)], "jkr")
    assert math.sqrt(needed) / 10.0 == pytest.approx(kappa, abs=5.1e-4)


@pytest.mark.parametrize("law", ["jkr", "hertz", "dmt", "maugis"])
@pytest.mark.parametrize("gap", [-20.0, -3.0, 1.0, 4.0])
def test_scatter_by_quadrature(law, gap):
    """Two materials, one of them farther apart; the tolerance is that of the one panel of the quadrature."""
    sigma, moments = SILICON.roughness, np.zeros(3)
    parts = [(SILICON, 0.3, 0.5 * sigma), (PlainSurface(energy=0.1), 0.7, 0.0)]
    for surface, share, offset in parts:
        single = law_of(law, surface)
        top = 12.0 + max(-gap, 0.0)

        def moment(power, single=single, at=gap + offset / sigma, top=top):
            return integrate.quad(
                lambda r: (
                    2.0 * r * float(single.load(r * r - single.join) ** power * psi(at + r * r - single.join))
                ),
                *(1e-9, math.sqrt(top + single.join)),
                epsabs=0.0,
                epsrel=1e-9,
                limit=400,
            )[0]

        unit = asperity_of(surface).hertz_factor
        moments += share * np.array([moment(0), unit * moment(1), unit**2 * moment(2)])
    wanted = 100.0 * moments[0] * moments[2] / moments[1] ** 2
    assert asperities_for_mean(gap * sigma, parts, law) == pytest.approx(wanted, rel=1e-5, abs=0)


def test_drawn_surfaces_scatter_as_much():
    """Forces of a thousand surfaces, 300 asperities each in contact: the deviation of a tenth to its own 7 %."""
    rng = np.random.default_rng(3)
    surface = PlainSurface(energy=0.1)
    sigma, law = surface.roughness, law_of("jkr", surface)
    half = math.sqrt(8.0)  # of the strip, in sqrt(2 R sigma); beyond it none reaches the gap of 2 roughnesses
    count = float(expected_asperities(2.0 * sigma, 0.5 / sigma, 1.0, surface)) / surface.asperity_density
    needed = asperities_for_mean(2.0 * sigma, [(surface, 1.0, 0.0)], "jkr")
    forces = []
    for number in rng.poisson(needed / count * 2.0 * half, 1000):
        place, height = half * rng.uniform(-1.0, 1.0, number), rng.standard_normal(number)
        depth = height - 2.0 - place**2
        forces.append(law.load(depth[depth > 0.0]).sum())
    assert np.std(forces) / np.mean(forces) == pytest.approx(0.1, rel=0.07, abs=0)


@pytest.mark.parametrize("gap", [-6.0, 0.0, 2.0, 6.0, 9.0])
def test_places_of_the_asperities_in_contact(gap):
    sigma = SILICON.roughness
    end = math.sqrt(40.0 - gap)

    def moment(power):
        return integrate.quad(
            lambda s: s**power * stats.norm.sf(gap + s * s),
            0.0,
            end,
            epsabs=0.0,
            epsrel=1e-10,
            points=[end / 8],
            limit=400,
        )[0]

    wanted = 2.0 * RADIUS * sigma * moment(2) / moment(0)
    assert mean_square_position(gap * sigma, RADIUS, SILICON) == pytest.approx(wanted, rel=1e-7, abs=0)


@pytest.mark.parametrize("gap", [-6.0, -1.0, 0.0, 1.0, 3.0, 6.0, 9.0])
def test_as_many_as_stand_higher_than_the_gap(gap):
    """Each strip of the contact has N dA of them, of which the normal tail above its own gap touches."""
    sigma = SILICON.roughness

    def above(x):
        return stats.norm.sf(gap + x**2 / (2.0 * RADIUS * sigma))

    half = math.sqrt(2.0 * RADIUS * sigma * (40.0 - gap))
    strip, _ = integrate.quad(
        above, 0.0, half, epsabs=0.0, epsrel=1e-10, points=[half / 8, half / 3], limit=400
    )
    wanted = 2.0 * SILICON.asperity_density * WIDTH * strip
    count = expected_asperities(gap * sigma, RADIUS, WIDTH, SILICON)
    assert float(count) == pytest.approx(wanted, rel=1e-8, abs=0)  # the quadrature's own error


def test_fewer_at_wider_gaps_and_none_far_away():
    counts = expected_asperities(np.linspace(-8.0, 45.0, 400) * SILICON.roughness, RADIUS, WIDTH, SILICON)
    assert np.all(counts >= 0.0)
    assert np.all(np.diff(counts[counts > 1e-250]) < 0.0)
    assert counts[-1] == 0.0


def test_silicon_is_dense_and_its_contacts_merge():
    assert density_product(SILICON) == pytest.approx(0.456, abs=5e-4)  # to the digits printed
    assert zero_load_radius(SILICON) == pytest.approx(46.6e-9, abs=5e-11)
    assert half_spacing(SILICON) == pytest.approx(38.5e-9, abs=5e-11)


def test_the_radius_without_load_is_the_asperity_laws_own():
    """JKR's load ``2 (s^6 - sqrt(2) s^3)`` is zero at s^3 = sqrt(2), where a^3 = s^6 of the unit of contact radii.

    That unit follows from the Hertz limit, a^2 = beta delta in deep compression.
    """
    tip = asperity_of(SILICON)
    deep = 1e8
    unit = math.sqrt(tip.radius * deep * tip.stretch_limit) / float(jkr_root(deep)) ** 2
    assert zero_load_radius(SILICON) == pytest.approx(unit * math.sqrt(2.0) ** (2.0 / 3.0), rel=1e-5, abs=0)
