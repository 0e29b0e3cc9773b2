"""What simulations show of the states of a life: windows at a frozen coverage, or one mesh cycle after another.

Cycles are simulated one by one where the coverage changes too fast for windows: each goes on from the one before, with
the coverage that its exposures have left.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae import engine
from gearidae.arrays import Floats
from gearidae.errors import SolverError
from gearidae.runs.execution import solutions
from gearidae.runs.run_cache import RunCache
from gearidae.wear import LossLaw
from gearidae.wear.lives.coverage import Coverage
from gearidae.wear.lives.cycle_jump import GearStuck
from gearidae.wear.lives.window import (
    Cycles,
    gained,
    part_of,
    run_window,
    solved,
    stands,
    steady_window,
    with_exposures,
)

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import GearScene
    from gearidae.wear import Exposure

MOST_STATES: Final = 1000
"""Largest number of states whose rate is computed."""
_EVALUATIONS: Final = 3
"""Rates per step of the integration."""
_PATIENCE: Final = 20.0
"""Time that a cycle gets, over its share of that of a window."""


@dataclass(frozen=True, slots=True)
class StateResult:
    """What the windows of a state have shown."""

    sticks: bool
    rate: Floats
    exposures: tuple[Exposure, ...]
    mean_speed: float
    min_speed: float


@dataclass
class LifeSamples:
    """The windows so far, and where more of them are computed."""

    scene: GearScene
    coverage: Coverage
    law: LossLaw
    cycles: Cycles
    starts: int
    backend: str
    executor: Executor | None = None
    kept: RunCache | None = None
    report: Callable[[float, int], None] | None = None
    seen: dict[bytes, StateResult] = field(default_factory=dict)
    run: int = 0
    mesh_cycles: int = 0

    def rate(self, state: Floats) -> Floats:
        """Change of a state in a passage; `GearStuck` where the gear sticks."""
        seen = self.of(state)
        if seen.sticks:
            raise GearStuck
        return seen.rate

    def has(self, state: Floats) -> bool:
        """Whether the windows of a state have been run."""
        return np.clip(state, 0.0, 1.0).tobytes() in self.seen

    def turns(self, state: Floats) -> bool:
        """Whether the windows of a state have been run, and the gear turns in them."""
        return self.has(state) and not self.of(state).sticks

    def of(self, state: Floats) -> StateResult:
        """Look a state up, or run its windows."""
        inside = np.clip(state, 0.0, 1.0)
        key = inside.tobytes()
        if key not in self.seen:
            if len(self.seen) >= MOST_STATES:
                raise SolverError(
                    f"the life needs more than {MOST_STATES} states",
                    time=0.0,
                    state={},
                    last_event="none",
                    advice="loosen the tolerance, or make windows longer (cycles, settle, starts)",
                )
            self.seen[key] = self._run(inside)
            self.report_states()
        return self.seen[key]

    def scene_at(self, state: Floats) -> GearScene:
        """Return the scene of a window with the coverage of a state."""
        return self.scene.replace(self.coverage.changes(state))

    def report_states(self) -> None:
        """Report the states so far."""
        if self.report is not None:
            self.report(float(len(self.seen)), MOST_STATES)

    def _run(self, state: Floats) -> StateResult:
        changed = self.scene_at(state)
        phase = self.scene.initial.mesh_phase
        scenes = [
            changed.replace({"initial.mesh_phase": (phase + number / self.starts) % 1.0})
            for number in range(self.starts)
        ]
        solved = list(solutions(self.kept, self.executor, run_window, scenes, self.cycles, self.backend))
        self.run += len(scenes)
        stuck = any(word == "sticks" for _, word in solved)
        if stuck:
            exposures: tuple[Exposure, ...] = ()
            rate = np.full_like(state, math.nan)
        else:
            exposures = tuple(
                self.coverage.exposure(scene, solution, self.cycles.count, state)
                for scene, (solution, _) in zip(scenes, solved, strict=True)
            )
            rate = np.mean([self.law.rate(state, exposure) for exposure in exposures], axis=0)
        extremes = [solution.extremes for solution, _ in solved if solution.extremes is not None]
        self.mesh_cycles += sum(extreme.mesh_exits for extreme in extremes)
        return StateResult(
            stuck,
            rate,
            exposures,
            float(np.mean([extreme.settled_gear_speed for extreme in extremes])),
            min(extreme.min_gear_speed for extreme in extremes),
        )


@dataclass
class DirectCycles:
    """Mesh cycles that are simulated one after another.

    Attributes
    ----------
    samples : LifeSamples
        Of the same life.
    seen : dict of bytes to StateResult
        What the cycle of each state has shown.
    run : int
        Cycles so far, with those that the motion took to become steady.
    """

    samples: LifeSamples
    seen: dict[bytes, StateResult] = field(default_factory=dict)
    run: int = 0
    _here: _BetweenCycles | None = None

    @property
    def cycle(self) -> float:
        """A mesh cycle in passages of each tooth."""
        return 1.0 / self.samples.scene.gears.pinion_teeth

    @property
    def worth(self) -> float:
        """Passages below which a jump is not worth the cycles of its windows."""
        return _EVALUATIONS * self.samples.cycles.total * self.cycle

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

    def _begin(self, passages: float, state: Floats) -> _BetweenCycles:
        """Bring the gears into steady motion at a coverage."""
        samples = self.samples
        window = steady_window(samples.scene_at(state), samples.cycles, samples.backend)
        if window.start is None:
            raise GearStuck(passages)
        assert window.solution.extremes is not None
        self.run += window.solution.extremes.mesh_exits
        return _BetweenCycles(passages, state, window.start, window.solution)

    def _next(self, here: _BetweenCycles) -> _BetweenCycles:
        """Simulate a cycle."""
        samples, state = self.samples, here.state
        scene = part_of(samples.scene_at(state), 1, samples.cycles.total, _PATIENCE)
        solution = solved(scene, samples.backend, here.start)
        if stands(solution, scene) or solution.checkpoint is None:
            raise GearStuck(here.passages + self.cycle)
        seen = self._see(scene, solution, here)
        self.seen[state.tobytes()] = seen
        self.run += 1
        samples.report_states()
        after = np.clip(state + seen.rate * self.cycle, 0.0, 1.0)
        start = engine.end_of(scene, solution.checkpoint, here.start.time)
        return _BetweenCycles(here.passages + self.cycle, after, start, solution, here.passages, state)

    def _see(self, scene: GearScene, solution: Solution, here: _BetweenCycles) -> StateResult:
        """What a cycle has shown; where the coverage is that of the run before, its exposures go on."""
        assert solution.extremes is not None
        assert here.start.scene is not None
        same = scene.coating == here.start.scene.coating
        exposures = gained(solution, here.run if same else None, scene)
        exposure = self.samples.coverage.exposure(scene, with_exposures(solution, exposures), 1, here.state)
        assert solution.reached is not None
        speed = 2.0 * math.pi / (scene.gears.gear_teeth * (solution.reached - here.start.time))
        rate = self.samples.law.rate(here.state, exposure)
        return StateResult(False, rate, (exposure,), speed, solution.extremes.min_gear_speed)


@dataclass(frozen=True, slots=True)
class _BetweenCycles:
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
