"""The newest checkpoint of a run under way, kept beside its archive."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from gearidae.archive.commits import Commit, with_lengths
from gearidae.archive.store import Store
from gearidae.records import COUNTERS, EnergyBalance, Extremes, Statistics, Words

_COUNTERS: Final = tuple(quantity.name for quantity in COUNTERS)
_PREFIX: Final = "checkpoint_"
RUN: Final = "run"
"""Attribute of an archive by which its run's checkpoint is found."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Where a run can go on from.

    Attributes
    ----------
    lengths : mapping of str to int
        How much the run had produced along each dimension that grows.
    time : float
        Simulated time [s].
    wall_time : float
        Wall time in the solver until then [s].
    statistics : Statistics
        The solver's counters there.
    state : ndarray of 8-byte words
        What the engine needs, kept to the last bit and never looked into.
    extremes : Extremes, optional
        Of the run until then, without exposures.
    checksums : mapping of str to int
        Of all that until then, see `gearidae.archive.commits.Commit`.
    balance : EnergyBalance, optional
        Of the run until then.
    """

    lengths: Mapping[str, int]
    time: float
    wall_time: float
    statistics: Statistics
    state: Words
    extremes: Extremes | None = None
    checksums: Mapping[str, int] = field(default_factory=dict)
    balance: EnergyBalance | None = None

    @property
    def commit(self) -> Commit:
        """State of the archive at the checkpoint."""
        return Commit(self.lengths, self.checksums)

    def keep(self, archive: Path, run: str) -> None:
        """Write it beside the archive of a run, in the place of the one before, once it is on the disk.

        Parameters
        ----------
        run : str
            Tells one run from another into the same archive.

        Raises
        ------
        OSError
            If the disk does not take it.
        """
        header = {
            "lengths": self.lengths,
            "time": self.time,
            "wall_time": self.wall_time,
            "checksums": self.checksums,
            "statistics": {name: getattr(self.statistics, name) for name in _COUNTERS},
            "balance": self.balance,
            "extremes": self.extremes and {**self.extremes, "exposures": ()},
        }
        # as words: some may be no numbers
        words = np.ascontiguousarray(self.state).view(np.uint64)
        Store(archive).put(_key(run), header, {"state": words}, durable=True)

    @classmethod
    def newest(cls, archive: Path, run: str) -> Checkpoint | None:
        """Read the newest checkpoint of a run; None if there is none, or no longer a whole one."""
        try:
            entry = Store(archive).take(_key(run))
            if entry is None:
                return None
            header, tables = entry
            statistics, extremes = Statistics(**header.pop("statistics")), header.pop("extremes")
            balance = header.pop("balance")
            return cls(
                **with_lengths(header),
                statistics=statistics,
                balance=balance and EnergyBalance(balance),
                state=tables["state"].view(np.float64),
                extremes=extremes and Extremes(extremes),
            )
        except Exception:  # what a damaged file makes the libraries raise may be anything
            return None


def _key(run: str) -> str:
    """Where the checkpoint of a run is; a hash, as its name comes from a file and must lead nowhere else."""
    return _PREFIX + hashlib.sha256(run.encode(errors="replace")).hexdigest()


def drop_checkpoints(archive: Path) -> None:
    """Delete the checkpoints beside an archive: those of its run, which is over, or of runs that it has replaced."""
    store = Store(archive)
    store.remove([key for key in store.entries() if key.startswith(_PREFIX)])
