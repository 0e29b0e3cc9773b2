"""``gearidae life``: a law from the command line, the archive, and what is wrong in one line."""

import json

import pytest
import xarray as xr

from gearidae.cli import main

CASE = "teodorescu2009_low_speed"


def test_a_life_is_written_and_shown(tmp_path, monkeypatch, capsys):
    """Nothing is lost where no area is removed: one state answers."""
    monkeypatch.chdir(tmp_path)
    law_options = ["--law", "contacts", "--parameter", "area=0 nm^2", "--passages", "1e6"]
    slow = ["--arrhenius", "activation_energy=1 eV", "--arrhenius", "activation_volume=50 nm^3"]
    settings = ["--set", "run.duration=0.05 s", "run.samples=5001", "coating.sam_fraction=0.9"]
    code = main(["life", CASE, *law_options, *slow, "--arrhenius", "temperature=300 K", *settings])
    printed = capsys.readouterr().out
    assert code == 0
    assert "90 %" in printed
    assert "mesh cycles simulated" in printed
    with xr.open_dataset(f"{CASE}_life.nc") as ds:
        assert ds.passages.values.tolist() == [0.0, 1e6]
        law = json.loads(ds.attrs["law"])
    assert law["name"] == "arrhenius"
    assert law["law"] == {"name": "contacts", "area": 0.0}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--law", "rust", "--parameter", "area=1"], "must be one of adhesion_work, contacts, friction_work"),
        (["--law", "contacts", "--parameter", "energy=1"], "is no parameter of it"),
        (["--law", "contacts", "--parameter", "area=1e-20", "--arrhenius", "temperature=300 K"], "needs"),
    ],
)
def test_wrong_laws_are_told_in_a_line(options, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["life", CASE, *options]) == 2
    assert words in capsys.readouterr().err
