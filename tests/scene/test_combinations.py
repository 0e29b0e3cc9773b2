"""Pairs of features: every pair of the table is tried as a scene, and `auto` decides by the same table."""

import re

import pytest

import gearidae as gd
from gearidae.scene.combinations import FEATURES, REFUSED, may_deflect, reason_to_stay_rigid
from reference.feature_scenes import BASE, CHANGES, scene_with

TABLE = gd.combinations()
ALLOWED = TABLE[TABLE.allowed]
PAIRS = list(zip(ALLOWED["first"], ALLOWED["second"], strict=True))


def test_the_table_has_each_pair_of_features_once():
    assert set(CHANGES) == set(FEATURES)
    pairs = list(zip(TABLE["first"], TABLE["second"], strict=True))
    assert (
        len(pairs) == len(set(pairs)) == len(FEATURES) * (len(FEATURES) - 1) // 2 - 2
    )  # two keys with two laws each
    assert {(first, second) for first, second in pairs if first == second} == set()


def test_five_pairs_are_refused_each_for_its_reason():
    refused = TABLE[~TABLE.allowed]
    assert len(refused) == len(REFUSED) == 5
    assert set(refused["first"]) == {"elastic bodies", "attraction"}
    assert refused.reason.str.len().min() > 40
    assert (ALLOWED.reason == "").all()


@pytest.mark.parametrize("name", FEATURES)
def test_a_scene_has_a_feature_only_if_it_is_given(name):
    assert FEATURES[name].is_in(scene_with(name))
    assert not FEATURES[name].is_in(BASE)


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_an_allowed_pair_is_a_scene(first, second):
    scene = scene_with(first, second)
    assert {name for name, feature in FEATURES.items() if feature.is_in(scene)} == {first, second}


@pytest.mark.parametrize("pair", REFUSED)
def test_a_refused_pair_is_no_scene(pair):
    with pytest.raises(gd.SceneError, match=re.escape(REFUSED[pair])) as error:
        scene_with(*pair)
    assert error.value.key == FEATURES[pair[0]].key


@pytest.mark.parametrize("name", [name for name in FEATURES if name != "elastic bodies"])
def test_auto_stays_rigid_where_elastic_is_refused(name):
    scene = scene_with(name).replace({"contact.bodies": "auto"})
    refused = ("elastic bodies", name) in REFUSED
    assert may_deflect(scene) is not refused
    assert (REFUSED.get(("elastic bodies", name), "-") in reason_to_stay_rigid(scene)) is refused


# -- older names -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "bodies", "roughness"),
    [
        ("auto", "auto", "statistical"),
        ("asperity", "rigid", "statistical"),
        ("elastic", "elastic", "statistical"),
        ("population", "rigid", "discrete"),
    ],
)
def test_older_names_of_the_contact_are_read(model, bodies, roughness):
    scene = gd.preset("teodorescu2009").replace({"contact.model": model})
    assert (scene.contact.bodies, scene.contact.roughness) == (bodies, roughness)
    assert scene == gd.preset("teodorescu2009").replace(
        {"contact.bodies": bodies, "contact.roughness": roughness}
    )
    assert "model" not in scene.to_dict()["contact"]


def test_the_older_name_of_the_friction_law_is_read():
    scene = gd.preset("teodorescu2009").replace({"contact.friction_law": "net", "contact.friction": 0.1})
    assert scene.contact.friction_law == "coulomb"


def test_an_older_name_is_said_in_one_line(caplog):
    from gearidae.scene import older_names

    older_names._note.cache_clear()
    for _ in range(2):
        gd.preset("teodorescu2009").replace({"contact.model": "population"})
    (line,) = caplog.messages
    assert 'contact.bodies = "rigid"' in line
    assert 'contact.roughness = "discrete"' in line


@pytest.mark.parametrize("other", ["bodies", "roughness"])
def test_older_and_present_names_are_not_given_together(other):
    value = {"bodies": "rigid", "roughness": "discrete"}[other]
    with pytest.raises(gd.SceneError, match="cannot be given beside") as error:
        gd.preset("teodorescu2009").replace({"contact": {"model": "elastic", other: value}})
    assert error.value.key == "contact.model"
    with pytest.raises(gd.SceneError, match="cannot be given beside"):
        gd.preset("teodorescu2009").replace({"contact.model": "elastic", f"contact.{other}": value})
