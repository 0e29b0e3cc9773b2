"""Surfaces by name: what a name stands for, what counts before it, and that each number says where it comes from."""

import jsonschema
import pytest

import gearidae as gd
from gearidae.scene.surface_library import COATINGS, SOLIDS

LOW_SPEED = gd.preset("teodorescu2009_low_speed")


def tables(**changes):
    return {**LOW_SPEED.to_dict(), **changes}


@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("coating", ["", *COATINGS])
def test_every_name_is_a_scene(solid, coating):
    name = f"{solid}, {coating}" if coating else solid
    data = tables(surface=name)
    del data["coating"]
    scene = gd.Scene.from_dict(data)
    for key, entry in {**SOLIDS[solid], **COATINGS.get(coating, {})}.items():
        table, _, last = key.rpartition(".")
        if table:
            assert getattr(getattr(scene, table), last) == entry.value
    assert scene.coating.sam_fraction == (1.0 if coating else 0.0)
    assert scene.surface.provenance == f"library: {name}"
    jsonschema.validate(data, gd.Scene.json_schema())


def test_the_paper_s_surface_is_silicon_with_ots():
    """But for the surface energy, which the paper prints as 1.5 J/m^2."""
    scene = gd.Scene.from_dict(tables(surface="silicon, OTS"))
    same = {"provenance": "", "energy": 1.5}
    assert scene.surface.model_copy(update=same) == LOW_SPEED.surface
    assert scene.coating.energy == LOW_SPEED.coating.energy


def test_keys_of_the_coating_count_before_the_library():
    scene = gd.Scene.from_dict(
        tables(surface="polysilicon, ots", coating={"sam_fraction": 0.4, "energy": 0.03})
    )
    assert (scene.coating.sam_fraction, scene.coating.energy, scene.coating.thickness) == (0.4, 0.03, 2.5e-9)


def test_replace_takes_the_monolayer_too_and_keeps_the_coverage():
    worn = LOW_SPEED.replace({"coating.sam_fraction": 0.5})
    scene = worn.replace({"surface": "polysilicon, FOTS"})
    assert (scene.coating.sam_fraction, scene.coating.energy, scene.coating.thickness) == (0.5, 0.02, 1e-9)
    assert worn.replace({"surface": "polysilicon, FOTS", "coating.energy": 0.05}).coating.energy == 0.05
    assert worn.replace({"surface": "polysilicon"}).coating == worn.coating


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("polysilicon, OTX", "did you mean OTS?"),
        ("steel", "known are silicon"),
        ("", "known are"),
        ("silicon, OTS, FOTS", "no monolayer"),
    ],
)
def test_an_unknown_name_is_refused(name, word):
    with pytest.raises(gd.SceneError, match=word) as error:
        gd.Scene.from_dict(tables(surface=name))
    assert error.value.key == "surface"


def test_the_table_has_each_number_with_its_source():
    table = gd.surfaces.library()
    assert len(table) == sum(map(len, [*SOLIDS.values(), *COATINGS.values()]))
    assert table["source"].str.len().min() > 0
    measured = table[~table["assumed"]]
    assert measured["source"].str.contains("doi:10.").all()
    assert float(table.loc[("polysilicon", "sliding friction"), "value"]) == 0.2
