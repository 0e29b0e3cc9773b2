"""Standing: the conditions under which a gear stands, sticks, or is thought to have left, in one place.

Free gears are the same shafts under the same torques, joined without backlash, adhesion and friction. Advances are the
farthest distances of the gear and of free gears from a zero of the gear's speed, in pitches of the gear.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntFlag
from functools import partial
from typing import Final, NamedTuple

from gearidae.laws.frictions import FRICTION_LAWS
from gearidae.laws.joints import JOINT_LAWS
from gearidae.records.quantity import PITCHES, SECONDS, TORQUE, Quantity, count

COLUMNS = (
    *("begin", "end", "advance", "free_advance", "held_torque", "holding", "driven_time", "rest_time"),
    "settled",
)
"""Numbers of a standstill: begin and end [s], end NaN at the end of the run; advances [pitches]; largest torque held
beyond the dry load [N m]; what held it, a `Holding`; times for which the drive exceeded the load, and at rest [s]; and
whether free gears have settled, which archives of version 0.3.0 do not say."""


class Holding(IntFlag):
    """What holds a gear; set-valued laws of a shaft declare what they say."""

    _ignore_ = "holder"

    for holder in (holder for laws in (FRICTION_LAWS, JOINT_LAWS) for law in laws for holder in law.holders):
        vars()[holder.name.upper()] = holder.number
    FLANK_FRICTION = 4
    ADHESION = 8
    DRIVE_WELL = 64
    SHAFT_TIE = 128

    @property
    def words(self) -> str:
        """Names of all that hold it."""
        names = ((part.name or "").lower().replace("_", " ") for part in sorted(Holding) if part in self)
        spoken = {"drive well": "the drive's own well", "shaft tie": "a shaft's tie to the ground"}
        return " and ".join(spoken.get(name, name) for name in names)

    @property
    def by_adhesion(self) -> bool:
        """Whether adhesion has a part in it."""
        return Holding.ADHESION in self

    @property
    def by_friction(self) -> bool:
        """Whether dry resistance or friction has a part in it."""
        return bool(self & ~(Holding.ADHESION | Holding.DRIVE_WELL | Holding.SHAFT_TIE))


_time, _advance = partial(Quantity, unit=SECONDS, archive=True), partial(Quantity, unit=PITCHES, archive=True)
_torque, _number = partial(Quantity, unit=TORQUE, archive=True), partial(count, archive=True)

STANDING_NOW: Final = (
    _time(
        "stick_time",
        "when the gear came to stand",
        comment="first zero of its speed from which it stands; NaN if it does not stand at the end",
    ),
    _number("stick_exits", "mesh exits on the drive flank until it stood or went back"),
    _advance("advance", "pitches that the gear has been away from where it came to stand"),
    _advance("free_advance", "pitches that free gears would have been away from there"),
    _time("driven_time", "time since then for which the drive exceeded the dry load"),
    _torque("held_torque", "largest torque of the drive at the gear beyond the dry load since then"),
    _number(
        "settled",
        "1 if free gears have settled there, 2 if the gear has settled with them",
        comment="within a pitch, and no farther away in the second half of the time than in the first",
    ),
    _number(
        "holding",
        "what holds the gear at the end",
        comment="sum of " + ", ".join(f"{part.value} for {part.words}" for part in sorted(Holding)),
    ),
    _advance("turned_back", "pitches by which the gear has gone back at the end"),
    _advance("free_turned_back", "pitches by which free gears would have gone back"),
    _time("back_time", "zero of the speed from which the gear has gone back"),
    _number("standstills", "number of standstills"),
    _time("standing_time", "time of all standstills"),
    _time("standing_rest_time", "time for which dry friction held all of the gear in them"),
    _time(
        "start_time",
        "end of the last standstill that has ended",
        comment="0 without one; NaN if the gear has never left half a pitch",
    ),
    _torque("breakaway_torque", "torque of the drive on the pinion then"),
    _time("rest_time", "time since the start of the chain of runs for which dry friction has held the gear"),
    _time("followed_time", "time since the start of the chain of runs to which this holds"),
)
"""Where the gear stands at the end of a run; advances of a gear that does not stand begin at the first zero within half
a pitch of all that came later."""

HALF_PITCH = 0.5
"""Pitches that a gear must move from a zero of its speed to have left it."""
NOTICED = 0.1
"""Pitches that free gears must have moved for a standstill of any duration, and for one that sticks."""
SWING = 2.0 * NOTICED
"""Pitches by which free gears may be ahead of a gear that turns round; 0.14 where it rings before it follows them."""
SHORT_STANDSTILL = 0.01
"""Of the time since the start: a standstill in which free gears have moved less lasts longer than this."""
SETTLED_WITHIN = 1.0
"""Pitches that free gears may go from a zero and settle."""
GROWS = 1e-2
"""Share by which a distance from a zero must exceed the largest before to have grown: what approaches its rest
exponentially has come that near after five times its time constant, and a ringing gear repeats its amplitude closer."""


def stands(advance: float, free_advance: float, lasts: float, until: float, together: bool) -> bool:
    """Whether a gear stands that has stayed within half a pitch since a zero of its speed.

    Parameters
    ----------
    advance, free_advance : float
        Of the gear and of free gears since the zero [pitches].
    lasts : float
        Time since the zero [s].
    until : float
        Time since the start of the chain of runs [s].
    together : bool
        Whether free gears have settled, and the gear has gone no farther in the second half of the time either.
    """
    held = free_advance == 0.0 or advance < 0.5 * free_advance or together
    return held and (free_advance >= NOTICED or lasts > SHORT_STANDSTILL * until)


class Followed(NamedTuple):
    """What gear and free gears have done from an earlier zero of the gear's speed until now.

    Attributes
    ----------
    advance, free_advance : float
        Farthest distances [pitches].
    onset : float
        When free gears began to move [s].
    """

    advance: float
    free_advance: float
    onset: float


def turns_round(since: float, until: float, free_advance: float, earlier: Iterable[Followed]) -> bool:
    """Whether a gear that stands from a zero of its speed only turns round there.

    It has followed free gears from an earlier zero, for longer than since. Until the pinion has passed the
    backlash, free gears that swing back are ahead of it by a small part of a pitch. Under a constant torque no gear
    that sticks is taken for one: when free gears from rest have turned by `NOTICED`, those from a start within half a
    pitch have gone more than twice as far as the gear.

    Parameters
    ----------
    since, until : float
        The zero and the present time [s].
    free_advance : float
        Of free gears from the zero [pitches].
    earlier : iterable of Followed
        Earlier zeros from which the gear has stayed within half a pitch.
    """
    if not 0.0 < free_advance < SWING:
        return False
    return any(
        before.advance >= 0.5 * before.free_advance >= 0.5 * NOTICED and until - since < since - before.onset
        for before in earlier
    )


def is_driven(free_advance: float, driven_time: float, until: float, settled: int) -> bool:
    """Whether a gear that stands is driven: it sticks, and does not only stop.

    Parameters
    ----------
    free_advance : float
        Of free gears [pitches].
    driven_time : float
        For which the drive exceeded the dry load [s].
    until : float
        As for `stands`.
    settled : int
        Whether free gears have settled: the drive then goes on to turn nothing.
    """
    return not settled and (free_advance >= NOTICED or driven_time > SHORT_STANDSTILL * until)
