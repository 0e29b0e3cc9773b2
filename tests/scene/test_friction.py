"""Keys of friction: defaults, units, and what does not go together."""

from __future__ import annotations

from typing import Any

import pytest

import gearidae as gd
from gearidae.scene.friction import friction_values, has_flank_friction
from gearidae.scene.joints import has_joint_friction

HIGH = gd.preset("teodorescu2009")
ENGINE = {"name": "microengine", "radius": 1e-5, "force": 1e-5, "frequency": 600.0}
HUBS = {"gears.pinion_hub_radius": "3 um", "gears.gear_hub_radius": "6 um"}


def test_presets_have_no_friction() -> None:
    for name in ("teodorescu2009", "teodorescu2009_low_speed", "roller_slow"):
        scene = gd.preset(name)
        assert friction_values(scene) == {"bare": 0.0, "coated": 0.0, "mixed": 0.0}
        assert not has_flank_friction(scene)
        assert not has_joint_friction(scene)


def test_the_monolayer_has_the_flanks_friction_unless_given() -> None:
    scene = HIGH.replace({"contact.friction": 0.3})
    assert friction_values(scene) == {"bare": 0.3, "coated": 0.3, "mixed": 0.3}
    scene = scene.replace({"coating.friction": 0.1})
    assert friction_values(scene) == {"bare": 0.3, "coated": 0.1, "mixed": 0.1}
    assert has_flank_friction(scene)


def test_a_material_that_flanks_do_not_have_rubs_nothing() -> None:
    bare_alone = {"contact.friction": 0.3, "coating.friction": 0.0}
    assert not has_flank_friction(HIGH.replace({**bare_alone, "coating.sam_fraction": 1.0}))
    assert has_flank_friction(HIGH.replace({**bare_alone, "coating.sam_fraction": 0.5}))


def test_strengths_with_units() -> None:
    scene = HIGH.replace({"contact.friction_law": "shear", "contact.shear_strength": "100 MPa"})
    assert friction_values(scene) == {"bare": 1e8, "coated": 1e8, "mixed": 1e8}
    scene = scene.replace({"coating.shear_strength": "10 MPa"})
    assert friction_values(scene)["coated"] == 1e7
    assert gd.Scene.from_dict(scene.to_dict()) == scene


def test_hubs_with_units() -> None:
    scene = HIGH.replace({"gears.hub_friction": 0.3, **HUBS})
    assert scene.gears is not None
    assert (scene.gears.pinion_hub_radius, scene.gears.gear_hub_radius) == (3e-6, 6e-6)
    assert has_joint_friction(scene)
    assert not has_flank_friction(scene)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"contact.friction": -0.1}, "contact.friction"),
        ({"contact.friction": 1.7}, "contact.friction"),  # the preset locks at 1.615
        ({"contact.friction": 0.1, "coating.friction": 1.7}, "coating.friction"),
        ({"contact.friction_law": "stick"}, "contact.friction_law"),
        ({"contact.friction_law": "shear"}, "contact.shear_strength"),
        ({"contact.shear_strength": 1e7}, "contact.shear_strength"),
        ({"coating.shear_strength": 1e7}, "coating.shear_strength"),
        (
            {"contact.friction_law": "shear", "contact.shear_strength": 1e7, "contact.friction": 0.1},
            "contact.friction",
        ),
        ({"gears.hub_friction": 0.1}, "gears.pinion_hub_radius"),
        (
            {"gears.hub_friction": 2.0, "gears.pinion_hub_radius": 20e-6, "gears.gear_hub_radius": 6e-6},
            "gears.pinion_hub_radius",
        ),
        (
            {"gears.hub_friction": 1.0, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 139e-6},
            "gears.gear_hub_radius",
        ),
        ({"gears.pinion_hub_adhesion": 1e-6}, "gears.pinion_hub_radius"),
        ({"gears.gear_axial_load": 1e-6}, "gears.gear_dimple_radius"),
        ({"gears.gear_axial_load": -1e-6}, "gears.gear_axial_load"),
        ({"drive.pin_radius": 1e-6}, "drive.pin_radius"),
        ({"drive.pin_friction": 0.3}, "drive.pin_friction"),
        ({"drive.orientation": 0.3}, "drive.orientation"),
        ({"drive.law": ENGINE, "drive.pin_friction": 0.3}, "drive.pin_radius"),
        (
            {
                "drive.law": ENGINE,
                "drive.pin_radius": 2e-6,
                "drive.pin_friction": 2.0,
                "gears.hub_friction": 2.0,
                "gears.pinion_hub_radius": 3.1e-6,
            },
            "drive.pin_radius",  # takes 4 + 6.2 um of an arm of 10 um
        ),
        ({"load.law": ENGINE}, "load.law.name"),
    ],
)
def test_bad_friction_is_refused_by_its_key(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(gd.SceneError) as caught:
        HIGH.replace(changes)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"contact.friction": 0.1}, "contact.friction"),
        ({"coating.friction": 0.1}, "coating.friction"),
        ({"contact.shear_strength": 1e7}, "contact.shear_strength"),
        ({"contact.friction_law": "shear"}, "contact.friction_law"),
    ],
)
def test_a_roller_has_no_friction(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(gd.SceneError) as caught:
        gd.preset("roller_slow").replace(changes)
    assert caught.value.key == key


def test_self_locking_bounds_the_coefficient() -> None:
    """1.615 from the gear's side, the smaller of both sides, for the preset's mesh."""
    assert HIGH.replace({"contact.friction": 1.61}).contact.friction == 1.61
    with pytest.raises(gd.SceneError, match=r"must be below 1\.615"):
        HIGH.replace({"contact.friction": 1.62})
