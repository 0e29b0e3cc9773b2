"""Slow gears in heat: the script's own integrator beside the engine, and the energy that heat gives."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae_pages.heat import KELVIN, shaken, sticks

WORN = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})


@pytest.mark.by_hand  # scripts of pages change hardly ever
def test_without_heat_the_gears_are_those_of_the_engine():
    """Beyond the first mesh exit; the tabulated force is good to some thousandths in a ringing contact."""
    cold = shaken(WORN, 0.0, 0, kelvin=0.0, duration=0.06)
    run = gd.simulate(WORN.replace({"run.duration": 0.06, "run.samples": 1201, "contact.bodies": "rigid"}))
    np.testing.assert_allclose(cold.time, run.time, rtol=1e-9)
    np.testing.assert_allclose(cold.speed, run.gear_speed, atol=0.02)
    pitch = 2.0 * math.pi / 76
    np.testing.assert_allclose(cold.turned, run.gear_angle / pitch, atol=1e-4)


def test_teeth_apart_have_the_energy_of_their_temperature():
    """Half of k T in their relative motion, by which the gear swings about the common one; 4 % of scatter are left."""
    apart = WORN.replace({"initial.gap": 0.09e-6, "drive.torque": 1e-24, "load.drag": 0.0})
    gears, g = WORN.gears, WORN.geometry
    pinion, gear = gears.pinion_inertia / g.base_radius_pinion**2, gears.gear_inertia / g.base_radius_gear**2
    share = pinion / (pinion + gear) / g.base_radius_gear
    expected = 1.380649e-23 * KELVIN * (1.0 / pinion + 1.0 / gear) * share**2
    speeds = [shaken(apart, 1e-7, seed, duration=0.02).speed[20:] for seed in range(4)]
    assert np.var(speeds) == pytest.approx(expected, rel=0.15)


def test_worn_gears_stick_earlier_in_heat():
    """At half of the monolayer the cold gear turns for 0.3 s."""
    assert not sticks(shaken(WORN, 1e-8, 0, kelvin=0.0))
    assert sticks(shaken(WORN, 1e-8, 0))
