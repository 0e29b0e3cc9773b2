"""Checkpoints in a growing archive: two slots, written in turn, of which the newest sound one counts."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np

from gearidae.records import Extremes, Statistics, Words

__all__ = ["COUNTERS", "HEADER", "Checkpoint", "newest"]

COUNTERS = tuple(field.name for field in fields(Statistics) if field.type == "int")
_FIXED = ("checksum", "sequence", "samples", "events", "time", "wall_time", "words")
_EXTREMES = {field.name: field.type for field in fields(Extremes) if field.name != "exposures"}
HEADER = len(_FIXED) + len(COUNTERS) + len(_EXTREMES)
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
    extremes : Extremes, optional
        Of the run until then, without exposures.
    """

    sequence: int
    samples: int
    events: int
    time: float
    wall_time: float
    statistics: Statistics
    state: Words
    extremes: Extremes | None = None

    @classmethod
    def start(cls) -> Checkpoint:
        """Return the checkpoint that every run has: nothing done yet."""
        return cls(0, 0, 0, 0.0, 0.0, Statistics(), np.empty(0))

    def pack(self) -> bytes:
        """Return the record as it stands in its slot: a checksum over all that follows, then the numbers."""
        counters = [getattr(self.statistics, name) for name in COUNTERS]
        fixed = [self.sequence, self.samples, self.events, self.time, self.wall_time, self.state.size]
        extremes = [getattr(self.extremes, name, np.nan) for name in _EXTREMES]
        words = np.ascontiguousarray(self.state).view("u8")  # as they are: some may be no numbers
        body = np.array([*fixed, *counters, *extremes], "<f8").tobytes() + words.astype("<u8").tobytes()
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
        first = len(_FIXED) + len(COUNTERS)
        for name, number in zip(COUNTERS, numbers[len(_FIXED) : first], strict=True):
            setattr(statistics, name, int(number))
        extremes = dict(zip(_EXTREMES, numbers[first:HEADER].tolist(), strict=True))
        time, wall_time = map(float, numbers[4:6])
        state = np.frombuffer(record, "<u8", size - HEADER, 8 * HEADER).astype(np.uint64).view(np.float64)
        return cls(sequence, samples, events, time, wall_time, statistics, state, _extremes_from(extremes))


def _extremes_from(numbers: dict[str, float]) -> Extremes | None:
    """Return extremes from numbers; None if there are none, of which the speed at the end is NaN."""
    if np.isnan(numbers["final_speed"]):
        return None
    return Extremes(**{name: int(one) if _EXTREMES[name] == "int" else one for name, one in numbers.items()})  # type: ignore[arg-type]


def newest(slots: Iterable[bytes]) -> Checkpoint:
    """Return the newest sound checkpoint of an archive, the start of the run if there is none."""
    sound = [point for slot in slots if (point := Checkpoint.unpack(slot)) is not None]
    return max(sound, key=lambda point: point.sequence, default=Checkpoint.start())
