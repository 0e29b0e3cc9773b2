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
    assert torque_names() == ("microengine", "motor")
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
    assert not any("law" in (scene.to_dict().get(table) or {}) for table in ("drive", "load"))
    assert not re.search(r"^(\[(drive|load)\.law|law\b)", dump_case(scene), re.MULTILINE)


def test_one_number_needs_no_list(scene):
    gd.register_torque("push", parameters=1)(lambda t, speed, p: p[0])
    try:
        for value in (2e-18, [2e-18], np.array([2e-18]), np.float64(2e-18)):
            changed = scene.replace({"drive.law": {"name": "push", "parameters": value}})
            assert changed.drive.law.parameters == (2e-18,)
    finally:
        gd.unregister_torque("push")


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (
            {"name": "moter", "parameters": [1, 2]},
            r"drive\.law\.name = moter: must be one of microengine, motor",
        ),
        ({"name": 3}, r"drive\.law\.name = 3: must be one of microengine, motor"),
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
def test_what_is_no_law_is_refused(scene, law, message):
    with pytest.raises(SceneError, match=message):
        scene.replace({"drive.law": law})


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
    with pytest.raises(SceneError, match=r"law\.name = mine: must be one of microengine, motor"):
        gd.unregister_torque("mine")


ENGINE = {
    "name": "microengine",
    "radius": "5 um",
    "force": "1 uN",
    "frequency": [["0 ms", 0.0], ["2 ms", "0.6 kHz"]],
}


def test_named_parameters_have_units_and_defaults(scene, tmp_path):
    scene = scene.replace({"drive.law": ENGINE})
    assert scene.drive.law.numbers() == (5e-6, 1e-6, 0.0, 0.0, 0.0, 0.0, 0.0, 2e-3, 600.0)
    assert Scene.from_dict(scene.to_dict()) == scene
    file = tmp_path / "case.toml"
    file.write_text(dump_case(scene), encoding="utf-8")
    assert load_case(file) == scene
    changed = scene.replace({"drive.law.force": "2 uN", "drive.law.frequency": "300 Hz"})
    assert changed.drive.law.numbers() == (5e-6, 2e-6, 0.0, 0.0, 0.0, 0.0, 300.0)
    assert changed != scene


def test_parameters_without_a_unit_take_any(scene):
    gd.register_torque("named", parameters=("stiffness", "speed", "share"))(lambda t, angle, speed, p: p[0])
    try:
        law = {"name": "named", "stiffness": "2 uN/um", "speed": "30 deg/s", "share": 0.5}
        changed = scene.replace({"load.law": law})
        assert changed.load.law.numbers() == pytest.approx((2.0, np.pi / 6, 0.5), rel=1e-15, abs=0)
        for text in ("2 kittens", "a lot", "2 m m m)"):
            with pytest.raises(SceneError, match=r"load\.law\.speed"):
                scene.replace({"load.law": law | {"speed": text}})
    finally:
        gd.unregister_torque("named")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"force": None}, r"law\.force = \(missing\): is required by the law microengine: amplitude F0"),
        ({"radius": "5 s"}, r"law\.radius = 5 s: the unit 's' does not fit; .* m"),
        (
            {"spring": 2},
            r"law\.spring = 2: unknown key; did you mean|law\.spring = 2: unknown key; known are",
        ),
        (
            {"parameters": [1.0]},
            r"law\.parameters = \[1\.0\]: the law microengine has them by name: radius, force",
        ),
        ({"radius": [[0, 1], [1, 2]]}, r"law\.radius"),
        ({"frequency": [[0, 1], [0, 2]]}, r"law\.frequency = .*increas"),
        ({"frequency": [[0, 1], [1, "2 s"]]}, r"law\.frequency = .*the unit 's' does not fit"),
        ({"frequency": [[0, 1], [1]]}, r"law\.frequency"),
        ({"frequency": []}, r"law\.frequency"),
    ],
)
def test_named_parameters_that_do_not_fit(scene, changes, message):
    parameters = {name: value for name, value in (ENGINE | changes).items() if value is not None}
    with pytest.raises(SceneError, match=message) as refused:
        scene.replace({"drive.law": parameters})
    assert "\n" not in str(refused.value)


def test_unknown_parameters_are_no_keys(scene):
    with pytest.raises(SceneError, match=r"drive\.law\.strength = 2: unknown key"):
        scene.replace({"drive.law": ENGINE}).replace({"drive.law.strength": 2})
    with pytest.raises(SceneError, match=r"drive\.law\.radius"):
        scene.replace({"drive.law": MOTOR}).replace({"drive.law.radius": 2})


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        (("a", "a"), "names that differ"),
        (("name",), "not name and not parameters"),
        (("a b",), "must be a word"),
        ("radius", "a list of names"),
        (-1, "whole number"),
    ],
)
def test_declarations_that_do_not_fit(parameters, message):
    with pytest.raises(SceneError, match=message):
        gd.register_torque("never", parameters=parameters)(lambda t, speed, p: 0.0)
    assert "never" not in torque_names()


def test_a_law_takes_three_or_four_arguments():
    with pytest.raises(SceneError, match="takes 2 arguments; must take t, speed, p or t, angle, speed, p"):
        gd.register_torque("never")(lambda t, p: 0.0)


@pytest.mark.parametrize(
    "harmonic", [{"amplitude": 1e-12}, {"amplitude": 1e-12, "frequency": 1.0, "order": 2}]
)
def test_a_harmonic_follows_time_or_angle(scene, harmonic):
    with pytest.raises(SceneError, match="either the frequency in time or the order"):
        scene.replace({"drive.harmonic": harmonic})


def test_a_harmonic_of_the_angle_survives_every_way_of_writing_a_scene(scene, tmp_path):
    scene = scene.replace({"drive.harmonic": {"amplitude": 1e-18, "order": 3}})
    assert Scene.from_dict(scene.to_dict()) == scene
    file = tmp_path / "case.toml"
    file.write_text(dump_case(scene), encoding="utf-8")
    assert load_case(file) == scene
