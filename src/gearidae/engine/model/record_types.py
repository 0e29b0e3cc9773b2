"""What the records of a run share: kinds, flanks and shafts by number, indices of the state vector, kinds of fields."""

from __future__ import annotations

from typing import Any, Final, TypeAlias

import numpy as np

from gearidae.laws.law import DRIVE as DRIVE
from gearidae.laws.law import LOAD as LOAD
from gearidae.laws.law import SCHEDULES as SCHEDULES
from gearidae.laws.law import SPEED as SPEED
from gearidae.records.quantity import INT as INT
from gearidae.records.quantity import REAL as REAL
from gearidae.records.quantity import Quantity
from gearidae.scene.coating import MATERIAL_NAMES
from gearidae.scene.limits import MOST_PAIRS

Record: TypeAlias = Any
"""A numpy record; compiled code checks its names."""

GEARS: Final = 0
ROLLER: Final = 1
"""Kinds of scene."""

COAST: Final = 1
"""The other flank than that of the `DRIVE`."""

MATERIALS: Final = len(MATERIAL_NAMES)
"""Materials that may share the interface: bare first, then coated, then mixed."""

SLOTS_HIGH: Final = MOST_PAIRS
"""Tooth pairs per flank whose history can be kept, a power of two."""

EMPTY: Final = -(2**62)
"""Pair number of a history that is about no pair."""

MOST_ORDERS: Final = 8
"""Highest number of former rates that a formula uses."""

STUCK: Final = 2
"""Value of ``slide`` of a pair that rolls without sliding."""

FREE: Final = 0
HELD_PAIR: Final = 1
HELD_GEAR: Final = 2
HELD_PINION: Final = 3
AT_REST: Final = 4
"""What friction holds: nothing; the sliding of one pair, which rolls; the gear; the pinion; or both gears."""

# -- the state vector ------------------------------------------------------------------------------------------------
U: Final = 0  # dynamic transmission error (a roller's height with the other sign) / sigma
V: Final = 1  # its rate
PHASE: Final = 2  # gear's turn in base pitches, less the whole ones in `STATE`
W: Final = 3  # gear's surface velocity at the base circle
MOTION: Final = 4  # states of a motion
# then, for an elastic contact, the deflection of both bodies / sigma at every node of every history's pair


def record_type(*fields: tuple[Any, ...] | Quantity) -> np.dtype[Any]:
    """Record type whose fields are attributes, in compiled code and in Python alike."""
    plain = [_plain(field) if isinstance(field, Quantity) else field for field in fields]
    return np.dtype((_Fields, np.dtype(plain, align=True)))


def _plain(field: Quantity) -> tuple[Any, ...]:
    kind = record_type(*field.kind) if isinstance(field.kind, tuple) else field.kind
    return field.name, kind, field.shape


class _Fields(np.void):  # type: ignore[misc]  # final in numpy's stubs; numpy.record is another such class
    """A record whose fields are attributes.

    numpy's own runs Python code for every attribute, also where numba asks for the memory of a record: a
    `KeyboardInterrupt` that is raised there is lost as soon as numba asks the next record of the same call. Here the
    attributes of numpy's scalars are found without Python, and the others are fields.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except (KeyError, ValueError):
            raise AttributeError(f"the record has no field {name}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        self[name] = value
