"""Passages: what a run has done up to each mesh exit of a tooth pair."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import ClassVar, Final

import numpy as np

from gearidae.records.energy import ENERGY_NOW, ENERGY_SUMS
from gearidae.records.quantity import FORCE, INT, TIME, Quantity, count
from gearidae.records.row_table import FLAG, RowColumn, Rows, indices_of

_force = partial(Quantity, unit=FORCE, comment="since the mesh exit before on the same flank, or the start")

EXIT: Final = (
    Quantity("time", "time of the mesh exit", TIME),
    count("pair", "tooth pair that has left the mesh, counted from the one in mesh at the start as 0"),
    count("flank", "flank of the mesh exit"),
)
"""Which passage it is."""
SINCE_LAST: Final = (
    _force("largest_force", "largest force along the line of action while this flank is in reach"),
    _force("smallest_force", "smallest force along the line of action while this flank is in reach"),
    count(
        "impacts",
        "contacts made on this flank (onset events)",
        comment="since the mesh exit before on the same flank, or the start",
    ),
)
"""What begins anew with each passage of a flank."""
SUMS: Final = tuple(term for term in ENERGY_SUMS if term.sign)
CHANGES: Final = tuple(term for term in ENERGY_NOW if term.sign)
"""Running sums: all terms of the energy balance."""
COLUMNS: Final = (*EXIT, *SINCE_LAST, *SUMS, *CHANGES)
"""Quantities of a passage, in the order of its row."""


class Passages(Rows):
    """Mesh exits in the order of time, with `COLUMNS` in SI units.

    The running sums go from the start of a run, or of its chain, to the mesh exit, and are NaN without an energy
    balance.
    """

    dim = "passage"
    field = "passages"
    columns: ClassVar[Mapping[str, RowColumn]] = {
        **{
            term.name: RowColumn(np.int64 if term.kind == INT else np.float64)
            for term in (*EXIT, *SINCE_LAST)
        },
        "flank": RowColumn(FLAG),
        **{name: RowColumn(missing=math.nan) for term in (*SUMS, *CHANGES) for name in term.names},
    }


PASSAGE: Final = indices_of(*Passages.columns)
"""Indices of the columns in a passage's row: ``row[PASSAGE.impacts]``."""
