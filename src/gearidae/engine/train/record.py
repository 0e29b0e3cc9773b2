"""Events of a train, and intervals at rest: those of its meshes as a pair records them, with their place.

A row of an event has the numbers of `gearidae.engine.events.record`, and behind them its mesh and its shaft, -1 for
none; one of a rest has the shaft, begin and end.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.engine.train.layout import TrainModel, TrainOutput
from gearidae.records import EVENT, EventKind, Flank

MESH_AT: Final = EVENT_NUMBERS
SHAFT_AT: Final = EVENT_NUMBERS + 1
TRAIN_EVENT_NUMBERS: Final = EVENT_NUMBERS + 2
"""Numbers of an event of a train."""
REST_NUMBERS: Final = 3
_TIME, _KIND, _PAIR, _FLANK, _GAP_RATE, _ASPERITY, _FORCE = EVENT
_NO_FLANK, _SLIP = float(Flank.NONE), float(EventKind.SLIP)


@compiled
def record_at_shaft(tm: TrainModel, t: float, kind: float, shaft: int, out: TrainOutput) -> None:
    """Write an event of a shaft at a time [s]; of one that slips the rest that ends there."""
    train, events, rests = tm.train[0], out.events, out.rests
    at = train.events
    if at < events.shape[0]:
        events[at, _TIME], events[at, _KIND], events[at, _PAIR] = t, kind, 0.0
        events[at, _FLANK], events[at, _GAP_RATE], events[at, _ASPERITY] = _NO_FLANK, 0.0, -1.0
        events[at, _FORCE], events[at, MESH_AT], events[at, SHAFT_AT] = math.nan, -1.0, float(shaft)
        train.events += 1
    at = train.rests
    if kind == _SLIP and at < rests.shape[0]:
        rests[at, 0], rests[at, 1], rests[at, 2] = float(shaft), tm.shafts[shaft].rest_begin, t
        train.rests += 1


@compiled
def take_from_mesh(tm: TrainModel, mesh: int, count: int, out: TrainOutput) -> None:
    """Take the events over that a mesh has recorded among the few of one time; those of no pair are of no mesh."""
    train, events, few = tm.train[0], out.events, tm.few
    for i in range(count):
        at = train.events
        if at >= events.shape[0]:
            return
        for j in range(EVENT_NUMBERS):
            events[at, j] = few[i, j]
        events[at, MESH_AT] = float(mesh) if few[i, _FLANK] != _NO_FLANK else -1.0
        events[at, SHAFT_AT] = -1.0
        train.events += 1
