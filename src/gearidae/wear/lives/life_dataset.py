"""A life as a dataset along its passages, and what a speed sensor would show along it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.exposures import exposure_coordinates
from gearidae.archive.provenance import provenance
from gearidae.archive.select import scene_of
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import interruptible
from gearidae.scene import Scene
from gearidae.scene.friction import friction_values
from gearidae.wear.declared.life import STUDY
from gearidae.wear.lives.coverage import Coverage
from gearidae.wear.lives.cycle_jump import Life

if TYPE_CHECKING:
    from gearidae.wear.lives.rates import StateResult

SAMPLES: Final = 30_001
"""Of a signal, where the scene has none."""
_ASSESSED: Final = {
    "assessed_coverage": "most likely coverage by the signal",
    "assessed_low": "lower end of its 95 % interval",
    "assessed_high": "upper end of its 95 % interval",
}
_EXPOSURES: Final = {"contacts", "adhesion_work", "sliding_work", "friction_work", "pressure"}


def life_dataset(
    scene: Scene, coverage: Coverage, history: Life, seen: Sequence[StateResult], *, frequency: bool
) -> xr.Dataset:
    """Make the dataset of a life.

    Parameters
    ----------
    scene : Scene
        That it began with.
    seen : sequence
        What each state has shown.
    frequency : bool
        Whether to find the characteristic frequency of each state.
    """
    states, passages = np.array(history.states), np.array(history.passages)
    tables = np.array([coverage.table(state) for state in states])
    values: dict[str, Any] = {
        "passages": passages,
        "side": list(coverage.sides),
        "coverage": tables.mean(axis=(2, 3)),
        "coverage_loss": -np.array([coverage.table(result.rate) for result in seen]).mean(axis=(2, 3)),
        "verdict": [_word(result) for result in seen],
        "mean_gear_speed": [result.mean_speed for result in seen],
        "min_gear_speed": [result.min_speed for result in seen],
    }
    rubs = any(friction_values(scene).values())
    for name in _EXPOSURES if rubs else _EXPOSURES - {"friction_work"}:
        parts = np.array([coverage.table(_mean(result, name, len(states[0]))) for result in seen])
        values[f"passage_{name}"] = parts.max(axis=(2, 3)) if name == "pressure" else parts.mean(axis=(2, 3))
        if name != "pressure":
            values[f"total_{name}"] = _cumulated(passages, values[f"passage_{name}"])
    if coverage.resolved != "uniform":
        values["coverage_by_place"] = tables
    if frequency:
        values["characteristic_frequency"] = _frequencies(scene, coverage, states)
    attributes = {
        **provenance(scene, "simulated the life of the coating", swept=("coating.sam_fraction",)),
        "title": f"{scene.name}: life of the coating",
        "summary": "Coverage of the flanks against passages of their teeth, by cycle jump.",
        "resolved": coverage.resolved,
    }
    ds = STUDY.dataset(values, attributes)
    if coverage.resolved == "uniform":
        return ds
    place = exposure_coordinates(scene.replace({"run.exposures": coverage.places}))["place"]
    return ds.assign_coords(place=place, tooth=np.arange(coverage.teeth))


def _word(seen: StateResult) -> str:
    return "sticks" if seen.sticks else "turns"


def _mean(seen: StateResult, name: str, size: int) -> Floats:
    """Mean of an exposure over the starts; NaN where the gear sticks."""
    if not seen.exposures:
        return np.full(size, math.nan)
    return np.asarray(np.mean([getattr(exposure, name) for exposure in seen.exposures], axis=0))


def _cumulated(passages: Floats, rates: Floats) -> Floats:
    """Integral over passages, by the trapezoidal rule."""
    steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(passages)[:, None]
    return np.concatenate([np.zeros((1, rates.shape[1])), np.cumsum(steps, axis=0)])


def _frequencies(scene: Scene, coverage: Coverage, states: Floats) -> Floats:
    """Characteristic frequency at each state, of the first impact of a run as a coating map has it."""
    from gearidae.analysis import characteristic_frequency

    return np.array(
        [float(characteristic_frequency(signal_of(scene, coverage.changes(state)))) for state in states]
    )


def assess_life(ds: xr.Dataset, chart: xr.Dataset, *, noise: float = 0.0, seed: int = 0) -> xr.Dataset:
    """Assess a signal of each state of a life, as a speed sensor would give it.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.studies.life`.
    chart : Dataset
        From `gearidae.studies.coating_map`, of the same scene.
    noise : float, optional
        Standard deviation of white noise on the speed [rad/s].
    seed : int, optional
        Of the noise.

    Returns
    -------
    Dataset
        The life, and along ``passages`` ``assessed_coverage`` with its 95 % interval ``assessed_low`` and
        ``assessed_high`` [1], NaN where a signal does not decide, and ``assessed_verdict``.

    Raises
    ------
    SceneError
        If the dataset is no life or the chart no coating map, or a number is not allowed.
    Interrupted
        On Ctrl-C.
    """
    from gearidae.analysis import assess

    STUDY.require(ds)
    if not 0.0 <= noise < np.inf:
        raise SceneError("noise", noise, "must be a speed in rad/s, 0 or more")
    random = np.random.default_rng(seed)
    assessments = []
    with interruptible():
        for number in range(ds.sizes["passages"]):
            signal = life_signal(ds, number)
            assessments.append(assess(signal + noise * random.standard_normal(signal.size), chart))
    columns = [(assessment.sam_fraction, assessment.low, assessment.high) for assessment in assessments]
    values = np.where([[assessment.conclusive] for assessment in assessments], np.array(columns), np.nan)
    made: dict[str, Any] = {
        name: ("passages", values[:, number], {"units": "1", "long_name": words})
        for number, (name, words) in enumerate(_ASSESSED.items())
    }
    words = {"units": "1", "long_name": "verdict on the signal"}
    made["assessed_verdict"] = ("passages", [assessment.verdict for assessment in assessments], words)
    return ds.assign(made).assign_attrs(assessed_noise=float(noise))


def life_signal(ds: xr.Dataset, number: int) -> xr.DataArray:
    """Simulate the gear's speed at a state of a life.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.studies.life`.
    number : int
        Of the state, along ``passages``.

    Returns
    -------
    DataArray
        Speed [rad/s] along ``time``, from the start of the life's scene.
    """
    scene = Scene.from_dict(scene_of(ds))
    return signal_of(scene, _changes(ds.isel(passages=number)))["gear_speed"]


def signal_of(scene: Scene, changes: Mapping[str, Any]) -> xr.Dataset:
    """Simulate what a sensor records, with a coverage of the life."""
    from gearidae.runs.simulation import simulate

    changed = scene.replace({**changes, "run.stop": "time", "run.exposures": 0})
    return simulate(changed, samples=changed.run.samples if changed.run.sample_count else SAMPLES)


def _changes(state: xr.Dataset) -> dict[str, Any]:
    """What a state of a life changes in its scene."""
    if "coverage_by_place" in state:
        names = {"interface": "pinion", "pinion": "pinion", "gear": "gear"}
        changes: dict[str, Any] = {"coating.pinion_fraction": None, "coating.gear_fraction": None}
        for side in state["side"].values.tolist():
            table = state["coverage_by_place"].sel(side=side).values
            # the rows of the pinion's teeth hold what all teeth of the gear have alike
            changes[f"coating.{names[side]}_table"] = (table[:1] if side == "gear" else table).tolist()
        return changes
    shares = {side: float(state["coverage"].sel(side=side)) for side in state["side"].values.tolist()}
    if "interface" in shares:
        return {"coating.sam_fraction": shares["interface"]}
    return {f"coating.{side}_fraction": share for side, share in shares.items()}
