"""What joints slide in a turn of the drive's shaft, of a pair the pinion: blocks of whole turns until it is steady."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae import engine
from gearidae.arrays import Floats
from gearidae.errors import SolverError
from gearidae.laws.joints import JOINTS
from gearidae.records.train_results import AnySolution, TrainSolution
from gearidae.runs.running import FAILS, nothing_of, solve_any_to_end, unfinished, unsolved
from gearidae.runs.starting import end_of_run
from gearidae.runs.train_statics import ratios
from gearidae.scene import TrainScene
from gearidae.scene.joints import train_pin
from gearidae.scene.judged import judged_shaft

if TYPE_CHECKING:
    from gearidae.scene import GearScene

_SUMS: Final = {joint.name: f"{joint.prefix}_sliding" for joint in JOINTS}
"""Joints of a pair, and the totals of a run that say what they have slid."""
_PATIENCE: Final = 4.0
"""Time that a block gets, over that of its turns at the speed with which it begins."""
_MOST_BLOCKS: Final = 20


@dataclass(frozen=True, slots=True)
class Turns:
    """Whole turns of the drive's shaft that are measured.

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
    """What joints slide in a turn of the drive's shaft.

    Attributes
    ----------
    sliding : tuple of float
        Integral of load times speed of each of `names_of_sums` [N m].
    rate : float
        Turns of the drive's shaft in a second.
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


def names_of_sums(scene: GearScene | TrainScene) -> list[str]:
    """Names of the joints whose sliding runs of a scene add up, with a radius or without."""
    if isinstance(scene, TrainScene):
        return [*(f"hub of {name}" for name in scene.shafts), "pin"]
    return list(_SUMS)


def shaft_of_turns(scene: GearScene | TrainScene) -> str:
    """Name of the shaft whose turns count: the drive's, of a pair the pinion."""
    return scene.train.shafts[scene.train.drive].name if isinstance(scene, TrainScene) else "the pinion"


def settling_scene(scene: GearScene | TrainScene, turns: Turns) -> GearScene | TrainScene:
    """Return the scene that settles: it keeps the sums, and its name says what is measured afterwards."""
    turning = f"{turns.count} turns of {shaft_of_turns(scene)} of {scene.name}"
    return scene.replace(
        {
            "run.balance": True,
            "run.samples": "off",
            "run.exposures": 0,
            "run.checkpoints": [],
            "run.stop": "time",
            "name": f"blocks of {turning}, steady to {turns.tolerance:g}",
        }
    )


def run_turns(scene: GearScene | TrainScene, turns: Turns, backend: str) -> tuple[AnySolution, str]:
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
    Solution or TrainSolution, str
        Of the last block, and a `Slid` as JSON; `FAILS` and a message where there is no answer: one run does not end a
        study of several.
    """
    try:
        solution, word = _measured(scene, turns, backend)
    except SolverError as error:
        return nothing_of(scene, "failed", str(error)), f"{FAILS}{error}"
    if isinstance(solution, TrainSolution):
        none = TrainSolution.none(solution.shafts, solution.meshes, "", "")
        return replace(solution, events=none.events, checkpoint=None), word
    return replace(solution, events=unsolved("", "").events, checkpoint=None), word


def _measured(scene: GearScene | TrainScene, turns: Turns, backend: str) -> tuple[AnySolution, str]:
    before, block = _solved(scene, backend), scene
    start, rate = engine.AT_ONCE, _late_rate(before, scene)
    blocks: list[Floats] = []
    while rate > 0.0 and not _stands(before):
        assert before.checkpoint is not None
        start = end_of_run(block, before.checkpoint, start.time)
        block = _block(scene, turns, rate)
        after = _solved(block, backend, start)
        assert after.reached is not None
        took = after.reached - start.time
        slid, before = _sums(scene, after) - _sums(scene, before), after
        # turns that are made end a block before its time is up
        if took >= block.run.duration * (1.0 - 1e-9):
            break
        blocks.append(slid / turns.count)
        rate, drift = turns.count / took, _drift(blocks)
        if drift <= turns.tolerance or len(blocks) == _MOST_BLOCKS:
            return after, json.dumps({"sliding": blocks[-1].tolist(), "rate": rate, "drift": drift})
    whose = scene.train.shafts[judged_shaft(scene)].name if isinstance(scene, TrainScene) else "the gear"
    return before, f"{FAILS}{whose} does not turn on at {before.reached:g} s"


def _late_rate(settled: AnySolution, scene: GearScene | TrainScene) -> float:
    """Turns of the drive's shaft in a second, in the second half of a run to its end; 0 if that is not known."""
    speed = math.nan if settled.extremes is None else abs(settled.extremes.late_gear_speed)
    rate = speed / (2.0 * math.pi * _over_drive(scene)[0])
    return 0.0 if math.isnan(rate) else rate


def _over_drive(scene: GearScene | TrainScene) -> tuple[float, float]:
    """Speeds of the judged shaft and of the load's over that of the drive's; both are the gear of a pair."""
    if isinstance(scene, TrainScene):
        judged, load = ratios(scene.train)[[judged_shaft(scene), scene.train.load]]
        return float(judged), float(load)
    return (scene.gears.pinion_teeth / scene.gears.gear_teeth,) * 2


def _solved(scene: GearScene | TrainScene, backend: str, start: engine.Start = engine.AT_ONCE) -> AnySolution:
    solution = solve_any_to_end(scene, backend, start)
    if solution.extremes is None or solution.status != "finished":
        raise unfinished(solution, f"the run of {scene.name}")
    return solution


def _stands(solution: AnySolution) -> bool:
    """Whether the gear stands or has gone back at the end of a run."""
    extremes = solution.extremes
    return extremes is None or not (math.isnan(extremes.stick_time) and math.isnan(extremes.back_time))


def _block(scene: GearScene | TrainScene, turns: Turns, rate: float) -> GearScene | TrainScene:
    """Return the scene of a block, with the time that it may take at a rate of turns of the drive's shaft."""
    way = turns.count * _over_drive(scene)[1]
    return scene.replace({"run.stop": f"turns {way!r}", "run.duration": _PATIENCE * turns.count / rate})


def _sums(scene: GearScene | TrainScene, solution: AnySolution) -> Floats:
    """What joints have slid by the end of a run [N m], as `names_of_sums` has them."""
    if isinstance(solution, TrainSolution):
        pin = train_pin(scene)
        # a train has no sum of its own for the pin: its friction has taken so much, at a constant coefficient
        slid = solution.energy["pin_loss"] / pin.coefficient if pin.arm > 0.0 else 0.0
        return np.append(solution.shaft_totals["hub_sliding"], slid)
    assert solution.balance is not None
    return np.array([solution.balance[name] for name in _SUMS.values()])


def _drift(blocks: list[Floats]) -> float:
    """Largest relative change from the last block but one; infinite of the first block."""
    if len(blocks) < 2:
        return math.inf
    last, before = blocks[-1], blocks[-2]
    slides = last > 0.0
    return float(np.max(np.abs(last - before)[slides] / last[slides], initial=0.0))
