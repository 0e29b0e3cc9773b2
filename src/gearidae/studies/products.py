"""Files that studies have written: one reader, which study a file is of, and what it says."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from gearidae.archive import open_archive
from gearidae.archive.library import loaded
from gearidae.errors import SceneError
from gearidae.studies.declared import studies

_HEADERS = (b"\x89HDF\r\n\x1a\n", b"CDF")
"""How netCDF files begin, those of version 4 and the older ones."""


def open_product(path: str | os.PathLike[str], kind: str | None = None) -> tuple[xr.Dataset, str]:
    """Read a file that this program has written, whatever it is.

    Parameters
    ----------
    path : path-like
        A netCDF file.
    kind : str, optional
        What it has to be: of a `Study`.

    Returns
    -------
    ds : Dataset
    kind : str
        Of a `Study`, or ``runs`` of an archive of other runs.

    Raises
    ------
    SceneError
        If the file cannot be read or is something else.
    """
    if kind is not None:
        ds = _read(path, kind)
        try:
            return studies()[kind].require(ds), kind
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
    for kind, study in studies().items():
        try:
            study.require(ds)
            return kind
        except SceneError:
            pass
    return "runs"


def _last(kind: str) -> str:
    """Name a file as errors do: ``map``."""
    return kind.rpartition("_")[2]


def _read(path: str | os.PathLike[str], kind: str) -> xr.Dataset:
    source, about = Path(path), studies()[kind]
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


@dataclass(frozen=True, slots=True)
class Answer:
    """What a study has found.

    Attributes
    ----------
    sentence : str
        The answer.
    rows : tuple of (str, str, str)
        Name, value and remark; a row without a value is a heading.
    """

    sentence: str
    rows: tuple[tuple[str, str, str], ...]


def answer(ds: xr.Dataset, kind: str) -> Answer:
    """Say what a study has found.

    Parameters
    ----------
    kind : str
        From `open_product`, other than ``runs``.
    """
    study = studies()[kind]
    return Answer(study.sentence(ds), tuple(study.rows(ds)))


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
