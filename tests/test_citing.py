"""The references that a dataset rests on."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive.provenance import provenance
from gearidae.asperities import law_class, law_names
from gearidae.citing import references_of
from gearidae.references import ARCHARD_1953
from gearidae.scene.surface_library import COATINGS, SOLIDS
from gearidae.wear import loss_law_names
from gearidae.wear.registry import loss_law_references

CASES = Path(__file__).parents[1] / "cases"
LOW = gd.preset("teodorescu2009_low_speed")


def dataset(scene, **attributes):
    return xr.Dataset(attrs={**provenance(scene, "tested"), **attributes})


def keys(scene, **attributes):
    return [reference.key for reference in references_of(dataset(scene, **attributes))]


def test_a_run_cites_the_paper_its_laws_the_solver_and_the_program():
    assert keys(LOW.replace({"contact.bodies": "rigid"})) == [
        "teodorescu2009", "johnson1971", "greenwood1966", "fuller1975", "hindmarsh2005", "randall2024", "gearidae",
    ]  # fmt: skip
    maugis = LOW.replace({"contact.asperity": "maugis", "contact.bodies": "elastic"})
    assert {"maugis1992", "kim1998", "johnson1985"} <= {*keys(maugis)}
    assert "johnson1985" not in keys(maugis, contact_bodies="rigid")  # what was computed decides
    assert "fuller1975" not in keys(LOW.replace({"contact.roughness": "discrete"}))
    assert "garcia1995" in keys(gd.load_case(CASES / "microengine.toml"))


def test_the_numbers_of_a_named_surface_bring_their_sources():
    named = LOW.replace({"surface": "polysilicon, OTS"})
    assert {"delrio2007", "castillo2015"} <= {*keys(named)}
    changed = named.replace({"coating.thickness": "3 nm"})
    assert "castillo2015" not in keys(changed)
    for entry in (entry for values in (*SOLIDS.values(), *COATINGS.values()) for entry in values.values()):
        if not entry.assumed:
            assert re.search(r"[A-Z]\w+\D* \d{4}, doi:10\.\d{4,}/\S", entry.source), entry


def test_a_life_cites_its_law_of_wear():
    law = {"name": "arrhenius", "law": {"name": "sliding_work", "coefficient": 1.0}}
    assert {"zhurkov1965", "gotsmann2008", "archard1953"} <= {*keys(LOW, law=json.dumps(law))}
    assert "archard1953" not in keys(LOW, law=json.dumps({"name": "somebody's own"}))


def test_every_law_of_the_package_has_a_reference():
    assert all(law_class(name).references for name in law_names())
    assert all(loss_law_references(name) for name in loss_law_names())


def test_text_and_bibtex():
    assert (
        ARCHARD_1953.source
        == "J. F. Archard, Journal of Applied Physics 24 (1953) 981-988, doi:10.1063/1.1721448"
    )
    assert ARCHARD_1953.bibtex == (
        "@article{archard1953,\n  author = {J. F. Archard},\n  title = {{Contact} and rubbing of flat surfaces},\n"
        "  journal = {Journal of Applied Physics},\n  volume = {24},\n  pages = {981--988},\n  year = {1953},\n"
        "  doi = {10.1063/1.1721448}\n}"
    )
    lines = gd.cite(dataset(LOW)).splitlines()
    assert len(lines) == len(keys(LOW))
    assert lines[-1] == (
        "The gearidae authors, gearidae: dynamics of rough, adhesive, monolayer-protected MEMS gears, "
        f"version {gd.__version__}"
    )
    entries = gd.cite(dataset(LOW.replace({"surface": "polysilicon, OTS"})), "bibtex").split("\n\n")
    assert all(
        re.fullmatch(r"@(article|book|misc)\{\w+,\n(  \w+ = \{.+\},?\n)+\}", entry) for entry in entries
    )
    assert all(entry.count("{") == entry.count("}") for entry in entries)
    with pytest.raises(gd.SceneError, match="must be text or bibtex"):
        gd.cite(dataset(LOW), "ris")
    with pytest.raises(gd.SceneError):
        gd.cite(xr.Dataset())


def test_the_program_and_the_paper_are_those_of_the_citation_file():
    cited = (Path(__file__).parents[1] / "CITATION.cff").read_text(encoding="utf-8")
    paper, *_, program = references_of(dataset(LOW))
    assert f'title: "{program.title}"' in cited
    assert f"version: {program.version}" in cited
    for value in (paper.title, paper.journal, paper.volume, paper.year, paper.doi, *paper.pages.split("-")):
        assert str(value) in cited
