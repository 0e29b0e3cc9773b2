"""Counts of asperities against quadrature, and the numbers of silicon in Teodorescu et al. (2009)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, stats

from gearidae.asperities.jkr import jkr_root
from gearidae.asperities.tip import asperity_of
from gearidae.contact.asperity_statistics import (
    density_product,
    expected_asperities,
    half_spacing,
    zero_load_radius,
)
from reference.surface import PlainSurface

RADIUS, WIDTH = 1.01e-5, 2e-6
SILICON = PlainSurface()


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
    found = expected_asperities(gap * sigma, RADIUS, WIDTH, SILICON)
    assert float(found) == pytest.approx(wanted, rel=1e-8, abs=0)  # the quadrature's own error


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
