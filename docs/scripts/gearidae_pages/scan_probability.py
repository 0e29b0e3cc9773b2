"""From height maps to the probability that gears stick, within more and more mesh exits.

Four synthetic scans of one spectrum give the asperities' numbers with their spread; the gears of `cases/low_speed.toml`
run with surfaces and coverages drawn from there until they stick or have had the time of 1,000 mesh exits. Makes the
table of `docs/howto_ensembles.md`, some minutes on two cores::

    python -m gearidae_pages.scan_probability
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Final

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae.scene import Scene

__all__ = ["asperities_of_scans", "members", "probability_table", "waiting"]

EXITS: Final = (10, 30, 100, 300, 1000)
MEMBERS: Final = 64
_CASE: Final = Path(__file__).parents[3] / "cases" / "low_speed.toml"


def asperities_of_scans(scans: int = 4) -> dict[str, str]:
    """Distributions of the surface's keys from synthetic scans of one spectrum."""
    maps = [
        gd.surfaces.gaussian_map(256, 2e-6, 6e-9, shortest=80e-9, longest=500e-9, seed=seed)
        for seed in range(scans)
    ]
    surfaces = [gd.surface_from(heights, "2 um", cutoff="120 nm").settings for heights in maps]
    drawn = {}
    for key in ("surface.roughness", "surface.asperity_density", "surface.asperity_radius"):
        values = [float(settings[key]) for settings in surfaces]
        drawn[key] = f"normal({np.mean(values)}, {np.std(values, ddof=1)})"
    return drawn


def waiting(exits: int) -> Scene:
    """The gears of the case, which run until they stick, or for the time of some mesh exits at their first speed."""
    scene = gd.load_case(_CASE)
    assert scene.gears is not None
    assert scene.initial is not None
    wait = exits * 2.0 * math.pi / (scene.gears.gear_teeth * scene.initial.gear_speed)
    return scene.replace({"run.stop": "sticks", "run.duration": wait})


def members(exits: int = EXITS[-1], size: int = MEMBERS, jobs: int | None = None) -> xr.Dataset:
    """Run the ensemble: surfaces from the scans, coverage between 0.3 and 0.8."""
    drawn = {**asperities_of_scans(), "coating.sam_fraction": "uniform(0.3, 0.8)"}
    jobs = jobs or os.cpu_count() or 1
    # each member has tables of the force law of its own, which threads cannot make side by side
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as executor:
        return gd.studies.ensemble(waiting(exits), drawn, size, seed=1, executor=executor)


def probability_table(ds: xr.Dataset, exits: Sequence[int] = EXITS) -> str:
    """Write the probability within each number of mesh exits as a table in Markdown.

    Parameters
    ----------
    ds : Dataset
        An ensemble whose runs ended where they stuck.
    exits : sequence of int
        Mesh exits to wait for, at most as many as the runs had time for.
    """
    lines = [
        "| within mesh exits | members that stick | probability | 95 % between |",
        "|---:|---:|---:|---|",
    ]
    for count in exits:
        early = ds.assign(sticks=ds["sticks"].where(ds["stick_exits"] <= count, 0.0))
        share = gd.studies.sticking_probability(early)
        low, high = float(share["low"]), float(share["high"])
        lines.append(
            f"| {count} | {int(share['stuck'])} of {int(share['members'])} | {float(share['probability']):.2f} "
            f"| {low:.2f} and {high:.2f} |"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(probability_table(members()))
