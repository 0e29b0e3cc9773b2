"""What the verdict of a train that goes on has to know of the runs before it, as numbers beside its end state.

A standstill may begin in one run and end in a later one. Free gears have followed the torques of the earlier runs,
which a later one does not know: it takes over where they have come to. The judge of a pair has the same in the engine's
state.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.records.standing import COLUMNS

SPEEDS_KEPT: Final = 500
"""Speeds of a chain that are kept for the runs after it, evenly spaced over its time."""
GROWN_KEPT: Final = 100
"""Times since a zero of which the farthest distances are kept."""


@dataclass(frozen=True, slots=True)
class Zero:
    """A zero of the judged shaft's speed, and what has been since, until a run ended that another goes on from.

    Attributes
    ----------
    time, angle : float
        [s], [rad].
    exits : float
        Mesh exits until then.
    free_angle, free_speed : float
        Of free gears at the end of that run [rad], [rad/s].
    onset : float
        When they began to move [s]; NaN if they had not.
    held_torque, driven_time, rest_time : float
        As of a standstill that begins there.
    slip, slip_torque : float
        End of the last rest [s], and the torque of the drive then [N m]; NaN without one.
    grown : ndarray, shape (3, n)
        Times [s], and the farthest distances of the shaft and of free gears until then [pitches].
    """

    time: float
    angle: float
    exits: float
    free_angle: float
    free_speed: float = 0.0
    onset: float = math.nan
    held_torque: float = 0.0
    driven_time: float = 0.0
    rest_time: float = 0.0
    slip: float = math.nan
    slip_torque: float = math.nan
    grown: Floats = field(default_factory=lambda: np.empty((3, 0)))

    def numbers(self) -> Floats:
        """Numbers of it, those that have grown behind their count."""
        own = [getattr(self, name) for name in _OF_ZERO]
        return np.array([*own, self.grown.shape[1], *self.grown.ravel()])


_OF_ZERO: Final = (
    *("time", "angle", "exits", "free_angle", "free_speed", "onset", "held_torque", "driven_time"),
    *("rest_time", "slip", "slip_torque"),
)


@dataclass(frozen=True, slots=True)
class Turn:
    """The farthest place of the judged shaft, or where it has turned back by more than half a pitch.

    Attributes
    ----------
    back : bool
        Whether it has turned back.
    time, angle : float
        Of the place [s], [rad].
    low : float
        Farthest back since [rad].
    free_angle, free_speed : float
        Of free gears from there, at the end [rad], [rad/s].
    exits : float
        Mesh exits until then.
    """

    back: bool
    time: float
    angle: float
    low: float
    free_angle: float
    free_speed: float
    exits: float

    def numbers(self) -> list[float]:
        """Numbers of it."""
        return [float(getattr(self, name)) for name in self.__slots__]


@dataclass(frozen=True, slots=True)
class Chain:
    """What the runs before have left for the verdict.

    Attributes
    ----------
    shaft : int
        Number of the judged shaft.
    exits : float
        Mesh exits of its mesh.
    breakaway : float
        Torque of the drive where the last standstill ended [N m]; NaN without one.
    turn : Turn
    time, speed : ndarray, shape (n,)
        Times [s] and speeds of the shaft [rad/s].
    rows : ndarray, shape (k, numbers of a standstill)
        Standstills that have ended.
    zeros : sequence of Zero
        From which the shaft has stayed within half a pitch, in the order of time.
    """

    shaft: int
    exits: float
    breakaway: float
    turn: Turn
    time: Floats
    speed: Floats
    rows: Floats
    zeros: Sequence[Zero]

    def words(self) -> Floats:
        """Write it as one vector of words."""
        counts = [self.shaft, self.time.size, len(self.rows), len(self.zeros)]
        head = np.array([*counts, self.exits, self.breakaway, *self.turn.numbers()], dtype=np.float64)
        zeros = [zero.numbers() for zero in self.zeros]
        return np.concatenate([head, self.time, self.speed, self.rows.ravel(), *zeros])


def chain_of(words: Floats) -> Chain:
    """Read what `Chain.words` has written.

    Raises
    ------
    SceneError
        If it is damaged.
    """
    try:
        return _read(iter(words.tolist()), words.size)
    except (StopIteration, ValueError, OverflowError):
        raise SceneError("start", "end_verdict", "is damaged: it is nothing that a run has left") from None


def _read(numbers: Iterator[float], size: int) -> Chain:
    """Take all numbers, of which there must be no more."""

    def take(count: float) -> Floats:
        whole = int(count)
        if not 0 <= whole == count <= size:
            raise ValueError
        return np.array([next(numbers) for _ in range(whole)])

    shaft, looks, rows, zeros, exits, breakaway = take(6).tolist()
    back, *turn = take(len(Turn.__slots__)).tolist()
    time, speed = take(looks), take(looks)
    table = take(rows * len(COLUMNS)).reshape(-1, len(COLUMNS))
    found = []
    for _ in range(int(zeros)):
        own = take(len(_OF_ZERO)).tolist()
        grown = take(3 * next(numbers)).reshape(3, -1)
        found.append(Zero(**dict(zip(_OF_ZERO, own, strict=True)), grown=grown))
    if next(numbers, None) is not None or not np.isfinite([shaft, exits, *time, *speed]).all():
        raise ValueError
    return Chain(int(shaft), exits, breakaway, Turn(bool(back), *turn), time, speed, table, found)


def evenly(time: Floats, count: int) -> NDArray[np.intp]:
    """Indices of at most so many of the times, evenly spaced over them."""
    if time.size <= count:
        return np.arange(time.size)
    return np.unique(np.searchsorted(time, np.linspace(time[0], time[-1], count)).clip(0, time.size - 1))
