"""Who is writing: a lock that dies with its process and is in nobody's way.

An open-file-description lock on one byte far beyond any data: unlike a classic record lock it survives another
descriptor of the same file being closed (every reader in this process closes one), and unlike ``flock`` it does not
collide with the locks that HDF5 takes for readers.
"""

from __future__ import annotations

import fcntl
import os
import struct
from pathlib import Path

__all__ = ["is_locked", "lock"]

_FLOCK = "hhqqi4x"  # struct flock: type, whence, start, length, pid (must be 0)
_BYTE = 2**62


def lock(descriptor: int) -> bool:
    """Mark a file as being written; False if another has done so.

    Parameters
    ----------
    descriptor : int
        Open for writing; the lock ends when it is closed, also by the end of the process.
    """
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, _request())
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks: two writers at once are then up to the user
        return True
    return True


def is_locked(path: Path) -> bool:
    """Whether a process is writing the file."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        answer = fcntl.fcntl(descriptor, fcntl.F_OFD_GETLK, _request())
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return bool(struct.unpack(_FLOCK, answer)[0] != fcntl.F_UNLCK)


def _request() -> bytes:
    return struct.pack(_FLOCK, fcntl.F_WRLCK, os.SEEK_SET, _BYTE, 1, 0)
