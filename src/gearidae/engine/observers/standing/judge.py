"""The judge: what is said of where a gear stands, from what the run has noted and free gears.

It is asked at the end of a block, and never by a step. What it notes for good are standstills that have ended, of which
free gears decide whether there were any.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from gearidae.engine.model.checkpoint_record import HIGH, MOST_STANDSTILLS
from gearidae.engine.model.state import PHASE, STOPS, Floats, Model, W
from gearidae.engine.observers.standing.free_gears import FreeGears, FreeWay, Zero, torque_knots
from gearidae.engine.observers.standing.torques import hardest_in, slowest_period_at
from gearidae.engine.observers.standing.tracking import NEAR
from gearidae.records.standing import (
    GROWS,
    NOTICED,
    SETTLED_WITHIN,
    SHORT_STANDSTILL,
    Followed,
    stands,
    turns_round,
)

STICKS: Final = STOPS.index("sticks")
STOP_STEPS: Final = 1_000
"""Steps at most after which the judge of a run that is to stop where it sticks is asked."""


class Standstill(NamedTuple):
    """A standstill that has ended, or one at the end of a run, with the fields of the state's record."""

    begin: float
    end: float
    advance: float
    free_advance: float
    excess: float
    driven_time: float
    rest_time: float
    since: float
    breakaway: float
    settled: int


_NOWHERE: Final = Standstill._make([math.nan] * 9 + [0])


class Stood:
    """Standstills that have ended, taken out of the state's record and written back.

    Attributes
    ----------
    rows : list of Standstill
        In the order of time; of more than `MOST_STANDSTILLS` the longest.
    number : int
    standing_time, standing_rest : float
        Of all of them [s].
    last_end, breakaway : float
        End of the last one [s], and torque of the drive then, or at the start [N m].
    start_torque : float
        At the start [N m].
    """

    def __init__(self, record: Any) -> None:
        count = int(record.stand_count)
        self.rows = [Standstill(*row) for row in record.standstill[:count][list(Standstill._fields)].tolist()]
        self.number, self.start_torque = int(record.standstills), float(record.start_torque)
        self.standing_time, self.standing_rest = float(record.standing_time), float(record.standing_rest)
        self.last_end, self.breakaway = float(record.last_end), float(record.breakaway)

    def write(self, record: Any) -> None:
        """Write all into the state's record."""
        record.stand_count, record.standstills = len(self.rows), self.number
        for i, row in enumerate(self.rows):
            for name, value in zip(Standstill._fields, row, strict=True):
                record.standstill[name][i] = value
        record.standing_time, record.standing_rest = self.standing_time, self.standing_rest
        record.last_end, record.breakaway = self.last_end, self.breakaway

    def has(self, zero: Zero) -> bool:
        """Whether a standstill that has ended lies behind a zero."""
        return self.number > 0 and zero.time <= self.last_end

    def add(self, row: Standstill) -> None:
        """Note one more."""
        self.number += 1
        self.standing_time += row.end - row.begin
        self.standing_rest += row.rest_time
        self.last_end, self.breakaway = row.end, row.breakaway
        self.rows.append(row)
        if len(self.rows) > MOST_STANDSTILLS:  # the shortest makes room
            self.rows.remove(min(self.rows, key=lambda kept: kept.end - kept.begin))


class Said(NamedTuple):
    """What the judge says of an end.

    Attributes
    ----------
    stood : Stood
        Standstills that have ended until then.
    stands : bool
    row : Standstill
        What has been since the gear came to stand, or since the first zero within half a pitch of all that came later;
        NaN without one.
    since : float
        When it came to stand [s], the start of a gear that has never left it.
    exits : int
        Mesh exits until then.
    back : tuple
        How far gear and free gears have gone back [pb]; when that began [s], after how many mesh exits, and when the
        gear had gone back by half a pitch [s]. Zero if the gear's last movement was forward.
    period : float
        Of the slowest harmonic [s].
    """

    stood: Stood
    stands: bool
    row: Standstill
    since: float
    exits: int
    back: tuple[float, float, float, int, float]
    period: float


class Seen:
    """What a run has noted of where its gear stands, at one time.

    Attributes
    ----------
    zeros : list of Zero
    record : record
        The state's, of the rest.
    """

    def __init__(self, record: Any) -> None:
        self.record = record
        self.zeros = [Zero(*row) for row in record.zero[: int(record.zero_count)].tolist()]


def distance(zero: Zero, position: float) -> float:
    """How far the gear has been from a zero [pb], with its present position."""
    return max(zero.highest - zero.position, zero.position - zero.lowest, abs(position - zero.position))


class Judge:
    """Judges one run.

    Parameters
    ----------
    m : Model
        Of the run.
    place : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    """

    def __init__(self, m: Model, address: int) -> None:
        self._m, self._address = m, address
        self._unit, self._near = float(m.scene.time_unit), NEAR * float(m.scene.phase_rate)
        self._free: dict[Zero, FreeGears] = {}  # of the zeros that are known now
        self._known_knots: list[float] | None = None

    # -- what it is asked --------------------------------------------------------------------------------------------

    def follow(self, time: float) -> None:
        """Note standstills that have ended in a block, and plan the end of a run that stops where it sticks.

        Parameters
        ----------
        time : float
            Reached, over tau.
        """
        m = self._m
        count = int(m.work.leavings)
        if count > 0:
            stood, length = Stood(m.state.stood), float(m.scene.end) * self._unit
            known = stood.number
            for record in m.work.leaving[:count]:
                seen = Seen(record)
                self._note(stood, seen, float(record.leave_time), float(record.leave_position), length)
            m.work.leavings = 0
            self._forget()
            if stood.number > known:
                stood.write(m.state.stood)
        if m.scene.stop == STICKS:
            self._plan(time)

    def now(self, time: float, y: Floats) -> Said:
        """Say where the gear stands if the run ends here, with the standstills until then.

        Parameters
        ----------
        time : float
            Reached, over tau.
        y : ndarray, shape (n,)
            Scaled state there.
        """
        m, t, position = self._m, time * self._unit, float(y[PHASE] + self._m.state.whole_pitches)
        seen, stood, s = Seen(m.state.standing), Stood(m.state.stood), m.state.standing
        zeros, row, since, exits = seen.zeros, _NOWHERE, math.nan, 0
        from_here = self._standing_since(zeros, t, position, t, 0.0)
        if from_here is None:
            self._note(stood, seen, t, position, t)
        if zeros:
            z = from_here or zeros[0]
            free, begin = self._free_until(z, t), self._begin(stood, seen, z)
            ways, drive = (distance(z, position), free.farthest), (free.excess, free.driven_time)
            rest = float(s.rest_time) - z.rest_time
            row = Standstill(
                begin, math.nan, *ways, *drive, rest, z.time, math.nan, self._settles(z, free, t, position)
            )
            named = zeros[0] if s.left == 0 and zeros[0].start != 0 else z
            since, exits = named.time, named.exits
        back: tuple[float, float, float, int, float] = (0.0, 0.0, 0.0, 0, 0.0)
        if s.direction < 0:
            high = Zero(*s.zero[HIGH].item())
            gone = max(-self._free_until(high, t).travel, 0.0)
            back = high.position - position, gone, high.time, high.exits, float(s.turn_time)
        self._forget()
        period = float(slowest_period_at(self._address)) * self._unit
        return Said(stood, from_here is not None, row, since, exits, back, period)

    def settle(self, time: float, y: Floats) -> None:
        """Follow all free gears to the end of a run, after which torques are others.

        Free gears are not followed back in time. A standstill that has ended before is therefore noted now, and one
        that is noted after this ends here or later.

        Parameters
        ----------
        time, y
            As for `now`.
        """
        self.follow(time)
        m, t, position = self._m, time * self._unit, float(y[PHASE] + self._m.state.whole_pitches)
        seen, stood, s = Seen(m.state.standing), Stood(m.state.stood), m.state.standing
        if self._standing_since(seen.zeros, t, position, t, 0.0) is None:
            self._note(stood, seen, t, position, t)
            stood.write(m.state.stood)
        broken = min(self._break_away(seen, t, position)[0], t)
        s.slow_count = 1
        slow = s.slow[0]
        slow.time, slow.position = t, position
        slow.speed = abs(y[W]) * m.scene.phase_rate / self._unit
        followed = [*range(int(s.zero_count)), *([HIGH] if s.direction < 0 else [])]
        for i in followed:
            z = Zero(*s.zero[i].item())
            before, free, record = self._free_until(z, broken), self._free_until(z, t), s.zero[i]
            record.free_before, record.free_time = before.farthest, t
            record.free_travel, record.free_speed = free.travel, free.speed
            record.free_farthest, record.free_mark, record.free_grown = free.farthest, free.mark, free.grown
            record.onset, record.excess, record.driven_time = free.onset, free.excess, free.driven_time

    # -- standstills -------------------------------------------------------------------------------------------------

    def _note(self, stood: Stood, seen: Seen, t: float, position: float, length: float) -> None:
        """Note a standstill that has ended: as the gear broke away, or as it began to move as free gears do.

        Parameters
        ----------
        stood : Stood
            Gets it.
        seen : Seen
            When the gear has left half a pitch, or at an end.
        t, position : float
            That time [s], and where the gear was [pb].
        length : float
            Of the run [s].
        """
        zeros = seen.zeros
        if not zeros:
            return
        limit, stood_at = self._break_away(seen, t, position)
        if (
            limit - zeros[0].time <= SHORT_STANDSTILL * length
            and self._gears(zeros[0]).bound(limit) < NOTICED
        ):
            return  # too short for any of them
        s = seen.record
        held = self._near if self._slipped(seen) and s.slip_from_rest != 0 else 0.0
        since = self._standing_since(zeros, limit, stood_at, length, held)
        if since is not None:
            if not stood.has(since):
                free = self._free_until(since, limit)
                settled = self._settles(since, free, limit, stood_at)
                self._add(stood, seen, since, limit, (distance(since, stood_at), free.farthest), settled)
            return
        for z in zeros:
            if not stood.has(z) and z.time < limit:
                time, way, farthest = self._stood_until(seen, z, limit, length)
                if time > 0.0 and not self._swings(zeros, z, farthest, time, stood_at):
                    self._add(stood, seen, z, time, (way, farthest), 0, begun=farthest > 0.0)
                    return

    def _add(
        self,
        stood: Stood,
        seen: Seen,
        z: Zero,
        time: float,
        ways: tuple[float, float],
        settled: int,
        begun: bool = True,
    ) -> None:
        """Note a standstill from a zero to a time [s], with the advances; until free gears begin nothing drives."""
        begin = self._begin(stood, seen, z)
        rest = min(float(seen.record.rest_time) - z.rest_time, time - begin)
        drive = self._gears(z).driven(time) if begun or settled else (0.0, 0.0)
        torque = self._drive_torque(z, time)
        stood.add(Standstill(begin, time, *ways, *drive, rest, z.time, torque, settled))

    def _begin(self, stood: Stood, seen: Seen, z: Zero) -> float:
        """When a standstill begins [s]: no two of them overlap, and one that begins at a start at rest begins there."""
        if seen.record.left == 0 and seen.zeros[0].start != 0 and stood.number == 0:
            return seen.zeros[0].time
        return max(z.time, stood.last_end)

    def _slipped(self, seen: Seen) -> bool:
        """Whether dry friction has let go of the gear since its last zero, near where it stood."""
        s = seen.record
        near = abs(s.slip_position - s.zero_position) <= self._near
        return bool(near and s.slip_time >= s.zero_time and s.slip_time > 0.0)

    def _break_away(self, seen: Seen, t: float, position: float) -> tuple[float, float]:
        """When [s] and where the gear broke away that leaves half a pitch now.

        With the last slip near where it stood; where none has been since the last zero of its speed, as it went away
        from there. Neither depends on how fast the torque rises, as the speed does.
        """
        s = seen.record
        if self._slipped(seen):
            return float(s.slip_time), float(s.slip_position)
        if s.near != 0:
            return t, position
        return float(s.near_time), float(s.near_position)

    def _standing_since(
        self, zeros: list[Zero], time: float, position: float, length: float, held: float
    ) -> Zero | None:
        """First zero from which the gear stands until a time at a position, in a run of a length [s].

        A gear that dry friction has held until then, no farther than `held` from the zero [pb], has stood, whatever
        free gears have done: under nearly the same load they may have just begun to move. One that swings has not,
        see `_swings`.
        """
        for z in zeros:
            if z.time > time:
                break
            lasts = time - z.time
            if lasts <= SHORT_STANDSTILL * length and self._gears(z).bound(time) < NOTICED:
                continue
            free, way = self._free_until(z, time), distance(z, position)
            kept = way <= held or self._settles(z, free, time, position) == 2
            if stands(way, free.farthest, lasts, length, kept) and (
                kept or not self._swings(zeros, z, free.farthest, time, position)
            ):
                return z
        return None

    def _swings(self, zeros: list[Zero], z: Zero, free_advance: float, time: float, position: float) -> bool:
        """Whether a gear that stands from a zero until a time [s] at a position only turns round there."""
        return turns_round(z.time, time, free_advance, self._followed(zeros, z, time, position))

    def _followed(self, zeros: list[Zero], z: Zero, time: float, position: float) -> Iterator[Followed]:
        for earlier in zeros[: zeros.index(z)]:
            free = self._free_until(earlier, time)
            yield Followed(distance(earlier, position), free.farthest, free.onset)

    def _stood_until(self, seen: Seen, z: Zero, limit: float, length: float) -> tuple[float, float, float]:
        """When the conditions of standing from a zero held last before a time [s]; 0 if they did not.

        A gear that begins to move as free gears do ends a standstill without leaving half a pitch. Since the last zero
        its way is among the slow times; before, the standstill of a gear that is not driven ends where free gears
        begin.

        Returns
        -------
        time, advance, free_advance : float
            [s], [pb], [pb].
        """
        end, advance, before = 0.0, 0.0, -1.0
        for time, _, position in seen.record.slow[: int(seen.record.slow_count)].tolist():
            if time < max(z.free_time, z.time) or time > limit:
                continue
            way, free = distance(z, position), self._free_until(z, time).farthest
            margin = 0.5 * free - way
            if stands(way, free, time - z.time, length, False):
                end, advance, before = time, way, margin
            elif before >= 0.0:
                share = before / (before - margin)
                end, advance = end + share * (time - end), advance + share * (way - advance)
                before = -1.0
        if end > 0.0:
            return end, advance, self._free_until(z, end).farthest
        onset = self._free_until(z, limit).onset
        if onset > 0.0 and onset - z.time > SHORT_STANDSTILL * length:
            return onset, distance(z, z.position), 0.0
        return 0.0, 0.0, 0.0

    def _settles(self, z: Zero, free: FreeWay, time: float, position: float) -> int:
        """Whether free gears have settled since a zero, until a time [s]: 1, or 2 if the gear has as well.

        They go no farther than a pitch, and no farther in the second half of the time than in the first.
        """
        half = 0.5 * (time - z.time)
        if free.farthest > SETTLED_WITHIN or free.grown - z.time > half:
            return 0
        rests = z.grown - z.time <= half and distance(z, position) <= (1.0 + GROWS) * z.mark
        return 2 if rests else 1

    # -- free gears --------------------------------------------------------------------------------------------------

    def _free_until(self, z: Zero, time: float) -> FreeWay:
        return self._gears(z).until(time)

    def _gears(self, z: Zero) -> FreeGears:
        """Free gears of a zero; which it is does not change with where the gear has been since."""
        key = z._replace(lowest=0.0, highest=0.0, mark=0.0, grown=0.0, driven=0)
        if key not in self._free:
            self._free[key] = FreeGears(self._m, self._address, z, self.knots())
        return self._free[key]

    def _forget(self) -> None:
        """Forget free gears of zeros that the run has forgotten."""
        times = set(self._m.state.standing.zero["time"].tolist())
        self._free = {key: free for key, free in self._free.items() if key.time in times}

    def knots(self) -> list[float]:
        """Times over tau at which schedules and laws begin another piece, and the end of the run."""
        if self._known_knots is None:
            self._known_knots = torque_knots(self._m)
        return self._known_knots

    def _drive_torque(self, z: Zero, time: float) -> float:
        """Torque of the drive on a pinion at rest [N m]."""
        s = self._m.scene
        torque = self._gears(z).drive_torque(time)
        return torque * float(s.force_unit * s.pinion_radius)

    def _plan(self, t: float) -> None:
        """Set when a run ends that is to end in a standstill that sticks, if the gear does not leave its first zero.

        When free gears have turned by a pitch and nothing ahead drives harder than before. That may have passed.
        """
        m, track = self._m, self._m.work.track
        stood, seen = Stood(m.state.stood), Seen(m.state.standing)
        z = next((z for z in seen.zeros if not stood.has(z)), None)
        if z is None:
            track.planned = track.stop_time = 0.0
            return
        if track.planned == z.time + 1.0:
            return
        track.planned, track.stop_time = z.time + 1.0, 0.0
        end, begin = self._gears(z).reaches(1.0), z.time / self._unit
        if end == math.inf:
            return
        hardest = self._hardest(z, max(begin, float(m.scene.start)))
        end = max(end, begin + float(slowest_period_at(self._address)), hardest)
        # behind the present time, so that it is a root
        track.stop_time = max(end, t + 1e-9 * float(m.scene.end - m.scene.start))

    def _hardest(self, z: Zero, t: float) -> float:
        """Time over tau from which on nothing drives a gear that stands harder than before."""
        time, most, knots = t, -math.inf, self.knots()
        begins = [0.0, *knots[:-1]]
        for begin, end in zip(begins, knots, strict=True):
            if end <= t:
                continue
            first = max(begin, t)
            at, size = hardest_in(self._address, (begin, end), first, end, (z.position, z.pinion_lead))
            if size > most + 1e-9 * abs(most) or most == -math.inf:
                time, most = at, size
        return time
