"""How much the reproduced figures move with each number that the paper does not print.

One number at a time is changed by a tenth either way; the larger change of each quantity counts. Makes a table of
`docs/validation.md`::

    python -m gearidae_pages.figure_sensitivity
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

import gearidae as gd
from gearidae.scene import Scene

__all__ = ["INFERRED", "QUANTITIES", "Moved", "Quantity", "figure_changes", "figure_table"]

_PART: Final = 0.1
"""Change of a number, in parts of itself."""

INFERRED: Final[Mapping[str, str]] = {
    "surface.asperity_radius": "tip radius",
    "surface.asperity_density": "asperity density",
    "gears.pressure_angle": "pressure angle",
    "mesh.tip_relief_radius": "tip rounding",
    "initial.gap": "start: gap",
    "initial.mesh_phase": "start: phase",
    "drive.torque": "torque",
    "roller.mass": "roller's mass",
}
"""Keys of the numbers that were fitted or inferred, and their names. The torque was for the low speed only."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number that a figure shows.

    Attributes
    ----------
    figure, name, unit : str
    scene : Scene
    of : callable
        From the scene to the number, in `unit`.
    keys : tuple of str
        Those of `INFERRED` that it may depend on.
    """

    figure: str
    name: str
    unit: str
    scene: Scene
    of: Callable[[Scene], float]
    keys: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Moved:
    """A quantity as it stands, and its largest relative change by key."""

    quantity: Quantity
    value: float
    changes: Mapping[str, float]


def _mean_speed(scene: Scene) -> float:
    """Mean over the last eight periods of the drive's 10 kHz, so that neither start nor ripple counts [rad/s]."""
    ds = gd.simulate(scene)
    return float(ds["gear_speed"].sel(time=slice(0.2e-3, None)).mean())


def _ripple(scene: Scene) -> float:
    """Highest minus lowest speed over the same periods [rad/s]."""
    speed = gd.simulate(scene)["gear_speed"].sel(time=slice(0.2e-3, None))
    return float(speed.max() - speed.min())


def _slow_mean(scene: Scene) -> float:
    """Median speed of the run [rad/s]."""
    return float(gd.simulate(scene)["gear_speed"].median())


def _first_ring(scene: Scene) -> float:
    """Frequency after the first impact [Hz]."""
    return float(gd.analysis.characteristic_frequency(gd.simulate(scene)))


def _peak_force(scene: Scene) -> float:
    """Largest repulsion [uN]."""
    return 1e6 * float(gd.simulate(scene)["force"].max())


_HIGH = gd.preset("teodorescu2009")
_LOW = gd.preset("teodorescu2009_low_speed")
_MESH = tuple(INFERRED)[:6]
_SLOW = tuple(INFERRED)[:7]
_ROLLER = ("surface.asperity_radius", "surface.asperity_density", "roller.mass")

QUANTITIES: Final[Sequence[Quantity]] = (
    Quantity("2a", "peak force at 0.01 m/s, bare", "uN", gd.preset("roller_slow"), _peak_force, _ROLLER),
    Quantity("2b", "peak force at 0.1 m/s, bare", "uN", gd.preset("roller_fast"), _peak_force, _ROLLER),
    Quantity("4", "mean speed, SAM", "rad/s", _HIGH, _mean_speed, _MESH),
    Quantity("4, 5", "ripple, SAM, highest less lowest", "rad/s", _HIGH, _ripple, _MESH),
    Quantity("7", "speed, SAM 100 %", "rad/s", _LOW, _slow_mean, _SLOW),
    *(
        Quantity(
            figure,
            f"characteristic frequency, SAM {100 * fraction:g} %",
            "Hz",
            _LOW.replace({"coating.sam_fraction": fraction}),
            _first_ring,
            _SLOW,
        )
        for figure, fraction in (("9", 1.0), ("10", 0.8), ("10", 0.6), ("10", 0.5))
    ),
)


def figure_changes(quantities: Sequence[Quantity] = QUANTITIES) -> list[Moved]:
    """Change each inferred number by a tenth either way.

    Parameters
    ----------
    quantities : sequence of Quantity, optional

    Returns
    -------
    list of Moved
    """
    moves = []
    for quantity in quantities:
        whole = quantity.of(quantity.scene)
        changes = {}
        for key in quantity.keys:
            table, name = key.split(".")
            standing = float(getattr(getattr(quantity.scene, table), name))
            moved = [
                quantity.of(quantity.scene.replace({key: standing * (1.0 + part)}))
                for part in (-_PART, _PART)
            ]
            changes[key] = float(max(np.abs(np.array(moved) / whole - 1.0)))
        moves.append(Moved(quantity, whole, changes))
    return moves


def figure_table(moves: Sequence[Moved]) -> str:
    """Write changes as a table in Markdown, in per cent; empty where a quantity cannot depend on a number."""
    lines = [
        "| figure | quantity | as it stands | " + " | ".join(INFERRED.values()) + " |",
        "|---|---|---:|" + "---:|" * len(INFERRED),
    ]
    for moved in moves:
        cells = [_per_cent(moved.changes[key]) if key in moved.changes else "" for key in INFERRED]
        quantity = moved.quantity
        stands = f"{moved.value:.4g} {quantity.unit}"
        lines.append(f"| {quantity.figure} | {quantity.name} | {stands} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _per_cent(part: float) -> str:
    """Write a relative change with two digits."""
    if part < 1e-4:
        return "< 0.01 %"
    return f"{100.0 * part:.2g} %" if part < 0.995 else f"{100.0 * part:.0f} %"


if __name__ == "__main__":
    sys.stdout.write(figure_table(figure_changes()))
