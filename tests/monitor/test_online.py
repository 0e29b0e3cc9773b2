"""An assessment that grows with the record is at any time that of the record so far."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import OnlineAssessment, assess, coating_map
from same import assert_same

SCENE = gd.preset("teodorescu2009_low_speed")
PITCH = 2.0 * math.pi / 76


@pytest.fixture(scope="module")
def chart():
    return coating_map(SCENE, [1.0, 0.9, 0.8, 0.7, 0.6])


@pytest.fixture(scope="module")
def record():
    run = gd.simulate(SCENE.replace({"coating.sam_fraction": 0.65}))
    noise = 1e-4 * np.random.default_rng(0).standard_normal(run.sizes["time"])
    return run.time.values, run.gear_speed.values + noise


def offline(record, chart, count=None):
    time, speed = (column[:count] for column in record)
    return assess(xr.DataArray(speed, dims="time", coords={"time": time}), chart)


@pytest.mark.parametrize("size", [997, 6000, 40000])
def test_online_is_offline_whatever_the_pieces(size, chart, record):
    online = OnlineAssessment(chart)
    for first in range(0, len(record[0]), size):
        online.feed(*(column[first : first + size] for column in record))
    assert_same(online.estimate, offline(record, chart))
    assert online.estimate.conclusive
    assert online.estimate.low < 0.65 < online.estimate.high


def test_estimate_follows_each_impact(chart, record):
    """Fed one hundredth of a pitch at a time, it is made anew once a pitch, and narrows."""
    online, after = OnlineAssessment(chart), []
    for first in range(0, len(record[0]), 50):
        if online.feed(*(column[first : first + 50] for column in record)):
            after.append(online.estimate)
            assert_same(after[-1], offline(record, chart, first + 50))
    turned = float(np.trapezoid(record[1], record[0])) / PITCH
    assert len(after) == online.impacts == int(turned)
    assert len(after[-1].frequencies) > len(after[0].frequencies)
    widths = [estimate.high - estimate.low for estimate in after if estimate.conclusive]
    assert len(widths) >= 3
    assert widths[-1] <= widths[0]


def test_samples_one_by_one_and_none(chart, record):
    online = OnlineAssessment(chart)
    assert online.estimate.verdict == "no impacts"
    assert not online.feed([], [])
    for time, speed in zip(record[0][:15], record[1][:15], strict=True):
        assert not online.feed(time, speed)
    assert online.estimate.verdict == "no impacts"
    online.feed(*(column[15:9000] for column in record))
    assert_same(online.estimate, offline(record, chart, 9000))


def test_wrong_pieces_are_refused_and_change_nothing(chart, record):
    online = OnlineAssessment(chart)
    online.feed(*(column[:9000] for column in record))
    before = online.estimate
    time, speed = (column[9000:9100] for column in record)
    for wrong in (
        (time[:50], speed),
        (time[::-1], speed),
        (time - 0.05, speed),
        (time, speed * np.nan),
        ("a", "b"),
    ):
        with pytest.raises(gd.SceneError):
            online.feed(*wrong)
    assert online.estimate is before
    online.feed(time, speed)
    assert_same(online.estimate, offline(record, chart, 9100))


def test_a_gap_in_the_record_is_named(chart, record):
    online = OnlineAssessment(chart)
    online.feed(*(column[:9000] for column in record))
    with pytest.raises(gd.SceneError, match="off the uniform grid"):
        online.feed(*(column[9700:18000] for column in record))


def test_settings_are_those_of_assess(chart):
    with pytest.raises(gd.SceneError, match="history = perhaps"):
        OnlineAssessment(chart, history="perhaps")
    with pytest.raises(gd.SceneError, match="anti_alias_filter"):
        OnlineAssessment(chart, anti_alias_filter=0.0)
    with pytest.raises(gd.SceneError, match="must be a Dataset"):
        OnlineAssessment("map.nc")


@pytest.mark.parametrize(
    "speed",
    [np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0]), np.array([True, False, True]), np.array([1j, 2, 3])],
)
def test_what_is_no_speed_is_refused(speed, chart):
    with pytest.raises(gd.SceneError, match="speed"):
        OnlineAssessment(chart).feed([0.0, 1e-5, 2e-5], speed)
