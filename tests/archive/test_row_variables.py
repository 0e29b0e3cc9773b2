"""Rows of runs, events and passages, in datasets: labelled, picked, joined, kept, and counted in archives that grow."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import combine, to_dataset
from gearidae.archive.output_selection import read_keep
from gearidae.archive.row_variables import rows_from
from gearidae.archive.select import runs
from gearidae.records import Events, Passages
from gearidae.scene.sampled import rows_of

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 11})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 11})
KEYS = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [4e-18, 5e-18, 6e-18]}
IMPACTS = (1, 4, 0, 2, 3, 5)


@pytest.fixture
def sweep(make_solution):
    scenes = [
        LOW.replace({"coating.sam_fraction": fraction, "drive.torque": torque})
        for fraction in KEYS["coating.sam_fraction"]
        for torque in KEYS["drive.torque"]
    ]
    solutions = [make_solution(scene, impacts=count) for scene, count in zip(scenes, IMPACTS, strict=True)]
    return combine(LOW, KEYS, scenes, solutions), scenes, solutions


def test_rows_carry_the_labels_of_their_runs(sweep):
    ds, _, solutions = sweep
    for (label, run), solution in zip(runs(ds), solutions, strict=True):
        for kind in rows_of(LOW):
            rows = getattr(solution, kind.field)
            assert run.sizes[kind.dim] == len(rows)
            np.testing.assert_array_equal(rows_from(run, kind).table(), rows.table())
            for name, value in label.items():
                assert (run[f"{kind.dim}_{name}"] == value).all()


def test_a_picked_run_has_its_passages_only(sweep):
    ds, scenes, solutions = sweep
    picked = ds.sel(torque=6e-18)
    assert picked.sizes["passage"] == ds.sizes["passage"]  # xarray knows no runs
    assert len(picked.gearidae.passages()) == IMPACTS[2] + IMPACTS[5]
    run = ds.gearidae.run(sam_fraction=0.5, torque=6e-18)
    assert {str(name) for name in run.variables if str(name).startswith("passage_")} == {
        str(name)
        for name in to_dataset(scenes[5], solutions[5]).variables
        if str(name).startswith("passage_")
    }
    np.testing.assert_array_equal(run["passage_drive_work"], solutions[5].passages.drive_work)


def test_the_table_of_passages(sweep):
    ds, _, solutions = sweep
    table = ds.gearidae.passages()
    assert len(table) == sum(IMPACTS)
    assert set(table["flank"].cat.categories) == {"none", "drive", "coast"}
    rows = table.query("sam_fraction == 1.0 and torque == 5e-18")
    np.testing.assert_array_equal(rows["adhesion_loss"], solutions[1].passages.adhesion_loss)
    np.testing.assert_array_equal(rows["tooth"], solutions[1].passages.pair % LOW.gears.pinion_teeth)
    assert "passages()" in repr(ds.gearidae)


def test_which_scenes_have_passages(make_solution):
    """No roller, and no gears that leave them out; in a sweep of both, those that have some."""
    off = LOW.replace({"run.passages": False})
    assert "passage" not in to_dataset(ROLLER, make_solution(ROLLER)).dims
    assert "passage" not in to_dataset(off, make_solution(off)).dims
    scenes = [LOW, off]
    both = combine(LOW, {"run.passages": [True, False]}, scenes, [make_solution(scene) for scene in scenes])
    assert both.sizes["passage"] == 3
    with pytest.raises(gd.SceneError, match="passages"):
        to_dataset(off, make_solution(off)).gearidae.passages()


def test_passages_are_kept_by_their_name(make_solution):
    solution = make_solution(LOW)
    for names, left in ((["passages"], (0, 3)), (["events"], (6, 0)), (["passages", "events"], (6, 3))):
        keep = read_keep(names, LOW)
        thinned = keep.thinned(solution)
        assert (len(thinned.events), len(thinned.passages)) == left
        ds = combine(LOW, {"coating.sam_fraction": [1.0]}, [LOW], [thinned], selection=keep)
        assert {dim for dim in ("event", "passage") if dim in ds.dims} == {name[:-1] for name in names}
    with pytest.raises(gd.SceneError, match="passages"):
        read_keep(["passages"], ROLLER)


def test_columns_that_a_version_does_not_know_are_missing(make_solution):
    ds = to_dataset(LOW, make_solution(LOW)).drop_vars(["event_force", "passage_film_loss"])
    assert np.isnan(rows_from(ds, Events).force).all()
    assert np.isnan(rows_from(ds, Passages).film_loss).all()
    assert len(rows_from(ds.drop_dims("passage"), Passages)) == 0


def test_archives_without_passages_open(make_solution, tmp_path):
    """As those of version 0.2, or of a user who has dropped them."""
    ds = to_dataset(LOW, make_solution(LOW)).drop_dims("passage").drop_vars("event_force")
    gd.save(ds, tmp_path / "old.nc")
    xr.testing.assert_identical(gd.open_archive(tmp_path / "old.nc"), ds)


def test_pieces_of_a_chain_have_their_passages_cut(make_solution):
    """A piece of a run that still has the passages of the whole would give them twice."""
    run = gd.simulate(LOW.replace({"run.duration": 0.05}))
    assert run.sizes["passage"] > 1
    middle = float(run.time[5])
    begin = run.isel(time=slice(None, 6), event=run.event_time.values <= middle)
    rest = run.isel(time=slice(5, None), event=run.event_time.values > middle)
    with pytest.raises(gd.SceneError, match="passages of dataset 2 must follow"):
        gd.concat([begin, rest], "time")
    begin, rest = (
        part.isel(passage=chosen)
        for part, chosen in (
            (begin, run.passage_time.values <= middle),
            (rest, run.passage_time.values > middle),
        )
    )
    assert gd.concat([begin, rest], "time").passage_time.equals(run.passage_time)
