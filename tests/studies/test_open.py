"""`gearidae.open` reads what any part of the program has written; errors of the special readers name it."""

from __future__ import annotations

import pytest

import gearidae as gd

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11})


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A run, a sweep, a study that holds runs, and one that holds none."""
    folder = tmp_path_factory.mktemp("files")
    products = {
        "run": gd.simulate(LOW, archive=folder / "run.nc"),
        "sweep": gd.sweep(LOW, {"drive.torque": [4e-18, 5e-18]}, archive=folder / "sweep.nc"),
        "ensemble": gd.studies.ensemble(
            LOW, {"drive.torque": "uniform(4e-18, 5e-18)"}, 2, archive=folder / "ensemble.nc"
        ),
        "sticking_threshold": gd.studies.sticking_threshold(
            LOW, between=(0.4, 0.7), exits=5, width=0.2, archive=folder / "sticking_threshold.nc"
        ),
    }
    return folder, products


@pytest.mark.parametrize("name", ["run", "sweep", "ensemble", "sticking_threshold"])
def test_every_file_is_opened_as_what_it_is(files, name):
    folder, products = files
    opened = gd.open(folder / f"{name}.nc")
    assert opened.drop_attrs().identical(products[name].drop_attrs())
    kind = "runs" if name in ("run", "sweep") else name
    assert opened.gearidae.kind == products[name].gearidae.kind == kind


def test_readers_of_one_kind_name_it(files):
    folder, _ = files
    with pytest.raises(gd.SceneError, match=r"is no archive of runs but .*: gearidae\.open reads it"):
        gd.open_archive(folder / "sticking_threshold.nc")
    for name in ("run", "ensemble"):
        with pytest.raises(gd.SceneError, match=r"is no life of a coating.*gearidae\.open reads it as what"):
            gd.studies.open_life(folder / f"{name}.nc")


def test_what_nobody_of_us_has_written(tmp_path):
    (tmp_path / "text.nc").write_text("time,speed\n")
    for name in ("text.nc", "missing.nc"):
        with pytest.raises(gd.SceneError, match=r"archive = "):
            gd.open(tmp_path / name)


def test_an_interrupted_archive_says_how_to_go_on(tmp_path):
    def stop(time, events):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        gd.simulate(LOW, archive=tmp_path / "run.nc", progress=stop)
    ds = gd.open(tmp_path / "run.nc")
    assert ds.attrs["status"] == "interrupted"
    assert ds.attrs["message"].endswith("go on with --resume (resume=True)")
    assert "interrupted: not at its end yet" in repr(ds.gearidae)
    assert gd.simulate(LOW, archive=tmp_path / "run.nc", resume=True).attrs["status"] == "finished"
