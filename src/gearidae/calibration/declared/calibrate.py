"""Find out what observations of gears say about keys that are not known: their posterior.

Finished runs are kept beside the output, in OUT.nc.journal, until it is written.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.dataset import dimension_names
from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.calibration.observation_files import observation_of, read_observations
from gearidae.calibration.observations import STICKS, Observation
from gearidae.calibration.posterior import SUMMARY, grid_posterior, sampled_posterior
from gearidae.errors import SceneError
from gearidae.progress import sweep_progress
from gearidae.runs.execution import RunOptions, prepared, run_kept
from gearidae.scene import describe_key
from gearidae.scene.literal import literal
from gearidae.scene.pairs import texts
from gearidae.scene.quantity import whole
from gearidae.studies.declared.ensemble import figure_names
from gearidae.studies.distributions import read_distributions
from gearidae.studies.products import open_posterior
from gearidae.studies.study import Option, Picture, Rows, Study

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.runs.run_cache import RunCache
    from gearidae.scene import Scene

log = logging.getLogger(__name__)

_ONE_CELL: Final = 0.9
"""Share of a posterior in one cell of its grid above which the cell is wider than the posterior."""
_SPREADS_AWAY: Final = 4.0
"""Uncertainties beyond all runs from which an observation is far from them."""
_EXAMPLE: Final = "'sticks=true; drive.torque=4.2e-18' or 'ring_frequency=5.2 kHz +- 0.1 kHz'"
_STEPS_WANTED: Final = 50
"""Steps to keep of each walker, over the autocorrelation time, for that time to be found (emcee's own advice)."""
METHODS: Final = ("auto", "grid", "emcee")


def calibrate(
    scene: Scene,
    priors: Mapping[str, Any],
    observations: Sequence[Observation],
    *,
    method: Literal["auto", "grid", "emcee"] = "auto",
    points: int = 41,
    steps: int = 500,
    seed: int = 0,
    **options: Unpack[RunOptions],
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
        Steps of each of emcee's walkers, of which there are 16, or four a key; the first quarter is not kept.
    seed : int, optional
        Seed of emcee.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`. With ``archive``, finished runs are kept beside it until the posterior is written.

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
    from gearidae.calibration.predicting import Predictor

    base, execution = prepared(scene, options)
    distributions = read_distributions(base, priors)
    keys = tuple(distribution.key for distribution in distributions)
    chosen = _check(method, len(keys), points, steps, seed)
    seen = _checked(observations, base, keys)
    settings = {"method": chosen, "points": points, "steps": steps, "seed": seed}
    about = _attributes(base, distributions, seen, settings)
    predictor = Predictor(base, keys, seen, execution)

    def likelihood(values: Floats, shown: bool | SweepProgress = False) -> Floats:
        figures = predictor.figures(values, shown)
        if chosen == "grid":  # a sampler comes to points that it leaves again
            for index, observation in enumerate(seen):
                _doubt_observation(observation, figures[:, index])
        parts = [observation.log_likelihood(figures[:, index]) for index, observation in enumerate(seen)]
        return np.asarray(np.sum(parts, axis=0), dtype=np.float64)

    names = list(dimension_names(keys).values())

    def work(kept: RunCache | None) -> xr.Dataset:
        predictor.kept = kept
        if chosen == "grid":
            ds = grid_posterior(
                distributions, names, points, lambda values: likelihood(values, execution.progress)
            )
            _doubt(ds["weight"], dict(zip(names, keys, strict=True)))
        else:
            with sweep_progress(execution.progress, steps) as report:
                allowed = _where_allowed(base, keys, likelihood)
                ds = sampled_posterior(distributions, names, steps, seed, allowed, report)
        for key, name in zip(keys, names, strict=True):
            info = describe_key(key)
            ds[name].attrs.update(long_name=f"{key}: {info.description}", units=info.unit)
        return ds.assign_attrs(about)

    depends = {name: about[name] for name in ("scene", "source", "calibration")}
    return run_kept(execution, predictor.store, work, depends, read=open_posterior)


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
    if not low - _SPREADS_AWAY * seen.spread <= value <= high + _SPREADS_AWAY * seen.spread:
        log.warning("no run comes near %s = %g: theirs are %g to %g", seen.figure, value, low, high)


def _where_allowed(scene: Scene, keys: tuple[str, ...], likelihood: Any) -> Any:
    """Make the likelihood of values that are not allowed zero."""

    def inside(values: Floats) -> Floats:
        result = np.full(len(values), -np.inf)
        allowed = np.array([_is_allowed(scene, keys, point) for point in values.tolist()])
        if allowed.any():
            result[allowed] = likelihood(values[allowed])
        return result

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
        whole(name, value, least)
    return ("grid" if keys <= 2 else "emcee") if method == "auto" else method


def _checked(
    observations: Sequence[Observation], scene: Scene, keys: tuple[str, ...]
) -> tuple[Observation, ...]:
    """Refuse observations that cannot be compared with runs, before anything is run."""
    seen = tuple(observations)
    if not seen or not all(isinstance(observation, Observation) for observation in seen):
        raise SceneError("observations", len(seen), "must be a list of at least one Observation")
    for observation in seen:
        observation.check(figure_names(scene))
        for key in observation.conditions:
            if key in keys:
                raise SceneError("conditions", key, "is a key to be calibrated: it cannot be a condition too")
        scene.replace(dict(observation.conditions))
    return seen


def _attributes(
    scene: Scene, priors: Sequence[Any], seen: Sequence[Observation], settings: Mapping[str, Any]
) -> dict[str, Any]:
    """What a posterior depends on, as attributes."""
    listed = [
        {
            "of": observation.figure,
            "value": str(observation.value),
            "uncertainty": str(observation.uncertainty),
            "conditions": {key: str(value) for key, value in observation.conditions.items()},
            "misjudged": observation.misjudged,
        }
        for observation in seen
    ]
    settings_used = {
        "priors": {prior.key: prior.text for prior in priors},
        "observations": listed,
        **settings,
    }
    return {
        **provenance(scene, "calibrated", swept=tuple(prior.key for prior in priors)),
        "title": f"{scene.name}: calibration of {', '.join(prior.key for prior in priors)}",
        "summary": f"Posterior of {', '.join(prior.key for prior in priors)}. Observations: {len(seen)}.",
        "calibration": json.dumps(settings_used),
    }


def calibrated_keys(posterior: xr.Dataset) -> tuple[str, ...]:
    """Return the keys that a posterior is about.

    Raises
    ------
    SceneError
        If the dataset is no posterior.
    """
    try:
        keys = tuple(map(str, json.loads(posterior.attrs["calibration"])["priors"]))
        names = dimension_names(keys).values()
        whole = bool(keys) and all(name in posterior.variables for name in names)
        if whole and ("weight" in posterior or "draw" in posterior.dims):
            return keys
    except (AttributeError, KeyError, TypeError, ValueError):
        pass
    raise SceneError("posterior", type(posterior).__name__, "must be a posterior, from studies.calibrate")


def _written(
    *,
    vary: Annotated[
        list[str],
        Option(
            "Key and what was known of it, key=normal(450 nm, 50 nm), as for ensemble; repeatable.",
            repeatable=True,
            completes="keys",
        ),
    ],
    seen: Annotated[
        list[str] | None,
        Option(
            "Observation and its conditions: 'sticks=true; drive.torque=4.2e-18', "
            "'ring_frequency=5.2 kHz +- 0.1 kHz'; repeatable.",
            repeatable=True,
        ),
    ] = None,
    observations: Annotated[Path | None, Option("File with more of them: .toml or .csv.")] = None,
) -> dict[str, Any]:
    priors = texts(vary, "--vary", "coating.sam_fraction=uniform(0.4, 0.7)")
    listed = [_observation(text) for text in seen or []]
    listed += [] if observations is None else read_observations(observations)
    if not listed:
        raise SceneError("--seen", "(missing)", f"give what was observed, {_EXAMPLE}, or --observations FILE")
    return {"priors": priors, "observations": listed}


def _announced(
    _: Scene,
    __: int | None,
    *,
    priors: Mapping[str, Any],
    observations: Sequence[Observation],
    **___: Any,
) -> str:
    count = len(observations)
    return f"{' and '.join(priors)} from {count} observation{'s' if count > 1 else ''}"


def _observation(text: str) -> Observation:
    """Read ``figure=value +- uncertainty; key=value; misjudged=share``."""
    entry: dict[str, Any] = {}
    for index, pair in enumerate(text.split(";")):
        name, equals, value = (part.strip() for part in pair.partition("="))
        if not (name and equals and value) or name in entry:
            raise SceneError("--seen", text, f"must read figure=value and conditions, such as {_EXAMPLE}")
        if index == 0:
            measured, _, uncertainty = (
                part.strip() for part in value.replace("\u00b1", "+-").partition("+-")
            )
            entry = {"of": name, "value": literal(measured)}
            entry |= {"uncertainty": literal(uncertainty)} if uncertainty else {}
        else:
            entry[name] = literal(value)
    try:
        return observation_of(entry)
    except SceneError as error:
        raise SceneError(f"--seen {error.key}", error.value, f"{error.allowed}; in {text!r}") from None


def _sentence(ds: xr.Dataset) -> str:
    words = []
    for key in ds["parameter"].values.tolist():
        low, _, middle, _, high = (
            _in_unit(value, key) for value in ds["quantiles"].sel(parameter=key).values
        )
        words.append(f"{key} is {middle}, 95 % in {low} .. {high}")
    return f"{'; '.join(words)}."


def _rows(ds: xr.Dataset) -> Rows:
    """Mean, deviation and quantiles of each key; of draws, how many are independent."""
    count = len(json.loads(ds.attrs["calibration"])["observations"])
    yield str(ds.attrs["title"]), "", f"{count} observation{'s' if count > 1 else ''}"
    for key in ds["parameter"].values.tolist():
        summary = ds.sel(parameter=key)
        low, inner_low, middle, inner_high, high = (
            _in_unit(value, key) for value in summary["quantiles"].values
        )
        spread = f"{_in_unit(float(summary['mean']), key)} +- {_in_unit(float(summary['standard_deviation']), key)}"
        yield key, spread, f"median {middle}, 68 % in {inner_low} .. {inner_high}, 95 % in {low} .. {high}"
    if "autocorrelation_time" in ds.attrs:
        time, draws = float(ds.attrs["autocorrelation_time"]), ds.sizes["draw"]
        many = f"{draws / max(time, 1.0):.2g}"
        if ds.attrs.get("steps_kept", math.inf) < _STEPS_WANTED * time:
            independent = f"fewer than {many} independent: few --steps"
        else:
            independent = f"some {many} of them independent"
        yield "draws", str(draws), independent


def _in_unit(value: float, key: str) -> str:
    unit = describe_key(key).unit
    return f"{value:.4g}" if unit == "1" else f"{value:.4g} {unit}"


STUDY = Study(
    kind="posterior",
    words="posterior",
    maker="calibrate",
    title="Posterior",
    run="calibrate",
    command=_written,
    options=("method", "points", "steps", "seed"),
    announcement=_announced,
    members=lambda priors, observations, points, **_: (priors, len(observations) * points),
    examples=(
        'gearidae calibrate mine.toml --vary "coating.sam_fraction=uniform(0.4, 0.7)" --seen sticks=true',
        'gearidae calibrate mine.toml --vary "drive.torque=normal(4.5e-18, 3e-19)" --observations seen.csv -o known.nc',
    ),
    columns=SUMMARY,
    check=calibrated_keys,
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("posterior", "Posterior of each key, and of each two"),),
)
