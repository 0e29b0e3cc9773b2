"""Cases by name: those that ship and the presets need no file, and a file goes before both."""

from __future__ import annotations

from pathlib import Path

import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.cli.case import read_scene, shipped_cases
from gearidae.scene import PRESETS, dump_case

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", PRESETS)
def test_the_name_of_a_preset_is_the_preset(name):
    assert read_scene(name, []) == gd.preset(name)


@pytest.mark.parametrize("file", sorted(CASES.glob("*.toml")), ids=lambda file: file.stem)
def test_the_name_of_a_shipped_case_is_the_case(file):
    assert read_scene(file.stem, []) == gd.load_case(file)


def test_shipped_cases_are_looked_for_in_the_package_first(folder, monkeypatch):
    """As in a wheel, which has them inside."""
    (folder / "cases").mkdir()
    (folder / "cases" / "mine.toml").write_text(dump_case(gd.preset("roller_slow")))
    monkeypatch.setattr(gd, "__file__", str(folder / "__init__.py"))
    assert list(shipped_cases()) == ["mine"]
    assert read_scene("mine", ["run.samples=11"]).run.samples == 11


def test_a_file_of_that_name_goes_first(folder):
    (folder / "low_speed").write_text(dump_case(gd.preset("roller_slow")))
    assert read_scene("low_speed", []).roller is not None


SHORT = ["--set", "run.duration=1 us", "run.samples=11"]
VARY = "coating.sam_fraction=uniform(0.7, 0.8)"


@pytest.mark.parametrize(
    ("arguments", "output"),
    [
        (["check", "microengine"], ""),
        (["run", "inspection", *SHORT], "inspection.nc"),
        (["run", "running", *SHORT], "running.nc"),
        (["sweep", "run_down", "--over", "coating.sam_fraction=0.8,0.7", *SHORT], "run_down.nc"),
        (["ensemble", "high_speed", "--vary", VARY, "--size", "2", *SHORT], "high_speed_ensemble.nc"),
    ],
    ids=lambda words: words if isinstance(words, str) else words[0],
)  # fmt: skip
def test_commands_take_shipped_names(arguments, output, folder):
    assert main(arguments) == 0
    assert not output or (folder / output).is_file()


def test_a_mistyped_name_is_answered(capfd):
    assert main(["check", "low_sped"]) == 2
    assert "did you mean low_speed" in capfd.readouterr().err
