"""Archives: what is read is what was saved; what is not an archive is refused in one line; nothing is half written."""

from __future__ import annotations

import json
import multiprocessing
import threading
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import check_target, combine, definition, save, to_dataset
from gearidae.archive import netcdf as netcdf_module
from gearidae.archive import target as target_module
from gearidae.archive.definition import CHUNK
from gearidae.archive.integrity import CHECKSUMS

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 101})


@pytest.fixture
def single(make_solution):
    return to_dataset(LOW, make_solution(LOW))


@pytest.fixture
def sweep(make_solution):
    fractions = [1.0, 0.5]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [make_solution(scenes[0], impacts=0), make_solution(scenes[1], reached=0.4, status="chatter")]
    return combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)


@pytest.fixture
def unlike_others(single):
    """All that a dataset of gearidae may have: flags, several texts, none, no values, a coordinate of its own."""
    texts = {
        "several": ("label", ["\N{GREEK SMALL LETTER ALPHA}", "", "two words"]),
        "empty": ((), ""),
        "objects": ("label", np.array(["a", "bc", ""], dtype=object)),
        "none": ("nothing", np.empty(0, dtype=str)),
    }
    numbers = {
        "flags": ("label", [True, False, True]),
        "single": ("time", np.zeros(single.sizes["time"], np.float32), {"valid_range": np.array([0.0, 1.0])}),
        "count": ((), np.int64(7)),
    }
    beside = {
        "own": ((), 2.0),
        "named": ("label", ["x", "y", "z"]),
        "label": [1.0, 2.0, 4.0],
        "apart": ("far", [1]),
    }
    return single.assign(texts | numbers).assign_coords(beside)


def described(path):
    """Whatever a file says, but for the order in which."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        file.set_auto_chartostring(False)
        variables = {
            name: (
                variable.dtype,
                variable.dimensions,
                variable.shape,
                variable.chunking(),
                variable.filters(),
                {key: str(variable.getncattr(key)) for key in variable.ncattrs()},
                np.asarray(variable[...]).tobytes() if variable.dtype is not str else variable.shape,
            )
            for name, variable in file.variables.items()
        }
        return variables, {key: str(file.getncattr(key)) for key in file.ncattrs()}


@pytest.mark.parametrize("name", ["single", "sweep", "unlike_others"])
def test_a_file_says_what_xarray_would_write(name, request, tmp_path):
    ds = request.getfixturevalue(name).drop_encoding()
    definition.write(ds, tmp_path / "ours.nc")
    ds.to_netcdf(tmp_path / "theirs.nc", engine="netcdf4", encoding=definition._encoding(ds, compress=True))
    ours, theirs = described(tmp_path / "ours.nc"), described(tmp_path / "theirs.nc")
    assert ours[0].keys() == theirs[0].keys()
    for variable, said in ours[0].items():
        assert (variable, said) == (variable, theirs[0][variable])
    assert ours[1] == theirs[1]


def test_what_others_add_is_written_by_xarray(single, tmp_path):
    dated = single.assign_coords(written=np.datetime64("2026-01-02T03:04:05"))
    save(dated, tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc") as read:
        assert read["written"].values == dated["written"].values
    listed = single.assign(mesh_force=single["mesh_force"].assign_attrs(flags=[1, 2]))
    save(listed, tmp_path / "listed.nc")
    assert gd.open_archive(tmp_path / "listed.nc")["mesh_force"].attrs["flags"].tolist() == [1, 2]


@pytest.mark.parametrize("name", ["single", "sweep", "unlike_others"])
def test_what_is_read_is_what_was_saved(name, request, tmp_path):
    ds = request.getfixturevalue(name)
    save(ds, tmp_path / "run.nc")
    xr.testing.assert_identical(gd.open_archive(tmp_path / "run.nc"), ds)


def test_without_events(make_solution, tmp_path):
    ds = to_dataset(LOW, make_solution(LOW, impacts=0))
    save(ds, tmp_path / "run.nc")
    read = gd.open_archive(tmp_path / "run.nc")
    xr.testing.assert_identical(read, ds)
    assert read.sizes["event"] == 0


def test_plain_xarray_reads_times_as_numbers(single, tmp_path):
    """The defaults of xarray turn some units of time into dates; "s" must stay a number."""
    save(single, tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc") as ds:
        assert ds.time.dtype == np.float64
        assert ds.event_time.dtype == np.float64
        read = ds.load()
        del read.attrs[CHECKSUMS]
        xr.testing.assert_identical(read, single)


def test_file_is_netcdf4_with_units_and_without_needless_fill_values(sweep, tmp_path):
    save(sweep, tmp_path / "run.nc")
    with netCDF4.Dataset(tmp_path / "run.nc") as file:
        assert file.data_model == "NETCDF4"
        assert file["time"].units == "s"
        assert "_FillValue" not in file["time"].ncattrs()
        assert "_FillValue" not in file["sam_fraction"].ncattrs()
        assert json.loads(file.scene) == LOW.to_dict()


@pytest.fixture
def large(make_solution):
    """Fill several chunks, unevenly."""
    scene = LOW.replace({"run.samples": 2 * CHUNK // 8 + 7})
    solution = make_solution(scene)
    solution.samples["pairs_in_contact"] = np.floor(
        solution.samples["pairs_in_contact"] + solution.time * 100
    )
    return to_dataset(scene, solution)


@pytest.mark.parametrize("compress", [True, False])
def test_all_large_variables_are_compressed_unless_speed_is_wanted(compress, large, tmp_path):
    save(large, tmp_path / "run.nc", compress=compress)
    xr.testing.assert_identical(gd.open_archive(tmp_path / "run.nc"), large)
    with netCDF4.Dataset(tmp_path / "run.nc") as file:
        filters = {name: variable.filters() for name, variable in file.variables.items()}
    long = [str(name) for name, variable in large.variables.items() if variable.dims == ("time",)]
    assert len(long) > 5
    for name in long:
        assert filters[name]["zlib"] is filters[name]["shuffle"] is compress
        assert filters[name]["fletcher32"]
    size = (tmp_path / "run.nc").stat().st_size
    assert size < large.nbytes if compress else size > 0.99 * large.nbytes


def test_large_archives_are_read_when_used(single, tmp_path, monkeypatch):
    monkeypatch.setattr(netcdf_module, "LONGEST_WHOLE", 0)
    save(single, tmp_path / "run.nc")
    with gd.open_archive(tmp_path / "run.nc") as ds:
        assert not ds.gear_speed.variable._in_memory
        xr.testing.assert_identical(ds, single)


def test_a_file_that_is_replaced_while_it_is_opened_is_opened_again(single, tmp_path, monkeypatch):
    """The netCDF library opens a file twice; a run that ends in between leaves it an unknown format."""
    path, finished = tmp_path / "run.nc", tmp_path / "finished.nc"
    save(single, path)
    save(single, finished)
    opened = netcdf_module._opened

    def meets_another_file(source):
        if finished.exists():
            finished.replace(path)
            raise OSError("NetCDF: Unknown file format")
        return opened(source)

    monkeypatch.setattr(netcdf_module, "_opened", meets_another_file)
    xr.testing.assert_identical(gd.open_archive(path), single)


def test_saving_what_was_read_again(sweep, tmp_path):
    """Encodings of the first file must not leak into the second."""
    save(sweep, tmp_path / "first.nc")
    save(gd.open_archive(tmp_path / "first.nc"), tmp_path / "second.nc")
    xr.testing.assert_identical(gd.open_archive(tmp_path / "second.nc"), sweep)


def test_an_archive_is_not_overwritten_unless_asked(single, tmp_path):
    path = tmp_path / "run.nc"
    path.write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match=r"exists already.*-o.*overwrite"):
        save(single, path)
    assert path.read_bytes() == b"precious"
    save(single, path, overwrite=True)
    xr.testing.assert_identical(gd.open_archive(path), single)


def test_a_failed_write_leaves_the_old_archive_and_no_litter(single, tmp_path, monkeypatch):
    path = tmp_path / "run.nc"
    save(single, path)
    before = path.read_bytes()

    def disk_full(target, mode):
        Path(target).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(definition, "opened", disk_full)
    with pytest.raises(gd.SceneError, match="No space left on device"):
        save(single, path, overwrite=True)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.nc"]


def test_links_are_followed(single, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link.nc").symlink_to(tmp_path / "elsewhere" / "run.nc")
    save(single, tmp_path / "link.nc")
    assert (tmp_path / "link.nc").is_symlink()
    xr.testing.assert_identical(gd.open_archive(tmp_path / "elsewhere" / "run.nc"), single)


def test_missing_folder(tmp_path):
    with pytest.raises(gd.SceneError, match="there is no folder"):
        check_target(tmp_path / "nowhere" / "run.nc")
    with pytest.raises(gd.SceneError, match="is a folder"):
        check_target(tmp_path)


@pytest.mark.parametrize("path", [None, 3, 1.5])
def test_paths_that_are_none(path, single):
    with pytest.raises(gd.SceneError):
        gd.open_archive(path)
    with pytest.raises(gd.SceneError):
        save(single, path)


def _attributes(path, **changes):
    """Change attributes of a file of an older version, which has no checksums of them."""
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(CHECKSUMS)
        for name, value in changes.items():
            if value is None:
                file.delncattr(name)
            else:
                file.setncattr(name, value)


def _cut(path, share):
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])


DAMAGES = {
    "missing": (lambda path: path.unlink(), "No such file"),
    "folder": (lambda path: (path.unlink(), path.mkdir()), "Is a directory"),
    "empty": (lambda path: path.write_bytes(b""), "not a netCDF4 file"),
    "text": (lambda path: path.write_text("a,b\n1,2\n"), "not a netCDF4 file"),
    "signature alone": (lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n"), "damaged"),
    "cut in half": (lambda path: _cut(path, 0.5), "damaged"),
    "last byte lost": (lambda path: path.write_bytes(path.read_bytes()[:-1]), "damaged"),
    "foreign": (lambda path: _attributes(path, schema_version=None), "not an archive of gearidae"),
    "no scene": (lambda path: _attributes(path, scene=None), "not an archive of gearidae"),
    "newer": (lambda path: _attributes(path, schema_version=99), "schema_version 99"),
    "version of another kind": (lambda path: _attributes(path, schema_version="1"), "schema_version 1"),
    "scene not JSON": (lambda path: _attributes(path, scene="{"), "its scene is not readable"),
    "scene not tables": (lambda path: _attributes(path, scene='{"gears": 3}'), "its scene is not readable"),
    "roller scene on gear data": (lambda path: _attributes(path, scene='{"roller": {}}'), "lacks height"),
    "no status": (lambda path: _attributes(path, status=None), "lacks status"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_what_is_not_an_archive_is_refused_in_one_line(damage, single, tmp_path):
    path = tmp_path / "run.nc"
    save(single, path)
    harm, message = DAMAGES[damage]
    harm(path)
    with pytest.raises(gd.SceneError, match=message) as caught:
        gd.open_archive(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_an_unfinished_run_of_version_0_1_0_is_refused_by_name(single, tmp_path):
    save(single, tmp_path / "run.nc")
    with netCDF4.Dataset(tmp_path / "run.nc", "a") as file:
        file.createDimension("checkpoint_word", 20)
        for name, dims in (
            ("committed_samples", ()),
            ("committed_events", ()),
            ("checkpoint", ("checkpoint_word",)),
        ):
            file.createVariable(name, "f8", dims)[...] = 0.0
    for read in (gd.open_archive, lambda path: gd.simulate(LOW, archive=path, resume=True)):
        with pytest.raises(gd.SceneError, match=r"a run that gearidae 0\.1\.0 has not finished"):
            read(tmp_path / "run.nc")


@pytest.mark.parametrize("compress", [True, False])
def test_damage_within_samples_is_noticed(compress, large, tmp_path):
    """A checksum travels with every chunk, so that no wrong number is ever read silently."""
    path = tmp_path / "run.nc"
    save(large, path, compress=compress)
    content = bytearray(path.read_bytes())
    # samples fill all but the ends of the file; where compressed ones lie depends on the library that deflated them
    place = len(content) // 2 if compress else content.find(large.gear_speed.values[1000:1010].tobytes())
    assert place > 0
    content[place] ^= 1
    path.write_bytes(content)
    with pytest.raises(gd.SceneError, match="damaged"):
        gd.open_archive(path)


def _wait_while_writing(path, started):
    scene = gd.preset("teodorescu2009_low_speed")
    template = xr.open_dataset(path, engine="netcdf4").load()
    original = target_module.sync

    def stop_here(target):
        started.set()
        threading.Event().wait()
        original(target)

    target_module.sync = stop_here
    save(template.assign_attrs(title=scene.name), path, overwrite=True)


def test_a_process_killed_while_writing_leaves_the_old_archive(single, tmp_path):
    path = tmp_path / "run.nc"
    save(single, path)
    context = multiprocessing.get_context("spawn")
    started = context.Event()
    writer = context.Process(target=_wait_while_writing, args=(path, started))
    writer.start()
    assert started.wait(300)
    writer.kill()
    writer.join()
    xr.testing.assert_identical(gd.open_archive(path), single)
