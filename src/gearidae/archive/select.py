"""Take a dataset apart into its runs: a single run, one picked from a sweep, and a whole sweep alike."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.dataset import dimension_names
from gearidae.archive.pieces import reached
from gearidae.archive.variables import columns
from gearidae.errors import SceneError
from gearidae.scene import Scene

__all__ = ["is_roller", "motion_samples", "run_scene", "run_value", "runs", "scene_of", "swept_dims"]


def scene_of(ds: xr.Dataset) -> dict[str, Any]:
    """Return the scene that a dataset carries, as plain data in SI units.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep` or `open_archive`.

    Returns
    -------
    dict
        Of a sweep, the scene that its runs were derived from.

    Raises
    ------
    SceneError
        If the dataset carries none.
    """
    try:
        scene = json.loads(ds.attrs["scene"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SceneError(
            "dataset", type(ds).__name__, "must come from simulate, sweep or open_archive"
        ) from error
    if not isinstance(scene, dict):
        raise SceneError("dataset", type(ds).__name__, "must come from simulate, sweep or open_archive")
    return scene


def is_roller(ds: xr.Dataset) -> bool:
    """Whether a dataset is of a roller scene, else of a gear pair."""
    return scene_of(ds).get("roller") is not None


def swept_dims(ds: xr.Dataset) -> tuple[str, ...]:
    """Dimensions along which the runs of a dataset differ; none for a single run."""
    sample = next((ds[name] for name in columns(is_roller(ds)) if name in ds), None)
    return () if sample is None else tuple(str(dim) for dim in sample.dims if dim != "time")


def runs(ds: xr.Dataset) -> Iterator[tuple[dict[str, Any], xr.Dataset]]:
    """Go through the runs of a dataset, each with its own events only.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, a sweep, or a selection from a sweep.

    Yields
    ------
    label : dict
        Dimension to value; empty for a single run.
    run : xarray.Dataset
        The run, without swept dimensions.
    """
    dims = swept_dims(ds)
    for place in np.ndindex(*(ds.sizes[dim] for dim in dims)):
        run = ds.isel(dict(zip(dims, place, strict=True)))
        yield {dim: run[dim].item() for dim in dims}, _own_events(run)


def run_value(run: xr.Dataset, name: str) -> Any:
    """Status or solver statistic of one run: a variable if it comes from a sweep, an attribute otherwise."""
    return run[name].item() if name in run.variables else run.attrs[name]


def run_scene(run: xr.Dataset) -> Scene:
    """Return the scene of one run, also of one that was picked from a sweep.

    Parameters
    ----------
    run : xarray.Dataset
        Without swept dimensions.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    scene = Scene.from_dict(scene_of(run))
    swept: Mapping[str, list[Any]] = json.loads(run.attrs.get("swept", "{}"))
    changes = {}
    for key, dim in dimension_names(swept).items():
        value = run[dim].item()
        if run[dim].attrs.get("comment"):  # values that are neither numbers nor words are numbered
            if not (isinstance(value, int) and 0 <= value < len(swept[key])):
                raise SceneError("dataset", f"{dim} {value}", f"must number one of {len(swept[key])} values")
            value = swept[key][value]
        changes[key] = value
    return scene.replace(changes)


def motion_samples(run: xr.Dataset) -> int:
    """Return how many samples of the motion a run has.

    Parameters
    ----------
    run : xarray.Dataset
        One run of a gear pair.

    Returns
    -------
    int
    """
    samples = reached(run["transmission_error"])
    for name in ("gear_angle", "gear_speed", "pinion_speed", "mesh_force"):
        if samples and not np.isfinite(run[name].variable[samples - 1].values):
            samples = min(samples, reached(run[name]))
    return samples


def _own_events(run: xr.Dataset) -> xr.Dataset:
    """Drop the events of other runs, which stay behind when a run is picked from a sweep."""
    if "swept" not in run.attrs:
        return run
    labels = [
        name for name in map(str, run.coords) if name not in run.dims and f"event_{name}" in run.variables
    ]
    own = np.ones(run.sizes.get("event", 0), dtype=bool)
    for name in labels:
        own &= run[f"event_{name}"].values == run[name].item()
    return run if own.all() else run.isel(event=own)
