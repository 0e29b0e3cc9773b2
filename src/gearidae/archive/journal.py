"""Checkpoints in a growing archive: two slots, written in turn, of which the newest sound one counts."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np

from gearidae.records import Statistics, Words

__all__ = ["COUNTERS", "HEADER", "Checkpoint", "newest"]

COUNTERS = tuple(field.name for field in fields(Statistics) if field.type == "int")
_FIXED = ("checksum", "sequence", "samples", "events", "time", "wall_time", "words")
HEADER = len(_FIXED) + len(COUNTERS)
"""Words in front of the state."""


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
    statistics : Statistics
        The solver's counters there.
    state : ndarray of 8-byte words
        What the engine needs, kept to the last bit and never looked into; empty at the start.
    """

    sequence: int
    samples: int
    events: int
    time: float
    wall_time: float
    statistics: Statistics
    state: Words

    @classmethod
    def start(cls) -> Checkpoint:
        """Return the checkpoint that every run has: nothing done yet."""
        return cls(0, 0, 0, 0.0, 0.0, Statistics(), np.empty(0))

    def pack(self) -> bytes:
        """Return the record as it stands in its slot: a checksum over all that follows, then the numbers."""
        counters = [getattr(self.statistics, name) for name in COUNTERS]
        fixed = [self.sequence, self.samples, self.events, self.time, self.wall_time, self.state.size]
        words = np.ascontiguousarray(self.state).view("u8")  # as they are: some may be no numbers
        body = np.array([*fixed, *counters], "<f8").tobytes() + words.astype("<u8").tobytes()
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
        statistics = Statistics()
        for name, number in zip(COUNTERS, numbers[len(_FIXED) : HEADER], strict=True):
            setattr(statistics, name, int(number))
        time, wall_time = map(float, numbers[4:6])
        state = np.frombuffer(record, "<u8", size - HEADER, 8 * HEADER).astype(np.uint64).view(np.float64)
        return cls(sequence, samples, events, time, wall_time, statistics, state)


def newest(slots: Iterable[bytes]) -> Checkpoint:
    """Return the newest sound checkpoint of an archive, the start of the run if there is none."""
    sound = [point for slot in slots if (point := Checkpoint.unpack(slot)) is not None]
    return max(sound, key=lambda point: point.sequence, default=Checkpoint.start())
