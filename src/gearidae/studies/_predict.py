"""Predictions from a calibration: an ensemble whose keys are drawn from the posterior."""

from __future__ import annotations

import json
import os
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.dataset import dimension_names
from gearidae.runs.execution import Execution
from gearidae.runs.running import prepare
from gearidae.runs.sweeping import run_study
from gearidae.studies.design import check_design
from gearidae.studies.members import along_members, member_plan
from gearidae.studies.products import calibrated_keys

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.scene import Scene


def predict(
    scene: Scene,
    posterior: xr.Dataset,
    size: int,
    *,
    seed: int = 0,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Run a scene with the keys that were calibrated drawn from their posterior.

    Parameters
    ----------
    scene : Scene
        What is to be predicted: also under other conditions than those of the observations.
    posterior : Dataset
        From `calibrate`.
    size : int
        Number of members.
    seed : int, optional
        Of the draws.
    executor, jobs, backend, progress, archive, overwrite, resume
        As for `gearidae.sweep`.

    Returns
    -------
    Dataset
        Along ``member``, as from `ensemble`; `sticking_probability` takes it.

    Raises
    ------
    SceneError
        If the dataset is no posterior, or a setting is not allowed.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``.
    """
    check_design(size, "random", seed, indices=False)
    base = prepare(scene, rtol=None, t_end=None, samples="off", backend=backend)
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, base.run.method)
    values = posterior_draws(posterior, size, seed)
    source = dict.fromkeys(values, "the posterior")
    plan = member_plan(base, values, source)
    about = {"design": "posterior", "seed": int(seed), "size": int(size), "of": None, "distributions": source}

    def finish(ds: xr.Dataset) -> xr.Dataset:
        return along_members(ds, tuple(values)).assign_attrs(
            title=f"{base.name}: {size} runs from a posterior of {', '.join(values)}",
            summary=f"Verdicts and figures of {size} runs with {', '.join(values)} drawn from their posterior.",
        )

    return run_study(plan, how, {"ensemble": json.dumps(about)}, finish)


def posterior_draws(posterior: xr.Dataset, size: int, seed: int = 0) -> dict[str, NDArray[np.float64]]:
    """Draw values of the keys from a posterior.

    Parameters
    ----------
    posterior : Dataset
        From `calibrate`.
    size : int
        Number of draws.

    Returns
    -------
    dict of str to ndarray, shape (size,)
        In SI units; of a grid spread evenly over each cell.

    Raises
    ------
    SceneError
        If the dataset is no posterior.
    """
    keys = calibrated_keys(posterior)
    names = dimension_names(keys)
    generator = np.random.default_rng(seed)
    if "weight" not in posterior:
        drawn = generator.integers(0, posterior.sizes["draw"], size)
        return {key: posterior[names[key]].values[drawn] for key in keys}
    weight = posterior["weight"]
    cells = generator.choice(weight.size, size, p=weight.values.ravel() / weight.values.sum())
    places = np.unravel_index(cells, weight.shape)
    values = {}
    for key, place in zip(keys, places, strict=True):
        axis = posterior[names[key]].values
        width = axis[1] - axis[0]
        values[key] = axis[place] + width * (generator.random(size) - 0.5)
    return values
