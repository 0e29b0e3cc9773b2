"""``STATE``: all that a checkpoint carries, besides the state vector and the nodes of an elastic contact."""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.record_types import INT, MATERIALS, REAL, SCHEDULES, SLOTS_HIGH, record_type

__all__ = [
    "ENERGY",
    "EXTREMES",
    "HISTORY",
    "PART",
    "PARTS",
    "PROGRESS",
    "STATE",
    "STOPS",
]

HISTORY: Final = record_type(
    ("pair", INT),  # number of the pair, counted without the turns taken out of the phase, or EMPTY
    ("direction", REAL),  # sign of the gap rate; 0 at the very start
    ("gap", REAL),  # gap and gap rate at the last accepted time
    ("gap_rate", REAL),
    ("in_contact", INT),  # 1 between onset and separation
    (
        "joined",
        REAL,
        (MATERIALS,),
    ),  # height above which asperities were in contact at the last turning point
    ("fully_stretched", INT, (MATERIALS,)),  # 1 once full stretch has been reached on the way apart
    (
        "adhered_energy",
        REAL,
        (MATERIALS,),
    ),  # adhesion loss of the asperities above `joined` (asperity model)
    ("lag", REAL),  # what joining has taken less than it would have at the present contact length,
    ("lag_power", REAL),  # its rate at the last accepted time, and the rate of that
    ("lag_rate", REAL),
    ("length", REAL),  # contact length of an elastic contact, sqrt(radius / pitch), at its last evaluation
    ("loaded", INT),  # 1 if that evaluation found it within reach
    ("stretched", INT),  # 1 if asperities of it were stretched at the last turning point
)

ENERGY: Final = record_type(  # sums over the run, in the unit of force times sigma
    ("drive_work", REAL),
    ("drag_loss", REAL),
    ("dry_loss", REAL),
    ("damping_loss", REAL),
    ("adhesion_loss", REAL),
    ("radius_work", REAL),
    ("model_change", REAL),
    ("throughput", REAL),
    ("start_stored", REAL),
    ("start_kinetic", REAL),
    ("quadrature_error", REAL),  # about how far the quadratures over gathered steps may be out,
    ("loss_error", REAL),  # and those of drag and damping, which do not decide how many are gathered
    ("peak_kinetic", REAL),  # largest kinetic energy
)

PROGRESS: Final = record_type(  # of a driver
    ("next_sample", INT),
    ("steps", INT),
    ("residual_evaluations", INT),
    ("jacobian_evaluations", INT),
    ("error_test_failures", INT),
    ("convergence_failures", INT),
    ("restarts", INT),
    ("guard_evaluations", INT),
    ("flight_steps", INT),
)

STOPS: Final = ("time", "sticks", "turns")
"""What ends a run, by number."""

PARTS: Final = (0.05, 0.5, 0.95)
"""Where the parts of a run begin over which speeds are judged, as shares of it: start-up, half, last twentieth."""

PART: Final = record_type(  # of a run, from where it begins to where the run stands
    ("begun", INT),
    ("lowest", REAL),  # speed of the gear
    ("highest", REAL),
    ("time", REAL),  # where it began: time,
    ("place", REAL),  # and how far the gear had turned, in pitches
)

EXTREMES: Final = record_type(  # of a run so far, at accepted times and located extrema
    ("begun", INT),
    ("lowest_speed", REAL),  # of the gear, or of a roller
    ("highest_speed", REAL),
    ("top", REAL),  # highest and lowest speed since start-up,
    ("bottom", REAL),
    ("fall", REAL),  # and how far it has fallen below the first and risen above the second
    ("rise", REAL),
    ("part", PART, (len(PARTS),)),
    ("reversals", INT),  # how often the speed has fallen to zero
    ("held", INT),  # 1 while the gear has not turned on by half a pitch since one of them,
    ("held_time", REAL),  # the time and place of the first such, and the mesh exits until then
    ("held_place", REAL),
    ("held_exits", INT),
    ("turn_backs", INT),  # how often the drive flank's adhesion has turned the gear back there,
    ("turn_back_time", REAL),  # when it last did,
    ("adhering", REAL),  # and all times from one such to the next in the same place
    ("mesh_exits", INT),  # on the drive flank
    ("largest_force", REAL),  # along the line of action, mesh damping included; of a roller, on it
    ("largest_force_time", REAL),
    ("smallest_force", REAL),
    ("smallest_force_time", REAL),
    ("separation", REAL),  # least distance of the flanks, deflection included
)

STATE: Final = record_type(
    ("time", REAL),  # last accepted time
    ("turns", REAL),  # whole pitches taken out of the phase
    ("mark_low", REAL),  # phases of the nearest mesh entries and exits
    ("mark_high", REAL),
    (
        "slip",
        REAL,
    ),  # direction of the gear's slip against dry resistance: -1, +1; 0 while it is held at rest
    ("slipping", INT),  # 1 once a slip has become faster than `rest_speed`
    ("near", INT, (2,)),  # flank close enough for any pair to touch
    ("last_flank", INT),  # flank of the last onset, -1 before the first
    ("bound_exceeded", INT),  # 1 once a pair has been below the lowest gap
    (
        "deep_exits",
        INT,
    ),  # mesh exits when elastic contacts were last too deep for the asperity model, -1 before,
    ("light", INT),  # and 1 once that has been long ago
    (
        "stop_armed",
        INT,
    ),  # 1 once the gear has moved forward, in a run that ends where its speed falls to zero
    ("asperity_onsets", INT),  # single asperities that have joined, and let go, so far
    ("asperity_detachments", INT),
    ("cycle_events", INT),  # both since the last mesh mark
    ("last_root", REAL),  # time of the last root, and how many have come in close succession
    ("roots", INT),
    ("next_knot", INT),  # index of the coming knot among all knots
    ("segment", INT, (SCHEDULES,)),  # the schedules' current segments: set at knots, never inside a step
    ("energy", ENERGY),
    ("progress", PROGRESS),
    ("extremes", EXTREMES),
    ("history", HISTORY, (2 * SLOTS_HIGH,)),
)
