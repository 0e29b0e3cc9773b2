"""How much the reproduced figures move with each inferred number."""

from __future__ import annotations

import math

import pytest

import gearidae as gd
from gearidae_pages.figure_sensitivity import INFERRED, QUANTITIES, Quantity, figure_changes, figure_table


def test_changes_are_those_of_a_power_law():
    """A quantity that goes with the cube of the gap and not with the density: 1.1^3 - 1, and nothing."""
    scene = gd.preset("teodorescu2009_low_speed")
    cube = Quantity(
        "1",
        "cube",
        "m3",
        scene,
        lambda changed: changed.initial.gap**3 * changed.surface.asperity_density**0,
        ("initial.gap", "surface.asperity_density"),
    )
    (moved,) = figure_changes([cube])
    assert moved.value == pytest.approx(scene.initial.gap**3, rel=1e-6, abs=0)
    assert moved.changes["initial.gap"] == pytest.approx(1.1**3 - 1.0)
    assert moved.changes["surface.asperity_density"] == 0.0
    assert "| 33 % |" in figure_table([moved])


def test_the_steady_speed_follows_from_table_1_alone():
    """The balance of torques, sqrt((M10 R2/R1 - M20) / alpha), has none of the inferred numbers in it."""
    speed = next(quantity for quantity in QUANTITIES if quantity.figure == "4")
    assert "drive.torque" not in speed.keys
    (moved,) = figure_changes([speed])
    assert moved.value == pytest.approx(math.sqrt((2.43e-11 * 4 - 3e-11) / 8e-18), rel=0.005)
    assert max(moved.changes.values()) < 2e-3


def test_every_inferred_number_is_a_key_of_some_scene():
    named = {key for quantity in QUANTITIES for key in quantity.keys}
    assert named == set(INFERRED)
