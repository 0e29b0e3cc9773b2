"""`ds.gearidae`: a run picked from a sweep is the run that it would have been by itself."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

import gearidae as gd
from gearidae.archive.select import runs
from gearidae.records import EventKind

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 11, "contact.bodies": "rigid"})
FRACTIONS, TORQUES = [1.0, 0.5], [4e-18, 5e-18, 6e-18]
OVER = {"coating.sam_fraction": FRACTIONS, "drive.torque": TORQUES}


def scene_at(fraction, torque):
    return LOW.replace({"coating.sam_fraction": fraction, "drive.torque": torque})


def plain(run):
    """A single run without what depends on the moment and the machine's load."""
    gone = (
        "history",
        "date_created",
        "wall_time",
        "end_state",
        "end_state_name",
    )  # the last is not kept of the runs of a sweep
    kept = run.copy()
    kept.attrs = {name: value for name, value in run.attrs.items() if name not in gone}
    return kept


@pytest.fixture(scope="module")
def ds():
    return gd.sweep(LOW, OVER)


def test_the_scene_follows_a_selection(ds):
    worn = ds.sel(sam_fraction=0.5, torque=6e-18)
    assert worn.gearidae.scene == scene_at(0.5, 6e-18)
    assert ds.isel(sam_fraction=0, torque=1).gearidae.scene == scene_at(1.0, 5e-18)
    assert ds.isel(sam_fraction=[1], torque=[0]).gearidae.scene == scene_at(0.5, 4e-18)
    assert worn[["gear_speed", "min_gear_speed"]].gearidae.scene == scene_at(
        0.5, 6e-18
    )  # from its coordinates
    assert ds.gearidae.template == LOW
    assert ds.gearidae.scenes == [scene_at(f, t) for f in FRACTIONS for t in TORQUES]


def test_several_runs_have_no_one_scene(ds):
    with pytest.raises(gd.SceneError, match="must be a single run"):
        _ = ds.sel(torque=4e-18).gearidae.scene


@pytest.mark.parametrize("fraction", FRACTIONS)
def test_a_run_is_what_simulate_returns(ds, fraction):
    """All of it: samples, events, scene, statistics, energy balance, extremes, summary."""
    alone = gd.simulate(scene_at(fraction, 5e-18))
    assert plain(ds.gearidae.run(sam_fraction=fraction, torque=5e-18)).identical(plain(alone))
    assert plain(ds.sel(sam_fraction=fraction).gearidae.run(torque=5e-18)).identical(plain(alone))


def test_a_run_of_a_roller_sweep_is_what_simulate_returns():
    ds = gd.sweep(ROLLER, {"roller.speed": [0.01, 0.02]})
    alone = gd.simulate(ROLLER.replace({"roller.speed": 0.02}))
    assert plain(ds.gearidae.run(roller_speed=0.02)).identical(plain(alone))


def test_a_zipped_run_is_found_by_either_label():
    ds = gd.sweep(LOW, {"drive.torque": TORQUES, "load.drag": [7e-18, 8e-18, 9e-18]}, zipped=True)
    alone = gd.simulate(LOW.replace({"drive.torque": 5e-18, "load.drag": 8e-18}))
    for label in ({"torque": 5e-18}, {"drag": 8e-18}):
        assert plain(ds.gearidae.run(**label)).identical(plain(alone))


def test_an_archive_tells_the_same(ds, tmp_path):
    gd.save(ds, tmp_path / "sweep.nc")
    kept = gd.open_archive(tmp_path / "sweep.nc")
    assert kept.identical(ds)
    labels = {"sam_fraction": 0.5, "torque": 4e-18}
    assert kept.gearidae.run(**labels).identical(ds.gearidae.run(**labels))


def test_chunked_data_tell_the_same(ds):
    """As of a sweep that is opened from zarr."""
    pytest.importorskip("dask")
    chunked = ds.chunk()
    pd.testing.assert_frame_equal(chunked.gearidae.verdicts(), ds.gearidae.verdicts())
    assert chunked.gearidae.scenes == ds.gearidae.scenes
    assert plain(chunked.gearidae.run(sam_fraction=0.5, torque=5e-18).compute()).identical(
        plain(ds.gearidae.run(sam_fraction=0.5, torque=5e-18))
    )


@pytest.mark.parametrize(
    ("labels", "said"),
    [
        ({"sam_fracton": 0.5}, "must be one of"),
        ({"sam_fraction": 0.51, "torque": 4e-18}, "must be one of 1, 0.5"),
        ({"sam_fraction": 0.5}, r"leaves several runs: name one, such as run\(torque=4e-18\)"),
        ({}, "leaves several runs"),
    ],
)
def test_labels_that_name_no_run(ds, labels, said):
    with pytest.raises(gd.SceneError, match=said):
        ds.gearidae.run(**labels)


def test_verdicts_are_a_row_a_run(ds):
    table = ds.gearidae.verdicts()
    assert table[["sam_fraction", "torque"]].values.tolist() == [[f, t] for f in FRACTIONS for t in TORQUES]
    assert table["min_gear_speed"].tolist() == ds.min_gear_speed.values.ravel().tolist()
    assert table["words"].str.contains("in 2 ms").all()
    onsets = (
        ds.gearidae.events().query("kind == 'onset'").groupby(["sam_fraction", "torque"], sort=False).size()
    )
    assert table.set_index(["sam_fraction", "torque"])["impacts"].equals(
        onsets.reindex(table.set_index(["sam_fraction", "torque"]).index, fill_value=0)
    )
    single = ds.gearidae.run(sam_fraction=0.5, torque=4e-18).gearidae.verdicts()
    row = table.query("sam_fraction == 0.5 and torque == 4e-18").drop(columns="torque")
    pd.testing.assert_frame_equal(single, row.reset_index(drop=True))


def test_verdicts_of_a_roller():
    table = gd.simulate(ROLLER).gearidae.verdicts()
    assert len(table) == 1
    assert table.largest_mesh_force[0] > 0.0
    assert table.verdict[0] in ("rebounds", "sticks")


def test_time_series(ds):
    long = ds.gearidae.to_dataframe()
    assert len(long) == ds.gear_speed.size
    assert list(long.columns[:2]) == ["sam_fraction", "torque"]
    run = ds.gearidae.run(sam_fraction=0.5, torque=6e-18).gearidae.to_dataframe()
    assert np.array_equal(run.index, ds.time)
    part = long.query("sam_fraction == 0.5 and torque == 6e-18").drop(columns=["sam_fraction", "torque"])
    assert part.equals(run)
    assert list(ds.gearidae.to_dataframe("gear_speed").columns) == ["sam_fraction", "torque", "gear_speed"]


def test_absurd_tables_are_refused(ds):
    with pytest.raises(gd.SceneError, match=r"would take .* pick runs"):
        ds.gearidae.to_dataframe(largest=8 * ds.gear_speed.size)
    with pytest.raises(gd.SceneError, match="must be sampled"):
        ds.gearidae.to_dataframe(["steps"])


def test_events_are_those_of_the_runs_picked(ds):
    worn = ds.sel(sam_fraction=0.5, torque=6e-18)
    assert worn.sizes["event"] == ds.sizes["event"]  # what xarray leaves
    table = worn.gearidae.events()
    alone = gd.simulate(scene_at(0.5, 6e-18))
    assert np.array_equal(table["time"], alone.event_time)
    assert [EventKind[word.upper()] for word in table["kind"]] == alone.event_kind.values.tolist()
    assert set(table["flank"]) <= {"none", "drive", "coast"}
    half = ds.sel(sam_fraction=0.5).gearidae.events()
    assert half.equals(ds.gearidae.events().query("sam_fraction == 0.5").reset_index(drop=True))


def test_runs_that_were_turned_round_keep_their_events(ds):
    """Events are found by their labels, wherever their runs are."""
    for label, run in runs(ds.isel(sam_fraction=slice(None, None, -1)).transpose("torque", ...)):
        alone = gd.simulate(scene_at(label["sam_fraction"], label["torque"]))
        assert np.array_equal(run.event_time, alone.event_time)


def test_a_run_without_samples_is_told_by_the_solver():
    ds = gd.simulate(LOW, samples="off")
    assert ds.gearidae.to_dataframe().empty
    assert ds.gearidae.verdicts().verdict[0] == gd.simulate(LOW).gearidae.verdicts().verdict[0]


def test_the_accessor_waits_for_xarray():
    """Importing gearidae imports neither xarray nor the engine, and yet code that imports xarray later has it."""
    script = (
        "import sys, gearidae; before = set(sys.modules); import xarray as xr; "
        "heavy = {'numba', 'sksundae', 'gearidae.engine', 'gearidae.archive'} & set(sys.modules); "
        "print('xarray' in before, heavy, hasattr(xr.Dataset(), 'gearidae'), bool(xr.Dataset()._repr_html_()))"
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert out.split("\n")[0] == "False set() True True"
    other_way = "import xarray as xr, gearidae; print(hasattr(xr.Dataset(), 'gearidae'))"
    out = subprocess.run([sys.executable, "-c", other_way], capture_output=True, text=True, check=True).stdout
    assert out.strip() == "True"


def test_a_dataset_of_something_else():
    import xarray as xr

    with pytest.raises(gd.SceneError, match="must come from simulate"):
        _ = xr.Dataset().gearidae.scene


def test_labels_may_be_written_as_in_a_scene(ds):
    """Texts with a unit and quantities pick what their number picks, of one run or of several."""
    pint = pytest.importorskip("pint")
    wanted = ds.gearidae.run(sam_fraction=0.5, torque=5e-18)
    for torque in ("5 aN m", "5e-6 pN m", pint.UnitRegistry().Quantity(5.0, "aN m")):
        assert ds.gearidae.run(sam_fraction="50 %", torque=torque).identical(wanted)
    both = ds.gearidae.sel(torque="5 aN m")
    assert dict(both.sizes) | {"sam_fraction": 2} == dict(both.sizes)
    assert set(both.event_torque.values.tolist()) == {5e-18}
    with pytest.raises(gd.SceneError, match=r"run\(torque\) = 7 aN m: must be one of 4e-18, 5e-18"):
        ds.gearidae.run(torque="7 aN m")
    with pytest.raises(gd.SceneError, match="does not fit; expected a number with a unit that fits N m"):
        ds.gearidae.sel(torque="5 um")


def test_the_accessor_lists_what_works(ds):
    """What it lists can be called as it stands there."""
    for dataset in (ds, ds.gearidae.run(sam_fraction=0.5, torque=5e-18), ds.sel(torque=5e-18)):
        title, *rows = repr(dataset.gearidae).splitlines()
        assert title.startswith("<")
        assert len(rows) > 5
        for row in rows:
            call = row.split("  ")[1]
            value = eval(
                call if call.startswith("gearidae.") else f"ds.gearidae.{call}",
                {"ds": dataset, "gearidae": gd},
            )
            assert value is not None, call
    assert "6 runs of teodorescu2009_low_speed along sam_fraction (1, 0.5), torque" in repr(ds.gearidae)
    assert ds.gearidae._repr_html_().startswith("<pre>&lt;6 runs")


def test_the_accessor_of_something_else_has_a_text():
    import xarray as xr

    assert repr(xr.Dataset({"a": 1}).gearidae).startswith("<no dataset of gearidae")
