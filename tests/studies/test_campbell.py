"""Campbell diagrams: lines where the excitation is, crossings where two frequencies meet."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis import contact_resonance
from gearidae.cli import main
from gearidae.studies.declared import campbell

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.05, "run.samples": 5001})
ORDER = 40
ROUGH = LOW.replace(
    {
        "mesh.static_error": [{"order": ORDER, "amplitude": 2e-8, "phase": 0.0}],
        "load.torque": 1e-17,
        "load.drag": 1e-20,
    }
)
"""A dry load: under drag alone the contact's frequency rises with the speed as the mesh's does, and never meets it."""
SPEEDS = [20.0, 30.0, 45.0]


@pytest.fixture(scope="module")
def found():
    return gd.studies.campbell(ROUGH, SPEEDS, multiples=[1, 10])


def test_a_static_error_is_the_strongest_line_at_each_speed(found):
    assert found.mean_speed.values == pytest.approx(SPEEDS, rel=0.05)
    wanted = ORDER * found.mean_speed.values / (2.0 * math.pi)
    assert np.abs(found.peak_frequency.values - wanted).max() <= 1.5 * found.attrs["resolution"]


def test_the_density_holds_the_variance(found):
    step = float(found.frequency[1] - found.frequency[0])
    # two segments under a Hann window weigh the middle of the record, where the swing is not quite that of its ends
    assert np.sqrt(found.density.sum("frequency") * step).values == pytest.approx(found.rms.values, rel=0.25)


def test_crossings_are_where_the_frequencies_meet(found):
    assert math.isnan(found.critical_speed.sel(multiple=1))
    speed = float(found.critical_speed.sel(multiple=10))
    assert SPEEDS[0] < speed < SPEEDS[-1]
    mesh, contact = (np.interp(speed, SPEEDS, found[f"{name}_frequency"]) for name in ("mesh", "contact"))
    assert 10.0 * mesh == pytest.approx(contact, rel=1e-9)
    assert f"10 times at {speed:.4g} rad/s" in repr(found.gearidae)


def test_the_contact_carries_what_the_load_takes_at_each_speed(found):
    ratio = LOW.gears.pinion_teeth / LOW.gears.gear_teeth
    for number, speed in enumerate(SPEEDS):
        torque = (ROUGH.load.torque + ROUGH.load.drag * (speed * ratio) ** 2) * ratio
        driven = ROUGH.replace({"drive.torque": torque})
        assert float(found.contact_frequency[number]) == pytest.approx(contact_resonance(driven), rel=1e-6)


def test_lines_that_may_be_aliases_are_named():
    coarse = LOW.replace({"run.samples": 101})
    found = gd.studies.campbell(coarse, [20.0, 30.0])
    assert "aliases" in found.attrs["note"]
    assert "aliases" in gd.plot.campbell(found).get_title(loc="left")


def test_samples_of_the_ringing_are_those_of_the_fastest_run():
    found = gd.studies.campbell(LOW.replace({"run.samples": "ringing"}), [20.0, 30.0])
    assert "note" not in found.attrs
    assert float(found.frequency[-1]) > float(found.contact_frequency.max())


@pytest.mark.parametrize(
    ("key", "more"),
    [
        ("speeds", {"speeds": [5.0]}),
        ("speeds", {"speeds": [5.0, -1.0]}),
        ("speeds", {"speeds": ["5 m", "6 m"]}),
        ("variable", {"variable": "gear_sped"}),
        ("variable", {"variable": "stick_time"}),
        ("multiples", {"multiples": [0]}),
    ],
)
def test_what_it_refuses(key, more):
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.campbell(LOW, **({"speeds": [5.0, 6.0]} | more))
    assert refused.value.key == key


def test_it_takes_gears_with_samples():
    with pytest.raises(gd.SceneError, match="with gears"):
        gd.studies.campbell(gd.preset("roller_slow"), [5.0, 6.0])
    with pytest.raises(gd.SceneError, match="spectra need samples"):
        gd.studies.campbell(LOW.replace({"run.samples": "off"}), [5.0, 6.0])


def test_the_picture_has_mesh_shafts_contact_and_crossings(found):
    ax = gd.plot.campbell(found)
    first, second, contact, met = ax.get_lines()
    assert first.get_ydata() == pytest.approx(found.mesh_frequency.values)
    assert second.get_ydata() == pytest.approx(10.0 * found.mesh_frequency.values)
    assert contact.get_label() == "contact"
    assert met.get_xdata() == pytest.approx(found.critical_speed.sel(multiple=[10]).values)
    ax.figure.canvas.draw()
    assert gd.plot.campbell(found, highest=500.0).get_ylim()[1] <= 500.0
    with pytest.raises(gd.SceneError, match="Campbell"):
        gd.plot.campbell(found.drop_vars("critical_speed"))


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = ["campbell", "low_speed", "--set", "run.duration=5 ms", "run.samples=501", "-o", "out.nc"]
    assert main([*command, "--speeds", "40:80:20 rpm", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["kind"] == "campbell"
    speeds = gd.open("out.nc").speed.values
    assert speeds == pytest.approx(np.array([40.0, 60.0, 80.0]) * 2.0 * math.pi / 60.0)


@pytest.mark.parametrize("case", ["microengine", "transmission"])
def test_a_drive_that_holds_a_speed_has_no_pin(case):
    """With the law its force goes, and with that the pin, which a couple does not have."""
    scene = gd.load_case(Path(__file__).parents[2] / "cases" / f"{case}.toml")
    held, _ = campbell._plan(scene, np.array([300.0, 400.0]), ringing=False)
    assert scene.drive.pin_radius > 0.0 == held.drive.pin_radius
    assert held.drive.law is None
