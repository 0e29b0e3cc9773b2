"""Outcome of a run of a train: extremes of its judged shaft, as those of a pair, and the names of what holds it.

Intervals at rest, zeros and extremes of the speed come from the steps of the engine; changes of the speed, and ways,
from looks at the run that are as many for every one. Nothing of it depends on what is sampled.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gearidae.analysis.verdict.free_train import FreeTrain
from gearidae.archive.train.work import MESH_LOSSES
from gearidae.arrays import Floats
from gearidae.laws.frictions import friction_laws_of
from gearidae.laws.law import LOAD
from gearidae.laws.shaft.dry_load import DRY_LOAD
from gearidae.records import RUN_PARTS, EventKind, Extremes
from gearidae.records.standing import HALF_PITCH, SETTLED_WITHIN, Followed, Holding, stands, turns_round
from gearidae.records.train_results import NO_TRACK
from gearidae.scene.judged import judged_mesh, judged_pitch, judged_shaft

if TYPE_CHECKING:
    from gearidae.records.train_results import TrainSolution
    from gearidae.scene import TrainScene

_LOOKS: Final = 500
"""Times of a standstill at which the drive is compared with the dry resistance."""
_NOT_PASSED_ON: Final = 0.01
"""Share of the torque arriving at a shaft that must be missing for adhesion in its mesh to be named."""


class _Standstill(NamedTuple):
    """Numbers of a standstill, in the order of `gearidae.records.standing.COLUMNS`."""

    begin: float
    end: float
    advance: float
    free_advance: float
    held_torque: float
    holding: int
    driven_time: float
    rest_time: float
    settled: int


class _Motion:
    """The judged shaft over time, in pitches of its driven gear."""

    def __init__(self, scene: TrainScene, solution: TrainSolution) -> None:
        self.shaft, self.mesh = judged_shaft(scene), judged_mesh(scene)
        self.pitch = judged_pitch(scene)
        track = solution.track
        self.time, self.begin, self.end = track.time, solution.start, solution.reached
        self.speed, self.angle = (
            track.samples[name][self.shaft] if track.time.size else np.empty(0)
            for name in ("shaft_speed", "shaft_angle")
        )
        self.zero_time, self.zero_angle = track.zero_time, track.zero_angle
        rests = solution.rests
        mine = np.flatnonzero(rests["shaft"] == self.shaft)
        self.rests = [(float(rests["begin"][k]), float(rests["end"][k])) for k in mine]

    def at(self, t: float) -> float:
        """Angle at a time [rad]."""
        at = np.flatnonzero(self.zero_time == t)
        return float(self.zero_angle[at[0]] if at.size else np.interp(t, self.time, self.angle))

    def zeros(self) -> list[float]:
        """Times at which the speed is zero, or begins to be [s]."""
        found = {*self.zero_time.tolist(), *(begin for begin, _ in self.rests)}
        if self.speed.size and self.speed[0] == 0.0:
            found.add(float(self.time[0]))
        return sorted(found)


def judge_train(scene: TrainScene, solution: TrainSolution) -> TrainSolution:
    """Judge a run of a train by its judged shaft.

    Parameters
    ----------
    scene : Scene
        As it was run.
    solution : TrainSolution
        With its track.

    Returns
    -------
    TrainSolution
        With extremes and names of what holds the shaft, such as ``hub friction of middle``, in place of the track.
    """
    extremes, held = _judgement(scene, solution)
    return replace(solution, extremes=extremes, held_by=held, track=NO_TRACK)


def _judgement(scene: TrainScene, solution: TrainSolution) -> tuple[Extremes, tuple[str, ...]]:
    """Extremes of the judged shaft, and names of what holds it."""
    motion = _Motion(scene, solution)
    exits = _exits(solution, motion)
    numbers: dict[str, float] = {
        "min_gear_speed": float(solution.shaft_totals["min_speed"][motion.shaft]),
        "max_gear_speed": float(solution.shaft_totals["max_speed"][motion.shaft]),
        "mesh_exits": float(solution.mesh_totals["mesh_exits"][motion.mesh]),
        "rest_time": float(solution.shaft_totals["rest_time"][motion.shaft]),
        "followed_time": motion.end,
        "stick_exits": len(exits),
        **_speeds(motion),
    }
    if motion.time.size < 2:
        return Extremes(numbers), ()
    free = FreeTrain(scene)
    numbers |= _back(motion, free)
    standstills = list(_standstills(motion, free))
    ended = [still.end for still in standstills if not math.isnan(still.end)]
    started = ended[-1] if ended else 0.0 if not standstills else math.nan
    numbers |= {
        "standstills": len(standstills),
        "standing_time": sum((motion.end if math.isnan(s.end) else s.end) - s.begin for s in standstills),
        "standing_rest_time": sum(still.rest_time for still in standstills),
        "start_time": started,
    }
    if ended:
        torque = solution.track.samples["drive_torque"]
        numbers["breakaway_torque"] = float(np.interp(started, motion.time, torque))
    held: tuple[str, ...] = ()
    if standstills and math.isnan(standstills[-1].end):
        still = standstills[-1]
        holding, held = _holders(scene, solution, free, motion, still.free_advance)
        standstills[-1] = still._replace(holding=int(holding))
        numbers |= {
            "stick_time": still.begin,
            "stick_exits": int(np.count_nonzero(exits <= still.begin)),
            "holding": int(holding),
            "settled": int(still.settled),
            **{
                name: getattr(still, name)
                for name in ("advance", "free_advance", "driven_time", "held_torque")
            },
        }
    elif numbers["turned_back"] > 0.0:
        numbers["stick_exits"] = int(np.count_nonzero(exits <= numbers["back_time"]))
    table = array("d", [float(number) for still in standstills for number in still])
    return Extremes(numbers, standstill_list=table), held


def _exits(solution: TrainSolution, motion: _Motion) -> Floats:
    events = solution.events
    own = (events["mesh"] == motion.mesh) & (events["kind"] == EventKind.MESH_EXIT)
    return np.asarray(events["time"][own])


def _speeds(motion: _Motion) -> dict[str, float]:
    """Changes of the speed after the start-up, in the second half, and in the last twentieth of the run."""
    if not motion.time.size:
        return {}
    share = (motion.time - motion.begin) / max(motion.end - motion.begin, 1e-300)
    settled, late, last = (motion.speed[share >= part] for part in RUN_PARTS)
    made = {"final_speed": float(motion.speed[-1])}
    if settled.size:
        made |= {
            "settled_gear_speed": float(settled.mean()),
            "settled_spread": float(np.ptp(settled)),
            "speed_fall": float((np.maximum.accumulate(settled) - settled).max()),
            "speed_rise": float((settled - np.minimum.accumulate(settled)).max()),
        }
    if late.size:
        made |= {"late_gear_speed": float(late.mean()), "late_spread": float(np.ptp(late))}
    if last.size:
        made["last_min_gear_speed"] = float(last.min())
    return made


def _standstills(motion: _Motion, free: FreeTrain) -> Iterator[_Standstill]:
    """Yield the standstills of the shaft in the order of time; the end of one that lasts is NaN.

    A zero of the speed that is no standstill is followed by others of the same rocking: the next that counts is one
    after a new farthest position.
    """
    until, low, high = -math.inf, math.inf, -math.inf
    earlier: list[float] = []
    for zero in motion.zeros():
        position = motion.at(zero)
        if zero < until or low < position < high:
            continue
        inside = np.flatnonzero(motion.time >= zero)
        away = np.abs(motion.angle[inside] - position) / motion.pitch
        left = np.flatnonzero(away >= HALF_PITCH)
        lasts = left.size == 0
        inside = inside if lasts else inside[: left[0]]
        end = motion.end if lasts else float(motion.time[inside[-1]]) if inside.size else zero
        still = _judged(motion, free, earlier, zero, end)
        if still is None:
            earlier.append(zero)
            low, high = min(low, position), max(high, position)
            continue
        if not lasts:
            slips = [slip for _, slip in motion.rests if zero < slip <= end]
            still = still._replace(end=slips[-1] if slips else end)
        yield still
        until, low, high = end, math.inf, -math.inf


def _judged(
    motion: _Motion, free: FreeTrain, earlier: list[float], zero: float, end: float
) -> _Standstill | None:
    """Judge the time from a zero to an end, in which the shaft has stayed within half a pitch; None if it moves."""
    position = motion.at(zero)
    times, away, drifted = _ways(motion, free, zero, end)
    advance = float(away.max())
    ahead, half = float(drifted.max()), times <= 0.5 * (zero + end)
    calm = 0.0 < ahead <= SETTLED_WITHIN and half.any() and ahead <= float(drifted[half].max())
    together = bool(calm and advance <= float(away[half].max()))
    if not stands(advance, ahead, end - zero, end, together):
        return None
    if not together and turns_round(zero, end, ahead, _followed(motion, free, earlier, end)):
        return None
    sampled_times = np.linspace(zero, end, _LOOKS)
    beyond = np.array(
        [abs(free.driving(t, position, 0.0)) - free.dry(t, position, 0.0) for t in sampled_times]
    )
    rest = sum(max(min(stop, end) - max(start, zero), 0.0) for start, stop in motion.rests)
    return _Standstill(
        begin=zero,
        end=math.nan,
        advance=advance,
        free_advance=ahead,
        held_torque=max(float(beyond.max()), 0.0),
        holding=0,
        driven_time=float(np.mean(beyond > 0.0)) * (end - zero),
        rest_time=rest,
        settled=int(calm) + int(together),
    )


def _ways(motion: _Motion, free: FreeTrain, zero: float, end: float) -> tuple[Floats, Floats, Floats]:
    """Times from a zero to an end, and distances from the zero of the shaft and of free gears [pitches]."""
    position = motion.at(zero)
    times = np.union1d(motion.time[(motion.time >= zero) & (motion.time < end)], [end])
    away = np.abs(np.interp(times, motion.time, motion.angle) - position) / motion.pitch
    # of a run that goes on the torques before its start are not known
    drifted = free.positions(max(zero, motion.begin), position, times)
    return times, away, np.abs(drifted - position) / motion.pitch


def _followed(motion: _Motion, free: FreeTrain, earlier: list[float], end: float) -> Iterator[Followed]:
    """Yield what shaft and free gears have done from earlier zeros of which it has stayed within half a pitch."""
    for zero in earlier:
        _, away, drifted = _ways(motion, free, zero, end)
        if float(away.max()) < HALF_PITCH:
            onset = free.onset(max(zero, motion.begin), motion.at(zero), end)
            yield Followed(float(away.max()), float(drifted.max()), onset)


def _back(motion: _Motion, free: FreeTrain) -> dict[str, float]:
    """Distances by which the shaft, and free gears from the same zero, have gone back at the end."""
    nothing = {"turned_back": 0.0, "free_turned_back": 0.0, "back_time": math.nan}
    positions = motion.angle / motion.pitch
    top, low, forward, turned = 0, 0, True, 0
    for k, position in enumerate(positions):
        if forward:
            top = k if position > positions[top] else top
            if positions[top] - position > HALF_PITCH:
                forward, low, turned = False, k, top
        else:
            low = k if position < positions[low] else low
            if position - positions[low] > HALF_PITCH:
                forward, top = True, k
    if forward:
        return nothing
    since = float(motion.time[turned])
    drifted = free.positions(since, float(motion.angle[turned]), motion.time[turned:]) / motion.pitch
    return {
        "turned_back": float(positions[turned] - positions[-1]),
        "free_turned_back": max(float(positions[turned] - drifted[-1]), 0.0),
        "back_time": since,
    }


def _holders(
    scene: TrainScene, solution: TrainSolution, free: FreeTrain, motion: _Motion, free_advance: float
) -> tuple[Holding, tuple[str, ...]]:
    """What holds a train that stands: dry resistances alone if they suffice; else hubs, flanks, adhesion."""
    train, held, holding = scene.train, [], Holding(0)
    names = list(scene.shafts)
    if free_advance == 0.0:
        if free.dry(motion.end, motion.angle[-1], 0.0) > 0.0:
            holding |= Holding(DRY_LOAD.holders[0].number)
        if friction_laws_of(scene, LOAD):
            held.append(f"dry load of {names[train.load]}")
        held += [
            f"dry resistance of {name}" for name, shaft in scene.shafts.items() if shaft.resistance > 0.0
        ]
        return holding, tuple(held)
    at_rest = {
        int(shaft)
        for shaft, end in zip(solution.rests["shaft"], solution.rests["end"], strict=True)
        if end >= motion.end
    }
    for number, (name, shaft) in enumerate(scene.shafts.items()):
        hub = shaft.hub_of(name)
        if number in at_rest and hub is not None and hub.holding:
            holding |= Holding.HUB_FRICTION
            held.append(f"hub friction of {name}")
    for number in solution.flanks_held:
        holding |= Holding.FLANK_FRICTION
        held.append(f"flank friction of {train.meshes[number].name}")
    for name in _adhering(scene, solution):
        holding |= Holding.ADHESION
        held.append(f"adhesion in {name}")
    return holding, tuple(held)


def _adhering(scene: TrainScene, solution: TrainSolution) -> list[str]:
    """Names of the meshes that drive a shaft at which more torque is missing than its friction can hold."""
    train, track = scene.train, solution.track
    late = track.time >= solution.start + RUN_PARTS[2] * (solution.reached - solution.start)
    forces = track.samples["mesh_force"][:, late].mean(axis=1)
    loads, frictions = (track.samples[name][:, late].mean(axis=1) for name in ("hub_load", "hub_friction"))
    missing = []
    for number, (name, shaft) in enumerate(scene.shafts.items()):
        mine = [k for k, mesh in enumerate(train.meshes) if mesh.b == number]
        if not mine or not any(solution.mesh_totals[MESH_LOSSES[0]][k] > 0.0 for k in mine):
            continue
        arrives = sum(train.meshes[k].geometry.base_radius_gear * forces[k] for k in mine)
        leaves = sum(
            mesh.geometry.base_radius_pinion * forces[k]
            for k, mesh in enumerate(train.meshes)
            if mesh.a == number
        )
        hub = shaft.hub_of(name)
        limit = shaft.resistance
        if hub is not None:
            limit += replace(hub, coefficient=float(frictions[number])).torque(float(loads[number]))
        limit += scene.load.torque if name == train.shafts[train.load].name else 0.0
        if arrives - leaves - limit > _NOT_PASSED_ON * abs(arrives):
            missing += [train.meshes[k].name for k in mine]
    return missing
