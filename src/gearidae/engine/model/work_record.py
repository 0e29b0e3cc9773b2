"""``WORK``: work space, which can be worked out anew from the scene and a checkpoint.

Units as in `gearidae.engine.model.scene_record`.
"""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.checkpoint_record import STANDING
from gearidae.engine.model.record_types import (
    INT,
    MATERIALS,
    MOST_ORDERS,
    MOTION,
    REAL,
    SCHEDULES,
    SLOTS_HIGH,
    record_type,
)
from gearidae.laws.frictions import FRICTION_LAWS
from gearidae.records.energy import ENERGY_NOW

NOTED_FRICTION: Final = record_type(*(field for law in FRICTION_LAWS for field in law.noted))
"""What set-valued laws of a shaft note for their losses."""

QUADRATURE: Final = record_type(  # inputs of the powers at the last sample of the energy balance
    ("time", REAL),  # [tau]
    ("steps", INT),  # accepted since
    ("kinetic", REAL),  # energy of motion [F sigma]
    ("pinion_travel", REAL),  # of its base circle [sigma]
    ("pinion_speed", REAL),  # [sigma/tau]
    ("pinion_acceleration", REAL),  # [sigma/tau^2]
    ("gear_travel", REAL),  # of its base circle [sigma]
    ("gear_speed", REAL),  # [sigma/tau]
    ("gear_acceleration", REAL),  # [sigma/tau^2]
    ("drive", REAL),  # torque over base radius [F]
    ("drive_rate", REAL),  # [F/tau]
    ("friction", NOTED_FRICTION, (2,)),  # of both shafts
    ("radius_power", REAL),  # of the changing radius [F sigma/tau]
    ("radius_power_rate", REAL),  # [F sigma/tau^2]
    ("length_work", REAL),  # of the radius on the adhesion losses added since then [F sigma]
)

RESISTANCE: Final = record_type(  # the same of drag and damping, which are integrated at every step
    ("time", REAL),  # [tau]
    ("gear_travel", REAL),  # [sigma]
    ("gear_speed", REAL),  # [sigma/tau]
    ("gear_acceleration", REAL),  # [sigma/tau^2]
    ("pinion_travel", REAL),  # where laws act on the pinion [sigma]
    ("pinion_speed", REAL),  # [sigma/tau]
    ("pinion_acceleration", REAL),  # [sigma/tau^2]
    ("mesh_travel", REAL),  # transmission error [sigma]
    ("mesh_speed", REAL),  # rate of the transmission error [sigma/tau]
    ("mesh_acceleration", REAL),  # [sigma/tau^2]
)

ADAMS: Final = record_type(
    ("native_newton", INT),  # 1 with the package's own Newton iteration, 0 with IDA's
    ("evaluations", INT),  # of the residual with its slopes, so far
    ("failures", INT),  # of Newton's iteration, so far
    ("contraction_rate", REAL),  # contraction of Newton's iteration: next correction over this one [1]
    ("omega_sq", REAL),  # squared angular frequency of the motion, from the last evaluation [1/tau^2]
    ("wanted", INT),  # 1 for Adams formulas from the next start on
    ("used", INT),  # 1 while Adams formulas are used
    ("attempts", INT),  # steps tried since the start
    ("limited_steps", INT),  # successive steps limited by stability, not by the error
    ("next_order", INT),  # order k of the next step: number of former rates
    ("n_history", INT),  # former rates known
    ("order_used", INT),  # order k of the last step; 0 if it used IDA's formula
    ("time", REAL),  # last accepted time [tau]
    ("last_step", REAL),  # step up to it [tau]
    ("new_step", REAL),  # length of the step that is tried; 0 once it has been accepted [tau]
    ("amplitude_sq", REAL),  # squared amplitude of the vibration over the tolerance [1]
    ("new_state", REAL, (MOTION,)),  # at the end of the step that is tried
    ("predicted_rates", REAL, (MOTION,)),  # rates there as predicted
    ("state", REAL, (MOTION,)),  # at the last accepted time
    ("time_lags", REAL, (MOST_ORDERS + 1,)),  # time from each former rate to it, the newest first [tau]
    ("basis_integrals", REAL, (MOST_ORDERS + 1,)),  # of Newton's polynomials over these times
    ("basis_values", REAL, (MOST_ORDERS + 1,)),  # of Newton's polynomials at the end of the step
    (
        "differences",
        REAL,
        (MOST_ORDERS + 1, MOTION),
    ),  # divided differences of the rates, a row for each order
    ("new_differences", REAL, (MOST_ORDERS + 1, MOTION)),  # with those at the end of the step that is tried
)

SEARCH: Final = record_type(  # for the root of the guard in a step
    ("low", REAL),  # the guard at the beginning of the search interval
    ("low_time", REAL),  # when that is [tau]
    ("step_end", REAL),  # time at the end of the step [tau]
    ("rest", INT),  # 1 after a root: the rest of its step is still to be searched
    ("stop", INT),  # 1 while a stop waits for the roots before it
    ("stop_time", REAL),  # when that stop is [tau]
    ("evaluations", INT),  # of the guard, so far
    ("as_ida", INT),  # 1 to search as IDA does, and take the state at a step's end from its interpolant
    ("sharpness", REAL),  # how sharply to find a root, over the length of the interval [1]
)

DRIVER: Final = record_type(
    ("time", REAL),  # reached [tau]
    ("rows", INT),  # samples in the present block
    ("events", INT),  # events in the present block
    ("passages", INT),  # passages in the present block
    ("impacts", INT),  # impacts in the present block
    ("pending", INT),  # flag of a step that waits for room, plus 1; 0 for none, -1 for a start
    ("done", INT),  # 1 at the end of the run
    ("error", INT),  # IDA's flag, or one of the driver's own
    ("since", INT),  # steps since the last checkpoint
    ("step_end", REAL),  # where the last whole step has ended, or the last start was [tau]
    ("step", REAL),  # length of that step, 0 at a start [tau]
    ("resting", INT),  # 1 while nothing moves: the time goes on without an integration
    ("counted", INT, (5,)),  # of IDA's counters since its last start, what the run's own already have
)

POINT: Final = record_type(  # of an accepted time, what extremes are located from
    ("time", REAL),  # [tau]
    ("travel", REAL),  # transmission error, or height [sigma]
    ("travel_rate", REAL),  # [sigma/tau]
    ("travel_acceleration", REAL),  # [sigma/tau^2]
    ("speed", REAL),  # of the gear [sigma/tau]
    ("speed_rate", REAL),  # [sigma/tau^2]
    ("position", REAL),  # how far the gear has turned [pb]
    ("force", REAL),  # along the line of action [F]
)

TRACK: Final = record_type(  # of the extremes
    ("time", REAL),  # last accepted time [tau]
    ("point", POINT, (3,)),  # it, two before it, and in turn the time that is just accepted
    ("last", INT),  # index of the last accepted time among them
    ("smooth", INT),  # how many of them the force has passed since its last corner, that included
    ("next_part", REAL),  # time at which the coming part of the run begins [tau]
    ("planned", REAL),  # time of the zero for which the end of a run that is to stop is planned, plus 1 [s]
    ("stop_time", REAL),  # when that end is; 0 for none [tau]
)

MOST_LEAVINGS: Final = 8
"""In a block: one takes a movement by half a pitch, which is hundreds of steps."""

EXPOSED: Final = record_type(  # a pair where its exposures have last been added up
    ("known", INT),  # 1 if it was within the cut-off there
    ("pair", INT),  # its number
    ("row", INT),  # where its tooth begins among the rows [index]
    ("time", REAL),  # [tau]
    ("position", REAL),  # along the path of contact [pb]
    ("bin", INT),  # that this lies in
    ("turned", INT),  # 1 from where it began to close until something joins
    ("pulls", INT),  # 1 from where it has been seen to pull
    ("lowest", REAL),  # least gap at a turning point in this bin [sigma]
    ("front", REAL, (MATERIALS,)),  # asperities in contact that have been added up, over their density
    ("added", REAL, (MATERIALS,)),  # contacts that have been added since the last turning point
    ("number", REAL, (MATERIALS,)),  # asperities in contact, over their density
    ("base", REAL, (MATERIALS,)),  # those at the last turning point
    ("gap", REAL),  # [sigma]
    ("gap_rate", REAL),  # [sigma/tau]
    ("power", REAL),  # force times magnitude of the sliding speed [F sigma/tau]
    ("power_rate", REAL),  # [F sigma/tau^2]
    ("side", INT),  # sign of the sliding speed
    ("seen_time", REAL),  # when its pressure has last been looked at [tau]
    ("seen_position", REAL),  # where that was [pb]
    ("seen_bin", INT),  # bin of that
    ("force", REAL),  # there [F]
    ("force_rate", REAL),  # there [F/tau]
    ("friction", REAL),  # power of its friction as last noted [F sigma/tau]
    ("friction_rate", REAL),  # [F sigma/tau^2]
    ("rubbed", REAL),  # work of friction in the present step [F sigma]
)

EXPOSING: Final = record_type(
    ("time", REAL),  # when the exposures of all pairs have last been added up [tau]
    ("begun", INT),  # 0 before the first start
    ("often", INT),  # 1 where contacts are added up as often as sliding work
    ("steps", INT),  # accepted since then
    ("steps_per_interval", INT),  # how many of them end the interval of sliding work
    ("wanted", INT),  # after how many of them pressures are looked at next
    ("error", REAL),  # error estimate of sliding work in this interval [F sigma]
    ("work", REAL),  # sliding work of the last intervals; former ones count less [F sigma]
    ("counted", REAL),  # how many steps they had [1]
    ("pair", EXPOSED, (2 * SLOTS_HIGH,)),
)

FOLLOWED: Final = record_type(  # the load of a pair in contact, where its impact has last been followed
    ("time", REAL),  # [tau]
    ("force", REAL),  # [F]
    ("force_rate", REAL),  # [F/tau]
    ("power", REAL),  # that it takes from the motion [F sigma/tau]
    ("power_rate", REAL),  # [F sigma/tau^2]
)

NOTED: Final = record_type(  # a pair where its force was evaluated
    ("history", INT),  # index of its history
    ("pair", INT),  # its number
    ("position", REAL),  # along the path of contact [pb]
    ("gap", REAL),  # [sigma]
    ("gap_rate", REAL),  # [sigma/tau]
    ("relief", REAL),  # slope of the tip relief along the path [1]
    ("force", REAL),  # [F]
    ("slope", REAL),  # of the force in the gap [F/sigma]
    ("drift", REAL),  # rate of the force at that gap, where its law has it [F/tau]
    ("contact", REAL),  # what asperities in contact carry of the force [F]
    ("contact_slope", REAL),  # of that in the gap [F/sigma]
    ("limit", REAL),  # of its friction; below zero where nothing rubs [F]
    ("limit_slope", REAL),  # in the gap [F/sigma]
    ("limit_rate", REAL),  # [F/tau]
    ("force_rate", REAL),  # [F/tau]
    ("damping", REAL),  # slope of the force in the gap's rate [F tau/sigma]
)

NOTES: Final = record_type(  # the last evaluation of all forces
    ("count", INT),  # pairs
    ("pair", NOTED, (2 * SLOTS_HIGH,)),
)

SETTLING: Final = record_type(  # deflections of a pair where nodes are eliminated
    ("evaluated", INT),  # 1 once they have been evaluated since the last step's end
    ("known", INT),  # 1 if the history was about the pair at that evaluation
    ("time", REAL),  # of that evaluation [tau]
    ("gap", REAL),  # of the pair at that evaluation [sigma]
    ("last_known", INT),  # 1 if they are known at the end of the last step
    ("last_time", REAL),  # [tau]
    ("last_gap", REAL),  # [sigma]
    ("last_rate", REAL),  # of the gap [sigma/tau]
    ("before_known", INT),  # 1 if they are known at the end of the step before
    ("before_time", REAL),  # [tau]
    ("before_gap", REAL),  # [sigma]
    ("before_rate", REAL),  # of the gap [sigma/tau]
    ("reached", INT),  # 1 if the pair is within reach at the end of the step
)

ELEMENT: Final = record_type(  # that dry friction may hold at rest
    ("pinion", REAL),  # its speed per surface velocity of the pinion [1]
    ("gear", REAL),  # and of the gear [1]
    ("limit", REAL),  # of its friction, without what grows with the load of a hub [F]
    ("by_load", REAL),  # what its limit grows by with the load of its hub [1]
    ("flank", INT),  # 1 for a pair of the coast flank
    ("hold", INT),  # `HELD_PAIR`, `HELD_GEAR` or `HELD_PINION`
    ("history", INT),  # of a pair [index]
)

FRICTION_WORK: Final = record_type(  # friction
    ("count", INT),  # elements at rest [1]
    ("pairs", INT),  # how many of them are pairs, which come first [1]
    ("element", ELEMENT, (2 * SLOTS_HIGH + 2,)),
    (
        "load",
        REAL,
        (2,),
    ),  # vector sum of the mesh forces without friction, along and across the line of action [F]
    ("pin", REAL, (2,)),  # force of the pin in the same components [F]
    ("continued", INT),  # 1 if a load of a hub has gone on below zero since the last passage of zero
    ("before_slip", REAL),  # the gear's direction of slip before the decisions of one time
    ("before_pair", INT, (2 * SLOTS_HIGH,)),  # pair of each history then
    ("before_slide", INT, (2 * SLOTS_HIGH,)),  # and its direction
    ("time", REAL),  # of the powers [tau]
    (
        "power",
        REAL,
        (8,),
    ),  # of both flanks, hubs and the pin; loads times sliding speeds of the joints [F sigma/tau]
    ("power_rate", REAL, (8,)),  # [F sigma/tau^2]
)

CONTACT: Final = record_type(  # of a population: the candidates of a pair
    ("known", INT),  # 1 where they have been chosen for the pair of the history
    ("gap", REAL),  # down to which they hold [sigma]
    ("low", REAL),  # position along the path from which they hold [pb]
    ("high", REAL),  # position up to which they hold [pb]
    ("count", INT),  # [1]
    ("joined", INT),  # those that are joined [1]
    ("asperity_switches", INT),  # asperities that have joined or detached at the present root [1]
    ("started", INT),  # 1 where the pair was there when the step began
    ("start_moves", INT),  # 1 where it was on the path of contact then
    ("start_gap", REAL),  # its gap then [sigma]
    ("start_rate", REAL),  # its gap rate then [sigma/tau]
    ("start_position", REAL),  # its position along the path then [pb]
    ("start_position_rate", REAL),  # the rate of that [pb/tau]
)

MESH_ERROR: Final = record_type(  # the last evaluation of the error of the mesh
    ("known", INT),  # 1 if there has been one
    ("u", REAL),  # state of which it is [sigma]
    ("phase", REAL),  # [pb]
    ("whole_pitches", REAL),  # [pb]
    ("angle", REAL),  # of the pinion [rad]
    ("value", REAL),  # [sigma]
    ("pinion", REAL),  # derivatives in the pinion's angle [1]
    ("pinion_curvature", REAL),  # [1/sigma]
    ("gear", REAL),  # and in the gear's [1]
    ("gear_curvature", REAL),  # [1/sigma]
)

PITCH_ERROR: Final = record_type(  # of the teeth of a pair, as last looked up
    (
        "tag",
        REAL,
    ),  # number of the pair with all turns, and a half, so that no pair has the tag of blank records [1]
    ("value", REAL),  # [sigma]
)

ORBIT: Final = record_type(  # of the pinion in its hub, at the time that is looked at
    ("time", REAL),  # [tau]
    ("error", REAL),  # what it adds to the error of the mesh [sigma]
    ("error_rate", REAL),  # [sigma/tau]
    ("error_acceleration", REAL),  # [sigma/tau^2]
    ("play_rate", REAL),  # rate of what it adds to the gap of the coast flank besides u [sigma/tau]
    ("play_acceleration", REAL),  # [sigma/tau^2]
    ("origin", REAL),  # of the values that a polynomial goes through [tau]
    ("step", REAL),  # between them; 0 before there are any [tau]
    ("value", REAL, (2, 6)),  # their divided differences: of the error and of the coast gap [sigma]
    ("work_time", REAL),  # to which the work of the moving centre is booked [tau]
    ("power", REAL),  # of that, then [F sigma/tau]
    ("power_rate", REAL),  # [F sigma/tau^2]
)

WORK: Final = record_type(
    ("quadrature", QUADRATURE),  # of the energy balance
    ("resistance", RESISTANCE),  # of the energy balance
    ("energy_now", record_type(*ENERGY_NOW)),  # of a look at the energy balance
    ("track", TRACK),  # of the extremes
    ("adhesion_lag_time", REAL),  # time to which the lags of joining are followed [tau]
    ("exposing", EXPOSING),  # of the exposures
    ("known", INT, (2 * SLOTS_HIGH,)),  # histories of the pairs that have been listed last [index]
    ("pair_forces", NOTES),  # forces of single pairs
    (
        "shares",
        REAL,
        (2 * SLOTS_HIGH, MATERIALS),
    ),  # by tooth and position, of elastic contacts as last computed [1]
    ("settling", SETTLING, (2 * SLOTS_HIGH,)),  # of elastic contacts
    ("not_converged", INT),  # 1 where no stable deflections have been found since it was set to 0
    ("adams", ADAMS),  # of the integrator
    ("search", SEARCH),  # of the root search
    ("driver", DRIVER),
    ("piece", INT, (SCHEDULES,)),  # of a cubic schedule, last used; where the next search begins [index]
    ("torque_law", INT, (2,)),  # where the compiled torque law of either shaft lies; 0 without one [address]
    (
        "torque_switch",
        INT,
        (2,),
    ),  # where the function lies whose zeros are where it switches; 0 without one [address]
    ("elsewhere", INT),  # 1 while laws are asked of shafts that are not those of the run: of free gears
    ("law_side", REAL, (2,)),  # its sign since the last start [1]
    ("law_from", REAL),  # time of the last knot, just behind it [tau]
    ("law_until", REAL),  # and of the next, just before it; 0 outside a run [tau]
    ("law_jumps", INT),  # jumps of laws in close succession [1]
    ("law_steps", INT),  # steps since the last of them [1]
    ("law_beyond", INT),  # 1 if one of IDA's iterates of this step has been beyond a switch
    (
        "law_speed",
        REAL,
        (2,),
    ),  # of a shaft at its law's last jump, if its law jumps with the speed; else not a number
    ("contact", CONTACT, (2 * SLOTS_HIGH,)),  # of a population
    ("friction", FRICTION_WORK),  # of friction
    ("mesh_error", MESH_ERROR),  # of a mesh that has one
    ("pitch_error", PITCH_ERROR, (2 * SLOTS_HIGH,)),  # by history
    ("orbit", ORBIT),  # of a pinion that has one
    # by history: number of the pair within the cut-off plus 0.5, so that 0 is none
    ("within", REAL, (2 * SLOTS_HIGH,)),
    ("impact", FOLLOWED, (2 * SLOTS_HIGH,)),  # by history
    ("leavings", INT),  # times in this block at which the gear has left half a pitch from its first zero
    ("leaving", STANDING, (MOST_LEAVINGS,)),  # what was known of where it stood then
)
