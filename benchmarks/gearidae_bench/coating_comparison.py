"""Where the sticking limit moves with what is assumed of the coating: pairing, thickness and law of one asperity.

The low-speed preset runs with each combination; the SAM fraction at which the gear begins to stick within the run is
bisected, and the smallest speed at half coverage is taken. With independent sides both have the fraction. Makes the
table of `docs/coating_compared.md`::

    python -m gearidae_bench.coating_comparison
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import gearidae as gd
from gearidae.scene import Scene
from gearidae_bench.sensitivity import sticking_limit

__all__ = ["Compared", "comparison", "comparison_table"]

LAWS: Final = ("jkr", "maugis")
PAIRINGS: Final = ("patches", "independent")
THICKNESSES: Final = (0.0, 2.5e-9)
RESOLUTION: Final = 0.01
_HALF: Final = 0.5


@dataclass(frozen=True, slots=True)
class Compared:
    """One set of assumptions and what follows from it.

    Attributes
    ----------
    law, pairing : str
        ``contact.asperity`` and ``coating.pairing``.
    thickness : float
        ``coating.thickness`` [m].
    sticks, turns : float
        Bracket of the SAM fraction at which the gear begins to stick; NaN where there is none.
    speed : float
        Smallest speed at half coverage [rad/s].
    """

    law: str
    pairing: str
    thickness: float
    sticks: float
    turns: float
    speed: float


def comparison(
    base: Scene | None = None,
    laws: Sequence[str] = LAWS,
    pairings: Sequence[str] = PAIRINGS,
    thicknesses: Sequence[float] = THICKNESSES,
    resolution: float = RESOLUTION,
) -> Iterator[Compared]:
    """Run every combination.

    Parameters
    ----------
    base : Scene, optional
        The low-speed preset if not given.
    laws, pairings, thicknesses : sequence, optional
        What to combine.
    resolution : float, optional
        Width of the bracket of a limit.

    Yields
    ------
    Compared
    """
    base = base or gd.preset("teodorescu2009_low_speed").replace({"run.samples": 3001})
    for law, pairing, thickness in itertools.product(laws, pairings, thicknesses):
        scene = base.replace(
            {"contact.asperity": law, "coating.pairing": pairing, "coating.thickness": thickness}
        )
        sticks, turns = sticking_limit(scene, lowest=0.0, highest=0.9, resolution=resolution)
        half = gd.simulate(scene.replace({"coating.sam_fraction": _HALF}), samples="off")
        yield Compared(law, pairing, thickness, sticks, turns, float(half["min_gear_speed"]))


def comparison_table(found: Sequence[Compared]) -> str:
    """Write the combinations as a table in Markdown."""
    lines = [
        "| asperity | pairing | thickness | sticks at a SAM fraction of | turns at | smallest speed at 0.5 |",
        "|---|---|---:|---:|---:|---:|",
    ]
    for one in found:
        ends = [f"{end:.3f}" if not math.isnan(end) else "-" for end in (one.sticks, one.turns)]
        lines.append(
            f"| `{one.law}` | {one.pairing} | {one.thickness * 1e9:g} nm | {ends[0]} | {ends[1]} "
            f"| {one.speed:.4f} rad/s |"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(comparison_table(list(comparison())))
