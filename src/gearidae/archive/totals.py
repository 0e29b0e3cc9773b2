"""The totals of runs in a dataset: variables without a dimension of a single run, along the swept ones of a sweep."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from gearidae.archive.extremes import standstills_as_text
from gearidae.archive.variables import (
    ENERGY_TOTALS,
    EXTREMES,
    ROLLER_EXTREMES,
    STANDSTILL_LIST,
    extreme_names,
)
from gearidae.records import EnergyBalance, Extremes
from gearidae.scene import Scene
from gearidae.scene.sampled import columns_of


def total_variables(
    scene: Scene,
    scenes: Sequence[Scene],
    runs: Sequence[Any],
    dims: tuple[str, ...] = (),
    shape: tuple[int, ...] = (),
) -> dict[Hashable, Any]:
    """Make the variables of the runs' energy balances and extremes.

    Parameters
    ----------
    scene : Scene
        That the runs were derived from.
    scenes, runs : sequence
        Of each run its scene, and its `Solution` or `Checkpoint`.
    dims, shape : tuple, optional
        Swept dimensions and their lengths.

    Returns
    -------
    dict
        Name to dimensions, values and attributes. NaN, and 0 of counts, where a run has left nothing; without what none
        of them has left.
    """

    def stacked(values: Iterable[Any], dtype: Any) -> Any:
        array = np.empty(len(runs), dtype=dtype)
        array[:] = list(values)
        return array.reshape(shape)

    made: dict[Hashable, Any] = {}
    balances = [_energies(each, run.balance) for each, run in zip(scenes, runs, strict=True)]
    for name, variable in ENERGY_TOTALS.items() if any(balances) else ():
        energies = (numbers.get(name, math.nan) for numbers in balances)
        made[name] = (dims, stacked(energies, variable.dtype), variable.attributes)
    extremes = [run.extremes or Extremes() for run in runs]
    if all(run.extremes is None for run in runs):
        return made
    roller, sampled = scene.roller is not None, columns_of(scene)
    for name in extreme_names(scene):
        if name in sampled:  # of elastic bodies
            continue
        field = "smallest_separation" if name == "min_separation" else name
        variable = (ROLLER_EXTREMES if roller else EXTREMES)[name]
        values = stacked((each[field] for each in extremes), variable.dtype)
        made[name] = (dims, values, variable.attributes)
    if not roller:
        lists = stacked(map(standstills_as_text, extremes), object)
        made[STANDSTILL_LIST.name] = (dims, lists, STANDSTILL_LIST.attributes)
    return made


def _energies(scene: Scene, balance: EnergyBalance | None) -> Mapping[str, float]:
    """Energy balance with residual and bound; empty without one that is finite."""
    if balance is None or not math.isfinite(balance.residual + balance.throughput):
        return {}
    bound = balance.bound(scene.run.rtol, roller=scene.roller is not None)
    derived = {"residual": balance.residual, "residual_bound": bound, "efficiency": balance.efficiency}
    return {**balance, **derived}
