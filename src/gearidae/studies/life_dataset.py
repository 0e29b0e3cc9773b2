"""A life as a dataset along its passages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.exposures import exposure_coordinates
from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.scene.friction import friction_values
from gearidae.studies.cycle_jump import Life
from gearidae.studies.declared.life import STUDY
from gearidae.studies.life_coverage import Coverage
from gearidae.studies.life_signals import signal_of

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.studies.life_rates import StateResult

_EXPOSURES: Final = {"contacts", "adhesion_work", "sliding_work", "friction_work", "pressure"}


def life_dataset(
    scene: Scene, coverage: Coverage, found: Life, seen: Sequence[StateResult], *, frequency: bool
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
    states, passages = np.array(found.states), np.array(found.passages)
    tables = np.array([coverage.table(state) for state in states])
    values: dict[str, Any] = {
        "passages": passages,
        "side": list(coverage.sides),
        "coverage": tables.mean(axis=(2, 3)),
        "coverage_loss": -np.array([coverage.table(each.rate) for each in seen]).mean(axis=(2, 3)),
        "verdict": [_word(each) for each in seen],
        "mean_gear_speed": [each.mean_speed for each in seen],
        "min_gear_speed": [each.min_speed for each in seen],
    }
    rubs = any(friction_values(scene).values())
    for name in _EXPOSURES if rubs else _EXPOSURES - {"friction_work"}:
        parts = np.array([coverage.table(_mean(each, name, len(states[0]))) for each in seen])
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
    return np.asarray(np.mean([getattr(each, name) for each in seen.exposures], axis=0))


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
