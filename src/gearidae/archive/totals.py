"""The totals of runs in a dataset, written and read: energy balance and extremes.

They are variables without a dimension of a single run, and along the swept ones of a sweep.
"""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.variables import (
    ENERGY_BALANCE,
    ENERGY_TOTALS,
    EXTREMES,
    ROLLER_EXTREMES,
    STANDSTILL_LIST,
    extreme_names,
)
from gearidae.records import EnergyBalance, Extremes
from gearidae.records.standing import COLUMNS
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
    balances = [_energies(member, run.balance) for member, run in zip(scenes, runs, strict=True)]
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
        values = stacked((extreme[field] for extreme in extremes), variable.dtype)
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


def standstills_as_text(extremes: Extremes) -> str:
    """Write the standstills of a run as JSON, which has no NaN: the end of one that lasts is null."""
    plain = [None if math.isnan(number) else number for number in extremes.standstill_list]
    return json.dumps([plain[k : k + len(COLUMNS)] for k in range(0, len(plain), len(COLUMNS))])


def standstills_from_text(text: str) -> list[list[float]]:
    """Read what `standstills_as_text` has written."""
    return [[math.nan if number is None else float(number) for number in row] for row in json.loads(text)]


def extremes_of(run: xr.Dataset) -> Extremes | None:
    """Read the extremes of one run.

    Parameters
    ----------
    run : xarray.Dataset
        A single run, or one picked from a sweep.

    Returns
    -------
    Extremes or None
        None if there are none: the run produced nothing, or has left no checkpoint yet.
    """
    if "final_speed" not in run.variables or math.isnan(float(run["final_speed"])):
        return None
    known = [name for name in EXTREMES if name in run.variables and name != "min_separation"]
    return Extremes({name: run.variables[name].values.item() for name in known})


def balance_of(ds: xr.Dataset) -> dict[str, float] | None:
    """Read the energy balance of one run.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, or one picked from a sweep.

    Returns
    -------
    dict or None
        By the names of `gearidae.archive.variables.ENERGY_BALANCE` [J]; None if there is none.
    """
    # `variables` makes no arrays with coordinates, which take 30 us a name
    kept = {name: ds.variables[name] for name in ENERGY_BALANCE if name in ds.variables}
    if len(kept) < len(ENERGY_BALANCE) or any(variable.dims for variable in kept.values()):
        return None
    numbers = {name: float(variable.values) + 0.0 for name, variable in kept.items()}  # which makes 0 of -0
    return None if any(map(math.isnan, numbers.values())) else numbers


def energy_balance(ds: xr.Dataset) -> dict[str, float] | None:
    """Read the energy balance of one run, as `balance_of`, with the ``time`` that it reaches to [s]."""
    numbers = balance_of(ds)
    return numbers and {"time": float(ds["reached"]), **numbers}


def imbalance(residual: float, bound: float) -> float:
    """Size of a residual over its bound [1]; NaN without either, and 0 where nothing has moved."""
    if residual == 0.0:
        return 0.0
    return abs(residual) / bound if bound != 0.0 else math.inf


def imbalance_of(ds: xr.Dataset) -> float:
    """Size of the energy balance's residual over its bound, of one run [1].

    Parameters
    ----------
    ds : xarray.Dataset
        As in `balance_of`.

    Returns
    -------
    float
        NaN if there is no balance.
    """
    kept = balance_of(ds)
    return math.nan if kept is None else imbalance(kept["residual"], kept["residual_bound"])


def imbalance_words(out_by: float) -> str:
    """Words to add to what is said of a run whose `imbalance` is above one; empty if it is not, or not known."""
    if not out_by > 1.0:
        return ""
    return f", energy balance out by {out_by:.2g} times its bound"
