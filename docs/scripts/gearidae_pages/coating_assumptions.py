"""What is assumed of coating, asperities and radius force, and what the figures of the paper become under it.

Key numbers of Figs. 2, 4, 7 and 10 of Teodorescu et al. 2009 and the sticking limit, each from simulations of the
presets with nothing else changed.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import gearidae as gd
from gearidae.scene import Scene
from gearidae_pages.sensitivity import sticking_limit

__all__ = [
    "ALL_ASSUMPTIONS",
    "FRACTIONS",
    "LAWS",
    "Assumption",
    "HighSpeed",
    "Impact",
    "LowSpeed",
    "high_speed",
    "impacts",
    "low_speed",
]

LAWS: Final = {"jkr": "JKR", "maugis": "Maugis"}
"""Names of the laws, by ``contact.asperity``."""
FRACTIONS: Final = (1.0, 0.8, 0.6, 0.5)
"""SAM fractions at which the characteristic frequency is given."""
RESOLUTION: Final = 0.01
"""Width of the bracket of a sticking limit."""
_HALF: Final = 0.5


@dataclass(frozen=True, slots=True)
class Assumption:
    """One set of assumptions.

    Attributes
    ----------
    law : str
        ``contact.asperity``.
    pairing : str
        ``coating.pairing``.
    thickness : float
        ``coating.thickness`` [m].
    radius_force : bool
        ``mesh.radius_force``.
    """

    law: str
    pairing: str = "patches"
    thickness: float = 0.0
    radius_force: bool = False

    @property
    def coating(self) -> str:
        """The coating in words."""
        return f"{self.pairing}, {self.thickness * 1e9:g} nm"

    @property
    def contact(self) -> str:
        """Law and force in words."""
        return LAWS[self.law] + (" + radius force" if self.radius_force else "")

    def of(self, scene: Scene, **more: Any) -> Scene:
        """Return a scene under these assumptions; further changes by table and name, ``coating__sam_fraction=0.5``."""
        keys: dict[str, Any] = {"contact.asperity": self.law}
        if scene.gears is not None:
            keys["mesh.radius_force"] = self.radius_force
            keys |= {"coating.pairing": self.pairing, "coating.thickness": self.thickness}
        return scene.replace(keys | {key.replace("__", "."): value for key, value in more.items()})


ALL_ASSUMPTIONS: Final = tuple(
    Assumption(law, pairing, thickness, force)
    for pairing, thickness, law, force in itertools.product(
        ("patches", "independent"), (0.0, 2.5e-9), LAWS, (False, True)
    )
)
"""In the order of the tables: by coating, law and force."""


@dataclass(frozen=True, slots=True)
class LowSpeed:
    """What the low-speed gears do (Figs. 7 and 10).

    Attributes
    ----------
    assumption : Assumption
    sticks, turns : float
        Bracket of the SAM fraction at which the gear begins to stick within the run; NaN where there is none.
    speed : float
        Smallest speed at half coverage [rad/s].
    frequencies : tuple of float
        Characteristic frequency at each of `FRACTIONS` [Hz].
    """

    assumption: Assumption
    sticks: float
    turns: float
    speed: float
    frequencies: tuple[float, ...]


def low_speed(
    assumptions: Sequence[Assumption] = ALL_ASSUMPTIONS,
    base: Scene | None = None,
    resolution: float = RESOLUTION,
    fractions: Sequence[float] = FRACTIONS,
) -> Iterator[LowSpeed]:
    """Run the low-speed preset under each assumption.

    Parameters
    ----------
    assumptions : sequence of Assumption, optional
    base : Scene, optional
        In place of the preset.
    resolution : float, optional
        Width of the bracket of a limit.
    fractions : sequence of float, optional
        At which frequencies are given.

    Yields
    ------
    LowSpeed
    """
    base = base or gd.preset("teodorescu2009_low_speed")
    for assumption in assumptions:
        scene = assumption.of(base)
        sticks, turns = sticking_limit(scene, lowest=0.0, highest=0.9, resolution=resolution)
        half = gd.simulate(scene.replace({"coating.sam_fraction": _HALF}), samples="off")
        chart = gd.analysis.coating_map(scene, fractions)["characteristic_frequency"]
        frequencies = tuple(float(chart.sel(sam_fraction=f, method="nearest")) for f in fractions)
        yield LowSpeed(assumption, sticks, turns, float(half["min_gear_speed"]), frequencies)


@dataclass(frozen=True, slots=True)
class HighSpeed:
    """Mean speeds of the high-speed gears over the run (Fig. 4) [rad/s]."""

    assumption: Assumption
    whole: float
    bare: float


def high_speed(laws: Sequence[str] = tuple(LAWS)) -> Iterator[HighSpeed]:
    """Run the high-speed preset, coated and bare, with each law, without and with the radius force.

    Yields
    ------
    HighSpeed
    """
    base = gd.preset("teodorescu2009")
    for law, force in itertools.product(laws, (False, True)):
        assumption = Assumption(law, radius_force=force)
        means = [
            float(gd.simulate(assumption.of(base, coating__sam_fraction=f))["gear_speed"].mean())
            for f in (1.0, 0.0)
        ]
        yield HighSpeed(assumption, *means)


@dataclass(frozen=True, slots=True)
class Impact:
    """Peak force and largest tension of the roller of Fig. 2 [N], bare and coated."""

    law: str
    speed: float
    peaks: tuple[float, float]
    tensions: tuple[float, float]


def impacts(
    laws: Sequence[str] = tuple(LAWS), names: Sequence[str] = ("roller_slow", "roller_fast")
) -> Iterator[Impact]:
    """Drop the rollers with each law.

    Yields
    ------
    Impact
    """
    for name, law in itertools.product(names, laws):
        scene = gd.preset(name)
        assert scene.roller is not None
        runs = [gd.simulate(Assumption(law).of(scene, coating__sam_fraction=f))["force"] for f in (0.0, 1.0)]
        peaks, tensions = (
            [float(value) for value in ends] for ends in zip(*(_ends(run) for run in runs), strict=True)
        )
        yield Impact(law, scene.roller.speed, (peaks[0], peaks[1]), (tensions[0], tensions[1]))


def _ends(force: Any) -> tuple[float, float]:
    """Largest repulsion and largest tension [N]."""
    return float(force.max()), -float(force.min())
