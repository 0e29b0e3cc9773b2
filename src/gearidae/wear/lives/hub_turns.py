"""What the joints of a gear pair slide in a turn of the pinion: whole turns, one block after another, until steady."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae import engine
from gearidae.arrays import Floats
from gearidae.errors import SolverError
from gearidae.runs.running import FAILS, solve_to_end, unfinished, unsolved

if TYPE_CHECKING:
    from gearidae.records import Solution
    from gearidae.scene import GearScene

SUMS: Final = {
    "pinion hub": "pinion_hub_sliding",
    "gear hub": "gear_hub_sliding",
    "pin": "pin_sliding",
}
"""Joints, and the totals of a run that say what they have slid."""
_PATIENCE: Final = 4.0
"""Time that a block gets, over that of its turns at the speed with which it begins."""
_MOST_BLOCKS: Final = 20


@dataclass(frozen=True, slots=True)
class Turns:
    """Whole turns of the pinion that are measured.

    Attributes
    ----------
    count : int
        Those of a block.
    tolerance : float
        By which share what a joint slides may differ from the block before.
    """

    count: int
    tolerance: float


@dataclass(frozen=True, slots=True)
class Slid:
    """What joints slide in a turn of the pinion.

    Attributes
    ----------
    sliding : tuple of float
        Integral of load times speed of each of `SUMS` [N m].
    rate : float
        Turns of the pinion in a second.
    drift : float
        Largest relative difference of two blocks, of the joints that slide.
    """

    sliding: tuple[float, ...]
    rate: float
    drift: float

    @classmethod
    def read(cls, word: str) -> Slid:
        """Read the word of a run that has an answer."""
        numbers = json.loads(word)
        return cls(tuple(numbers["sliding"]), numbers["rate"], numbers["drift"])


def settling_scene(scene: GearScene, turns: Turns) -> GearScene:
    """Return the scene that settles: it keeps the sums, and its name says what is measured afterwards."""
    return scene.replace(
        {
            "run.balance": True,
            "run.samples": "off",
            "run.exposures": 0,
            "run.checkpoints": [],
            "run.stop": "time",
            "name": f"blocks of {turns.count} turns of the pinion of {scene.name}, steady to {turns.tolerance:g}",
        }
    )


def run_turns(scene: GearScene, turns: Turns, backend: str) -> tuple[Solution, str]:
    """Run a scene to its end, then blocks of turns until what the joints slide is steady.

    Parameters
    ----------
    scene : Scene
        From `settling_scene`.
    turns : Turns
    backend : str
        As for `simulate`.

    Returns
    -------
    Solution, str
        Of the last block, and a `Slid` as JSON; `FAILS` and a message where there is no answer: one run does not end a
        study of several.
    """
    try:
        solution, word = _measured(scene, turns, backend)
    except SolverError as error:
        return unsolved("failed", str(error)), f"{FAILS}{error}"
    return replace(solution, events=unsolved("", "").events, checkpoint=None), word


def _measured(scene: GearScene, turns: Turns, backend: str) -> tuple[Solution, str]:
    before, block = _solved(scene, backend), scene
    start, rate = engine.AT_ONCE, _late_rate(before, scene)
    blocks: list[Floats] = []
    while rate > 0.0 and not _stands(before):
        assert before.checkpoint is not None
        start = engine.end_of(block, before.checkpoint, start.time)
        block = _block(scene, turns, rate)
        after = _solved(block, backend, start)
        slid, took, turned = _gained(after, before, start, block)
        if turned < turns.count * (1.0 - 1e-6):
            before = after
            break
        blocks.append(slid / turned)
        before, rate, drift = after, turned / took, _drift(blocks)
        if drift <= turns.tolerance or len(blocks) == _MOST_BLOCKS:
            return after, json.dumps({"sliding": blocks[-1].tolist(), "rate": rate, "drift": drift})
    return before, f"{FAILS}the gear does not turn on at {before.reached:g} s"


def _late_rate(settled: Solution, scene: GearScene) -> float:
    """Turns of the pinion in a second, in the second half of a run to its end; 0 if that is not known."""
    speed = math.nan if settled.extremes is None else abs(settled.extremes.late_gear_speed)
    rate = speed * scene.gears.gear_teeth / (2.0 * math.pi * scene.gears.pinion_teeth)
    return 0.0 if math.isnan(rate) else rate


def _solved(scene: GearScene, backend: str, start: engine.Start = engine.AT_ONCE) -> Solution:
    solution = solve_to_end(scene, backend, start)
    if solution.extremes is None or solution.status != "finished":
        raise unfinished(solution, f"the run of {scene.name}")
    return solution


def _stands(solution: Solution) -> bool:
    """Whether the gear stands or has gone back at the end of a run."""
    extremes = solution.extremes
    return extremes is None or not (math.isnan(extremes.stick_time) and math.isnan(extremes.back_time))


def _block(scene: GearScene, turns: Turns, rate: float) -> GearScene:
    """Return the scene of a block, with the time that it may take at a rate of turns of the pinion."""
    way = turns.count * scene.gears.pinion_teeth / scene.gears.gear_teeth
    return scene.replace({"run.stop": f"turns {way!r}", "run.duration": _PATIENCE * turns.count / rate})


def _gained(
    after: Solution, before: Solution, start: engine.Start, block: GearScene
) -> tuple[Floats, float, float]:
    """What a block has slid [N m], the time it took [s], and turns of the pinion."""
    assert after.checkpoint is not None
    assert start.position is not None
    end = engine.end_of(block, after.checkpoint, start.time)
    assert end.position is not None
    assert after.balance is not None
    assert before.balance is not None
    slid = np.array([after.balance[name] - before.balance[name] for name in SUMS.values()])
    return slid, end.time - start.time, abs(end.position - start.position) / block.gears.pinion_teeth


def _drift(blocks: list[Floats]) -> float:
    """Largest relative change from the last block but one; infinite of the first block."""
    if len(blocks) < 2:
        return math.inf
    last, before = blocks[-1], blocks[-2]
    slides = last > 0.0
    return float(np.max(np.abs(last - before)[slides] / last[slides], initial=0.0))
