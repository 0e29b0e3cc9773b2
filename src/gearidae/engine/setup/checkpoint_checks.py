"""Bounds of what compiled code uses as an index, a count or a flag, looked at before a checkpoint is used.

Compiled code looks at no bounds of its own: whatever it counts by, branches on or makes an index from has its bound
in the declarations of `gearidae.engine.model.checkpoint_record`, wherever the checkpoint comes from. Other numbers are
only finite. A forged number gives a wrong run, as a forged archive does.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from gearidae.engine.model.state import PHASE, STATE_FIELDS, Floats, Model, Record
from gearidae.errors import SceneError
from gearidae.records.quantity import COUNT_HIGH, LARGEST, REAL, Quantity

_NODES_HIGH: Final = 1e6
"""Roughnesses: a step may have gone far below the tables before that was noticed."""


def require(condition: bool, what: str, allowed: str) -> None:
    """Refuse a checkpoint whose `what` is not what is allowed there."""
    if not condition:
        raise refused(what, f"not what a run of this scene leaves there: it must be {allowed}")


def refused(what: str, why: str) -> SceneError:
    """Return the error for a checkpoint that is not taken."""
    return SceneError("checkpoint", what, why)


def check(m: Model, state: Record, y: Floats, rows: Floats, exposures: Floats) -> None:
    """Check the bounds of a checkpoint.

    Parameters
    ----------
    m : Model
        Of the scene.
    state : record
        ``STATE`` of the checkpoint.
    y : ndarray, shape (n,)
        Its state vector.
    rows, exposures : ndarray
        What it keeps of nodes and flanks.

    Raises
    ------
    SceneError
        If an index, a count or a flag is out of bounds, or a number is not finite.
    """
    _check_fields(state, STATE_FIELDS, m.scene)
    for which, last in enumerate(_last_segments(m)):
        require(0 <= state.segment[which] <= last, "segment", "one of the schedule")
    _check_size(y, LARGEST, "the state vector")
    _check_size(rows, _NODES_HIGH, "the nodes")
    _check_size(exposures, LARGEST, "the exposures")
    require(abs(y[PHASE]) < COUNT_HIGH, "phase", "a number of pitches")


def _last_segments(m: Model) -> list[int]:
    """Last segment of each schedule: behind all its knots, of a cubic one behind its first and its last."""
    return [2 if schedule.cubic else int(schedule.knot_count) for schedule in m.scene.schedule]


def _check_fields(record: Record, fields: Iterable[Quantity], scene: Record) -> None:
    """Check all fields of a record, or of all records of an array at once."""
    for field in fields:
        values, high = record[field.name], field.high(scene) if callable(field.high) else field.high
        if isinstance(field.kind, tuple):
            _check_fields(values, field.kind, scene)
        elif field.kind == REAL:
            _check_size(values, high, field.name)
        else:
            within = (field.low <= values).all() and (values <= high).all()
            require(bool(within), field.name, f"from {field.low} to {high}")


def _check_size(values: Floats, most: float, what: str) -> None:
    """Let every number be finite, and none larger than `most`."""
    require(bool((np.abs(values) < most).all()), what, "finite" if most == LARGEST else f"below {most:g}")
