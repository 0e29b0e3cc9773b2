"""Which stage holds a train at rest: starting torques of many trains of one design, the table of the page on trains.

Each train has teeth that were mounted anyhow (the phases of its meshes) and a coverage of its own in each mesh::

    python -m gearidae_pages.train_starting 100
"""

from __future__ import annotations

import sys
from collections import Counter
from typing import Any, Final

import numpy as np
import xarray as xr
from scipy.stats import binomtest

import gearidae as gd

__all__ = ["design", "drawn", "shown"]

MESHES: Final = ("first", "second", "third")
LOWEST: Final = 1e-15
"""Torque below which nothing is looked for [N m]."""
LOAD: Final = 1e-10
"""Dry load [N m]: 2.1 pN m at the engine."""
COVERAGES: Final = ((0.5, 1.0), (0.0, 0.5))
"""Ranges of the coverage of each mesh, whole and worn."""


def design() -> gd.Scene:
    """Make a reduction of 48:1 in three stages, of the paper's gears, with a dry load."""
    gears = gd.preset("teodorescu2009")
    tables: dict[str, Any] = gears.to_dict()
    pair = tables.pop("gears")
    tables["name"] = "reduction of 48:1"
    tables["mesh"] |= {
        "module": gears.geometry.module,
        "pressure_angle": gears.geometry.pressure_angle,
        "face_width": pair["face_width"],
        "radius_force": False,
    }
    tables["shafts"] = {
        "engine": {"teeth": 19, "inertia": 1.5e-20},
        "fast": {"gears": {"wheel": 76, "small": 19}, "inertia": 6e-20},
        "slow": {"gears": {"wheel": 57, "small": 19}, "inertia": 4e-20},
        "output": {"teeth": 76, "inertia": 6e-20},
    }
    gear = "engine", "fast.wheel", "fast.small", "slow.wheel", "slow.small", "output"
    tables["meshes"] = {
        name: {"driver": gear[2 * k], "driven": gear[2 * k + 1]} for k, name in enumerate(MESHES)
    }
    tables["load"] = {"torque": LOAD}
    return gd.Scene.from_dict(tables)


def drawn(scene: gd.Scene, count: int, coverage: tuple[float, float], seed: int = 0) -> list[xr.Dataset]:
    """Find the starting torques of trains with any phases, and with coverages in a range."""
    numbers = np.random.default_rng(seed)
    torques = []
    for _ in range(count):
        changes: dict[str, float] = {}
        for mesh in MESHES:
            changes[f"meshes.{mesh}.phase"] = numbers.uniform()
            changes[f"meshes.{mesh}.coating.sam_fraction"] = numbers.uniform(*coverage)
        torques.append(
            gd.studies.starting_torque(scene.replace(changes), lowest=LOWEST, simulated=False, progress=False)
        )
    return torques


def of(count: int, total: int) -> str:
    """Write a count with the 95 % interval of its share, Wilson's."""
    interval = binomtest(count, total).proportion_ci(method="wilson")
    return f"{count} of {total} ({100.0 * interval.low:.0f} to {100.0 * interval.high:.0f} %)"


def shown(torques: list[xr.Dataset]) -> str:
    """Say which stage holds, how often, and what the trains need."""
    parts = xr.concat([ds["parts"].isel(sam_fraction=0, drop=True) for ds in torques], "train")
    adhesion = parts.sel(part=[f"adhesion of {mesh}" for mesh in MESHES])
    held = (adhesion.sum("part") > 0.0).values
    most = [MESHES[k] for k in np.argmax(adhesion.values, axis=1)[held]]
    counts = Counter(most)
    totals = np.array([float(ds["static_torque"][0]) for ds in torques])
    dry = float(parts.sel(part="dry resistance")[0])
    lines = ["| stage | holds most in | mean share of what adhesion takes |", "|---|---|---|"]
    shares = adhesion[held] / adhesion[held].sum("part")
    for mesh in MESHES:
        share = float(shares.sel(part=f"adhesion of {mesh}").mean())
        lines.append(f"| {mesh} | {of(counts[mesh], len(torques))} | {100.0 * share:.0f} % |")
    lines.append(f"| none | {of(len(torques) - int(held.sum()), len(torques))} | |")
    low, middle, high = np.quantile(totals - dry, [0.1, 0.5, 0.9])
    several = int(((shares > 0.05).sum("part") > 1).sum())
    lines += [
        "",
        f"beyond the dry load's {dry:.3g} N m, 10, 50 and 90 % start below {low:.3g}, {middle:.3g}, {high:.3g} N m",
        f"two stages or more hold at once in {several}",
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    for coverage in COVERAGES:
        low, high = coverage
        sys.stdout.write(f"coverage {low:g} to {high:g}\n{shown(drawn(design(), count, coverage))}\n")


if __name__ == "__main__":
    main()
