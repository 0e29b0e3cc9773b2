"""Calibration: what observations of real gears say about keys that are not known."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.dataset import dimension_names
from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.progress import sweep_progress
from gearidae.runs.execution import Execution, run_kept
from gearidae.runs.running import prepare
from gearidae.scene import describe_key
from gearidae.studies.declared.ensemble import figure_names
from gearidae.studies.distributions import read_distributions
from gearidae.studies.observations import STICKS, Observation
from gearidae.studies.posterior import grid_posterior, sampled_posterior
from gearidae.studies.predicting import Predictor
from gearidae.studies.products import open_posterior

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.runs.kept_runs import KeptRuns
    from gearidae.scene import Scene

log = logging.getLogger(__name__)

_ONE_CELL: Final = 0.9
"""Share of a posterior in one cell of its grid above which the cell is wider than the posterior."""
_FAR: Final = 4.0
"""Uncertainties beyond all runs from which an observation is far from them."""
METHODS: Final = ("auto", "grid", "emcee")


def calibrate(
    scene: Scene,
    priors: Mapping[str, Any],
    observations: Sequence[Observation],
    *,
    method: str = "auto",
    points: int = 41,
    steps: int = 500,
    seed: int = 0,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Posterior of some keys, given observations.

    Parameters
    ----------
    scene : Scene
        What the observed gears have in common.
    priors : mapping of str to object
        Keys, and what was known of them before, as for `ensemble`; distributions with a density.
    observations : sequence of Observation
        Gears that stuck or did not, frequencies of impact responses, other figures; independent of each other.
    method : {"auto", "grid", "emcee"}, optional
        A grid of one or two keys, without further libraries; or emcee, an affine-invariant sampler, for any number
        (an optional dependency). By default a grid for up to two keys.
    points : int, optional
        Cells a key of the grid, which spans 99.96 % of the prior.
    steps : int, optional
        Of each of emcee's walkers, of which there are 16, or four a key; the first quarter is not kept.
    seed : int, optional
        Of emcee.
    executor, jobs, backend, progress, archive, overwrite, resume
        As for `gearidae.sweep`. With `archive`, finished runs are kept beside it until the posterior is written.

    Returns
    -------
    Dataset
        Of a grid, ``weight`` (posterior probability of the cell) and ``log_likelihood`` along the keys; of emcee, a
        variable for each key along ``draw``. Of both, along ``parameter``, ``mean``, ``standard_deviation`` and
        ``quantiles``. `gearidae.studies.predict` takes it.

    Raises
    ------
    SceneError
        If a key, a prior, an observation or a setting is not allowed, or the observations are impossible.
    Interrupted
        On Ctrl-C; finished runs are kept beside `archive`.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> seen = [
    ...     gd.studies.Observation(value=True, conditions={"coating.sam_fraction": 0.45}),
    ...     gd.studies.Observation(value=False, conditions={"coating.sam_fraction": 0.6}),
    ... ]
    >>> found = gd.studies.calibrate(
    ...     scene, {"surface.asperity_radius": "normal(450 nm, 50 nm)"}, seen
    ... )  # doctest: +SKIP
    """
    base = prepare(scene, rtol=None, t_end=None, samples=None, backend=backend)
    distributions = read_distributions(base, priors)
    keys = tuple(each.key for each in distributions)
    chosen = _check(method, len(keys), points, steps, seed)
    seen = _checked(observations, base, keys)
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, base.run.method)
    settings = {"method": chosen, "points": points, "steps": steps, "seed": seed}
    about = _attributes(base, distributions, seen, settings)
    predictor = Predictor(base, keys, seen, how)

    def likelihood(values: Floats, shown: bool | SweepProgress = False) -> Floats:
        figures = predictor.figures(values, shown)
        if chosen == "grid":  # a sampler comes to places that it leaves again
            for place, each in enumerate(seen):
                _doubt_observation(each, figures[:, place])
        parts = [each.log_likelihood(figures[:, place]) for place, each in enumerate(seen)]
        return np.asarray(np.sum(parts, axis=0), dtype=np.float64)

    names = list(dimension_names(keys).values())

    def work(kept: KeptRuns | None) -> xr.Dataset:
        predictor.kept = kept
        if chosen == "grid":
            ds = grid_posterior(distributions, names, points, lambda values: likelihood(values, progress))
            _doubt(ds["weight"], dict(zip(names, keys, strict=True)))
        else:
            with sweep_progress(progress, steps) as report:
                allowed = _where_allowed(base, keys, likelihood)
                ds = sampled_posterior(distributions, names, steps, seed, allowed, report)
        for key, name in zip(keys, names, strict=True):
            info = describe_key(key)
            ds[name].attrs.update(long_name=f"{key}: {info.description}", units=info.unit)
        return ds.assign_attrs(about)

    depends = {name: about[name] for name in ("scene", "source", "calibration")}
    return run_kept(how, predictor.store, work, depends, read=open_posterior)


def _doubt(weight: xr.DataArray, keys: Mapping[Any, str]) -> None:
    """Say where a posterior is finer than its grid, or goes on beyond the prior."""
    for name, key in keys.items():
        share = weight.sum([dim for dim in weight.dims if dim != name]).values
        if share.max() > _ONE_CELL:
            log.warning(
                "the posterior of %s is narrower than a cell of the grid, and its spread is that of the cell: take "
                "more points, or a narrower prior",
                key,
            )
        if share.argmax() in (0, share.size - 1):
            log.warning("the most likely %s is at the edge of its prior", key)


def _doubt_observation(seen: Observation, predicted: Floats) -> None:
    """Say that no run comes near what was measured."""
    known = predicted[np.isfinite(predicted)]
    if seen.of == STICKS or not known.size:
        return
    low, high, value = known.min(), known.max(), float(seen.value)
    if not low - _FAR * seen.spread <= value <= high + _FAR * seen.spread:
        log.warning("no run comes near %s = %g: theirs are %g to %g", seen.figure, value, low, high)


def _where_allowed(scene: Scene, keys: tuple[str, ...], likelihood: Any) -> Any:
    """Make the likelihood of values that are not allowed zero."""

    def inside(values: Floats) -> Floats:
        found = np.full(len(values), -np.inf)
        allowed = np.array([_is_allowed(scene, keys, point) for point in values.tolist()])
        if allowed.any():
            found[allowed] = likelihood(values[allowed])
        return found

    return inside


def _is_allowed(scene: Scene, keys: tuple[str, ...], point: list[float]) -> bool:
    try:
        scene.replace(dict(zip(keys, point, strict=True)))
    except SceneError:
        return False
    return True


def _check(method: str, keys: int, points: int, steps: int, seed: int) -> str:
    """Return the method to take."""
    if method not in METHODS:
        raise SceneError("method", method, f"must be one of {', '.join(METHODS)}")
    if method == "grid" and keys > 2:
        raise SceneError("method", method, "must be emcee for more than two keys")
    for name, value, least in (("points", points, 3), ("steps", steps, 8), ("seed", seed, 0)):
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise SceneError(name, value, f"must be a whole number, {least} or more")
    return ("grid" if keys <= 2 else "emcee") if method == "auto" else method


def _checked(
    observations: Sequence[Observation], scene: Scene, keys: tuple[str, ...]
) -> tuple[Observation, ...]:
    """Refuse observations that cannot be compared with runs, before anything is run."""
    seen = tuple(observations)
    if not seen or not all(isinstance(each, Observation) for each in seen):
        raise SceneError("observations", len(seen), "must be a list of at least one Observation")
    for each in seen:
        each.check(figure_names(scene))
        for key in each.conditions:
            if key in keys:
                raise SceneError("conditions", key, "is a key to be calibrated: it cannot be a condition too")
        scene.replace(dict(each.conditions))
    return seen


def _attributes(
    scene: Scene, priors: Sequence[Any], seen: Sequence[Observation], settings: Mapping[str, Any]
) -> dict[str, Any]:
    """What a posterior depends on, as attributes."""
    listed = [
        {
            "of": each.figure,
            "value": str(each.value),
            "uncertainty": str(each.uncertainty),
            "conditions": {key: str(value) for key, value in each.conditions.items()},
            "misjudged": each.misjudged,
        }
        for each in seen
    ]
    settings_used = {"priors": {each.key: each.text for each in priors}, "observations": listed, **settings}
    return {
        **provenance(scene, "calibrated", swept=tuple(each.key for each in priors)),
        "title": f"{scene.name}: calibration of {', '.join(each.key for each in priors)}",
        "summary": f"Posterior of {', '.join(each.key for each in priors)}, given {len(seen)} observations.",
        "calibration": json.dumps(settings_used),
    }
