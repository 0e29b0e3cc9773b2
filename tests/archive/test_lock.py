"""Who is writing an archive: known to all processes, forgotten when the writer ends, and without traces."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import filelock
import pytest

from gearidae.archive import lock as module
from gearidae.archive.lock import WriterLock, is_locked


@pytest.fixture
def archive(tmp_path):
    return tmp_path / "run.nc"


def test_one_writer_at_a_time(archive):
    assert not is_locked(archive)
    held = WriterLock.take(archive)
    assert held is not None
    assert is_locked(archive)
    assert WriterLock.take(archive) is None
    held.release()
    assert not is_locked(archive)
    assert list(archive.parent.iterdir()) == []
    again = WriterLock.take(archive)
    assert again is not None
    again.release()
    again.release()  # twice does no harm


def test_the_archive_itself_bears_no_lock(archive):
    """Readers take locks of their own on it."""
    archive.touch()
    held = WriterLock.take(archive)
    assert held is not None
    descriptor = os.open(archive, os.O_RDONLY)
    assert filelock.lock_descriptor(descriptor, blocking=False)
    os.close(descriptor)
    held.release()


def hold(path, ready):
    held = WriterLock.take(path)
    ready.send(held is not None)
    signal.pause()


def test_a_killed_writer_holds_nothing(archive):
    here, there = multiprocessing.Pipe()
    writer = multiprocessing.get_context("spawn").Process(target=hold, args=(archive, there))
    writer.start()
    there.close()  # or a writer that ends before it is ready would be waited for
    assert here.recv()
    assert is_locked(archive)
    assert WriterLock.take(archive) is None
    writer.kill()
    writer.join(30.0)
    assert not is_locked(archive)
    assert [path.name for path in archive.parent.iterdir()] == [".run.nc.lock"]  # what is left locks nothing
    held = WriterLock.take(archive)
    assert held is not None
    held.release()
    assert list(archive.parent.iterdir()) == []


def test_who_asks_keeps_no_writer_away(archive, monkeypatch):
    """Whoever asks takes the lock for microseconds, or longer if the system lets it wait; a writer waits longer."""
    monkeypatch.setattr(module, "_PATIENCE", 30.0)
    (archive.parent / ".run.nc.lock").touch()
    with ThreadPoolExecutor(1) as other:
        asked = other.submit(lambda: [is_locked(archive) for _ in range(20_000)])
        done = False
        while not done:
            done = asked.done()
            held = WriterLock.take(archive)
            assert held is not None
            held.release()
        asked.result()


ASK = """
import os, sys
from pathlib import Path
from gearidae.archive.lock import WriterLock, is_locked
os.setuid(65534)
print(is_locked(Path(sys.argv[1])), WriterLock.take(Path(sys.argv[1])))
"""


@pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="needs the right to become another user")
def test_another_user_who_may_only_read_sees_who_is_writing():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        archive = Path(folder) / "run.nc"
        held = WriterLock.take(archive)
        assert held is not None
        command = [sys.executable, "-c", ASK, str(archive)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert done.stdout.split() == ["True", "None"]
        held.release()


@pytest.mark.parametrize(
    "error", [OSError(38, "Function not implemented"), OSError(37, "No locks available")]
)
def test_a_file_system_without_locks_leaves_it_to_the_users(error, archive, monkeypatch):
    def refuse(*_, **__):
        raise error

    monkeypatch.setattr(module.FileLock, "acquire", refuse)
    monkeypatch.setattr(module, "lock_descriptor", refuse)
    held = WriterLock.take(archive)
    assert held is not None
    assert not is_locked(archive)
    held.release()
