"""The records of a run: constants, what a checkpoint carries, and work space, each declared once.

Compiled code reads and writes them by name, ``m.state.history[k].joined[material]``, through a `Model`: three records
and two arrays of variable length. ``SCENE`` holds constants, made from the scene and never read from a file. ``STATE``
is all that a checkpoint carries, besides the state vector and the nodes of an elastic contact. ``WORK`` can be
worked out anew from both. Everything is scaled: lengths by the roughness sigma, forces by a reference load of the scene
and time by ``tau = sqrt(m sigma / F)``, so that states, rates and forces are of order one whatever the speed.
"""

from __future__ import annotations

from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearidae.scene.limits import MOST_PAIRS

__all__ = [
    "ADAMS",
    "COAST",
    "DRIVE",
    "EMPTY",
    "ENERGY",
    "EXTREMES",
    "GEARS",
    "HISTORY",
    "LOAD",
    "MATERIAL",
    "MATERIALS",
    "MOST_ORDERS",
    "MOTION",
    "PARTS",
    "PHASE",
    "PROGRESS",
    "ROLLER",
    "SCENE",
    "SCHEDULES",
    "SLOTS_HIGH",
    "SPEED",
    "STATE",
    "STOPS",
    "TORQUE",
    "WORK",
    "Floats",
    "Model",
    "Record",
    "U",
    "V",
    "W",
    "assign",
    "blank_model",
    "blank_work",
    "empty_history",
]

Floats: TypeAlias = NDArray[np.float64]
Record: TypeAlias = Any
"""A numpy record; compiled code checks its names."""

GEARS: Final = 0
ROLLER: Final = 1
"""Kinds of scene."""

DRIVE: Final = 0
COAST: Final = 1
"""Flanks."""

LOAD: Final = 1
"""The gear's shaft among the torques; the pinion's is `DRIVE`."""

SPEED: Final = 2
SCHEDULES: Final = 3
"""The speed that a drive holds among the schedules, beside both torques; and how many there are."""

MATERIALS: Final = 2
"""Materials that share the surface: bare first, then coated."""

SLOTS_HIGH: Final = MOST_PAIRS
"""Tooth pairs per flank whose history can be kept, a power of two."""

EMPTY: Final = -(2**62)
"""Pair number of a history that is about no pair."""

MOST_ORDERS: Final = 8
"""Highest number of former rates that a formula uses."""

# -- the state vector ------------------------------------------------------------------------------------------------
U: Final = 0  # dynamic transmission error (a roller's height) / sigma
V: Final = 1  # its rate
PHASE: Final = 2  # gear's turn in base pitches, less the whole ones in `STATE`
W: Final = 3  # gear's surface velocity at the base circle
MOTION: Final = 4  # states of a motion at most
# then, for an elastic contact, the deflection of both bodies / sigma at every node of every history's pair

_REAL, _INT = "f8", "i8"


def _record(*fields: tuple[Any, ...]) -> np.dtype[Any]:
    """Record type whose fields are attributes, in compiled code and in Python alike."""
    return np.dtype((np.record, np.dtype(list(fields), align=True)))


# -- constants -------------------------------------------------------------------------------------------------------
MATERIAL: Final = _record(
    ("force_scale", _REAL),  # per sqrt(radius / pitch), with the material's share of the surface
    ("stretch_limit", _REAL),  # over sigma; 0 where there is no hysteresis worth following
    ("joining_energy", _REAL),  # energy lost by an asperity at contact onset, in the unit of `force_scale`
    ("table_at", _INT),  # where its force law and its stored energy begin among the tables,
    ("energy_at", _INT),
    ("number_at", _INT),  # and the number of its asperities above a height
    ("table_count", _INT),  # numbers in each
)

TORQUE: Final = _record(
    ("constant", _REAL),
    ("harmonic_count", _INT),  # (amplitude, angular frequency, phase) of each
    ("harmonics_at", _INT),
    ("law_count", _INT),  # parameters of the law, whose address is in `WORK`
    ("law_at", _INT),
    ("law_torque", _REAL),  # units of the law's torque [N m] and of the shaft's speed [rad/s]
    ("law_speed", _REAL),
)

SCHEDULE: Final = _record(
    ("knot_count", _INT),  # (time, value) of each, then the coefficients of the pieces of a cubic one
    ("knots_at", _INT),
    ("cubic", _INT),  # 1 for monotone cubics between the knots, 0 for straight lines
)

SCENE: Final = _record(
    ("kind", _INT),  # GEARS or ROLLER
    ("length_unit", _REAL),  # sigma [m]
    ("time_unit", _REAL),  # tau [s]
    ("force_unit", _REAL),  # [N]
    # the mesh
    ("base_pitch", _REAL),  # [m]
    ("gear_radius", _REAL),  # R2 [m]
    ("pinion_radius", _REAL),  # R1 [m]
    ("pinion_teeth", _REAL),
    (
        "pinion_inverse_mass",
        _REAL,
    ),  # R1^2 tau^2 F / (I1 sigma): acceleration along the line of action per force
    ("gear_inverse_mass", _REAL),  # R2^2 tau^2 F / (I2 sigma); of a roller tau^2 F / (m sigma)
    ("half_backlash", _REAL),  # b / sigma
    ("phase_rate", _REAL),  # sigma / pb: turns the gear's surface velocity into the rate of its phase
    ("contact_ratio", _REAL),  # path of contact in pitches
    ("coast_phase", _REAL),  # 2 approach / pb + 1/2: mirrors the coast flank about the pitch point
    ("relief_curvature", _REAL),  # pb^2 / (rho sigma): curvature of the tip relief
    ("relief_slope", _REAL),  # pb / rho
    ("reach", _REAL),  # how far outside the path a pair may still touch, in pitches
    ("start_radius", _REAL),  # pinion's radius of curvature where contact begins, in pitches
    ("sum_curvature", _REAL),  # 1 over the sum of both radii of curvature, per pitch
    ("damping", _REAL),  # viscous mesh damping
    ("drag", _REAL),  # force per squared surface velocity,
    ("viscous", _REAL),  # and per surface velocity
    ("dry", _INT),  # whether there is dry resistance at the gear
    ("error_count", _INT),  # harmonics of the static transmission error: order, amplitude / sigma, phase
    ("error_at", _INT),
    ("torque", TORQUE, (2,)),  # of the pinion (DRIVE) and of the gear (LOAD)
    ("schedule", SCHEDULE, (SCHEDULES,)),  # of both torques and of the speed that the drive holds (SPEED),
    (
        "speed_gain",
        _REAL,
    ),  # and force over what the pinion's surface velocity is short of that; 0 if none is held
    # the contact
    ("cutoff", _REAL),  # gap beyond which the force is taken as zero
    ("contact_gap", _REAL),  # gap of contact onset and separation
    ("lowest_gap", _REAL),  # the model holds above this gap of a pair
    ("material", MATERIAL, (MATERIALS,)),
    ("loading_at", _INT),  # loading branch of all materials together, in forces
    ("potential_at", _INT),  # potential of that branch
    ("slots", _INT),  # histories per flank in use, a power of two, and of all flanks
    ("histories", _INT),
    ("branch_length", _INT),  # size of a branch of the force law or the stored energy; 0 if none is kept
    ("branches_at", _INT),  # where they begin among the rows
    # nodes of an elastic contact
    ("nodes", _INT),  # per pair; 0 for the asperity model
    ("points", _INT),  # the nodes and what lies between them
    ("orders", _INT),  # powers of the contact length in the influence coefficients
    ("length_middle", _REAL),  # that length, counted from the middle of its range and over half of it
    ("length_half_range", _REAL),
    ("profile_at", _INT),  # among the tables: of nodes profile, weights and influence coefficients,
    ("weights_at", _INT),
    ("influence_at", _INT),
    ("point_profile_at", _INT),  # of points profile, weights and shares of the nodes around each
    ("point_weights_at", _INT),
    ("shares_at", _INT),
    ("node_rows_at", _INT),  # where the pairs' nodes begin among the rows
    ("node_row_length", _INT),  # numbers of one pair's nodes there
    # the run
    ("states", _INT),
    ("scale_at", _INT),  # what an error of 1 means for each state, among the tables
    ("error_weights_at", _INT),  # one over the absolute tolerance of each state, among the rows
    ("rtol", _REAL),
    ("start", _REAL),  # time at which the run begins: 0, or the end of the run that it goes on from,
    ("end", _REAL),  # and ends
    ("samples", _INT),  # in the whole run, the first at its start; 0 for none
    ("first_sample", _REAL),  # the start over the time between two samples
    (
        "knot_count",
        _INT,
    ),  # stops inside the run, knots of schedules and checkpoints, among the tables: times,
    ("knots_at", _INT),
    ("checkpoints_at", _INT),  # and for each 1 if a checkpoint is kept there
    ("stop", _INT),  # what ends the run before its time: see `STOPS`
    ("stop_from", _REAL),  # place of the gear in pitches from which its turns are counted,
    ("stop_pitches", _REAL),  # and how many pitches make the turns
    ("rest_speed", _REAL),  # smallest slip speed that counts as motion
    ("root_limit", _INT),  # roots in succession allowed to be closer than `root_spacing`, times 1 + t
    ("root_spacing", _REAL),
    ("torque_omega", _REAL),  # highest angular frequency of the torques that steps have to follow
    (
        "longest_step",
        _REAL,
    ),  # that a cubic schedule allows, which may be flat where a pulse is to come; 0 for any
    ("mesh_omega", _REAL),  # and along the mesh, per pitch
    ("balance_steps", _INT),  # accepted steps that the energy balance integrates over at once,
    ("balance_span", _REAL),  # over which they may last,
    ("balance_error", _REAL),  # error over throughput from which on it takes single steps,
    ("flight_parts", _INT),  # and into which it divides a step in flight
)

# -- what a checkpoint carries ---------------------------------------------------------------------------------------
HISTORY: Final = _record(
    ("pair", _INT),  # number of the pair, counted without the turns taken out of the phase, or EMPTY
    ("direction", _REAL),  # sign of the gap rate; 0 at the very start
    ("gap", _REAL),  # gap and gap rate at the last accepted time
    ("gap_rate", _REAL),
    ("in_contact", _INT),  # 1 between onset and separation
    (
        "joined",
        _REAL,
        (MATERIALS,),
    ),  # height above which asperities were in contact at the last turning point
    ("fully_stretched", _INT, (MATERIALS,)),  # 1 once full stretch has been reached on the way apart
    (
        "adhered_energy",
        _REAL,
        (MATERIALS,),
    ),  # adhesion loss of the asperities above `joined` (asperity model)
    ("lag", _REAL),  # what joining has taken less than it would have at the present contact length,
    ("lag_power", _REAL),  # its rate at the last accepted time, and the rate of that
    ("lag_rate", _REAL),
    ("length", _REAL),  # contact length of an elastic contact, sqrt(radius / pitch), at its last evaluation
    ("loaded", _INT),  # 1 if that evaluation found it within reach
    ("stretched", _INT),  # 1 if asperities of it were stretched at the last turning point
)

ENERGY: Final = _record(  # sums over the run, in the unit of force times sigma
    ("drive_work", _REAL),
    ("drag_loss", _REAL),
    ("dry_loss", _REAL),
    ("damping_loss", _REAL),
    ("adhesion_loss", _REAL),
    ("radius_work", _REAL),
    ("model_change", _REAL),
    ("throughput", _REAL),
    ("start_stored", _REAL),
    ("start_kinetic", _REAL),
    ("quadrature_error", _REAL),  # about how far the quadratures over gathered steps may be out,
    ("loss_error", _REAL),  # and those of drag and damping, which do not decide how many are gathered
    ("peak_kinetic", _REAL),  # largest kinetic energy
)

PROGRESS: Final = _record(  # of a driver
    ("next_sample", _INT),
    ("steps", _INT),
    ("residual_evaluations", _INT),
    ("jacobian_evaluations", _INT),
    ("error_test_failures", _INT),
    ("convergence_failures", _INT),
    ("restarts", _INT),
    ("guard_evaluations", _INT),
    ("flight_steps", _INT),
)

STOPS: Final = ("time", "sticks", "turns")
"""What ends a run, by number."""

PARTS: Final = (0.05, 0.5, 0.95)
"""Where the parts of a run begin over which speeds are judged, as shares of it: start-up, half, last twentieth."""

PART: Final = _record(  # of a run, from where it begins to where the run stands
    ("begun", _INT),
    ("lowest", _REAL),  # speed of the gear
    ("highest", _REAL),
    ("time", _REAL),  # where it began: time,
    ("place", _REAL),  # and how far the gear had turned, in pitches
)

EXTREMES: Final = _record(  # of a run so far, at accepted times and located extrema
    ("begun", _INT),
    ("lowest_speed", _REAL),  # of the gear, or of a roller
    ("highest_speed", _REAL),
    ("top", _REAL),  # highest and lowest speed since start-up,
    ("bottom", _REAL),
    ("fall", _REAL),  # and how far it has fallen below the first and risen above the second
    ("rise", _REAL),
    ("part", PART, (len(PARTS),)),
    ("reversals", _INT),  # how often the speed has fallen to zero
    ("held", _INT),  # 1 while the gear has not turned on by half a pitch since one of them,
    ("held_time", _REAL),  # the time and place of the first such, and the mesh exits until then
    ("held_place", _REAL),
    ("held_exits", _INT),
    ("turn_backs", _INT),  # how often the drive flank's adhesion has turned the gear back there,
    ("turn_back_time", _REAL),  # when it last did,
    ("adhering", _REAL),  # and all times from one such to the next in the same place
    ("mesh_exits", _INT),  # on the drive flank
    ("largest_force", _REAL),  # along the line of action, mesh damping included; of a roller, on it
    ("largest_force_time", _REAL),
    ("smallest_force", _REAL),
    ("smallest_force_time", _REAL),
    ("separation", _REAL),  # least distance of the flanks, deflection included
)

STATE: Final = _record(
    ("time", _REAL),  # last accepted time
    ("turns", _REAL),  # whole pitches taken out of the phase
    ("mark_low", _REAL),  # phases of the nearest mesh entries and exits
    ("mark_high", _REAL),
    (
        "slip",
        _REAL,
    ),  # direction of the gear's slip against dry resistance: -1, +1; 0 while it is held at rest
    ("slipping", _INT),  # 1 once a slip has become faster than `rest_speed`
    ("near", _INT, (2,)),  # flank close enough for any pair to touch
    ("last_flank", _INT),  # flank of the last onset, -1 before the first
    ("bound_exceeded", _INT),  # 1 once a pair has been below the lowest gap
    (
        "stop_armed",
        _INT,
    ),  # 1 once the gear has moved forward, in a run that ends where its speed falls to zero
    ("last_root", _REAL),  # time of the last root, and how many have come in close succession
    ("roots", _INT),
    ("next_knot", _INT),  # index of the coming knot among all knots
    ("segment", _INT, (SCHEDULES,)),  # the schedules' current segments: set at knots, never inside a step
    ("energy", ENERGY),
    ("progress", PROGRESS),
    ("extremes", EXTREMES),
    ("history", HISTORY, (2 * SLOTS_HIGH,)),
)

# -- work space ------------------------------------------------------------------------------------------------------
QUADRATURE: Final = _record(  # inputs of the powers at the last sample of the energy balance
    ("time", _REAL),
    ("steps", _INT),  # accepted since
    ("kinetic", _REAL),
    ("pinion_travel", _REAL),  # of its base circle
    ("pinion_speed", _REAL),
    ("pinion_acceleration", _REAL),
    ("gear_travel", _REAL),
    ("gear_speed", _REAL),
    ("gear_acceleration", _REAL),
    ("drive", _REAL),  # torques over base radius
    ("drive_rate", _REAL),
    ("load", _REAL),
    ("load_rate", _REAL),
    ("radius_power", _REAL),
    ("radius_power_rate", _REAL),
    ("length_work", _REAL),  # work of the radius on the adhesion losses added since then
)

RESISTANCE: Final = _record(  # the same of drag and damping, which are integrated at every step
    ("time", _REAL),
    ("gear_travel", _REAL),
    ("gear_speed", _REAL),
    ("gear_acceleration", _REAL),
    ("mesh_speed", _REAL),
    ("mesh_acceleration", _REAL),
)

ADAMS: Final = _record(
    ("own", _INT),  # 1 with the package's own Newton iteration, 0 with IDA's
    ("evaluations", _INT),  # of the residual with its slopes, so far
    ("failures", _INT),  # of Newton's iteration, so far
    ("contraction_rate", _REAL),  # contraction of Newton's iteration: next correction over this one
    ("omega_sq", _REAL),  # squared angular frequency of the motion, from the last evaluation
    ("wanted", _INT),  # 1 for Adams formulas from the next start on
    ("used", _INT),  # 1 while Adams formulas are used
    ("attempts", _INT),  # steps tried since the start
    ("limited_steps", _INT),  # successive steps limited by stability, not by the error
    ("next_order", _INT),  # order k of the next step: number of former rates
    ("n_history", _INT),  # former rates known
    ("order_used", _INT),  # order k of the last step; 0 if it used IDA's formula
    ("time", _REAL),  # the last accepted time, and the step up to it
    ("last_step", _REAL),
    ("new_step", _REAL),  # length of the step that is tried; 0 once it has been accepted
    ("amplitude_sq", _REAL),  # of the vibration, over the tolerance
    ("new_state", _REAL, (MOTION,)),
    ("predicted_rates", _REAL, (MOTION,)),
    ("state", _REAL, (MOTION,)),  # at the last accepted time
    ("time_lags", _REAL, (MOST_ORDERS + 1,)),  # time from each former rate to it, the newest first
    ("basis_integrals", _REAL, (MOST_ORDERS + 1,)),  # of Newton's polynomials over these times
    ("basis_values", _REAL, (MOST_ORDERS + 1,)),
    (
        "differences",
        _REAL,
        (MOST_ORDERS + 1, MOTION),
    ),  # divided differences of the rates, a row for each order
    ("new_differences", _REAL, (MOST_ORDERS + 1, MOTION)),  # with those at the end of the step that is tried
)

SEARCH: Final = _record(  # for the root of the guard in a step
    ("low", _REAL),  # the guard at the beginning of the search interval
    ("low_time", _REAL),
    ("step_end", _REAL),  # time at the end of the step
    ("rest", _INT),  # 1 after a root: the rest of its step is still to be searched
    ("stop", _INT),  # 1 while a stop waits for the roots before it
    ("stop_time", _REAL),
    ("evaluations", _INT),  # of the guard, so far
    ("as_ida", _INT),  # 1 to search as IDA does, and take the state at a step's end from its interpolant
    ("sharpness", _REAL),  # how sharply to find a root, over the length of the interval
)

DRIVER: Final = _record(
    ("time", _REAL),  # reached
    ("rows", _INT),  # samples and events in the present block
    ("events", _INT),
    ("pending", _INT),  # flag of a step that waits for room, plus 1; 0 for none, -1 for a start
    ("done", _INT),
    ("error", _INT),  # IDA's flag, or one of the driver's own
    ("since", _INT),  # steps since the last checkpoint
)

POINT: Final = _record(  # of an accepted time, what extremes are located from
    ("time", _REAL),
    ("travel", _REAL),  # transmission error, or height, with its rate and acceleration
    ("travel_rate", _REAL),
    ("travel_bend", _REAL),
    ("speed", _REAL),  # of the gear, its acceleration,
    ("speed_rate", _REAL),
    ("place", _REAL),  # and how far it has turned, in pitches
    ("force", _REAL),
)

TRACK: Final = _record(  # of the extremes
    ("time", _REAL),  # the last accepted time
    ("point", POINT, (3,)),  # it, two before it, and in turn the time that is just accepted
    ("last", _INT),  # where among them the last accepted time is
    ("smooth", _INT),  # how many of them the force has passed since its last corner, that included
    ("next_part", _REAL),  # time at which the coming part of the run begins
)

WORK: Final = _record(
    ("quadrature", QUADRATURE),
    ("resistance", RESISTANCE),
    ("track", TRACK),
    ("adams", ADAMS),
    ("search", SEARCH),
    ("driver", DRIVER),
    ("piece", _INT, (SCHEDULES,)),  # of a cubic schedule, last used; where the next search begins
    ("elastic_service", _INT),  # where the compiled code of elastic contacts lies in this process
    ("torque_law", _INT, (2,)),  # and that of the torque law of either shaft; 0 without one
)


class Model(NamedTuple):
    """One scene as compiled code sees it.

    Attributes
    ----------
    scene, state, work : record
        `SCENE`, `STATE` and `WORK`.
    tables : ndarray
        Constants of variable length; where each begins is in `scene`.
    rows : ndarray
        Numbers of variable length that change: branches of the histories, nodes of elastic contacts, error weights.
    """

    scene: Record
    state: Record
    work: Record
    tables: Floats
    rows: Floats


def assign(record: Record, other: Record) -> None:
    """Copy all fields of a record into another of the same kind."""
    record.setfield(other, record.dtype)


def blank_work(work: Record) -> None:
    """Forget what a run has left in the work records; how a driver searches and where compiled code lies stay."""
    fresh = np.zeros(1, WORK)[0]
    for name in ("elastic_service", "torque_law"):
        fresh[name] = work[name]
    for name in ("as_ida", "sharpness"):
        fresh.search[name] = work.search[name]
    fresh.driver.pending = -1  # the driver is to start
    assign(work, fresh)


def empty_history() -> Record:
    """History that is about no pair."""
    empty = np.zeros(1, HISTORY)[0]
    empty.pair = EMPTY
    return empty


def blank_model(scene: Record, tables: Floats, rows: int) -> Model:
    """Model with these constants, nothing known of any pair, and so many numbers that change."""
    state, work = np.zeros(1, STATE)[0], np.zeros(1, WORK)[0]
    state.history["pair"] = EMPTY
    state.last_flank = -1
    return Model(scene, state, work, tables, np.zeros(rows))
