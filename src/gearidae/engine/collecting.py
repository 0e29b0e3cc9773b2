"""Rows of a run without an archive: in memory up to a size, in temporary files beyond."""

from __future__ import annotations

import logging
import math
import tempfile
from typing import IO, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.records.row_table import Rows

logger = logging.getLogger(__name__)

IN_MEMORY: Final = 64 * 2**20
"""Bytes of the rows of one kind that are held in memory."""


class Collector:
    """Rows of one kind, which come block by block.

    Parameters
    ----------
    kind : type of Rows
    in_memory : int, optional
        Bytes from which on rows go to temporary files, one for each column, which end with the arrays.
    """

    def __init__(self, kind: type[Rows], in_memory: int = IN_MEMORY) -> None:
        self._kind, self._in_memory, self._held = kind, float(in_memory), 0
        self._parts: dict[str, list[NDArray[Any]]] = {name: [] for name in kind.columns}
        self._files: dict[str, IO[bytes]] = {}
        self._written = dict.fromkeys(kind.columns, 0)

    def add(self, table: NDArray[np.float64]) -> None:
        """Add a table as a driver writes it, shape (n, columns)."""
        if not len(table):
            return
        for index, (name, column) in enumerate(self._kind.columns.items()):
            part: NDArray[Any] = table[:, index].astype(column.dtype)
            self._parts[name].append(part)
            self._held += part.nbytes
        if self._held > self._in_memory:
            self._write()

    def _write(self) -> None:
        """Move what is in memory to the files; where they cannot be written, rows stay in memory from there on."""
        try:
            if not self._files:
                # without a buffer, whose rest a full disk would refuse once more when the file is read or closed
                self._files = {name: tempfile.TemporaryFile(buffering=0) for name in self._parts}  # noqa: SIM115
                logger.info("many %ss: they are held in a temporary file", self._kind.dim)
            for name, parts in self._parts.items():
                column = self._joined(name, parts)
                content = memoryview(column.tobytes())
                while content:  # what there is room for is written without an error
                    content = content[self._files[name].write(content) :]
                self._written[name] += len(column)
                parts.clear()
            self._held = 0
        except OSError as error:
            logger.warning(
                "%ss stay in memory: a temporary file cannot be written (%s)", self._kind.dim, error.strerror
            )
            self._in_memory = math.inf

    def rows(self) -> Rows:
        """Return the rows; those in files are read as they are used, and may be written to in memory."""
        if not self._held and not self._files:
            return self._kind.none()
        if self._files and self._in_memory < math.inf:
            self._write()
        columns = {name: self._column(name) for name in self._kind.columns}
        for file in self._files.values():
            file.close()  # what is mapped stays
        return self._kind(**columns)

    def _column(self, name: str) -> NDArray[Any]:
        parts, count = self._parts[name], self._written[name]
        if not count:
            return self._joined(name, parts)
        kept = np.memmap(self._files[name], self._kind.columns[name].dtype, "c", shape=(count,))
        return np.concatenate([kept, *parts]) if parts else kept

    def _joined(self, name: str, parts: list[NDArray[Any]]) -> NDArray[Any]:
        return np.concatenate([np.empty(0, self._kind.columns[name].dtype), *parts])
