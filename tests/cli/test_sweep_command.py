"""``gearidae sweep``: what it adds to `gearidae.sweep` is options, and words for the user."""

from __future__ import annotations

import os
import re
import signal

import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.analysis.verdict.headline import headline
from gearidae.archive.journal import Journal
from gearidae.cli import main
from gearidae.studies.announcement import draw_words
from sweeps import without_times

FRACTIONS = [1.0, 0.5, 0.45]
SHORT = ["--set", "run.duration=1 ms", "run.samples=11"]
SWEEP = ["sweep", "teodorescu2009_low_speed", "--over", "coating.sam_fraction=1,0.5,0.45", *SHORT]
LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "1 ms", "run.samples": 11})


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def interrupted(monkeypatch, folder, capsys):
    """Files of a sweep that Ctrl-C ended in its last run."""
    solve = engine.solve

    def deed(scene, **options):
        if scene.coating.sam_fraction == 0.45:
            os.kill(os.getpid(), signal.SIGINT)
        return solve(scene, **options)

    with monkeypatch.context() as patch:
        patch.setattr(engine, "solve", deed)
        assert main([*SWEEP, "--jobs", "1", "-o", "out.nc"]) == 130
    assert "--resume" in capsys.readouterr().err
    with Journal(folder / "out.nc.journal", "runs") as journal:
        assert len(list(journal.frames())) == 2
    return folder


def test_resume(interrupted, capsys):
    assert main([*SWEEP, "-o", "out.nc"]) == 2
    assert "go on with --resume" in capsys.readouterr().err
    assert main([*SWEEP, "-o", "out.nc", "--resume"]) == 0
    expected = gd.sweep(LOW, {"coating.sam_fraction": FRACTIONS})
    xr.testing.assert_identical(without_times(gd.open_archive("out.nc")), without_times(expected))
    assert [path.name for path in interrupted.iterdir()] == ["out.nc"]


def test_a_damaged_run_is_one_line(interrupted, capsys):
    path = interrupted / "out.nc.journal"
    content = path.read_bytes()
    path.write_bytes(content[:-9] + bytes([content[-9] ^ 1]) + content[-8:])
    assert main([*SWEEP, "-o", "out.nc", "--resume"]) == 0
    complaint = capsys.readouterr().err
    assert complaint.startswith("gearidae: ")
    assert "ignored and computed again" in complaint
    assert complaint.count("\n") == 1


def test_resume_and_overwrite_contradict_each_other(capsys):
    assert main([*SWEEP, "--resume", "--overwrite"]) == 2
    assert "choose one" in capsys.readouterr().err


def test_zipped(capsys):
    command = ["sweep", "teodorescu2009_low_speed", *SHORT, "--zipped", "-o", "out.nc"]
    over = ["--over", "drive.torque=4.5e-18,4e-18", "coating.sam_fraction=1,0.5"]
    assert main([*command, *over]) == 0
    assert gd.open_archive("out.nc").sam_fraction.dims == ("torque",)
    assert main([*command, *over, "--over", "load.drag=1:3:1", "--overwrite"]) == 2
    assert "load.drag = 3 values: must be as many as drive.torque has, 2" in capsys.readouterr().err


def test_what_will_be_run_is_said_first_and_the_answer_last(folder, capsys):
    assert main([*SWEEP, "-o", "out.nc", "--jobs", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == (
        "Sweep of teodorescu2009_low_speed: 3 runs, coating.sam_fraction = 1, 0.5, 0.45; less than a second"
    )
    assert lines[-2:] == ["Archive: out.nc", "3 runs: turns smoothly 3."]
    assert main([*SWEEP, "-o", "quiet.nc", "--quiet"]) == 0
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("arguments", "first"),
    [
        (
            [
                "coating-map",
                "low_speed",
                *SHORT[:-1],
                "run.samples=101",
                "--over",
                "coating.sam_fraction=1,0.6",
            ],
            "Map of low_speed: 2 runs, coating.sam_fraction = 1, 0.6; less than a second",
        ),
        (["pull-off", "low_speed", "--seeds", "3"], "Pull-off of low_speed: 3 drawn pairs"),
        (
            ["starting-torque", "low_speed"],
            "Starting torque of low_speed: own coating; one torque is tried after the other",
        ),
    ],
)
def test_a_study_says_first_what_it_will_run(arguments, first, folder, capsys):
    assert main([*arguments, "-o", "out.nc"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == first


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--over", "run.duration=1,2"], "cannot be swept"),
        (["--over", "coating.sam_fraction=0.5,0.5"], "stands twice"),
        (["--over", "coating.sam_fraction=2,3"], "coating.sam_fraction"),
    ],
)
def test_a_sweep_that_cannot_be_meant_is_refused_before_anything_is_said(arguments, said, folder, capsys):
    assert main(["sweep", "low_speed", *arguments]) == 2
    out, complaint = capsys.readouterr()
    assert out == ""
    assert said in complaint
    assert not list(folder.iterdir())


def test_the_time_of_many_runs():
    """20,000 times the time that `check` expects of one, four at a time."""
    scene = LOW.replace({"run.duration": 10.0})
    words = draw_words(scene, {"load.drag": "uniform(8e-18, 8.001e-18)"}, 20_000, 4)
    match = re.search(r"20000 runs, .*; some ([\d.]+) min with 4 at a time", words)
    assert float(match[1]) == pytest.approx(5000 * gd.studies.run_time(scene).seconds / 60.0, rel=0.1)


def test_the_sentence_of_a_sweep_names_where_the_gear_begins_to_stick():
    ds = gd.sweep(LOW.replace({"run.duration": "0.3 s"}), {"coating.sam_fraction": [0.8, 0.45, 0.47, 0.6]})
    assert headline(ds) == (
        "4 runs: turns smoothly 2, sticks 2. "
        "The gear sticks at sam_fraction = 0.47 and below, and not at 0.6 and above."
    )
    assert headline(ds.isel(sam_fraction=1)) == f"The gear {gd.outcomes(ds.isel(sam_fraction=1))[0].words}."


def test_the_sentence_of_a_sweep_gives_its_values_with_their_unit():
    scene = LOW.replace({"run.duration": "0.3 s", "coating.sam_fraction": 0.47})
    ds = gd.sweep(scene, {"drive.torque": ["4.5 aN m", "0.3 fN m"]})
    assert headline(ds).endswith(
        "The gear sticks at torque = 4.5 aN m and below, and not at 300 aN m and above."
    )
