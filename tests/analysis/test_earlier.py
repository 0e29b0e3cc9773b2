"""Verdicts of archives of version 0.2, which have not kept what free gears would have done."""

from __future__ import annotations

import math

import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.earlier import OLD, earlier_verdict, is_earlier
from gearidae.archive.select import run_scene
from gearidae.errors import SceneError
from gearidae.records import Extremes

LOW = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.45, "run.samples": "off"})
STOOD = Extremes(stick_time=0.2, turned_back=0.0, last_min_gear_speed=0.0)
NEW = (
    *("advance", "free_advance", "driven_time", "held_torque", "holding", "free_turned_back", "back_time"),
    *("standstills", "standing_time", "standing_rest_time", "start_time", "breakaway_torque"),
    *("rest_time", "followed_time", "standstill_list"),
)


def judged(changes, extremes=STOOD):
    scene = LOW.replace({"load.torque": 3e-18} | changes)
    scheduled = bool(len(scene.drive.schedule) or len(scene.load.schedule))
    return earlier_verdict(extremes, "finished", scene.to_dict(), scheduled=scheduled)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, ("sticks", False)),  # 4 times 4.5e-18 N m are beyond the dry load
        ({"drive.torque": 0.0}, ("stops", False)),
        (
            {"drive.torque": 1e-18, "drive.harmonic": [{"amplitude": 1e-18, "frequency": 10.0}]},
            ("sticks", True),
        ),
        ({"drive.schedule": [(0.0, 0.0), (0.1, 1e-18)]}, ("sticks", False)),  # beyond it at any time
        ({"drive.torque": 0.0, "drive.schedule": [(0.0, 1e-18), (0.1, 0.0)]}, ("stops", True)),
        ({"load.schedule": [(0.0, 0.0), (0.1, 1e-16)]}, ("stops", True)),
    ],
)
def test_what_follows_from_the_torques_is_judged_anew(changes, expected):
    assert judged(changes) == expected


def test_a_gear_that_has_turned_on_is_judged_as_at_present():
    assert judged({}, Extremes(stick_time=math.nan)) == (None, False)


def test_a_gear_that_went_back():
    back = Extremes(stick_time=0.2, turned_back=3.0)
    assert judged({}, back) == ("runs back", False)
    assert judged({"drive.torque": -4.5e-18}, back) == ("turns back", False)


def test_an_archive_without_the_numbers_opens_with_its_words(tmp_path):
    ds = gd.simulate(LOW)
    old = ds.drop_vars(NEW)
    old.to_netcdf(tmp_path / "old.nc")
    kept = gd.open_archive(tmp_path / "old.nc")
    (now,), (then,) = outcomes(ds), outcomes(kept)
    assert (then.words, then.old) == (now.words, False)
    assert not is_earlier(Extremes(followed_time=0.3))
    with pytest.raises(SceneError, match="need runs of gears of this version"):
        kept.gearidae.standstills()


def test_a_verdict_of_the_former_rule_says_so():
    ramp = {"drive.torque": 0.0, "drive.schedule": [(0.0, 0.0), (0.01, 4.5e-18)]}
    old = gd.simulate(LOW.replace(ramp | {"load.torque": 1e-18})).drop_vars(NEW)
    (outcome,) = outcomes(old)
    assert outcome.verdict == "stops"
    assert outcome.words.endswith(OLD)


def test_labels_of_another_run_are_refused_by_their_key():
    """What `xarray.concat` joins has the scene of its first run."""
    run = gd.simulate(LOW.replace({"run.samples": 11, "run.duration": 0.01}))
    assert len(outcomes(run.assign_coords(duration=0.01))) == 1
    other = run.assign_coords(duration=0.02)
    for read in (outcomes, run_scene):
        with pytest.raises(SceneError, match=r"^run\.duration = 0\.02: is not that of its scene, 0\.01"):
            read(other)
    swept = gd.sweep(
        LOW.replace({"run.samples": 11, "run.duration": 0.01}), {"drive.torque": [4e-18, 5e-18]}, jobs=1
    )
    assert len(outcomes(swept)) == 2
    assert outcomes(swept.isel(torque=1))[0].label == {}
    assert swept.isel(torque=1).gearidae.scene.drive.torque == 5e-18
