"""``WORK``: work space, which can be worked out anew from the scene and a checkpoint."""

from __future__ import annotations

from typing import Final

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

__all__ = [
    "ADAMS",
    "CELL",
    "CONTACT",
    "DRIVER",
    "EXPOSED",
    "EXPOSING",
    "NOTED",
    "NOTES",
    "POINT",
    "QUADRATURE",
    "RESISTANCE",
    "SEARCH",
    "SETTLING",
    "TRACK",
    "WORK",
]

QUADRATURE: Final = record_type(  # inputs of the powers at the last sample of the energy balance
    ("time", REAL),
    ("steps", INT),  # accepted since
    ("kinetic", REAL),
    ("pinion_travel", REAL),  # of its base circle
    ("pinion_speed", REAL),
    ("pinion_acceleration", REAL),
    ("gear_travel", REAL),
    ("gear_speed", REAL),
    ("gear_acceleration", REAL),
    ("drive", REAL),  # torques over base radius
    ("drive_rate", REAL),
    ("load", REAL),
    ("load_rate", REAL),
    ("radius_power", REAL),
    ("radius_power_rate", REAL),
    ("length_work", REAL),  # work of the radius on the adhesion losses added since then
)

RESISTANCE: Final = record_type(  # the same of drag and damping, which are integrated at every step
    ("time", REAL),
    ("gear_travel", REAL),
    ("gear_speed", REAL),
    ("gear_acceleration", REAL),
    ("mesh_speed", REAL),
    ("mesh_acceleration", REAL),
)

ADAMS: Final = record_type(
    ("own", INT),  # 1 with the package's own Newton iteration, 0 with IDA's
    ("evaluations", INT),  # of the residual with its slopes, so far
    ("failures", INT),  # of Newton's iteration, so far
    ("contraction_rate", REAL),  # contraction of Newton's iteration: next correction over this one
    ("omega_sq", REAL),  # squared angular frequency of the motion, from the last evaluation
    ("wanted", INT),  # 1 for Adams formulas from the next start on
    ("used", INT),  # 1 while Adams formulas are used
    ("attempts", INT),  # steps tried since the start
    ("limited_steps", INT),  # successive steps limited by stability, not by the error
    ("next_order", INT),  # order k of the next step: number of former rates
    ("n_history", INT),  # former rates known
    ("order_used", INT),  # order k of the last step; 0 if it used IDA's formula
    ("time", REAL),  # the last accepted time, and the step up to it
    ("last_step", REAL),
    ("new_step", REAL),  # length of the step that is tried; 0 once it has been accepted
    ("amplitude_sq", REAL),  # of the vibration, over the tolerance
    ("new_state", REAL, (MOTION,)),
    ("predicted_rates", REAL, (MOTION,)),
    ("state", REAL, (MOTION,)),  # at the last accepted time
    ("time_lags", REAL, (MOST_ORDERS + 1,)),  # time from each former rate to it, the newest first
    ("basis_integrals", REAL, (MOST_ORDERS + 1,)),  # of Newton's polynomials over these times
    ("basis_values", REAL, (MOST_ORDERS + 1,)),
    (
        "differences",
        REAL,
        (MOST_ORDERS + 1, MOTION),
    ),  # divided differences of the rates, a row for each order
    ("new_differences", REAL, (MOST_ORDERS + 1, MOTION)),  # with those at the end of the step that is tried
)

SEARCH: Final = record_type(  # for the root of the guard in a step
    ("low", REAL),  # the guard at the beginning of the search interval
    ("low_time", REAL),
    ("step_end", REAL),  # time at the end of the step
    ("rest", INT),  # 1 after a root: the rest of its step is still to be searched
    ("stop", INT),  # 1 while a stop waits for the roots before it
    ("stop_time", REAL),
    ("evaluations", INT),  # of the guard, so far
    ("as_ida", INT),  # 1 to search as IDA does, and take the state at a step's end from its interpolant
    ("sharpness", REAL),  # how sharply to find a root, over the length of the interval
)

DRIVER: Final = record_type(
    ("time", REAL),  # reached
    ("rows", INT),  # samples and events in the present block
    ("events", INT),
    ("pending", INT),  # flag of a step that waits for room, plus 1; 0 for none, -1 for a start
    ("done", INT),
    ("error", INT),  # IDA's flag, or one of the driver's own
    ("since", INT),  # steps since the last checkpoint
    ("step_end", REAL),  # where the last whole step has ended, or the last start was,
    ("step", REAL),  # and the length of that step, 0 at a start
    ("counted", INT, (5,)),  # of IDA's counters since its last start, what the run's own already have
)

POINT: Final = record_type(  # of an accepted time, what extremes are located from
    ("time", REAL),
    ("travel", REAL),  # transmission error, or height, with its rate and acceleration
    ("travel_rate", REAL),
    ("travel_bend", REAL),
    ("speed", REAL),  # of the gear, its acceleration,
    ("speed_rate", REAL),
    ("place", REAL),  # and how far it has turned, in pitches
    ("force", REAL),
)

TRACK: Final = record_type(  # of the extremes
    ("time", REAL),  # the last accepted time
    ("point", POINT, (3,)),  # it, two before it, and in turn the time that is just accepted
    ("last", INT),  # where among them the last accepted time is
    ("smooth", INT),  # how many of them the force has passed since its last corner, that included
    ("next_part", REAL),  # time at which the coming part of the run begins
)

EXPOSED: Final = record_type(  # a pair where its exposures have last been added up
    ("known", INT),  # whether it was within the cut-off there
    ("pair", INT),
    ("row", INT),  # where its tooth begins among the rows
    ("time", REAL),
    ("place", REAL),  # along the path of contact, in pitches,
    ("at", INT),  # and the index of what it is divided into
    ("turned", INT),  # 1 from where it began to close until something joins
    ("pulls", INT),  # 1 from where it has been seen to pull
    ("lowest", REAL),  # least gap at a turning point in this place
    ("front", REAL, (MATERIALS,)),  # asperities in contact that have been added up, over their density
    ("added", REAL, (MATERIALS,)),  # contacts that have been added since the last turning point
    ("number", REAL, (MATERIALS,)),  # asperities in contact, over their density,
    ("base", REAL, (MATERIALS,)),  # and at the last turning point
    ("gap", REAL),  # and its rate
    ("gap_rate", REAL),
    ("power", REAL),  # force times magnitude of the sliding speed, and its rate
    ("power_rate", REAL),
    ("side", INT),  # sign of the sliding speed
    ("seen_time", REAL),  # when its pressure has last been looked at, and where
    ("seen_place", REAL),
    ("seen_at", INT),
    ("force", REAL),  # there, with its rate
    ("force_rate", REAL),
)

EXPOSING: Final = record_type(
    ("time", REAL),  # when the exposures of all pairs have last been added up
    ("begun", INT),  # 0 before the first start
    ("often", INT),  # 1 where contacts are added up as often as sliding work
    ("steps", INT),  # accepted since then,
    ("at_once", INT),  # how many of them end the interval of sliding work,
    ("wanted", INT),  # and after how many of them pressures are looked at next
    ("error", REAL),  # error estimate of sliding work in this interval
    ("work", REAL),  # sliding work of the last intervals, and how many steps they had; former ones count less
    ("counted", REAL),
    ("pair", EXPOSED, (2 * SLOTS_HIGH,)),
)

NOTED: Final = record_type(  # a pair where its force was evaluated
    ("history", INT),  # index of its history
    ("pair", INT),
    ("place", REAL),  # along the path of contact, in pitches
    ("gap", REAL),  # and its rate
    ("gap_rate", REAL),
    ("force", REAL),  # and its slope in the gap
    ("slope", REAL),
)

NOTES: Final = record_type(  # the last evaluation of all forces, in a run that keeps exposures
    ("time", REAL),
    ("travel", REAL),  # transmission error
    ("count", INT),
    ("pair", NOTED, (2 * SLOTS_HIGH,)),
)

SETTLING: Final = record_type(  # deflections of a pair where nodes are eliminated
    ("evaluated", INT),  # since the last step's end,
    ("known", INT),  # and then whether the history was about the pair, the time and the pair's gap
    ("time", REAL),
    ("gap", REAL),
    ("last_known", INT),  # the end of the last step, and the pair's gap and gap rate there
    ("last_time", REAL),
    ("last_gap", REAL),
    ("last_rate", REAL),
    ("before_known", INT),  # and of the one before
    ("before_time", REAL),
    ("before_gap", REAL),
    ("before_rate", REAL),
)

PART: Final = (
    record_type(  # of a cell, one side: before + change u^3 (10 - 15 u + 6 u^2), u = (place - origin) scale
        ("origin", REAL),
        ("scale", REAL),
        ("before", REAL),
        ("change", REAL),
    )
)

CELL: Final = (
    record_type(  # where fractions change with tooth and place: those of a pair between middles of places
        ("number", REAL),  # of the pair, counted without end,
        ("low", REAL),  # and the way along the path of contact in pitches; none at first
        ("high", REAL),
        ("side", PART, (2,)),  # of the pinion and of the gear
    )
)

CONTACT: Final = record_type(  # of a population: the candidates of a pair
    ("known", INT),  # whether they have been chosen for the pair of the history,
    ("gap", REAL),  # down to which gap, and between which places,
    ("low", REAL),
    ("high", REAL),
    ("count", INT),  # how many there are, and how many of them are joined
    ("joined", INT),
    ("flips", INT),  # how many have joined or let go at the present root
    ("started", INT),  # whether the pair was there when the step began, and then whether it was on the path,
    ("start_moves", INT),
    ("start_gap", REAL),  # its gap and place, with their rates
    ("start_rate", REAL),
    ("start_place", REAL),
    ("start_place_rate", REAL),
)

WORK: Final = record_type(
    ("quadrature", QUADRATURE),
    ("resistance", RESISTANCE),
    ("track", TRACK),
    ("lag_time", REAL),  # time to which the lags of joining are followed
    ("exposing", EXPOSING),
    ("notes", NOTES),
    ("cell", CELL, (2 * SLOTS_HIGH,)),
    (
        "shares",
        REAL,
        (2 * SLOTS_HIGH, MATERIALS),
    ),  # by tooth and place, of elastic contacts as last asked for
    ("settling", SETTLING, (2 * SLOTS_HIGH,)),
    ("contact", CONTACT, (2 * SLOTS_HIGH,)),
    ("least_guard", REAL),  # least guard of a population when last asked for, and where the step began
    ("least_before", REAL),
    ("unsettled", INT),  # 1 where no stable deflections have been found since it was set to 0
    ("adams", ADAMS),
    ("search", SEARCH),
    ("driver", DRIVER),
    ("piece", INT, (SCHEDULES,)),  # of a cubic schedule, last used; where the next search begins
    ("torque_law", INT, (2,)),  # where the compiled torque law of either shaft lies; 0 without one
)
