"""Estimates against closed forms, and against what the simulation does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

import gearidae as gd
from gearidae.asperities.tip import asperity_of
from gearidae.contact import line_force
from gearidae.contact.psi import psi
from gearidae.mesh.involute import curvature_radii
from gearidae.runs.equilibrium import natural_frequency
from gearidae.runs.estimates import effective_mass, resting_gap, steady_speed
from gearidae.runs.rubbing import flank_coefficient

LOW = gd.preset("teodorescu2009_low_speed")
HIGH = gd.preset("teodorescu2009")


def test_steady_speeds_of_the_paper():
    assert steady_speed(LOW) == pytest.approx(1.5, rel=1e-12, abs=0)  # the torque was chosen for it
    assert steady_speed(HIGH) == pytest.approx(math.sqrt((4 * 2.43e-11 - 3e-11) / 8e-18), rel=1e-12, abs=0)
    assert steady_speed(HIGH.replace({"drive.torque": 7e-12})) == 0.0
    assert steady_speed(LOW.replace({"load.drag": 0.0})) == math.inf


def test_scheduled_torques_count_with_their_mean():
    """0 to 24.3 pN m in a fifth of the run, the rest at 24.3: 0.9 of it; the estimate samples 4001 times."""
    start_up = gd.preset("start_up")
    speed = math.sqrt((4 * 0.9 * 2.43e-11 - 3e-11) / 8e-18)
    assert steady_speed(start_up) == pytest.approx(speed, rel=1e-3, abs=0)
    constant = start_up.replace({"drive.torque": 0.9 * 2.43e-11, "drive.schedule": None})
    assert resting_gap(start_up) == pytest.approx(resting_gap(constant), rel=1e-3, abs=0)
    assert natural_frequency(start_up) == pytest.approx(natural_frequency(constant), rel=1e-3, abs=0)
    loaded = HIGH.replace({"load.torque": 0.0, "load.schedule": [[0.0, 0.0], [1e-3, 6e-11]]})
    assert steady_speed(loaded) == pytest.approx(steady_speed(HIGH), rel=1e-3, abs=0)


@pytest.mark.parametrize(("coefficient", "speed"), [(0.1, 2867.67), (0.3, 2805.45)])
def test_steady_speed_with_friction_of_the_flanks(coefficient, speed):
    """By a separate program, to the digits it printed."""
    assert steady_speed(HIGH.replace({"contact.friction": coefficient})) == pytest.approx(speed, abs=5.1e-3)


def test_steady_speed_with_friction_of_the_hubs():
    """M2 = M1 (R2 - mu r_h2) / (R1 + mu r_h1); a drive that holds a speed gives the same torque at the same speed."""
    hubs = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}
    ratio = (138.86 - 0.3 * 6) / (34.715 + 0.3 * 3)
    wanted = math.sqrt((ratio * 2.43e-11 - 3e-11) / 8e-18)
    assert steady_speed(HIGH.replace(hubs)) == pytest.approx(wanted, rel=1e-12, abs=0)
    held = hubs | {
        "drive.torque": 0.0,
        "drive.speed": 4.0 * wanted + 2.43e-11 / 1e-14,
        "drive.speed_gain": 1e-14,
    }
    assert steady_speed(HIGH.replace(held)) == pytest.approx(wanted, rel=1e-9, abs=0)


def test_coefficients_of_two_materials_count_with_the_forces_that_they_carry():
    """At one gap, by the readable force law; where both have the same, it is that."""
    worn = HIGH.replace({"coating.sam_fraction": 0.3, "contact.friction": 0.4, "coating.friction": 0.1})
    radius = float(curvature_radii(worn.geometry, worn.geometry.approach)[2])
    coated, bare = (
        share * float(line_force(resting_gap(worn), 0.0, radius, worn.gears.face_width, surface))
        for share, surface in ((0.3, worn.coated_surface), (0.7, worn.surface))
    )
    wanted = (0.1 * coated + 0.4 * bare) / (coated + bare)
    load = 2.43e-11 / worn.gears.pinion_base_radius
    # the difference of large forces carries the load, see above
    assert flank_coefficient(worn, load) == pytest.approx(wanted, rel=1e-5)
    assert flank_coefficient(worn.replace({"coating.friction": 0.4}), load) == 0.4
    assert flank_coefficient(HIGH, load) == 0.0


def test_shear_strength_over_pressure():
    """Strength times area over force: of asperities without adhesion, both integrals of powers of the overlap."""
    scene = HIGH.replace(
        {"contact.asperity": "hertz", "contact.friction_law": "shear", "contact.shear_strength": 1e7}
    )
    load, sigma, tip = 7e-7, 6e-9, asperity_of(scene.surface)
    gap = resting_gap(scene) / sigma

    def moment(power):
        return quad(lambda x: x**power * psi(np.array(gap + x)), 0.0, 12.0, epsrel=1e-10)[0]

    area = math.pi * tip.radius * sigma * moment(1.0)
    force = tip.hertz_factor * sigma**1.5 * moment(1.5)
    assert flank_coefficient(scene, load) == pytest.approx(1e7 * area / force, rel=1e-3)
    assert math.isnan(flank_coefficient(scene, 0.0))


def test_effective_mass():
    assert effective_mass(HIGH) == pytest.approx(2.53e-12, rel=2e-3, abs=0)  # rounded figure


@pytest.mark.parametrize("fraction", [1.0, 0.5, 0.0])
def test_at_the_resting_gap_the_tooth_carries_the_drive(fraction):
    scene = LOW.replace({"coating.sam_fraction": fraction})
    radius = float(curvature_radii(scene.geometry, scene.geometry.approach)[2])
    gap = resting_gap(scene)
    carried = sum(
        share * line_force(gap, 0.0, radius, scene.gears.face_width, surface)
        for share, surface in ((fraction, scene.coated_surface), (1.0 - fraction, scene.surface))
    )
    # The load is the difference of what pushes and what pulls: some millionths of either on bare silicon, and those
    # are good to 1e-12.
    assert float(carried) == pytest.approx(
        scene.drive.torque / scene.gears.pinion_base_radius, rel=1e-5, abs=0
    )


def ringing(fraction):
    """Frequency of the last of the start-up's oscillations, small by then, with two pairs in mesh."""
    scene = LOW.replace({"coating.sam_fraction": fraction})
    ds = gd.simulate(scene, t_end=0.02, samples=20_001).isel(time=slice(15_000, None))
    swing = ds.gear_speed.values - ds.gear_speed.values.mean()
    crossings = np.flatnonzero((swing[:-1] < 0.0) & (swing[1:] >= 0.0))
    return (len(crossings) - 1) / (ds.time.values[crossings[-1]] - ds.time.values[crossings[0]])


def test_natural_frequency_is_that_of_the_simulated_ringing():
    """In the far tail the stiffness is nearly proportional to the load, so two pairs that share it ring like one.

    The first impacts have joined a few asperities more than touch at rest: a few per cent. The paper reads 1301 Hz.
    """
    assert natural_frequency(LOW) == pytest.approx(ringing(1.0), rel=0.05, abs=0)
    assert natural_frequency(LOW) == pytest.approx(1301.0, rel=0.05, abs=0)


def test_worn_teeth_ring_faster_than_those_that_were_never_pressed():
    estimates = [natural_frequency(LOW.replace({"coating.sam_fraction": f})) for f in (1.0, 0.8, 0.6, 0.5)]
    assert sorted(estimates) == estimates
    for estimate, fraction in zip(estimates[1:], (0.8, 0.6, 0.5), strict=True):
        assert 1.0 < ringing(fraction) / estimate < 2.0


def test_nothing_rests_without_a_drive():
    idle = LOW.replace({"drive.torque": 0.0})
    assert math.isnan(resting_gap(idle))
    assert math.isnan(natural_frequency(idle))
    assert math.isnan(resting_gap(LOW.replace({"drive.torque": 1.0})))  # would crush the teeth


def test_hertzian_asperities_close_the_gap():
    """Without adhesion the far tail is all repulsion: the resting gap is larger than with it."""
    assert resting_gap(LOW.replace({"contact.asperity": "hertz"})) > resting_gap(LOW)


@pytest.mark.parametrize("estimate", [effective_mass, steady_speed, resting_gap, natural_frequency])
def test_a_roller_has_none_of_these(estimate):
    with pytest.raises(gd.SceneError, match="must be a scene with gears"):
        estimate(gd.preset("roller_slow"))
