import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from scipy import integrate, special

from gearidae.asperities.tip import asperity_of
from gearidae.contact.line import line_force
from gearidae.contact.rough import adhesion_loss_per_asperity, rough_pressure
from gearidae.errors import SceneError
from reference import heights as brute

R, L = 5e-6, 2e-6


@pytest.mark.parametrize("height", [-300.0, -60.0, -9.4, -1.0, 2.0, 7.0, 12.0])
def test_hertzian_asperities_have_a_closed_form(silicon, height):
    # The convolution of Delta^(3/2) with the parabola's x^(-1/2) is (3 pi / 8) w^2: the truncated second moment.
    unit = L * math.sqrt(2 * R * silicon.roughness) * silicon.asperity_density
    unit *= asperity_of(silicon).hertz_factor * silicon.roughness**1.5
    with mpmath.workdps(60):
        G = mpmath.mpf(height)
        moment = 3 * mpmath.pi / 8 * ((1 + G**2) * mpmath.ncdf(-G) - G * mpmath.npdf(G))
    got = line_force(height * silicon.roughness, 0.0, R, L, silicon, "hertz")
    assert got == pytest.approx(unit * float(moment), rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("height", "limit"), [(-20.0, 0.22), (0.0, 0.22), (5.5, 0.22), (3.0, 2.0), (12.0, 0.01)]
)
def test_force_is_the_pressure_added_up_along_the_contact(silicon, height, limit):
    surface = replace(silicon, roughness=asperity_of(silicon).stretch_limit / limit)
    for stretch in (0.0, 0.7 * asperity_of(silicon).stretch_limit):
        want, scale = brute.line(height * surface.roughness, stretch, R, L, surface)
        got = line_force(height * surface.roughness, stretch, R, L, surface)
        assert got == pytest.approx(
            want, rel=0, abs=3e-12 * scale
        )  # the promise and the brute force's own rounding


def test_force_against_the_pressure_function(silicon):
    gap, stretch = 9e-9, 1e-9
    along, _ = integrate.quad(
        lambda x: float(rough_pressure(gap + x * x / (2 * R), stretch, silicon)) * 1e-6, 0, 1e-6, epsrel=1e-11
    )
    assert line_force(gap, stretch, R, L, silicon) == pytest.approx(2 * L * along * 1e6, rel=1e-9, abs=0)


def test_adhering_without_stretch_subtracts_the_joined_asperities(silicon):
    gap = 3e-9
    x = np.linspace(0.0, 1e-6, 20001)
    joined = integrate.simpson(special.ndtr(-(gap + x * x / (2 * R)) / silicon.roughness), x=x)
    pull = (
        2 * L * joined * silicon.asperity_density * 2 * math.pi * silicon.asperity_radius * 2 * silicon.energy
    )
    difference = line_force(gap, 0.0, R, L, silicon, "hertz") - line_force(gap, 0.0, R, L, silicon, "dmt")
    assert difference == pytest.approx(pull, rel=1e-10, abs=0)


def test_closed_loop_loses_what_its_asperities_lose(silicon):
    sigma, reach = silicon.roughness, asperity_of(silicon).stretch_limit
    bottom = 2.0 * sigma

    def lost(gap):
        stretch = min(gap - bottom, reach)
        return 1e9 * float(line_force(gap, 0.0, R, L, silicon) - line_force(gap, stretch, R, L, silicon))

    loop = integrate.quad(lost, bottom, bottom + reach, epsrel=1e-9)[0]
    loop += integrate.quad(lost, bottom + reach, 14 * sigma, epsrel=1e-9)[0]
    x = np.linspace(0.0, 1.2e-6, 20001)
    joined = 2 * L * integrate.simpson(special.ndtr(-(bottom + x * x / (2 * R)) / sigma), x=x)
    want = adhesion_loss_per_asperity(silicon) * silicon.asperity_density * joined
    assert loop * 1e-9 == pytest.approx(
        want, rel=1e-6, abs=0
    )  # the root at the fold limits the quadrature of the loop


def test_scales_with_width_and_root_of_radius(silicon):
    gap = np.linspace(-2e-8, 5e-8, 6)
    force = line_force(gap, 0.0, R, L, silicon)
    assert line_force(gap, 0.0, 4 * R, 3 * L, silicon) == pytest.approx(6 * force, rel=1e-13, abs=0)
    assert force.shape == gap.shape


@pytest.mark.parametrize(
    ("radius", "width", "key"), [(0.0, L, "radius"), (R, -1.0, "width"), (np.nan, L, "radius")]
)
def test_bad_lengths_are_named(silicon, radius, width, key):
    with pytest.raises(SceneError, match=f"{key} = .*: must be a positive number of metres"):
        line_force(0.0, 0.0, radius, width, silicon)
