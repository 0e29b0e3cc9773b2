"""Run a scene with the keys that were calibrated drawn from their posterior: how often it sticks.

Finished runs are kept beside the archive, in OUT.nc.journal, until the archive is written.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.dataset import dimension_names
from gearidae.calibration.declared.calibrate import calibrated_keys
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweeping import run_study
from gearidae.studies.declared import ensemble
from gearidae.studies.design import check_design
from gearidae.studies.members import along_members, member_plan
from gearidae.studies.products import open_posterior
from gearidae.studies.study import Option

if TYPE_CHECKING:
    from gearidae.scene import Scene


def predict(
    scene: Scene,
    posterior: xr.Dataset,
    size: int,
    *,
    seed: int = 0,
    **options: Unpack[RunOptions],
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
        Seed of the draws.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`.

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
    base, execution = prepared(scene, options, samples="off")
    values = posterior_draws(posterior, size, seed)
    source = dict.fromkeys(values, "the posterior")
    plan = member_plan(base, values, source)
    about = {"design": "posterior", "seed": int(seed), "size": int(size), "of": None, "distributions": source}

    def finish(ds: xr.Dataset) -> xr.Dataset:
        return along_members(ds, tuple(values)).assign_attrs(
            title=f"{base.name}: {size} runs from a posterior of {', '.join(values)}",
            summary=f"Verdicts and figures of {size} runs with {', '.join(values)} drawn from their posterior.",
        )

    return run_study(plan, execution, {"ensemble": json.dumps(about)}, finish)


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
    indices = np.unravel_index(cells, weight.shape)
    values = {}
    for key, index in zip(keys, indices, strict=True):
        axis = posterior[names[key]].values
        width = axis[1] - axis[0]
        values[key] = axis[index] + width * (generator.random(size) - 0.5)
    return values


def _written(*, posterior: Annotated[Path, Option("Posterior, from gearidae calibrate.")]) -> dict[str, Any]:
    return {"posterior": open_posterior(posterior)}


def _announced(_: Scene, __: int | None, *, posterior: xr.Dataset, size: int, **___: Any) -> str:
    return f"{size} runs, {' and '.join(calibrated_keys(posterior))} drawn from the posterior"


STUDY = replace(
    ensemble.STUDY,
    title="Prediction",
    suffix="predicted",
    run="predict",
    command=_written,
    options=("size", "seed"),
    announcement=_announced,
    members=lambda posterior, size, **_: (calibrated_keys(posterior), size),
    examples=("gearidae predict mine.toml --posterior known.nc --size 64 --set drive.torque=6e-18",),
)
