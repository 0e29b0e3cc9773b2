"""Features of a scene that may be combined, and the pairs that are refused: what scenes are checked by.

A pair is refused only for a reason of physics, which its message says. Whether ``contact.bodies = "auto"`` may become
elastic follows from the same list.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import combinations as pairs_of
from typing import TYPE_CHECKING, Final, NamedTuple

from gearidae.asperities import law_class, law_names
from gearidae.errors import SceneError
from gearidae.laws.frictions import FRICTION_LAWS, asks_for, key_of
from gearidae.laws.joints import JOINT_LAWS
from gearidae.laws.law import DRIVE, LOAD, ShaftLaw, on_shaft
from gearidae.laws.pairs import MESH_LAWS, has_mesh_law
from gearidae.laws.shafts import SHAFT_LAWS, has_law
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.joints import ages, has_joint
from gearidae.scene.keys import scene_value
from gearidae.scene.orbit import has_orbit
from gearidae.scene.pitch_errors import has_pitch_errors

if TYPE_CHECKING:
    import pandas as pd

    from gearidae.scene.scene import Scene


class Feature(NamedTuple):
    """A feature of a scene of gears.

    Attributes
    ----------
    key : str
        The key that asks for it.
    is_in : callable
        Whether a scene has it.
    """

    key: str
    is_in: Callable[[Scene], bool]


def _of_law(law: ShaftLaw) -> Feature:
    """Feature of a law of a shaft whose keys are those of the gears."""

    def is_in(scene: Scene) -> bool:
        return scene.gears is not None and any(has_law(scene, shaft, law) for shaft in (DRIVE, LOAD))

    return Feature(f"gears.{on_shaft(LOAD, law.coefficients[0].name)}", is_in)


def _flanks_rub(scene: Scene, law: str) -> bool:
    return scene.contact.friction_law == law and has_flank_friction(scene)


def _has_asperities(scene: Scene, name: str) -> bool:
    return scene.contact.asperity == name


_ASPERITIES: Final = tuple(name for name in law_names() if law_class(name).is_feature)
ELASTIC: Final = "elastic bodies"
FEATURES: Final = {
    ELASTIC: Feature("contact.bodies", lambda scene: scene.contact.bodies == "elastic"),
    "discrete asperities": Feature("contact.roughness", lambda scene: scene.contact.is_discrete),
    "attraction": Feature("surface.hamaker", lambda scene: scene.attracts),
    "coulomb friction": Feature("contact.friction", lambda scene: _flanks_rub(scene, "coulomb")),
    "shear friction": Feature("contact.shear_strength", lambda scene: _flanks_rub(scene, "shear")),
    **{f"{law.name} friction": Feature(law.key, partial(has_joint, law=law)) for law in JOINT_LAWS},
    "friction that ages": Feature("gears.hub_friction_rise", ages),
    **{law.name: Feature(key_of(law), partial(asks_for, law=law)) for law in FRICTION_LAWS},
    **{
        f"{name} asperities": Feature("contact.asperity", partial(_has_asperities, name=name))
        for name in _ASPERITIES
    },
    "independent coatings": Feature("coating.pairing", lambda scene: scene.coating.pairing == "independent"),
    "coating by place": Feature("coating.pinion_table", lambda scene: scene.coating.by_place),
    "radius force": Feature(
        "mesh.radius_force", lambda scene: scene.mesh is not None and scene.mesh.radius_force
    ),
    "static error": Feature(
        "mesh.static_error", lambda scene: scene.mesh is not None and bool(scene.mesh.static_error)
    ),
    "pitch errors": Feature("mesh.pitch_error_rms", has_pitch_errors),
    "runout": Feature(
        "mesh.gear_runout",
        lambda scene: scene.mesh is not None and bool(scene.mesh.pinion_runout or scene.mesh.gear_runout),
    ),
    "orbit": Feature("gears.pinion_hub_clearance", has_orbit),
    **{
        law.name: Feature(f"mesh.{law.constants[0].name}", partial(has_mesh_law, law=law))
        for law in MESH_LAWS
    },
    "held speed": Feature("drive.speed", lambda scene: scene.drive is not None and bool(scene.drive.speed)),
    "exposures": Feature("run.exposures", lambda scene: scene.run.exposures > 0),
    **{law.name: _of_law(law) for law in SHAFT_LAWS if any(constant.key for constant in law.coefficients)},
}
"""Features by their names."""

REFUSED: Final = {
    (ELASTIC, "discrete asperities"): (
        "deflections are those of the mean pressure of many asperities; single ones would each sink into the bodies by"
        " themselves"
    ),
    (ELASTIC, "attraction"): (
        "attraction acts across the whole gap and would deflect the bodies outside the contacts, where no deflection is"
        " solved for"
    ),
    **{
        (other, f"{name} asperities"): reason
        for name in _ASPERITIES
        for other, reason in law_class(name).not_with.items()
    },
    (ELASTIC, "shear friction"): (
        "the traction of a shear strength on asperities that hardly press would deflect the bodies along the flank, and"
        " deflections are solved for along the normal only"
    ),
}
"""Pairs of features that no scene can have, each with its reason."""

_ONE_KEY: Final = {
    ("coulomb friction", "shear friction"),
    *pairs_of([f"{name} asperities" for name in _ASPERITIES], 2),
}
"""Features that are two values of one key."""


def check_combinations(scene: Scene) -> None:
    """Refuse pairs of features that do not go together.

    Raises
    ------
    SceneError
        Naming the key of the first feature of the pair.
    """
    for (first, second), reason in REFUSED.items():
        if FEATURES[first].is_in(scene) and FEATURES[second].is_in(scene):
            key = FEATURES[first].key
            other = f"{second} ({FEATURES[second].key})"
            raise SceneError(key, scene_value(scene, key), f"cannot be combined with {other}: {reason}")


def reason_to_stay_rigid(scene: Scene) -> str:
    """Return why bodies that ``contact.bodies = "auto"`` decides on stay rigid in a scene; empty if they need not."""
    for (first, second), reason in REFUSED.items():
        if first == ELASTIC and FEATURES[second].is_in(scene):
            return f"{second} ({FEATURES[second].key}): {reason}"
    return ""


def may_deflect(scene: Scene) -> bool:
    """Whether the bodies of a scene are elastic, or may become so in a run."""
    bodies = scene.contact.bodies
    return bodies == "elastic" or (bodies == "auto" and not reason_to_stay_rigid(scene))


def bodies_reason(scene: Scene, *, elastic: bool) -> str:
    """Return why a run has had elastic or rigid bodies; empty where the scene says which.

    Parameters
    ----------
    elastic : bool
        Whether they have been elastic at any time.
    """
    if scene.contact.bodies != "auto":
        return ""
    if reason := reason_to_stay_rigid(scene):
        return f"auto stays rigid: {reason}"
    return f"auto: deflections {'may exceed' if elastic else 'stay below'} what rigid bodies allow"


def combinations() -> pd.DataFrame:
    """List all pairs of features of a scene of gears, and which are refused; scenes are checked by the same list.

    Returns
    -------
    pandas.DataFrame
        A row for each pair: the names ``first`` and ``second``, ``allowed``, and the ``reason`` of a pair that is
        refused, empty for others.

    Examples
    --------
    >>> import gearidae as gd
    >>> table = gd.combinations()
    >>> int((~table.allowed).sum())
    5
    """
    import pandas as pd

    rows = [
        (first, second, (first, second) not in REFUSED, REFUSED.get((first, second), ""))
        for first, second in pairs_of(FEATURES, 2)
        if (first, second) not in _ONE_KEY
    ]
    return pd.DataFrame(rows, columns=["first", "second", "allowed", "reason"])
