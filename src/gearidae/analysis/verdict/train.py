"""Outcome of a run of a train: extremes of its judged shaft, as those of a pair, and the names of what holds it.

Intervals at rest, zeros and extremes of the speed come from the steps of the engine; changes of the speed, and ways,
from looks at the run that are as many for every one. Nothing of it depends on what is sampled. A run that goes on has
the standstills of its chain.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.analysis.verdict.chain import (
    GROWN_KEPT,
    SPEEDS_KEPT,
    Chain,
    Turn,
    Zero,
    chain_of,
    evenly,
)
from gearidae.archive.train.work import MESH_LOSSES
from gearidae.arrays import Floats
from gearidae.engine.train.free_train import FreeTrain
from gearidae.laws.frictions import friction_laws_of
from gearidae.laws.law import LOAD
from gearidae.laws.shaft.dry_load import DRY_LOAD
from gearidae.laws.shaft.hub import HUB
from gearidae.records import RUN_PARTS, EventKind, Extremes
from gearidae.records.standing import (
    COLUMNS,
    HALF_PITCH,
    SETTLED_WITHIN,
    Followed,
    Holding,
    stands,
    turns_round,
)
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


class _Way(NamedTuple):
    """Times, farthest distances of shaft and free gears until then, and free gears' angle and speed at the end."""

    grown: Floats
    free_angle: float
    free_speed: float


class _Motion:
    """The judged shaft over time, in pitches of its driven gear, and what earlier runs of its chain have left."""

    def __init__(self, scene: TrainScene, solution: TrainSolution, before: Chain | None) -> None:
        self.shaft, self.mesh = judged_shaft(scene), judged_mesh(scene)
        self.pitch = judged_pitch(scene)
        self.before = before if before is not None and before.shaft == self.shaft else None
        track = solution.track
        self.time, self.begin, self.end = track.time, solution.start, solution.reached
        self.speed, self.angle = (
            track.samples[name][self.shaft] if track.time.size else np.empty(0)
            for name in ("shaft_speed", "shaft_angle")
        )
        self.torque = track.samples["drive_torque"] if track.time.size else np.empty(0)
        self.zero_time, self.zero_angle = track.zero_time, track.zero_angle
        rests = solution.rests
        mine = np.flatnonzero(rests["shaft"] == self.shaft)
        self.rests = [(float(rests["begin"][k]), float(rests["end"][k])) for k in mine]
        events = solution.events
        own = (events["mesh"] == self.mesh) & (events["kind"] == EventKind.MESH_EXIT)
        self.exits = np.asarray(events["time"][own])
        self._ways: dict[tuple[float, float], _Way] = {}

    def at(self, t: float) -> float:
        """Angle at a time [rad]."""
        at = np.flatnonzero(self.zero_time == t)
        return float(self.zero_angle[at[0]] if at.size else np.interp(t, self.time, self.angle))

    def exits_until(self, t: float) -> float:
        """Mesh exits of the chain until a time of this run."""
        return (self.before.exits if self.before else 0.0) + float(np.count_nonzero(self.exits <= t))

    def zeros(self) -> list[Zero]:
        """Zeros of the speed, and where it begins to be zero, in the order of time."""
        found = {*self.zero_time.tolist(), *(begin for begin, _ in self.rests)}
        if self.before:
            found = {t for t in found if t > self.begin}
        elif self.speed.size and self.speed[0] == 0.0:
            found.add(float(self.time[0]))
        own = [Zero(t, self.at(t), self.exits_until(t), self.at(t)) for t in sorted(found)]
        return [*(self.before.zeros if self.before else ()), *own]

    def rested(self, zero: Zero, end: float) -> float:
        """Time at rest from a zero to an end [s]."""
        since = max(zero.time, self.begin) if self.before else zero.time
        own = sum(max(min(stop, end) - max(start, since), 0.0) for start, stop in self.rests)
        return zero.rest_time + own

    def slip(self, zero: Zero, end: float) -> tuple[float, float]:
        """End of the last rest after a zero until an end [s], and the drive's torque then [N m]; NaN without one."""
        slips = [slip for _, slip in self.rests if zero.time < slip <= end]
        return (slips[-1], self.torque_at(slips[-1])) if slips else (zero.slip, zero.slip_torque)

    def torque_at(self, t: float) -> float:
        """Torque of the drive at a time of this run [N m]."""
        return float(np.interp(t, self.time, self.torque))

    def way(self, free: FreeTrain, zero: Zero, end: float) -> _Way:
        """Ways of the shaft and of free gears from a zero to an end."""
        key = zero.time, end
        if key not in self._ways:
            # of a run that goes on the torques before its start are not known
            since = max(zero.time, self.begin)
            times = np.union1d(self.time[(self.time >= since) & (self.time < end)], [end])
            free_angles, speed = free.follow(since, zero.free_angle, zero.free_speed, times)
            angles = np.interp(times, self.time, self.angle)
            ways = [np.abs(own - zero.angle) / self.pitch for own in (angles, free_angles)]
            grown = np.concatenate([zero.grown, np.array([times, *ways])], axis=1)
            grown[1:] = np.maximum.accumulate(grown[1:], axis=1)
            self._ways[key] = _Way(grown, float(free_angles[-1]), speed)
        return self._ways[key]

    def driven(self, free: FreeTrain, zero: Zero, end: float) -> tuple[float, float]:
        """Largest torque held beyond the dry resistance [N m] from a zero to an end, and for how long it was [s]."""
        since = max(zero.time, self.begin)
        beyond = np.array(
            [
                abs(free.push(t, zero.angle, 0.0)) - free.dry(t, zero.angle, 0.0)
                for t in np.linspace(since, end, _LOOKS)
            ]
        )
        longer = float(np.mean(beyond > 0.0)) * (end - since)
        return max(float(beyond.max()), zero.held_torque, 0.0), zero.driven_time + longer

    def onset(self, free: FreeTrain, zero: Zero, end: float) -> float:
        """Time at which free gears begin to move from a zero, or the end [s]."""
        if not math.isnan(zero.onset):
            return zero.onset
        return free.onset(max(zero.time, self.begin), zero.free_angle, end)


def judge_chain(
    scene: TrainScene, solution: TrainSolution, before: Floats | None
) -> tuple[TrainSolution, Floats | None]:
    """Judge a run of a train by its judged shaft, with what runs before have left.

    Parameters
    ----------
    scene : Scene
        As it was run.
    solution : TrainSolution
        With its track.
    before : ndarray of 8-byte words or None
        Of the run that this one goes on from; None of a run by itself.

    Returns
    -------
    solution : TrainSolution
        With extremes and names of what holds the shaft, such as ``hub friction of middle``, in place of the track.
    words : ndarray of 8-byte words or None
        For runs that go on from this one; None of a run without looks.

    Raises
    ------
    SceneError
        If what is before is damaged.
    """
    motion = _Motion(scene, solution, None if before is None else chain_of(before))
    extremes, held, chain = _judgement(scene, solution, motion)
    judged = replace(solution, extremes=extremes, held_by=held, track=NO_TRACK)
    return judged, None if chain is None else chain.words()


def _judgement(
    scene: TrainScene, solution: TrainSolution, motion: _Motion
) -> tuple[Extremes, tuple[str, ...], Chain | None]:
    """Extremes of the judged shaft, names of what holds it, and what runs that go on have to know."""
    time, speed = _speed_of_chain(motion)
    numbers: dict[str, float] = {
        "min_gear_speed": float(solution.shaft_totals["min_speed"][motion.shaft]),
        "max_gear_speed": float(solution.shaft_totals["max_speed"][motion.shaft]),
        "mesh_exits": float(solution.mesh_totals["mesh_exits"][motion.mesh]),
        "rest_time": float(solution.shaft_totals["rest_time"][motion.shaft]),
        "followed_time": motion.end,
        "stick_exits": motion.exits_until(motion.end),
        **_speeds(time, speed, motion.end),
    }
    if motion.time.size < 2:
        return Extremes(numbers), (), None
    free = FreeTrain(scene, solution.start)
    turn = _turn(motion, free)
    numbers |= _back(motion, turn)
    found = list(_standstills(motion, free))
    earlier = [] if motion.before is None else [_Standstill(*row) for row in motion.before.rows.tolist()]
    standstills = [*earlier, *(still for still, _ in found)]
    ended = [still for still in standstills if not math.isnan(still.end)]
    started = ended[-1].end if ended else 0.0 if not standstills else math.nan
    numbers |= {
        "standstills": len(standstills),
        "standing_time": sum((motion.end if math.isnan(s.end) else s.end) - s.begin for s in standstills),
        "standing_rest_time": sum(still.rest_time for still in standstills),
        "start_time": started,
    }
    breakaway = math.nan if motion.before is None else motion.before.breakaway
    if len(ended) > len(earlier):
        breakaway = found[len(ended) - len(earlier) - 1][1]
    if ended:
        numbers["breakaway_torque"] = breakaway
    held: tuple[str, ...] = ()
    if standstills and math.isnan(standstills[-1].end):
        still = standstills[-1]
        holding, held = _holders(scene, solution, free, motion, still.free_advance)
        standstills[-1] = still._replace(holding=int(holding))
        numbers |= {
            "stick_time": still.begin,
            "stick_exits": next(zero.exits for zero in motion.zeros() if zero.time == still.begin),
            "holding": int(holding),
            "settled": int(still.settled),
            **{
                name: getattr(still, name)
                for name in ("advance", "free_advance", "driven_time", "held_torque")
            },
        }
    elif turn.back:
        numbers["stick_exits"] = turn.exits
    table = array("d", [float(number) for still in standstills for number in still])
    chosen = evenly(time, SPEEDS_KEPT)
    chain = Chain(
        shaft=motion.shaft,
        exits=motion.exits_until(motion.end),
        breakaway=breakaway,
        turn=turn,
        time=time[chosen],
        speed=speed[chosen],
        rows=np.array(ended, dtype=float).reshape(-1, len(COLUMNS)),
        zeros=list(_zeros_left(motion, free)),
    )
    return Extremes(numbers, standstill_list=table), held, chain


def _speed_of_chain(motion: _Motion) -> tuple[Floats, Floats]:
    """Times and speeds at which the shaft has been looked at, evenly spaced over the chain."""
    if motion.before is None or not motion.time.size:
        return motion.time, motion.speed
    time = np.concatenate([motion.before.time[:-1], motion.time])
    chosen = evenly(time, int((time[-1] - time[0]) / np.diff(time).max()) + 1)
    return time[chosen], np.concatenate([motion.before.speed[:-1], motion.speed])[chosen]


def _speeds(time: Floats, speed: Floats, end: float) -> dict[str, float]:
    """Changes of the speed after the start-up, in the second half, and in the last twentieth of the chain."""
    if not time.size:
        return {}
    share = (time - time[0]) / max(end - time[0], 1e-300)
    settled, late, last = (speed[share >= part] for part in RUN_PARTS)
    made = {"final_speed": float(speed[-1])}
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


def _standstills(motion: _Motion, free: FreeTrain) -> Iterator[tuple[_Standstill, float]]:
    """Yield the standstills of the shaft in the order of time, and the torques of the drive at their ends [N m].

    The end of one that lasts is NaN.

    A zero of the speed that is no standstill is followed by others of the same rocking: the next that counts is one
    after a new farthest position.
    """
    until, low, high = -math.inf, math.inf, -math.inf
    earlier: list[Zero] = []
    for zero in motion.zeros():
        if zero.time < until or low < zero.angle < high:
            continue
        inside, left = _within(motion, zero)
        inside = inside if left is None else inside[:left]
        end = motion.end if left is None else float(motion.time[inside[-1]]) if inside.size else zero.time
        still = _judged(motion, free, earlier, zero, end)
        if still is None:
            earlier.append(zero)
            low, high = min(low, zero.angle), max(high, zero.angle)
            continue
        torque = motion.torque_at(end)
        if left is not None:
            slip, torque_then = motion.slip(zero, end)
            end_of_it, torque = (end, torque) if math.isnan(slip) else (slip, torque_then)
            still = still._replace(end=end_of_it)
        yield still, torque
        until, low, high = end, math.inf, -math.inf


def _within(motion: _Motion, zero: Zero) -> tuple[NDArray[np.intp], int | None]:
    """Looks of this run since a zero, and which of them is the first half a pitch away; None if none is."""
    inside = np.flatnonzero(motion.time >= zero.time)
    away = np.abs(motion.angle[inside] - zero.angle) / motion.pitch
    left = np.flatnonzero(away >= HALF_PITCH)
    return inside, int(left[0]) if left.size else None


def _judged(
    motion: _Motion, free: FreeTrain, earlier: list[Zero], zero: Zero, end: float
) -> _Standstill | None:
    """Judge the time from a zero to an end, in which the shaft has stayed within half a pitch; None if it moves."""
    times, away, drifted = motion.way(free, zero, end).grown
    advance, ahead = float(away[-1]), float(drifted[-1])
    half = int(np.count_nonzero(times <= 0.5 * (zero.time + end)))
    calm = 0.0 < ahead <= SETTLED_WITHIN and half > 0 and ahead <= float(drifted[half - 1])
    together = bool(calm and advance <= float(away[half - 1]))
    if not stands(advance, ahead, end - zero.time, end, together):
        return None
    if not together and turns_round(zero.time, end, ahead, _followed(motion, free, earlier, end)):
        return None
    held_torque, driven_time = motion.driven(free, zero, end)
    return _Standstill(
        begin=zero.time,
        end=math.nan,
        advance=advance,
        free_advance=ahead,
        held_torque=held_torque,
        holding=0,
        driven_time=driven_time,
        rest_time=motion.rested(zero, end),
        settled=int(calm) + int(together),
    )


def _followed(motion: _Motion, free: FreeTrain, earlier: list[Zero], end: float) -> Iterator[Followed]:
    """Yield what shaft and free gears have done from earlier zeros of which it has stayed within half a pitch."""
    for zero in earlier:
        _, away, drifted = motion.way(free, zero, end).grown
        if float(away[-1]) < HALF_PITCH:
            yield Followed(float(away[-1]), float(drifted[-1]), motion.onset(free, zero, end))


def _zeros_left(motion: _Motion, free: FreeTrain) -> Iterator[Zero]:
    """Yield the zeros within half a pitch of all that came later: the first, and those after a new farthest place."""
    low, high, end = math.inf, -math.inf, motion.end
    for zero in motion.zeros():
        if low <= zero.angle <= high or _within(motion, zero)[1] is not None:
            continue
        low, high = min(low, zero.angle), max(high, zero.angle)
        way, onset = motion.way(free, zero, end), motion.onset(free, zero, end)
        slip, slip_torque = motion.slip(zero, end)
        held_torque, driven_time = motion.driven(free, zero, end)
        yield Zero(
            time=zero.time,
            angle=zero.angle,
            exits=zero.exits,
            free_angle=way.free_angle,
            free_speed=way.free_speed,
            onset=onset if onset < end else math.nan,
            held_torque=held_torque,
            driven_time=driven_time,
            rest_time=motion.rested(zero, end),
            slip=slip,
            slip_torque=slip_torque,
            grown=way.grown[:, evenly(way.grown[0], GROWN_KEPT)],
        )


def _turn(motion: _Motion, free: FreeTrain) -> Turn:
    """Follow the farthest place of the shaft, or where it has turned back by more than half a pitch."""
    half, begin = HALF_PITCH * motion.pitch, float(motion.angle[0])
    before = Turn(False, float(motion.time[0]), begin, begin, begin, 0.0, motion.exits_until(motion.begin))
    before = motion.before.turn if motion.before else before
    back, time, place, low = before.back, before.time, before.angle, before.low
    for t, angle in zip(motion.time.tolist(), motion.angle.tolist(), strict=True):
        low = min(low, angle)
        if (back and angle - low > half) or (not back and angle > place):
            back, time, place = False, t, angle
        elif not back and place - angle > half:
            back, low = True, angle
    known = (time, place) == (before.time, before.angle)
    since = motion.begin if known else time
    later = np.union1d(motion.time[motion.time >= since], [motion.end])
    start = (before.free_angle, before.free_speed) if known else (place, 0.0)
    angles, speed = free.follow(since, *start, later)
    exits = before.exits if known else motion.exits_until(time)
    return Turn(back, time, place, low, float(angles[-1]), speed, exits)


def _back(motion: _Motion, turn: Turn) -> dict[str, float]:
    """Distances by which the shaft, and free gears from the same place, have gone back at the end."""
    if not turn.back:
        return {"turned_back": 0.0, "free_turned_back": 0.0, "back_time": math.nan}
    return {
        "turned_back": (turn.angle - float(motion.angle[-1])) / motion.pitch,
        "free_turned_back": max((turn.angle - turn.free_angle) / motion.pitch, 0.0),
        "back_time": turn.time,
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
            holding |= HUB.holders[0].number
            held.append(f"hub friction of {name}")
    for number in solution.flanks_held:
        holding |= Holding.FLANK_FRICTION
        held.append(f"flank friction of {train.meshes[number].name}")
    for name in _adhering(scene, solution, free.dry_load(motion.end, motion.angle[-1])):
        holding |= Holding.ADHESION
        held.append(f"adhesion in {name}")
    return holding, tuple(held)


def _adhering(scene: TrainScene, solution: TrainSolution, dry_load: float) -> list[str]:
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
        limit += dry_load if number == train.load else 0.0
        if arrives - leaves - limit > _NOT_PASSED_ON * abs(arrives):
            missing += [train.meshes[k].name for k in mine]
    return missing
