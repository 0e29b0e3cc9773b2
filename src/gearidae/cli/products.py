"""Files that a study has written, other than runs: which kind one is, and what is in it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gearidae as gd
from gearidae.archive.select import scene_of
from gearidae.cli.machine import contents
from gearidae.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["open_product", "product_facts", "product_rows"]


def _readers() -> dict[str, Callable[[Path], xr.Dataset]]:
    """How each kind is read, by the name of its picture."""
    return {
        "coating_map": gd.analysis.open_map,
        "life": gd.studies.open_life,
        "lives": gd.studies.open_lives,
        "posterior": gd.studies.open_posterior,
    }


def open_product(path: Path) -> tuple[xr.Dataset, str]:
    """Read a file whatever it is.

    Parameters
    ----------
    path : Path

    Returns
    -------
    tuple of Dataset and str
        What it holds; ``coating_map``, ``life``, ``lives`` or ``posterior``, or ``runs`` of an archive of runs.

    Raises
    ------
    SceneError
        If it is none of these.
    """
    try:
        return gd.open_archive(path), "runs"
    except SceneError:
        for kind, read in _readers().items():
            try:
                return read(path), kind
            except SceneError:
                pass
        raise


def product_rows(path: Path, ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Say what is in a file: name, value and unit or meaning of each row.

    Parameters
    ----------
    path : Path
    ds : Dataset
    """
    yield str(path), f"{path.stat().st_size / 1e6:.1f} MB", ""
    numbers: list[tuple[str, str, str]] = []
    for name, value in ds.attrs.items():
        if name in ("title", "summary", "history", "source"):
            yield str(name), str(value), ""
        elif isinstance(value, int | float) and not isinstance(value, bool):
            numbers.append((str(name).replace("_", " "), f"{value:.6g}", ""))
    yield from numbers
    for dim, size in ds.sizes.items():
        yield f"dimension: {dim}", str(size), ""
    yield "variables", "", ""
    for name, one in ds.data_vars.items():
        yield str(name), f"({', '.join(map(str, one.dims))})", str(one.attrs.get("units", ""))


def product_facts(path: Path, ds: xr.Dataset, kind: str) -> dict[str, Any]:
    """Say the same for programs.

    Parameters
    ----------
    path : Path
    ds : Dataset
    kind : str
    """
    return {
        "file": str(path),
        "bytes": path.stat().st_size,
        "kind": kind,
        "attributes": {str(name): value for name, value in ds.attrs.items() if name != "scene"},
        **contents(ds),
        "scene": scene_of(ds),
    }
