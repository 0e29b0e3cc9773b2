"""The records of a train: its shafts and meshes, and where the numbers of its state stand.

Each mesh is a pair of gears with a `Model` of its own, in its own units, whose shafts are given: all that happens
between two gears is asked of it, as in a run of a pair. What joins them is in SI units. States of a train of N shafts:

    0 .. N-1     departures of the shafts' angles from those of the rigid train [rad], at the place of the load's shaft
                 its own angle in pitches of its gear,
    N .. 2N-1    speeds of the shafts [rad/s],

and behind them the works and losses, integrated with the motion. The angle of shaft i is ``rho_i phi_L + delta_i``, rho
a fraction of integers: it drops out of all transmission errors, ``u = R_a delta_a - R_b delta_b - e - o``, which are
never differences of large angles, those of the meshes that close a loop neither.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.compiled import compiled, name_type
from gearidae.engine.events.record import EVENT_NUMBERS, EVENTS_AT_ONCE
from gearidae.engine.model.record_types import INT, REAL, Record, record_type
from gearidae.engine.train.box import BOX_ROWS

SHAFT: Final = record_type(
    ("inertia", REAL),  # [kg m^2]
    ("ratio", REAL),  # speed over that of the load's shaft [1]
    ("resistance", REAL),  # dry resistance of its own [N m]
    ("viscous", REAL),  # [N m s]
    ("drag", REAL),  # [N m s^2]
    ("rubs", INT),  # 1 if anything dry may hold it
    ("begin", REAL),  # departure at the start [rad]
    ("still", REAL),  # speed below which it counts as at rest beside flanks with friction [rad/s]
    ("creeps", REAL),  # speed below which it may creep towards rest, or that of its tolerance [rad/s]
    ("no_torque", REAL),  # torque that counts as none [N m]
    # state
    ("slip", REAL),  # direction of slip: 1, -1, or 0 of a shaft that is held
    ("kept", INT),  # 1 of a shaft without friction of its own that tooth pairs keep at rest
    ("rest_begin", REAL),  # since when it is at rest [s]
    ("rest_time", REAL),  # of all rests that have ended [s]
    ("min_speed", REAL),  # [rad/s]
    ("max_speed", REAL),  # [rad/s]
    # of the last evaluation
    ("torque", REAL),  # without its own friction [N m]
    ("before", REAL),  # direction of slip before the decisions of one time
    ("rested", INT),  # 1 if it was at rest before them
    ("slow", INT),  # 1 if it may creep towards rest
    ("moving_torque", REAL),  # without the friction of pairs that roll [N m]
    ("moving_x", REAL),  # force on its hub without that [N]
    ("moving_y", REAL),
    ("limit", REAL),  # of friction [N m]
    ("load_x", REAL),  # force on its hub [N]
    ("load_y", REAL),
    ("hub", REAL),  # modulus of that [N]
)

JOINT: Final = record_type(
    ("shaft", INT),
    ("radius", REAL),  # [m]
    ("hold", REAL),  # torque of adhesion and axial load over the coefficient [N m]
    ("fresh", REAL),  # coefficient of fresh contacts [1]
    ("rise", REAL),  # by how much that grows [1]
    ("ageing_rate", REAL),  # [1/s]
    ("forgetting", REAL),  # memory lengths in a radian
    # state
    ("age", REAL),  # at the accepted time [s]
    # of one that ages that of the last evaluation
    ("friction", REAL),  # coefficient [1]
    ("by_load", REAL),  # coefficient times radius [m]
    ("constant", REAL),  # torque of adhesion and axial load [N m]
)

MESH: Final = record_type(
    ("address", INT),  # where its model lies, see `gearidae.engine.model.addresses`
    ("a", INT),  # shafts of the driver and of the driven gear
    ("b", INT),
    ("time_unit", REAL),  # of its model [s]
    ("length_unit", REAL),  # [m]
    ("force_unit", REAL),  # [N]
    ("driver_radius", REAL),  # base radii [m]
    ("driven_radius", REAL),
    ("offset", REAL),  # [m]
    ("phase", REAL),  # at the start, less whole pitches [pb]
    ("ratio", REAL),  # pitches in a pitch of the load's gear
    ("per_radian", REAL),  # pitches in a radian of the driven gear
    ("drive_x", REAL),  # direction in which the drive flank pushes the driven gear
    ("drive_y", REAL),
    ("coast_x", REAL),  # and the coast flank
    ("coast_y", REAL),
    (
        "rub_x",
        REAL,
    ),  # direction in which friction of the drive flank pushes the driver where that slides ahead
    ("rub_y", REAL),
    ("coast_rub_x", REAL),  # and of the coast flank
    ("coast_rub_y", REAL),
    ("radius_power", INT),  # 1 if the power of the changing radius is followed
    ("flanks", INT),  # 1 if its flanks have friction
    # state
    ("largest", REAL),  # mesh forces [N] and their times [s]
    ("largest_time", REAL),
    ("smallest", REAL),
    ("smallest_time", REAL),
    ("separation", REAL),  # smallest [m]
    # of the search within a step
    ("closing", REAL),  # rate of the transmission error where the part begins that is searched; scaled
    # of the last evaluation
    ("force", REAL),  # with damping [N]
    ("step_high", REAL),  # largest and smallest in the stages of the present step [N]
    ("step_low", REAL),
    ("error", REAL),  # transmission error [m]
)

TRAIN: Final = record_type(
    ("drive", INT),  # shafts of the drive and of the load
    ("load", INT),
    ("drive_mesh", INT),  # meshes whose models have the torques of the drive and of the load
    ("load_mesh", INT),
    ("pushes", INT),  # 1 if the drive pushes with a pin
    ("cosine", REAL),  # of the direction of its axes in the frame
    ("sine", REAL),
    ("per_radian", REAL),  # pitches of the load's gear in a radian
    (
        "period",
        REAL,
    ),  # pitches of the load's gear after which all phases are whole, and their histories in place
    ("balance", INT),  # 1 if works and losses are followed
    ("flanks", INT),  # 1 if the flanks of any mesh have friction
    ("discrete", INT),  # 1 if any mesh has discrete asperities
    ("hubs", INT),  # 1 if the friction of any hub grows with its load
    ("ages", INT),  # 1 if the friction of any joint grows with time at rest
    ("start", REAL),  # [s]
    ("end", REAL),  # [s]
    ("pause", REAL),  # time of the coming checkpoint, infinite for none [s]
    ("samples", INT),
    ("judged", INT),  # shaft that is judged
    ("first_sample", REAL),  # start over the spacing of the samples, and over that of the looks
    ("first_look", REAL),
    ("stop_pitches", REAL),  # way of the load's gear at which the run ends; infinite for none
    ("stop_from", REAL),  # place of the load's gear from which that counts
    ("longest_step", REAL),  # [s]
    ("rest_step", REAL),  # longest while a shaft is held [s]
    ("tau", REAL),  # fastest time of the meshes [s]
    # state
    ("whole_pitches", REAL),  # whole pitches taken out of the load's angle
    ("time", REAL),  # accepted [s]
    ("step", REAL),  # next to be tried [s]
    ("guard", REAL),  # least guard at the accepted time
    ("throughput", REAL),  # magnitudes of works and changes of kinetic energy [J]
    ("peak_kinetic", REAL),  # largest kinetic energy [J]
    ("kinetic", REAL),  # at the accepted time [J]
    ("roots", INT),  # in close succession
    ("last_root", REAL),  # [s]
    ("next_sample", INT),
    ("next_look", INT),
    ("rows", INT),  # in the present block
    ("looks", INT),
    ("zeros", INT),
    ("events", INT),
    ("rests", INT),
    ("fresh", INT),  # 1 if the rates at the accepted time have to be evaluated
    ("done", INT),
    ("error", INT),
    ("steps", INT),  # counters
    ("evaluations", INT),
    ("refused", INT),
    ("guards", INT),
    ("restarts", INT),
    ("flight_steps", INT),
    # of the last evaluation
    ("drive_torque", REAL),  # [N m]
    ("load_limit", REAL),  # limit of the set-valued laws of the load [N m]
    ("drags", REAL),  # what acts on the load's shaft besides [N m]
    ("pin", REAL),  # force of the pin [N]
    ("elements", INT),  # tooth pairs that friction lets roll, and with any the shafts that are held
    ("rank", INT),  # of them, independent ones
)

ELEMENT: Final = record_type(
    ("mesh", INT),  # of a pair; -1 of a shaft
    ("history", INT),  # of the pair
    ("a", INT),  # shafts; both the same of a shaft
    ("b", INT),
    ("first", REAL),  # its speed per speed of shaft a: r1 [m], or 1
    ("second", REAL),  # and of shaft b: -r2 [m], or 0
    (
        "acceleration",
        REAL,
    ),  # rate of its speed with shafts that keep theirs, less what errors have brought about [m/s^2]
    ("x", REAL),  # direction in which the friction pushes the hub of shaft a
    ("y", REAL),
)

OF_SHAFT: Final = 4
"""Works of a shaft: loss of the hub, its load over its sliding distance, dry resistance, drags."""
OF_MESH: Final = 5
"""Works of a mesh: losses by damping and films, work of the changing radius, work put in and work got out."""
OF_TRAIN: Final = 4
"""Works of the train: of the drive, what dry resistance and drags of the load take, loss of the pin."""


def works_of(shafts: int, meshes: int, flanks: bool = False) -> int:
    """Count the works that are integrated with the motion; flanks with friction have one for each mesh, at the end."""
    return OF_SHAFT * shafts + OF_MESH * meshes + OF_TRAIN + flanks * meshes


class TrainModel(NamedTuple):
    """A train as compiled code sees it.

    Attributes
    ----------
    train : ndarray of one record
        `TRAIN`; an array, as numba is slow to take a record out of Python's hands.
    shafts, meshes : ndarray of records
        `SHAFT` and `MESH`.
    y : ndarray, shape (2 N + works,)
        State at the accepted time, with the works.
    new, between : ndarray, same shape
        At the end of a step, and between.
    rates : ndarray, shape (16, 2 N + works)
        Of the stages of a step; the first are those at the accepted time.
    dense : ndarray, shape (7, 2 N + works)
        Of the polynomial of a step.
    weights : ndarray, shape (2 N,)
        One over the tolerances.
    own : ndarray, shape (4,)
        State of one mesh in its own units.
    few : ndarray, shape (n, EVENT_NUMBERS)
        Events of one mesh at one time.
    elements : ndarray of records
        `ELEMENT`: what is at rest beside flanks with friction.
    gram, work, box : ndarray
        See `gearidae.engine.train.box`; `box` has forces [N] of pairs, torques [N m] of shafts.
    joints : ndarray of records, shape (N + 1,)
        `JOINT`: the hubs of all shafts, and last the pin of the drive.
    """

    train: NDArray[Any]
    shafts: NDArray[Any]
    meshes: NDArray[Any]
    y: Floats
    new: Floats
    between: Floats
    rates: NDArray[np.float64]
    dense: NDArray[np.float64]
    weights: Floats
    own: Floats
    few: NDArray[np.float64]
    elements: NDArray[Any]
    gram: NDArray[np.float64]
    work: NDArray[np.float64]
    box: NDArray[np.float64]
    joints: NDArray[Any]


def blank_train(shafts: int, meshes: int, histories: int = 0) -> TrainModel:
    """Room for a train; `histories` are all those of flanks with friction."""
    n = 2 * shafts + works_of(shafts, meshes, histories > 0)
    elements = shafts + histories if histories > 0 else 0
    return TrainModel(
        np.zeros(1, TRAIN),
        np.zeros(shafts, SHAFT),
        np.zeros(meshes, MESH),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros((16, n)),
        np.zeros((7, n)),
        np.zeros(2 * shafts),
        np.zeros(4),
        np.zeros((EVENTS_AT_ONCE, EVENT_NUMBERS)),
        np.zeros(elements, ELEMENT),
        np.zeros((elements, elements)),
        np.zeros((elements, elements + 1)),
        np.zeros((BOX_ROWS, elements)),
        np.zeros(shafts + 1, JOINT),
    )


name_type(blank_train(1, 1), "TrainModel")


@compiled(inline=True)
def is_at_rest(shaft: Record) -> bool:
    """Whether a shaft stands: its own friction holds it, or tooth pairs keep it at rest."""
    return bool((shaft.rubs != 0 and shaft.slip == 0.0) or shaft.kept != 0)


def which_rest(tm: TrainModel) -> NDArray[np.bool_]:
    """Tell of all shafts whether they stand, see `is_at_rest`."""
    shafts = tm.shafts
    held = (shafts["rubs"] != 0) & (shafts["slip"] == 0.0) | (shafts["kept"] != 0)
    return np.asarray(held, dtype=np.bool_)


class TrainOutput(NamedTuple):
    """Samples, looks, zeros, events and rests of a block, before it is taken over.

    Attributes
    ----------
    samples, looks : ndarray, shape (n, columns)
        See `gearidae.engine.train.observe.observe_train`; looks are those by which a run is judged.
    zeros : ndarray, shape (k, 2)
        Times [s] and angles [rad] at which the speed of the judged shaft changes its sign.
    events, rests : ndarray, shape (k, numbers)
        See `gearidae.engine.train.record`.
    """

    samples: NDArray[np.float64]
    looks: NDArray[np.float64]
    zeros: NDArray[np.float64]
    events: NDArray[np.float64]
    rests: NDArray[np.float64]


name_type(TrainOutput(*(np.zeros((1, 1)) for _ in range(5))), "TrainOutput")
