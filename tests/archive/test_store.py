"""Entries beside an archive: each is whole or not there, and comes back to the last bit."""

from __future__ import annotations

import os
from array import array

import numpy as np
import pytest

from gearidae.archive.checkpoint import Checkpoint, drop_checkpoints
from gearidae.archive.store import Store
from gearidae.records import Statistics

TABLES = {
    "samples": np.array([[0.0, -0.0, np.nan, np.inf, 5e-324, 1.0 + 2.0**-52]]),
    "words": np.array([0, 2**64 - 1], np.uint64),
    "none": np.empty((3, 0)),
}


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "out.nc")


def test_what_is_put_is_taken(store):
    assert store.take("a") is None
    assert store.entries() == set()
    numbers = {"text": "\u00b5", "number": 0.1, "counts": array("d", [1.0, np.inf]), "count": np.int64(3)}
    store.put("a", numbers, TABLES)
    header, tables = Store(store.folder.with_name("out.nc")).take("a")
    assert header == {"text": "\u00b5", "number": 0.1, "counts": [1.0, np.inf], "count": 3}
    for name, table in TABLES.items():
        assert tables[name].dtype == table.dtype
        assert tables[name].shape == table.shape
        assert tables[name].tobytes() == table.tobytes()


def test_the_last_of_a_key_counts_and_the_folder_goes_with_the_last_entry(store):
    for number in range(3):
        for key in ("a", "b_1"):
            store.put(key, {"number": number}, {}, durable=number == 1)
    assert store.entries() == {"a", "b_1"}
    assert store.take("a")[0] == store.take("b_1")[0] == {"number": 2}
    store.remove({"a", "c"})
    assert store.entries() == {"b_1"}
    store.remove({"b_1"})
    assert not store.folder.exists()
    store.remove({"a"})


@pytest.mark.parametrize("durable", [False, True])
def test_a_kill_while_one_is_written_leaves_the_one_before(store, durable, monkeypatch):
    store.put("a", {"number": 1}, TABLES)
    child = os.fork()
    if not child:
        os.replace = None
        np.savez = lambda file, **_: (file.write(b"half"), file.flush(), os._exit(9))
        store.put("a", {"number": 2}, TABLES, durable=durable)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9
    assert store.take("a")[0] == {"number": 1}
    assert store.entries() == {"a"}
    assert len(list(store.folder.iterdir())) == 2
    store.remove({"a"})
    assert not store.folder.exists()


def test_what_a_power_failure_has_left_is_never_read_as_data(store):
    store.put("a", {"number": 1}, {"samples": np.arange(4.0)})
    path = store.path("a")
    whole = path.read_bytes()
    for length in range(0, len(whole.rstrip(b"\0")), 7):
        for rest in (b"", bytes(len(whole) - length)):  # cut off, or with blocks that were never written
            path.write_bytes(whole[:length] + rest)
            with pytest.raises(Exception, match=r"."):
                store.take("a")
    for part in (np.arange(4.0).tobytes(), b'{"number": 1'):
        path.write_bytes(whole.replace(part, bytes(len(part))))
        with pytest.raises(Exception, match="CRC"):
            store.take("a")


def test_an_entry_under_another_name_is_not_taken(store):
    store.put("a", {}, {})
    store.path("a").rename(store.path("b"))
    with pytest.raises(ValueError, match="another scene"):
        store.take("b")


def test_checkpoints(tmp_path):
    archive = tmp_path / "out.nc"
    state = np.array([0x7FF8000000000123, 1, 2**63], np.uint64).view(np.float64)  # some are no numbers
    point = Checkpoint({"time": 3, "event": 4}, 0.1, 0.2, Statistics(steps=7, restarts=2), state)
    assert Checkpoint.newest(archive, "one") is None
    point.keep(archive, "one")
    newest = Checkpoint.newest(archive, "one")
    assert newest.state.tobytes() == state.tobytes()
    assert (newest.lengths, newest.time, newest.wall_time) == (point.lengths, 0.1, 0.2)
    assert newest.statistics == point.statistics
    assert Checkpoint.newest(archive, "other") is None  # of a run that this one has replaced
    (path,) = Store(archive).folder.iterdir()
    path.write_bytes(b"damaged")
    assert Checkpoint.newest(archive, "one") is None
    Store(archive).put("a", {}, {})
    drop_checkpoints(archive)
    assert Store(archive).entries() == {"a"}


def test_the_name_of_a_run_leads_nowhere(tmp_path):
    """It is read from a file, which may hold anything."""
    for run in ("../../other", "/tmp/other", "a" * 5000, "\udc80", ""):
        Checkpoint({}, 0.1, 0.2, Statistics(), np.empty(3)).keep(tmp_path / "out.nc", run)
        assert Checkpoint.newest(tmp_path / "out.nc", run).time == 0.1
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc.runs"]
    assert len(Store(tmp_path / "out.nc").entries()) == 5
    drop_checkpoints(tmp_path / "out.nc")
    assert list(tmp_path.iterdir()) == []
