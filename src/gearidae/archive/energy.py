"""The energy ledger in a dataset: an attribute of a single run, variables along the swept dimensions of a sweep."""

from __future__ import annotations

import json
import math
from typing import Any

import xarray as xr

from gearidae.archive.variables import LEDGER
from gearidae.records import Solution
from gearidae.scene import Scene

__all__ = ["ledger_attribute", "ledger_numbers", "ledger_of"]


def ledger_numbers(scene: Scene, solution: Solution) -> dict[str, float]:
    """Return a run's ledger by the names of `LEDGER` [J]; empty if it has none that is sound."""
    ledger = solution.ledger
    if ledger is None or not math.isfinite(ledger.residual + ledger.throughput):
        return {}
    bound = ledger.bound(scene.run.rtol, roller=scene.roller is not None)
    return {name: getattr(ledger, name) for name in LEDGER if name != "residual_bound"} | {
        "residual_bound": bound
    }


def ledger_attribute(scene: Scene, solution: Solution) -> dict[str, str]:
    """Return the attribute ``ledger`` of a single run's dataset, with the time that it reaches to [s]."""
    numbers = ledger_numbers(scene, solution)
    if solution.ledger is None or not numbers:
        return {}
    return {"ledger": json.dumps({"time": solution.ledger.time, **numbers}, allow_nan=False)}


def ledger_of(ds: xr.Dataset) -> dict[str, float] | None:
    """Read the energy ledger of one run.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, or one picked from a sweep.

    Returns
    -------
    dict or None
        By the names of `gearidae.archive.variables.LEDGER` [J]; None if there is none.
    """
    if "ledger" in ds.attrs:
        numbers: dict[str, Any] = json.loads(ds.attrs["ledger"])
        return {name: float(numbers[name]) for name in LEDGER}
    if all(name in ds.variables and not ds[name].dims for name in LEDGER):
        found = {name: float(ds[name]) for name in LEDGER}
        return None if any(map(math.isnan, found.values())) else found
    return None
