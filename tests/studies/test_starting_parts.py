"""What takes a starting torque, part beside part: closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.mesh.friction import starting_ratio
from gearidae.studies import static_starting_torque
from gearidae.studies.starting_parts import PARTS, Starting, parts_of
from gearidae.studies.starting_ramp import pitch_of

HIGH = gd.preset("teodorescu2009")
HUBS = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}
STICKY = HUBS | {"gears.pinion_hub_adhesion": 0.5e-6, "gears.gear_hub_adhesion": 0.8e-6}
LOADED = STICKY | {
    "gears.pinion_axial_load": 0.2e-6,
    "gears.gear_axial_load": 0.4e-6,
    "gears.pinion_dimple_radius": 10e-6,
    "gears.gear_dimple_radius": 50e-6,
}
R1, R2 = HIGH.geometry.base_radius_pinion, HIGH.geometry.base_radius_gear


def part(scene, torque, name):
    return parts_of(scene, torque)[PARTS.index(name)]


def test_without_friction_the_torque_is_dry_resistance_and_teeth():
    parts = parts_of(HIGH, 9e-12)
    np.testing.assert_allclose(parts[:2], [7.5e-12, 1.5e-12], rtol=1e-9)
    assert parts[2:].tolist() == [0.0] * 4
    assert np.isnan(parts_of(HIGH, [math.inf, math.nan])).all()


def test_hubs_that_stick_without_a_force_of_the_teeth():
    """Nothing else resists: mu r1 A1 on the pinion, and mu r2 A2 on the gear through teeth and both hubs."""
    scene = HIGH.replace({**STICKY, "load.torque": 0.0, "contact.asperity": "hertz"})
    through = (R1 + 0.3 * 3e-6) / (R2 - 0.3 * 6e-6)
    expected = 0.3 * 3e-6 * 0.5e-6 + through * 0.3 * 6e-6 * 0.8e-6
    assert Starting(scene).torque() == pytest.approx(expected, rel=1e-9, abs=0)
    assert part(scene, expected, "hubs") == pytest.approx(expected, rel=1e-9, abs=0)
    assert static_starting_torque(scene) == pytest.approx(expected, rel=1e-9, abs=0)
    assert pitch_of(scene).dry == pytest.approx(expected, rel=1e-9, abs=0)


def test_parts_add_up_and_axial_loads_are_beside_the_hubs():
    scene = HIGH.replace({**LOADED, "contact.friction": 0.2})
    torque = 3e-11
    parts = parts_of(scene, torque)
    assert parts.sum() == pytest.approx(torque, rel=1e-12, abs=0)
    ratio = starting_ratio(scene.geometry, 0.2, 0.3, (3e-6, 6e-6))
    axial = 0.3 * 10e-6 * 0.2e-6 + ratio * 0.3 * 50e-6 * 0.4e-6
    assert part(scene, torque, "axial loads") == pytest.approx(axial, rel=1e-9, abs=0)
    assert (parts[:4] > 0.0).all()
    assert part(scene, torque, "pin") == 0.0
    without = parts_of(scene.replace({"contact.friction": 0.0}), torque)
    assert without[PARTS.index("friction of flanks")] == 0.0


def test_a_pin_takes_its_friction_under_the_force_of_the_law():
    scene = gd.load_case("cases/microengine.toml").replace(
        {
            **HUBS,
            "gears.hub_friction_rise": 0.0,
            "drive.pin_radius": 1.25e-6,
            "drive.pin_friction": 0.2,
            "contact.asperity": "hertz",
        }
    )
    torque = Starting(scene).torque()
    assert part(scene, torque, "pin") == pytest.approx(0.2 * 1.25e-6 * 10e-6, rel=1e-9, abs=0)
    weak = scene.replace({"drive.law.force": 1e-12})
    of_hub = part(scene, torque, "hubs") - part(weak, Starting(weak).torque(), "hubs")
    assert of_hub == pytest.approx(0.3 * 3e-6 * (10e-6 - 1e-12), rel=1e-9, abs=0)
