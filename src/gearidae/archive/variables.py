"""Catalogue of everything an archive can hold: name, dimensions, unit, meaning.

One `Variable` per row of the dataset's layout; `dataset` builds from it and nothing is named or given a unit
elsewhere, but for sampled columns (`gearidae.records.columns`), which the engine writes. Units are written as
UDUNITS, as CF asks. ``time`` is in ``s`` and not in "seconds since", which xarray would turn into nanosecond dates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from gearidae.records import (
    ELASTIC_SAMPLES,
    GEAR_SAMPLES,
    POPULATION_SAMPLES,
    ROLLER_SAMPLES,
    EventKind,
    Flank,
    sampled_columns,
)
from gearidae.records.standing import Holding


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
    for column in (*GEAR_SAMPLES, *ROLLER_SAMPLES, *ELASTIC_SAMPLES, *POPULATION_SAMPLES)
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

POPULATION_EVENTS: Mapping[str, Variable] = {
    variable.name: variable
    for variable in (
        Variable(
            "event_tooth",
            ("event",),
            "1",
            "tooth of the pinion that the event belongs to, counted from 0",
            np.int64,
            comment="-1 where it belongs to none",
        ),
        Variable(
            "event_asperity",
            ("event",),
            "1",
            "asperity that has joined or detached, counted along its flank from 0",
            np.int64,
            comment="-1 where the event is of no single asperity; gearidae.population lists them in this order",
        ),
    )
}
"""What events of a population have besides."""

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
    Variable("backend", (), "1", "driver of the solver that ran", np.str_),
    Variable("method", (), "1", "formulas that the run began with", np.str_),
)
_OF_SWEPT_RUN = (
    Variable("reached", (), "s", "simulated time reached"),
    Variable("skipped", (), "1", "what the scene did not need, by name, as JSON", np.str_),
    Variable("scene", (), "1", "input of the run in SI units, as JSON", np.object_),
)
_VERDICT = (
    Variable("verdict", (), "1", "outcome of the run in one word", np.str_),
    Variable("impacts", (), "1", "contacts made (onset events)", np.int64),
    Variable("flank_changes", (), "1", "how often contact went over to the other flank", np.int64),
)
_ENERGY_BALANCE = (
    Variable("drive_work", (), "J", "work of the drive"),
    Variable("radius_work", (), "J", "work of the changing radius of curvature"),
    Variable("model_change", (), "J", "jump of the stored energy where the contact model changed"),
    Variable("drag_loss", (), "J", "energy lost to drag"),
    Variable("dry_loss", (), "J", "energy lost to dry resistance"),
    Variable("damping_loss", (), "J", "energy lost to the mesh's viscous damping"),
    Variable("adhesion_loss", (), "J", "energy lost to adhesion"),
    Variable("drive_friction_loss", (), "J", "energy lost to friction of the drive flank"),
    Variable("coast_friction_loss", (), "J", "energy lost to friction of the coast flank"),
    Variable("pinion_hub_loss", (), "J", "energy lost to friction of the pinion's hub"),
    Variable("gear_hub_loss", (), "J", "energy lost to friction of the gear's hub"),
    Variable("stored_change", (), "J", "energy stored in contacts, at the end less at the start"),
    Variable("kinetic_change", (), "J", "kinetic energy, at the end less at the start"),
    Variable("throughput", (), "J", "all works and changes of kinetic energy without regard to sign"),
    Variable("residual", (), "J", "what does not add up in the energy balance"),
    Variable("residual_bound", (), "J", "what the residual stays below in a sound run"),
)
_FORCE_EXTREMES = (
    Variable("largest_mesh_force", (), "N", "largest force along the line of action, or on the roller"),
    Variable("largest_mesh_force_time", (), "s", "when it acted"),
    Variable("smallest_mesh_force", (), "N", "smallest force along the line of action, or on the roller"),
    Variable("smallest_mesh_force_time", (), "s", "when it acted"),
    Variable("smallest_separation", (), "m", "smallest distance of the flanks, deflection included"),
    Variable(
        "min_separation",
        (),
        "m",
        "smallest distance of the flanks, deflection included",
        comment="of elastic contacts along time, of others over the run",
    ),
)
_GEAR_SPEED = Variable("final_speed", (), "rad s-1", "speed of the gear where the run ended")
_ROLLER_SPEED = Variable("final_speed", (), "m s-1", "speed of the roller where the run ended")
_ASPERITY_COUNTS = (
    Variable("asperity_onsets", (), "1", "asperities that have joined", np.int64),
    Variable("asperity_detachments", (), "1", "asperities that have detached", np.int64),
)
_HOLDING = "sum of " + ", ".join(f"{part.value} for {part.words}" for part in Holding)
_GEAR_EXTREMES = (
    Variable("min_gear_speed", (), "rad s-1", "smallest speed of the gear"),
    Variable("max_gear_speed", (), "rad s-1", "largest speed of the gear"),
    Variable(
        "settled_gear_speed", (), "rad s-1", "mean speed of the gear after the first twentieth of the run"
    ),
    Variable("settled_spread", (), "rad s-1", "its largest speed less its smallest from then on"),
    Variable("speed_fall", (), "rad s-1", "how far its speed fell from then on below what it had reached"),
    Variable("speed_rise", (), "rad s-1", "how far its speed rose from then on above what it had fallen to"),
    Variable("late_gear_speed", (), "rad s-1", "mean speed of the gear in the second half of the run"),
    Variable("late_spread", (), "rad s-1", "its largest speed less its smallest there"),
    Variable(
        "last_min_gear_speed", (), "rad s-1", "smallest speed of the gear in the last twentieth of the run"
    ),
    Variable("reversals", (), "1", "how often the gear's speed fell to zero", np.int64),
    Variable(
        "stick_time",
        (),
        "s",
        "when the gear came to stand",
        comment="first zero of its speed from which it stands; NaN if it does not stand at the end",
    ),
    Variable("stick_exits", (), "1", "mesh exits on the drive flank until it stood or went back", np.int64),
    Variable("advance", (), "1", "pitches that the gear has been away from where it came to stand"),
    Variable("free_advance", (), "1", "pitches that free gears would have been away from there"),
    Variable("driven_time", (), "s", "time since then for which the drive exceeded the dry load"),
    Variable(
        "held_torque", (), "N m", "largest torque of the drive at the gear beyond the dry load since then"
    ),
    Variable("holding", (), "1", "what holds the gear at the end", np.int64, comment=_HOLDING),
    Variable("turned_back", (), "1", "pitches by which the gear has gone back at the end"),
    Variable("free_turned_back", (), "1", "pitches by which free gears would have gone back"),
    Variable("back_time", (), "s", "zero of the speed from which the gear has gone back"),
    Variable("standstills", (), "1", "number of standstills", np.int64),
    Variable("standing_time", (), "s", "time of all standstills"),
    Variable("standing_rest_time", (), "s", "time for which dry friction held all of the gear in them"),
    Variable(
        "start_time",
        (),
        "s",
        "end of the last standstill that has ended",
        comment="0 without one; NaN if the gear has never left half a pitch",
    ),
    Variable("breakaway_torque", (), "N m", "torque of the drive on the pinion then"),
    Variable("followed_time", (), "s", "time since the start of the chain of runs to which this holds"),
    Variable("turn_backs", (), "1", "how often adhesion has turned the gear back where it stands", np.int64),
    Variable("time_adhering", (), "s", "time held by adhesion, from one turning back to the next"),
    Variable("mesh_exits", (), "1", "mesh exits on the drive flank", np.int64),
)
_FLANKS = ("flank", "tooth", "place")
_MATERIALS = ("flank", "material", "tooth", "place")
_OF_PINION = "per area of the pinion's flank; a contact on the tip relief counts at the end of the path"
_EXPOSURES = (
    Variable(
        "asperity_contacts",
        _MATERIALS,
        "m-2",
        "asperity contacts made on a material, per area of it",
        comment=_OF_PINION,
    ),
    Variable(
        "adhesion_work",
        _MATERIALS,
        "J m-2",
        "energy lost to adhesion on a material, per area of it",
        comment=_OF_PINION,
    ),
    Variable(
        "sliding_work",
        _FLANKS,
        "J m-2",
        "normal force times sliding distance of contacts that push, per area",
        comment=_OF_PINION,
    ),
    Variable(
        "largest_pressure",
        _FLANKS,
        "Pa",
        "largest force of a pair over face width and sqrt(2 R sigma)",
        comment="nominal: the asperities share it",
    ),
    Variable(
        "friction_work",
        _FLANKS,
        "J m-2",
        "energy lost to friction of the flanks, per area; only of scenes with it",
        comment=_OF_PINION,
    ),
)
_PLACES = (
    Variable("place", ("place",), "m", "place along the path of contact, from its beginning at the pinion"),
    Variable("flank_area", ("place",), "m2", "area of one flank of the pinion that a place stands for"),
    Variable("tooth", ("tooth",), "1", "tooth of the pinion; that in mesh at the start is 0", np.int64),
    Variable("material", ("material",), "1", "material of the flanks", np.str_),
    Variable("flank", ("flank",), "1", "flank of the teeth", np.str_),
)
EXPOSURES: Mapping[str, Variable] = {variable.name: variable for variable in _EXPOSURES}
PLACES: Mapping[str, Variable] = {variable.name: variable for variable in _PLACES}
"""What the exposures are labelled by."""
ENERGY_BALANCE: Mapping[str, Variable] = {variable.name: variable for variable in _ENERGY_BALANCE}
ROLLER_EXTREMES: Mapping[str, Variable] = {
    variable.name: variable for variable in (*_FORCE_EXTREMES, _ROLLER_SPEED, *_ASPERITY_COUNTS)
}
EXTREMES: Mapping[str, Variable] = {
    variable.name: variable
    for variable in (*_GEAR_EXTREMES, *_FORCE_EXTREMES, _GEAR_SPEED, *_ASPERITY_COUNTS)
}
STANDSTILL_LIST = Variable(
    "standstill_list", (), "1", "standstills of the run as JSON, see ds.gearidae.standstills()", np.object_
)
ASPERITY_COUNTS = tuple(variable.name for variable in _ASPERITY_COUNTS)
"""Those that only populations have."""
RUN: Mapping[str, Variable] = {variable.name: variable for variable in _RUN}
OF_SWEPT_RUN: Mapping[str, Variable] = {variable.name: variable for variable in _OF_SWEPT_RUN}
"""What every run of a sweep has besides; of a single run these are attributes, or follow from them."""
VERDICT: Mapping[str, Variable] = {variable.name: variable for variable in _VERDICT}
"""What a run of a sweep leaves behind that keeps only parts of its runs."""


def extreme_names(is_roller: bool, model: str) -> tuple[str, ...]:
    """Names of the extremes that a run of gears or a roller leaves, with a contact model."""
    found = ROLLER_EXTREMES if is_roller else EXTREMES
    return tuple(name for name in found if name not in ASPERITY_COUNTS or model == "population")


def columns(is_roller: bool, model: str = "asperity") -> tuple[str, ...]:
    """Names of the sampled columns of a gear or a roller scene with a contact model."""
    return sampled_columns(roller=is_roller, model=model)


def by_name() -> dict[str, Variable]:
    """Every variable of the catalogue by its name."""
    return {
        "time": TIME,
        "sam_fraction": SAM_FRACTION,
        **SAMPLES,
        **EVENTS,
        **POPULATION_EVENTS,
        **RUN,
        **OF_SWEPT_RUN,
        **VERDICT,
        **ENERGY_BALANCE,
        **EXTREMES,
        STANDSTILL_LIST.name: STANDSTILL_LIST,
        **EXPOSURES,
        **PLACES,
    }
