"""Cases by name: those that ship and the presets need no file, and a file goes before both."""

from __future__ import annotations

from pathlib import Path

import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.cli.case import SHIPPED, read_scene
from gearidae.scene import PRESETS, dump_case

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", [*PRESETS, *SHIPPED])
def test_a_name_is_its_preset_or_its_case_file(name):
    scene = read_scene(name, [])
    assert scene.to_dict() | {"name": ""} == gd.preset(SHIPPED.get(name, name)).to_dict() | {"name": ""}
    if (CASES / f"{name}.toml").exists():
        assert scene == gd.load_case(CASES / f"{name}.toml")


def test_a_file_of_that_name_goes_first(folder):
    (folder / "low_speed").write_text(dump_case(gd.preset("roller_slow")))
    assert read_scene("low_speed", []).roller is not None


@pytest.mark.parametrize("command", [["check"], ["run", "--set", "run.duration=1 ms", "run.samples=11"]])
def test_commands_take_shipped_names(command, folder, capfd):
    assert main([command[0], "low_speed", *command[1:]]) == 0
    if command[0] == "run":
        assert "Archive: low_speed.nc" in capfd.readouterr().out


def test_a_mistyped_name_is_answered(capfd):
    assert main(["check", "low_sped"]) == 2
    assert "did you mean low_speed" in capfd.readouterr().err
