"""Passages of a life that are simulated one mesh cycle after another, as the coverage changes too fast for windows.

Each cycle goes on from the one before, with the coverage that its exposures have left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae import engine
from gearidae.studies.cycle_jump import GearStuck
from gearidae.studies.life_states import Seen, Windows
from gearidae.studies.life_window import gained, part_of, solved, stands, steady_window, with_exposures

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import Scene

__all__ = ["DirectCycles"]

Floats: TypeAlias = NDArray[np.float64]

_EVALUATIONS: Final = 3
"""Rates that a step of the integration asks for."""
_PATIENCE: Final = 20.0
"""Time that a cycle gets, over its share of that of a window."""


@dataclass
class DirectCycles:
    """Mesh cycles that are simulated one after another.

    Attributes
    ----------
    windows : Windows
        Of the same life.
    seen : dict of bytes to Seen
        What the cycle of each state has shown.
    run : int
        Cycles so far, with those that the motion took to become steady.
    """

    windows: Windows
    seen: dict[bytes, Seen] = field(default_factory=dict)
    run: int = 0
    _here: _Place | None = None

    @property
    def cycle(self) -> float:
        """A mesh cycle in passages of each tooth."""
        gears = self.windows.scene.gears
        assert gears is not None
        return 1.0 / gears.pinion_teeth

    @property
    def worth(self) -> float:
        """Passages below which a jump is not worth the cycles of its windows."""
        return _EVALUATIONS * self.windows.cycles.total * self.cycle

    def follow(self, passages: float, state: Floats) -> Iterator[tuple[float, Floats]]:
        """Simulate cycle after cycle.

        Parameters
        ----------
        passages : float
            Where to begin.
        state : ndarray
            Coverage there.

        Yields
        ------
        passages : float
        state : ndarray
            Each with which the gear has turned by a cycle; the first is the one to begin with.

        Raises
        ------
        GearStuck
            If the gear does, with the passages by which it has come to stand.
        """
        here = self._here
        if here is not None and here.before == passages and np.array_equal(here.turned, state):
            yield here.before, here.turned
        else:
            here = self._begin(passages, state)
        while True:
            here = self._here = self._next(here)
            yield here.before, here.turned

    def _begin(self, passages: float, state: Floats) -> _Place:
        """Bring the gears into steady motion at a coverage."""
        windows = self.windows
        window = steady_window(windows.scene_at(state), windows.cycles, windows.backend)
        if window.start is None:
            raise GearStuck(passages)
        assert window.solution.extremes is not None
        self.run += window.solution.extremes.mesh_exits
        return _Place(passages, state, window.start, window.solution)

    def _next(self, here: _Place) -> _Place:
        """Simulate a cycle."""
        windows, state = self.windows, here.state
        scene = part_of(windows.scene_at(state), 1, windows.cycles.total, _PATIENCE)
        found = solved(scene, windows.backend, here.start)
        if stands(found, scene) or found.checkpoint is None:
            raise GearStuck(here.passages + self.cycle)
        seen = self._see(scene, found, here)
        self.seen[state.tobytes()] = seen
        self.run += 1
        windows.say()
        after = np.clip(state + seen.rate * self.cycle, 0.0, 1.0)
        start = engine.end_of(scene, found.checkpoint, here.start.time)
        return _Place(here.passages + self.cycle, after, start, found, here.passages, state)

    def _see(self, scene: Scene, found: Solution, here: _Place) -> Seen:
        """What a cycle has shown; where the coverage is that of the run before, its exposures go on."""
        assert found.extremes is not None
        assert scene.gears is not None
        assert here.start.scene is not None
        same = scene.coating == here.start.scene.coating
        exposures = gained(found, here.run if same else None, scene)
        exposure = self.windows.coverage.exposure(scene, with_exposures(found, exposures), 1, here.state)
        assert found.reached is not None
        speed = 2.0 * math.pi / (scene.gears.gear_teeth * (found.reached - here.start.time))
        rate = self.windows.law.rate(here.state, exposure)
        return Seen(False, rate, (exposure,), speed, found.extremes.min_gear_speed)


@dataclass(frozen=True, slots=True)
class _Place:
    """Between two cycles.

    Attributes
    ----------
    passages, state
        Where the next cycle begins.
    start : Start
        Of the next cycle, at the end of the one before.
    run : Solution
        That cycle.
    before, turned
        Where it began.
    """

    passages: float
    state: Floats
    start: engine.Start
    run: Solution
    before: float = math.nan
    turned: Floats = field(default_factory=lambda: np.empty(0))
