"""A very long run: a million tooth passages, checked for drift, counting errors and memory growth.

Smooth running at full speed with full coverage: a constant drive and a critically damped mesh, so that each
passage takes few steps and is like the one before. Whatever changes from the first tenth of the run to the last is an
error that adds up.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from gearidae.engine import follow
from gearidae.errors import SolverError
from gearidae.records import GEAR_COLUMNS, Block, EventKind, Flank, Statistics
from gearidae.runs.estimates import steady_speed
from gearidae.scene import Scene, preset

__all__ = [
    "FEWEST_PASSAGES",
    "PASSAGES",
    "Part",
    "long_page",
    "long_rows",
    "long_scene",
    "measure_long",
    "peak_memory",
    "sound",
]

PASSAGES: Final = 1_000_000
FEWEST_PASSAGES: Final = 100
PARTS: Final = 10
_SAMPLED: Final = 10.0 * (1.0 + math.sqrt(5.0)) / 2.0
"""Samples to a passage: a number that no fraction is near, so that they fall anywhere in a passage alike."""
_RTOL: Final = 1e-5
_DAMPING: Final = 3e-5
"""Of the mesh [N s/m]: critical for the pair's effective mass and the stiffness at rest, nearly."""
_SPEED, _ANGLE, _ERROR = (
    GEAR_COLUMNS.index(name) for name in ("gear_speed", "gear_angle", "transmission_error")
)


@dataclass(slots=True)
class Part:
    """One part of the run, of the same length as the others.

    Attributes
    ----------
    passages : int
        Mesh exits on the drive flank since the start of the run.
    time : float
        Simulated time at its end [s].
    cpu_time : float
        What this part took of one core [s].
    steps : int
        Solver steps of this part.
    memory : float
        By how much the process has grown since the start of the run [bytes].
    angle : float
        Of the gear at its end [rad].
    samples : int
        Looked at since the start of the run.
    integral : float
        Of the sampled speed over this part [rad].
    speed : float
        Mean speed of the gear in this part [rad/s]: angle over time.
    error : float
        Mean transmission error [m].
    low, high : float
        Extremes of the gear's angle in pitches less the passages counted, over all samples of this part.
    scatter : float
        Standard deviation of the time from one passage to the next [s].
    imbalance : float
        Residual of the energy balance over its throughput, from the start of the run to this part's end.
    miscounted : int
        Passages that are not of the pair that follows the one before.
    """

    passages: int = 0
    time: float = 0.0
    cpu_time: float = 0.0
    steps: int = 0
    memory: float = 0.0
    angle: float = 0.0
    samples: int = 0
    integral: float = 0.0
    speed: float = math.nan
    error: float = math.nan
    low: float = math.inf
    high: float = -math.inf
    scatter: float = math.nan
    imbalance: float = math.nan
    miscounted: int = 0


def long_scene(passages: int) -> Scene:
    """Make the scene: the high-speed preset without its harmonic torque, and damped."""
    scene = preset("teodorescu2009").replace({"drive.harmonic": [], "mesh.damping": _DAMPING})
    assert scene.gears is not None
    duration = passages * 2.0 * math.pi / scene.gears.gear_teeth / steady_speed(scene)
    return scene.replace(
        {"run.duration": duration, "run.samples": round(_SAMPLED * passages), "run.rtol": _RTOL}
    )


def measure_long(passages: int = PASSAGES, report: Callable[[int], object] = lambda _: None) -> list[Part]:
    """Run it, its output looked at and dropped as it comes.

    Parameters
    ----------
    passages : int, optional
        How many teeth pass, about.
    report : callable, optional
        Told now and then how many have.

    Returns
    -------
    list of Part

    Raises
    ------
    SolverError
        If the run does not reach its end.
    """
    scene = long_scene(passages)
    follow(long_scene(16), lambda *_: None)  # compiles, on a machine that is new to it
    watch = _Watch(scene, report)
    ended = follow(scene, watch.take)
    watch.end()
    if ended.status != "finished":
        raise SolverError(
            f"the long run ended early ({ended.message})",
            time=ended.end_time, state={}, last_event="none", advice="report this",
        )  # fmt: skip
    return watch.parts


class _Watch:
    """What is kept of the run's output."""

    def __init__(self, scene: Scene, report: Callable[[int], object]) -> None:
        assert scene.gears is not None
        self._report = report
        self._began, self._memory = time.process_time(), peak_memory()
        self._pitch = 2.0 * math.pi / scene.gears.gear_teeth
        self._interval = scene.run.duration / (scene.run.sample_count - 1)
        self._samples = scene.run.sample_count
        self._length = -(-self._samples // PARTS)
        self._part, self._before = Part(), Part()
        self._errors = 0.0
        self._exits: list[np.ndarray[tuple[int], np.dtype[np.float64]]] = []
        self._pair: int | None = None
        self._speed: float | None = None
        self.parts: list[Part] = []

    def take(self, block: Block, statistics: Statistics, wall_time: float) -> None:
        """Look at a block; parts end at blocks, so that they differ in length by a block at most."""
        self._look_at_events(block)
        if len(block.rows):
            self._look_at_samples(block)
        self._part.steps, self._part.cpu_time = statistics.steps, time.process_time() - self._began
        if block.balance is not None:
            self._part.imbalance = block.balance.imbalance
        self._report(self._part.passages)
        left = (
            self._samples - self._part.samples
        )  # what is too little for a part of its own goes with the last one
        if self._part.samples >= self._length * (len(self.parts) + 1) and left > 0.5 * self._length:
            self.end()

    def _look_at_events(self, block: Block) -> None:
        kind, flank = block.events[:, 1], block.events[:, 3]
        leaving = block.events[(kind == EventKind.MESH_EXIT) & (flank == Flank.DRIVE)]
        pairs = leaving[:, 2].astype(np.int64)
        if self._pair is not None:
            pairs = np.concatenate([[self._pair], pairs])
        self._part.miscounted += int(np.count_nonzero(np.diff(pairs) != 1))
        self._pair = int(pairs[-1]) if pairs.size else None
        self._part.passages += len(leaving)
        self._exits.append(leaving[:, 0])

    def _look_at_samples(self, block: Block) -> None:
        part, rows = self._part, block.rows
        times = self._interval * np.arange(part.samples, part.samples + len(rows))
        exits = self._exits[-1]
        counted = part.passages - len(exits) + np.searchsorted(exits, times, side="right")
        beyond = rows[:, _ANGLE] / self._pitch - counted
        part.low, part.high = min(part.low, float(beyond.min())), max(part.high, float(beyond.max()))
        speeds = rows[:, _SPEED] if self._speed is None else np.append(self._speed, rows[:, _SPEED])
        part.integral += float(np.sum(0.5 * (speeds[1:] + speeds[:-1]))) * self._interval
        self._errors += float(rows[:, _ERROR].sum())
        self._speed = float(rows[-1, _SPEED])
        part.samples += len(rows)
        part.time, part.angle = float(times[-1]), float(rows[-1, _ANGLE])

    def end(self) -> None:
        """Close a part, if there is anything in it."""
        part, before = self._part, self._before
        if part.samples == before.samples:
            return
        intervals = np.diff(np.concatenate(self._exits))
        self.parts.append(
            replace(
                part,
                cpu_time=part.cpu_time - before.cpu_time,
                steps=part.steps - before.steps,
                memory=peak_memory() - self._memory,
                speed=(part.angle - before.angle) / (part.time - before.time),
                error=self._errors / (part.samples - before.samples),
                scatter=float(intervals.std()) if intervals.size else math.nan,
            )
        )
        self._before = replace(part)
        part.low, part.high, part.integral, part.miscounted = math.inf, -math.inf, 0.0, 0
        self._errors, self._exits = 0.0, []


def sound(parts: Sequence[Part]) -> bool:
    """Whether every passage was counted once, in sequence, and the angle agrees with the count at every sample."""
    within = max(part.high for part in parts) - min(part.low for part in parts) < 1.0
    return within and not any(part.miscounted for part in parts)


def long_rows(parts: Sequence[Part]) -> Iterator[tuple[str, ...]]:
    """Heading and rows of the table of parts; drifts are relative to part 2, because part 1 contains the start."""
    yield (
        "passages", "simulated (s)", "steps per passage", "time per passage (us)", "memory growth (MB)",
        "mean u minus that of part 2 (m)", "speed over that of part 2, minus 1",
        "scatter of the passage time (s)",
    )  # fmt: skip
    base = parts[min(1, len(parts) - 1)]
    passed = 0
    for part in parts:
        count, passed = part.passages - passed, part.passages
        yield (
            f"{part.passages}",
            f"{part.time:.4g}",
            f"{part.steps / count:.1f}",
            f"{1e6 * part.cpu_time / count:.1f}",
            f"{part.memory * 1e-6:.1f}",
            f"{part.error - base.error:.1e}",
            f"{part.speed / base.speed - 1.0:.1e}",
            f"{part.scatter:.1e}",
        )


def long_page(parts: Sequence[Part]) -> str:
    """Write the table in Markdown, with the results for the whole run."""
    heading, *rows = long_rows(parts)
    first, last = parts[0], parts[-1]
    scene = long_scene(last.passages)
    assert scene.gears is not None
    pitch = 2.0 * math.pi / scene.gears.gear_teeth
    low, high = min(part.low for part in parts), max(part.high for part in parts)
    missing = (sum(part.integral for part in parts[1:]) - last.angle + first.angle) / pitch
    lines = [heading, ("---:",) * len(heading), *rows]
    table = "".join(f"| {' | '.join(line)} |\n" for line in lines)
    return (
        f"{last.passages} passages in {sum(part.steps for part in parts)} steps and "
        f"{sum(part.cpu_time for part in parts):.0f} s of one core, relative tolerance {_RTOL:g}.\n\n{table}\n"
        f"- Pairs out of sequence: {sum(part.miscounted for part in parts)}.\n"
        f"- The gear's angle in pitches minus the counted passages has a range of 1 - {1.0 - high + low:.1e} over all "
        f"{last.samples} samples. A single lost passage would make the range larger than 1.\n"
        f"- From the second part on, the integral of the sampled speed differs from the angle by {missing:.1e} "
        f"pitches in {(last.angle - first.angle) / pitch:.0f}.\n"
        f"- The imbalance of the energy balance is {last.imbalance:.1e} of the energy exchanged.\n"
        f"- The mean speed is {last.speed:.6f} rad/s; the balance of drive, drag and dry resistance alone gives "
        f"{steady_speed(scene):.6f} rad/s.\n"
    )


def peak_memory() -> float:
    """Largest memory of the process so far [bytes]."""
    if sys.platform == "win32":
        return math.nan  # the module resource is Unix's own
    import resource

    unit = 1 if sys.platform == "darwin" else 1024
    return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
