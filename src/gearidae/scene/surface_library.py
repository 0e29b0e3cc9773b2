"""Surfaces by name: silicon, polysilicon and the monolayers on them, each number with its source or marked as assumed.

``surface = "polysilicon, OTS"`` in a case file stands for a table ``surface`` and, of a surface with a monolayer, for
the energy and the thickness in the table ``coating``. Friction is listed and not set: flanks of a scene have none
unless the scene gives a coefficient.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten

_PAPER: Final = "Teodorescu et al. 2009, doi:10.1016/j.triboint.2008.05.019, Table 1"
_BREAKING: Final = "Jaccodine 1963, doi:10.1149/1.2425806, freshly broken (111)"
_WET: Final = "DelRio et al. 2007, doi:10.1063/1.2723658: a work of adhesion of at most 144 mJ/m^2"
_FOTS: Final = "Mayer et al. 2000, doi:10.1116/1.1288200"
_PULL_OFF: Final = (
    "one asperity that parts at the 30 nN of Asay et al., Tribol. Lett. 2008, 67, with 0.02 J/m^2"
)


class LibraryValue(NamedTuple):
    """One number of a named surface.

    Attributes
    ----------
    value : float
        In SI units.
    unit : str
    source : str
        Publication, with the condition that it holds for; of an assumed number, the reason of the choice.
    assumed : bool
        Whether no measurement of this number on this surface is known.
    """

    value: float
    unit: str
    source: str
    assumed: bool = False


_Values = Mapping[str, LibraryValue]

_SILICON: Final[_Values] = {
    "surface.youngs_modulus": LibraryValue(161e9, "Pa", _PAPER),
    "surface.poisson_ratio": LibraryValue(0.23, "1", _PAPER),
    "surface.energy": LibraryValue(1.23, "J/m^2", _BREAKING),
    "surface.asperity_density": LibraryValue(1.69e14, "1/m^2", _PAPER),
    "surface.asperity_radius": LibraryValue(450e-9, "m", "fitted to the figures of that paper", assumed=True),
    "surface.roughness": LibraryValue(6e-9, "m", _PAPER),
}
_POLYSILICON: Final[_Values] = {
    "surface.youngs_modulus": LibraryValue(161e9, "Pa", "as silicon", assumed=True),
    "surface.poisson_ratio": LibraryValue(0.23, "1", "as silicon", assumed=True),
    "surface.energy": LibraryValue(0.072, "J/m^2", _WET),
    "surface.asperity_density": LibraryValue(
        1.69e14, "1/m^2", "as silicon; of side walls none is known", assumed=True
    ),
    "surface.asperity_radius": LibraryValue(160e-9, "m", _PULL_OFF, assumed=True),
    "surface.roughness": LibraryValue(6e-9, "m", "as silicon; of side walls none is known", assumed=True),
    "static friction": LibraryValue(0.3, "1", "de Boer et al. 2001, doi:10.1117/12.443009"),
    "sliding friction": LibraryValue(0.2, "1", "de Boer et al. 2001, doi:10.1117/12.443009"),
}

SOLIDS: Final[Mapping[str, _Values]] = {
    "silicon": _SILICON,
    "oxidised silicon": {**_SILICON, "surface.energy": LibraryValue(0.072, "J/m^2", _WET)},
    "polysilicon": _POLYSILICON,
}
"""Bare surfaces: keys of a scene, and coefficients of friction that no key takes by itself."""

_FLUORINATED: Final = "of the order of surfaces that end in fluorinated groups; not measured on its own"

COATINGS: Final[Mapping[str, _Values]] = {
    "OTS": {
        "coating.energy": LibraryValue(0.1, "J/m^2", _PAPER),
        "coating.thickness": LibraryValue(
            2.5e-9, "m", "2.4 to 2.7 nm, collected by Castillo et al. 2015, doi:10.1021/la504178g"
        ),
        "sliding friction": LibraryValue(0.04, "1", "Khatri et al. 2007, doi:10.1021/jp073892z, fresh"),
    },
    "FOTS": {
        "coating.energy": LibraryValue(0.02, "J/m^2", _FLUORINATED, assumed=True),
        "coating.thickness": LibraryValue(1e-9, "m", _FOTS),
    },
    "FDTS": {
        "coating.energy": LibraryValue(0.02, "J/m^2", _FLUORINATED, assumed=True),
        "coating.thickness": LibraryValue(1e-9, "m", "as FOTS", assumed=True),
    },
    "FOTAS": {
        "coating.energy": LibraryValue(0.02, "J/m^2", _FLUORINATED, assumed=True),
        "coating.thickness": LibraryValue(1e-9, "m", "as FOTS, whose chain it has", assumed=True),
        "largest over smallest static friction": LibraryValue(
            3.0,
            "1",
            "Corwin, de Boer 2009, doi:10.1109/JMEMS.2008.2011717: with the rate of unloading after a hold",
        ),
    },
}
"""Monolayers: keys of a scene, and coefficients of friction that no key takes by itself."""


def library_tables(name: str) -> dict[str, dict[str, Any]]:
    """Return the tables of a scene that a named surface stands for.

    Parameters
    ----------
    name : str
        A bare surface (``"polysilicon"``), or one with a monolayer (``"polysilicon, OTS"``).

    Returns
    -------
    dict of str to dict
        ``surface``, and ``coating`` where the name has a monolayer; SI numbers. The name is its provenance.

    Raises
    ------
    SceneError
        If there is no such surface.
    """
    solid, _, coating = (part.strip() for part in name.partition(","))
    solid = _known(solid, SOLIDS, name)
    values = dict(SOLIDS[solid])
    label = solid
    if coating:
        coating = _known(coating, COATINGS, name)
        values |= COATINGS[coating]
        label = f"{solid}, {coating}"
    tables: dict[str, dict[str, Any]] = {"surface": {"provenance": f"library: {label}"}}
    for key, entry in values.items():
        table, _, last = key.rpartition(".")
        if table:
            tables.setdefault(table, {})[last] = entry.value
    return tables


def with_library(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the tables of a scene with a named surface written out.

    What the table ``coating`` gives counts before the library; without that table the monolayer is whole.
    """
    name = data.get("surface")
    if not isinstance(name, str):
        return data
    tables = library_tables(name)
    given = data.get("coating")
    if "coating" in tables and (given is None or isinstance(given, Mapping)):
        tables["coating"] = {**tables["coating"], **(given or {"sam_fraction": 1.0})}
    return {**data, **tables} if "coating" in tables else {**data, "surface": tables["surface"]}


def library_changes(name: str) -> dict[str, Any]:
    """Return a named surface as changes of a scene, for `Scene.replace`: its coverage stays."""
    tables = library_tables(name)
    changes: dict[str, Any] = {"surface": tables["surface"]}
    return changes | {f"coating.{key}": value for key, value in tables.get("coating", {}).items()}


def named_values(scene: Any) -> list[LibraryValue]:
    """Return the numbers of a scene that are those of the library, of a surface that was named there."""
    _, _, name = scene.surface.provenance.partition("library: ")
    solid, _, coating = name.partition(", ")
    if solid not in SOLIDS:
        return []
    found = []
    for key, entry in {**SOLIDS[solid], **COATINGS.get(coating, {})}.items():
        table, _, last = key.rpartition(".")
        if table and getattr(getattr(scene, table), last) == entry.value:
            found.append(entry)
    return found


def _known(part: str, among: Mapping[str, Any], name: str) -> str:
    """Return a part of a surface's name as the library writes it; capital letters do not count."""
    for known in among:
        if part.casefold() == known.casefold():
            return known
    kind = "surface" if among is SOLIDS else "monolayer"
    meant = did_you_mean(part, among)
    raise SceneError(
        "surface",
        shorten(name),
        f"the library has no {kind} {shorten(part)}; {meant + ' ' if meant else ''}known are {', '.join(among)}"
        f" (gearidae surfaces lists them with their sources)",
    )
