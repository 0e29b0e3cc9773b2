"""``gearidae check``: how far the model holds, the expected run time, and doubts."""

from __future__ import annotations

import re
from pathlib import Path

from gearidae.cli import main

CASE = str(Path(__file__).parents[2] / "cases" / "low_speed.toml")


def words(capfd):
    """What was printed, cells of the table that are wrapped put together as far as words go."""
    return " ".join(capfd.readouterr().out.split())


def test_check_says_that_the_input_is_valid_and_how_far_the_model_holds(capfd):
    assert main(["check", CASE]) == 0
    out = words(capfd)
    assert "low_speed: input is valid" in out
    assert "sound" not in out
    for expected in ("expected asperities in contact", "5.13e-08 !", "46.6 nm", "5 to 2.7", "0.82 to 0.45"):
        assert expected in out
    for expected in (
        "5.41 nm",
        "450 times",
        "45 times",
        "expected wall time",
        "within a factor of about three",
    ):
        assert expected in out
    assert "Warning:" not in out


def test_check_doubts_a_roughness_of_ten_micrometres(capfd):
    assert main(["check", CASE, "--set", "surface.roughness=10 um"]) == 0
    out = words(capfd)
    assert "Warning: surface.roughness = 10 um is larger than mesh.backlash = 200 nm" in out
    assert re.search(r"Warning: this run is expected to take \d+ h \(", out)


def test_check_of_a_roller(capfd):
    assert main(["check", "roller_slow"]) == 0
    out = words(capfd)
    assert "closest approach" in out
    assert "inertia" not in out


def test_run_announces_a_long_run_before_it(tmp_path, monkeypatch, capfd):
    """An output that cannot be written ends the run at once, after the announcement."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.nc").write_bytes(b"x")
    settings = ["--set", "run.duration=1e6", "run.samples=11"]
    assert main(["run", CASE, "-o", "there.nc", *settings]) == 2
    assert "this run is expected to take 7.4 h" in capfd.readouterr().err
