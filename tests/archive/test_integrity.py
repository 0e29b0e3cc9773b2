"""A flipped bit in an archive's samples or events: the variable is named, and nothing of it is read as data."""

import json
import shutil

import netCDF4
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import combine, save, to_dataset
from gearidae.archive import netcdf as netcdf_module
from gearidae.archive.variables import CONTACT
from gearidae.cli import main

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 101})
FRACTIONS = [1.0, 0.5]


@pytest.fixture(scope="module")
def streamed(tmp_path_factory):
    """An archive that grew while its run went on."""
    path = tmp_path_factory.mktemp("streamed") / "run.nc"
    gd.simulate(gd.preset("roller_slow").replace({"run.samples": 301}), archive=path)
    return path


@pytest.fixture(scope="module")
def kept(make_solution, tmp_path_factory, streamed):
    folder = tmp_path_factory.mktemp("kept")
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in FRACTIONS]
    solutions = [make_solution(scene) for scene in scenes]
    swept = combine(LOW, {"coating.sam_fraction": FRACTIONS}, scenes, solutions)
    return (
        save(to_dataset(LOW, make_solution(LOW)), folder / "single.nc"),
        save(swept, folder / "swept.nc"),
        shutil.copyfile(streamed, folder / "streamed.nc"),
    )


@pytest.fixture
def archives(kept, tmp_path):
    """Copies, for a test to damage."""
    return {path.stem: shutil.copyfile(path, tmp_path / path.name) for path in kept}


def first_bytes(path):
    """Where the numbers along dimensions begin in the file, of the variables whose bytes are there once."""
    content = path.read_bytes()
    with xr.open_dataset(path, decode_times=False) as ds:
        values = {name: ds[name].values.tobytes() for name in ds.variables if ds[name].dtype.kind == "f"}
    return {
        name: content.find(value)
        for name, value in values.items()
        if len(value) > 8 and content.count(value) == 1
    }


def flipped(path, place, bit):
    content = bytearray(path.read_bytes())
    content[place] ^= 1 << bit
    other = path.with_name("flipped.nc")
    other.write_bytes(bytes(content))
    return other


TEXTS = {
    "status",
    "message",
    "backend",
    "method",
    "skipped",
    "scene",
    *(quantity.name for quantity in CONTACT),
}
"""Of each run of a sweep, of varying length."""


@pytest.mark.parametrize("kind", ["single", "swept", "streamed"])
def test_every_variable_along_a_dimension_carries_a_checksum(archives, kind):
    with netCDF4.Dataset(archives[kind]) as file:
        plain = {
            name
            for name, variable in file.variables.items()
            if not (variable.filters() or {}).get("fletcher32")
        }
        single = {name for name, variable in file.variables.items() if not variable.dimensions}
        assert "sam_fraction" in single or kind == "swept"
        assert plain == (TEXTS if kind == "swept" else single)


@pytest.mark.parametrize("kind", ["single", "swept", "streamed"])
def test_a_flipped_bit_is_named(archives, kind):
    path = archives[kind]
    places = first_bytes(path)
    assert {"time", "event_time"} < set(places)
    for number, (name, place) in enumerate(places.items()):
        with pytest.raises(gd.SceneError, match=rf"flipped\.nc: is damaged: its variable {name} "):
            gd.open_archive(flipped(path, place, number % 8))


def test_a_flipped_bit_is_named_where_the_file_is_read_when_used(archives, monkeypatch, capfd, tmp_path):
    monkeypatch.setattr(netcdf_module, "_LAZY_ABOVE", 0)
    damaged = flipped(archives["single"], first_bytes(archives["single"])["mesh_force"], 3)
    with gd.open_archive(damaged) as ds:
        assert np.isfinite(ds.gear_speed.values).all()
        with pytest.raises(gd.SceneError, match="its variable mesh_force cannot be read"):
            _ = ds.mesh_force.values
    assert main(["report", str(damaged), "-o", str(tmp_path / "r.html")]) == 2
    assert "its variable mesh_force cannot be read" in capfd.readouterr().err
    assert not (tmp_path / "r.html").exists()


def test_checksums_that_version_0_1_0_has_written_are_not_part_of_the_dataset(archives):
    with netCDF4.Dataset(archives["single"], "a") as file:
        file.checksums = '{"sam_fraction": "01234567"}'
    assert "checksums" not in gd.open_archive(archives["single"]).attrs


WRONG = {
    "title": np.arange(3),
    "status": 3,
    "rtol": "1e-6",
    "scene": json.dumps({"surface": {"roughness": -1}}),
}


@pytest.mark.parametrize("name", WRONG)
def test_an_attribute_of_another_kind_ends_in_one_line(archives, name, capfd, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with netCDF4.Dataset(archives["single"], "a") as file:
        file.setncattr(name, WRONG[name])
    assert main(["info", "single.nc"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("gearidae: archive = single.nc: ")
    assert err.count("\n") == 1
    assert len(err) < 600
    assert name in err


@pytest.mark.parametrize("name", ["backend", "wall_time"])
def test_a_missing_attribute_is_named(archives, name):
    with netCDF4.Dataset(archives["single"], "a") as file:
        file.delncattr(name)
    with pytest.raises(gd.SceneError, match=f"lacks {name}$"):
        gd.open_archive(archives["single"])


def test_attributes_of_others_are_left_alone(archives):
    with netCDF4.Dataset(archives["single"], "a") as file:
        file.setncattr("my_note", np.arange(3))
    assert np.array_equal(gd.open_archive(archives["single"]).attrs["my_note"], np.arange(3))
