"""The records of a run: constants, what a checkpoint carries, and work space, each declared in a file of its own.

Compiled code reads and writes them by name, ``m.state.history[k].joined[material]``, through a `Model`: three records
and two arrays of variable length. ``SCENE`` holds constants, made from the scene and never read from a file. ``STATE``
is all that a checkpoint carries, besides the state vector and the nodes of an elastic contact. ``WORK`` can be
worked out anew from both. Everything is scaled: lengths by the roughness sigma, forces by a reference load of the scene
and time by ``tau = sqrt(m sigma / F)``, so that states, rates and forces are of order one whatever the speed.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.compiled import name_type
from gearidae.engine.model.checkpoint_record import EXTREMES, HISTORY, STATE, STATE_FIELDS, STOPS
from gearidae.engine.model.record_types import (
    COAST,
    DRIVE,
    EMPTY,
    GEARS,
    LOAD,
    MATERIALS,
    MOST_ORDERS,
    MOTION,
    PHASE,
    ROLLER,
    SCHEDULES,
    SLOTS_HIGH,
    SPEED,
    Record,
    U,
    V,
    W,
)
from gearidae.engine.model.scene_record import MATERIAL, SCENE, TORQUE
from gearidae.engine.model.work_record import ADAMS, WORK

__all__ = [
    "ADAMS",
    "COAST",
    "DRIVE",
    "EMPTY",
    "EXTREMES",
    "GEARS",
    "HISTORY",
    "LOAD",
    "MATERIAL",
    "MATERIALS",
    "MOST_ORDERS",
    "MOTION",
    "PHASE",
    "ROLLER",
    "SCENE",
    "SCHEDULES",
    "SLOTS_HIGH",
    "SPEED",
    "STATE",
    "STATE_FIELDS",
    "STOPS",
    "TORQUE",
    "WORK",
    "Floats",
    "Model",
    "Record",
    "U",
    "V",
    "W",
    "assign",
    "blank_model",
    "blank_work",
    "copied",
    "empty_history",
    "plain",
]


class Model(NamedTuple):
    """One scene as compiled code sees it.

    Attributes
    ----------
    scene, state, work : record
        `SCENE`, `STATE` and `WORK`.
    tables : ndarray
        Constants of variable length; where each begins is in `scene`.
    rows : ndarray
        Numbers of variable length that change: branches of the histories, nodes of elastic contacts, error weights.
    """

    scene: Record
    state: Record
    work: Record
    tables: Floats
    rows: Floats


def assign(record: Record, other: Record) -> None:
    """Copy all fields of a record into another of the same kind."""
    record.setfield(other, record.dtype)


def copied(record: Record) -> Record:
    """Copy of a record; numpy's own goes field by field, which takes twenty times as long."""
    return np.frombuffer(bytearray(record.tobytes()), record.dtype)[0]


def plain(record: Record) -> SimpleNamespace:
    """Fields of a record as Python's numbers; outside compiled code each look at a record takes a microsecond."""
    return SimpleNamespace(**dict(zip(record.dtype.names, record.item(), strict=True)))


def blank_work(work: Record) -> None:
    """Forget what a run has left in the work records; how a driver searches and where torque laws lie stay."""
    fresh = np.zeros(1, WORK)[0]
    fresh["torque_law"], fresh["torque_switch"] = work["torque_law"], work["torque_switch"]
    for name in ("as_ida", "sharpness"):
        fresh.search[name] = work.search[name]
    fresh.driver.pending = -1  # the driver is to start
    assign(work, fresh)


def empty_history() -> Record:
    """History that is about no pair."""
    empty = np.zeros(1, HISTORY)[0]
    empty.pair = EMPTY
    return empty


def blank_model(scene: Record, tables: Floats, rows: int) -> Model:
    """Model with these constants, nothing known of any pair, and so many numbers that change."""
    state, work = np.zeros(1, STATE)[0], np.zeros(1, WORK)[0]
    state.history["pair"] = EMPTY
    state.last_flank = state.deep_exits = -1
    return Model(scene, state, work, tables, np.zeros(rows))


name_type(blank_model(np.zeros(1, SCENE)[0], np.zeros(0), 0), "Model")
