"""The energy balance of a run, read from its dataset, and how far it is out."""

from __future__ import annotations

import math

import xarray as xr

from gearidae.archive.variables import ENERGY_BALANCE


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
    if not all(name in ds.variables and not ds[name].dims for name in ENERGY_BALANCE):
        return None
    numbers = {name: float(ds[name]) + 0.0 for name in ENERGY_BALANCE}  # which makes 0 of -0
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


def doubt(out_by: float) -> str:
    """Words to add to what is said of a run whose `imbalance` is above one; empty if it is not, or not known."""
    if not out_by > 1.0:
        return ""
    return f", energy balance out by {out_by:.2g} times its bound"
