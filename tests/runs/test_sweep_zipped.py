"""Sweeps whose keys are walked together."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis import verdict as outcome
from gearidae.archive.select import runs

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3, "run.samples": 11})
FRACTION = "coating.sam_fraction"
TORQUES = [4.5e-18, 4e-18, 3.5e-18]
DRAGS = [8e-18, 8e-18, 9e-18]
PAIRED = {"drive.torque": TORQUES, "load.drag": DRAGS}


def test_zipped_runs_are_the_runs_one_by_one():
    ds = gd.sweep(LOW, PAIRED, zipped=True)
    assert ds.gear_speed.dims == ("torque", "time")
    assert ds.drag.dims == ds.gear_speed.dims[:1]
    assert ds.drag.values.tolist() == DRAGS
    assert ds.drag.attrs["units"] == "N m s^2/rad^2"
    for torque, drag in zip(TORQUES, DRAGS, strict=True):
        run = gd.simulate(LOW.replace({"drive.torque": torque, "load.drag": drag}))
        swept = ds.sel(torque=torque)
        assert np.array_equal(swept.gear_speed, run.gear_speed)
        assert swept.drag == drag
        assert np.array_equal(ds.event_time[ds.event_torque == torque], run.event_time)


def test_the_result_says_what_was_zipped(tmp_path):
    ds = gd.sweep(LOW, PAIRED, zipped=True, archive=tmp_path / "zipped.nc")
    assert json.loads(ds.attrs["swept"]) == PAIRED
    assert ds.attrs["zipped"] == "drive.torque, load.drag"
    assert ds.attrs["title"].endswith("swept over drive.torque with load.drag")
    assert gd.open_archive(tmp_path / "zipped.nc").identical(ds)
    assert [member.label for member in outcome.outcomes(ds)] == [{"torque": torque} for torque in TORQUES]


def test_a_zipped_pair_beside_a_product():
    """The pair stands where its first key does, and the third key makes a product with it."""
    over = {"drive.torque": TORQUES, FRACTION: [1.0, 0.5], "load.drag": DRAGS}
    ds = gd.sweep(LOW, over, zipped=("load.drag", "drive.torque"))
    assert ds.gear_speed.dims == ("torque", "sam_fraction", "time")
    assert ds.drag.dims == ("torque",)
    run = gd.simulate(LOW.replace({"drive.torque": 3.5e-18, "load.drag": 9e-18, FRACTION: 0.5}))
    assert np.array_equal(ds.gear_speed.sel(torque=3.5e-18, sam_fraction=0.5), run.gear_speed)


def test_the_fraction_as_the_second_of_a_pair():
    """Then it is a coordinate along the first; events still carry it, and belong to their own runs."""
    fractions = [1.0, 0.5, 0.5]
    ds = gd.sweep(LOW, {"drive.torque": TORQUES, FRACTION: fractions}, zipped=True)
    assert ds.sam_fraction.dims == ("torque",)
    for (label, run), torque, fraction in zip(runs(ds), TORQUES, fractions, strict=True):
        alone = gd.simulate(LOW.replace({"drive.torque": torque, FRACTION: fraction}))
        assert label == {"torque": torque}
        assert run.sam_fraction == fraction
        assert np.array_equal(run.event_time, alone.event_time)
        assert np.array_equal(run.event_sam_fraction, alone.event_sam_fraction)


def test_keys_of_one_last_part_take_their_whole_names():
    ds = gd.sweep(LOW, {"drive.torque": TORQUES, "load.torque": [0.0, 1e-19, 0.0]}, zipped=True)
    assert ds.gear_speed.dims == ("swept_drive_torque", "time")  # a variable has the name of the whole key
    assert ds.swept_load_torque.dims == ("swept_drive_torque",)
    assert ds.drive_torque.dims == ("swept_drive_torque", "time")
    assert ds.event_swept_drive_torque.dims == ("event",)


def test_torques_of_both_shafts_can_be_swept():
    ds = gd.sweep(LOW, {"drive.torque": TORQUES[:2], "load.torque": [0.0, 1e-19]})
    assert ds.gear_speed.dims == ("swept_drive_torque", "swept_load_torque", "time")
    assert ds.drive_torque.dims == ("swept_drive_torque", "swept_load_torque", "time")


def test_runs_by_name():
    over = {"name": ["idle", "slow"], "drive.torque": [4e-18, 4e-18], FRACTION: [0.5, 0.6]}
    ds = gd.sweep(LOW, over, zipped=True)
    run = gd.simulate(LOW.replace({"drive.torque": 4e-18, FRACTION: 0.6}))
    assert np.array_equal(ds.gear_speed.sel(name="slow"), run.gear_speed)


@pytest.mark.parametrize(
    ("over", "zipped", "key", "words"),
    [
        (
            {"drive.torque": TORQUES, "load.drag": DRAGS[:2]},
            True,
            "load.drag",
            "as many as drive.torque has, 3",
        ),
        (
            {"drive.torque": TORQUES[:1], "load.drag": DRAGS},
            True,
            "load.drag",
            "as many as drive.torque has, 1",
        ),
        ({"load.drag": DRAGS, "drive.torque": TORQUES}, True, "load.drag", "labels the runs"),
        (PAIRED, ["drive.torque", "load.torque"], "zipped", "among the swept keys"),
        (PAIRED, "load", "zipped", "among the swept keys"),
        (PAIRED, 1, "zipped", "True, False or keys"),
        (PAIRED, [["load.drag"]], "zipped", "among the swept keys"),
        ({"drive.torque": TORQUES, FRACTION: [1.0, 1.5, 0.5]}, True, FRACTION, "0"),
    ],
)
def test_what_cannot_be_zipped(over, zipped, key, words):
    with pytest.raises(gd.SceneError, match=words) as caught:
        gd.sweep(LOW, over, zipped=zipped)
    assert caught.value.key == key
