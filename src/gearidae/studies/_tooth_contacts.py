"""States of every pair of teeth at samples of a run, read from the model while the scene runs again.

A run is repeated with the driver that it was made with, from where it began, and does the same to the last bit. What is
recorded at a sample is the check: where the repeated run moves otherwise, it is not the recorded one, and nothing is
returned.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from gearidae import engine
from gearidae.archive.select import first_travel, is_roller, motion_samples, run_scene, runs, swept_dims
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.progress import run_progress
from gearidae.records.tooth_states import MeshState
from gearidae.runs.starting import start_again
from gearidae.scene import GearScene, Scene, require_gears
from gearidae.scene.carried import numbers_of

Integers = NDArray[np.int64]


def tooth_contacts(ds: xr.Dataset, times: ArrayLike) -> list[MeshState]:
    """Return the states of the pairs of teeth at some times of a run, for which its scene is run again.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair; from a sweep, one selected with ``sel``.
    times : array_like
        Times [s]; the nearest samples are taken. Infinite: the last one.

    Returns
    -------
    list of MeshState
        One for each time, in the order given.

    Raises
    ------
    SceneError
        If the dataset is of a roller, of several runs, or has no samples, a time lies outside of them, or the run
        cannot be repeated: it was made by a version, on a machine or with a law of a user that computes otherwise, or
        it goes on from a run that an archive of version 0.2 does not hold.

    Notes
    -----
    It takes as long as the run took up to the last of the times. A run that goes on from another begins at the state
    that it went on from, which its dataset holds, and so does each run of a chain.
    """
    run = _one_run(ds)
    wanted = _nearest(run, np.atleast_1d(numbers_of(times, "s")))
    states: dict[int, MeshState] = {}
    for scene, attributes, samples in _parts(run, np.unique(wanted)):
        states |= zip(samples.tolist(), _repeated(run, scene, attributes, samples), strict=True)
    return [states[sample] for sample in wanted.tolist()]


def last_time(ds: xr.Dataset) -> float:
    """Time of the last sample of the motion in one run of a gear pair [s]; what else a dataset is, is refused."""
    run = _one_run(ds)
    return float(run["time"][motion_samples(run) - 1])


def _one_run(ds: xr.Dataset) -> xr.Dataset:
    """Return the dataset as a single run."""
    if is_roller(ds):
        raise SceneError("dataset", "a roller", "must be of a gear pair: a roller has no teeth")
    if dims := swept_dims(ds):
        raise SceneError(
            "dataset",
            f"{ds.sizes[dims[0]]} runs",
            f"must be a single run: select one, as ds.isel({dims[0]}=0) or --select {dims[0]}=... do",
        )
    if "transmission_error" not in ds.variables:
        raise SceneError(
            "dataset", str(ds.attrs.get("title", "(no title)"))[:60], "holds no run with its motion"
        )
    if not motion_samples(ds):
        raise SceneError("dataset", "transmission_error", "the dataset has no samples of it")
    return next(run for _, run in runs(ds))


def _nearest(run: xr.Dataset, wanted: Floats) -> Integers:
    """Return which samples are nearest to some times; those of a single run are evenly spaced."""
    last = motion_samples(run) - 1
    start, end = (float(run["time"][index]) for index in (0, last))
    step = (end - start) / last if last > 0 else 1.0
    wanted = np.where(wanted == math.inf, end, wanted)
    for time in wanted:
        if not start - step <= time <= end + step:
            raise SceneError("time", float(time), f"must lie in the record, {start:g}..{end:g} s")
    if "chain" in run.attrs:
        indices = np.interp(wanted, run["time"].values[: last + 1], np.arange(last + 1))
    else:
        indices = (wanted - start) / step
    return np.clip(np.rint(indices).astype(np.int64), 0, last)


def _parts(run: xr.Dataset, samples: Integers) -> Iterator[tuple[GearScene, Mapping[Any, Any], Integers]]:
    """Go through the runs that have some of the samples, with scene and attributes: several of a chain."""
    if "chain" not in run.attrs:
        yield require_gears(run_scene(run)), run.attrs, samples
        return
    links = json.loads(run.attrs["chain"])
    starts = [link["start"] or 0.0 for link in links]
    # the sample between two runs is the first one's
    which = np.maximum(np.searchsorted(starts, _read(run, "time", samples), side="left") - 1, 0)
    for number in np.unique(which).tolist():
        yield require_gears(Scene.from_dict(links[number]["scene"])), links[number], samples[which == number]


def _repeated(
    run: xr.Dataset, scene: GearScene, attributes: Mapping[Any, Any], samples: Integers
) -> list[MeshState]:
    """Run a scene again up to the last of some samples, and return the states there."""
    begin = start_again(attributes)
    times = _read(run, "time", samples)
    every = scene.run.duration / max(scene.run.sample_count - 1, 1)
    numbers = np.rint((times - begin.time) / every).astype(np.int64)
    backend = str(run.attrs.get("backend", ""))
    with run_progress(False, float(times[-1])) as report:
        states = engine.states_at(
            scene,
            np.unique(numbers).tolist(),
            backend=backend if backend in ("native", "sksundae") else "auto",
            start=begin,
            on_progress=report,
        )
    if len(states) < len(samples):
        raise _not_repeated(run, f"ends before t = {times[-1]:g} s")
    _refuse_other_motion(run, scene, samples, states)
    return states


def _read(run: xr.Dataset, name: str, samples: Integers) -> Floats:
    """Read some samples of a variable, and no more of it."""
    values: Floats = run[name].variable[samples].values
    return values


def _refuse_other_motion(
    run: xr.Dataset, scene: GearScene, samples: Integers, states: list[MeshState]
) -> None:
    """Refuse states of a run that moves otherwise than the recorded one, by more than its solver's tolerance."""
    bound = scene.run.rtol * scene.surface.roughness
    travels = _read(run, "gear_angle", samples) * scene.geometry.base_radius_gear + first_travel(run, scene)
    errors = _read(run, "transmission_error", samples)
    for state, travel, error in zip(states, travels.tolist(), errors.tolist(), strict=True):
        if not (abs(state.transmission_error - error) <= bound and abs(state.travel - travel) <= bound):
            both = f"{state.transmission_error:.9g} m, recorded {error:.9g} m"
            raise _not_repeated(run, f"moves otherwise at t = {state.time:g} s (transmission error {both})")


def _not_repeated(run: xr.Dataset, what: str) -> SceneError:
    """Error for a run that does not do the same again."""
    made = str(run.attrs.get("source", "another version of gearidae"))
    allowed = (
        f"cannot be repeated here: its scene {what}. Versions, machine and laws of your own must be those of the run "
        f"({made}); or run the scene anew"
    )
    return SceneError("dataset", "a run", allowed)
