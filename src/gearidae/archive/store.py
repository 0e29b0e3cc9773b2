"""What unfinished work needs to go on: entries in a folder beside its archive, each of which is whole or not there.

A sweep keeps its finished runs there, a run its newest checkpoint. An entry is a file in numpy's format ``.npz``, whose
checksums (CRC-32) tell what a power failure has left of one that was not forced onto the disk.
"""

from __future__ import annotations

import json
import re
from array import array
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.disk import part_beside, sync

_ENTRY: Final = re.compile(r"([0-9a-z_]+)\.npz")
_UNFINISHED: Final = re.compile(r"\.[0-9a-z_]+\.npz\.[0-9]+-[0-9a-f]{8}\.part")
_HEADER: Final = "header"


class Store:
    """Entries by their keys: a header, and tables of numbers that come back to the last bit.

    Parameters
    ----------
    archive : Path
        The archive, ``OUT.nc``; the folder is ``OUT.nc.runs``.
    """

    def __init__(self, archive: Path) -> None:
        self.folder = archive.with_name(f"{archive.name}.runs")

    def entries(self) -> set[str]:
        """Keys of the entries that are there."""
        return {match[1] for name in self._names() if (match := _ENTRY.fullmatch(name))}

    def put(
        self,
        key: str,
        header: Mapping[str, Any],
        tables: Mapping[str, NDArray[Any]],
        *,
        durable: bool = False,
    ) -> None:
        """Write an entry, in the place of one of the same key.

        Parameters
        ----------
        key : str
            Of digits, lower case letters and ``_``.
        header : mapping
            Ready for JSON; arrays become lists, and numpy's integers plain ones.
        tables : mapping of str to ndarray
        durable : bool, optional
            Whether to wait until it is on the disk, so that a power failure leaves it or the one before.

        Raises
        ------
        OSError
            If the disk does not take it.
        """
        text = json.dumps({**header, "key": key}, default=_plain).encode()
        self.folder.mkdir(exist_ok=True)
        part = part_beside(self.path(key))
        try:
            with part.open("wb") as file:
                np.savez(file, **{_HEADER: np.frombuffer(text, np.uint8)}, **tables)  # type: ignore[arg-type]
            if durable:
                sync(part)
            part.replace(self.path(key))
            if durable:
                sync(self.folder)
        finally:
            part.unlink(missing_ok=True)

    def take(self, key: str) -> tuple[dict[str, Any], dict[str, NDArray[Any]]] | None:
        """Read an entry; None if there is none.

        Raises
        ------
        Exception
            Of any kind, if it is damaged; ValueError if it is another's.
        """
        try:
            with self.path(key).open("rb") as file, np.load(file, allow_pickle=False) as content:
                tables = {name: content[name] for name in content.files}
        except FileNotFoundError:
            return None
        header = json.loads(tables.pop(_HEADER).tobytes())
        if header.pop("key") != key:
            raise ValueError("it is of another scene, setting or version")
        return header, tables

    def remove(self, keys: Collection[str]) -> None:
        """Delete entries and what a kill has left of unfinished ones; the folder goes with the last file in it."""
        for name in self._names():
            match = _ENTRY.fullmatch(name)
            if (match and match[1] in keys) or _UNFINISHED.fullmatch(name):
                (self.folder / name).unlink(missing_ok=True)
        if self.folder.is_dir() and not any(self.folder.iterdir()):
            self.folder.rmdir()

    def path(self, key: str) -> Path:
        """Where an entry is."""
        return self.folder / f"{key}.npz"

    def _names(self) -> list[str]:
        return [path.name for path in self.folder.iterdir()] if self.folder.is_dir() else []


def _plain(value: Any) -> Any:
    """What JSON has not: arrays, and numpy's integers."""
    return value.tolist() if isinstance(value, array) else int(value)
