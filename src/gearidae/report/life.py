"""The report on the life of a coating: its steps, and a viewer with a slider over passages."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.report import html
from gearidae.report.tables import law_table
from gearidae.scene.prefixes import with_prefix


def life_table(ds: xr.Dataset) -> str:
    """List the steps of a life."""
    sides = [str(side) for side in ds["side"].values]
    headings = ["passages", *(f"coverage, {side} (%)" for side in sides), "verdict"]
    headings += ["mean speed (rad/s)", "smallest speed (rad/s)"]
    if "characteristic_frequency" in ds:
        headings.append("ring frequency")
    rows = []
    for number in range(ds.sizes["passages"]):
        state = ds.isel(passages=number)
        row = [_count(state["passages"]), *(f"{100.0 * share:.4g}" for share in state["coverage"].values)]
        row += [str(state["verdict"].values), f"{float(state['mean_gear_speed']):.5g}"]
        row.append(f"{float(state['min_gear_speed']):.5g}")
        if "characteristic_frequency" in ds:
            rings = float(state["characteristic_frequency"])
            row.append("-" if math.isnan(rings) else with_prefix(rings, "Hz", 4))
        rows.append(row)
    numeric = [column for column in range(len(headings)) if column != 1 + len(sides)]
    return html.table(headings, rows, caption="Steps of the life", numeric=numeric) + law_table(ds)


def life_viewer(ds: xr.Dataset) -> str:
    """Place the viewer and its data."""
    return (
        '<div id="life-viewer"><p class="hint">Move the slider over the passages; between two steps of the life '
        "coverage and frequency are interpolated.</p></div>\n"
        "<noscript><p>The viewer needs JavaScript; the pictures below do not.</p></noscript>\n"
        + html.json_block("life-data", pack_life(ds))
    )


def pack_life(ds: xr.Dataset) -> dict[str, Any]:
    """Pack a life for its viewer.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.life`.

    Returns
    -------
    dict
        ``passages``, ``sides``, and a number for each step: ``coverage`` of each side, ``verdict``, ``mean`` and
        ``smallest`` speed [rad/s], ``frequency`` [Hz] or null; ``sticksBy`` or null; with a resolved coverage
        ``places`` [m], ``teeth``, ``low``, ``high`` and ``tables``: for each side base64 text of little-endian float32
        numbers over passages, tooth and place.
    """
    data: dict[str, Any] = {
        "passages": ds["passages"].values.tolist(),
        "sides": [str(side) for side in ds["side"].values],
        "coverage": [_numbers(ds["coverage"].sel(side=side).values) for side in ds["side"].values],
        "verdict": [str(verdict) for verdict in ds["verdict"].values],
        "mean": _numbers(ds["mean_gear_speed"].values),
        "smallest": _numbers(ds["min_gear_speed"].values),
        "frequency": None,
        "sticksBy": None,
    }
    if "characteristic_frequency" in ds:
        data["frequency"] = _numbers(ds["characteristic_frequency"].values)
    if ds.attrs.get("ending") == "sticks":
        data["sticksBy"] = float(ds.attrs["passages_to_sticking"])
    if "coverage_by_place" in ds:
        tables = ds["coverage_by_place"].transpose("side", "passages", "tooth", "place").values
        data |= {
            "places": ds["place"].values.tolist(),
            "teeth": int(ds.sizes["tooth"]),
            "low": float(tables.min()),
            "high": float(tables.max()),
            "tables": [html.numbers(table) for table in tables],
        }
    return data


def _numbers(values: NDArray[np.float64]) -> list[float | None]:
    """Numbers as JSON knows them."""
    return [float(value) if np.isfinite(value) else None for value in values]


def _count(passages: Any) -> str:
    return f"{float(passages):.4g}"
