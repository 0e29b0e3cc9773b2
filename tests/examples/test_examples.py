"""The examples, which are the gallery, run as they stand, each in a folder of its own, and answer what they ask."""

from __future__ import annotations

import ast
import re
import runpy
from importlib import import_module
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))

# What the answer says, as a pattern, and the files that are left.
ANSWERS: dict[str, tuple[str, set[str]]] = {
    "assess_a_signal": (r"clear: 0\.71\d of the monolayer is left \(0\.7\d+ to 0\.7\d+\)", {"rig.csv"}),
    "braking": (r"closed form: 19\.34 us; the run: 19\.3\d us\nheld by dry resistance", set()),
    "does_it_start": (
        r"1\.4 pitches in 2 s, 0\.0 of them(.|\n)*3\.4 pitches in 2 s, 0\.0 of them(.|\n)*, [6-9]\.\d of them",
        set(),
    ),
    "how_hard_do_teeth_hit": (r"5\d\d impacts: median 1\.\d uN, largest 14\.\d uN", set()),
    "how_worn_may_it_be": (
        r"4\.5e-18 N m: sticks at 0\.47 and below\n9e-18 N m: sticks at 0\.5 and below",
        set(),
    ),
    "hub_life": (r"pinion hub +5\.3\de\+04|pinion hub +5\.3e\+04(.|\n)*pin +1\.27e\+05", set()),
    "humid_air": (r"0\.50 +2424(.|\n)*0\.95 +155", set()),
    "laboratory_record": (
        r"drive torque: 4\.8e-18 \+- 1e-19 N m\nclear: 0\.66 of the monolayer(.|\n)*0\.66\d\)\nreport: worn\.html",
        {"new.csv", "worn.csv", "worn.html"},
    ),
    "long_run": (r"interrupted after \d+ samples(.|\n)*finished after 15001 samples", {"start_up.nc"}),
    "one_tooth_proud": (r"perfect: 0\.8\d uN\none tooth proud: 1\.\d\d uN", set()),
    "operating_map": ("", set()),
    "order_tracking": (r"1\d{5} samples", set()),
    "own_gears": (r"turns smoothly", {"own_gears.nc", "own_gears.toml"}),
    "probability_of_sticking": (r"0\.36, 95 % between 0\.25 and 0\.48", set()),
    "read_with_dask": (r"SAM 1: a tooth leaves every 55\.\d ms", {"sweep.nc"}),
    "specimens": (r"50% +424\.1\n(.|\n)*max +[89]\d\d", set()),
    "start_run_brake": (
        r"up: 0\.00 to 6\.00 ms(.|\n)*ing: 6\.00 to 8\.00 ms(.|\n)*ing: 8\.00 to 11\.00 ms, -?0 r(.|\n)*: True",
        {"start_up.nc", "running.nc", "braking.nc"},
    ),
    "start_up": (r"started at 3\.086 ms, with 7\.500 pN m\nthe dry load alone takes 7\.500 pN m", set()),
    "starting_torque": (r"0\.60 +0\.18 +0\.03\n0\.55 +2\.78 +0\.09\n(.|\n)*0\.45 +148\.\d+ +1\.3\d", set()),
    "surfaces": (
        r"silicon: sticks(.|\n)*oxidised silicon: turned smoothly(.|\n)*polysilicon, FOTS: turned smoothly",
        set(),
    ),
    "tested_gears": ("", set()),
    "transmission": (
        r"engine: turns at 1 of(.|\n)*idler: turns at -1/2 of(.|\n)*output: turns at 1/4 of",
        set(),
    ),
    "watch_the_teeth": (r"pair -?\d+, DRIVE: \d+\.\d nm, -\d+\.\d+ pN, FULLY_STRETCHED", {"teeth.gif"}),
}

# These take some seconds each; `make docs` runs them, too.
LONG = {
    "hub_life",
    "one_tooth_proud",
    "operating_map",
    "order_tracking",
    "probability_of_sticking",
    "starting_torque",
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    return tmp_path


@pytest.fixture
def pyplot():
    mpl.use("agg")
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


def pictures(names):
    """The figures that names of a script stand for, itself or by their axes."""
    found = (value.get_figure(root=True) for value in names.values() if isinstance(value, Artist))
    return {figure for figure in found if isinstance(figure, Figure)}


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(path, id=path.stem, marks=pytest.mark.by_hand if path.stem in LONG else ())
        for path in EXAMPLES
    ],
)
def test_example_answers_its_question_and_replaces_its_files(script, folder, capsys, pyplot):
    answer, left = ANSWERS[script.stem]
    for name in left:
        (folder / name).write_bytes(b"of a run before")
    names = runpy.run_path(str(script), run_name="__main__")
    assert re.search(answer, capsys.readouterr().out)
    assert {path.name for path in folder.iterdir()} - {"cases"} == left
    assert all((folder / name).read_bytes() != b"of a run before" for name in left)
    shown = pictures(names)
    assert shown
    for figure in shown:
        figure.canvas.draw()


def test_every_example_has_an_answer():
    assert {path.stem for path in EXAMPLES} == set(ANSWERS)
    assert len(EXAMPLES) >= 16


@pytest.mark.parametrize("script", [pytest.param(path, id=path.stem) for path in EXAMPLES])
def test_example_is_a_page_of_the_gallery(script):
    title, line, *rest = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))).split("\n")
    assert title.endswith("?")
    assert line == "=" * len(title)
    assert "".join(rest).strip()


@pytest.mark.parametrize(
    "script", [pytest.param(path, id=path.stem) for path in EXAMPLES if path.stem in LONG]
)
def test_names_in_long_examples_exist(script):
    """The functions of the package that a script calls by their full names: what a renaming would break."""
    calls = [
        ast.unparse(node)
        for node in ast.walk(ast.parse(script.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and ast.unparse(node).startswith("gd.")
    ]
    assert calls
    for call in calls:
        value = import_module("gearidae")
        for name in call.split("(")[0].split(".")[1:]:
            value = getattr(value, name)


def test_a_picture_is_found_by_its_axes():
    figure = Figure()
    assert pictures({"ax": figure.add_subplot(), "n": 3, "again": figure}) == {figure}
    assert pictures({"Axes": Axes}) == set()
