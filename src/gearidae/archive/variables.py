"""Catalogue of everything an archive can hold: name, dimensions, unit, meaning.

One `Variable` per row of the dataset's layout; `dataset` builds from it and nothing is named or given a unit
elsewhere, but for sampled columns (`gearidae.records.columns`), which the engine writes. Units are written as
UDUNITS, as CF asks. ``time`` is in ``s`` and not in "seconds since", which xarray would turn into nanosecond dates.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import DTypeLike

from gearidae.records import (
    COUNTERS,
    ELASTIC_SAMPLES,
    GEAR_SAMPLES,
    JOINT_FRICTION,
    JOINT_LOADS,
    LAW_SAMPLES,
    POPULATION_SAMPLES,
    ROLLER_SAMPLES,
    EventKind,
    Events,
    Flank,
    Rows,
    impacts,
    passages,
)
from gearidae.records import extremes as records
from gearidae.records.energy import ENERGY_NOW, ENERGY_SUMS, SLIDING
from gearidae.records.quantity import INT, Quantity

if TYPE_CHECKING:
    from gearidae.scene import Scene


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

    @classmethod
    def catalogue(cls, quantities: Iterable[Quantity]) -> dict[str, Self]:
        """Make the variables of the quantities that are archived, one value a run, by their names."""
        return {
            name: cls(
                name,
                (),
                quantity.unit.si,
                long_name,
                np.int64 if quantity.kind == INT else np.float64,
                comment=quantity.comment,
            )
            for quantity in quantities
            for name, long_name in quantity.archive.items()
        }

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
COVERAGE_KEY = f"coating.{SAM_FRACTION.name}"
"""The key whose value labels each run and its rows, swept or not. Any other key labels runs where it is swept."""

SAMPLES: Mapping[str, Variable] = {
    column.name: Variable(column.name, ("time",), column.units, column.long_name, comment=column.comment)
    for column in (
        *GEAR_SAMPLES,
        *ROLLER_SAMPLES,
        *ELASTIC_SAMPLES,
        *POPULATION_SAMPLES,
        *JOINT_LOADS,
        *JOINT_FRICTION,
        *LAW_SAMPLES,
    )
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
    Variable(
        "event_force",
        ("event",),
        "N",
        "force of the pair along the line of action",
        comment="at onsets and separations, positive where the flanks push each other apart; NaN elsewhere",
    ),
    Variable(f"event_{SAM_FRACTION.name}", ("event",), "1", "SAM fraction of the run the event belongs to"),
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

_SINCE_START = "from the start of the run, or of its chain of runs, to the mesh exit"


def _of_passage(quantity: Quantity, name: str, meaning: str) -> Variable:
    is_sum = quantity in (*passages.SUMS, *passages.CHANGES)
    return Variable(
        f"passage_{name}",
        ("passage",),
        quantity.unit.si,
        meaning,
        passages.Passages.columns[name].dtype,
        Flank if name == "flank" else None,
        _SINCE_START if is_sum else quantity.comment,
    )


_PASSAGES = (
    *(
        _of_passage(quantity, name, meaning)
        for quantity in passages.COLUMNS
        for name, meaning in (quantity.archive or {quantity.name: quantity.meaning}).items()
    ),
    Variable("passage_tooth", ("passage",), "1", "tooth of the pinion, counted from 0", np.int64),
    Variable(
        f"passage_{SAM_FRACTION.name}", ("passage",), "1", "SAM fraction of the run the passage belongs to"
    ),
)
PASSAGES: Mapping[str, Variable] = {variable.name: variable for variable in _PASSAGES}
_IMPACTS = (
    *(
        Variable(
            f"tooth_impact_{quantity.name}",
            ("tooth_impact",),
            quantity.unit.si,
            quantity.meaning,
            impacts.Impacts.columns[quantity.name].dtype,
            Flank if quantity.name == "flank" else None,
            quantity.comment,
        )
        for quantity in impacts.COLUMNS
    ),
    Variable("tooth_impact_tooth", ("tooth_impact",), "1", "tooth of the pinion, counted from 0", np.int64),
    Variable(
        f"tooth_impact_{SAM_FRACTION.name}",
        ("tooth_impact",),
        "1",
        "SAM fraction of the run the impact belongs to",
    ),
)
IMPACTS: Mapping[str, Variable] = {variable.name: variable for variable in _IMPACTS}
ROW_VARIABLES: Final[Mapping[type[Rows], Mapping[str, Variable]]] = {
    Events: {**EVENTS, **POPULATION_EVENTS},
    passages.Passages: PASSAGES,
    impacts.Impacts: IMPACTS,
}
"""What rows of each kind have."""

_RUN = (
    Variable("status", (), "1", "how the run ended", np.str_),
    Variable("message", (), "1", "how the run ended, in a sentence", np.str_),
    *Variable.catalogue(COUNTERS).values(),
    Variable("wall_time", (), "s", "wall time in the solver"),
    Variable("backend", (), "1", "driver of the solver that ran", np.str_),
    Variable("method", (), "1", "formulas that the run began with", np.str_),
)
CONTACT: Final = (
    Variable(
        "contact_bodies", (), "1", "tooth bodies that were computed: rigid, or elastic at any time", np.str_
    ),
    Variable(
        "contact_bodies_reason", (), "1", "what decided on the bodies where the scene says auto", np.str_
    ),
    Variable("contact_roughness", (), "1", "asperities that were computed: statistical or discrete", np.str_),
)
"""What a run has computed of its contacts, whatever was left to it."""
_OF_SWEPT_RUN = (
    Variable("reached", (), "s", "simulated time reached"),
    *CONTACT,
    Variable("skipped", (), "1", "what the scene did not need, by name, as JSON", np.str_),
    Variable("scene", (), "1", "input of the run in SI units, as JSON", np.object_),
)
_VERDICT = (
    Variable("verdict", (), "1", "outcome of the run in one word", np.str_),
    Variable("impacts", (), "1", "contacts made (onset events)", np.int64),
    Variable("flank_changes", (), "1", "how often contact went over to the other flank", np.int64),
)
_RESIDUAL = (
    Variable("residual", (), "J", "what does not add up in the energy balance"),
    Variable("residual_bound", (), "J", "what the residual stays below in a sound run"),
)
_EFFICIENCY = Variable(
    "efficiency",
    (),
    "1",
    "what drag and dry resistance at the gear have taken over all that has been lost",
    comment="NaN where nothing has been lost, or the drive has done no work",
)
_MIN_SEPARATION = Variable(
    "min_separation",
    (),
    "m",
    "smallest distance of the flanks, deflection included",
    comment="of elastic contacts along time, of others over the run",
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
TRAIN_LABELS: Final = (
    "shaft",
    "mesh",
    "mesh_driver",
    "mesh_driven",
    "mesh_ratio",
    "shaft_sense",
    "shaft_ratio",
)
"""Coordinates of shafts and meshes in runs of trains."""
_SUMS = Variable.catalogue((*ENERGY_SUMS, *ENERGY_NOW))
ENERGY_BALANCE: Mapping[str, Variable] = {
    **{name: variable for name, variable in _SUMS.items() if name not in SLIDING},
    **{variable.name: variable for variable in _RESIDUAL},
}
ENERGY_TOTALS: Mapping[str, Variable] = {
    **ENERGY_BALANCE,
    **{name: _SUMS[name] for name in SLIDING},
    _EFFICIENCY.name: _EFFICIENCY,
}
"""The balance, and what a run with one keeps besides, of which archives of version 0.2 have nothing."""
ROLLER_EXTREMES: Mapping[str, Variable] = {
    **Variable.catalogue(records.ROLLER_EXTREMES),
    _MIN_SEPARATION.name: _MIN_SEPARATION,
}
EXTREMES: Mapping[str, Variable] = {
    **Variable.catalogue(records.GEAR_EXTREMES),
    _MIN_SEPARATION.name: _MIN_SEPARATION,
}
STANDSTILL_LIST = Variable(
    "standstill_list", (), "1", "standstills of the run as JSON, see ds.gearidae.standstills()", np.object_
)
ASPERITY_COUNTS = tuple(quantity.name for quantity in records.ASPERITY_COUNTS)
"""Those that only populations have."""
RUN: Mapping[str, Variable] = {variable.name: variable for variable in _RUN}
OF_SWEPT_RUN: Mapping[str, Variable] = {variable.name: variable for variable in _OF_SWEPT_RUN}
"""What every run of a sweep has besides; of a single run these are attributes, or follow from them."""
VERDICT: Mapping[str, Variable] = {variable.name: variable for variable in _VERDICT}
"""What a run of a sweep leaves behind that keeps only parts of its runs."""


def extreme_names(scene: Scene) -> tuple[str, ...]:
    """Names of the extremes that a run of a scene leaves."""
    extremes = EXTREMES if scene.roller is None else ROLLER_EXTREMES
    return tuple(name for name in extremes if name not in ASPERITY_COUNTS or scene.contact.is_discrete)


def run_label(scene: Scene) -> dict[str, tuple[tuple[()], float, dict[str, Any]]]:
    """Coordinate that labels a run."""
    return {SAM_FRACTION.name: ((), scene.coating.sam_fraction, SAM_FRACTION.attributes)}


def by_name() -> dict[str, Variable]:
    """Every variable of the catalogue by its name."""
    return {
        "time": TIME,
        SAM_FRACTION.name: SAM_FRACTION,
        **SAMPLES,
        **EVENTS,
        **POPULATION_EVENTS,
        **PASSAGES,
        **IMPACTS,
        **RUN,
        **OF_SWEPT_RUN,
        **VERDICT,
        **ENERGY_TOTALS,
        **EXTREMES,
        STANDSTILL_LIST.name: STANDSTILL_LIST,
        **EXPOSURES,
        **PLACES,
    }
