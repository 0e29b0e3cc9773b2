"""A life as a dataset along its passages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.exposures import exposure_coordinates
from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.scene.friction import friction_values
from gearidae.studies.cycle_jump import Life
from gearidae.studies.life_coverage import Coverage
from gearidae.studies.life_signals import signal_of

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.studies.life_rates import StateResult

_EXPOSURES = {
    "contacts": ("m-2", "asperity contacts made on coated flank in a passage, per area of it"),
    "adhesion_work": ("J m-2", "energy lost to adhesion on coated flank in a passage, per area of it"),
    "sliding_work": ("J m-2", "normal force times sliding distance in a passage, per area"),
    "friction_work": ("J m-2", "energy lost to friction of the flanks in a passage, per area"),
    "pressure": ("Pa", "largest nominal pressure"),
}


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
    states = np.array(found.states)
    tables = np.array([coverage.table(state) for state in states])
    dims = ("passages", "side")
    variables: dict[str, Any] = {
        "coverage": (dims, tables.mean(axis=(2, 3)), _about("1", "mean covered share of the flanks")),
        "coverage_loss": (
            dims,
            -np.array([coverage.table(each.rate) for each in seen]).mean(axis=(2, 3)),
            _about("1", "share lost in a passage"),
        ),
        "verdict": ("passages", [_word(each) for each in seen], _about("1", "what the gear does")),
        "mean_gear_speed": (
            "passages",
            [each.mean_speed for each in seen],
            _about("rad s-1", "mean speed of the gear"),
        ),
        "min_gear_speed": (
            "passages",
            [each.min_speed for each in seen],
            _about("rad s-1", "smallest speed of the gear"),
        ),
    }
    rubs = any(friction_values(scene).values())
    for name, (unit, meaning) in _EXPOSURES.items():
        if name == "friction_work" and not rubs:
            continue
        values = np.array([coverage.table(_mean(each, name, len(states[0]))) for each in seen])
        together = values.max(axis=(2, 3)) if name == "pressure" else values.mean(axis=(2, 3))
        variables[f"passage_{name}"] = (dims, together, _about(unit, meaning))
        if name != "pressure":
            summed = _cumulated(np.array(found.passages), together)
            text = meaning.replace(" in a passage", "").replace("made ", "made so far ")
            variables[f"total_{name}"] = (dims, summed, _about(unit, f"{text}, since the beginning"))
    if coverage.resolved != "uniform":
        text = "covered share by tooth of the pinion and place along the flank"
        variables["coverage_by_place"] = (("passages", "side", "tooth", "place"), tables, _about("1", text))
    if frequency:
        variables["characteristic_frequency"] = (
            "passages",
            _frequencies(scene, coverage, states),
            _about("Hz", "frequency of the first impact response"),
        )
    passages = _about("1", "passages of each tooth of the pinion")
    coords: dict[str, Any] = {
        "passages": ("passages", found.passages, passages),
        "side": list(coverage.sides),
    }
    if coverage.resolved != "uniform":
        own = exposure_coordinates(scene.replace({"run.exposures": coverage.places}))
        coords["place"] = own["place"]
        coords["tooth"] = np.arange(coverage.teeth)
    return xr.Dataset(
        variables,
        coords=coords,
        attrs={
            **provenance(scene, "simulated the life of the coating", swept=("coating.sam_fraction",)),
            "title": f"{scene.name}: life of the coating",
            "summary": "Coverage of the flanks against passages of their teeth, by cycle jump.",
            "resolved": coverage.resolved,
        },
    )


def _about(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}


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
