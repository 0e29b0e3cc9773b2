"""``gearidae calibrate`` and ``gearidae predict``: the answers of the functions, and what is wrong in one line."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.cli import main
from gearidae.studies import Observation

CASE = "teodorescu2009_low_speed"
PRIOR = "coating.sam_fraction=uniform(0.4, 0.65)"
SEEN = "sticks=true; drive.torque=4.2e-18 N m; misjudged=0.05"
FILE = """# gears of one wafer
of, value, uncertainty, misjudged, drive.torque
sticks, true, , 0.05, 4.2e-18 N m
"""
TABLES = """
[[observation]]
value = true
misjudged = 0.05
conditions.drive.torque = "4.2e-18 N m"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def expected():
    seen = Observation(value=True, conditions={"drive.torque": "4.2e-18 N m"}, misjudged=0.05)
    return gd.studies.calibrate(
        gd.preset(CASE), {"coating.sam_fraction": "uniform(0.4, 0.65)"}, [seen], points=5, jobs=1
    )


def calibrate(*arguments, code=0):
    assert main(["calibrate", CASE, "--vary", PRIOR, "--points", "5", "--jobs", "1", *arguments]) == code


def test_a_posterior_is_written_shown_drawn_and_predicted_from(folder, expected, capsys):
    calibrate("--seen", SEEN)
    printed = capsys.readouterr()
    assert printed.err == "the most likely coating.sam_fraction is at the edge of its prior\n"
    row = next(line for line in printed.out.splitlines() if "coating.sam_fraction" in line and "+-" in line)
    assert f"{float(expected['mean'][0]):.4g} +- {float(expected.standard_deviation[0]):.4g}" in row
    posterior = gd.studies.open_posterior(f"{CASE}_posterior.nc")
    xr.testing.assert_equal(posterior, expected)
    assert [path.name for path in folder.iterdir()] == [f"{CASE}_posterior.nc"]

    assert main(["plot", f"{CASE}_posterior.nc", "-o", "posterior.png"]) == 0
    assert (folder / "posterior.png").stat().st_size > 5_000

    more = ["--size", "6", "--seed", "2", "--jobs", "1", "--set", "run.duration=0.05"]
    assert main(["predict", CASE, "--posterior", f"{CASE}_posterior.nc", *more]) == 0
    assert "probability of sticking" in capsys.readouterr().out
    scene = gd.preset(CASE).replace({"run.duration": 0.05})
    predicted = gd.studies.predict(scene, expected, 6, seed=2)
    np.testing.assert_array_equal(
        gd.open_archive(f"{CASE}_predicted.nc").min_gear_speed, predicted.min_gear_speed
    )


def test_of_a_short_chain_no_number_of_independent_draws_is_promised(folder, capsys):
    pytest.importorskip("emcee")
    calibrate("--seen", SEEN, "--method", "emcee", "--steps", "8", "--set", "run.duration=0.02")
    row = next(line for line in capsys.readouterr().out.splitlines() if "independent" in line)
    assert "96" in row  # six steps of 16 walkers
    assert "fewer than 96 independent" in row


def test_observations_of_a_file_are_the_same(folder, expected):
    for name, text in (("seen.csv", FILE), ("seen.toml", TABLES)):
        (folder / name).write_text(text)
    assert gd.studies.read_observations("seen.csv") == gd.studies.read_observations("seen.toml")
    calibrate("--observations", "seen.toml", "-q")
    posterior = gd.studies.open_posterior(f"{CASE}_posterior.nc")
    xr.testing.assert_equal(posterior, expected)
    assert posterior.attrs["calibration"] == expected.attrs["calibration"]


def test_ctrl_c_keeps_the_runs_and_it_goes_on(folder, expected, monkeypatch, capsys):
    from gearidae import engine

    solve, asked = engine.solve, []

    def deed(scene, **options):
        asked.append(scene)
        if len(asked) == 4:
            raise KeyboardInterrupt
        return solve(scene, **options)

    monkeypatch.setattr(engine, "solve", deed)
    calibrate("--seen", SEEN, code=130)
    assert "go on with" in capsys.readouterr().err
    calibrate("--seen", SEEN, "--resume")
    assert len(asked) == 4 + 2  # three of five were there
    xr.testing.assert_equal(gd.studies.open_posterior(f"{CASE}_posterior.nc"), expected)


def test_numbers_with_uncertainties_and_conditions_reach_the_observation(folder):
    """Nothing is run: the posterior of the torque by a figure is left to the functions' own tests."""
    from gearidae.calibration.declared.calibrate import _observation

    rung = _observation("ring_frequency=5.2 kHz +- 0.1 kHz; mesh.backlash=0.2 um; drive.torque=5e-18")
    same = _observation("ring_frequency = 5.2 kHz \u00b1 0.1 kHz;drive.torque=5e-18;mesh.backlash = 0.2 um")
    assert rung == same
    assert (rung.of, rung.value, rung.spread) == ("ring_frequency", 5200.0, 100.0)
    assert rung.conditions == {"mesh.backlash": "0.2 um", "drive.torque": 5e-18}
    assert _observation("min_gear_speed=1.5+-0.1").value == 1.5
    assert _observation("sticks=TRUE; misjudged=5 %") == Observation(value=True, misjudged=0.05)


def test_cells_of_a_spreadsheet(tmp_path):
    """Excel writes TRUE; a frequency in kilohertz beside an uncertainty without a unit is refused."""
    path = tmp_path / "seen.csv"
    path.write_text("of,value,uncertainty,misjudged\nsticks,TRUE,,5 %\nring_frequency,1.87 kHz,10 Hz,\n")
    stuck, rung = gd.studies.read_observations(path)
    assert (stuck.value, stuck.misjudged) == (True, 0.05)
    assert (rung.value, rung.spread) == (1870.0, 10.0)
    path.write_text("of,value,uncertainty\nring_frequency,1.87,0.01 kHz\n")
    with pytest.raises(gd.SceneError, match=r"observation 1 of .*1\.87 has no unit beside 0\.01 kHz"):
        gd.studies.read_observations(path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "give what was observed"),
        (["--seen", "sticks"], "must read figure=value"),
        (["--seen", "sticks=maybe"], "must be True or False"),
        (["--seen", "ring_frequency=5 kHz"], "--seen uncertainty"),
        (["--seen", "sticks=true; misjugded=0.1"], "did you mean misjudged?"),
        (["--seen", "sticks=true; drive.torqe=1"], "drive.torque"),
        (["--seen", "stiks=true"], "must be a number"),
        (["--seen", "ring_frequency=1.87 +- 0.01 kHz"], "1.87 has no unit beside 0.01 kHz"),
        (["--seen", "ring_frequency=1.87 kHz +- 0.01"], "0.01 has no unit beside 1.87 kHz"),
        (["--seen", "min_gear_sped=1 +- 1"], "did you mean min_gear_speed?"),
        (["--seen", "sticks=true; coating.sam_fraction=0.5"], "cannot be a condition too"),
        (["--observations", "none.csv"], "cannot be read"),
        (["--observations", "seen.txt"], "ends in .toml or .csv"),
        (["--observations", "empty.csv"], "at least one observation"),
        (["--observations", "bad.csv"], "observation 2 of bad.csv: value = maybe"),
        (["--observations", "short.csv"], "3 cells, but there are 2 headings"),
        (["--observations", "bad.toml"], "cannot be read"),
        (["--observations", "other.toml"], "tables [[observation]]"),
        (["--seen", "sticks=true", "--points", "2"], "points"),
    ],
)
def test_what_is_wrong_is_told_in_a_line_and_nothing_is_run(folder, arguments, words, monkeypatch, capsys):
    monkeypatch.setattr("gearidae.engine.solve", None)
    (folder / "seen.txt").write_text("")
    (folder / "empty.csv").write_text("of, value\n")
    (folder / "bad.csv").write_text("of, value\nsticks, true\nsticks, maybe\n")
    (folder / "short.csv").write_text("of, value\nsticks, true, 3\n")
    (folder / "bad.toml").write_text("[[observation]\n")
    (folder / "other.toml").write_text("[drive]\ntorque = 1\n")
    assert main(["calibrate", CASE, "--vary", PRIOR, *arguments]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (folder / f"{CASE}_posterior.nc").exists()


def test_what_is_no_posterior_is_refused(folder, capsys):
    (folder / "note.nc").write_text("a note")
    xr.Dataset({"x": 1.0}).to_netcdf(folder / "other.nc")
    attributes = {"calibration": json.dumps({"priors": {"drive.torque": "?"}})}
    xr.Dataset({"x": 1.0}, attrs=attributes).to_netcdf(folder / "empty.nc")
    for name in ("note.nc", "none.nc", "other.nc", "empty.nc"):
        assert main(["predict", CASE, "--posterior", name, "--size", "4"]) == 2
        assert "posterior" in capsys.readouterr().err
