"""A scene has gears or a roller: its tables say of which kind it is, however it is made."""

import copy
import pickle
from typing import Any

import pytest

import gearidae as gd
from gearidae.scene import GearScene, RollerScene, Scene, describe_keys, preset, require_gears
from gearidae.scene.scene import keys_of

KINDS = {"teodorescu2009_low_speed": GearScene, "roller_slow": RollerScene}


def made(name: str) -> list[Scene]:
    """The same scene in each way that there is to make one."""
    scene = preset(name)
    tables = {table: value for table, value in scene if value is not None}
    return [
        scene,
        Scene.from_dict(scene.to_dict()),
        Scene(**tables),
        KINDS[name](**tables),
        pickle.loads(pickle.dumps(scene)),
        copy.deepcopy(scene),
        scene.model_copy(),
        scene.replace({}),
    ]


@pytest.mark.parametrize("name", KINDS)
def test_a_scene_is_of_the_kind_of_its_tables(name: str) -> None:
    for scene in made(name):
        assert type(scene) is KINDS[name]
        assert isinstance(scene, gd.Scene)
        assert scene == preset(name)
        assert hash(scene) == hash(preset(name))


def test_other_tables_make_another_kind() -> None:
    gears, roller = preset("teodorescu2009_low_speed"), preset("roller_slow")
    none: dict[str, Any] = dict.fromkeys(("gears", "mesh", "drive", "load", "initial"))
    other = gears.replace({**none, "roller": roller.to_dict()["roller"]})
    assert isinstance(other, RollerScene)
    again = other.replace({**gears.to_dict(), "roller": None})
    assert isinstance(again, GearScene)
    assert again == gears


def test_a_kind_takes_no_other_tables() -> None:
    gears, roller = preset("teodorescu2009_low_speed").to_dict(), preset("roller_slow").to_dict()
    with pytest.raises(gd.SceneError, match="is required in a scene without a roller"):
        GearScene(**roller)
    with pytest.raises(gd.SceneError, match="is required in a scene without gears"):
        RollerScene(surface=roller["surface"], run=roller["run"])
    with pytest.raises(gd.SceneError, match="a roller takes no gears"):
        Scene(**{**gears, **roller})


def test_gears_are_required_of_those_only() -> None:
    gears = preset("teodorescu2009_low_speed")
    assert require_gears(gears) is gears
    for other in (preset("roller_slow"), "gears", None):
        with pytest.raises(gd.SceneError, match="must be a scene with gears"):
            require_gears(other)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS.values())
def test_all_kinds_describe_the_same_keys(kind: type[Scene]) -> None:
    assert keys_of(kind) == describe_keys()
    assert kind.json_schema() == Scene.json_schema()
