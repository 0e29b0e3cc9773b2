"""Files to be written: refused before anything is computed if they cannot be, and then written whole or not at all."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from pathlib import Path
from typing import Final

from gearidae.archive.disk import DiskError, drop_parts, no_room, part_beside, sync
from gearidae.archive.journal import journal_of
from gearidae.archive.lock import claimed
from gearidae.errors import DiskFullError, SceneError

_USUAL_LONGEST: Final = 255
"""Bytes of a file's name, where the system does not say."""

MADE_BY: Final = "made by gearidae"
"""What pictures and pages say at their beginning, so that they are told from files of other programs."""
_HEAD: Final = 4096
"""Bytes at the beginning of a file in which that stands: behind the colours of a GIF."""

_CLAIMED: Final[ContextVar[frozenset[Path]]] = ContextVar("claimed", default=frozenset())
"""Archives that the studies under way in this thread will save."""

_INPUTS: Final[ContextVar[frozenset[tuple[int, int]]]] = ContextVar("inputs", default=frozenset())
"""Files, as the system numbers them, that the command under way reads."""


@contextmanager
def keeps_inputs(paths: Iterable[str]) -> Iterator[None]:
    """Refuse the files among some paths as targets until the block is left."""
    inputs = [Path(path).stat() for path in paths if Path(path).is_file()]
    token = _INPUTS.set(frozenset((status.st_dev, status.st_ino) for status in inputs))
    try:
        yield
    finally:
        _INPUTS.reset(token)


def is_input(path: Path) -> bool:
    """Whether a path is one of the files that the command under way reads."""
    return path.exists() and (path.stat().st_dev, path.stat().st_ino) in _INPUTS.get()


def is_our_own(path: Path) -> bool:
    """Whether a file is a picture or a page that this program has made, by what stands at its beginning."""
    if not path.is_file():
        return False
    try:
        with path.open("rb") as file:
            return MADE_BY.encode() in file.read(_HEAD)
    except OSError:
        return False


def as_path(path: str | os.PathLike[str], name: str = "archive") -> Path:
    """Return a path whose name the libraries for files can write.

    Parameters
    ----------
    path : path-like
    name : str, optional
        How the error calls it.

    Raises
    ------
    SceneError
        If it is no file name, or has characters that this locale's encoding lacks.
    """
    try:
        target = Path(path)
        str(target).encode(sys.getfilesystemencoding())
        if "\0" in str(target):
            raise TypeError
    except TypeError:
        raise SceneError(name, path, "must be a file name") from None
    except UnicodeEncodeError:
        shown = ascii(os.fspath(path)).strip("'\"")
        allowed = f"must be a name in this locale's encoding ({sys.getfilesystemencoding()})"
        raise SceneError(name, shown, allowed) from None
    return target


def check_target(
    path: str | os.PathLike[str], *, overwrite: bool = False, name: str = "archive", remedy: str = ""
) -> Path:
    """Make sure, before anything is computed, that a file can be written.

    Parameters
    ----------
    path : path-like
        Where the file is to go.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    name : str, optional
        How the error calls the file.
    remedy : str, optional
        What the error advises where there is a file already.

    Returns
    -------
    Path
        The file to write, links followed.

    Raises
    ------
    SceneError
        If the file exists and may not be replaced, or is an input of the command, what is there is no regular file, or
        its folder is missing or cannot be written to.
    """
    target = as_path(path, name)
    if not target.parent.is_dir():
        raise SceneError(name, path, f"there is no folder {target.parent}")
    if target.name and len(os.fsencode(part_beside(target).name)) > _longest_name(target.parent):
        raise SceneError(name, path, "is too long a name: the files beside it have longer ones")
    if target.is_dir():
        raise SceneError(name, path, "is a folder: name a file")
    if is_input(target):
        raise SceneError(name, path, "is an input of this command, which it would replace: name another")
    if target.exists() and not target.is_file():
        raise SceneError(name, path, "is no regular file and cannot be replaced: name another")
    if target.exists() and not overwrite:
        usual = "name another with -o (archive=), or allow --overwrite (overwrite=True)"
        raise SceneError(name, path, f"exists already: {remedy or usual}")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise SceneError(name, path, f"the folder {target.parent} cannot be written to")
    return Path(os.path.realpath(target))


@contextmanager
def claims_target(
    path: str | os.PathLike[str], *, overwrite: bool = False, name: str = "archive", remedy: str = ""
) -> Iterator[Path]:
    """Hold the right to write a file from before it is checked until it is written, so that nobody else does meanwhile.

    Parameters
    ----------
    path, overwrite, name, remedy
        As for `check_target`.

    Yields
    ------
    Path
        The file to write, links followed.

    Raises
    ------
    SceneError
        As `check_target` does, or if another process or thread is writing the file.
    """
    with claimed(check_target(path, overwrite=True, name=name), name):
        target = check_target(path, overwrite=overwrite, name=name, remedy=remedy)
        if not overwrite and (journal := journal_of(target)).exists():
            allowed = (
                f"was cut off, what there is of it is in {journal.name}: go on with --resume (resume=True), "
                "start anew with --overwrite (overwrite=True), or name another"
            )
            raise SceneError(name, path, allowed)
        drop_parts(target)  # which nobody writes but this thread
        yield target


@contextmanager
def claims_output(archive: str | os.PathLike[str], *, overwrite: bool = True) -> Iterator[Path]:
    """Hold the right to write an archive until the block is left; inside, `whole_file` needs no other.

    Parameters
    ----------
    archive : path-like
    overwrite : bool, optional
        As for `check_target`.

    Yields
    ------
    Path
        The file to write, links followed.

    Raises
    ------
    SceneError
        As `claims_target` does.
    """
    with claims_target(archive, overwrite=overwrite) as target:
        token = _CLAIMED.set(_CLAIMED.get() | {target})
        try:
            yield target
        finally:
            _CLAIMED.reset(token)


@contextmanager
def whole_file(
    path: str | os.PathLike[str],
    *,
    overwrite: bool = False,
    name: str = "archive",
    remedy: str = "",
    ending: str = "",
) -> Iterator[Path]:
    """Let a file be written that appears whole or not at all.

    Parameters
    ----------
    path, overwrite, name, remedy
        As for `check_target`.
    ending : str, optional
        Which the file that is written first must have.

    Yields
    ------
    Path
        What to write: a file beside the target, which takes its place when it is whole and on the disk.

    Raises
    ------
    SceneError
        As `claims_target` does, unless a study of this thread has claimed the file; if the disk does not take the data,
        a `DiskFullError` if it has no room for them.
    """
    target = check_target(path, overwrite=overwrite, name=name, remedy=remedy)
    is_claimed = target in _CLAIMED.get()
    with nullcontext() if is_claimed else claims_target(path, overwrite=overwrite, name=name, remedy=remedy):
        part = part_beside(target.with_name(target.name.removesuffix(ending)), ending)
        try:
            yield part
            sync(part)
            part.replace(target)
            sync(target.parent)
        except (DiskError, OSError) as error:
            if full := no_room(error, part):
                raise DiskFullError(name, path, f"could not be written ({full}): free some space") from error
            reason = getattr(error, "strerror", None) or error
            raise SceneError(name, path, f"could not be written ({reason})") from error
        finally:
            part.unlink(missing_ok=True)


def _longest_name(folder: Path) -> int:
    """Bytes that the name of a file in a folder may have."""
    if sys.platform == "win32" or not hasattr(os, "pathconf"):
        return _USUAL_LONGEST
    try:
        return os.pathconf(folder, "PC_NAME_MAX")
    except (OSError, ValueError):
        return _USUAL_LONGEST
