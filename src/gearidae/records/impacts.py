"""Impacts: what a tooth pair has done from each contact onset to its separation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Final

import numpy as np

from gearidae.records.quantity import ENERGY, FORCE, INT, SPEED, TIME, Quantity, Unit, count
from gearidae.records.row_table import FLAG, RowColumn, Rows, indices_of

WHICH: Final = (
    Quantity("time", "time of the separation, which ends the impact", TIME),
    count("pair", "tooth pair, counted from the one in mesh at the start as 0"),
    count("flank", "flank of the contact"),
    Quantity("duration", "time from the onset to the separation", TIME),
)
"""Which impact it is, and what follows from its ends."""
KEPT: Final = (
    Quantity("begin", "time of the onset, or of the start of the run that has met the contact", TIME),
    Quantity(
        "approach_speed",
        "speed at which the flanks came together at the onset",
        SPEED,
        comment="NaN where the run has met the contact",
    ),
    Quantity("largest_force", "largest force along the line of action, positive where flanks push", FORCE),
    Quantity("largest_force_time", "time of the largest force", TIME),
    Quantity(
        "smallest_force",
        "smallest force along the line of action",
        FORCE,
        comment="below zero by the largest pull of adhesion",
    ),
    Quantity("impulse", "integral of the force over time", Unit("F tau", "N s", force=1, time=1)),
    Quantity(
        "energy_lost",
        "work that the motion has done on the contact, less what it has got back",
        ENERGY,
        comment="friction included",
    ),
    Quantity(
        "friction_loss",
        "what friction of the flanks has taken of it",
        ENERGY,
        comment="NaN without a balance",
    ),
)
"""What is kept of a contact while it lasts."""
COLUMNS: Final = (*WHICH, *KEPT)
"""Quantities of an impact, in the order of its row."""


class Impacts(Rows):
    """Contacts of tooth pairs in the order of their ends, with `COLUMNS` in SI units.

    A contact that lasts at the end of a run has its row in the run that goes on. The dimension `impact` is that of
    the impacts that ringing shows.
    """

    dim = "tooth_impact"
    field = "impacts"
    columns: ClassVar[Mapping[str, RowColumn]] = {
        **{column.name: RowColumn(np.int64 if column.kind == INT else np.float64) for column in COLUMNS},
        "flank": RowColumn(FLAG),
    }


IMPACT: Final = indices_of(*Impacts.columns)
"""Indices of the columns in an impact's row: ``row[IMPACT.impulse]``."""
