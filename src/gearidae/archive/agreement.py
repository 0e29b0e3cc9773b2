"""Whether the parts of a dataset agree with each other, whoever has edited it: asked once, when a file is opened."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.attributes import readable_scene
from gearidae.archive.dataset import dimension_names
from gearidae.archive.end_state import END_DIGEST, end_state_of, fingerprint
from gearidae.archive.provenance import SCENE_DIGEST, digest_of
from gearidae.archive.row_variables import DIMS
from gearidae.archive.select import is_train
from gearidae.archive.train.variables import ALL
from gearidae.archive.variables import ROLLER_EXTREMES, by_name
from gearidae.errors import SceneError
from gearidae.scene import Scene
from gearidae.scene.validity_row import ATTRIBUTE, rows_from_json

_TABLES: Final[Mapping[str, type]] = {
    "swept": dict,
    "parent": dict,
    "skipped": dict,
    "ensemble": dict,
    "calibration": dict,
    "law": dict,
    "chain": list,
    ATTRIBUTE: list,
    "settings": object,
}
"""Attributes that hold JSON, and what it must be."""


def disagreement(ds: xr.Dataset, *, runs: bool = True, times: bool = True) -> str:
    """Look for a part of a dataset that cannot be as gearidae wrote it.

    Parameters
    ----------
    ds : xarray.Dataset
        As read from a file, with a scene.
    runs : bool, optional
        Whether its variables are those of runs, else a study's own.
    times : bool, optional
        Whether to look at times, which are in memory then.

    Returns
    -------
    str
        What is wrong, in one line, with its key; empty if nothing is.
    """
    try:
        checks = (
            _wrong_tables,
            *((_wrong_times,) if times else ()),
            *((_wrong_units,) if runs else ()),
            _wrong_labels,
            _wrong_start,
        )
        return next((wrong for check in checks for wrong in check(ds)), "")
    except (KeyError, TypeError, AttributeError) as error:  # tables of the right kind with other entries
        return f"its attributes do not fit together ({type(error).__name__}: {error})"


def _wrong_tables(ds: xr.Dataset) -> Iterator[str]:
    for name, kind in _TABLES.items():
        if name not in ds.attrs:
            continue
        try:
            table: Any = json.loads(ds.attrs[name])
        except (TypeError, ValueError, RecursionError):
            yield f"its attribute {name} is not readable"
            continue
        if not isinstance(table, kind):
            yield f"its attribute {name} is not readable"
    if json.loads(ds.attrs.get(ATTRIBUTE, "[]")) and not rows_from_json(ds.attrs[ATTRIBUTE]):
        yield f"its attribute {ATTRIBUTE} has no rows of a validity table"
    for number, link in enumerate(json.loads(ds.attrs.get("chain", "[]"))):
        if not _is_scene(json.dumps(link["scene"])):
            yield f"its attribute chain has no scene of its run {number + 1}"


def _wrong_times(ds: xr.Dataset) -> Iterator[str]:
    if "time" in ds.dims and "time" in ds.coords:
        times = ds["time"].values
        if times.dtype.kind != "f" or not np.isfinite(times).all():
            yield "its coordinate time has times that are no numbers"
        elif not (np.diff(times) > 0.0).all():
            yield "its coordinate time does not increase"
    for name in (f"{dim}_time" for dim in DIMS):
        if name in ds and not np.isfinite(ds[name].values).all():
            yield f"its variable {name} has times that are no numbers"


def _wrong_units(ds: xr.Dataset) -> Iterator[str]:
    roller = "roller" in json.loads(ds.attrs["scene"])
    known = {**by_name(), **(ROLLER_EXTREMES if roller else {}), **(ALL if is_train(ds) else {})}
    for name, variable in ds.variables.items():
        units = variable.attrs.get("units")
        if (catalogued := known.get(str(name))) is not None and units not in (None, catalogued.units):
            yield f"its variable {name} is in {units}, and must be in {catalogued.units}"


def _wrong_labels(ds: xr.Dataset) -> Iterator[str]:
    """Compare the labels of runs with the values of the swept keys; a part that was picked out has some of them."""
    swept: dict[str, Any] = json.loads(ds.attrs.get("swept", "{}"))
    for key, name in dimension_names(swept).items():
        if not isinstance(swept[key], list):
            yield f"its attribute swept has no list of values of {key}"
        elif name in ds.coords:
            label = ds.coords[name]
            values = list(range(len(swept[key]))) if label.attrs.get("comment") else swept[key]
            for other in np.ravel(label.values[~np.isin(label.values, values)]).tolist()[:1]:
                yield f"its coordinate {name} has {other}, which is no value of {key} in its attribute swept"


def _wrong_start(ds: xr.Dataset) -> Iterator[str]:
    """Compare the run with its scene, and look at the states that it began with and has left."""
    rtol, of_scene = ds.attrs.get("rtol"), json.loads(ds.attrs["scene"]).get("run", {}).get("rtol")
    if None not in (rtol, of_scene) and rtol != of_scene:
        yield f"its attribute rtol is {rtol}, and {of_scene} in its scene"
    digest = ds.attrs.get(SCENE_DIGEST)
    if digest is not None and digest != digest_of(ds.attrs["scene"]):
        yield f"its attribute scene is not the scene that was run, of which {SCENE_DIGEST} is the digest"
    parent: dict[str, Any] = json.loads(ds.attrs.get("parent", "{}"))
    if parent and not _is_scene(parent.get("scene")):
        yield "its attribute parent has no scene"
    for name, holder, known_as in (
        ("parent", parent, ds.attrs.get("started_from")),
        ("end_state", ds.attrs, ds.attrs.get(END_DIGEST)),
    ):
        if "end_state" not in holder or "swept" in ds.attrs:
            continue
        try:
            words, _ = end_state_of(holder)
        except SceneError:
            yield f"its attribute {name} has no state that a run has left"
        else:
            if known_as not in (None, fingerprint(words)):
                yield f"its attribute {name} has the state that another run has left"


def _is_scene(text: object) -> bool:
    try:
        return Scene.from_dict(readable_scene(text) or {}) is not None
    except SceneError:
        return False
