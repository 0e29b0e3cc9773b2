"""How often a coating is read wrong where teeth differ: ``python -m gearidae_pages.assessment_of_gears``.

Prints the table of ``docs/assess.md``: records of gears of one design against a map over seeds and one of teeth
without errors (some minutes).
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
import xarray as xr

import gearidae as gd

__all__ = ["counted", "markdown"]

_FRACTIONS = (0.97, 0.9, 0.8, 0.72, 0.64)
_MAP = np.round(np.arange(1.0, 0.549, -0.05), 3).tolist()
_GEARS = 20
_FIRST = 1000
"""Seed of the map's first gear: the records are of others, from 0 on."""
_LOW = gd.preset("teodorescu2009_low_speed").replace({"mesh.pitch_error_rms": "3 nm"})


def counted(
    fraction: float, charts: Sequence[xr.Dataset], gears: int = _GEARS
) -> list[tuple[int, int, float]]:
    """Assess records of so many gears against each map.

    Returns
    -------
    list of tuple
        For each map the clear verdicts, the wrong ones of them, and their median width (NaN without any).
    """
    found = []
    records = [
        gd.simulate(_LOW.replace({"mesh.pitch_error_seed": seed, "coating.sam_fraction": fraction}))
        for seed in range(gears)
    ]
    for chart in charts:
        clear = [one for one in (gd.analysis.assess(record, chart) for record in records) if one.conclusive]
        wrong = sum(not one.low <= fraction <= one.high for one in clear)
        widths = [one.high - one.low for one in clear]
        found.append((len(clear), wrong, float(np.median(widths)) if widths else float("nan")))
    return found


def markdown() -> str:
    """Make the table."""
    drawn = _LOW.replace({"mesh.pitch_error_seed": _FIRST})
    over_seeds = gd.analysis.coating_map(drawn, _MAP, seeds=_GEARS, progress=False)
    alike = gd.analysis.coating_map(_LOW.replace({"mesh.pitch_error_rms": 0.0}), _MAP, progress=False)
    lines = [
        "| SAM fraction | map over seeds: clear | wrong | width | map without errors: clear | wrong |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for fraction in _FRACTIONS:
        (clear, wrong, width), (bare, bare_wrong, _) = counted(fraction, (over_seeds, alike))
        lines.append(f"| {fraction:.2f} | {clear} | {wrong} | {width:.3f} | {bare} | {bare_wrong} |")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(f"{markdown()}\n")
