"""``STATE``: all that a checkpoint carries, besides the state vector and the nodes of an elastic contact.

Units as in `gearidae.engine.model.scene_record`.
"""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.record_types import INT, MATERIALS, REAL, SCHEDULES, SLOTS_HIGH, record_type
from gearidae.records import RUN_PARTS

HISTORY: Final = record_type(
    ("pair", INT),  # number of the pair, counted without the turns taken out of the phase, or EMPTY
    ("direction", REAL),  # sign of the gap rate; 0 at the very start
    ("gap", REAL),  # at the last accepted time [sigma]
    ("gap_rate", REAL),  # at the last accepted time [sigma/tau]
    ("in_contact", INT),  # 1 between onset and separation
    ("joined", REAL, (MATERIALS,)),  # height above which asperities joined by the last turn [sigma]
    ("fully_stretched", INT, (MATERIALS,)),  # 1 once full stretch has been reached on the way apart
    (
        "adhered_energy",
        REAL,
        (MATERIALS,),
    ),  # adhesion loss above `joined`, rigid bodies [`force_scale` sigma]
    ("lag", REAL),  # what joining has taken less than at the present contact length [F sigma]
    ("lag_power", REAL),  # rate of `lag` at the last accepted time [F sigma/tau]
    ("lag_rate", REAL),  # rate of `lag_power` there [F sigma/tau^2]
    ("stretched", INT),  # 1 if asperities of it were stretched at the last turning point
    ("slide", INT),  # direction of sliding, -1 or 1; `STUCK`, or 0 while nothing rubs: see `record_types`
)

ENERGY: Final = record_type(  # sums over the run
    ("drive_work", REAL),  # work of the drive [F sigma]
    ("drag_loss", REAL),  # loss by drag and viscous resistance [F sigma]
    ("dry_loss", REAL),  # loss by dry resistance [F sigma]
    ("damping_loss", REAL),  # loss by damping of the mesh [F sigma]
    ("adhesion_loss", REAL),  # loss by joining [F sigma]
    ("radius_work", REAL),  # work of the changing radius of curvature [F sigma]
    ("model_change", REAL),  # jumps of the stored energy where the contact model changes [F sigma]
    ("throughput", REAL),  # all that has been exchanged, without regard to sign [F sigma]
    ("start_stored", REAL),  # energy stored at the start [F sigma]
    ("start_kinetic", REAL),  # energy of motion at the start [F sigma]
    ("quadrature_error", REAL),  # about how far quadratures over gathered steps may be out [F sigma]
    ("loss_error", REAL),  # the same of drag and damping, which do not decide how many are gathered [F sigma]
    ("peak_kinetic", REAL),  # largest energy of motion [F sigma]
    ("flank_loss", REAL, (2,)),  # loss by friction of the drive and the coast flank [F sigma]
    ("hub_loss", REAL, (2,)),  # loss by friction of the pinion's and the gear's hub [F sigma]
)

PROGRESS: Final = record_type(  # of a driver
    ("next_sample", INT),  # index of the coming sample
    ("steps", INT),  # accepted steps
    ("residual_evaluations", INT),  # evaluations of the residual
    ("jacobian_evaluations", INT),  # evaluations of its Jacobian
    ("error_test_failures", INT),  # steps rejected for their error
    ("convergence_failures", INT),  # steps rejected by Newton's iteration
    ("restarts", INT),  # restarts of the integration
    ("guard_evaluations", INT),  # evaluations of the guard
    ("flight_steps", INT),  # steps in free flight
)

STOPS: Final = ("time", "sticks", "turns")
"""What ends a run, by number."""

PART: Final = record_type(  # of a run, from where it begins to where the run stands
    ("begun", INT),  # 1 once it has begun
    ("lowest", REAL),  # lowest speed of the gear [sigma/tau]
    ("highest", REAL),  # highest speed of the gear [sigma/tau]
    ("time", REAL),  # when it began [tau]
    ("position", REAL),  # how far the gear had turned by then [pb]
)

EXTREMES: Final = record_type(  # of a run so far, at accepted times and located extrema
    ("begun", INT),  # 1 once the run has begun
    ("lowest_speed", REAL),  # of the gear, or of a roller [sigma/tau]
    ("highest_speed", REAL),  # of the gear, or of a roller [sigma/tau]
    ("top", REAL),  # highest speed since start-up [sigma/tau]
    ("bottom", REAL),  # lowest speed since start-up [sigma/tau]
    ("fall", REAL),  # how far the speed has fallen below `top` [sigma/tau]
    ("rise", REAL),  # how far it has risen above `bottom` [sigma/tau]
    ("part", PART, (len(RUN_PARTS),)),  # parts of the run
    ("reversals", INT),  # how often the speed has fallen to zero
    ("is_stuck", INT),  # 1 while the gear has not turned on by half a pitch since a reversal
    ("stuck_time", REAL),  # time of the first such reversal [tau]
    ("stuck_position", REAL),  # how far the gear had turned by then [pb]
    ("stuck_exits", INT),  # mesh exits until then
    ("turn_backs", INT),  # how often the drive flank's adhesion has turned the gear back there
    ("turn_back_time", REAL),  # when it last did [tau]
    ("adhering", REAL),  # all times from one such to the next in the same place [tau]
    ("mesh_exits", INT),  # on the drive flank
    ("largest_force", REAL),  # along the line of action with mesh damping; of a roller, on it [F]
    ("largest_force_time", REAL),  # [tau]
    ("smallest_force", REAL),  # likewise [F]
    ("smallest_force_time", REAL),  # [tau]
    ("separation", REAL),  # least distance of the flanks, deflection included [sigma]
)

MOST_ZEROS: Final = 12
"""Zeros of the gear's speed that are kept as beginnings of a standstill."""
HIGH: Final = MOST_ZEROS
SPARE: Final = MOST_ZEROS + 1
"""Places among the zeros: of the zero farthest forward, and of a copy to look ahead with."""
MOST_SLOW: Final = 32
MOST_STANDSTILLS: Final = 64

ZERO: Final = (
    record_type(  # of the gear's speed; free gears start there at rest. Units stay with a change of torques
        ("time", REAL),  # [s]
        ("position", REAL),  # how far the gear had turned by then [pb]
        ("lead", REAL),  # of the pinion's base circle over the gear's, from the start of a chain [sigma]
        ("exits", INT),  # mesh exits until then
        ("lowest", REAL),  # position of the gear since then, at zeros of its speed [pb]
        ("highest", REAL),  # [pb]
        ("start", INT),  # 1 for a start at rest
        ("spent", INT),  # 1 if a standstill that has ended lies behind it
        ("rest_time", REAL),  # time at rest until then [s]
        ("free_time", REAL),  # up to which free gears are followed [s]
        ("free_travel", REAL),  # of free gears [pb]
        ("free_speed", REAL),  # of free gears [pb/s]
        ("free_farthest", REAL),  # largest size of `free_travel` [pb]
        ("free_before", REAL),  # that at the end of the run before [pb]
        ("onset", REAL),  # when free gears have begun to move; 0 before [s]
        ("excess", REAL),  # largest torque of the drive at the gear beyond the dry load [N m]
        ("driven_time", REAL),  # for which there was any [s]
    )
)

SLOW: Final = record_type(  # an accepted time after which the gear has been faster
    ("time", REAL),  # [s]
    ("speed", REAL),  # [pb/s]
    ("position", REAL),  # [pb]
)

STANDSTILL: Final = record_type(  # that has ended
    ("begin", REAL),  # [s]
    ("end", REAL),  # [s]
    ("advance", REAL),  # of the gear [pb]
    ("free_advance", REAL),  # of free gears [pb]
    ("excess", REAL),  # as of a zero [N m]
    ("driven_time", REAL),  # as of a zero [s]
    ("rest_time", REAL),  # at rest [s]
)

STANDING: Final = record_type(
    ("zero_count", INT),  # zeros in use, from which on the gear has stayed within half a pitch
    ("zero", ZERO, (MOST_ZEROS + 2,)),  # in the order of time, then `HIGH` and `SPARE`
    ("slow_count", INT),  # entries in use
    ("slow", SLOW, (MOST_SLOW,)),  # in the order of time, each faster than the one before
    ("direction", INT),  # of the last movement of more than half a pitch; 0 before the first
    ("turn_time", REAL),  # when that became so [s]
    ("high_known", INT),  # 1 if `HIGH` is the zero farthest forward since the gear last went forward
    ("low", REAL),  # position farthest back since it last went back [pb]
    ("left", INT),  # 1 once the gear has left half a pitch from the start of a chain
    ("rest_time", REAL),  # for which all that is dry has held the gear [s]
    ("stand_count", INT),  # standstills that are kept
    ("standstill", STANDSTILL, (MOST_STANDSTILLS,)),  # in the order of time; of more the longest are kept
    ("standstills", INT),  # that have ended
    ("standing_time", REAL),  # of all of these [s]
    ("standing_rest", REAL),  # at rest in all of these [s]
    ("last_end", REAL),  # end of the last of them [s]
    ("breakaway", REAL),  # drive torque then, or at the start [N m]
)

STATE: Final = record_type(
    ("time", REAL),  # last accepted time [tau]
    ("turns", REAL),  # whole pitches taken out of the phase [pb]
    (
        "first_place",
        REAL,
    ),  # position of the gear where a chain of runs began, where shafts' angles are 0 [pb]
    ("first_lead", REAL),  # u + e there: lead of the pinion's base circle over the gear's [sigma]
    ("mark_low", REAL),  # phase of the nearest mesh entry or exit below the present one [pb]
    ("mark_high", REAL),  # phase of the nearest one above [pb]
    ("slip", REAL),  # direction of the gear's slip against dry resistance, -1 or +1; 0 while it is stuck
    ("slipping", INT),  # 1 once a slip has become faster than `rest_speed`
    ("near", INT, (2,)),  # 1 for a flank close enough for any pair to touch
    ("last_flank", INT),  # flank of the last onset, -1 before the first
    ("bound_exceeded", INT),  # 1 once a pair has been below the lowest gap
    ("deep_exits", INT),  # mesh exits when elastic contacts were last too deep for rigid ones, -1 before
    ("light", INT),  # 1 once that has been long ago
    ("last_root", REAL),  # time of the last root [tau]
    ("roots", INT),  # how many have come in close succession
    ("next_knot", INT),  # index of the coming knot among all knots
    ("segment", INT, (SCHEDULES,)),  # the schedules' current segments: set at knots, never inside a step
    ("energy", ENERGY),  # energy balance
    ("progress", PROGRESS),  # counters of the driver
    ("extremes", EXTREMES),  # extremes of the run
    ("standing", STANDING),  # where the gear stands, and what free gears would do
    ("history", HISTORY, (2 * SLOTS_HIGH,)),  # of the tooth pairs
    ("asperity_onsets", INT),  # asperities of a population that have joined so far [1]
    ("asperity_detachments", INT),  # those that have detached [1]
    ("cycle_events", INT),  # both since the last mesh mark [1]
    ("hold", INT),  # what friction holds at rest: see `record_types`
    ("held_pair", INT),  # history of the pair that rolls, if that is held [index]
    ("pinion_slip", REAL),  # direction in which the pinion turns in its hub, -1 or +1; 0 while it is held
    (
        "reversals",
        INT,
    ),  # changes of sliding of the flanks since the last mesh mark, or in a share of the run [1]
    ("counted_from", REAL),  # when they have last been counted from zero [tau]
    (
        "load_sign",
        REAL,
    ),  # +1 where the vector sum of the mesh forces points forward, -1 behind its passage of zero
)
