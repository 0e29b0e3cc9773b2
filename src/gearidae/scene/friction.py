"""Friction of flanks: the values of each material, and what does not go together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.asperities import law_class, law_names
from gearidae.errors import SceneError
from gearidae.mesh.friction import locking_coefficients

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


def friction_values(scene: Scene) -> dict[str, float]:
    """Friction of each material: coefficients of the law ``coulomb`` [1], shear strengths of the law ``shear`` [Pa].

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    dict of str to float
        By the names of `gearidae.scene.coating.MATERIAL_NAMES`. A monolayer on one side separates the flanks like one
        on both: the mixed material has the value of the coated one.
    """
    contact, coating = scene.contact, scene.coating
    if contact.friction_law == "shear":
        bare, coated = contact.shear_strength, coating.shear_strength
    else:
        bare, coated = contact.friction, coating.friction
    if coated is None:
        coated = bare
    return {"bare": bare, "coated": coated, "mixed": coated}


def has_flank_friction(scene: Scene) -> bool:
    """Whether any material of a scene's flanks has friction."""
    values = friction_values(scene)
    return any(values[material.name] > 0.0 for material in scene.materials() if material.share > 0.0)


def check_friction(scene: Scene) -> None:
    """Refuse friction that a scene of gears cannot have.

    Raises
    ------
    SceneError
        Naming the key.
    """
    _check_law(scene)
    locks, values = min(locking_coefficients(scene.geometry)), friction_values(scene)
    for key, value in (("contact.friction", values["bare"]), ("coating.friction", values["coated"])):
        if scene.contact.friction_law == "coulomb" and value >= locks:
            raise SceneError(
                key,
                value,
                f"must be below {locks:.4g}: gears of this mesh lock themselves from there on",
            )


def check_no_friction(scene: Scene) -> None:
    """Refuse friction of a roller, whose motion is normal to the flank.

    Raises
    ------
    SceneError
        Naming the key.
    """
    contact, coating = scene.contact, scene.coating
    values = {
        "contact.friction": contact.friction,
        "contact.shear_strength": contact.shear_strength,
        "coating.friction": coating.friction,
        "coating.shear_strength": coating.shear_strength,
    }
    for key, value in values.items():
        if value:
            raise SceneError(key, value, "must be 0 in a scene with a roller, which does not slide")
    if contact.friction_law != "coulomb":
        raise SceneError(
            "contact.friction_law", contact.friction_law, "must be coulomb in a scene with a roller"
        )


def _check_law(scene: Scene) -> None:
    """Refuse a law without its values, and values of the other law."""
    contact, coating = scene.contact, scene.coating
    if contact.friction_law == "shear":
        if not law_class(contact.asperity).has_area():
            with_area = ", ".join(name for name in law_names() if law_class(name).has_area())
            raise SceneError(
                "contact.friction_law",
                "shear",
                f"needs a law of one asperity that has the method area: contact.asperity must be one of {with_area}",
            )
        if contact.shear_strength == 0.0 and not coating.shear_strength:
            raise SceneError(
                "contact.shear_strength", 0.0, "must be above 0 with contact.friction_law = shear"
            )
        others = {"contact.friction": contact.friction, "coating.friction": coating.friction}
        wanted = "coulomb"
    else:
        others = {
            "contact.shear_strength": contact.shear_strength,
            "coating.shear_strength": coating.shear_strength,
        }
        wanted = "shear"
    for key, value in others.items():
        if value:
            raise SceneError(key, value, f"must be 0 or left out, or contact.friction_law must be {wanted}")
