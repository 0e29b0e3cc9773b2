"""Torque laws by their names, as a scene takes them."""

import re

import numpy as np
import pytest

import gearidae as gd
from gearidae.errors import SceneError
from gearidae.scene import Scene, dump_case, load_case, preset
from gearidae.torques import torque_law, torque_names

MOTOR = {"name": "motor", "parameters": [9e-18, 12.0]}


@pytest.fixture
def scene():
    return preset("teodorescu2009_low_speed")


def test_laws_of_the_package_are_found():
    assert torque_names() == ("motor",)
    assert torque_law("motor").function(0.0, 3.0, np.array([2.0, 12.0])) == 1.5


@pytest.mark.parametrize("shaft", ["drive", "load"])
def test_a_law_survives_every_way_of_writing_a_scene(scene, shaft, tmp_path):
    scene = scene.replace({f"{shaft}.law": MOTOR})
    assert getattr(scene, shaft).law.parameters == (9e-18, 12.0)
    assert Scene.from_dict(scene.to_dict()) == scene
    file = tmp_path / "case.toml"
    file.write_text(dump_case(scene), encoding="utf-8")
    assert load_case(file) == scene
    changed = scene.replace({f"{shaft}.law.parameters": [1e-17, 13.0]})
    assert getattr(changed, shaft).law.parameters == (1e-17, 13.0)
    assert getattr(scene.replace({f"{shaft}.law": None}), shaft).law is None


def test_scenes_without_a_law_are_written_as_before(scene):
    assert "law" not in str(scene.to_dict())
    assert "law" not in re.sub(r"#.*", "", dump_case(scene))


def test_one_number_needs_no_list(scene):
    gd.register_torque("push", parameters=1)(lambda t, speed, p: p[0])
    try:
        for value in (2e-18, [2e-18], np.array([2e-18]), np.float64(2e-18)):
            changed = scene.replace({"drive.law": {"name": "push", "parameters": value}})
            assert changed.drive.law.parameters == (2e-18,)
    finally:
        gd.unregister_torque("push")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"name": "moter", "parameters": [1, 2]}, r"drive\.law\.name = moter: must be one of motor"),
        ({"name": 3}, r"drive\.law\.name = 3: must be one of motor"),
        ({"parameters": [1, 2]}, r"drive\.law\.name = \(missing\)"),
        ({"name": "motor"}, r"drive\.law\.parameters = \[\]: the law motor takes 2 numbers"),
        ({"name": "motor", "parameters": [1, 2, 3]}, r"drive\.law\.parameters = .*takes 2 numbers"),
        (
            {"name": "motor", "parameters": [1, float("nan")]},
            r"drive\.law\.parameters.*must be a finite number",
        ),
        ({"name": "motor", "parameters": [1, "much"]}, r"drive\.law\.parameters.*must be a number"),
        ({"name": "motor", "parameters": [1, 2], "gain": 3}, r"drive\.law\.gain = 3: unknown key"),
        ("motor", r"drive\.law = motor: must be a table"),
    ],
)
def test_what_is_no_law_is_refused(scene, given, message):
    with pytest.raises(SceneError, match=message):
        scene.replace({"drive.law": given})


def test_a_load_with_a_law_is_dry(scene):
    assert not scene.load.is_dry
    assert scene.replace({"load.law": MOTOR}).load.is_dry


@pytest.mark.parametrize("name", ["", "two words", 5, None])
def test_what_is_no_name_is_refused(name):
    with pytest.raises(SceneError, match="must be a word"):
        gd.register_torque(name)


@pytest.mark.parametrize("count", [-1, 1.5, "two", 10**9])
def test_what_is_no_number_of_parameters_is_refused(count):
    with pytest.raises(SceneError, match=r"parameters = .*whole number in 0"):
        gd.register_torque("counted", parameters=count)


def test_names_are_taken_once():
    with pytest.raises(SceneError, match="motor: is the name of another torque law"):
        gd.register_torque("motor")(lambda t, speed, p: 0.0)
    with pytest.raises(SceneError, match=r"law\.name = mine: must be one of motor"):
        gd.unregister_torque("mine")
