"""Solution of a run of a train: samples over its shafts and meshes, events with their mesh or shaft, totals of each.

An engine hands it up block by block, in tables; what the columns are is said here, for whoever reads a block.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.records.events import Events
from gearidae.records.extremes import Extremes
from gearidae.records.results import Solution, Words
from gearidae.records.statistics import Statistics

SHAFT_SAMPLES: Final = ("shaft_speed", "shaft_angle", "hub_load", "hub_load_angle", "hub_friction")
"""Samples of each shaft, shape (shafts, n): [rad/s], [rad], [N], the load's angle in the frame [rad], and the
coefficient of friction of the hub [1]."""
MESH_SAMPLES: Final = (
    "mesh_force",
    "transmission_error",
    "drive_gap",
    "coast_gap",
    "pairs_in_contact",
    "asperities_in_contact",
)
"""Samples of each mesh, shape (meshes, n): the force with the damping of the mesh [N], lengths [m], and two counts, the
last of asperities that are followed one by one."""
COMMON_SAMPLES: Final = ("drive_torque", "load_torque", "pin_load", "pin_friction")
"""Samples of the train, shape (n,): [N m], [N m], [N] and the coefficient of friction of the pin [1]."""
WORKS_OF_SHAFTS: Final = ("hub_loss", "hub_sliding", "resistance_loss", "drag_loss")
WORKS_OF_MESHES: Final = (
    "adhesion_loss",
    "damping_loss",
    "film_loss",
    "friction_loss",
    "work_in",
    "work_out",
)
"""Totals that are followed with the energy balance; NaN without it, as all of `ENERGIES` are."""
SHAFT_TOTALS: Final = ("min_speed", "max_speed", *WORKS_OF_SHAFTS, "rest_time")
"""Totals of each shaft: [rad/s], [J], the load integrated over the way of the hub [N m], [J], [J] and [s]."""
MESH_TOTALS: Final = (
    "largest_mesh_force",
    "largest_mesh_force_time",
    "smallest_mesh_force",
    "smallest_mesh_force_time",
    "smallest_separation",
    "mesh_exits",
    "asperity_onsets",
    "asperity_detachments",
    *WORKS_OF_MESHES,
)
"""Totals of each mesh in SI units: ``work_in`` is the work of its driver, ``work_out`` that on its driven gear."""
ENERGIES: Final = (
    "drive_work",
    "radius_work",
    "load_work",
    "kinetic_change",
    "stored_change",
    "pin_loss",
    "throughput",
    "residual",
    "residual_bound",
)
"""Energies of the whole train [J]; ``load_work`` is what the dry resistance and the drags of the load have taken."""
EVENT_COLUMNS: Final = (*Events.columns, "mesh", "shaft")
"""Columns of a table of events: those of a pair's, and behind them mesh and shaft."""
_KEPT_OF_EVENTS: Final = ("time", "kind", "pair", "flank", "gap_rate", "asperity", "force", "mesh", "shaft")
_WHOLE: Final = ("kind", "pair", "flank", "asperity", "mesh", "shaft")
REST_COLUMNS: Final = ("shaft", "begin", "end")


class TrainTotals(NamedTuple):
    """What a run has added up to at a time.

    Attributes
    ----------
    shafts, meshes : dict of str to ndarray
        `SHAFT_TOTALS` and `MESH_TOTALS`.
    energy : dict of str to float
        `ENERGIES`.
    resting : ndarray, shape (n, 3)
        `REST_COLUMNS` of the shafts that are held then, each until then.
    """

    shafts: dict[str, NDArray[np.float64]]
    meshes: dict[str, NDArray[np.float64]]
    energy: dict[str, float]
    resting: NDArray[np.float64]

    @classmethod
    def none(cls, shafts: int, meshes: int) -> TrainTotals:
        """Totals of a run that has not begun: numbers are NaN, counts 0."""
        counts = {"mesh_exits", "asperity_onsets", "asperity_detachments"}
        of_shafts, of_meshes = (
            {name: np.full(count, 0.0 if name in counts else np.nan) for name in names}
            for count, names in ((shafts, SHAFT_TOTALS), (meshes, MESH_TOTALS))
        )
        return cls(of_shafts, of_meshes, dict.fromkeys(ENERGIES, math.nan), np.empty((0, len(REST_COLUMNS))))


class TrainBlock(NamedTuple):
    """What a run has left since the block before.

    Attributes
    ----------
    time : float
        Reached [s].
    wall_time : float
        In the solver until then [s].
    tables : dict of str to ndarray, shape (n, columns)
        ``samples`` and ``looks`` (those of the track): `SHAFT_SAMPLES` of each shaft, `MESH_SAMPLES` of each mesh, and
        `COMMON_SAMPLES`; ``zeros``: times and angles of the track; ``events``: `EVENT_COLUMNS`; ``rests``:
        `REST_COLUMNS` of rests that have ended.
    checkpoint : ndarray of 8-byte words
        From which the run goes on to the same last bit.
    totals : TrainTotals
    """

    time: float
    wall_time: float
    tables: dict[str, NDArray[np.float64]]
    checkpoint: Words
    totals: TrainTotals


TABLES: Final = ("samples", "looks", "zeros", "events", "rests")
"""Tables of a block."""


def sample_columns(shafts: int, meshes: int) -> int:
    """Count the columns of a table of samples."""
    return len(SHAFT_SAMPLES) * shafts + len(MESH_SAMPLES) * meshes + len(COMMON_SAMPLES)


def columns_of(table: str, shafts: int, meshes: int) -> int:
    """Count the columns of one of the tables of a block, or of its shafts at rest."""
    if table in ("samples", "looks"):
        return sample_columns(shafts, meshes)
    return {"zeros": 2, "events": len(EVENT_COLUMNS)}.get(table, len(REST_COLUMNS))


class Track(NamedTuple):
    """Motion of a train by which its run is judged: as many looks at every run, whatever is sampled.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s].
    samples : dict of str to ndarray
        As those of `TrainSolution`.
    zero_time, zero_angle : ndarray, shape (k,)
        Times [s] and angles [rad] at which the speed of the judged shaft changes its sign.
    """

    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    zero_time: NDArray[np.float64]
    zero_angle: NDArray[np.float64]


NO_TRACK: Final = Track(np.empty(0), {}, np.empty(0), np.empty(0))
"""Of a run that has been judged, or has not begun."""


@dataclass(frozen=True, slots=True)
class TrainSolution:
    """Result of one run of a train.

    Attributes
    ----------
    shafts, meshes : tuple of str
        Names, in the order of the arrays.
    time : ndarray, shape (n,)
        Sample times [s].
    samples : dict of str to ndarray
        `SHAFT_SAMPLES` in the shape (shafts, n), `MESH_SAMPLES` in (meshes, n), and `COMMON_SAMPLES` in (n,).
    events : dict of str to ndarray, shape (m,)
        In the order of time: ``time`` [s], ``kind`` (an `EventKind`), ``mesh`` and ``shaft`` (numbers, -1 for none),
        ``flank`` (a `Flank`), ``pair``, ``gap_rate`` [m/s], ``asperity`` and ``force`` [N], as for `Events`.
    shaft_totals, mesh_totals : dict of str to ndarray, shape (shafts,) and (meshes,)
        Those of `SHAFT_TOTALS` and `MESH_TOTALS`.
    energy : dict of str to float
        Those of `ENERGIES`; without the balance they are NaN, and so are works and losses of shafts and meshes.
    rests : dict of str to ndarray, shape (k,)
        Every interval in which a shaft was at rest: ``shaft``, ``begin`` and ``end`` [s], in the order of their ends.
    status, message : str
        As for `Solution`.
    reached, start : float
        Time reached, and that at which the run began [s].
    statistics : Statistics
    track : Track, optional
        What the run is judged by.
    extremes : Extremes, optional
        Of the judged shaft; None of a run that has not been judged.
    held_by : tuple of str
        Names of what holds the judged shaft.
    checkpoint : ndarray of 8-byte words, optional
        State at the end, from which another run can go on; None where there is none.
    flanks_held : tuple of int, optional
        Numbers of the meshes of which friction holds a pair of flanks at the end.
    """

    shafts: tuple[str, ...]
    meshes: tuple[str, ...]
    time: NDArray[np.float64]
    samples: dict[str, NDArray[np.float64]]
    events: dict[str, NDArray[np.float64]]
    shaft_totals: dict[str, NDArray[np.float64]]
    mesh_totals: dict[str, NDArray[np.float64]]
    energy: dict[str, float]
    rests: dict[str, NDArray[np.float64]]
    status: str
    message: str
    reached: float
    start: float
    statistics: Statistics
    track: Track = NO_TRACK
    extremes: Extremes | None = None
    held_by: tuple[str, ...] = ()
    checkpoint: Words | None = None
    flanks_held: tuple[int, ...] = ()

    @classmethod
    def none(cls, shafts: Sequence[str], meshes: Sequence[str], status: str, message: str) -> TrainSolution:
        """Solution of a run that produced nothing: numbers are NaN, counts 0."""
        sizes, nothing = (len(shafts), len(meshes)), np.empty(0)
        return solution_of(
            shafts,
            meshes,
            nothing,
            nothing,
            [np.empty((0, columns_of(table, *sizes))) for table in TABLES],
            TrainTotals.none(*sizes),
            status=status,
            message=message,
            reached=0.0,
            start=0.0,
            statistics=Statistics(),
        )


def solution_of(
    shafts: Sequence[str],
    meshes: Sequence[str],
    time: NDArray[np.float64],
    distances_time: NDArray[np.float64],
    tables: Sequence[NDArray[np.float64]],
    totals: TrainTotals,
    *,
    status: str,
    message: str,
    reached: float,
    start: float,
    statistics: Statistics,
    checkpoint: Words | None = None,
    flanks_held: tuple[int, ...] = (),
) -> TrainSolution:
    """Put a solution together.

    Parameters
    ----------
    shafts, meshes : sequence of str
        Names.
    time, distances_time : ndarray
        Times of the samples and of the looks [s], of which the run may have reached the first ones alone.
    tables : sequence of ndarrays
        `TABLES`, as in a `TrainBlock`.
    totals : TrainTotals
    status, message, reached, start, statistics, checkpoint, flanks_held
        Of the solution.
    """
    samples, looks, zeros, events, rests = tables
    sizes = len(shafts), len(meshes)
    at = {name: EVENT_COLUMNS.index(name) for name in _KEPT_OF_EVENTS}
    rested = np.concatenate([rests, totals.resting])
    return TrainSolution(
        shafts=tuple(shafts),
        meshes=tuple(meshes),
        time=time[: len(samples)],
        samples=_columns(samples, *sizes),
        track=Track(distances_time[: len(looks)], _columns(looks, *sizes), *zeros.T.copy()),
        events={
            name: events[:, i].astype(np.int64) if name in _WHOLE else events[:, i].copy()
            for name, i in at.items()
        },
        shaft_totals=totals.shafts,
        mesh_totals=totals.meshes,
        energy=totals.energy,
        rests={
            "shaft": rested[:, 0].astype(np.int64),
            "begin": rested[:, 1].copy(),
            "end": rested[:, 2].copy(),
        },
        status=status,
        message=message,
        reached=reached,
        start=start,
        statistics=statistics,
        checkpoint=checkpoint,
        flanks_held=flanks_held,
    )


def _columns(table: NDArray[np.float64], shafts: int, meshes: int) -> dict[str, NDArray[np.float64]]:
    """Columns of samples by their names."""
    count, first = len(table), len(SHAFT_SAMPLES) * shafts
    last = first + len(MESH_SAMPLES) * meshes
    of_shafts = table[:, :first].reshape(count, shafts, len(SHAFT_SAMPLES))
    of_meshes = table[:, first:last].reshape(count, meshes, len(MESH_SAMPLES))
    common = table[:, last:]
    return {
        **{name: np.ascontiguousarray(of_shafts[:, :, i].T) for i, name in enumerate(SHAFT_SAMPLES)},
        **{name: np.ascontiguousarray(of_meshes[:, :, i].T) for i, name in enumerate(MESH_SAMPLES)},
        **{name: np.ascontiguousarray(common[:, i]) for i, name in enumerate(COMMON_SAMPLES)},
    }


AnySolution: TypeAlias = Solution | TrainSolution
"""Result of a run of whatever scene."""
