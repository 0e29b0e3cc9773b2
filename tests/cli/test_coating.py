"""``coating-map``, ``assess`` and the pictures of ``plot``: what they print and write, and their exit codes."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

import gearidae as gd
from gearidae.cli import main

CASE = "teodorescu2009_low_speed"
OVER = ["--over", "coating.sam_fraction=1:0.6:-0.1"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def kept_chart(tmp_path_factory):
    path = tmp_path_factory.mktemp("chart") / "map.nc"
    assert main(["coating-map", CASE, *OVER, "-o", str(path)]) == 0
    return path


@pytest.fixture
def chart(folder, kept_chart, capfd):
    shutil.copyfile(kept_chart, "map.nc")
    capfd.readouterr()
    return "map.nc"


def test_map_prints_frequencies_and_keeps_them(folder, capfd):
    assert main(["coating-map", CASE, *OVER]) == 0
    printed = capfd.readouterr().out
    kept = gd.analysis.open_map(f"{CASE}_map.nc")
    assert f"{float(kept.characteristic_frequency[0]):.0f} +-" in printed
    assert "SAM 60 %" in printed
    assert main(["coating-map", CASE, *OVER]) == 2  # it is there
    assert "exists already" in capfd.readouterr().err


def test_info_says_what_is_in_a_map(chart, folder, capfd):
    assert main(["info", chart]) == 0
    printed = capfd.readouterr().out
    assert "characteristic_frequency" in printed
    assert "drive.torque" in printed
    assert main(["info", chart, "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    kept = gd.analysis.open_map(chart)
    assert facts["kind"] == "coating_map"
    assert facts["sizes"] == dict(kept.sizes)
    assert facts["variables"]["characteristic_frequency"]["units"] == "Hz"
    assert facts["scene"] == json.loads(kept.attrs["scene"])


def test_map_over_torque(folder, capfd):
    over = ["coating.sam_fraction=1,0.8", "drive.torque=4e-18 N m,5e-18 N m"]
    assert main(["coating-map", CASE, "--over", *over, "-o", "map.nc"]) == 0
    assert "torque = 5e-18" in capfd.readouterr().out
    assert gd.analysis.open_map("map.nc").characteristic_frequency.dims == ("torque", "sam_fraction")


def test_a_map_without_impacts_says_so(folder, capfd):
    over = ["coating.sam_fraction=1,0.8", "drive.torque=4e-18 N m,5e-18 N m"]
    arguments = ["coating-map", CASE, "--over", *over, "-o", "map.nc", "--set", "run.duration=5 ms"]
    assert main(arguments) == 0
    printed = capfd.readouterr().out
    assert "SAM 80 %" in printed
    assert "Hz" not in printed


def test_assess_a_record_from_a_file(chart, folder, capfd):
    ds = gd.simulate(gd.preset(CASE).replace({"coating.sam_fraction": 0.72}))
    rows = np.column_stack([ds.time, ds.gear_speed])
    np.savetxt("rig.csv", rows, delimiter=",", header="time [s], gear_speed [rad/s]", comments="")
    assert main(["assess", "rig.csv", "--map", chart]) == 0
    printed = capfd.readouterr().out
    assert printed.startswith("clear: SAM fraction 0.72")
    np.savetxt("rig.csv", rows[:500], delimiter=",", header="time [s], gear_speed [rad/s]", comments="")
    assert main(["assess", "rig.csv", "--map", chart]) == 0  # that the signal cannot tell is an answer
    assert capfd.readouterr().out.startswith("no impacts: ")


def test_a_laboratorys_record_needs_no_repair(chart, folder, capfd):
    """Semicolons, decimal commas, two lines above the headings, revolutions per minute, six samples missing."""
    ds = gd.simulate(gd.preset(CASE).replace({"coating.sam_fraction": 0.72}))
    rpm = [f"{value:.6f}" for value in ds.gear_speed.values * 60 / (2 * np.pi)]
    for number in (500, 501, 502, 9000, 20000, 29000):
        rpm[number] = ""
    rows = "".join(f"{1e3 * time:.5f};{speed}\n" for time, speed in zip(ds.time.values, rpm, strict=True))
    heads = "Prüfstand 2\nAbtastrate;100 kHz\nZeit [ms];Drehzahl [1/min]\n"
    (folder / "rig.csv").write_text(heads + rows.replace(".", ","), encoding="cp1252")
    command = ["assess", "rig.csv", "--map", chart, "--columns", "Zeit [ms]", "Drehzahl [1/min]"]
    assert main(command) == 2
    error = capfd.readouterr().err
    assert "rig.csv" in error
    assert "sample 500 (0.005 s) is missing" in error
    assert "--bridge" in error
    for more in ([], ["--skip", "2", "--delimiter", ";", "--decimal", ","]):
        assert main([*command, "--bridge", "3", "--calibration", "1 %", "--offset", "0.01 rad/s", *more]) == 0
        said, answer = capfd.readouterr().out.splitlines()
        assert said == "rig.csv: semicolons, decimal commas, 2 lines skipped, 6 samples bridged"
        assert answer.startswith("clear: SAM fraction 0.72")
    assert main([*command, "--bridge", "3", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["reading"] == said.removeprefix("rig.csv: ")
    for wrong in (["--calibration", "much"], ["--offset", "1 V"], ["--bridge", "-1"], ["--decimal", "x"]):
        assert main([*command, *wrong]) == 2
        assert capfd.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["assess", "none.csv", "--map", "map.nc"],
        ["assess", "map.nc", "--map", "none.nc"],
        ["assess", "map.nc", "--map", "map.nc"],
        ["assess", "map.nc"],
        ["coating-map", "roller_slow", "-o", "other.nc"],
        ["coating-map", CASE, "--over", "coating.sam_fraction=2", "-o", "other.nc"],
        ["plot", "map.nc", "--picture", "portrait"],
        ["plot", "map.nc", "--picture", "gear_speed"],
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(arguments, chart, folder, capfd):
    assert main(arguments) == 2
    error = capfd.readouterr().err
    assert error.startswith("gearidae: ")
    assert error.count("\n") == 1
    assert not (folder / "other.nc").exists()


def test_plot_draws_maps_and_named_pictures(chart, folder, capfd):
    assert main(["plot", chart]) == 0
    assert (folder / "map.png").exists()
    assert main(["run", CASE, "--set", "run.duration=0.1", "-o", "run.nc"]) == 0
    for name in ("impact_spectrum", "power_spectrum", "spectrogram", "cycle"):
        assert main(["plot", "run.nc", "--picture", name, "-o", f"{name}.png"]) == 0
        assert (folder / f"{name}.png").exists()


def test_map_over_the_usual_torques(folder, capfd):
    over = ["--over", "coating.sam_fraction=1,0.8", "--over", "drive.torque"]
    assert main(["coating-map", CASE, *over, "-o", "map.nc"]) == 0
    torques = gd.analysis.open_map("map.nc").torque.values
    assert np.allclose(torques / 4.5e-18, [0.7, 0.85, 1.0, 1.15, 1.3], rtol=1e-12)
    capfd.readouterr()
    assert main(["coating-map", CASE, *over, "--over", "load.drag=8e-18", "-o", "other.nc"]) == 2
    assert "needs values beside load.drag" in capfd.readouterr().err


def test_an_estimated_torque_is_printed(folder, capfd):
    over = ["--over", "coating.sam_fraction=1:0.6:-0.1", "--over", "drive.torque"]
    assert main(["coating-map", CASE, *over, "-o", "map.nc"]) == 0
    ds = gd.simulate(gd.preset(CASE).replace({"coating.sam_fraction": 0.72, "drive.torque": 5e-18}))
    np.savetxt(
        "rig.csv",
        np.column_stack([ds.time, ds.gear_speed]),
        delimiter=",",
        header="time [s], gear_speed [rad/s]",
        comments="",
    )
    capfd.readouterr()
    assert main(["assess", "rig.csv", "--map", "map.nc"]) == 0
    printed = capfd.readouterr().out
    assert printed.startswith("clear: SAM fraction 0.7")
    assert "the torque being 5" in printed


@pytest.mark.parametrize(
    "content", [b'name = "a case"\n[gears]\n', b"", b"\x89HDF\r\n\x1a\n" + bytes(40), b"CDF\x01" + bytes(9)]
)
def test_a_file_that_is_no_map_is_one_line(content, folder, capfd):
    (folder / "m.toml").write_bytes(content)
    (folder / "rig.csv").write_text("time [s], gear_speed [rad/s]\n")
    assert main(["assess", "rig.csv", "--map", "m.toml"]) == 2
    error = capfd.readouterr().err
    assert error.startswith("gearidae: map = m.toml")
    assert error.count("\n") == 1
    assert "xarray" not in error
    assert "engine" not in error


def rows_of(ds, every=1):
    return np.column_stack([ds.time, ds.gear_speed])[::every]


def write_record(ds, every=1):
    np.savetxt(
        "rig.csv",
        rows_of(ds, every),
        delimiter=",",
        header="time [s], gear_speed [rad/s]",
        comments="",
    )


def test_a_filter_before_the_sampling_is_told(folder, capfd):
    """At 12.5 kHz two impacts could be images of faster ringing, unless a filter has kept that out."""
    assert main(["coating-map", CASE, "--over", "coating.sam_fraction=1:0.5:-0.05", "-o", "map.nc"]) == 0
    write_record(
        gd.simulate(gd.preset(CASE).replace({"coating.sam_fraction": 0.9}), t_end=0.11, samples=11001), 8
    )
    capfd.readouterr()
    assert main(["assess", "rig.csv", "--map", "map.nc"]) == 0
    assert capfd.readouterr().out.startswith("sampled too slowly: ")
    for cutoff in ("4 kHz", "4000"):
        assert main(["assess", "rig.csv", "--map", "map.nc", "--anti-alias-filter", cutoff]) == 0
        assert capfd.readouterr().out.startswith("clear: SAM fraction 0.9")


@pytest.mark.parametrize("cutoff", ["4 km", "fast", "-1", "0 Hz", "nan"])
def test_a_filter_that_is_none_is_refused(cutoff, chart, folder, capfd):
    write_record(gd.simulate(gd.preset(CASE), t_end=0.05, samples=5001))
    assert main(["assess", "rig.csv", "--map", chart, f"--anti-alias-filter={cutoff}"]) == 2
    error = capfd.readouterr().err
    assert "anti" in error
    assert error.count("\n") == 1


def test_one_run_of_a_sweep_against_one_line_of_a_map(folder, capfd):
    """The lines are at two torques; that of the run makes a clear answer, the other none that is near the truth."""
    over = ["coating.sam_fraction=1:0.6:-0.1", "drive.torque=3.4e-18,4.5e-18"]
    assert main(["coating-map", CASE, "--over", *over, "-o", "map.nc"]) == 0
    assert main(["sweep", CASE, "--over", "coating.sam_fraction=1,0.72", "-o", "runs.nc"]) == 0
    capfd.readouterr()
    assess = ["assess", "runs.nc", "--map", "map.nc"]
    assert main([*assess, "--select", "sam_fraction=0.72", "--line", "torque=4.5e-18"]) == 0
    out = capfd.readouterr().out
    assert out.startswith("clear: SAM fraction 0.72")
    assert "torque" not in out
    assert main([*assess, "--select", "sam_fraction=0.72", "--line", "torque=3.4e-18"]) == 0
    assert not capfd.readouterr().out.startswith("clear: SAM fraction 0.72")
    assert main([*assess, "--select", "sam_fraction=0.72"]) == 0
    assert "the torque being 4.5" in capfd.readouterr().out
    for wrong, words in (
        ([], "--select sam_fraction=..."),
        (["--select", "sam_fraction=0.5"], "must be one of 1, 0.72"),
        (["--select", "torque=1"], "must be one of sam_fraction"),
        (["--select", "sam_fraction=1", "--line", "drag=1"], "must be one of torque"),
    ):
        assert main([*assess, *wrong]) == 2
        assert words in capfd.readouterr().err


def test_lines_over_another_key_are_picked(folder, capfd):
    over = ["coating.sam_fraction=1:0.6:-0.1", "load.drag=8e-18,9e-18"]
    assert main(["coating-map", CASE, "--over", *over, "-o", "map.nc"]) == 0
    write_record(gd.simulate(gd.preset(CASE).replace({"coating.sam_fraction": 0.72})))
    capfd.readouterr()
    assert main(["assess", "rig.csv", "--map", "map.nc"]) == 2
    assert "--line drag=..." in capfd.readouterr().err
    assert main(["assess", "rig.csv", "--map", "map.nc", "--line", "drag=8e-18"]) == 0
    assert capfd.readouterr().out.startswith("clear: SAM fraction 0.72")
