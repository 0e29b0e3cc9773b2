"""What is asked of a long archive is read piece by piece: no more of it is in memory than a piece at a time.

The pieces are made small here, and every read of the file is watched; the largest decides how memory grows.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from importlib import import_module
from itertools import pairwise

import netCDF4
import numpy as np
import pytest
import xarray as xr
from xarray.backends.netCDF4_ import NetCDF4ArrayWrapper

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.archive import definition, netcdf, pieces, save, time_index, to_dataset, unfinished
from gearidae.archive import run_summary as summary_module
from gearidae.archive.row_variables import DIMS
from gearidae.archive.unfinished import RunJournal
from gearidae.drawing import style
from gearidae.plot import spectra
from gearidae.records import Block, Events, Passages, Statistics
from gearidae.report import build_report, series
from gearidae.report.teeth import pack_runs
from same import assert_same

page_module = import_module("gearidae.report.page")
NOTHING = {"time": np.empty(0), "samples": {}, "events": Events.none(), "passages": Passages.none()}
SAMPLES, PIECE, ANALYSED, DRAWN = 10_007, 512, 2_048, 200
LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": SAMPLES})


@pytest.fixture
def lengths(monkeypatch):
    """Make pieces small, and note how many values each read of a file fetches."""
    for module, name, value in (
        (netcdf, "LONGEST_WHOLE", 0),
        (definition, "LONGEST_WHOLE", 0),
        (netcdf, "LARGEST_IN_MEMORY", PIECE),
        (unfinished, "LARGEST_IN_MEMORY", PIECE),
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


def test_the_journal_of_a_run(make_solution, tmp_path, lengths, monkeypatch):
    """The same holds of a run under way, however its blocks are cut; written from there, it is the archive."""
    solution = make_solution(LOW)
    whole = to_dataset(LOW, solution)
    template = to_dataset(LOW, replace(solution, **NOTHING))
    rows, events, passages = (
        np.stack(list(solution.samples.values()), axis=1),
        solution.events.table(),
        solution.passages.table(),
    )
    monkeypatch.setattr(unfinished, "FRAME_SHARE", 0.0)
    cuts = [0, 1, 400, 400, 777, 5_000, SAMPLES]
    with RunJournal.create(tmp_path / "run.nc", template.attrs) as journal:
        for number, (first, last) in enumerate(pairwise(cuts)):
            ends = [len(table) * (number + 1) // (len(cuts) - 1) for table in (events, passages)]
            begins = [len(table) * number // (len(cuts) - 1) for table in (events, passages)]
            block = Block(
                rows[first:last],
                events[begins[0] : ends[0]],
                0.1,
                passages=passages[begins[1] : ends[1]],
            )
            journal.take(block, Statistics(), 0.0)
        save(journal.filled(whole.isel(time=slice(0), event=slice(0), passage=slice(0))), tmp_path / "end.nc")
    with gd.open_archive(tmp_path / "run.nc") as opened:
        assert opened.attrs["status"] == "interrupted"
        assert isinstance(opened.xindexes["time"], time_index.TimeIndex)
        for name in (
            name for name, variable in whole.variables.items() if {*variable.dims} & {"time", *DIMS}
        ):
            np.testing.assert_array_equal(opened[name], whole[name])
            assert opened[name].dtype == whole[name].dtype
        for key in (3, -1, slice(390, 410), slice(None, None, 600), slice(9000, 20, -7), [5, 4_999, 5_000]):
            np.testing.assert_array_equal(opened.gear_speed[key], whole.gear_speed[key])
    save(whole, tmp_path / "whole.nc")
    for ds in (written := [gd.open_archive(tmp_path / name) for name in ("end.nc", "whole.nc")]):
        ds.load()
    xr.testing.assert_identical(*written)
    monkeypatch.setattr(definition, "LONGEST_WHOLE", 2**30)  # the same by xarray alone
    save(whole, tmp_path / "at_once.nc")
    with netCDF4.Dataset(tmp_path / "end.nc") as ours, netCDF4.Dataset(tmp_path / "at_once.nc") as theirs:
        assert {*ours.variables} == {*theirs.variables}
        for name, variable in ours.variables.items():
            other = theirs[name]
            assert (variable.dtype, variable.shape, variable.chunking(), variable.filters()) == (
                other.dtype,
                other.shape,
                other.chunking(),
                other.filters(),
            ), name
            assert variable.ncattrs() == other.ncattrs()


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
