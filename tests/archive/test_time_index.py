"""Sample times looked up in the file are found as xarray's usual index finds them in memory."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from gearidae.archive import time_index
from gearidae.archive.time_index import TimeIndex, in_memory, with_times

TIMES = np.linspace(0.0, 3.0, 31)


def plain():
    return xr.Dataset({"speed": ("time", np.arange(31.0))}, {"time": ("time", TIMES, {"units": "s"})})


def looked_up():
    ds = plain()
    return with_times(ds.drop_vars("time"), ds["time"].variable.to_base_variable())


@pytest.fixture(autouse=True)
def small_parts_only(monkeypatch):
    """Keep our index for parts of more than five labels."""
    monkeypatch.setattr(time_index, "LARGEST_IN_MEMORY", 5)


LABELS = st.one_of(st.sampled_from(list(TIMES)), st.floats(-1.0, 4.0))
METHODS = st.sampled_from([None, "nearest", "pad", "ffill", "backfill", "bfill"])


def attempt(ds, label, **options):
    try:
        return ds["speed"].sel(time=label, **options).values
    except KeyError:
        return None


@given(LABELS, METHODS, st.one_of(st.none(), st.floats(0.0, 1.0)))
def test_single_times(label, method, tolerance):
    options = {} if method is None else {"method": method, "tolerance": tolerance}
    wanted, answer = attempt(plain(), label, **options), attempt(looked_up(), label, **options)
    if wanted is None or answer is None:
        assert wanted is answer
    elif method == "nearest":  # halfway between two, either is nearest
        distances = [abs(TIMES[int(value)] - label) for value in (wanted, answer)]
        assert distances[0] == pytest.approx(distances[1], rel=0, abs=1e-15)
    else:
        assert wanted == answer


@given(st.one_of(st.none(), LABELS), st.one_of(st.none(), LABELS))
def test_slices_include_both_ends(start, stop):
    part = slice(start, stop)
    np.testing.assert_array_equal(looked_up()["speed"].sel(time=part), plain()["speed"].sel(time=part))


def test_lists_and_arrays_of_times():
    wanted = [0.5, 2.51]
    assert looked_up()["speed"].sel(time=wanted, method="nearest").values.tolist() == [5.0, 25.0]
    places = xr.DataArray(wanted, dims="place")
    assert looked_up()["speed"].sel(time=places, method="nearest").dims == ("place",)
    with pytest.raises(KeyError):
        looked_up().sel(time=[0.55])


def test_what_is_refused():
    with pytest.raises(ValueError, match="no step"):
        looked_up().sel(time=slice(0.0, 1.0, 2.0))
    with pytest.raises(ValueError, match="must be one of nearest"):
        looked_up().sel(time=1.0, method="next")


def test_parts_keep_an_index():
    ds = looked_up()
    assert isinstance(ds.isel(time=slice(6)).xindexes["time"], TimeIndex)
    assert isinstance(ds.isel(time=slice(None, None, 2)).xindexes["time"], TimeIndex)
    for part in (ds.isel(time=slice(5)), ds.sel(time=slice(0.0, 0.4)), ds.isel(time=[3, 1])):
        xr.testing.assert_identical(part, plain().sel(time=part["time"].values))
    assert "time" not in ds.isel(time=3).xindexes
    assert "time" not in ds.isel(time=slice(None, None, -1)).xindexes


def test_it_goes_along_with_the_dataset():
    ds = looked_up()
    assert (ds["speed"] + looked_up()["speed"]).sum() == 2.0 * plain()["speed"].sum()
    assert ds.rename(time="t")["speed"].sel(t=0.5).item() == 5.0
    assert ds["speed"].to_series().loc[0.5] == 5.0
    assert ds.assign_attrs(a=1).equals(ds.copy(deep=True))
    assert not ds.equals(ds.assign_coords(time=TIMES + 1.0))
    xr.testing.assert_identical(in_memory(ds), plain())


PARTS = st.tuples(st.integers(0, 30), st.integers(1, 31)).map(
    lambda ends: slice(min(ends), max(*ends, min(ends) + 7))
)


@given(PARTS, PARTS, st.sampled_from(["inner", "outer", "left", "right"]))
def test_alignment(first, second, how):
    """Two archives, or parts of them, are aligned as they would be in memory."""

    def aligned(ds, file):
        return xr.align(file(ds, first), file(ds, second), join=how)

    results = aligned(plain(), lambda ds, part: _in_file(ds.isel(time=part)))
    wanted = aligned(plain(), lambda ds, part: ds.isel(time=part))
    for mine, theirs in zip(results, wanted, strict=True):
        np.testing.assert_array_equal(mine["time"], theirs["time"])
        np.testing.assert_array_equal(mine["speed"], theirs["speed"])


@given(PARTS, st.sampled_from([None, "nearest", "pad", "backfill"]))
def test_reindexing_like_another(part, method):
    coarse = plain().isel(time=part)
    coarse = coarse.assign_coords(time=coarse["time"] + 0.01 if method else coarse["time"])
    result = looked_up().reindex_like(_in_file(coarse), method=method)
    np.testing.assert_array_equal(result["speed"], plain().reindex_like(coarse, method=method)["speed"])


def test_another_kind_of_index_is_told_how_to_be_met():
    with pytest.raises(ValueError, match=r'drop_indexes\("time"\)'):
        looked_up().reindex(time=TIMES[::2])
    usual = looked_up().drop_indexes("time").set_xindex("time")
    np.testing.assert_array_equal(usual.reindex(time=TIMES[::2])["speed"], np.arange(0.0, 31.0, 2.0))


def _in_file(ds):
    return with_times(ds.drop_vars("time"), ds["time"].variable.to_base_variable())
