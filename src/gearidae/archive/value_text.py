"""Values of keys and labels of runs as tables on the terminal and in the report list them, with their units."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import xarray as xr

from gearidae.scene.prefixes import with_prefix

_MOST_NAMED = 12
_PREFIXED = ("m", "s", "N", "J", "Pa", "Hz", "W")


def value_text(value: Any, unit: str) -> str:
    """Write the value of a key; of a list, which may have thousands of knots, no more than its ends."""
    if isinstance(value, list):
        return values_text(value, "")
    if isinstance(value, float) and unit == "rad":
        return f"{math.degrees(value):.6g} deg"
    if isinstance(value, float) and unit == "1/m^2":
        return f"{1e-12 * value:.6g} 1/um^2"
    if isinstance(value, float) and unit not in ("", "1"):
        return measure_text(value, unit)
    return number_text(value) if isinstance(value, (int, float, str)) else json.dumps(value)


def coverage_text(share: float) -> str:
    """Write the covered share of the flanks."""
    return f"SAM {100.0 * share:.4g} %"


def values_text(values: list[Any], unit: str) -> str:
    """Write several values; of many, the first and the last."""
    shown = [
        value_text(value, unit)
        for value in (values if len(values) <= _MOST_NAMED else [*values[:6], *values[-3:]])
    ]
    if len(values) > _MOST_NAMED:
        shown.insert(6, f"... ({len(values)} in all) ...")
    return ", ".join(shown)


def label_cells(ds: xr.Dataset, label: dict[str, Any]) -> list[str]:
    """Write the swept values of a run, with their units."""
    return [value_text(value, str(ds[dim].attrs.get("units", "1"))) for dim, value in label.items()]


def measure_text(value: Any, unit: str) -> str:
    """Write a quantity with a prefix; texts have none, nor have units that take none."""
    if isinstance(value, str) or unit.split(" ")[0].split("/")[0].split("^")[0] not in _PREFIXED:
        return f"{number_text(value)} {unit}".rstrip()
    return with_prefix(float(value), unit, 6)


def number_text(value: Any) -> str:
    """Write a number with six digits at most, and anything else as it is."""
    if isinstance(value, (float, np.floating)):
        return "-" if math.isnan(value) else f"{value:.6g}"
    return str(value)
