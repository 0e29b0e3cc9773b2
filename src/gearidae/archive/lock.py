"""Who is writing an archive: a lock that ends with its process and disturbs no reader.

The lock is taken on a file of its own beside the archive, ``.NAME.lock``: HDF5 takes locks on the archive itself for
its readers, and on some systems a lock keeps others from reading. What a lock is there, `filelock` knows: ``flock`` on
Linux and macOS, ``LockFileEx`` on Windows. The system lifts it when the process ends in whatever way; the empty file
that a killed process leaves behind locks nothing.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final, Self

from filelock import FileLock, Timeout, lock_descriptor

from gearidae.errors import SceneError

_PATIENCE: Final = 0.5
"""Time [s] for which a writer tries: a process that only looks holds the lock for some microseconds, and for as
long as the system keeps it waiting meanwhile."""
_ATTEMPTS: Final = 5
"""Times that the question is asked, since two who ask at once see each other."""


class WriterLock:
    """The right to write an archive, held until `release` or the end of the process.

    Use `take`.
    """

    def __init__(self, held: FileLock | None) -> None:
        self._held = held

    @classmethod
    def take(cls, archive: Path) -> Self | None:
        """Mark an archive as being written; None if another has done so.

        Parameters
        ----------
        archive : Path
            It need not exist yet; its folder must.
        """
        lock_path = _beside(archive)
        # any thread may release it; on a file system without locks nothing is gained by a file that outlives a crash
        wanted = FileLock(lock_path, thread_local=False, fallback_to_soft=False)
        try:
            wanted.acquire(timeout=_PATIENCE, poll_interval=0.005)
        except Timeout:
            return None
        except (
            OSError
        ):  # no locks here, or the file is another user's: two writers at once are then up to the users
            return None if is_locked(archive) else cls(None)
        return cls(wanted)

    def release(self) -> None:
        """Let others write; the file beside the archive goes."""
        if self._held is None:
            return
        held, self._held = self._held, None
        with suppress(OSError):  # Windows removes no file that is open, and leaves that to the library
            Path(held.lock_file).unlink(
                missing_ok=True
            )  # still locked: who waits for it notices, and starts over
        held.release()


@contextmanager
def claimed(archive: Path, name: str = "archive") -> Iterator[None]:
    """Mark an archive as being written until the block is left.

    Parameters
    ----------
    archive : Path
        It need not exist yet; its folder must.
    name : str, optional
        How the error calls it.

    Raises
    ------
    SceneError
        If another has done so.
    """
    held = WriterLock.take(archive)
    if held is None:
        raise SceneError(name, archive, "is being written by another run")
    try:
        yield
    finally:
        held.release()


def is_locked(archive: Path) -> bool:
    """Whether a process is writing an archive; what cannot be asked counts as no."""
    try:
        descriptor = os.open(_beside(archive), os.O_RDONLY)
    except OSError:
        return False
    try:
        for attempt in range(_ATTEMPTS):
            if lock_descriptor(descriptor, blocking=False):
                return False
            time.sleep(0.001 * (attempt + os.getpid() % 5))  # not in step with another who asks
    except OSError:
        return False
    finally:
        os.close(descriptor)  # which lifts the lock
    return True


def _beside(archive: Path) -> Path:
    return archive.with_name(f".{archive.name}.lock")
