"""Journals: frames are whole or not there, come back to the last bit, and no byte of a damaged file is read as data."""

from __future__ import annotations

import errno
import os
import signal
import threading
import zlib
from array import array

import numpy as np
import pytest

from gearidae.archive import journal as module
from gearidae.archive.journal import SIGNATURE, Journal, journal_of

TABLES = {
    "samples": np.array([[0.0, -0.0, np.nan, np.inf, 5e-324, 1.0 + 2.0**-52]]),
    "words": np.array([0, 2**64 - 1], np.uint64),
    "none": np.empty((3, 0)),
}


@pytest.fixture
def path(tmp_path):
    return journal_of(tmp_path / "out.nc")


@pytest.fixture
def written(path):
    """A journal of five frames, and the places behind its head and each of them."""
    with Journal.create(path, "run") as journal:
        frames = [journal.append({"number": k}, {"values": np.arange(4.0) + k}) for k in range(5)]
    return [journal.head.end, *(frame.end for frame in frames)]


def numbers(path):
    """What can be read of a journal: the number of each frame, None for one that is altered."""
    with Journal(path, "run") as journal:
        found = []
        for frame in journal.frames():
            if frame is not None:
                np.testing.assert_array_equal(
                    journal.values(frame, "values"), np.arange(4.0) + frame.header["number"]
                )
            found.append(frame and frame.header["number"])
        return found


def test_what_is_appended_is_read(path):
    assert path.name == "out.nc.journal"
    header = {"text": "\u00b5", "number": 0.1, "counts": array("d", [1.0, np.inf]), "count": np.int64(3)}
    with Journal.create(path, "run", about=0.1) as journal:
        journal.append(header, TABLES)
        journal.append({}, {})
    with pytest.raises(ValueError, match="of a single run"):
        Journal(path, "runs")
    with Journal(path, "run") as journal:
        assert journal.head.header == {"kind": "run", "about": 0.1}
        first, second = journal.frames()
        assert first.header == {"text": "\u00b5", "number": 0.1, "counts": [1.0, np.inf], "count": 3}
        for name, table in TABLES.items():
            back = journal.table(first, name)
            assert (back.dtype, back.shape, back.tobytes()) == (table.dtype, table.shape, table.tobytes())
        assert journal.values(first, "samples", 2, 4).tobytes() == TABLES["samples"][0, 2:4].tobytes()
        assert journal.frame(second.begin) == second
        assert (second.header, second.shapes, journal.end) == ({}, {}, path.stat().st_size)


def test_a_cut_at_any_byte_leaves_the_whole_frames(path, written):
    content = path.read_bytes()
    for length in range(written[0]):
        path.write_bytes(content[:length])
        with pytest.raises(ValueError, match=r"no journal|altered"):
            Journal(path, "run")
    for length in range(written[0], len(content)):
        path.write_bytes(content[:length])
        whole = sum(end <= length for end in written) - 1
        assert numbers(path) == list(range(whole))
    path.write_bytes(
        content[: written[3] + 40] + bytes(500)
    )  # a power failure: blocks that were never written
    assert numbers(path) in ([0, 1, 2], [0, 1, 2, None])


def test_a_flipped_bit_anywhere_spoils_one_frame_or_ends_the_journal(path, written):
    content = bytearray(path.read_bytes())
    for place in range(len(content)):
        content[place] ^= 1 << place % 8
        path.write_bytes(content)
        if place < written[0]:
            with pytest.raises(ValueError, match=r"no journal|altered"):
                Journal(path, "run")
        else:
            spoilt = sum(end <= place for end in written) - 1
            without = [None if number == spoilt else number for number in range(5)]
            assert numbers(path) in (without, list(range(spoilt)))
        content[place] ^= 1 << place % 8


def test_a_journal_goes_on_behind_its_last_whole_frame(path, written):
    path.write_bytes(path.read_bytes()[: written[4] + 7])
    with Journal(path, "run", "a") as journal:
        *_, last = journal.frames()
        journal.append({"number": 9}, {"values": np.arange(4.0) + 9})
        assert last.end == written[4]
    assert numbers(path) == [0, 1, 2, 3, 9]
    with Journal(path, "run", "a") as journal:
        journal.cut(written[2])
        journal.append({"number": 7}, {"values": np.arange(4.0) + 7})
    assert numbers(path) == [0, 1, 7]


def test_a_kill_in_the_middle_of_a_frame_leaves_those_before(path, written, monkeypatch):
    whole = path.stat().st_size

    class Half:
        def __init__(self, file):
            self.file, self.writes = file, 0

        def __getattr__(self, name):
            return getattr(self.file, name)

        def write(self, content):
            self.writes += 1
            if self.writes == 3:
                self.file.write(content[: len(content) // 2])
                os.kill(os.getpid(), signal.SIGKILL)
            return self.file.write(content)

    child = os.fork()
    if not child:
        journal = Journal(path, "run", "a")
        list(journal.frames())
        journal._file = Half(journal._file)
        journal.append({"number": 5}, {"values": np.arange(4.0) + 5})
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    assert path.stat().st_size > whole
    assert numbers(path) == [0, 1, 2, 3, 4]


def test_what_the_disk_does_not_take_is_not_there(path, written):
    """Wherever it fills up: the journal is as before, and goes on when there is room again."""
    with Journal(path, "run", "a") as journal:
        list(journal.frames())
        file, room = journal._file, 0

        class Full:
            def __getattr__(self, name):
                return getattr(file, name)

            def write(self, content):
                nonlocal left
                if not left:
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                count = file.write(content[:left])
                left -= count
                return count

        journal._file = Full()
        for room in range(0, written[1] - written[0], 11):
            left = room
            with pytest.raises(OSError, match="No space"):
                journal.append({"number": 5}, {"values": np.arange(4.0) + 5})
            assert path.stat().st_size == written[-1]
        journal._file = file
        journal.append({"number": 5}, {"values": np.arange(4.0) + 5})
    assert numbers(path) == [0, 1, 2, 3, 4, 5]


def test_readers_and_the_writer_are_in_no_one_s_way(path):
    """Threads that read while frames come see whole ones only, and never fewer."""
    counts, stop = [], threading.Event()

    def read():
        while not stop.is_set():
            counts.append(len(numbers(path)))

    with Journal.create(path, "run") as journal:
        reader = threading.Thread(target=read)
        reader.start()
        for number in range(300):
            journal.append({"number": number}, {"values": np.arange(4.0) + number})
        stop.set()
        reader.join()
    assert counts == sorted(counts)
    assert numbers(path) == list(range(300))


def made(path, header, contents=b""):
    """A journal made by hand, with sound checksums."""
    checksum = zlib.crc32(header + contents)
    lead = module._PREAMBLE.pack(module._MARK, len(header), len(contents), checksum, 0)[:-4]
    path.write_bytes(SIGNATURE + lead + zlib.crc32(lead).to_bytes(4, "little") + header + contents)


@pytest.mark.parametrize(
    "layout",
    [
        '[["a", "<f8", [2]]]',
        '[["a", "<f8", [-1]]]',
        '[["a", "<f8", [true]]]',
        '[["a", "<f8", [4, 1000000000000]]]',
        '[["a", "|O", [1]]]',
        '[["a", "<f4", [2]]]',
        "[3]",
        "3",
        "[" * 5000,
    ],
)
def test_no_file_decides_where_and_how_much_is_read(path, layout):
    """Arrays lie within their frame, whatever a header that somebody has made says."""
    made(path, f'{{"kind": "run", "arrays": {layout}}}'.encode(), bytes(8))
    with pytest.raises(ValueError, match="its"):
        Journal(path, "run")


def test_a_journal_that_is_cut_while_it_is_read_says_so(path, written):
    with Journal(path, "run") as journal:
        *_, last = journal.frames()
        os.truncate(path, written[-1] - 8)
        with pytest.raises(OSError, match="open it again"):
            journal.values(last, "values")
