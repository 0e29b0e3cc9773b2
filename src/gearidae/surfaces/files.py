"""Files with a height map: numpy's, text, and what SurfaceTopography reads."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.scene.group import shorten
from gearidae.scene.units import from_text

__all__ = ["Scan", "read_scan"]

_TEXTS = (".csv", ".txt", ".dat")
_SEPARATORS = ";\t,"
_FEW_LINES = 100


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
        separated by commas, semicolons, tabs or blanks, comments after ``#``, empty cells and ``nan`` for holes. Any
        other format, such as those of microscopes, is read by SurfaceTopography, if that is installed.
    unit : str, optional
        Unit of the heights in ``.npy`` and text files; metres without one. Other formats carry their own.

    Returns
    -------
    Scan

    Raises
    ------
    SceneError
        If the file cannot be read, or its unit is not a length.
    """
    path = Path(path)
    if not path.is_file():
        raise SceneError("surface scan", path, "no such file")
    ending = path.suffix.lower()
    try:
        if ending == ".npy" or ending in _TEXTS:
            heights = np.load(path, allow_pickle=False) if ending == ".npy" else _table(path)
            return Scan(np.asarray(heights, dtype=np.float64) * _factor(unit), None)
    except (ValueError, TypeError, EOFError, OSError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError("surface scan", path, f"is no table of heights: {shorten(str(error))}") from None
    if unit is not None:
        raise SceneError("unit", unit, f"is for .npy and text files; {path.name} carries its own")
    return _by_surface_topography(path)


def _factor(unit: str | None) -> float:
    if unit is None:
        return 1.0
    try:
        return from_text(f"1 {unit}", "m")
    except ValueError as error:
        raise SceneError("unit", unit, str(error)) from None


def _table(path: Path) -> NDArray[np.float64]:
    """Read numbers in lines, separated by what the first of them has."""
    import pandas as pd

    with path.open(encoding="utf-8-sig", errors="replace") as file:
        lines = (line for line, _ in zip(file, range(_FEW_LINES), strict=False))
        first = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), "")
    separator = next((char for char in _SEPARATORS if char in first.strip()), r"\s+")
    table = pd.read_csv(
        path, sep=separator, header=None, comment="#", skip_blank_lines=True, dtype=np.float64, engine="c",
        encoding="utf-8-sig",
    )  # fmt: skip
    if first.rstrip().endswith(separator):  # a separator at the end of each line makes no column
        table = table.iloc[:, :-1]
    heights: NDArray[np.float64] = table.to_numpy()
    return heights


def _by_surface_topography(path: Path) -> Scan:
    """Read a microscope's file with heights and sizes in their units."""
    try:
        from SurfaceTopography import read_topography
    except ImportError:
        endings = ", ".join((".npy", *_TEXTS))
        raise SceneError(
            "surface scan",
            path,
            f"is read by SurfaceTopography: pip install 'gearidae[surfaces]'; without it {endings} are read",
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # some of its readers leave files open
            scan: Any = read_topography(str(path)).to_unit("m")
            heights = np.ma.array(scan.heights(), dtype=np.float64, copy=True)
            sizes = scan.physical_sizes
    except Exception as error:  # each of its forty readers fails in its own way
        raise SceneError(
            "surface scan", path, f"SurfaceTopography cannot read it: {shorten(str(error))}"
        ) from error
    if np.ndim(heights) != 2:
        raise SceneError("surface scan", path, "holds a line scan; a map is needed")
    return Scan(np.ma.filled(heights, np.nan), (float(sizes[0]), float(sizes[1])))
