"""Events of a run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import IntEnum, unique
from typing import ClassVar, Final

import numpy as np

from gearidae.laws.law import on_shaft
from gearidae.laws.shafts import SHAFT_LAWS
from gearidae.records.row_table import FLAG, RowColumn, Rows, indices_of


@unique
class EventKind(IntEnum):
    """Kind of an event, as stored in ``event_kind``; those of laws of a shaft are declared by them."""

    _ignore_ = "shaft declared"

    ONSET = 0
    SEPARATION = 1
    TURNING_POINT = 2
    FULL_STRETCH = 3
    MESH_ENTRY = 4
    MESH_EXIT = 5
    STICK = 6
    SLIP = 7
    FLANK_CHANGE = 8
    SCHEDULE_KNOT = 9
    ASPERITY_ONSET = 10
    ASPERITY_DETACHMENT = 11
    SLIDING_REVERSAL = 12
    FLANK_STICK = 13
    FLANK_SLIP = 14
    for declared in (event for law in SHAFT_LAWS for event in law.events):
        for shaft in (0, 1):
            vars()[on_shaft(shaft, declared.name).upper()] = declared.numbers[shaft]


class Flank(IntEnum):
    """Side of the tooth to which an event belongs."""

    NONE = -1
    DRIVE = 0
    COAST = 1


class Events(Rows):
    """Events in the order of time.

    Attributes
    ----------
    time : ndarray of float64
        Time of the event [s].
    kind : ndarray of int8
        An `EventKind`.
    pair : ndarray of int64
        Number of the tooth pair; the pair that starts in mesh is 0.
    flank : ndarray of int8
        A `Flank`.
    gap_rate : ndarray of float64
        Rate of change of that pair's gap [m/s]; negative while it closes.
    asperity : ndarray of int64, optional
        Number of the asperity on its flank, of a population; -1, the default, where an event is of no single one.
    force : ndarray of float64, optional
        Force of the pair at an onset or a separation [N]; NaN, the default, elsewhere.
    """

    dim = "event"
    field = "events"
    columns: ClassVar[Mapping[str, RowColumn]] = {
        "time": RowColumn(),
        "kind": RowColumn(FLAG),
        "pair": RowColumn(np.int64),
        "flank": RowColumn(FLAG),
        "gap_rate": RowColumn(),
        "asperity": RowColumn(np.int64, -1),
        "force": RowColumn(missing=math.nan),
    }


EVENT: Final = indices_of(*Events.columns)
"""Indices of the columns in an event's row: ``row[EVENT.kind]``."""
