"""What the dataset of a train has along its shafts and meshes: name, unit and meaning of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.archive.variables import (
    ASPERITY_COUNTS,
    EVENTS,
    EXTREMES,
    POPULATION_EVENTS,
    SAMPLES,
    STANDSTILL_LIST,
    Variable,
)
from gearidae.records.train_results import WORKS_OF_MESHES, WORKS_OF_SHAFTS
from gearidae.scene.joints import ages

if TYPE_CHECKING:
    from gearidae.scene import Scene

SHAFT, MESH = ("shaft",), ("mesh",)

COORDINATES: Final[Mapping[str, Variable]] = {
    variable.name: variable
    for variable in (
        Variable("shaft", SHAFT, "1", "name of the shaft", np.str_),
        Variable("mesh", MESH, "1", "name of the mesh", np.str_),
        Variable("mesh_driver", MESH, "1", "gear that drives in the mesh", np.str_),
        Variable("mesh_driven", MESH, "1", "gear that is driven in the mesh", np.str_),
        Variable("mesh_ratio", MESH, "1", "speed of the driver over that of the driven gear"),
        Variable("shaft_sense", SHAFT, "1", "turning sense, 1 is that of the drive's shaft", np.int64),
        Variable("shaft_ratio", SHAFT, "1", "speed over that of the judged shaft"),
    )
}
_FORWARD = "positive in the forward sense of each shaft"
_OF_INSTANT = SAMPLES["gear_hub_friction"].comment
TRAIN_SAMPLES: Final[Mapping[str, Variable]] = {
    variable.name: variable
    for variable in (
        Variable("shaft_speed", (*SHAFT, "time"), "rad s-1", "speed of the shaft", comment=_FORWARD),
        Variable("shaft_angle", (*SHAFT, "time"), "rad", "angle of the shaft", comment=_FORWARD),
        Variable(
            "hub_load",
            (*SHAFT, "time"),
            "N",
            "load of the hub",
            comment="vector sum over all meshes, and the force of the drive's law",
        ),
        Variable(
            "hub_load_angle",
            (*SHAFT, "time"),
            "rad",
            "direction of the load of the hub",
            comment="counter-clockwise from the frame's x axis",
        ),
        Variable(
            "hub_friction", (*SHAFT, "time"), "1", "coefficient of friction of the hub", comment=_OF_INSTANT
        ),
        *(
            Variable(name, (*MESH, "time"), SAMPLES[name].units, SAMPLES[name].long_name)
            for name in (
                "mesh_force",
                "transmission_error",
                "drive_gap",
                "coast_gap",
                "pairs_in_contact",
                "asperities_in_contact",
            )
        ),
        *(
            Variable(name, ("time",), SAMPLES[name].units, SAMPLES[name].long_name)
            for name in ("drive_torque", "load_torque", "pin_load", "pin_friction")
        ),
    )
}
TWO_SHAFTS: Final[Mapping[str, str]] = {
    f"{side}_{name}": source
    for side in ("gear", "pinion")
    for name, source in (
        ("speed", "shaft_speed"),
        ("angle", "shaft_angle"),
        ("hub_load", "hub_load"),
        ("hub_friction", "hub_friction"),
    )
}
"""Samples by the names that a pair has, ``gear`` for the judged shaft and ``pinion`` for the drive's, and those of all
shafts that they are taken from."""
OF_AGEING: Final = ("hub_friction", "pin_friction")
"""Samples that a dataset has only where friction of a joint ages."""
SHAFT_TOTALS: Final[Mapping[str, Variable]] = {
    name: Variable(name, SHAFT, units, meaning)
    for name, units, meaning in (
        ("min_speed", "rad s-1", "smallest speed of the shaft"),
        ("max_speed", "rad s-1", "largest speed of the shaft"),
        ("hub_loss", "J", "energy lost to friction of the hub"),
        ("hub_sliding", "N m", "load of the hub, integrated over its sliding distance"),
        ("resistance_loss", "J", "energy lost to the dry resistance of the shaft"),
        ("drag_loss", "J", "energy lost to drags of the shaft"),
        ("rest_time", "s", "time for which dry friction has held the shaft"),
    )
}
MESH_TOTALS: Final[Mapping[str, Variable]] = {
    **{
        name: Variable(name, MESH, EXTREMES[name].units, EXTREMES[name].long_name, EXTREMES[name].dtype)
        for name in (
            "largest_mesh_force",
            "largest_mesh_force_time",
            "smallest_mesh_force",
            "smallest_mesh_force_time",
            "smallest_separation",
            "mesh_exits",
            *ASPERITY_COUNTS,
        )
        if name in EXTREMES
    },
    **{
        name: Variable(name, MESH, "J", meaning)
        for name, meaning in (
            ("adhesion_loss", "energy lost to adhesion in the mesh"),
            ("damping_loss", "energy lost to the viscous damping of the mesh"),
            ("film_loss", "energy lost to films of gas in the mesh"),
            ("friction_loss", "energy lost to friction of the flanks"),
            ("work_in", "work of the driver on the mesh"),
            ("work_out", "work of the mesh on its driven gear"),
        )
    },
}
EFFICIENCIES: Final[Mapping[str, Variable]] = {
    variable.name: variable
    for variable in (
        Variable(
            "mesh_efficiency",
            MESH,
            "1",
            "work of the mesh on its driven gear over that of its driver",
            comment="NaN where nothing arrived",
        ),
        Variable(
            "hub_efficiency",
            SHAFT,
            "1",
            "what friction of the hub leaves of the work that arrives",
            comment="1 - hub_loss over work_in of the meshes that drive the shaft, or the drive's work; NaN where "
            "nothing arrived",
        ),
    )
}
ENERGY: Final[Mapping[str, Variable]] = {
    name: Variable(name, (), "J", meaning)
    for name, meaning in (
        ("drive_work", "work of the drive"),
        ("radius_work", "work of the changing radius of curvature"),
        ("load_work", "energy that the dry resistance and the drags of the load have taken"),
        ("pin_loss", "energy lost to friction of the pin"),
        ("kinetic_change", "kinetic energy, at the end less at the start"),
        ("stored_change", "energy stored in contacts, at the end less at the start"),
        ("throughput", "all works and changes of kinetic energy without regard to sign"),
        ("residual", "what does not add up in the energy balance"),
        ("residual_bound", "what the residual stays below in a sound run"),
    )
}
OF_ASPERITIES: Final = ("asperities_in_contact", *ASPERITY_COUNTS, *POPULATION_EVENTS)
"""What a run has only where its asperities are followed one by one."""


def left_out(scene: Scene) -> frozenset[str]:
    """Names of what a run of a train does not leave, as its scene has nothing of the kind."""
    return frozenset(
        {*(() if ages(scene) else OF_AGEING), *(() if scene.contact.is_discrete else OF_ASPERITIES)}
    )


EVENT_PLACES: Final[Mapping[str, Variable]] = {
    name: Variable(name, ("event",), "1", meaning, np.int64, comment="-1 where it belongs to none")
    for name, meaning in (
        ("event_mesh", "number of the mesh that the event belongs to, from 0"),
        ("event_shaft", "number of the shaft that the event belongs to, from 0"),
    )
}
REST_LIST: Final = Variable(
    "rest_list", (), "1", "intervals at rest as JSON: shaft, begin and end in seconds", np.object_
)
HELD_BY: Final = Variable("held_by", (), "1", "what holds the judged shaft, by names", np.str_)
"""Of each run of a sweep; of a single run it is an attribute."""
_JUDGED_BESIDE = {*MESH_TOTALS, *SHAFT_TOTALS, "min_separation"}
OF_JUDGED: Final = tuple(name for name in EXTREMES if name not in _JUDGED_BESIDE)
"""Extremes of the judged shaft, without a dimension."""
PARTS: Final[Mapping[str, tuple[str, ...]]] = {
    "extremes": (
        *OF_JUDGED,
        *(name for name in SHAFT_TOTALS if name not in WORKS_OF_SHAFTS),
        *(name for name in MESH_TOTALS if name not in WORKS_OF_MESHES),
        STANDSTILL_LIST.name,
    ),
    "energy_balance": (*WORKS_OF_SHAFTS, *WORKS_OF_MESHES, *ENERGY, *EFFICIENCIES, "efficiency"),
    "samples": (*TRAIN_SAMPLES, *TWO_SHAFTS),
    "events": (*EVENTS, *POPULATION_EVENTS, *EVENT_PLACES, REST_LIST.name, "impacts"),
}
"""What a run of a train leaves, by the groups of `gearidae.archive.output_selection`."""
ATTRIBUTES: Final = ("judged_shaft", "judged_mesh", "drive_shaft")
"""Attributes that all runs of a sweep have in common."""
ALL: Final[Mapping[str, Variable]] = {
    **COORDINATES,
    **TRAIN_SAMPLES,
    **SHAFT_TOTALS,
    **MESH_TOTALS,
    **EFFICIENCIES,
    **ENERGY,
    **EVENT_PLACES,
    **POPULATION_EVENTS,
    REST_LIST.name: REST_LIST,
}
"""By their names."""
