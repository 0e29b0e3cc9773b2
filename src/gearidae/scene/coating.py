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
is no mixed material, and the shares are f and 1 - f. The Hamaker constant of unlike surfaces is the geometric mean,
too.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Final, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, create_model, model_validator

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.coating_table import FractionTable, path_means
from gearidae.scene.group import Group, shorten
from gearidae.scene.quantity import Quantity
from gearidae.scene.surface import (
    LAW_KEYS,
    Energy,
    Hamaker,
    OptionalFriction,
    OptionalStrength,
    Surface,
    field_of_law,
)

MATERIAL_NAMES: Final = ("bare", "coated", "mixed")
"""Names of the materials that an interface may have, in the order of `Scene.materials`."""

THICKEST: Final = 3.0
"""Largest thickness of a monolayer, in roughnesses: beyond, what is bare touches nothing, and tables lose digits."""

_RECESSES: Final = {"bare": 2.0, "coated": 0.0, "mixed": 1.0}  # thicknesses by which gaps are wider

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


class CoatingOfFlanks(Group):
    """Share and energies of the self-assembled monolayer."""

    sam_fraction: Fraction = Field(description="share of the flank that the monolayer still covers, f")
    energy: Energy = Field(default=0.1, description="surface energy where the monolayer covers the flank")
    hamaker: Hamaker = Field(
        default=0.0, description="Hamaker constant where the monolayer covers both flanks, at their own gap"
    )


if TYPE_CHECKING:
    _CoatingWithLaws = CoatingOfFlanks
else:
    _CoatingWithLaws = create_model(
        "_CoatingWithLaws",
        __base__=CoatingOfFlanks,
        __module__=__name__,
        **{
            key.name: field_of_law(key, key.coated.default, key.coated.description)
            for key in LAW_KEYS
            if key.coated is not None
        },
    )


class Coating(_CoatingWithLaws):
    """The self-assembled monolayer: its energy and thickness, and how much of it is left on either side."""

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

    pinion_table: FractionTable = Field(
        default=(), description="that share by tooth and place: a list of teeth, each a list along the flank"
    )
    gear_table: FractionTable = Field(
        default=(), description="the same of the gear, its places along the path of contact as the pinion's"
    )
    friction: OptionalFriction = Field(
        default=None,
        description="coefficient of friction where the monolayer separates the flanks; contact.friction if not given",
    )
    shear_strength: OptionalStrength = Field(
        default=None,
        description="shear strength of asperities there; contact.shear_strength if not given",
    )

    @model_validator(mode="after")
    def _one_fraction_of_patches(self) -> Self:
        """Refuse fractions of either side where covered patches meet covered ones, and two of one side."""
        for key in ("pinion_fraction", "gear_fraction"):
            value, table = getattr(self, key), key.replace("fraction", "table")
            if self.pairing == "patches" and value is not None:
                raise SceneError(
                    key, value, 'needs coating.pairing = "independent": patches have sam_fraction alone'
                )
            if value is not None and getattr(self, table):
                raise SceneError(key, value, f"cannot be given beside {table}: choose one of the two")
        if self.pairing == "patches" and self.gear_table:
            raise SceneError(
                "gear_table",
                shorten(self.gear_table),
                'needs coating.pairing = "independent": patches have pinion_table alone, the share of the interface',
            )
        return self

    @property
    def by_place(self) -> bool:
        """Whether fractions change with tooth and place."""
        return bool(self.pinion_table or self.gear_table)

    @property
    def tables(self) -> tuple[tuple[tuple[float, ...], ...], ...]:
        """Tables of the pinion and the gear, of one row and place for a side without one."""
        sides = ((self.pinion_table, self.pinion_fraction), (self.gear_table, self.gear_fraction))
        return tuple(
            table or ((self.sam_fraction if fraction is None else fraction,),) for table, fraction in sides
        )

    @property
    def fractions(self) -> tuple[float, float]:
        """Covered shares of the pinion's and the gear's flanks (of a roller and its plane) [1]; means of tables."""
        return path_means(*self.tables)[:2]


def interface_shares(pairing: str, first: ArrayLike, second: ArrayLike) -> dict[str, Floats]:
    """Shares of the materials where two flanks meet.

    Parameters
    ----------
    pairing : {"patches", "independent"}
    first, second : array_like
        Covered fractions of both sides [1]; of patches the first counts.

    Returns
    -------
    dict of str to ndarray
        By the names of `MATERIAL_NAMES`, without the mixed material for patches.
    """
    f, g = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if pairing == "patches":
        return {"bare": 1.0 - f, "coated": f}
    return {"bare": (1.0 - f) * (1.0 - g), "coated": f * g, "mixed": f * (1.0 - g) + g * (1.0 - f)}


def _mean_shares(coating: Coating) -> dict[str, float]:
    """Shares of the materials, of tables the means over teeth and path."""
    if not coating.by_place:
        first, second = (table[0][0] for table in coating.tables)
        return {
            name: float(share) for name, share in interface_shares(coating.pairing, first, second).items()
        }
    first, second, both = path_means(*coating.tables)
    if coating.pairing == "patches":
        return {"bare": 1.0 - first, "coated": first}
    bare = max(1.0 - first - second + both, 0.0)
    return {"bare": bare, "coated": both, "mixed": max(first + second - 2.0 * both, 0.0)}


@lru_cache(maxsize=64)
def materials_of(coating: Coating, surface: Surface) -> tuple[Material, ...]:
    """List the materials of an interface.

    Parameters
    ----------
    surface : Surface
        The bare surface.

    Returns
    -------
    tuple of Material
        In the order of `MATERIAL_NAMES`, mixed with independent sides only; shares add up to 1. Those of fractions by
        tooth and place are means over all teeth that meet and along the path of contact.
    """
    constants = {
        "coated": {"energy": coating.energy, "hamaker": coating.hamaker},
        "mixed": {
            "energy": math.sqrt(coating.energy * surface.energy),
            "hamaker": math.sqrt(coating.hamaker * surface.hamaker),
        },
    }
    for key in LAW_KEYS:
        if key.coated is not None:
            coated, bare = getattr(coating, key.name), getattr(surface, key.name)
            constants["coated"][key.name] = coated
            constants["mixed"][key.name] = key.coated.mixed(coated, bare)
    return tuple(
        Material(
            surface if name == "bare" else surface.model_copy(update=constants[name]),
            share,
            _RECESSES[name] * coating.thickness,
            name,
        )
        for name, share in _mean_shares(coating).items()
    )
