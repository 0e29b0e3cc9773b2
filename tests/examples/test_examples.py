"""The examples run as they stand, each in a folder of its own, and answer what they ask."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
PAGE = ROOT / "docs" / "examples.md"

# What the answer says, as a pattern, and the files that are left.
ANSWERS = {
    "assess_a_signal": (
        r"clear: 0\.71\d of the monolayer is left \(0\.7\d+ to 0\.7\d+\)",
        {"rig.csv", "assessed.png"},
    ),
    "does_it_start": (
        r"1\.4 pitches in 2 s, 0\.0 of them(.|\n)*3\.4 pitches in 2 s, 0\.0 of them(.|\n)*, [6-9]\.\d of them",
        set(),
    ),
    "how_worn_may_it_be": (r"4\.5e-18 N m: sticks at 0\.47 and below", {"worn.png"}),
    "laboratory_record": (
        r"drive torque: 4\.8e-18 \+- 1e-19 N m\nclear: 0\.66 of the monolayer(.|\n)*0\.66\d\)\nreport: worn\.html",
        {"new.csv", "worn.csv", "worn.html"},
    ),
    "long_run": (r"interrupted after \d+ samples(.|\n)*finished after 15001 samples", {"start_up.nc"}),
    "own_gears": (r"turns smoothly", {"own_gears.nc", "own_gears.toml"}),
    "read_with_dask": (r"SAM 1: a tooth leaves every 55\.\d ms", {"sweep.nc"}),
    "start_run_brake": (
        r"up: 0\.00 to 6\.00 ms(.|\n)*ing: 6\.00 to 8\.00 ms(.|\n)*ing: 8\.00 to \d+\.\d+ ms, -?0 r(.|\n)*: True",
        {"start_up.nc", "running.nc", "braking.nc"},
    ),
    "watch_the_teeth": (
        r"pair -?\d+, DRIVE: \d+\.\d nm, -\d+\.\d+ pN, FULLY_STRETCHED",
        {"teeth.png", "teeth.gif"},
    ),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    return tmp_path


@pytest.mark.parametrize("script", [pytest.param(path, id=path.stem) for path in EXAMPLES])
def test_example_answers_its_question_and_replaces_its_files(script, folder, capsys):
    answer, left = ANSWERS[script.stem]
    for name in left:
        (folder / name).write_bytes(b"of a run before")
    runpy.run_path(str(script), run_name="__main__")
    assert re.search(answer, capsys.readouterr().out)
    assert {path.name for path in folder.iterdir()} - {"cases"} == left
    assert all((folder / name).read_bytes() != b"of a run before" for name in left)


def test_every_example_is_in_the_documentation():
    page = PAGE.read_text(encoding="utf-8")
    assert {path.stem for path in EXAMPLES} == set(ANSWERS)
    for path in EXAMPLES:
        assert f"```{{literalinclude}} ../examples/{path.name}\n" in page
