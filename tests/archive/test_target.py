"""Files to be written: refused before anything runs if they cannot be; one writer at a time; whole or not there."""

from __future__ import annotations

import json
import os
import socket
import stat
import sys
import threading
from pathlib import Path

import matplotlib.figure
import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import check_target, definition, lock, save, target, to_dataset
from gearidae.archive.journal import journal_of
from gearidae.archive.lock import WriterLock, is_locked
from gearidae.cli import main
from gearidae.errors import DiskFullError
from gearidae.report import write_report
from reference.small_studies import STUDIES

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3, "run.samples": 11})
CASE = "teodorescu2009_low_speed"
FRACTIONS = {"coating.sam_fraction": [1.0, 0.8]}


@pytest.fixture
def single(make_solution):
    return to_dataset(LOW, make_solution(LOW))


@pytest.fixture
def nothing_runs(monkeypatch):
    def run(*_, **__):
        raise AssertionError("something has been run")

    monkeypatch.setattr("gearidae.engine.solve", run)
    monkeypatch.setattr("gearidae.engine.follow", run)
    monkeypatch.setattr("gearidae.report.page.build_report", run)


POSTERIOR = xr.Dataset(
    {"sam_fraction": ("draw", [0.5, 0.6])},
    attrs={"calibration": json.dumps({"priors": {"coating.sam_fraction": "uniform(0.4, 0.6)"}})},
)


def products(single):
    """All that is saved, by its name."""
    return STUDIES | {
        "simulate": lambda path, **options: gd.simulate(LOW, archive=path, **options),
        "sweep": lambda path, **options: gd.sweep(LOW, FRACTIONS, archive=path, jobs=1, **options),
        "predict": lambda path, **options: gd.studies.predict(LOW, POSTERIOR, 2, archive=path, **options),
        "save": lambda path, **options: save(single, path, **options),
        "report": lambda path, **options: write_report(single, path, **options),
        "picture": lambda path, **options: gd.plot.write(matplotlib.figure.Figure(), path, **options),
    }


EVERY = sorted(products(None))


def fifo(path):
    os.mkfifo(path)


def bound(path):
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(path))


def device(path):
    try:
        os.mknod(path, stat.S_IFCHR | 0o600, os.makedev(1, 3))  # as the null device
    except (AttributeError, PermissionError):
        pytest.skip("needs the right to make a device")


def link_to_fifo(path):
    os.mkfifo(path.with_name("there"))
    path.symlink_to("there")


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("kind", [fifo, bound, device, link_to_fifo, Path.mkdir])
@pytest.mark.parametrize("product", EVERY)
def test_what_is_no_regular_file_is_never_replaced(kind, product, single, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # names of sockets are short
    path = Path("out.png")
    kind(path)
    before = os.lstat(path)
    for options in ({"overwrite": True}, {}):
        with pytest.raises(gd.SceneError, match=r"^\w+ = out.png: is (no regular file|a folder)"):
            products(single)[product](path, **options)
    after = os.lstat(path)
    assert (after.st_mode, after.st_ino, after.st_rdev) == (before.st_mode, before.st_ino, before.st_rdev)
    assert {entry.name for entry in tmp_path.iterdir()} <= {"out.png", "there"}


@pytest.mark.parametrize(
    "command",
    [
        ["run", CASE, "-o", "out.nc", "--overwrite"],
        ["run", CASE, "-o", "out.nc", "--resume"],
        ["sweep", CASE, "--over", "coating.sam_fraction=1,0.8", "-o", "out.nc", "--overwrite"],
        ["report", "run.nc", "-o", "out.nc", "--overwrite"],
        ["schema", "-o", "out.nc", "--overwrite"],
        ["info", "out.nc"],
    ],
)
@pytest.mark.usefixtures("nothing_runs")
def test_of_commands_one_line_says_so(command, single, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    save(single, "run.nc")
    fifo("out.nc")
    assert main(command) == 2
    assert len(capfd.readouterr().err.splitlines()) == 1
    assert stat.S_ISFIFO(os.lstat("out.nc").st_mode)


@pytest.mark.parametrize("product", ["save", "report", "picture", "simulate", "sweep"])
def test_links_to_files_stay_links(product, single, tmp_path):
    (tmp_path / "there.png").touch()
    (tmp_path / "out.png").symlink_to("there.png")
    products(single)[product](tmp_path / "out.png", overwrite=True)
    assert (tmp_path / "out.png").readlink() == Path("there.png")
    assert (tmp_path / "there.png").stat().st_size > 0


# -- one writer at a time --------------------------------------------------------------------------------------------


@pytest.fixture
def impatient(monkeypatch):
    """Writers ask for a lock that is held for good, and wait for it no longer than to ask a few times."""
    monkeypatch.setattr(lock, "_PATIENCE", 0.02)


@pytest.mark.usefixtures("nothing_runs", "impatient")
@pytest.mark.parametrize("product", EVERY)
@pytest.mark.parametrize("there", [True, False])
def test_what_another_writes_is_refused_before_anything_runs(product, there, single, tmp_path):
    path = tmp_path / "out.png"
    if there:
        path.write_bytes(b"precious")
    held = WriterLock.take(path)
    with pytest.raises(gd.SceneError, match="is being written by another run"):
        products(single)[product](path, overwrite=there)
    held.release()
    assert [entry.read_bytes() for entry in tmp_path.iterdir()] == ([b"precious"] if there else [])


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("other", ["sweep", "ensemble", "simulate", "save"])
def test_a_sweep_keeps_its_archive_and_the_journal_beside_it(other, single, tmp_path):
    """Others in another thread, as they may do it in another process."""
    path, refused = tmp_path / "out.nc", []

    def attempt():
        for options in ({"overwrite": True}, {}):
            with pytest.raises(gd.SceneError, match="is being written by another run"):
                products(single)[other](path, **options)
            refused.append(options)

    def look(done, total):
        if done == total and not refused:
            thread = threading.Thread(target=attempt)
            thread.start()
            thread.join()
            assert journal_of(path).exists()

    ds = gd.sweep(LOW, FRACTIONS, archive=path, jobs=1, progress=look)
    assert len(refused) == 2
    assert gd.open_archive(path).identical(ds)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.nc"]


def test_what_a_kill_has_left_of_an_archive_goes_with_the_next(single, tmp_path):
    """Of this archive only: another may be in the making."""
    left = [tmp_path / f".{name}.nc.123-0123abcd.part" for name in ("out", "other")]
    for path in left:
        path.write_bytes(b"half")
    save(single, tmp_path / "out.nc")
    assert {path.name for path in tmp_path.iterdir()} == {"out.nc", left[1].name}


def test_a_sweep_that_ends_early_leaves_no_claim(tmp_path):
    path = tmp_path / "out.nc"

    def interrupt(done, total):
        if done >= 1.0:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted) as caught:
        gd.sweep(LOW, FRACTIONS, archive=path, jobs=1, progress=interrupt)
    assert not is_locked(path)
    assert (
        gd.sweep(LOW, FRACTIONS, archive=path, jobs=1, resume=True).status.values.tolist() == ["finished"] * 2
    )
    assert caught.value.dataset is not None


def test_looking_and_replacing_are_one_step(single, tmp_path, monkeypatch):
    """Between our look and our file's coming nobody else can put one there."""
    path, met = tmp_path / "out.html", []
    real = target.sync

    def late(part):
        if not met:
            met.append(part)
            with pytest.raises(gd.SceneError, match="is being written by another run"):
                write_report(single, path)
        real(part)

    monkeypatch.setattr(target, "sync", late)
    write_report(single, path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.html"]


# -- names -----------------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("nothing_runs")
@pytest.mark.parametrize("name", ["n" * 238, "n" * 300, "\u00e9" * 120, "a\udcff.nc"])
@pytest.mark.parametrize("product", EVERY)
def test_names_that_cannot_be_written_are_refused_before_anything_runs(name, product, single, tmp_path):
    path = tmp_path / (name + ("" if name.endswith(".nc") else ".png"))
    with pytest.raises(gd.SceneError, match=r"too long a name|in this locale's encoding"):
        products(single)[product](path.with_suffix(".png"))
    assert list(tmp_path.iterdir()) == []


def test_the_longest_name_that_is_taken_can_be_written(tmp_path):
    longest = max(size for size in range(100, 256) if _taken(tmp_path / ("n" * size)))
    path = tmp_path / ("n" * longest)
    ds = gd.sweep(LOW, FRACTIONS, archive=path, jobs=1)
    assert gd.open_archive(path).identical(ds)
    gd.simulate(LOW, archive=path, overwrite=True)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def _taken(path):
    try:
        return check_target(path)
    except gd.SceneError:
        return None


# -- a full disk -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "command",
    [
        ["init", "new.toml"],
        ["schema", "-o", "new.json"],
        ["report", "run.nc", "-o", "new.html"],
        ["surface", "scan.txt", "--size", "2 um", "--unit", "nm", "--cutoff", "0.2 um", "-o", "new.toml"],
    ],
)
def test_of_a_full_disk_no_piece_of_a_file_is_left(command, single, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    save(single, "run.nc")
    np.savetxt("scan.txt", np.random.default_rng(1).normal(size=(64, 64)))
    before = sorted(tmp_path.iterdir())

    def full(path):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(target, "sync", full)
    assert main(command) == 3
    assert capfd.readouterr().err.endswith(
        "could not be written (No space left on device): free some space\n"
    )
    assert sorted(tmp_path.iterdir()) == before
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert main(command) == 0
    assert len(list(tmp_path.iterdir())) == len(before) + 1


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of a file's size")
@pytest.mark.parametrize("name", ["convergence", "ensemble", "hub_life"])
def test_a_study_without_room_for_its_file_says_so(name, tmp_path):
    """As the system refuses it to netCDF's library, which calls it otherwise; nothing of the file is left."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (3000, before[1]))
    try:
        with (
            pytest.warns(UserWarning, match="cannot be kept"),
            pytest.raises(DiskFullError, match="File too large"),
        ):
            STUDIES[name](tmp_path / "out.nc", jobs=1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [path.name for path in tmp_path.iterdir()] in ([], ["out.nc.journal"])


def test_a_library_that_calls_a_full_disk_otherwise(single, tmp_path, monkeypatch):
    def refuse(target, mode):
        Path(target).touch()
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(definition, "opened", refuse)
    with pytest.raises(gd.SceneError, match=r"could not be written \(Permission denied\)") as caught:
        save(single, tmp_path / "run.nc")
    assert not isinstance(caught.value, DiskFullError)  # there is room
