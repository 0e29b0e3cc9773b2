"""Files with a height map: numpy's, text, and what SurfaceTopography reads."""

from __future__ import annotations

import math
import os
import re
import warnings
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.scene.carried import numbers_of
from gearidae.scene.group import shorten
from gearidae.scene.table_head import open_table
from gearidae.scene.text_table import TextTable, as_number, check_regular, without_remark
from gearidae.scene.units import from_text

_TEXTS = (".csv", ".txt", ".dat")
_LARGEST = 2**32  # bytes
_MOST_POINTS = 100_000_000
_SAID = re.compile(
    r"\s*(?:(?P<width>width|breite|largeur|larghezza|anchura|šířka)"
    r"|(?P<height>height|höhe|hauteur|altezza|altura|výška)"
    r"|(?P<unit>value units?|einheiten|unités|unità valore|unidades de valor|jednotky hodnot))"
    r"\s*[:=]\s*(?P<said>.*?)\s*",
    re.IGNORECASE,
)
"""What Gwyddion writes above the numbers, in some of its languages."""
_BETWEEN = re.compile(r"[\s,;]+")
_FEWEST_LABELS = 8
"""Rows and columns below which labels are not recognised; such a map is too small for an analysis."""
_APART = 5.0
"""Labels differ from the next line by so many times what that differs from the one behind it."""
_HEIGHTS = re.compile(r"\s*(?:heights?|z)\s*[\[(]\s*([^\])]+?)\s*[\])]", re.IGNORECASE)
"""A heading with the unit of the heights."""


class Scan(NamedTuple):
    """A height map as a file has it.

    Attributes
    ----------
    heights : ndarray, shape (rows, columns)
        [m]; NaN where there is none.
    size : tuple of float or None
        Extent along both indices [m]; None if the file does not say.
    """

    heights: NDArray[np.float64]
    size: tuple[float, float] | None


def read_scan(path: str | os.PathLike[str], unit: str | None = None) -> Scan:
    """Read a height map.

    Parameters
    ----------
    path : str or path-like
        ``.npy``, or a table of numbers in text (``.csv``, ``.txt``, ``.dat``), a row of the map in each line:
        separated by commas, semicolons, tabs or blanks, remarks after ``#``, empty cells and ``nan`` for holes.
        Remarks above the numbers may say the extent and the unit, as Gwyddion writes them (``Width: 2 um``,
        ``Height: 2 um``, ``Value units: nm``), or the unit alone (``heights [nm]``). Any other format, such as those of
        microscopes, is read by SurfaceTopography, if that is installed.
    unit : str, optional
        Unit of the heights in a file that does not say it; metres without one in ``.npy`` and text files.

    Returns
    -------
    Scan

    Raises
    ------
    SceneError
        If the file cannot be read, its unit is not a length, or is another than the one given.
    """
    return _read(Path(path), unit)[0]


def read_lines(path: Path, unit: str | None = None) -> Scan:
    """Read a height map with the lines of the scan as its rows; in SurfaceTopography they are its columns.

    Parameters
    ----------
    path, unit
        As for `read_scan`.
    """
    scan, by_library = _read(path, unit)
    if not by_library:
        return scan
    return Scan(scan.heights.T, None if scan.size is None else scan.size[::-1])


def _read(path: Path, unit: str | None) -> tuple[Scan, bool]:
    """Read a height map; say whether SurfaceTopography has done it."""
    ending = path.suffix.lower()
    try:
        check_regular(path, _LARGEST)
    except (ValueError, OSError) as error:
        raise _no_heights(path, error) from None
    try:
        if ending == ".npy":
            return Scan(_array(path) * _factor(unit or "m"), None), False
        if ending in _TEXTS:
            return _text(path, unit), False
    except SceneError:
        raise
    except (ValueError, TypeError, EOFError, OSError) as error:
        refusal = _no_heights(path, error)
        if ending not in _TEXTS or not _is_of_another_program(path):
            raise refusal from None
        try:
            return _by_surface_topography(path, unit), True
        except SceneError as other:
            if other.key == "unit":  # it is read, and lacks the unit
                raise
            reason = f"{refusal.allowed}; a file of another program {other.allowed}"
            raise SceneError("surface scan", path, reason) from None
    return _by_surface_topography(path, unit), True


def _no_heights(path: Path, error: Exception) -> SceneError:
    return SceneError("surface scan", path, f"is no table of heights: {error}")


def _is_of_another_program(path: Path) -> bool:
    """Whether a file is no text, or has lines of its own kind above rows of numbers, all with as many of them."""
    try:
        with path.open(encoding="utf-8") as file:
            widths = [_row_width(line) for line in file if without_remark(line).strip()]
    except (OSError, UnicodeDecodeError):
        return True
    first = next((k for k, width in enumerate(widths) if width), 0)
    return first > 0 and len(set(widths[first:])) == 1


def _row_width(line: str) -> int:
    """Count the numbers in a line; 0 if it holds anything else."""
    cells = _BETWEEN.split(line.strip().lower())
    return len(cells) * all(cell == "bad" or as_number(cell, ".") is not None for cell in cells)


def _factor(unit: str) -> float:
    try:
        return from_text(f"1 {unit}", "m")
    except ValueError as error:
        raise SceneError("unit", unit, str(error)) from None


def _array(path: Path) -> NDArray[np.float64]:
    """Read an array, whose header may declare more than the file has, or than there is memory for."""
    declared = np.load(path, mmap_mode="r", allow_pickle=False)
    if declared.size > _MOST_POINTS:
        raise ValueError(f"has {declared.size} points; there may be {_MOST_POINTS}")
    return numbers_of(declared, "m")  # refuses complex numbers, whose imaginary parts would be lost


def _text(path: Path, unit: str | None) -> Scan:
    """Read numbers in lines, with what remarks above them say of the unit of the heights and the extent."""
    table = open_table(path, largest=_LARGEST)
    matches = [match for text in table.remarks if (match := _SAID.fullmatch(text))]
    said = {name: match["said"] for match in matches for name in ("width", "height", "unit") if match[name]}
    unit_of_file = said.get("unit") or next(
        (match[1] for text in table.remarks if (match := _HEIGHTS.match(text))), None
    )
    factor = _factor(unit or unit_of_file or "m")
    if unit is not None and unit_of_file is not None and not math.isclose(factor, _factor(unit_of_file)):
        raise SceneError(
            "unit", unit, f"the heights are in {unit_of_file}, as {path.name} says: leave the unit out"
        )
    extent = [_length(path, said[name]) for name in ("height", "width") if name in said]
    heights = _without_labels(table, table.numbers(holes=True))
    return Scan(heights * factor, (extent[0], extent[-1]) if len(extent) == 2 else None)


def _without_labels(table: TextTable, heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Leave out a heading and an index, as pandas writes them: numbers that count the columns and the rows.

    They are whole numbers from 0 or 1, or coordinates at even distances that meet in an empty cell.
    """
    first = [cells for _, _, cells in islice(table.rows(), 3)]
    if min(heights.shape) < _FEWEST_LABELS:
        return heights
    if not first[0][0] and _evenly(heights[0, 1:]) and _evenly(heights[1:, 0]):
        left_out, kept = "first row and the first column are", heights[1:, 1:]
    elif all(map(str.isdigit, first[0])) and _counts(heights, first[1]):
        left_out, kept = "first row is", heights[1:]
    elif all(cells[0].isdigit() for cells in first) and _counts(heights.T, [cells[1] for cells in first]):
        left_out, kept = "first column is", heights[:, 1:]
    else:
        return heights
    warnings.warn(f"{table.path.name}: the {left_out} left out, labels that count the others", stacklevel=4)
    return kept


def _counts(lines: NDArray[np.float64], cells: list[str]) -> bool:
    """Whether the first line counts from 0 or 1; beside heights in whole numbers, also whether it stands apart."""
    counts = lines[0, 0] in (0.0, 1.0) and bool((np.diff(lines[0]) == 1.0).all())
    if not counts or not all(cell.lstrip("+-").isdigit() for cell in cells):
        return counts
    steps = np.nanmedian(np.abs(np.diff(lines[:3], axis=0)), axis=1)
    return bool(steps[0] > _APART * steps[1])


def _evenly(numbers: NDArray[np.float64]) -> bool:
    steps = np.diff(numbers)
    return bool(steps[0]) and bool(np.allclose(steps, steps[0], rtol=1e-3, atol=0.0))


def _length(path: Path, text: str) -> float:
    try:
        return from_text(text.replace(",", "."), "m")
    except ValueError as error:
        reason = f"has the length {shorten(text)} in its header: {error}"
        raise SceneError("surface scan", path, reason) from None


def _by_surface_topography(path: Path, unit: str | None) -> Scan:
    """Read a microscope's file with heights and sizes in their units, as far as it has any."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns that it does without MPI
            from SurfaceTopography import read_topography
    except ImportError:
        endings = ", ".join((".npy", *_TEXTS))
        raise SceneError(
            "surface scan",
            path,
            f"is read by SurfaceTopography: pip install 'gearidae[surfaces]'; without it {endings} are read",
        ) from None
    sized = True
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # some of its readers leave files open
            try:
                scan: Any = read_topography(str(path))
            except ValueError as error:
                if "physical_sizes" not in str(error):
                    raise
                scan, sized = read_topography(str(path), physical_sizes=(1.0, 1.0)), False
            unit_of_file = scan.unit
            scan = scan if unit_of_file is None else scan.to_unit("m")
            heights = np.ma.array(scan.heights(), dtype=np.float64, copy=True)
            sizes = scan.physical_sizes
    except Exception as error:  # each of its forty readers fails in its own way
        raise SceneError(
            "surface scan",
            path,
            f"cannot be read by SurfaceTopography: {shorten(' '.join(str(error).split()))}",
        ) from error
    if np.ndim(heights) != 2:
        raise SceneError("surface scan", path, "holds a line scan; a map is needed")
    if unit_of_file is not None and unit is not None:
        raise SceneError(
            "unit", unit, f"is for files without a unit; {path.name} carries its own, {unit_of_file}"
        )
    if unit_of_file is None and unit is None:
        raise SceneError(
            "unit", "(none)", f"is needed: {path.name} does not say in which unit its heights are"
        )
    factor = 1.0 if unit is None else _factor(unit)
    extent = (float(sizes[0]), float(sizes[1])) if sized and unit_of_file is not None else None
    return Scan(np.ma.filled(heights, np.nan) * factor, extent)
