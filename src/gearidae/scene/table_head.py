"""What stands above the rows of a table in a text file: its encoding, separator, decimal sign and headings."""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from gearidae.scene.text_table import (
    TextTable,
    as_number,
    cells_of,
    check_regular,
    split_unit,
    without_remark,
)

_LONGEST_LINE: Final = 2**22
_SAMPLE: Final = 2**16  # bytes from which the encoding is recognised
_MOST_ABOVE: Final = 100  # lines in which the headings are looked for
_ROWS_SEEN: Final = 100  # rows from which separator and decimal sign are recognised
_ROWS_IN_TURN: Final = 5  # with numbers in columns that are given by number
_NO_CELLS: Final = ("comment", "start", "increment")
"""Last headings of LabVIEW and Rigol, below which most rows or all have no cell."""
_LABVIEW: Final = "LabVIEW Measurement"
"""First line of a file of which any row may have a remark, whatever stands above the rows."""
_MOST_LINES: Final = 100_000  # read above the rows, most of them remarks
_COMMA_NUMBER: Final = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_WHOLE_NUMBER: Final = re.compile(r"[+-]?\d+(?:[eE][+-]?\d+)?")
_WITH_UNIT: Final = re.compile(r"[^\[\]()]+[\[(][^\])]*[\])]")


class _Line(NamedTuple):
    """A line that is not empty: its number from 1, its text, and whether it is a remark."""

    number: int
    text: str
    remark: bool


def open_table(
    path: Path,
    *,
    largest: int,
    names: Callable[[Sequence[str]], bool] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    skip: int | None = None,
    unit_row: bool = False,
    columns: Sequence[int] | None = None,
) -> TextTable:
    """Read what stands above the first row of a table.

    Parameters
    ----------
    largest : int
        Bytes that the file may have.
    names : callable, optional
        Whether texts are the headings that are looked for. The first line that has them is the line of headings, be it
        a remark or not; if none has, it is the first that is no remark. Without it, the table has no headings.
    delimiter : str, optional
        Between the cells, empty for blanks; recognised by default.
    decimal : str, optional
        ``.`` or ``,``; recognised by default.
    skip : int, optional
        Lines above that of the headings.
    unit_row : bool, optional
        Whether the line below headings without units may hold these.
    columns : sequence of int, optional
        Columns of numbers, counted from 0, for a table whose headings are not read: it begins with the first rows that
        hold numbers in all of them.

    Raises
    ------
    ValueError
        If it is no regular file, too long, no text, or empty.
    """
    size = check_regular(path, largest)
    try:
        with path.open("rb") as file:
            encoding = _encoding(file.read(_SAMPLE))
        with path.open(encoding=encoding) as file:
            lines = _first_lines(file, skip or 0)
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise ValueError("is no text") from None
    plain = [line for line in lines if not line.remark]
    if not plain:
        raise ValueError("is empty: it has no row")
    heading, rows = None, plain
    if columns is not None:
        rows = _from_first_row(plain, columns, delimiter, decimal)
    elif names is not None:
        heading = _heading(lines, names, delimiter, is_first=skip is not None)
        rows = [line for line in plain if line.number > heading.number]
    texts = [line.text for line in rows[:_ROWS_SEEN]] or [plain[0].text]
    between = _delimiter(texts) if delimiter is None else delimiter
    point = _decimal(texts, between) if decimal is None else decimal
    headings = _headings(heading.text, between) if heading is not None else ()
    if unit_row and rows and _is_of_units(headings, rows[0].text, between):
        headings = _joined(headings, _split(rows[0].text, between))
        rows.pop(0)
    named = len(headings)
    if rows:
        headings = _with_cells(headings, _split(rows[0].text, between))
    above = rows[0].number - 1 if rows else lines[-1].number
    return TextTable(
        path=path,
        size=size,
        headings=headings,
        remarks=tuple(line.text for line in lines if line.remark and line.number <= above),
        delimiter=between,
        decimal=point,
        skipped=sum(line.number < (heading or rows[0]).number for line in plain) + (skip or 0) if rows else 0,
        above=above,
        encoding=encoding,
        remarked=len(headings) == named - 1 or plain[0].text.startswith(_LABVIEW),
        clock=_clock([line.text for line in plain if line.number <= above], between),
    )


def _encoding(start: bytes) -> str:
    """Recognise the encoding; bytes that are no UTF-8 come from an older Windows program."""
    if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if b"\0" in start:
        raise ValueError("is no text")
    try:
        codecs.getincrementaldecoder("utf-8")().decode(start)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _first_lines(file: Any, skip: int) -> list[_Line]:
    """Read lines until enough are there to recognise the table; those that are skipped and empty ones are left out."""
    lines: list[_Line] = []
    number = plain = 0
    while plain < _MOST_ABOVE + _ROWS_SEEN and (text := file.readline(_LONGEST_LINE)):
        number += 1
        if len(text) == _LONGEST_LINE:
            raise ValueError(f"has more than {_LONGEST_LINE} characters in line {number}: it is no table")
        text = text.strip(" \r\n\f\v")
        remark = text.startswith("#")
        if number > skip and text.strip():
            lines.append(_Line(number, text.lstrip("# ") if remark else without_remark(text), remark))
            plain += not remark
        if number > skip + _MOST_LINES:
            break
    return lines


def _heading(
    lines: list[_Line], names: Callable[[Sequence[str]], bool], delimiter: str | None, *, is_first: bool
) -> _Line:
    """Find the line of headings."""
    first = next(line for line in lines if not line.remark)
    if is_first:
        return first
    heading = None
    for line in [line for line in lines if line.number < first.number or not line.remark]:
        try:
            named = names(_headings(line.text, _delimiter([line.text]) if delimiter is None else delimiter))
        except ValueError:
            named = False  # a quotation mark in a line above the table
        if named:
            heading = line
            if not line.remark:
                break
        elif not line.remark and heading is not None:
            break  # the first row below headings in a remark
    return heading or first


def _headings(text: str, delimiter: str) -> tuple[str, ...]:
    """Split a line of headings, whose names may hold blanks before their units, and other separators than the rows."""
    if not delimiter or delimiter not in text:
        best = max(";\t,", key=text.count)
        delimiter = best if best in text else ""
    if delimiter:
        cells = _split(text, delimiter)
        return tuple(cells[:-1] if not cells[-1] else cells)
    names = _WITH_UNIT.findall(text)
    whole = (
        "".join(names).strip() == text.strip()
    )  # of a single column, which may have a blank before its unit
    return tuple(name.strip() for name in names) if len(names) > 1 or whole else tuple(text.split())


def _from_first_row(
    lines: list[_Line], columns: Sequence[int], delimiter: str | None, decimal: str | None
) -> list[_Line]:
    """Find the first rows that hold numbers in some columns; lines above a table may do so by chance."""
    for first in range(len(lines)):
        texts = [line.text for line in lines[first : first + _ROWS_IN_TURN]]
        between = _delimiter(texts) if delimiter is None else delimiter
        point = _decimal(texts, between) if decimal is None else decimal
        rows = [_split(text, between) for text in texts]
        if all(as_number("".join(row[k : k + 1] or "?"), point) is not None for row in rows for k in columns):
            return lines[first:]
    raise ValueError(
        f"has no rows with numbers in column {' and '.join(str(column + 1) for column in columns)}"
    )


def _with_cells(headings: tuple[str, ...], row: list[str]) -> tuple[str, ...]:
    """Leave out last headings of remarks and settings, where the first row has no such cells."""
    while len(headings) > len(row) and split_unit(headings[-1])[0].lower() in _NO_CELLS:
        headings = headings[:-1]
    return headings


def _is_of_units(headings: tuple[str, ...], text: str, delimiter: str) -> bool:
    """Whether the line below the headings holds units: no number, and the headings have none of their own."""
    cells = _split(text, delimiter)
    if cells and not cells[-1] and len(cells) == len(headings) + 1:
        cells.pop()
    bare = not any(split_unit(name)[1] for name in headings)
    # behind the units, an oscilloscope writes start and interval
    return (
        bare
        and len(cells) == len(headings)
        and all(as_number(cell, ".") is None for cell in cells[:2] if cell)
    )


def _joined(headings: tuple[str, ...], units: list[str]) -> tuple[str, ...]:
    pairs = zip(headings, units, strict=False)
    return tuple(f"{name} [{unit.strip('[]() ')}]" if unit else name for name, unit in pairs)


def _clock(texts: list[str], delimiter: str) -> tuple[float, float] | None:
    """Read the first time and the distance of samples [s] from lines above them.

    LabVIEW has lines ``X0`` and ``Delta_X`` with a cell for each channel; Rigol has headings ``Start`` and
    ``Increment`` above their cells. None if there is no distance, or channels differ.
    """
    try:
        rows = [_split(text, delimiter) for text in texts]
    except ValueError:
        return None  # a quotation mark in a line above the table
    cells: dict[str, list[str]] = {"x0": ["0"]}
    for row, below in zip(rows, [*rows[1:], []], strict=False):
        names = [cell.lower() for cell in row]
        if names[:1] in (["x0"], ["delta_x"], ["x_dimension"]):
            cells[names[0]] = row[1:]
        if {"start", "increment"} <= {*names}:
            for name, heading in (("x0", "start"), ("delta_x", "increment")):
                cells[name] = below[names.index(heading) :][:1]
    if {*map(str.lower, cells.pop("x_dimension", []))} - {"time", ""}:
        return None
    numbers = {
        name: {as_number(cell.replace(",", "."), ".") for cell in row if cell} for name, row in cells.items()
    }
    start, step = (
        numbers[name].pop() if len(numbers.get(name, ())) == 1 else None for name in ("x0", "delta_x")
    )
    if start is None or step is None or not (math.isfinite(start) and 0.0 < step < math.inf):
        return None
    return start, step


def _delimiter(texts: list[str]) -> str:
    """Recognise what separates the cells of rows."""
    for sure in ";\t":
        # a first cell may be empty
        if sure in texts[0].strip() or (texts[0].startswith(sure) and len(texts[0].split()) == 1):
            return sure
    if "," not in texts[0]:
        return ""
    cells = [text.split() for text in texts]
    decimals = all(
        _COMMA_NUMBER.fullmatch(cell) or _WHOLE_NUMBER.fullmatch(cell) for row in cells for cell in row
    )
    return "" if decimals and min(map(len, cells)) > 1 else ","


def _decimal(texts: list[str], delimiter: str) -> str:
    """Recognise the decimal sign."""
    cells = [
        cell.strip() for text in texts for cell in (text.split(delimiter) if delimiter else text.split())
    ]
    return "," if delimiter != "," and any(_COMMA_NUMBER.fullmatch(cell) for cell in cells) else "."


def _split(text: str, delimiter: str) -> list[str]:
    try:
        return next(cells_of(iter([text]), delimiter), [])
    except csv.Error as error:
        raise ValueError(f"has a line that is no row of a table ({error})") from None
