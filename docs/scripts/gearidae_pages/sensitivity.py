"""How much the sticking limit of the low-speed preset moves with every number that was not printed.

For each key and value the SAM fraction is bisected at which the gear begins to stick within the run. Makes the table of
`docs/validation.md`::

    python -m gearidae_pages.sensitivity
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.scene import Scene

__all__ = ["CHANGES", "Limit", "sensitivities", "sensitivity_table", "sticking_limit"]

RESOLUTION: Final = 0.005
"""Width of the bracket of a limit."""
_LOWEST, _HIGHEST = 0.2, 0.9
"""Fractions between which the limit is sought."""
_SAMPLES: Final = 3001

CHANGES: Final[Mapping[str, Sequence[float]]] = {
    "surface.asperity_radius": (0.9, 0.95, 1.05, 1.1),
    "surface.asperity_density": (0.9, 1.1),
    "surface.roughness": (0.9, 0.95, 1.05, 1.1),
    "surface.energy": (0.9, 0.95, 1.05, 1.1),
    "coating.energy": (0.9, 1.1),
    "mesh.tip_relief_radius": (0.5, 0.9, 1.1, 2.0),
    "gears.pressure_angle": (0.9, 0.95, 1.05, 1.1, 1.25),
    "load.drag": (0.9, 1.1),
    "drive.torque": (0.9, 1.1),
    "initial.gear_speed": (0.9, 1.1),
    "initial.gap": (0.9, 1.1),
    "initial.mesh_phase": (0.0, 1.0, 2.0, 3.0),
}
"""Factors on the preset's value of a key."""


@dataclass(frozen=True, slots=True)
class Limit:
    """Where a gear begins to stick.

    Attributes
    ----------
    key : str
        Key that was changed; empty for the preset as it stands.
    value : float
        Its value, SI.
    factor : float
        That over the preset's.
    sticks, turns : float
        Bracket: SAM fractions at which the gear sticks, and at which it turns. NaN where it does neither within the
        range searched.
    """

    key: str
    value: float
    factor: float
    sticks: float
    turns: float

    @property
    def middle(self) -> float:
        """Middle of the bracket [1]."""
        return 0.5 * (self.sticks + self.turns)


def sticking_limit(
    scene: Scene, *, lowest: float = _LOWEST, highest: float = _HIGHEST, resolution: float = RESOLUTION
) -> tuple[float, float]:
    """Bisect the SAM fraction at which a gear begins to stick within the scene's duration.

    Parameters
    ----------
    scene : Scene
        A gear pair.
    lowest, highest : float, optional
        Fractions at which it sticks, and turns.
    resolution : float, optional
        Width of the bracket.

    Returns
    -------
    sticks, turns : float
        The bracket; NaN for both if the ends are not as they should be.
    """
    if not _sticks(scene, lowest) or _sticks(scene, highest):
        return math.nan, math.nan
    sticks, turns = lowest, highest
    while turns - sticks > resolution * (1.0 + 1e-9):
        middle = 0.5 * (sticks + turns)
        if _sticks(scene, middle):
            sticks = middle
        else:
            turns = middle
    return sticks, turns


def sensitivities(changes: Mapping[str, Sequence[float]] = CHANGES) -> Iterator[Limit]:
    """Find the limit of the low-speed preset, and with one key changed after the other.

    Parameters
    ----------
    changes : mapping of str to sequence of float, optional
        Factors on the preset's values, by key.

    Yields
    ------
    Limit
    """
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.samples": _SAMPLES})
    yield Limit("", math.nan, 1.0, *sticking_limit(scene))
    for key, factors in changes.items():
        table, name = key.split(".")
        standing = float(getattr(getattr(scene, table), name))
        for factor in factors:
            value = standing * factor
            yield Limit(key, value, factor, *sticking_limit(scene.replace({key: value})))


def sensitivity_table(limits: Sequence[Limit]) -> str:
    """Write limits as a table in Markdown: key, change of the key, limit, change of the limit."""
    whole = limits[0].middle
    lines = ["| key | changed by | sticks at | turns at | limit moves by |", "|---|---|---|---|---|"]
    for limit in limits:
        change = f"{100.0 * (limit.factor - 1.0):+.0f} %" if limit.key else ""
        moved = f"{limit.middle - whole:+.3f}" if limit.key else ""
        lines.append(
            f"| {limit.key or 'as it stands'} | {change} | {limit.sticks:.3f} | {limit.turns:.3f} | {moved} |"
        )
    return "\n".join(lines) + "\n"


def _sticks(scene: Scene, fraction: float) -> bool:
    """Whether the gear sticks at a SAM fraction within the scene's duration."""
    (outcome,) = outcomes(gd.simulate(scene.replace({"coating.sam_fraction": fraction})))
    if outcome.status != "finished":
        raise RuntimeError(f"{scene.name} at {fraction:g}: the run ended with {outcome.status}")
    return outcome.verdict == "sticks"


if __name__ == "__main__":
    sys.stdout.write(sensitivity_table(list(sensitivities())))
