"""Solution of a run of a train: samples over its shafts and meshes, events with their place, totals of each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.records.extremes import Extremes
from gearidae.records.results import Solution, Words
from gearidae.records.statistics import Statistics

SHAFT_SAMPLES: Final = ("shaft_speed", "shaft_angle", "hub_load", "hub_load_angle")
"""Samples of each shaft, shape (shafts, n): [rad/s], [rad], [N], and the load's angle in the frame [rad]."""
MESH_SAMPLES: Final = ("mesh_force", "transmission_error", "drive_gap", "coast_gap", "pairs_in_contact")
"""Samples of each mesh, shape (meshes, n): the force with the damping of the mesh [N], lengths [m], and a count."""
COMMON_SAMPLES: Final = ("drive_torque", "load_torque", "pin_load")
"""Samples of the train, shape (n,): [N m], [N m] and [N]."""
WORKS_OF_SHAFTS: Final = ("hub_loss", "hub_sliding", "resistance_loss", "drag_loss")
WORKS_OF_MESHES: Final = ("adhesion_loss", "damping_loss", "film_loss", "work_in", "work_out")
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
        ``flank`` (a `Flank`), ``pair``, ``gap_rate`` [m/s] and ``force`` [N], as for `Events`.
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

    @classmethod
    def none(cls, shafts: Sequence[str], meshes: Sequence[str], status: str, message: str) -> TrainSolution:
        """Solution of a run that produced nothing: numbers are NaN, counts 0."""
        counts, nothing = {"mesh_exits"}, np.empty(0)
        totals = {
            side: {name: np.full(len(parts), 0.0 if name in counts else np.nan) for name in names}
            for side, parts, names in (("shafts", shafts, SHAFT_TOTALS), ("meshes", meshes, MESH_TOTALS))
        }
        whole: NDArray[Any] = np.empty(0, np.int64)
        events: dict[str, NDArray[Any]] = dict.fromkeys(("kind", "pair", "flank", "mesh", "shaft"), whole)
        return cls(
            shafts=tuple(shafts),
            meshes=tuple(meshes),
            time=nothing,
            samples={
                **{name: np.empty((len(shafts), 0)) for name in SHAFT_SAMPLES},
                **{name: np.empty((len(meshes), 0)) for name in MESH_SAMPLES},
                **dict.fromkeys(COMMON_SAMPLES, nothing),
            },
            events={**events, **dict.fromkeys(("time", "gap_rate", "force"), nothing)},
            shaft_totals=totals["shafts"],
            mesh_totals=totals["meshes"],
            energy=dict.fromkeys(ENERGIES, math.nan),
            rests={"shaft": whole, "begin": nothing, "end": nothing},
            status=status,
            message=message,
            reached=0.0,
            start=0.0,
            statistics=Statistics(),
        )


AnySolution: TypeAlias = Solution | TrainSolution
"""Result of a run of whatever scene."""
