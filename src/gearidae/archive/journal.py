"""Checkpoints in a growing archive: two slots, written in turn, of which the newest sound one counts."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from gearidae.engine.integrate.driver import Tally

__all__ = ["COUNTERS", "HEADER", "Checkpoint", "newest"]

Floats = NDArray[np.float64]

COUNTERS = tuple(field.name for field in fields(Tally) if field.type == "int")
_FIXED = ("checksum", "sequence", "samples", "events", "time", "wall_time", "words")
HEADER = len(_FIXED) + len(COUNTERS)
"""Numbers in front of the state."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Where a run can go on from.

    Attributes
    ----------
    sequence : int
        Number of the checkpoint, counted from 1; 0 for the start of the run.
    samples, events : int
        How many the run had produced there.
    time : float
        Simulated time [s].
    wall_time : float
        Wall time in the solver until then [s].
    tally : Tally
        The solver's counters there.
    state : ndarray
        What the engine needs; empty at the start.
    """

    sequence: int
    samples: int
    events: int
    time: float
    wall_time: float
    tally: Tally
    state: Floats

    @classmethod
    def start(cls) -> Checkpoint:
        """Return the checkpoint that every run has: nothing done yet."""
        return cls(0, 0, 0, 0.0, 0.0, Tally(), np.empty(0))

    def pack(self) -> bytes:
        """Return the record as it stands in its slot: a checksum over all that follows, then the numbers."""
        counters = [getattr(self.tally, name) for name in COUNTERS]
        fixed = [self.sequence, self.samples, self.events, self.time, self.wall_time, self.state.size]
        body: bytes = np.concatenate([fixed, counters, self.state]).astype("<f8").tobytes()
        return struct.pack("<d", zlib.crc32(body)) + body

    @classmethod
    def unpack(cls, record: bytes) -> Checkpoint | None:
        """Read a slot; None if it is empty, half written or damaged."""
        numbers = np.frombuffer(record, "<f8")
        if numbers.size < HEADER or not (1.0 <= numbers[1] < 2.0**53 and 0.0 <= numbers[6] < 2.0**40):
            return None
        size = HEADER + int(numbers[6])
        if size > numbers.size or zlib.crc32(record[8 : 8 * size]) != numbers[0]:
            return None
        sequence, samples, events = map(int, numbers[1:4])
        tally = Tally()
        for name, number in zip(COUNTERS, numbers[len(_FIXED) : HEADER], strict=True):
            setattr(tally, name, int(number))
        time, wall_time = map(float, numbers[4:6])
        return cls(sequence, samples, events, time, wall_time, tally, numbers[HEADER:size].astype(np.float64))


def newest(slots: Iterable[bytes]) -> Checkpoint:
    """Return the newest sound checkpoint of an archive, the start of the run if there is none."""
    sound = [point for slot in slots if (point := Checkpoint.unpack(slot)) is not None]
    return max(sound, key=lambda point: point.sequence, default=Checkpoint.start())
