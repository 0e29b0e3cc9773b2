"""The table of passages: a row at each mesh exit, with all terms of the energy balance up to it.

The balance has been brought to the mesh exit, at which its powers may jump, so that a row asks for what the contacts
store there and nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.mesh_marks import MARKS
from gearidae.engine.model.addresses import numbers_of
from gearidae.engine.model.record_types import Record
from gearidae.engine.model.state import STATE, WORK, Floats, Model
from gearidae.engine.observers.balance import note_changes
from gearidae.engine.observers.extremes.forces import force_of_law, note_since
from gearidae.records import EVENT, EventKind
from gearidae.records.passages import CHANGES, COLUMNS, PASSAGE, SUMS
from gearidae.records.quantity import Quantity

PASSAGE_NUMBERS: Final = len(PASSAGE)
"""Numbers of a passage."""
PASSAGES_AT_ONCE: Final = MARKS
"""Most that can be at one accepted time: one for each kind of mesh mark."""
_MESH_EXIT: Final = float(EventKind.MESH_EXIT)
_KIND, _PAIR, _FLANK = EVENT.kind, EVENT.pair, EVENT.flank


def _words(record: np.dtype, fields: Sequence[Quantity]) -> tuple[int, ...]:
    """Index of each number of some fields among the numbers of a record."""
    assert record.fields is not None
    firsts = [record.fields[field.name][1] // 8 for field in fields]
    return tuple(
        first + i for first, field in zip(firsts, fields, strict=True) for i in range(len(field.names))
    )


_SUMS: Final = _words(STATE["energy"], SUMS)
_CHANGES: Final = _words(WORK["energy_now"], CHANGES)
_FIRST_SUM: Final = PASSAGE_NUMBERS - len(_SUMS) - len(_CHANGES)
_FIRST_CHANGE: Final = PASSAGE_NUMBERS - len(_CHANGES)
_UNITS: Final = tuple(dict.fromkeys(field.unit for field in COLUMNS))
_UNIT_OF: Final = np.array([_UNITS.index(field.unit) for field in COLUMNS for _ in field.names])
_ADHESION: Final = PASSAGE.adhesion_loss
_RADIUS: Final = PASSAGE.radius_work


def units(scene: Record) -> Floats:
    """Units of the columns in SI units, of a scene."""
    return np.array([unit.in_si(scene) for unit in _UNITS])[_UNIT_OF]


@compiled
def write_passages(
    m: Model, t: float, y: Floats, events: Floats, new: tuple[int, int], rows: Floats, count: int
) -> int:
    """Write a row for each mesh exit among the events of an accepted time, and return the new number of rows.

    Parameters
    ----------
    m : Model
        Behind all that has happened there; the windows of the flanks begin anew.
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State there.
    events : ndarray, shape (n, EVENT_NUMBERS)
    new : tuple of int
        First of these events, and how many events there are.
    rows : ndarray, shape (n, PASSAGE_NUMBERS)
        Scaled numbers; drivers keep room for `PASSAGES_AT_ONCE`.
    count : int
        Rows already there.
    """
    for i in range(new[0], new[1]):
        if events[i, _KIND] == _MESH_EXIT and count < rows.shape[0]:
            rows[count, PASSAGE.pair], rows[count, PASSAGE.flank] = events[i, _PAIR], events[i, _FLANK]
            _fill(m, t, y, int(events[i, _FLANK]), rows[count])
            count += 1
    return count


@compiled_once(SOLVER)
def _fill(m: Model, t: float, y: Floats, flank: int, row: Floats) -> None:
    """Write what has been since the last mesh exit of a flank and the running sums, and begin anew with the force."""
    p = m.state.passage[flank]
    row[PASSAGE.time] = t
    row[PASSAGE.largest_force], row[PASSAGE.smallest_force] = p.largest_force, p.smallest_force
    row[PASSAGE.impacts] = p.impacts
    if m.scene.follow.balance != 0:
        adhesion, radius = note_changes(m, y)
        sums, changes = numbers_of(m.state.energy), numbers_of(m.work.energy_now)
        for i in range(len(_SUMS)):
            row[_FIRST_SUM + i] = sums[_SUMS[i]]
        for i in range(len(_CHANGES)):
            row[_FIRST_CHANGE + i] = changes[_CHANGES[i]]
        row[_ADHESION] += adhesion
        row[_RADIUS] += radius
    else:
        for i in range(_FIRST_SUM, row.size):
            row[i] = np.nan
    p.begun = p.impacts = 0
    note_since(m, flank, force_of_law(m, t, y))
