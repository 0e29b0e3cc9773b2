"""Rows of a run, which come one by one in the order of time: events, passages, impacts, and what else is declared so.

A kind of rows declares its columns once. Blocks of a driver, solutions, kept runs, datasets and archives that grow
follow from the declarations.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray


class RowColumn(NamedTuple):
    """A column of rows.

    Attributes
    ----------
    dtype : type
        In memory and in an archive; double precision, which a driver uses, holds it exactly.
    missing : float, optional
        What stands where nothing is known; None of a column that every row has.
    """

    dtype: type = np.float64
    missing: float | None = None


class Rows:
    """Rows of one kind: an array for each column, shape (n,), by its name as an attribute.

    Parameters
    ----------
    *arrays, **named : ndarray, shape (n,)
        Columns, in the order of `columns` or by name; those that have a `RowColumn.missing` may be left out.

    Attributes
    ----------
    dim : str
        Dimension in an archive, where it begins the names of the variables.
    field : str
        Name in a block of output and in a solution.
    columns : mapping of str to RowColumn
        In the order in which a driver writes them; the first is the time [s].
    """

    dim: ClassVar[str]
    field: ClassVar[str]
    columns: ClassVar[Mapping[str, RowColumn]]

    def __init__(self, *arrays: NDArray[Any], **named: NDArray[Any]) -> None:
        named |= dict(zip(self.columns, arrays, strict=False))
        for name, column in self.columns.items():
            if name not in named and column.missing is None:
                raise TypeError(f"{type(self).__name__} need {name}")
            values = named.get(name)
            if values is None:
                values = np.full(len(self), column.missing, column.dtype)
            setattr(self, name, values)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> NDArray[Any]: ...

    def __len__(self) -> int:
        return len(self.time)

    @classmethod
    def of_table(cls, table: NDArray[np.float64]) -> Self:
        """Make rows of a table, shape (n, columns), as a driver writes it."""
        return cls(
            *(table[:, index].astype(column.dtype) for index, column in enumerate(cls.columns.values()))
        )

    @classmethod
    @cache
    def none(cls) -> Self:
        """No rows; the same for all that have none."""
        return cls.of_table(cls.no_table())

    @classmethod
    def no_table(cls) -> NDArray[np.float64]:
        """Table of no rows, shape (0, columns)."""
        return np.empty((0, len(cls.columns)))

    def table(self) -> NDArray[np.float64]:
        """Table that `of_table` reads."""
        return np.stack([getattr(self, name).astype(np.float64) for name in self.columns], axis=1)


FLAG: Final = np.int8
"""Type of flags."""


def indices_of(*columns: str) -> Any:
    """Index of each column in a row, by its name."""
    make: Any = namedtuple  # mypy takes names that are written out only
    return make("Places", columns)(*range(len(columns)))
