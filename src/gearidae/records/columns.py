"""Sampled columns: name, unit and meaning of each, in the order of a row.

The engine fills the rows (`gearidae.engine.motion.observe`); dataset, files and their documentation follow from
these lists.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from gearidae.laws.joints import JOINTS
from gearidae.laws.law import SHAFT_NAMES
from gearidae.laws.shafts import SAMPLED
from gearidae.records.row_table import indices_of


class Column(NamedTuple):
    """One sampled quantity.

    Attributes
    ----------
    name : str
        Name in the dataset and in the file.
    units : str
        UDUNITS unit.
    long_name : str
        Meaning, in words.
    comment : str
        Sign convention and the like.
    since : str
        Version of gearidae that began to sample it; archives without it are older. Empty for the first version.
    """

    name: str
    units: str
    long_name: str
    comment: str = ""
    since: str = ""


OF_CHAIN: Final = "of the first run of a chain; not wrapped"
"""Of both angles; in archives of version 0.2 that of the gear began at the mesh phase."""

GEAR_SAMPLES: Final = (
    Column("gear_speed", "rad s-1", "angular speed of the gear"),
    Column("pinion_speed", "rad s-1", "angular speed of the pinion"),
    Column("gear_angle", "rad", "rotation of the gear since the start", OF_CHAIN),
    Column(
        "transmission_error",
        "m",
        "dynamic transmission error",
        "u = R1 phi1 - R2 phi2 - e(phi1), Teodorescu et al. 2009, Eq. 4",
    ),
    Column("mesh_force", "N", "force along the line of action", "positive drives the gear forward"),
    Column(
        "gear_contact_torque",
        "N m",
        "torque of the tooth contacts on the gear",
        "positive drives the gear forward; negative while adhesion holds it back",
    ),
    Column("drive_gap", "m", "smallest gap of all pairs on the drive flank"),
    Column("coast_gap", "m", "smallest gap of all pairs on the coast flank"),
    Column("pairs_in_contact", "1", "number of tooth pairs that transmit force"),
    Column(
        "drive_torque", "N m", "torque of the drive on the pinion", "positive turns the gears forward", "0.2"
    ),
    Column(
        "load_torque",
        "N m",
        "torque that resists the gear",
        "dry resistance and drag, Teodorescu et al. 2009, Eq. 2; of a gear at rest the torque that holds it",
        "0.2",
    ),
    Column(
        "pinion_angle",
        "rad",
        "rotation of the pinion since the start",
        OF_CHAIN,
        "0.2",
    ),
)
ROLLER_SAMPLES: Final = (
    Column("height", "m", "height of the roller above the mean plane of the asperities"),
    Column("speed", "m s-1", "velocity of the roller", "positive upwards, away from the plane"),
    Column("force", "N", "contact force on the roller", "positive pushes the bodies apart"),
)
POPULATION_SAMPLES: Final = (
    Column("asperities_in_contact", "1", "number of asperities in contact, of all pairs"),
)
ELASTIC_SAMPLES: Final = (
    Column("min_separation", "m", "smallest distance of the flanks, deflection included"),
)
JOINT_LOADS: Final = tuple(
    Column(f"{joint.prefix}_load", "N", f"load of {joint.sampled}", joint.load, "0.3") for joint in JOINTS
)
JOINT_FRICTION: Final = tuple(
    Column(
        f"{joint.prefix}_friction",
        "1",
        f"coefficient of friction of {joint.sampled}",
        "of the instant: it grows with the time at rest, and sliding forgets that",
        "0.3",
    )
    for joint in JOINTS
)
LAW_SAMPLES: Final = tuple(
    Column(
        f"{shaft}_{law.sample.name}",
        "N m",
        law.sample.meaning.format(shaft=shaft),
        f"positive turns the {shaft} forward",
        "0.3",
    )
    for shaft in SHAFT_NAMES
    for law in SAMPLED
    if law.sample is not None
)

GEAR_COLUMNS = tuple(column.name for column in GEAR_SAMPLES)
ROLLER_COLUMNS = tuple(column.name for column in ROLLER_SAMPLES)
ELASTIC_COLUMNS = tuple(column.name for column in ELASTIC_SAMPLES)
POPULATION_COLUMNS = tuple(column.name for column in POPULATION_SAMPLES)
JOINT_LOAD_COLUMNS = tuple(column.name for column in JOINT_LOADS)
JOINT_FRICTION_COLUMNS = tuple(column.name for column in JOINT_FRICTION)
"""Additional columns of elastic contacts, of populations and of joints, after the others; those of laws of the shafts
follow them."""


GEAR: Final = indices_of(*GEAR_COLUMNS, *ELASTIC_COLUMNS)
ROLLER: Final = indices_of(*ROLLER_COLUMNS, *ELASTIC_COLUMNS)
GEAR_POPULATION: Final = indices_of(*GEAR_COLUMNS, *POPULATION_COLUMNS)
ROLLER_POPULATION: Final = indices_of(*ROLLER_COLUMNS, *POPULATION_COLUMNS)
"""Indices of the columns in a row of samples: ``row[GEAR.gear_speed]``."""


def sampled_columns(
    *,
    roller: bool,
    bodies: str = "rigid",
    roughness: str = "statistical",
    joints: int = 0,
    ages: bool = False,
) -> tuple[str, ...]:
    """Names of what is sampled of gears or a roller, by bodies, roughness and how many joints."""
    more = ELASTIC_COLUMNS if bodies == "elastic" else ()
    more += POPULATION_COLUMNS if roughness == "discrete" else ()
    more += JOINT_LOAD_COLUMNS[:joints]
    more += JOINT_FRICTION_COLUMNS[:joints] if ages else ()
    return (ROLLER_COLUMNS if roller else GEAR_COLUMNS) + more
