"""Numbers as other libraries carry them are converted, wherever a user hands them in; what is no number is refused."""

from __future__ import annotations

from datetime import timedelta

import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr
from scipy import stats

import gearidae as gd
from gearidae.analysis import read_signal
from gearidae.analysis.signal import signals
from gearidae.monitor.declared.coating_map import further_keys
from gearidae.runs.sweep_plan import plan_sweep
from gearidae.scene.carried import number_of, numbers_of
from gearidae.studies.distributions import read_distributions
from gearidae.surfaces.height_map import height_map

U = pint.UnitRegistry()
LOW = gd.preset("teodorescu2009_low_speed")
TIMES, TORQUES = np.array([0.0, 0.05, 0.1]), np.array([4.5e-18, 4.6e-18, 4.7e-18])
DURATIONS = [
    pd.to_timedelta([0, 50, 100], unit="ms"),
    pd.Series(pd.to_timedelta([0, 50, 100], unit="ms")),
    np.array([0, 50, 100], "m8[ms]"),
    [timedelta(0), timedelta(milliseconds=50), pd.Timedelta("100ms")],
    xr.DataArray([0.0, 50.0, 100.0], attrs={"units": "ms"}),
    xr.DataArray(np.array([0.0, 50.0, 100.0]) * U.ms),
    np.array([0.0, 50.0, 100.0]) * U.ms,
    [0 * U.s, 50 * U.ms, "100 ms"],
]
NO_NUMBERS = [
    np.array([True, False, True]),
    [True, False, True],
    pd.Series([True, False, None], dtype="boolean"),
    np.array([1, 2, 3], complex),
    pd.to_datetime(["2026-01-01", "2026-01-02", "2026-01-03"]),
    np.array(["a", "b", "c"]),
    [1.0 * U.kg, 2.0 * U.kg, 3.0 * U.kg],
    np.ones(3) * U.dimensionless,
    np.array([1, 2, 3], "m8[M]"),
]
MISSING = [
    np.ma.array([1.0, 2.0, 3.0], mask=[False, True, False]),
    pd.Series([1, None, 3], dtype="Int64"),
    pd.Series([1.0, None, 3.0]),
    [1.0, np.ma.masked, 3.0],
]


@pytest.mark.parametrize("times", DURATIONS)
def test_durations_and_units_are_converted(times):
    np.testing.assert_allclose(numbers_of(times, "s"), TIMES, rtol=1e-15)
    torques = xr.DataArray([4.5, 4.6, 4.7], attrs={"units": "aN m"})
    knots = LOW.replace({"drive.schedule": {"time": times, "value": torques}}).drive.schedule
    np.testing.assert_allclose(knots, np.column_stack([TIMES, TORQUES]), rtol=1e-15)


@pytest.mark.parametrize("values", NO_NUMBERS)
def test_what_is_no_number_is_refused(values):
    with pytest.raises(ValueError, match=r"no number|does not fit|varies"):
        numbers_of(values, "N m")
    with pytest.raises(gd.SceneError, match=r"drive\.schedule.*column 'value'"):
        LOW.replace({"drive.schedule": {"time": [0, 1, 2], "value": values}})


@pytest.mark.parametrize("values", MISSING)
def test_what_is_masked_or_missing_is_never_used(values):
    np.testing.assert_array_equal(numbers_of(values, "N m"), [1.0, np.nan, 3.0])
    with pytest.raises(gd.SceneError, match=r"column 'value', row 2 is nan"):
        LOW.replace({"drive.schedule": {"time": [0, 1, 2], "value": values}})
    with pytest.raises(gd.SceneError, match=r"drive\.torque"):
        plan_sweep(LOW, {"drive.torque": values})


@pytest.mark.parametrize(
    ("value", "expected"),
    [(np.timedelta64(50, "ms"), 0.05), (pd.Timedelta("50ms"), 0.05), (5 * U.ms, 0.005), (np.array(2.0), 2.0)],
)
def test_single_numbers(value, expected):
    assert number_of(value, "s") == pytest.approx(expected, rel=1e-15, abs=0)
    assert LOW.replace({"run.duration": value}).run.duration == number_of(value, "s")


def test_the_zero_of_a_temperature_counts():
    warm = xr.DataArray([20.0, 25.0], attrs={"units": "degC"})
    np.testing.assert_allclose(numbers_of(warm, "K"), [293.15, 298.15], rtol=1e-15)


@pytest.mark.parametrize(
    "torques",
    [
        xr.DataArray([4.5, 4.6], attrs={"units": "aN m"}),
        np.array([4.5, 4.6]) * U("aN m"),
        [4.5e-18, 4.6 * U("aN m")],
        np.array([4.5e-18, 4.6e-18]),
    ],
)
def test_sweeps_take_them_too(torques):
    scenes = plan_sweep(LOW, {"drive.torque": torques}).scenes
    assert [scene.drive.torque for scene in scenes] == pytest.approx([4.5e-18, 4.6e-18], rel=1e-15, abs=0)


@pytest.mark.parametrize("values", [np.array([True, False]), pd.to_timedelta([1, 2], unit="s"), [1j, 2j]])
def test_sweeps_refuse_what_does_not_fit(values):
    with pytest.raises(gd.SceneError, match=r"drive\.torque"):
        plan_sweep(LOW, {"drive.torque": values})


@pytest.mark.parametrize("torques", [["4.4 aN m", 4.6], [4.4e-18, "4.6 aN m"], ["4.4 aN m", "4.6"]])
def test_swept_values_have_units_all_or_none(torques):
    with pytest.raises(gd.SceneError, match=r"drive\.torque.*has no unit beside"):
        plan_sweep(LOW, {"drive.torque": torques})
    with pytest.raises(ValueError, match="has no unit beside"):
        numbers_of(torques, "N m")
    with pytest.raises(gd.SceneError, match=r"between.*has no unit beside"):
        gd.studies.sticking_threshold(LOW, "drive.torque", torques, 1)
    with pytest.raises(gd.SceneError, match=r"drive\.torque.*has no unit beside"):
        further_keys(LOW, {"drive.torque": torques})


def test_zero_has_every_unit():
    scenes = plan_sweep(LOW, {"drive.torque": [0, "4.6 aN m"]}).scenes
    assert [scene.drive.torque for scene in scenes] == [0.0, 4.6e-18]


def test_distributions_with_units_are_refused():
    """Scipy drops the unit: 14.3 rpm would be 14.3 rad/s."""
    with pytest.raises(gd.SceneError, match="carries units"):
        read_distributions(LOW, {"drive.speed": stats.norm(loc=14.3 * U.rpm, scale=0.5)})


TIME = np.arange(64) * 1e-5
SPEED = 1.5 + 0.01 * np.sin(7e3 * TIME)


@pytest.mark.parametrize(
    "frame",
    [
        pd.DataFrame({"time": pd.to_timedelta(np.arange(64) * 10, unit="us"), "speed [rad/s]": SPEED}),
        pd.DataFrame({"speed [rad/s]": SPEED}, index=pd.to_timedelta(np.arange(64) * 10, unit="us")),
    ],
    ids=["column", "index"],
)
def test_records_with_durations(frame):
    signal = read_signal(frame)
    np.testing.assert_allclose(signal.time, TIME, rtol=1e-12, atol=0)
    np.testing.assert_allclose(signal.gear_speed, SPEED, rtol=1e-15)


def test_records_of_arrays_with_durations():
    times = pd.to_timedelta(np.arange(64) * 10, unit="us")
    array = xr.DataArray(
        SPEED, dims="time", coords={"time": times}, attrs={"units": "rad/s"}, name="gear_speed"
    )
    assert signals(array).signals[0].interval == pytest.approx(1e-5, rel=1e-12, abs=0)


@pytest.mark.parametrize("speeds", [SPEED > 1.5, pd.to_datetime(np.arange(64))])
def test_records_of_no_numbers_are_refused(speeds):
    with pytest.raises(gd.SceneError, match="no numbers"):
        read_signal(pd.DataFrame({"time [s]": TIME, "speed [rad/s]": speeds}))


def test_maps_with_units_masks_and_flags():
    heights = 1e-9 * np.random.default_rng(0).standard_normal((64, 64))
    expected = height_map(heights, (1e-6, 1e-6)).heights
    for carried in (
        1e9 * heights * U.nm,
        xr.DataArray(1e9 * heights, attrs={"units": "nm"}),
        heights.tolist(),
    ):
        np.testing.assert_allclose(height_map(carried, (1e-6, 1e-6)).heights, expected, rtol=1e-9, atol=1e-18)
    masked = np.ma.array(heights, mask=np.zeros(heights.shape, bool))
    masked[3, 4] = np.ma.masked
    assert height_map(masked, (1e-6, 1e-6)).hole_count == 1
    with pytest.raises(gd.SceneError, match="truth values"):
        height_map(heights > 0.0, (1e-6, 1e-6))
