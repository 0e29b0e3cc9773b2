"""The states of a life that have been looked at: the rates that their windows show."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SolverError
from gearidae.runs.executors import side_by_side
from gearidae.runs.kept_runs import KeptRuns
from gearidae.studies.cycle_jump import GearStuck
from gearidae.studies.life_coverage import Coverage
from gearidae.studies.life_window import Cycles, run_window
from gearidae.wear import LossLaw

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import Scene
    from gearidae.wear import Exposure

__all__ = ["MOST_STATES", "Seen", "Windows"]

Floats: TypeAlias = NDArray[np.float64]

MOST_STATES: Final = 1000
"""States whose rate may be asked for."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What the windows of a state have shown."""

    sticks: bool
    rate: Floats
    exposures: tuple[Exposure, ...]
    mean_speed: float
    min_speed: float


@dataclass
class Windows:
    """The windows so far, and where more of them are computed."""

    scene: Scene
    coverage: Coverage
    law: LossLaw
    cycles: Cycles
    starts: int
    backend: str
    executor: Executor | None
    kept: KeptRuns | None
    report: Callable[[float, int], None]
    seen: dict[bytes, Seen] = field(default_factory=dict)
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

    def of(self, state: Floats) -> Seen:
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
            self.say()
        return self.seen[key]

    def scene_at(self, state: Floats) -> Scene:
        """Return the scene of a window with the coverage of a state."""
        return self.scene.replace(self.coverage.changes(state))

    def say(self) -> None:
        """Report the states so far."""
        self.report(float(len(self.seen)), MOST_STATES)

    def _run(self, state: Floats) -> Seen:
        assert self.scene.initial is not None
        changed = self.scene_at(state)
        phase = self.scene.initial.mesh_phase
        scenes = [
            changed.replace({"initial.mesh_phase": (phase + number / self.starts) % 1.0})
            for number in range(self.starts)
        ]
        found = self._solutions(scenes)
        stuck = any(sticks for _, sticks in found)
        if stuck:
            exposures: tuple[Exposure, ...] = ()
            rate = np.full_like(state, math.nan)
        else:
            exposures = tuple(
                self.coverage.exposure(scene, solution, self.cycles.count, state)
                for scene, (solution, _) in zip(scenes, found, strict=True)
            )
            rate = np.mean([self.law.rate(state, each) for each in exposures], axis=0)
        extremes = [solution.extremes for solution, _ in found if solution.extremes is not None]
        self.mesh_cycles += sum(each.mesh_exits for each in extremes)
        return Seen(
            stuck,
            rate,
            exposures,
            float(np.mean([each.settled_gear_speed for each in extremes])),
            min(each.min_gear_speed for each in extremes),
        )

    def _solutions(self, scenes: Sequence[Scene]) -> list[tuple[Solution, bool]]:
        """Take windows that are kept, and run the others."""
        taken = [None if self.kept is None else self.kept.take(each) for each in scenes]
        left = [each for each, one in zip(scenes, taken, strict=True) if one is None]
        fresh = side_by_side(
            self.executor, run_window, left, [self.cycles] * len(left), [self.backend] * len(left)
        )
        found: list[tuple[Solution, bool]] = []
        for scene, one in zip(scenes, taken, strict=True):
            if one is not None:
                found.append((one[0], one[1].get("verdict") == "sticks"))
                continue
            solution, stuck = next(fresh)
            if self.kept is not None:
                self.kept.keep(scene, solution, {"verdict": "sticks" if stuck else "turns"})
            found.append((solution, stuck))
        self.run += len(scenes)
        return found
