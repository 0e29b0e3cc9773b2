"""Load that yields a tip, and the load of the highest asperity beside drawn surfaces."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.contact.asperity_statistics import expected_asperities
from gearidae.contact.line import line_force
from gearidae.contact.yielding import HARDNESS, highest_load, yield_load

SURFACE = gd.preset("teodorescu2009").surface
RADIUS, WIDTH = 10e-6, 2e-6


@pytest.mark.parametrize(("radius", "load"), [(450e-9, 46.7e-6), (160e-9, 5.90e-6)])
def test_yield_load(radius, load):
    """Three digits that were given for silicon of 12 GPa."""
    surface = SURFACE.model_copy(update={"asperity_radius": radius})
    assert yield_load(surface) == pytest.approx(load, rel=1e-3, abs=0)


def test_at_the_yield_load_the_pressure_of_hertz_is_1_6_yield_stresses():
    """Hertz, p0 = (6 P E*^2 / (pi^3 R^2))^(1/3), by way of the contact radius: p0 = 3 P / (2 pi a^2)."""
    load = yield_load(SURFACE)
    modulus = 161e9 / (2.0 * (1.0 - 0.23**2))
    contact = (0.75 * load * 450e-9 / modulus) ** (1.0 / 3.0)
    assert 1.5 * load / (math.pi * contact**2) == pytest.approx(1.6 * HARDNESS / 2.8, rel=1e-12)
    assert yield_load(SURFACE, 2.0 * HARDNESS) == pytest.approx(8.0 * load, rel=1e-12)


def drawn_highest(gap, rng):
    """Load of the highest of the asperities of one drawn line contact, Hertz's law."""
    half = math.sqrt(2.0 * RADIUS * 12.0 * SURFACE.roughness)  # beyond, the gap is 12 roughnesses wider
    count = rng.poisson(SURFACE.asperity_density * 2.0 * half * WIDTH)
    place = rng.uniform(-half, half, count)
    pressed = SURFACE.roughness * rng.standard_normal(count) - gap - place**2 / (2.0 * RADIUS)
    modulus = 161e9 / (2.0 * (1.0 - 0.23**2))
    return 4.0 / 3.0 * modulus * math.sqrt(450e-9) * max(pressed.max(), 0.0) ** 1.5


@pytest.mark.parametrize("gap", [-6e-9, 6e-9])
def test_the_highest_asperity_is_the_characteristic_one_of_drawn_surfaces(gap):
    """One is expected beyond the characteristic largest value: a share of exp(-1) of the surfaces stays below it.

    2000 surfaces: the standard deviation of the share is 0.011.
    """
    rng = np.random.default_rng(1)
    force = float(line_force(gap, 0.0, RADIUS, WIDTH, SURFACE, "hertz"))
    load = highest_load(gap, force, [(SURFACE, 1.0, 0.0)], (RADIUS, WIDTH), "hertz")
    below = np.mean([drawn_highest(gap, rng) < load for _ in range(2000)])
    assert below == pytest.approx(math.exp(-1.0), abs=4 * 0.011)


def test_where_less_than_one_is_expected_one_carries_all():
    gap = 24e-9
    assert float(expected_asperities(gap, RADIUS, WIDTH, SURFACE)) < 1.0
    assert highest_load(gap, 3e-7, [(SURFACE, 1.0, 0.0)], (RADIUS, WIDTH), "jkr") == 3e-7


def test_materials_with_shares_are_parts_of_one_surface():
    whole = highest_load(0.0, 1e-4, [(SURFACE, 1.0, 0.0)], (RADIUS, WIDTH), "hertz")
    halves = highest_load(0.0, 1e-4, [(SURFACE, 0.5, 0.0)] * 2, (RADIUS, 2.0 * WIDTH), "hertz")
    assert halves == pytest.approx(whole, rel=1e-9)
    recessed = highest_load(0.0, 1e-4, [(SURFACE, 1.0, 6e-9)], (RADIUS, WIDTH), "hertz")
    assert recessed < whole
