"""What is damaged is refused, and nothing of it is read as data; what has been edited is named."""

import json
import shutil
import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import combine, integrity, save, to_dataset
from gearidae.archive import netcdf as netcdf_module
from gearidae.archive.variables import CONTACT
from gearidae.cli import main

SEAL = integrity._SEAL
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
    """A damaged copy without the seal, as a file has none into which another program has written."""
    content = bytearray(path.read_bytes())[:-SEAL]
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
    monkeypatch.setattr(netcdf_module, "LONGEST_WHOLE", 0)
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
        file.delncattr(integrity.CHECKSUMS)
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


# -- all bytes -------------------------------------------------------------------------------------------------------

KNOTS = [[5e-5 * number, 1e-18 / (3 + number % 7)] for number in range(100)]
LONG = LOW.replace({"run.duration": "2 ms", "run.samples": 21, "drive.schedule": KNOTS})


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A run with texts of more than 4 kB, which HDF5 stores without a checksum, as written, and what it holds."""
    path = tmp_path_factory.mktemp("written") / "run.nc"
    ds = gd.simulate(LONG, archive=path)
    assert min(len(ds.attrs[name]) for name in ("scene", "validity")) > 4096
    return path, ds


def test_a_digit_of_a_long_text_is_no_other_without_a_word(written, tmp_path):
    """As gearidae has written the file, and as one in which another program has written since."""
    path, ds = written
    content, damaged = path.read_bytes(), tmp_path / "run.nc"
    for name in ("scene", "validity"):
        begin = content.find(ds.attrs[name].encode())
        digits = [begin + place for place, sign in enumerate(ds.attrs[name]) if sign in "2345"]
        assert begin > 0
        for place in digits[:: len(digits) // 6]:
            changed = bytearray(content)
            changed[place] += 4
            damaged.write_bytes(changed)
            with pytest.raises(gd.SceneError, match="is damaged: its bytes have been altered"):
                gd.open(damaged)
            damaged.write_bytes(changed[:-SEAL])
            with pytest.raises(gd.SceneError, match=rf"is damaged \(its attribute {name} has been changed"):
                gd.open(damaged)


def test_any_other_byte_is_refused(written, tmp_path):
    path, _ = written
    content, damaged = path.read_bytes(), tmp_path / "run.nc"
    for place in np.random.default_rng(1).integers(0, len(content) - SEAL, 40):
        changed = bytearray(content)
        changed[place] ^= 1 << place % 8
        damaged.write_bytes(changed)
        with pytest.raises(gd.SceneError, match="is damaged"):
            gd.open(damaged)


def test_an_end_that_is_missing_is_noticed_or_was_no_part_of_the_data(written, tmp_path):
    path, ds = written
    content, damaged = path.read_bytes(), tmp_path / "run.nc"
    for missing in range(1, SEAL + 2):
        damaged.write_bytes(content[:-missing])
        if SEAL - len(integrity._MARK) < missing <= SEAL:  # the mark is cut: a file without a seal
            assert gd.open(damaged).identical(ds)
        else:
            with pytest.raises(gd.SceneError, match="damaged"):
                gd.open(damaged)


OPEN = """
import sys
import gearidae as gd

try:
    gd.open(sys.argv[1])
except gd.SceneError as error:
    print(error)
"""


def test_zeros_that_hang_the_library_end_in_a_line(written, tmp_path):
    """HDF5 goes through a global heap by the sizes in it: one of 0 is a loop without end, which only a kill ends."""
    content, damaged = bytearray(written[0].read_bytes()), tmp_path / "run.nc"
    heap = content.find(b"GCOL")
    assert heap > 0
    content[heap + 24 : heap + 35] = bytes(
        11
    )  # the size of the first object, behind the heap's head of 16 bytes
    damaged.write_bytes(content)
    done = subprocess.run(
        [sys.executable, "-c", OPEN, str(damaged)], capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "is damaged" in done.stdout


def test_another_program_that_writes_into_a_file_cuts_the_seal_off(written, tmp_path):
    path = shutil.copyfile(written[0], tmp_path / "run.nc")
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("my_note", "measured on Monday")
    assert path.read_bytes()[-SEAL:] != written[0].read_bytes()[-SEAL:]
    assert gd.open(path).attrs["my_note"] == "measured on Monday"


# -- edited files ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def products(tmp_path_factory):
    """Files of a run, of one that goes on from it, of a sweep and of a study."""
    folder = tmp_path_factory.mktemp("products")
    scene = LOW.replace({"run.duration": "2 ms", "run.samples": 21})
    run = gd.simulate(scene, archive=folder / "run.nc")
    gd.simulate(scene, start=run, archive=folder / "continued.nc")
    gd.sweep(scene, {"coating.sam_fraction": FRACTIONS}, archive=folder / "sweep.nc")
    gd.studies.convergence(scene.replace({"run.samples": "off"}), archive=folder / "study.nc")
    return folder


def with_torque(ds):
    scene = json.loads(ds.attrs["scene"])
    scene["drive"]["torque"] *= 2.0
    return ds.assign_attrs(scene=json.dumps(scene))


def in_rpm(ds):
    return ds.assign(gear_speed=(ds.gear_speed * 30.0 / np.pi).assign_attrs(units="rpm"))


OTHER = gd.simulate(LOW.replace({"run.duration": "1 ms"})).attrs["end_state"]
EDITS = {
    "scene": ("run", with_torque),
    "gear_speed": ("run", in_rpm),
    "time": ("run", lambda ds: ds.isel(time=slice(None, None, -1))),
    "coordinate time": ("run", lambda ds: ds.assign_coords(time=ds.time * np.nan)),
    "event_time": ("run", lambda ds: ds.assign(event_time=ds.event_time * np.nan)),
    "rtol": ("run", lambda ds: ds.assign_attrs(rtol=-5.0)),
    "end_state": ("run", lambda ds: ds.assign_attrs(end_state=OTHER)),
    "parent": ("continued", lambda ds: ds.assign_attrs(parent='{"scene": "{}"}')),
    "attribute parent": ("continued", lambda ds: ds.assign_attrs(parent="[]")),
    "sam_fraction": ("sweep", lambda ds: ds.assign_coords(sam_fraction=[1.0, 0.7])),
    "swept": ("sweep", lambda ds: ds.assign_attrs(swept="[[[[")),
    "attribute swept": ("sweep", lambda ds: ds.assign_attrs(swept='{"coating.sam_fraction": 1.0}')),
    "scene is missing": ("study", lambda ds: ds.drop_attrs()),
    "settings": ("study", lambda ds: ds.assign_attrs(settings="{")),
    "rtol_to_take": ("study", lambda ds: ds.drop_vars("rtol_to_take")),
}
WAYS = {
    "xarray": (lambda path: xr.load_dataset(path, decode_times=False), lambda ds, path: ds.to_netcdf(path)),
    "opened": (gd.open, lambda ds, path: ds.to_netcdf(path)),
    "saved": (gd.open, save),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", EDITS)
def test_what_has_been_edited_is_named(name, way, products, tmp_path):
    """Read by xarray or by us, edited, written by xarray or by us."""
    (file, edit), (read, write) = EDITS[name], WAYS[way]
    write(edit(read(products / f"{file}.nc")), tmp_path / "edited.nc")
    with pytest.raises(gd.SceneError, match=rf"edited\.nc: is (a )?damaged.*\b{name}\b"):
        gd.open(tmp_path / "edited.nc")


KEPT = {
    "note": ("run", lambda ds: ds.assign_attrs(my_note=np.arange(3.0))),
    "history": ("run", lambda ds: ds.assign_attrs(history="2026: ncrcat\n" + ds.attrs["history"])),
    "fewer variables": ("run", lambda ds: ds.drop_dims("event")),
    "run of a sweep": ("sweep", lambda ds: ds.sel(sam_fraction=0.5)),
    "part of a sweep": ("sweep", lambda ds: ds.isel(sam_fraction=[1])),
    "study": ("study", lambda ds: ds),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", KEPT)
def test_what_is_added_left_out_or_picked_is_no_damage(name, way, products, tmp_path):
    (file, edit), (read, write) = KEPT[name], WAYS[way]
    edited = edit(read(products / f"{file}.nc"))
    write(edited, tmp_path / "edited.nc")
    assert set(gd.open(tmp_path / "edited.nc").data_vars) == set(edited.data_vars)


@pytest.mark.parametrize("name", ["run", "sweep", "study"])
def test_a_damaged_file_is_called_damaged_whatever_it_is(name, products, tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content = bytearray((products / f"{name}.nc").read_bytes())
    content[len(content) // 2] ^= 4
    (tmp_path / "run.nc").write_bytes(content)
    assert main(["info", "run.nc"]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("gearidae: archive = run.nc: is damaged")
