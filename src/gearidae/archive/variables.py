"""Catalogue of everything an archive can hold: name, dimensions, unit, meaning.

One `Variable` per row of the dataset's layout; `dataset` builds from it and nothing is named or given a unit
elsewhere, but for sampled columns (`gearidae.columns`), which the engine writes. Units are written as UDUNITS, as CF
asks. ``time`` is in ``s`` and not in "seconds since", which xarray would turn into nanosecond dates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from gearidae.columns import GEAR_SAMPLES, ROLLER_SAMPLES
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS, EventKind, Flank

__all__ = ["EVENTS", "LEDGER", "RUN", "SAMPLES", "SAM_FRACTION", "TIME", "Variable", "by_name", "columns"]


@dataclass(frozen=True, slots=True)
class Variable:
    """One quantity of the dataset.

    Attributes
    ----------
    name : str
        Name in the dataset and in the file.
    dims : tuple of str
        Dimensions on a single run; a sweep puts its own in front of those of samples and run variables.
    units : str
        UDUNITS unit.
    long_name : str
        What it is, in words.
    dtype : dtype-like
        Type in memory and on disk.
    flags : type of IntEnum, optional
        The values a flag variable can take.
    comment : str
        Sign convention and the like.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    dtype: DTypeLike = np.float64
    flags: type[IntEnum] | None = None
    comment: str = ""

    @property
    def attributes(self) -> dict[str, Any]:
        """CF attributes of the variable."""
        attributes: dict[str, Any] = {"long_name": self.long_name, "units": self.units}
        if self.flags is not None:
            attributes["flag_values"] = np.array([flag.value for flag in self.flags], dtype=self.dtype)
            attributes["flag_meanings"] = " ".join(flag.name.lower() for flag in self.flags)
        if self.comment:
            attributes["comment"] = self.comment
        return attributes


TIME = Variable("time", ("time",), "s", "time since the start of the run")
SAM_FRACTION = Variable(
    "sam_fraction", (), "1", "fraction of the contact area covered by the self-assembled monolayer"
)

SAMPLES: Mapping[str, Variable] = {
    column.name: Variable(column.name, ("time",), column.units, column.long_name, comment=column.comment)
    for column in (*GEAR_SAMPLES, *ROLLER_SAMPLES)
}

_EVENTS = (
    Variable("event_time", ("event",), "s", "time of the event"),
    Variable("event_kind", ("event",), "1", "what happened", np.int8, EventKind),
    Variable(
        "event_pair", ("event",), "1", "tooth pair, counted from the one in mesh at the start as 0", np.int64
    ),
    Variable("event_flank", ("event",), "1", "flank the event belongs to", np.int8, Flank),
    Variable(
        "event_gap_rate",
        ("event",),
        "m s-1",
        "rate of change of the pair's gap",
        comment="negative while it closes",
    ),
    Variable("event_sam_fraction", ("event",), "1", "SAM fraction of the run the event belongs to"),
)
EVENTS: Mapping[str, Variable] = {variable.name: variable for variable in _EVENTS}

_RUN = (
    Variable("status", (), "1", "how the run ended", np.str_),
    Variable("message", (), "1", "how the run ended, in a sentence", np.str_),
    Variable("steps", (), "1", "solver steps", np.int64),
    Variable("residual_evaluations", (), "1", "evaluations of the residual", np.int64),
    Variable("jacobian_evaluations", (), "1", "evaluations of the Jacobian", np.int64),
    Variable("error_test_failures", (), "1", "steps repeated because the error test failed", np.int64),
    Variable("convergence_failures", (), "1", "steps repeated because Newton's method failed", np.int64),
    Variable("restarts", (), "1", "restarts of the solver at order one", np.int64),
    Variable("guard_evaluations", (), "1", "evaluations of the event functions", np.int64),
    Variable("wall_time", (), "s", "wall time in the solver"),
)
_LEDGER = (
    Variable("drive_work", (), "J", "work of the drive"),
    Variable("radius_work", (), "J", "work of the changing radius of curvature"),
    Variable("model_change", (), "J", "jump of the stored energy where the contact model changed"),
    Variable("drag_loss", (), "J", "energy lost to drag"),
    Variable("dry_loss", (), "J", "energy lost to dry resistance"),
    Variable("damping_loss", (), "J", "energy lost to the mesh's viscous damping"),
    Variable("adhesion_loss", (), "J", "energy lost to adhesion"),
    Variable("stored_change", (), "J", "energy stored in contacts, at the end less at the start"),
    Variable("kinetic_change", (), "J", "kinetic energy, at the end less at the start"),
    Variable("throughput", (), "J", "all works and changes of kinetic energy without regard to sign"),
    Variable("residual", (), "J", "what does not add up in the energy ledger"),
    Variable("residual_bound", (), "J", "what the residual stays below in a sound run"),
)
LEDGER: Mapping[str, Variable] = {variable.name: variable for variable in _LEDGER}
RUN: Mapping[str, Variable] = {variable.name: variable for variable in _RUN}


def columns(is_roller: bool) -> tuple[str, ...]:
    """Names of the sampled columns of a gear or a roller scene."""
    return ROLLER_COLUMNS if is_roller else GEAR_COLUMNS


def by_name() -> dict[str, Variable]:
    """Every variable of the catalogue by its name."""
    return {"time": TIME, "sam_fraction": SAM_FRACTION, **SAMPLES, **EVENTS, **RUN, **LEDGER}
