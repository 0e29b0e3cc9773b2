"""Tables in text files, of whatever program wrote them: one reader for schedules, records, scans and observations.

Encoding, separator, decimal sign and the line of headings are recognised where they are not given. Each row must have
as many cells as there are headings, or as the first row has: a comma that is taken for a separator where it is a
decimal sign would shift all numbers. A separator at the end of a line makes no cell. ``#`` at the start of a
line or after a blank begins a remark.
"""

from __future__ import annotations

import csv
import math
import re
import stat
import warnings
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_SMALL: Final = 2**22
"""Bytes of a file below which it is read row by row: importing pandas takes longer."""
_MISSING: Final = ("", "nan", "na", "n/a", "null", "-", "--", "---")
_NO_NUMBER: Final = re.compile(r"[+-]?1\.#(qnan|snan|ind|inf)0*", re.IGNORECASE)
"""What programs built with Microsoft's older libraries write for no number."""
_REMARK: Final = re.compile(r"(?:^|(?<=\s))#(?![,;\t])")
_NAMES: Final = {";": "semicolons", "\t": "tabs", ",": "commas", "": "blanks"}
_UNIT: Final = re.compile(r"(.*?)\s*[\[(]\s*([^\[\]()]*(?:\([^()]*\)[^\[\]()]*)*)\s*[\])]\s*")


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table in a file, of which everything above the first row has been read.

    Attributes
    ----------
    size : int
        Bytes of the file.
    headings : tuple of str
        Names of the columns; empty if there are none.
    remarks : tuple of str
        Remarks above the first row.
    delimiter : str
        Between the cells; empty for blanks.
    skipped : int
        Lines above the headings that are no remarks.
    above : int
        Number of lines above the first row.
    remarked : bool
        Whether a row may have one cell more, a remark of the measuring program.
    clock : tuple of float, or None
        First time and distance of the samples [s], where a measuring program has written them above the first row.
    """

    path: Path
    size: int
    headings: tuple[str, ...]
    remarks: tuple[str, ...]
    delimiter: str
    decimal: str
    skipped: int
    above: int
    encoding: str
    remarked: bool = False
    clock: tuple[float, float] | None = None

    @property
    def recognised(self) -> tuple[str, ...]:
        """What a reader would not expect of a CSV file, in words: separator, decimal sign, skipped lines."""
        said = [_NAMES.get(self.delimiter, repr(self.delimiter))] if self.delimiter != "," else []
        said += ["decimal commas"] if self.decimal == "," else []
        if self.skipped:
            said.append("1 line skipped" if self.skipped == 1 else f"{self.skipped} lines skipped")
        return tuple(said)

    def rows(self) -> Iterator[tuple[int, int, list[str]]]:
        """Read the cells of each row as texts.

        Yields
        ------
        line, row : int
            From 1; of several lines that a quoted cell takes, the last.
        cells : list of str
            As many as there are headings, or as the first row has.

        Raises
        ------
        ValueError
            If a row has another number of cells, or the file is no text.
        """
        width = len(self.headings)
        line = [self.above]
        with self.path.open(encoding=self.encoding) as file:
            texts = _contents(file, self.above, line)
            try:
                for row, cells in enumerate(cells_of(texts, self.delimiter), 1):
                    width = width or len(cells)
                    if len(cells) == width + 1 and (self.remarked or not cells[-1]):
                        cells.pop()
                    if len(cells) != width:
                        raise ValueError(
                            f"line {line[0]}: row {row} has {len(cells)} cell{'s' * (len(cells) != 1)}, but "
                            f"{self._expected(width)}"
                        )
                    yield line[0], row, cells
            except csv.Error as error:
                raise ValueError(f"line {line[0]} is no row of a table ({error})") from None
            except UnicodeDecodeError:
                raise ValueError(f"is no text below line {line[0]}") from None

    def numbers(
        self,
        columns: Sequence[int] | None = None,
        *,
        holes: bool = False,
        undefined: bool = False,
        most: int | None = None,
    ) -> NDArray[np.float64]:
        """Read columns of numbers.

        Parameters
        ----------
        columns : sequence of int, optional
            Which of the columns; all of them by default.
        holes : bool, optional
            Whether cells may be empty, or hold a word for nothing such as ``nan``.
        undefined : bool, optional
            Whether they may also hold what a failed computation leaves (``1.#QNAN``).
        most : int, optional
            Rows that there may be.

        Returns
        -------
        ndarray, shape (rows, columns)
            NaN in holes. A last column of which all cells are empty is none.

        Raises
        ------
        ValueError
            If a cell is no finite number; the message names row and line.
        """
        table = self._all_at_once(columns) if self.size > _SMALL else None
        if table is None:
            table = self._row_by_row(columns, holes=holes, undefined=undefined, most=most)
        if most is not None and len(table) > most:
            raise ValueError(_too_many(most))
        return table

    def _expected(self, width: int) -> str:
        remedy = "if a comma is the decimal sign, cells must be separated by another"
        return (
            f"there are {width} headings: {remedy}" if self.headings else f"the first has {width}: {remedy}"
        )

    def _all_at_once(self, columns: Sequence[int] | None) -> NDArray[np.float64] | None:
        """Read a table without holes and faults; None if it is another."""
        import pandas as pd  # a third of a second, and few commands need it

        try:
            with self.path.open("rb") as file, warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of columns that hold both texts and numbers
                options: dict[str, Any] = {
                    "sep": self.delimiter or r"\s+", "header": None, "skiprows": self.above,
                    "decimal": self.decimal, "na_filter": False, "quoting": csv.QUOTE_NONE, "engine": "c",
                    "encoding": self.encoding.removesuffix("-sig"),
                }  # fmt: skip
                table = pd.read_csv(file, **options)
        except (ValueError, OSError):  # pandas' own errors are of the first kind
            return None
        last = table.shape[1] - 1
        if last > 0 and table[last].dtype.kind not in "fiu" and (table[last] == "").all():
            table = table.drop(columns=last)
        if self.headings and table.shape[1] != len(self.headings):
            return None
        wanted = table if columns is None else table[list(columns)]
        if not all(dtype.kind in "fiu" for dtype in wanted.dtypes):
            return None
        numbers = wanted.to_numpy(np.float64)
        return numbers if np.isfinite(numbers).all() else None

    def _row_by_row(
        self, columns: Sequence[int] | None, *, holes: bool, undefined: bool, most: int | None
    ) -> NDArray[np.float64]:
        """Read a table with holes, or find its first fault."""
        numbers = array("d")
        count, width, last_is_empty = 0, len(self.headings if columns is None else columns), True
        for line, count, cells in self.rows():
            if most is not None and count > most:
                raise ValueError(_too_many(most))
            wanted = range(len(cells)) if columns is None else columns
            width = len(wanted)
            last_is_empty = last_is_empty and not cells[-1]
            for column in wanted:
                number = as_number(cells[column], self.decimal)
                may_lack = holes and (undefined or "#" not in cells[column])
                if number is None or not (math.isfinite(number) or (may_lack and math.isnan(number))):
                    fault = f"row {count} {self._fault(cells[column], number)}"
                    raise ValueError(f"line {line}: column {self._named(column)}, {fault}")
                numbers.append(number)
        table = np.frombuffer(numbers, np.float64).reshape(count, width) if count else np.empty((0, width))
        return table[:, :-1] if columns is None and width > 1 and last_is_empty else table

    def _named(self, column: int) -> str:
        return repr(self.headings[column][:60]) if self.headings else str(column + 1)

    def _fault(self, cell: str, number: float | None) -> str:
        """Say what is wrong with a cell."""
        if not cell:
            return "is empty"
        if number is not None:
            return f"is {cell[:40]}, not a finite number"
        sign = f"; {self.decimal!r} is taken for the decimal sign" if set(",.") & set(cell) else ""
        return f"is {cell[:40]!r}, no number{sign}"


def check_regular(path: Path, largest: int) -> int:
    """Refuse what cannot be read whole: folders, pipes, devices, and files that are too long.

    Parameters
    ----------
    largest : int
        Bytes that it may have.

    Returns
    -------
    int
        Its bytes.

    Raises
    ------
    ValueError
        Saying why not.
    """
    try:
        status = path.stat()
    except FileNotFoundError:
        raise ValueError(f"cannot be read: there is no file {path.name}") from None
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None
    if stat.S_ISDIR(status.st_mode):
        raise ValueError("is a folder, not a file")
    if not stat.S_ISREG(status.st_mode):
        raise ValueError("is a pipe or a device, which may have no end: write it to a file first")
    if status.st_size > largest:
        raise ValueError(f"is larger than {largest / 1e6:.4g} MB: shorten it")
    return status.st_size


def split_unit(heading: str) -> tuple[str, str]:
    """Split a heading into the name and the unit in brackets, which is empty where there is none."""
    match = _UNIT.fullmatch(heading.strip())
    return (match[1], match[2]) if match else (heading.strip(), "")


def column_of(headings: Sequence[str], name: str) -> int | None:
    """Find a column by its heading; a name with a unit also finds a heading without one.

    Returns
    -------
    int or None
        None if there is none, or more than one.
    """
    name, bare = name.strip(), split_unit(name)[0]
    for wanted in (name, bare):
        if list(headings).count(wanted) == 1:
            return list(headings).index(wanted)
    return None


def listed(names: Sequence[str]) -> str:
    """Show the first names of columns."""
    return ", ".join(repr(name[:40]) for name in names[:8]) + (", ..." if len(names) > 8 else "")


def as_number(cell: str, decimal: str) -> float | None:
    """Read a cell: NaN where it is empty or a word for nothing, None where it is no number."""
    if decimal == "," and "." not in cell:
        cell = cell.replace(",", ".")
    elif decimal == ",":
        return None  # 1.234 would be a thousand, not one
    try:
        return float(cell) if "_" not in cell else None
    except ValueError:
        return np.nan if cell.lower() in _MISSING or _NO_NUMBER.fullmatch(cell) else None


def without_remark(text: str) -> str:
    """Return a line without its remark: what ``#`` begins, at the start of a line or after a blank.

    It begins none within quotes, nor where a separator follows, as in the heading ``Sample #,time [s]``.
    """
    for match in _REMARK.finditer(text):
        if text.count('"', 0, match.start()) % 2 == 0:
            return text[: match.start()]
    return text


def _too_many(most: int) -> str:
    return f"has more than {most} rows, the most that are allowed"


def cells_of(texts: Iterator[str], delimiter: str) -> Iterator[list[str]]:
    """Split lines into cells."""
    if not delimiter:
        return (text.split() for text in texts)
    rows = csv.reader(texts, delimiter=delimiter, skipinitialspace=True, strict=True)
    return ([cell.strip() for cell in row] for row in rows)


def _contents(file: Any, above: int, line: list[int]) -> Iterator[str]:
    """Lines below a line, without remarks and empty ones; `line` is set to the number of each."""
    for number, text in enumerate(file, 1):
        content = without_remark(text)
        if number > above and content.strip():
            line[0] = number
            yield content
