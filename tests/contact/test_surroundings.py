"""Heat and air: equipartition, Reynolds' equation solved by quadrature, and a disc summed ring by ring."""

from __future__ import annotations

import math

import pytest
from scipy import integrate

from gearidae.contact.surroundings import (
    AIR_MEAN_FREE_PATH,
    AIR_VISCOSITY,
    disc_drag,
    film_damping,
    thermal_amplitude,
)


def test_thermal_energy_is_shared_equally():
    """Half a spring's k x^2 is half of kB T: 2.07e-21 J at 300 K."""
    assert 0.5 * 142e-6 * thermal_amplitude(142e-6) ** 2 == pytest.approx(2.071e-21, rel=1e-3, abs=0)
    assert thermal_amplitude(142e-6, 75.0) == pytest.approx(0.5 * thermal_amplitude(142e-6), rel=1e-12, abs=0)
    assert thermal_amplitude(0.0) == math.inf


def test_a_thick_film_obeys_reynolds_equation():
    """``(H^3 p')' = -12 mu v`` with H = h + x^2/2R gives p' = -12 mu v x/H^3 and the force integral of p."""
    gap, radius, width = 100e-6, 0.1, 1e-3  # a thousand mean free paths: what rarefaction does is below 1 %

    def pressure_times_length(x):
        return -12.0 * AIR_VISCOSITY * x / (gap + x**2 / (2.0 * radius)) ** 3 * -x  # by parts

    reach = 60.0 * math.sqrt(2.0 * radius * gap)
    force = 2.0 * width * integrate.quad(pressure_times_length, 0.0, reach, limit=400)[0]
    slip = 1.0 + 9.638 * (AIR_MEAN_FREE_PATH / gap) ** 1.159
    assert slip < 1.01
    # what lies beyond the range of the quadrature falls with its third power
    assert film_damping(gap, radius, width) * slip == pytest.approx(force, rel=1e-4, abs=0)


def test_rarefied_air_damps_less_than_a_continuum_would():
    thin, radius, width = 36e-9, 1e-5, 2e-6
    continuum = 3.0 * math.sqrt(2.0) * math.pi * AIR_VISCOSITY * width * (radius / thin) ** 1.5
    assert 0.04 < film_damping(thin, radius, width) / continuum < 0.06  # Kn = 1.9: about 1/21


def test_a_disc_drags_as_its_rings_do():
    """Each ring feels the shear ``mu r w / d`` on its area ``2 pi r dr`` at the arm r."""
    radius, speed, distance = 139e-6, 1.5, 2e-6
    torque, _ = integrate.quad(
        lambda r: AIR_VISCOSITY * r * speed / distance * 2.0 * math.pi * r * r, 0.0, radius, epsabs=0.0
    )
    assert disc_drag(radius, speed, distance) == pytest.approx(torque, rel=1e-12, abs=0)
