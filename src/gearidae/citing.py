"""The references that a dataset rests on: model, laws, numbers of the surface, solver and program."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import gearidae
from gearidae.archive.select import scene_of
from gearidae.asperities import law_class
from gearidae.errors import SceneError
from gearidae.references import (
    FULLER_TABOR_1975,
    GARCIA_SNIEGOWSKI_1995,
    GIRIFALCO_GOOD_1957,
    GREENWOOD_WILLIAMSON_1966,
    HINDMARSH_2005,
    JOHNSON_1985,
    RANDALL_2024,
    TEODORESCU_2009,
    Reference,
)
from gearidae.scene import Scene
from gearidae.scene.surface_library import named_values

if TYPE_CHECKING:
    import xarray as xr

STYLES = ("text", "bibtex")


def cite(ds: xr.Dataset, style: str = "text") -> str:
    """List the references that a dataset rests on.

    Parameters
    ----------
    ds : xarray.Dataset
        A run, a sweep, or what a study has found.
    style : str, optional
        ``text``, a line for each reference, or ``bibtex``, an entry for each.

    Returns
    -------
    str
        The paper of the model, the laws of asperities and of wear, the sources of a surface from the library, the
        solver, and gearidae with its version.

    Raises
    ------
    SceneError
        If the dataset carries no scene, or there is no such style.

    Examples
    --------
    >>> import gearidae as gd
    >>> print(gd.cite(gd.open("worn.nc"), "bibtex"))  # doctest: +SKIP
    """
    if style not in STYLES:
        raise SceneError("style", style, f"must be {' or '.join(STYLES)}")
    found = references_of(ds)
    if style == "bibtex":
        return "\n\n".join(reference.bibtex for reference in found)
    return "\n".join(reference.text for reference in found)


def references_of(ds: xr.Dataset) -> tuple[Reference, ...]:
    """Return the references that a dataset rests on, each once.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    scene = Scene.from_dict(scene_of(ds))
    return tuple(dict.fromkeys([*_of_scene(scene, ds), *_of_study(ds), *_of_programs(ds)]))


def _of_scene(scene: Scene, ds: xr.Dataset) -> Iterator[Reference]:
    yield TEODORESCU_2009
    contact = scene.contact
    yield from law_class(contact.asperity).references
    yield GREENWOOD_WILLIAMSON_1966
    if contact.roughness == "statistical":
        yield FULLER_TABOR_1975
    if ds.attrs.get("contact_bodies", contact.bodies) != "rigid":
        yield JOHNSON_1985
    if scene.coating.pairing == "independent":
        yield GIRIFALCO_GOOD_1957
    if scene.drive is not None and scene.drive.law is not None and scene.drive.law.name == "microengine":
        yield GARCIA_SNIEGOWSKI_1995
    for value in named_values(scene):
        text, _, doi = value.source.partition(", doi:")
        if doi:
            yield _as_reference(text, re.split(r"[,:]", doi)[0])


def _as_reference(text: str, doi: str) -> Reference:
    """Make a reference of what the library of surfaces says of a number: ``Mayer et al. 2000``."""
    if doi == TEODORESCU_2009.doi:
        return TEODORESCU_2009
    found = re.search(r"([A-Z]\w+)\D* (\d{4})$", text)
    assert found is not None  # a test reads all of the library
    return Reference(f"{found[1].lower()}{found[2]}", (), text, 0, doi=doi)


def _of_study(ds: xr.Dataset) -> Iterator[Reference]:
    """Laws of wear that a life was computed with."""
    if not isinstance(ds.attrs.get("law"), str):
        return
    from gearidae.wear import Arrhenius  # which citing a run does without
    from gearidae.wear.registry import loss_law_references

    law = json.loads(ds.attrs["law"])
    while isinstance(law, dict):
        name = str(law.get("name"))
        yield from Arrhenius.references if name == Arrhenius.name else loss_law_references(name)
        law = law.get("law")  # of stress-assisted loss: the law that is assisted


def _of_programs(ds: xr.Dataset) -> Iterator[Reference]:
    yield HINDMARSH_2005
    yield RANDALL_2024
    written = re.match(r"gearidae (\S+?)(?:,|$)", str(ds.attrs.get("source", "")))
    yield Reference(
        "gearidae",
        ("The gearidae authors",),
        "gearidae: dynamics of rough, adhesive, monolayer-protected MEMS gears",
        0,
        version=written[1] if written else gearidae.__version__,
    )
