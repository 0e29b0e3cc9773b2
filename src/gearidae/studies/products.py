"""Files that studies have written: one reader, and which study a file is of."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import xarray as xr

from gearidae.archive import open_archive
from gearidae.archive.library import loaded
from gearidae.errors import SceneError
from gearidae.studies.declared import studies

_HEADERS = (b"\x89HDF\r\n\x1a\n", b"CDF")
"""How netCDF files begin, those of version 4 and the older ones."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """What a study writes other than runs.

    Attributes
    ----------
    words : str
        What it is.
    maker : str
        Function of `gearidae.studies`, or command, that makes one.
    needed : dict of str to str
        Variables that it has, and their first dimension, which is not empty.
    check : callable
        Raises a SceneError if it is something else.
    """

    words: str
    maker: str
    needed: dict[str, str] = field(default_factory=dict)
    check: Callable[[xr.Dataset], object] = id  # anything will do


_KINDS: Final = {
    "starting_torque": _Kind(
        "study of starting torques",
        "starting-torque",
        dict.fromkeys(("static_torque", "simulated_torque", "simulated_stuck"), "sam_fraction"),
    ),
    "starting_torques": _Kind(
        "study of a population's starting torques",
        "starting-torque",
        dict.fromkeys(
            (
                "starting_torque",
                "starts",
                "quantiles",
                "not_started",
                "chance",
                "rate",
                "median_change",
                "damping",
            ),
            "sam_fraction",
        ),
    ),
}


def require(ds: xr.Dataset, kind: str) -> xr.Dataset:
    """Return a dataset that a study has made.

    Parameters
    ----------
    kind : str
        ``coating_map``, ``life``, ``lives``, ``posterior``, ``starting_torque``, ``starting_torques`` or
        ``sticking_threshold``.

    Raises
    ------
    SceneError
        If it is something else.
    """
    if kind in studies():
        return studies()[kind].require(ds)
    about = _KINDS[kind]
    lacking = [
        name
        for name, dim in about.needed.items()
        if name not in ds or ds[name].dims[:1] != (dim,) or not ds.sizes[dim]
    ]
    if lacking:
        allowed = f"is no {about.words}: it lacks {', '.join(lacking)}; make one with {about.maker}"
        raise SceneError("dataset", type(ds).__name__, allowed)
    about.check(ds)
    return ds


def open_product(path: str | os.PathLike[str], kind: str | None = None) -> tuple[xr.Dataset, str]:
    """Read a file that this program has written, whatever it is.

    Parameters
    ----------
    path : path-like
        A netCDF file.
    kind : str, optional
        What it has to be, as for `require`.

    Returns
    -------
    ds : Dataset
    kind : str
        As for `require`, or ``runs``, ``ensemble`` or ``operating_map`` of an archive of runs.

    Raises
    ------
    SceneError
        If the file cannot be read or is something else.
    """
    if kind is not None:
        ds = _read(path, kind)
        try:
            return require(ds, kind), kind
        except SceneError as error:
            raise SceneError(_last(kind), path, error.allowed) from None
    try:
        ds = open_archive(path)
        return ds, kind_of(ds)
    except SceneError as no_archive:
        try:
            ds = _read(path, "life")
        except SceneError:
            raise no_archive from None
        if (found := kind_of(ds)) == "runs":
            raise
        return ds, found


def kind_of(ds: xr.Dataset) -> str:
    """Say what a dataset is.

    Returns
    -------
    str
        As from `open_product`; ``runs`` if it is nothing else.
    """
    for kind in (*studies(), *_KINDS):
        try:
            require(ds, kind)
            return kind
        except SceneError:
            pass
    return "runs"


def _last(kind: str) -> str:
    """Name a file as errors do: ``map``."""
    return kind.rpartition("_")[2]


def _read(path: str | os.PathLike[str], kind: str) -> xr.Dataset:
    source, about = Path(path), studies().get(kind) or _KINDS[kind]
    if not source.is_file():
        raise SceneError(_last(kind), path, "there is no such file")
    try:
        with source.open("rb") as file:
            head = file.read(8)
    except OSError as error:
        raise SceneError(_last(kind), path, f"cannot be read ({error.strerror})") from error
    if not head.startswith(_HEADERS):
        allowed = f"is no {about.words} but another kind of file; make one with {about.maker}"
        raise SceneError(_last(kind), path, allowed)
    try:
        return loaded(source)
    except Exception as error:
        raise SceneError(_last(kind), path, f"is damaged ({error})") from error


def open_life(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read the life of a coating that was saved; errors are those of `open_product`."""
    return open_product(path, "life")[0]


def open_lives(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read the lives of an ensemble that were saved; errors are those of `open_product`."""
    return open_product(path, "lives")[0]


def open_map(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a coating map that was saved; errors are those of `open_product`."""
    return open_product(path, "coating_map")[0]


def open_posterior(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a posterior that was saved; errors are those of `open_product`."""
    return open_product(path, "posterior")[0]
