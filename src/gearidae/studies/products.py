"""Files that studies have written: one reader, which study a file is of, and what it says."""

from __future__ import annotations

import os
from dataclasses import dataclass

import xarray as xr

from gearidae.archive import open_archive
from gearidae.archive.netcdf import OtherFileError
from gearidae.errors import SceneError
from gearidae.studies.declared import studies


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
        return studies()[kind].open(path), kind
    try:
        ds = open_archive(path)
        return ds, kind_of(ds)
    except SceneError as no_archive:
        try:
            ds = studies()["life"].read(path)
        except SceneError:
            raise no_archive from None
        if (content := kind_of(ds)) == "runs":
            raise (_not_whole(ds, path) if isinstance(no_archive, OtherFileError) else no_archive) from None
        return studies()[content].undamaged(ds, path), content


def _not_whole(ds: xr.Dataset, path: str | os.PathLike[str]) -> SceneError:
    """Error about the file of a study that has lost variables: of the study of which it has the largest share."""
    share, nearest, lacking = 0.0, "file", "the variables of any study"
    for study in studies().values():
        required = {name for name, column in study.columns.items() if column.required}
        held = required & {*ds.variables}
        if len(held) > share * len(required):
            share, nearest = len(held) / len(required), study.words
            lacking = ", ".join(sorted(required - held))
    return SceneError("archive", path, f"is a damaged {nearest}: it lacks {lacking}")


def open(path: str | os.PathLike[str]) -> xr.Dataset:  # noqa: A001
    """Read a file that gearidae has written: a run, a sweep, or what any study has found.

    Parameters
    ----------
    path : path-like
        A netCDF file.

    Returns
    -------
    xarray.Dataset
        Identical to the saved dataset; an unfinished run as `open_archive` reads it. ``ds.gearidae`` says what it is.

    Raises
    ------
    SceneError
        If the file cannot be read or is something else.
    """
    return open_product(path)[0]


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
