"""The energy balance in a dataset: an attribute of a single run, variables along the swept dimensions of a sweep."""

from __future__ import annotations

import json
import math
from typing import Any, Final

import xarray as xr

from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.records import Solution
from gearidae.scene import Scene

FRICTION_LOSSES: Final = ("drive_friction_loss", "coast_friction_loss", "pinion_hub_loss", "gear_hub_loss")
"""Losses that older archives do not have, as there was no friction."""


def balance_numbers(scene: Scene, solution: Solution) -> dict[str, float]:
    """Return a run's balance by the names of `ENERGY_BALANCE` [J]; empty if it has none that is sound."""
    balance = solution.balance
    if balance is None or not math.isfinite(balance.residual + balance.throughput):
        return {}
    bound = balance.bound(scene.run.rtol, roller=scene.roller is not None)
    return {name: getattr(balance, name) for name in ENERGY_BALANCE if name != "residual_bound"} | {
        "residual_bound": bound
    }


def balance_attribute(scene: Scene, solution: Solution) -> dict[str, str]:
    """Return the attribute ``energy_balance`` of a single run's dataset, with the time that it reaches to [s]."""
    numbers = balance_numbers(scene, solution)
    if solution.balance is None or not numbers:
        return {}
    return {"energy_balance": json.dumps({"time": solution.balance.time, **numbers}, allow_nan=False)}


def balance_in_attributes(ds: xr.Dataset) -> dict[str, Any]:
    """Read a single run's energy balance, with the time that it reaches to; empty if it has none."""
    numbers: dict[str, Any] = json.loads(ds.attrs.get("energy_balance", "{}"))
    return numbers


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
    if numbers := balance_in_attributes(ds):
        return {name: float(numbers.get(name, 0.0)) for name in ENERGY_BALANCE}
    known = [name for name in ENERGY_BALANCE if name in ds.variables or name not in FRICTION_LOSSES]
    if all(name in ds.variables and not ds[name].dims for name in known):
        found = dict.fromkeys(ENERGY_BALANCE, 0.0) | {name: float(ds[name]) for name in known}
        return None if any(map(math.isnan, found.values())) else found
    return None


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


def doubt(out_by: float) -> str:
    """Words to add to what is said of a run whose `imbalance` is above one; empty if it is not, or not known."""
    if not out_by > 1.0:
        return ""
    return f", energy balance out by {out_by:.2g} times its bound"
