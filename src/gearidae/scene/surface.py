"""The rough flanks, and the laws chosen for their contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Field, create_model, model_validator

from gearidae.asperities import law_class, law_names
from gearidae.asperities.base import SurfaceKey
from gearidae.asperities.tip import INTERACTION_RANGE
from gearidae.scene.asperity_list import Listed, ListedAsperities
from gearidae.scene.group import Group
from gearidae.scene.named import Named
from gearidae.scene.older_names import with_new_names
from gearidae.scene.quantity import Count, Quantity

_LONGEST_LINE = 300
Energy = Annotated[float, Quantity(unit="J/m^2", at_least=0, at_most=100, least=1e-15)]
Hamaker = Annotated[float, Quantity(unit="J", at_least=0, at_most=1e-17, least=1e-25)]
_FRICTION = Quantity(unit="1", at_least=0, at_most=2, least=1e-6)
_STRENGTH = Quantity(unit="Pa", at_least=0, at_most=1e12, least=1.0, shown=("MPa", 6))
Friction = Annotated[float, _FRICTION]
Strength = Annotated[float, _STRENGTH]
OptionalFriction = Annotated[float | None, _FRICTION]
_RISE = Quantity(unit="1", at_least=0, at_most=5, least=1e-6)
FrictionRise = Annotated[float, _RISE]
OptionalRise = Annotated[float | None, _RISE]
AgeingTime = Annotated[float | None, Quantity(unit="s", at_least=1e-12, at_most=1e12, shown=("ms", -3))]
MemoryLength = Annotated[float | None, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("nm", -9))]
OptionalStrength = Annotated[float | None, _STRENGTH]


def _line(value: object) -> str:
    if isinstance(value, str) and (value.isprintable() or not value) and len(value) <= _LONGEST_LINE:
        return value
    raise ValueError(f"must be a printable line of at most {_LONGEST_LINE} characters")


LAW_KEYS: Final = tuple(key for name in law_names() for key in law_class(name).keys)
"""Keys that the laws of one asperity declare."""


def field_of_law(key: SurfaceKey, default: float | None, description: str) -> tuple[Any, Any]:
    """Field of a table for a key of a law of one asperity."""
    kind = Quantity(unit=key.unit, at_least=key.at_least, at_most=key.at_most)
    number: Any = float if default is not None else float | None
    return Annotated[number, kind], Field(default=default, description=description)


class SurfaceOfSolid(Group):
    """Both flanks: the same elastic solid with the same Gaussian roughness."""

    youngs_modulus: Annotated[float, Quantity(unit="Pa", at_least=1e3, at_most=1e14, shown=("GPa", 9))] = (
        Field(description="Young's modulus")
    )
    poisson_ratio: Annotated[float, Quantity(unit="1", above=-1, below=0.5)] = Field(
        description="Poisson's ratio"
    )
    energy: Energy = Field(description="surface energy of the bare flank; the work of adhesion is twice that")
    asperity_density: Annotated[
        float, Quantity(unit="1/m^2", at_least=1, at_most=1e20, shown=("1/um^2", 12))
    ] = Field(description="asperities per area, N")
    asperity_radius: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=0.1, shown=("nm", -9))] = (
        Field(description="tip radius of the asperities, beta")
    )
    roughness: Annotated[float, Quantity(unit="m", at_least=1e-12, at_most=0.1, shown=("nm", -9))] = Field(
        description="rms height of the asperities, sigma"
    )
    interaction_range: Annotated[float, Quantity(unit="m", above=0, at_most=1e-6, shown=("nm", -9))] = Field(
        default=INTERACTION_RANGE,
        description="range of the adhesive forces, eps (equilibrium spacing of atoms); for maugis asperities",
    )
    hamaker: Hamaker = Field(
        default=0.0,
        description="Hamaker constant of bare flanks, which then attract each other across the gap; bodies stay rigid",
    )


if TYPE_CHECKING:
    _SurfaceWithLaws = SurfaceOfSolid
else:
    _SurfaceWithLaws = create_model(
        "_SurfaceWithLaws",
        __base__=SurfaceOfSolid,
        __module__=__name__,
        **{key.name: field_of_law(key, key.default, key.description) for key in LAW_KEYS},
    )


class Surface(_SurfaceWithLaws):
    """Both flanks: the same elastic solid with the same Gaussian roughness, and what laws of asperities ask for."""

    provenance: Annotated[str, BeforeValidator(_line)] = Field(
        default="",
        description="where roughness, density and radius of the asperities come from; not computed with",
    )


class Contact(Group):
    """Which laws of contact to use."""

    @model_validator(mode="before")
    @classmethod
    def _read_older_names(cls, data: Any) -> Any:
        return with_new_names(data) if isinstance(data, dict) else data

    @property
    def is_discrete(self) -> bool:
        """Whether asperities are followed one by one."""
        return self.roughness == "discrete"

    model: Literal["auto", "asperity", "elastic", "population"] | None = Field(
        default=None,
        description="older name, in place of bodies and roughness: asperity: rigid; elastic; auto; population: rigid "
        "with discrete asperities; a scene keeps those",
    )
    bodies: Literal["auto", "rigid", "elastic"] = Field(
        default="auto",
        description="tooth bodies: rigid; elastic: they deflect under the pressure; auto: elastic where needed",
    )
    roughness: Literal["statistical", "discrete"] = Field(
        default="statistical",
        description="asperities: statistical: the mean of many surfaces; discrete: those of one surface, drawn or "
        "listed for each flank",
    )
    asperity: Annotated[str, Named(law_names)] = Field(default="jkr", description="force law of one asperity")
    seed: Annotated[int, Count(at_least=0, at_most=2**53)] = Field(
        default=0, description="which surface of this kind discrete asperities are drawn as"
    )
    radius_spread: Annotated[float, Quantity(unit="1", at_least=0, at_most=10)] = Field(
        default=0.0,
        description="standard deviation of the tip radii of discrete asperities over their mean; they are lognormal",
    )
    asperities: Listed = Field(
        default=ListedAsperities(),
        description="list of asperities in place of drawn ones: a CSV file, or columns",
    )
    friction: Friction = Field(
        default=0.0, description="coefficient of friction of bare flanks, for friction_law = coulomb"
    )
    friction_law: Literal["coulomb", "shear"] = Field(
        default="coulomb",
        description="limit of the friction of a pair of flanks: coulomb: coefficient times the force that presses them "
        "together; shear: shear strength times the area of the asperities in contact",
    )
    shear_strength: Strength = Field(
        default=0.0, description="shear strength of bare asperities in contact, for friction_law = shear"
    )
