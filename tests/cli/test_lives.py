"""``gearidae lives``: keys and parameters of the law drawn, the archive, its picture, and Ctrl-C with two at a time."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.cli import main
from gearidae.wear.lives import rates

CASE = "teodorescu2009_low_speed"
LAW = ["--law", "adhesion_work", "--parameter", "energy=1e-6"]
SETTINGS = ["--set", "coating.sam_fraction=0.9"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_lives_are_written_shown_and_drawn(folder, capsys):
    drawn = ["--vary", "law.energy=uniform(1 uJ/m^2, 2 uJ/m^2)", "--size", "2", "--jobs", "1"]
    assert main(["lives", CASE, *LAW[:2], *drawn, "--fraction", "0.899", *SETTINGS]) == 0
    printed = capsys.readouterr().out
    assert "lives of 2 coatings" in printed
    assert "100 % of the members" in printed
    assert "89.9 %" in printed
    ds = gd.studies.open_lives(f"{CASE}_lives.nc")
    assert ds.energy.attrs["units"] == "J/m^2"
    assert json.loads(ds.attrs["ensemble"])["distributions"] == {"law.energy": "uniform(1 uJ/m^2, 2 uJ/m^2)"}
    # of one scene a life lasts in proportion to the energy
    lasted = ds.passages_turning / ds.energy
    np.testing.assert_allclose(lasted, lasted[0], rtol=1e-4)  # last digits of the states
    assert main(["plot", f"{CASE}_lives.nc", "-o", "lives.png"]) == 0
    assert (folder / "lives.png").stat().st_size > 1000
    capsys.readouterr()
    assert main(["info", f"{CASE}_lives.nc"]) == 0
    printed = capsys.readouterr().out
    assert str(ds.attrs["title"]) in printed
    assert "passages_to_sticking" in printed
    assert "coating.sam_fraction" in printed
    assert "None of 2 gears sticks as far as they were followed." in printed
    assert main(["report", f"{CASE}_lives.nc"]) == 0


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("law.energie=normal(1, 0.1)", "is no parameter of the loss law adhesion_work; it has law.energy"),
        ("law.energy=normal(1 m, 0.1)", "does not fit"),
        ("law.energy=uniform(-1, 1)", "must be above 0"),
        ("drive.torqe=normal(1, 0.1)", "drive.torque"),
        ("law.energy=3", "must be one of normal(mean, standard deviation)"),
    ],
)
def test_wrong_draws_are_told_in_a_line(vary, words, folder, capsys):
    assert main(["lives", CASE, *LAW, "--vary", vary, "--size", "4"]) == 2
    printed = capsys.readouterr().err
    assert words in printed
    assert printed.count("\n") == 1
    assert not list(folder.iterdir())


def test_parameters_that_are_neither_given_nor_drawn_are_named(capsys):
    assert (
        main(["lives", CASE, *LAW[:2], "--vary", "drive.torque=normal(4.5e-18, 1e-19)", "--size", "4"]) == 2
    )
    assert "adhesion_work.energy = (missing): is required" in capsys.readouterr().err


@pytest.mark.by_hand
def test_ctrl_c_keeps_the_lives_that_are_done(folder, monkeypatch):
    """Two at a time in threads, which Ctrl-C does not reach: they end between two states, and go on from there."""
    command = [
        "lives",
        CASE,
        *LAW,
        "--vary",
        "drive.torque=uniform(4.4e-18, 4.6e-18)",
        "--size",
        "4",
        "--jobs",
        "2",
    ]
    command += ["--fraction", "0.888", "--tolerance", "0.03", "--quiet", *SETTINGS]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *command, "-o", "cut.nc"],
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    kept = folder / "cut.nc.lives"
    try:
        while process.poll() is None and not list(kept.glob("*.nc")):
            time.sleep(0.02)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130
    assert "resume" in err
    assert "Traceback" not in err
    endings = []
    for path in kept.glob("*.nc"):
        with xr.open_dataset(path) as ds:
            endings.append(ds.attrs["ending"])
    done = endings.count("coverage")
    assert 1 <= done < 4
    whole, opened = [path.stem for path in kept.glob("*.nc")], []
    real = rates.run_window
    monkeypatch.setattr(rates, "run_window", lambda *a: opened.append(a) or real(*a))
    assert main([*command, "--resume", "-o", "cut.nc"]) == 0
    assert len(whole) >= done
    assert len(opened) < gd.studies.open_lives("cut.nc").windows.sum()  # lives that are done are read
    assert not kept.exists()
    assert main([*command, "-o", "whole.nc"]) == 0
    resumed, whole = gd.studies.open_lives("cut.nc"), gd.studies.open_lives("whole.nc")
    xr.testing.assert_identical(resumed.drop_attrs(), whole.drop_attrs())


PROGRAM = """
import signal, sys

from gearidae.cli import main
from gearidae.wear.lives import rates

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
sys.exit(main(sys.argv[1:]))
"""
