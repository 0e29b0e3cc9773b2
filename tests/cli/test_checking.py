"""``gearidae check``: how far the model holds, the expected run time, and doubts."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import xarray as xr

import gearidae as gd
from gearidae.cli import main
from gearidae.cli.tables import show_outcomes
from gearidae.report.tables import outcome_table
from gearidae.studies.products import answer

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
        "57 times",
        "expected wall time",
        "within a factor of about three",
    ):
        assert expected in out
    assert "Verdicts of runs are a mean over many gears: 5.13e-08 asperities in contact" in out
    assert "Warning:" not in out


def test_check_doubts_a_roughness_of_ten_micrometres(capfd):
    assert main(["check", CASE, "--set", "surface.roughness=10 um"]) == 0
    out = words(capfd)
    assert "Warning: surface.roughness = 10 um is larger than mesh.backlash = 200 nm" in out
    assert re.search(r"expected wall time [\d.]+ days", out)


def test_check_of_a_roller(capfd):
    assert main(["check", "roller_slow"]) == 0
    out = words(capfd)
    assert "closest approach" in out
    assert "inertia" not in out


def test_check_estimates_a_scheduled_drive(capfd):
    assert main(["check", "start_up"]) == 0
    out = words(capfd)
    assert "from the mean torques over the run" in out
    assert "gear speed 268" in out
    assert "does not overcome" not in out


def test_a_run_says_beside_its_verdict_that_it_is_a_mean(tmp_path, capfd):
    target = str(tmp_path / "low.nc")
    assert main(["run", CASE, "-o", target, "--set", "run.duration=1e-3", "run.samples=11"]) == 0
    assert "The verdict is a mean over many gears: 5.13e-08 asperities in contact" in words(capfd)


def test_check_does_not_guess_the_speed_that_a_law_gives(capfd):
    assert main(["check", str(Path(CASE).with_name("microengine.toml"))]) == 0
    out = words(capfd)
    assert "gear speed unknown a torque law decides" in out
    assert (
        "ageing of the pinion hub 50 um/s below this sliding speed, 16.67 rad/s of its shaft, it may chatter"
        in out
    )
    assert "after a long rest friction takes 3.75e-12 N m" in out
    assert "does not overcome" not in out


def test_check_counts_events_beside_samples(tmp_path, capfd):
    """Within the factor of three that the number of steps is known to."""
    case = str(Path(CASE).with_name("high_speed.toml"))
    ds = gd.simulate(gd.load_case(case).replace({"run.duration": "2 ms"}))
    assert main(["check", case, "--set", "run.duration=2 ms"]) == 0
    samples, events = re.search(r"([\d.]+) MB, and some ([\d.]+) MB of events", words(capfd)).groups()
    time = ds.drop_dims(["event", "passage"]).nbytes, ds.drop_dims(["time", "passage"]).nbytes
    assert float(samples) == pytest.approx(1e-6 * time[0], rel=0.01, abs=0)
    assert 1.0 / 3.0 < float(events) / (1e-6 * time[1]) < 3.0


def test_check_says_that_a_resistance_is_cut_off(capfd):
    assert main(["check", CASE, "--set", "load.harmonic={amplitude = 1e-18, frequency = 1e3}"]) == 0
    assert "Warning: load.harmonic swings by 1 aN m about a dry resistance of 0 N m" in words(capfd)


def test_smallest_speed_of_a_gear_at_rest_is_zero(capfd):
    """It swings about its rest by less than the tolerance resolves beside its largest speed."""
    scene = gd.preset("teodorescu2009").replace({"drive.torque": 4.4e-12, "initial.gear_speed": 0.0})
    ds = gd.simulate(scene.replace({"run.samples": "off"}))
    assert -1e-6 * float(ds.max_gear_speed) < float(ds.min_gear_speed) < 0.0
    show_outcomes(ds)
    assert re.search(r"held by dry resistance 0 rad/s 243\.4 rad/s ", words(capfd))
    assert ">0 rad/s<" in outcome_table(ds)
    turned_back = ds.assign(min_gear_speed=-1e-5 * ds.max_gear_speed)
    show_outcomes(turned_back)
    assert " -0.00" in words(capfd)


@pytest.mark.parametrize(
    ("sticks", "passes", "shown"),
    [
        (4.123456e-18, 4.123461e-18, "sticks at 4.123456e-18 N m, passes at 4.123461e-18 N m"),
        (0.574, 0.577, "sticks at 0.574, passes at 0.577"),
        (0.573828, 0.574219, "sticks at 0.5738, passes at 0.5742"),
        (4.12e-18, 4.62e-18, "sticks at 4.12e-18 N m, passes at 4.62e-18 N m"),
    ],
)
def test_digits_tell_the_ends_of_a_bracket_apart(sticks, passes, shown):
    unit = "1" if sticks > 1e-3 else "N m"
    ds = xr.Dataset(
        {
            name: ("exits", [value])
            for name, value in (("limit", passes), ("sticks", sticks), ("passes", passes))
        },
        {"exits": [100], "run": [0.0]},
    )
    ds["limit"].attrs.update(units=unit, long_name="sticking limit of drive.torque")
    assert any(shown in remark for _, _, remark in answer(ds, "sticking_threshold").rows)


def test_check_estimates_what_friction_takes(capfd):
    """In closed form; nothing is said of friction where there is none."""
    hubs = ["--set", "gears.hub_friction=0.3", "--set", "gears.gear_hub_radius=6um"]
    assert main(["check", "teodorescu2009", "--set", "contact.friction=0.3", *hubs]) == 0
    said = capfd.readouterr().out
    assert "4.36 %" in said  # 0.145249 times 0.3
    assert "1.3 %" in said  # 0.3 times 6 um over the gear's base radius
    assert "7.598e-12 N m" in said
    shear = ["--set", "contact.friction_law=shear", "--set", "contact.shear_strength=10 MPa"]
    assert main(["check", "teodorescu2009", *shear, "--set", "drive.torque=0"]) == 0
    lines = capfd.readouterr().out.splitlines()
    assert "unknown" in next(line for line in lines if "lost to flank friction" in line)
    assert main(["check", "teodorescu2009"]) == 0
    assert "friction" not in capfd.readouterr().out


def test_swept_values_carry_their_unit(capfd):
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "1 ms", "run.samples": 11})
    show_outcomes(gd.sweep(scene, {"mesh.backlash": ["0.2 um", "0.3 um"], "coating.sam_fraction": [1.0]}))
    shown = words(capfd)
    assert " 200 nm 1 turned" in shown
    assert " 300 nm 1 turned" in shown
