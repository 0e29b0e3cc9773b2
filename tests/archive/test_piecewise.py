"""What is asked of a long archive is read piece by piece: no more of it is in memory than a piece at a time.

The pieces are made small here, and every read of the file is watched; the largest decides how memory grows.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module

import numpy as np
import pytest
import xarray as xr
from xarray.backends.netCDF4_ import NetCDF4ArrayWrapper

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.archive import netcdf, pieces, save, time_index, to_dataset
from gearidae.archive import run_summary as summary_module
from gearidae.archive.growing import GrowingArchive
from gearidae.drawing import style
from gearidae.plot import spectra
from gearidae.report import build_report, series
from gearidae.report.teeth import pack_runs
from same import assert_same

page_module = import_module("gearidae.report.page")
SAMPLES, PIECE, ANALYSED, DRAWN = 10_007, 512, 2_048, 200
LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": SAMPLES})


@pytest.fixture
def lengths(monkeypatch):
    """Make pieces small, and note how many values each read of a file fetches."""
    for module, name, value in (
        (netcdf, "_LAZY_ABOVE", 0),
        (netcdf, "LARGEST_IN_MEMORY", PIECE),
        (time_index, "LARGEST_IN_MEMORY", PIECE),
        (pieces, "PIECE", PIECE),
        (style, "PIECE", PIECE),
        (series, "PIECE", PIECE),
        (summary_module, "PIECE", PIECE),
        (style, "_MOST_POINTS", DRAWN),
        (spectra, "_MOST_SAMPLES", ANALYSED),
        (page_module, "pack_runs", partial(pack_runs, most_states=300)),  # which take the most time
    ):
        monkeypatch.setattr(module, name, value)
    sizes = []
    read = NetCDF4ArrayWrapper._getitem

    def watched(self, key):
        values = read(self, key)
        sizes.append(np.size(values))
        return values

    monkeypatch.setattr(NetCDF4ArrayWrapper, "_getitem", watched)
    return sizes


@pytest.fixture
def long(make_solution, tmp_path, lengths):
    """An archive of many pieces, unevenly, and what it holds in memory."""
    ds = to_dataset(LOW, make_solution(LOW))
    assert ds.sizes["time"] == SAMPLES
    save(ds, tmp_path / "long.nc")
    with gd.open_archive(tmp_path / "long.nc") as opened:
        yield opened, ds


def test_outcome_and_summary(long, lengths):
    opened, ds = long
    assert_same(outcomes(opened), outcomes(ds))
    piecewise, whole = summary_module.summary_of(opened), summary_module.summary_of(ds)
    assert piecewise.as_plain() == whole.as_plain()  # in which NaN, of what is not known, equals itself
    assert 1 < max(lengths) <= PIECE + 2  # pieces of the summary overlap


def test_pictures_and_report(long, lengths):
    opened, ds = long
    del lengths[:]
    for picture in (gd.plot.overview, gd.plot.gap, gd.plot.transmission_error):
        picture(opened)
    assert max(lengths) <= PIECE
    for picture in (gd.plot.power_spectrum, gd.plot.cycle):
        picture(opened)
    assert max(lengths) <= ANALYSED
    page = build_report(opened, most_values=9_000)
    assert max(lengths) <= ANALYSED
    assert "cannot be repeated" in page  # it is no run, of which the teeth are asked for at some samples only
    assert page == build_report(ds, most_values=9_000)


def test_opening_reads_next_to_nothing(long, lengths):
    opened, _ = long
    assert sum(lengths) < 100
    assert opened.sel(time=0.1, method="nearest").gear_speed.size == 1
    assert sum(lengths) < 200


def test_a_growing_archive(make_solution, tmp_path, lengths):
    """The same holds of a run under way; of a short one nothing stays behind in the file."""
    template = to_dataset(LOW, make_solution(LOW)).isel(time=slice(0), event=slice(0), passage=slice(0))
    path = tmp_path / "run.nc"
    with GrowingArchive.create(path, template, SAMPLES, 0.3) as archive:
        archive._write("gear_speed", 0, np.ones(SAMPLES))
        archive.lengths = {**archive.lengths, "time": SAMPLES}
        archive._commit()
    with gd.open_archive(path) as opened:
        assert opened.sizes["time"] == SAMPLES
        assert opened.attrs["status"] == "interrupted"
        assert max(lengths) <= PIECE


@pytest.mark.parametrize("size", [1, 7, 512, 10**6])
def test_pieces(size, monkeypatch):
    """However it is cut, a variable has one spread, one end, one first value above a level."""
    monkeypatch.setattr(pieces, "PIECE", size)
    values = np.random.default_rng(3).normal(size=1000)
    values[900:] = np.nan
    array = xr.DataArray(values, dims="time")
    statistics = pieces.spread(array, 5, 950)
    assert (statistics.number, statistics.low, statistics.high) == (
        895,
        values[5:900].min(),
        values[5:900].max(),
    )
    assert statistics.mean == pytest.approx(values[5:900].mean(), rel=1e-12, abs=0)
    assert pieces.reached(array) == 900
    assert pieces.reached(array[:700]) == 700
    assert pieces.reached(array.shift(time=3)) == 903
    assert pieces.reached(array[900:]) == 0
    assert pieces.count(array, values[3]) == 1
    assert pieces.spread(array, 900).number == 0
