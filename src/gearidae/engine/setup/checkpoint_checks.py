"""Bounds of what compiled code uses as an index, a count or a flag, looked at before a checkpoint is used.

Compiled code looks at no bounds of its own: whatever it counts by, branches on or makes an index from has its bound
here, wherever the checkpoint comes from. Other numbers are only finite. A forged number gives a wrong run, as a forged
archive does.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gearidae.engine.model.checkpoint_record import MOST_SLOW, MOST_STANDSTILLS, MOST_ZEROS
from gearidae.engine.model.record_types import AT_REST, FREE, STUCK
from gearidae.engine.model.state import EMPTY, GEARS, PHASE, STATE, Floats, Model, Record
from gearidae.errors import SceneError

_COUNT_HIGH: Final = 2**53
"""Counts, and pitches from which pairs are numbered, beyond which a double no longer counts."""
_LARGEST: Final = 1e200  # squares of what is really there are still finite
_HEIGHT_HIGH: Final = 1e6
"""Roughnesses: a step may have gone far below the tables before that was noticed."""
_FLAGS: Final = (
    *("slipping", "near", "bound_exceeded", "light", "begun", "is_stuck"),
    *("start", "spent", "high_known", "left"),
    *("in_contact", "fully_stretched", "stretched"),
)
_PITCHES: Final = ("turns", "mark_low", "mark_high")


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
    _check_numbers(state, STATE, _bounds(m))
    for name in _PITCHES:
        require(abs(state[name]) < _COUNT_HIGH, name, "a number of pitches")
    for which, last in enumerate(_last_segments(m)):
        require(0 <= state.segment[which] <= last, "segment", "one of the schedule")
    _check_size(state.history["joined"], _HEIGHT_HIGH, "joined")
    _check_size(y, _LARGEST, "the state vector")
    _check_size(rows, _HEIGHT_HIGH, "the nodes")
    _check_size(exposures, _LARGEST, "the exposures")
    if m.scene.kind == GEARS:
        require(abs(y[PHASE]) < _COUNT_HIGH, "phase", "a number of pitches")


def _bounds(m: Model) -> dict[str, tuple[int, int]]:
    """Least and largest value of integers that are no mere counts."""
    pairs = {"pair": (EMPTY, _COUNT_HIGH)}
    places = {
        "next_knot": (0, int(m.scene.knot_count)),
        "next_sample": (0, int(m.scene.samples)),
        "roots": (0, int(m.scene.root_limit)),
        "deep_exits": (-1, _COUNT_HIGH),
        "last_flank": (-1, 1),
        "slide": (-1, STUCK),
        "direction": (-1, 1),
        "zero_count": (0, MOST_ZEROS),
        "slow_count": (0, MOST_SLOW),
        "stand_count": (0, MOST_STANDSTILLS),
        "hold": (FREE, AT_REST),
        "held_pair": (0, int(m.scene.histories) - 1),
    }
    return pairs | places | dict.fromkeys(_FLAGS, (0, 1))


def _last_segments(m: Model) -> list[int]:
    """Last segment of each schedule: behind all its knots, of a cubic one behind its first and its last."""
    return [2 if own.cubic else int(own.knot_count) for own in m.scene.schedule]


def _check_numbers(record: Record, dtype: np.dtype[Any], bounds: dict[str, tuple[int, int]]) -> None:
    """Check all fields of a record, or of all records of an array at once."""
    for name in dtype.names or ():
        values, kind = record[name], dtype[name].base
        if kind.names:
            _check_numbers(values, kind, bounds)
        elif kind.kind == "f":
            _check_size(values, _LARGEST, name)
        else:
            low, high = bounds.get(name, (0, _COUNT_HIGH))
            require(bool((low <= values).all() and (values <= high).all()), name, f"from {low} to {high}")


def _check_size(values: Floats, most: float, what: str) -> None:
    """Let every number be finite, and none larger than `most`."""
    require(bool((np.abs(values) < most).all()), what, "finite" if most == _LARGEST else f"below {most:g}")
