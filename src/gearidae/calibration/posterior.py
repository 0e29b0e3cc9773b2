"""The posterior of some keys: on a grid for one or two, by an ensemble sampler for more."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.studies.distributions import Distribution
from gearidae.studies.study import Column

LogLikelihood = Callable[[Floats], Floats]
"""Of points, shape (n, keys); shape (n,)."""

LEVELS: Final = (0.025, 0.16, 0.5, 0.84, 0.975)
"""Quantiles that are given for each key."""
SUMMARY: Final = {
    "parameter": Column(("parameter",), "1", "key"),
    "level": Column(("level",), "1", "share of the posterior below"),
    "mean": Column(("parameter",), "", "posterior mean, in the key's SI unit"),
    "standard_deviation": Column(("parameter",), "", "posterior standard deviation, likewise"),
    "quantiles": Column(("parameter", "level"), "", "posterior quantiles, likewise"),
}
"""Variables of the summary."""
_TAIL: Final = 2e-4
"""Share of the prior that a grid leaves out at each end."""
_WALKERS: Final = 16


def grid_posterior(
    priors: Sequence[Distribution], names: Sequence[str], points: int, log_likelihood: LogLikelihood
) -> xr.Dataset:
    """Posterior at the centres of cells of equal width that span the priors.

    Parameters
    ----------
    priors : sequence of Distribution
        One or two, with densities.
    names : sequence of str
        Dimensions.
    points : int
        Cells a key.
    log_likelihood : callable

    Returns
    -------
    Dataset
        ``weight``, the posterior probability of each cell, and ``log_likelihood``, along the keys.

    Raises
    ------
    SceneError
        If the observations are impossible everywhere.
    """
    axes = []
    for distribution in priors:
        low, high = distribution.quantiles(np.array([_TAIL, 1.0 - _TAIL]))
        axes.append(low + (high - low) * (np.arange(points) + 0.5) / points)
    mesh = np.meshgrid(*axes, indexing="ij")
    nodes = np.stack([table.ravel() for table in mesh], axis=1)
    likelihood = log_likelihood(nodes)
    prior = np.sum(
        [distribution.log_density(nodes[:, number]) for number, distribution in enumerate(priors)], axis=0
    )
    total = likelihood + prior
    if not np.isfinite(total.max()):
        raise SceneError("observations", "(all of them)", "are impossible for every value on the grid")
    weight = np.exp(total - total.max())
    weight /= weight.sum()
    shape = mesh[0].shape
    return xr.Dataset(
        {
            "weight": (
                tuple(names),
                weight.reshape(shape),
                {"long_name": "posterior probability", "units": "1"},
            ),
            "log_likelihood": (
                tuple(names),
                likelihood.reshape(shape),
                {"long_name": "logarithm of the likelihood", "units": "1"},
            ),
        },
        coords={name: (name, axis) for name, axis in zip(names, axes, strict=True)},
    ).merge(
        summary(
            nodes, weight, [distribution.key for distribution in priors], [np.ptp(axis[:2]) for axis in axes]
        )
    )


def sampled_posterior(
    priors: Sequence[Distribution],
    names: Sequence[str],
    steps: int,
    seed: int,
    log_likelihood: LogLikelihood,
    report: Callable[[float, int], None],
) -> xr.Dataset:
    """Draws from the posterior by emcee (Foreman-Mackey et al. 2013, doi:10.1086/670067).

    Parameters
    ----------
    priors : sequence of Distribution
        With densities.
    names : sequence of str
        Variables.
    steps : int
        Steps of each walker; the first quarter is not kept.
    log_likelihood : callable
        -inf where a value is not allowed.
    report : callable
        Called with the number of finished steps and of all steps.

    Returns
    -------
    Dataset
        A variable for each key along ``draw``, and ``log_likelihood``; attributes ``acceptance``, ``steps_kept`` (of
        each walker) and ``autocorrelation_time`` (steps between independent draws, which is found too small where
        fewer than 50 times as many are kept).

    Raises
    ------
    SceneError
        If emcee is not installed.
    """
    try:
        emcee: Any = import_module("emcee")
    except ImportError:
        raise SceneError(
            "method", "emcee", "needs a sampler: python -m pip install 'gearidae[calibrate]'"
        ) from None
    count = len(priors)
    walkers = max(_WALKERS, 4 * count)

    def log_posterior(points: Floats) -> tuple[Floats, Floats]:
        prior = np.sum(
            [distribution.log_density(points[:, number]) for number, distribution in enumerate(priors)],
            axis=0,
        )
        likelihood = np.full(len(points), -np.inf)
        inside = np.isfinite(prior)
        if inside.any():
            likelihood[inside] = log_likelihood(points[inside])
        return prior + likelihood, likelihood

    def with_blob(points: Floats) -> Floats:
        return np.stack(log_posterior(np.asarray(points)), axis=1)

    generator = np.random.default_rng(seed)
    share = generator.random((walkers, count))
    start = np.stack(
        [distribution.quantiles(share[:, number]) for number, distribution in enumerate(priors)], axis=1
    )
    sampler = emcee.EnsembleSampler(
        walkers, count, with_blob, vectorize=True, blobs_dtype=[("likelihood", float)]
    )
    sampler.random_state = np.random.RandomState(seed).get_state()
    for done, _ in enumerate(sampler.sample(start, iterations=steps), 1):
        report(float(done), steps)
    burnt = steps // 4
    draws = sampler.get_chain(discard=burnt, flat=True)
    likelihood = sampler.get_blobs(discard=burnt, flat=True)["likelihood"]
    time = float(np.max(sampler.get_autocorr_time(discard=burnt, quiet=True, tol=0)))
    made = {name: ("draw", draws[:, number]) for number, name in enumerate(names)}
    ds = xr.Dataset(made).assign(
        log_likelihood=("draw", likelihood, {"long_name": "logarithm of the likelihood", "units": "1"})
    )
    ds = ds.merge(
        summary(draws, np.full(len(draws), 1.0 / len(draws)), [distribution.key for distribution in priors])
    )
    acceptance = float(sampler.acceptance_fraction.mean())
    return ds.assign_attrs(acceptance=acceptance, steps_kept=steps - burnt, autocorrelation_time=time)


def summary(
    nodes: Floats, weight: Floats, keys: Sequence[str], widths: Sequence[float] | None = None
) -> xr.Dataset:
    """Mean, standard deviation and quantiles of each key.

    Parameters
    ----------
    nodes : ndarray, shape (n, keys)
    weight : ndarray, shape (n,)
        Adds up to 1.
    widths : sequence of float, optional
        Of the cells whose centres the nodes are, over which the weight is spread evenly.

    Returns
    -------
    Dataset
        Along ``parameter``, and ``level`` (`LEVELS`).
    """
    mean = weight @ nodes
    # a grid says nothing finer than the spread within a cell
    within = 0.0 if widths is None else np.asarray(widths) / np.sqrt(12.0)
    deviation = np.maximum(np.sqrt(weight @ (nodes - mean) ** 2), within)
    quantiles = np.empty((len(keys), len(LEVELS)))
    for number in range(len(keys)):
        values, index = np.unique(nodes[:, number], return_inverse=True)
        share = np.cumsum(np.bincount(index, weight))
        half = 0.5 * widths[number] if widths is not None else 0.0
        quantiles[number] = np.interp(LEVELS, np.r_[0.0, share], np.r_[values[0] - half, values + half])
    columns = (np.array(keys), np.array(LEVELS), mean, deviation, quantiles)
    made = zip(SUMMARY.items(), columns, strict=True)
    return xr.Dataset({name: (column.dims, value, column.attributes()) for (name, column), value in made})
