"""Rows of runs without an archive: the same in memory and in temporary files, whatever happens to these."""

import logging
import sys

import numpy as np
import pytest

from gearidae.engine import collecting
from gearidae.engine.collecting import Collector
from gearidae.records import Events

RNG = np.random.default_rng(1)
TABLES = [np.floor(RNG.uniform(0.0, 100.0, (n, len(Events.columns)))) for n in (0, 5, 1, 17, 300, 2)]


def collected(in_memory):
    collector = Collector(Events, in_memory)
    for table in TABLES:
        collector.add(table)
    return collector.rows()


def assert_whole(rows):
    expected = Events.of_table(np.concatenate(TABLES))
    for name, column in Events.columns.items():
        assert getattr(rows, name).dtype == column.dtype
        assert np.array_equal(getattr(rows, name), getattr(expected, name))


@pytest.mark.parametrize("in_memory", [0, 100, 5000, 10**6])
def test_rows_are_the_same_wherever_they_are_held(in_memory):
    rows = collected(in_memory)
    assert_whole(rows)
    assert isinstance(rows.time, np.memmap) == (in_memory < 10**6)
    rows.time[0] = -1.0  # as that of a dataset in memory
    assert rows.time[0] == -1.0


def test_rows_that_cannot_be_written_stay_in_memory(monkeypatch, caplog):
    """The disk fills up with the third column of the second writing."""
    opened, written = collecting.tempfile.TemporaryFile, []

    class Full:
        def __init__(self, buffering):
            self._file = opened(buffering=buffering)

        def __getattr__(self, name):
            return getattr(self._file, name)

        def write(self, data):
            written.append(data)
            if len(written) == len(Events.columns) + 3:
                self._file.write(data[: len(data) // 2])
                raise OSError(28, "No space left on device")
            return self._file.write(data)

    monkeypatch.setattr(collecting.tempfile, "TemporaryFile", Full)
    with caplog.at_level(logging.WARNING):
        rows = collected(100)
    assert_whole(rows)
    assert (
        "events stay in memory: a temporary file cannot be written (No space left on device)" in caplog.text
    )


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of a file's size")
def test_rows_stay_whole_where_a_file_may_not_grow(caplog):
    """As the system refuses it: what is left in a file's buffer would be an error when the rows are read."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with caplog.at_level(logging.WARNING):
            rows = collected(100)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert_whole(rows)
    assert "events stay in memory" in caplog.text


def test_no_rows():
    assert len(Collector(Events).rows()) == 0
