r"""The monolayer on the flanks, and the materials of which an interface with it is made.

A flank is covered by the monolayer in places. Where two flanks meet, either may be covered, so that up to three
materials share the interface, each with its work of adhesion and its gap. That of unlike surfaces is the geometric mean
of Girifalco and Good, J. Phys. Chem. 61 (1957) 904-909, doi:10.1021/j150553a013:

========  =======================================  =========  =========================
material  work of adhesion                         gap        share, independent sides
========  =======================================  =========  =========================
coated    :math:`2\gamma_c`                        h          f1 f2
mixed     :math:`2\sqrt{\gamma_c\gamma_s}`         h + t      f1 (1 - f2) + f2 (1 - f1)
bare      :math:`2\gamma_s`                        h + 2 t    (1 - f1) (1 - f2)
========  =======================================  =========  =========================

The gap h of a scene is that of flanks that are covered on both sides: where the monolayer is lost there is a recess of
its thickness t. With ``pairing = "patches"``, as in Teodorescu et al. 2009, covered patches meet covered ones: there
is no mixed material, and the shares are f and 1 - f.
"""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal, NamedTuple, Self

from pydantic import Field, model_validator

from gearidae.errors import SceneError
from gearidae.scene.group import Group
from gearidae.scene.quantity import Quantity
from gearidae.scene.surface import Energy, Surface

__all__ = ["MATERIAL_NAMES", "THICKEST", "Coating", "Material", "materials_of"]

MATERIAL_NAMES: Final = ("bare", "coated", "mixed")
"""Names of the materials that an interface may have, in the order of `Scene.materials`."""

THICKEST: Final = 3.0
"""Largest thickness of a monolayer, in roughnesses: beyond, what is bare touches nothing, and tables lose digits."""

Fraction = Annotated[float, Quantity(unit="1", at_least=0, at_most=1)]
OptionalFraction = Annotated[float | None, Quantity(unit="1", at_least=0, at_most=1)]


class Material(NamedTuple):
    """One of the materials that share the interface of two flanks.

    Attributes
    ----------
    surface : Surface
        Its surface; the work of adhesion is twice the surface's energy.
    share : float
        Its share of the interface [1].
    gap_offset : float
        By how much its gap is wider than the scene's [m].
    name : str
        One of `MATERIAL_NAMES`.
    """

    surface: Surface
    share: float
    gap_offset: float
    name: str


class Coating(Group):
    """The self-assembled monolayer: its energy and thickness, and how much of it is left on either side."""

    sam_fraction: Fraction = Field(description="share of the flank that the monolayer still covers, f")
    energy: Energy = Field(default=0.1, description="surface energy where the monolayer covers the flank")
    pairing: Literal["patches", "independent"] = Field(
        default="patches",
        description="patches: covered patches meet covered ones; independent: each side is covered on its own",
    )
    thickness: Annotated[float, Quantity(unit="m", at_least=0, at_most=1e-6, shown=("nm", -9))] = Field(
        default=0.0, description="thickness of the monolayer, by which bare places are recessed, t"
    )
    pinion_fraction: OptionalFraction = Field(
        default=None, description="share of the pinion's flanks that is covered; sam_fraction if not given"
    )
    gear_fraction: OptionalFraction = Field(
        default=None, description="share of the gear's flanks that is covered; sam_fraction if not given"
    )

    @model_validator(mode="after")
    def _one_fraction_of_patches(self) -> Self:
        """Refuse fractions of either side where covered patches meet covered ones."""
        for key in ("pinion_fraction", "gear_fraction"):
            value = getattr(self, key)
            if self.pairing == "patches" and value is not None:
                raise SceneError(
                    key, value, 'needs coating.pairing = "independent": patches have sam_fraction alone'
                )
        return self

    @property
    def fractions(self) -> tuple[float, float]:
        """Covered shares of the pinion's and the gear's flanks (of a roller and its plane) [1]."""
        sides = (self.pinion_fraction, self.gear_fraction)
        first, second = (self.sam_fraction if side is None else side for side in sides)
        return first, second


def materials_of(coating: Coating, surface: Surface) -> tuple[Material, ...]:
    """List the materials of an interface.

    Parameters
    ----------
    coating : Coating
    surface : Surface
        The bare surface.

    Returns
    -------
    tuple of Material
        In the order of `MATERIAL_NAMES`, mixed with independent sides only; shares add up to 1.
    """
    thickness, (first, second) = coating.thickness, coating.fractions

    def material(name: str, energy: float, share: float, layers: float) -> Material:
        own = surface if name == "bare" else surface.model_copy(update={"energy": energy})
        return Material(own, share, layers * thickness, name)

    if coating.pairing == "patches":
        return (
            material("bare", surface.energy, 1.0 - coating.sam_fraction, 2.0),
            material("coated", coating.energy, coating.sam_fraction, 0.0),
        )
    return (
        material("bare", surface.energy, (1.0 - first) * (1.0 - second), 2.0),
        material("coated", coating.energy, first * second, 0.0),
        material(
            "mixed",
            math.sqrt(coating.energy * surface.energy),
            first * (1.0 - second) + second * (1.0 - first),
            1.0,
        ),
    )
