"""Attraction across a gap: closed forms against quadrature of the pressure between planes."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import gearidae as gd
from gearidae.contact import attraction_energy, attraction_force, attraction_pressure
from gearidae.contact.attraction import FLOOR

RADIUS, WIDTH, HAMAKER = 5e-6, 2e-6, 5e-20
PAIR = (RADIUS, WIDTH, HAMAKER)


@pytest.mark.parametrize("gap", [FLOOR, 1e-9, 36e-9, 1e-6])
def test_force_is_the_pressure_added_up_along_the_opening_gap(gap):
    """With x = sqrt(2 R g) tan(a) the integrand is smooth and its range finite."""
    span = math.sqrt(2.0 * RADIUS * gap)

    def along(a):
        pressure = attraction_pressure(gap + (span * math.tan(a)) ** 2 / (2.0 * RADIUS), HAMAKER)
        return float(pressure) * span / math.cos(a) ** 2

    force = WIDTH * quad(along, -math.pi / 2, math.pi / 2, epsabs=0, epsrel=1e-12)[0]
    assert float(attraction_force(gap, *PAIR)) == pytest.approx(force, rel=1e-10, abs=0)


@pytest.mark.parametrize("gap", [FLOOR, 1e-9, 36e-9])
def test_energy_is_the_work_of_the_force_from_far_away(gap):
    """With g' = g / t^2 the integral from g to infinity runs from 0 to 1."""
    work = quad(
        lambda t: float(attraction_force(gap / t**2, *PAIR)) * 2.0 * gap / t**3, 0.0, 1.0, epsrel=1e-12
    )[0]
    assert float(attraction_energy(gap, *PAIR)) == pytest.approx(work, rel=1e-10, abs=0)


def test_below_the_floor_force_stays_and_energy_goes_on_along_its_tangent():
    gaps = np.array([FLOOR, 0.5 * FLOOR, 0.0, -3e-9])
    force, energy = attraction_force(gaps, *PAIR), attraction_energy(gaps, *PAIR)
    np.testing.assert_array_equal(force, force[0])
    np.testing.assert_array_equal(attraction_pressure(gaps, HAMAKER), attraction_pressure(FLOOR, HAMAKER))
    np.testing.assert_allclose(energy, energy[0] + force[0] * (FLOOR - gaps), rtol=1e-14)


def test_eighty_piconewtons_across_36_nm():
    """Computed by hand for the same pair, to the two digits it was given with."""
    assert float(attraction_force(36e-9, *PAIR)) == pytest.approx(-80e-12, rel=0.01, abs=0)


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ((1e-9, 0.0, 1e-6, 1e-19), "radius"),
        ((1e-9, 1e-6, -1.0, 1e-19), "width"),
        ((1e-9, 1e-6, 1e-6, -1e-19), "hamaker"),
        ((math.nan, *PAIR), "gap"),
    ],
)
def test_bad_input_is_named(arguments, key):
    for function in (attraction_force, attraction_energy):
        with pytest.raises(gd.SceneError) as caught:
            function(*arguments)
        assert caught.value.key == key
