"""Lives of hubs and pin: what joints slide in a turn, which of them fails first, at which frequency."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import optimize, stats

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.products import answer, open_product
from gearidae.wear.declared.hub_life import FITTED, STUDY
from gearidae.wear.lives.hub_life import at_frequency

JOINTS = {
    "gears.hub_friction": 0.3,
    "gears.hub_friction_rise": 0.0,
    "gears.pinion_hub_radius": 3e-6,
    "gears.gear_hub_radius": 6e-6,
    "drive.pin_radius": 1.25e-6,
}
ENGINE = gd.load_case("cases/microengine.toml").replace({**JOINTS, "load.schedule": [], "run.duration": 6e-3})
WEAR = {"coefficient": "1e-16 m^2/N", "threshold": "1e-21 m^3"}
HIGH = gd.preset("teodorescu2009")


@pytest.fixture(scope="module")
def lives():
    return gd.studies.hub_life(ENGINE, **WEAR, frequencies=[300, "600 Hz"], length="2 um", clearance=True)


def test_joints_slide_as_far_as_load_and_turn_say(lives):
    """Loads of the steady motion, given to six digits; what is left of the swing is much less than 1e-3."""
    at = lives.sel(frequency=600.0, method="nearest").sliding
    loads = {
        "pinion hub": (3e-6, 10.0042e-6, 1.0),
        "gear hub": (6e-6, 0.408257e-6, 0.25),
        "pin": (1.25e-6, 10e-6, 1.0),
    }
    for name, (radius, load, turns) in loads.items():
        expected = 2.0 * math.pi * radius * load * turns
        assert float(at.sel(joint=name)) == pytest.approx(expected, rel=1e-3, abs=0)
    np.testing.assert_allclose(lives.frequency, [300.0, 600.0], rtol=1e-6)
    assert (lives.drift <= 1e-3).all()


def test_the_life_of_the_pin_does_not_depend_on_the_frequency(lives):
    """V / (k 2 pi r F0), at constant force."""
    np.testing.assert_allclose(lives.turns.sel(joint="pin"), 1.27e5, rtol=5e-3)
    hours = lives.hours.sel(joint="pin").values
    assert hours[0] == pytest.approx(2.0 * hours[1], rel=1e-3)
    assert hours[1] == pytest.approx(1.273e5 / 600.0 / 3600.0, rel=1e-3)


def test_the_first_joint_ends_the_life(lives):
    assert lives.first_share.sel(joint="pinion hub").values.tolist() == [1.0, 1.0]
    np.testing.assert_array_equal(lives.life[:, 0], lives.turns.min("joint"))
    sentence = STUDY.sentence(lives)
    assert sentence.startswith("The pinion hub fails first, after 5.3")
    assert FITTED in sentence


def test_depths_and_backlash_at_the_end_of_the_life(lives):
    """The first joint has lost its threshold; a hub lets its shaft cross twice its depth, a pin does not count."""
    depth = lives.worn_depth.sel(joint="pinion hub").values
    np.testing.assert_allclose(depth, 1e-21 / (2.0 * math.pi * 3e-6 * 2e-6), rtol=1e-12)
    np.testing.assert_allclose(lives.added_backlash.sel(joint="pinion hub"), 2.0 * depth, rtol=1e-12)
    assert (lives.added_backlash.sel(joint="pin") == 0.0).all()


def test_a_frequency_scales_the_schedule_and_the_speed_at_the_start():
    slow = at_frequency(ENGINE.replace({"initial.gear_speed": 100.0}), 150.0)
    assert slow.drive.law.frequency == ((0.0, 0.0), (0.002, 150.0))
    assert slow.initial.gear_speed == 25.0
    constant = at_frequency(ENGINE.replace({"drive.law.frequency": 600.0}), 150.0)
    assert constant.drive.law.frequency == 150.0


def test_hubs_of_a_couple_by_the_depth_of_their_tops():
    """Steady gears of the paper: both hubs carry the teeth's force; life and tops go with the radius alike."""
    steady = HIGH.replace(
        {
            "drive.harmonic": None,
            "run.duration": 0.2e-3,
            **{k: JOINTS[k] for k in JOINTS if k.startswith("gears.")},
        }
    )
    ds = gd.studies.hub_life(steady, coefficient=1e-16, threshold="2 sigma", turns=2, spread=2.0, seeds=4000)
    pinion, gear = (ds.turns.sel(joint=name).item() for name in ("pinion hub", "gear hub"))
    # a quarter of the turns; the gears do not turn quite in proportion while loads change
    assert gear == pytest.approx(4.0 * pinion, rel=1e-5)
    assert ds.joint.values.tolist() == ["pinion hub", "gear hub"]
    low, middle, high = ds.turns_quantile.sel(joint="pinion hub").values[0]
    assert middle == pinion
    assert high / middle == pytest.approx(middle / low, rel=1e-12)
    assert ds.first_share.sum() == pytest.approx(1.0, rel=1e-12)
    # half of the devices live longer where both joints do: of lognormal lives, the product of two normal tails
    both = optimize.brentq(lambda z: stats.norm.sf(z) * stats.norm.sf(z - 2.0) - 0.5, -3.0, 3.0)
    # 1.25 standard deviations over the root of 4000, four times
    doublings = math.log2(ds.life_quantile.sel(quantile=0.5).item() / pinion)
    assert doublings == pytest.approx(both, abs=4.0 * 1.25 / math.sqrt(4000))


def test_wrong_settings_are_named():
    hubs = HIGH.replace({"gears.pinion_hub_radius": 3e-6})
    for scene, more, message in (
        (gd.preset("roller_slow"), {}, "must be a scene with gears"),
        (HIGH, {}, "must have a hub or a pin with a radius"),
        (hubs, {"frequencies": [100]}, "needs a drive whose law has a frequency"),
        (ENGINE, {"frequencies": []}, "must be one number at least"),
        (hubs, {"coefficient": 0.0}, "coefficient"),
        (hubs, {"coefficient": "1e-16 m^2"}, "coefficient"),
        (hubs, {"threshold": "many"}, "threshold"),
        (hubs, {"spread": 0.5}, "spread"),
        (hubs, {"spread": 2.0, "seeds": 0}, "seeds"),
        (hubs, {"length": 0.0}, "length"),
        (hubs, {"turns": 0}, "turns"),
        (hubs, {"tolerance": 0.0}, "tolerance"),
    ):
        with pytest.raises(gd.SceneError, match=message):
            gd.studies.hub_life(scene, **{**WEAR, **more})


def test_gears_that_do_not_turn_on_have_no_life_and_say_so(caplog):
    """An engine that is pulled out stands or goes back; beside one that turns it is named, alone it is an error."""
    heavy = ENGINE.replace({"load.torque": 6e-10, "run.duration": 3e-3})
    with pytest.raises(gd.SolverError, match="no run gives a life"):
        gd.studies.hub_life(heavy, **WEAR)
    assert caplog.messages[-1] == "one frequency has no life: the gear does not turn on at 0.003 s"


def test_the_command_keeps_what_it_says(tmp_path, capsys):
    path = tmp_path / "lives.nc"
    words = [
        "hub-life",
        "teodorescu2009",
        "--coefficient",
        "1e-16 m^2/N",
        "--threshold",
        "2 sigma",
        "-o",
        str(path),
    ]
    hubs = ["gears.pinion_hub_radius=3 um", "run.duration=0.1 ms", "drive.harmonic=[]"]
    assert main([*words, "--clearance", "--length", "2 um", "--set", *hubs]) == 0
    ds, kind = open_product(path)
    assert kind == "hub_life"
    assert "worn_depth" in ds
    out = " ".join(capsys.readouterr().out.split())
    assert FITTED in out
    assert answer(ds, kind).sentence in out
    ax = gd.plot.hub_life(ds)
    assert ax.get_yscale() == "log"
    again = [*words, "--clearance", "--length", "2 um", "--resume", "--set", *hubs]
    assert main(again) == 0
