"""``STATE``: all that a checkpoint carries, besides the state vector and the nodes of an elastic contact.

What compiled code uses as an index, a count or a flag is a whole number with bounds: a checkpoint comes from a file.
"""

from __future__ import annotations

from typing import Final

from gearidae.engine.model.record_types import (
    AT_REST,
    EMPTY,
    FREE,
    MATERIALS,
    SCHEDULES,
    SLOTS_HIGH,
    STUCK,
    record_type,
)
from gearidae.laws.joints import JOINTS
from gearidae.laws.shafts import SHAFT_LAWS
from gearidae.records import COUNTERS, RUN_PARTS
from gearidae.records.energy import ENERGY_SUMS
from gearidae.records.extremes import ASPERITY_COUNTS, FORCE_EXTREMES, SPEED_EXTREMES
from gearidae.records.impacts import KEPT
from gearidae.records.passages import SINCE_LAST
from gearidae.records.quantity import (
    COUNT_HIGH,
    ENERGY,
    LENGTH,
    PITCHES,
    POWER,
    POWER_RATE,
    SECONDS,
    SPEED,
    TIME,
    TORQUE,
    Quantity,
    Unit,
    count,
    flag,
)

_HEIGHT_HIGH: Final = 1e6
"""Roughnesses: a step may have gone far below the tables before that was noticed."""

HISTORY_FIELDS: Final = (
    count(
        "pair", "number of the pair, counted without the turns taken out of the phase, or EMPTY", low=EMPTY
    ),
    Quantity("direction", "sign of the gap rate; 0 at the very start"),
    Quantity("gap", "at the last accepted time", LENGTH),
    Quantity("gap_rate", "at the last accepted time", SPEED),
    flag("in_contact", "1 between onset and separation"),
    Quantity(
        "joined",
        "height above which asperities joined by the last turn",
        LENGTH,
        shape=(MATERIALS,),
        high=_HEIGHT_HIGH,
    ),
    flag("at_pull_off", "1 once full stretch has been reached on the way apart", shape=(MATERIALS,)),
    Quantity(
        "adhered_energy",
        "adhesion loss above `joined`, rigid bodies",
        Unit("`force_scale` sigma"),
        shape=(MATERIALS,),
    ),
    Quantity("adhesion_lag", "what joining has taken less than at the present contact length", ENERGY),
    Quantity("adhesion_lag_power", "rate of `adhesion_lag` at the last accepted time", POWER),
    Quantity("adhesion_lag_power_rate", "rate of `adhesion_lag_power` there", POWER_RATE),
    flag("stretched", "1 if asperities of it were stretched at the last turning point"),
    count(
        "slide",
        "direction of sliding, -1 or 1; `STUCK`, or 0 while nothing rubs: see `record_types`",
        low=-1,
        high=STUCK,
    ),
    Quantity(
        "impact",
        "what its contact has done so far",
        kind=(count("begun", "2 from an onset, 1 from where a run has met the contact", high=2), *KEPT),
    ),
)

PROGRESS_FIELDS: Final = (
    count("next_sample", "index of the coming sample", high=lambda scene: scene.samples),
    *COUNTERS,
)

STOPS: Final = ("time", "sticks", "turns")
"""What ends a run, by number."""

_PART_FIELDS: Final = (  # from where the part begins to where the run stands
    flag("begun", "1 once it has begun"),
    Quantity("lowest", "lowest speed of the gear", SPEED),
    Quantity("highest", "highest speed of the gear", SPEED),
    Quantity("time", "when it began", TIME),
    Quantity("position", "how far the gear had turned by then", PITCHES),
    Quantity(
        "whole_time", "end of its last whole period of the slowest harmonic; its beginning before", TIME
    ),
    Quantity("whole_position", "how far the gear had turned by then", PITCHES),
)

WINDOWS: Final = 80
"""Windows of equal length, of which start-up, half and last twentieth of a run have whole numbers. A longer chain makes
two of them one, so that its parts begin within an eightieth of it where they should."""

_WINDOW_FIELDS: Final = (
    Quantity("lowest", "lowest speed of the gear in it", SPEED),
    Quantity("highest", "highest speed of the gear in it", SPEED),
    Quantity("fall", "how far its speed fell in it", SPEED),
    Quantity("rise", "how far its speed rose in it", SPEED),
    Quantity("position", "how far the gear had turned where it began", PITCHES),
)

EXTREMES_FIELDS: Final = (  # at accepted times and located extrema
    flag("begun", "1 once the run has begun"),
    *SPEED_EXTREMES,
    Quantity("top", "highest speed since start-up", SPEED),
    Quantity("bottom", "lowest speed since start-up", SPEED),
    Quantity("part", "parts of the chain", kind=_PART_FIELDS, shape=(len(RUN_PARTS),)),
    Quantity("window", "of the chain so far", kind=_WINDOW_FIELDS, shape=(WINDOWS,)),
    Quantity("window_length", "of each", TIME),
    count("windows", "that have begun", high=WINDOWS),
    flag("is_stuck", "1 while the gear has not turned on by half a pitch since a reversal"),
    Quantity("stuck_time", "time of the first such reversal", TIME),
    Quantity("stuck_position", "how far the gear had turned by then", PITCHES),
    count("stuck_exits", "mesh exits until then"),
    count("turn_backs", "how often the drive flank's adhesion has turned the gear back there"),
    Quantity("turn_back_time", "when it last did", TIME),
    Quantity("adhering", "all times from one such to the next at the same position", TIME),
    *FORCE_EXTREMES,
)

_PASSAGE_FIELDS = (
    flag("begun", "1 once a force has been noted"),
    *SINCE_LAST,
)

MOST_ZEROS: Final = 12
"""Zeros of the gear's speed that are kept as beginnings of a standstill."""
HIGH: Final = MOST_ZEROS
"""Index among the zeros: of the zero farthest forward."""
MOST_SLOW: Final = 32
MOST_STANDSTILLS: Final = 64

# units of standing stay with a change of torques
_ZERO_FIELDS: Final = (
    Quantity("time", "of a zero of the gear's speed; free gears start there at rest", SECONDS),
    Quantity("position", "how far the gear had turned by then", PITCHES),
    Quantity("pinion_lead", "of the pinion's base circle over the gear's, from the start of a chain", LENGTH),
    count("exits", "mesh exits until then"),
    Quantity("lowest", "position of the gear since then, at zeros of its speed", PITCHES),
    Quantity("highest", "position of the gear since then, at zeros of its speed", PITCHES),
    flag("start", "1 for a start at rest"),
    flag("driven", "1 if the drive has exceeded the dry load of a gear at rest there since then"),
    Quantity("rest_time", "time at rest until then", SECONDS),
    Quantity("mark", "distance of the gear where that last grew, by a share", PITCHES),
    Quantity("grown", "when it did", SECONDS),
    # of free gears under torques that have ended, which a chain has carried over; at the zero itself without
    Quantity("free_time", "up to which free gears have been followed", SECONDS),
    Quantity("free_travel", "of free gears then", PITCHES),
    Quantity("free_speed", "of free gears then", Unit("pb/s")),
    Quantity("free_farthest", "largest size of `free_travel`", PITCHES),
    Quantity("free_before", "that where the gear broke away before", PITCHES),
    Quantity("free_mark", "`free_farthest` where that last grew, by a share", PITCHES),
    Quantity("free_grown", "when it did", SECONDS),
    Quantity("onset", "when free gears have begun to move; 0 before", SECONDS),
    Quantity("excess", "largest torque of the drive at the gear beyond the dry load", TORQUE),
    Quantity("driven_time", "for which there was any", SECONDS),
)

_SLOW_FIELDS: Final = (
    Quantity("time", "of an accepted time after which the gear has been faster", SECONDS),
    Quantity("speed", "of the gear then", Unit("pb/s")),
    Quantity("position", "of the gear then", PITCHES),
)

_STANDSTILL_FIELDS: Final = (
    Quantity("begin", "of a standstill that has ended", SECONDS),
    Quantity("end", "of the standstill", SECONDS),
    Quantity("advance", "of the gear", PITCHES),
    Quantity("free_advance", "of free gears", PITCHES),
    Quantity("excess", "as of a zero", TORQUE),
    Quantity("driven_time", "as of a zero", SECONDS),
    Quantity("rest_time", "at rest", SECONDS),
    Quantity("since", "zero that it began with", SECONDS),
    Quantity("breakaway", "drive torque at its end", TORQUE),
    count("settled", "as in `STANDING_NOW`", high=2),
)

_STANDING_FIELDS: Final = (
    count(
        "zero_count", "zeros in use, from which on the gear has stayed within half a pitch", high=MOST_ZEROS
    ),
    Quantity("zero", "in the order of time, then `HIGH`", kind=_ZERO_FIELDS, shape=(MOST_ZEROS + 1,)),
    flag("undriven", "1 if one of those in use is not `driven`"),
    count("slow_count", "entries in use", high=MOST_SLOW),
    Quantity(
        "slow", "in the order of time, each faster than the one before", kind=_SLOW_FIELDS, shape=(MOST_SLOW,)
    ),
    count("direction", "of the last movement of more than half a pitch; 0 before the first", low=-1, high=1),
    Quantity("turn_time", "when that became so", SECONDS),
    flag("high_known", "1 if `HIGH` is the zero farthest forward since the gear last went forward"),
    Quantity("low", "position farthest back since it last went back", PITCHES),
    flag("left", "1 once the gear has left half a pitch from the start of a chain"),
    Quantity("rest_time", "for which dry friction has held the gear", SECONDS),
    Quantity("distances_time", "when `mark` of the zeros is looked at next", SECONDS),
    count("way", "sign of the speed at the last accepted time", low=-1, high=1),
    count("held", "what friction held then", low=FREE, high=AT_REST),
    Quantity("zero_position", "of the gear at its last zero", PITCHES),
    Quantity("zero_time", "when that was", SECONDS),
    flag("near", "1 as long as the gear is near that position"),
    Quantity("near_time", "until when it was", SECONDS),
    Quantity("near_position", "where it was then", PITCHES),
    Quantity("slip_time", "when dry friction last let go", SECONDS),
    Quantity("slip_position", "where the gear was then", PITCHES),
    flag(
        "slip_from_rest",
        "1 if dry friction held the gear at rest until then, or until a slip near that place",
    ),
    Quantity("leave_time", "when the gear last left half a pitch from the first zero", SECONDS),
    Quantity("leave_position", "where it was then", PITCHES),
)

_STOOD_FIELDS: Final = (
    count("stand_count", "standstills that are kept", high=MOST_STANDSTILLS),
    Quantity(
        "standstill",
        "in the order of time; of more the longest are kept",
        kind=_STANDSTILL_FIELDS,
        shape=(MOST_STANDSTILLS,),
    ),
    count("standstills", "that have ended"),
    Quantity("standing_time", "of all of these", SECONDS),
    Quantity("standing_rest", "at rest in all of these", SECONDS),
    Quantity("last_end", "end of the last of them", SECONDS),
    Quantity("breakaway", "drive torque then, or at the start", TORQUE),
    Quantity("start_torque", "drive torque at the start", TORQUE),
)

_AGEING_FIELDS: Final = (
    Quantity("time", "when ages, ways and speeds have last been noted", TIME),
    Quantity("age", "of the contacts of the joints", TIME, shape=(len(JOINTS),)),
    Quantity("way", "of the base circles of pinion and gear then", LENGTH, shape=(2,)),
    Quantity("speed", "of the base circles then", SPEED, shape=(2,)),
)

STATE_FIELDS: Final = (
    Quantity("time", "last accepted time", TIME),
    Quantity("whole_pitches", "whole pitches taken out of the phase", PITCHES, high=COUNT_HIGH),
    Quantity(
        "first_position",
        "position of the gear where a chain of runs began, where shafts' angles are 0",
        PITCHES,
    ),
    Quantity("initial_pinion_lead", "u + e there: lead of the pinion's base circle over the gear's", LENGTH),
    Quantity(
        "mesh_mark_below",
        "phase of the nearest mesh entry or exit below the present one",
        PITCHES,
        high=COUNT_HIGH,
    ),
    Quantity("mesh_mark_above", "phase of the nearest one above", PITCHES, high=COUNT_HIGH),
    Quantity("slip", "direction of the gear's slip against dry resistance, -1 or +1; 0 while it is stuck"),
    flag("flank_in_reach", "1 for a flank close enough for any pair to touch", shape=(2,)),
    count("last_flank", "flank of the last onset, -1 before the first", low=-1, high=1),
    flag("bound_exceeded", "1 once a pair has been below the lowest gap"),
    count(
        "deep_exits", "mesh exits when elastic contacts were last too deep for rigid ones, -1 before", low=-1
    ),
    flag("rigid_again", "1 once that has been long ago"),
    Quantity("last_root", "time of the last root", TIME),
    count("roots", "how many have come in close succession", high=lambda scene: scene.root_limit),
    count("next_knot", "index of the coming knot among all knots", high=lambda scene: scene.knot_count),
    count(
        "segment", "the schedules' current segments: set at knots, never inside a step", shape=(SCHEDULES,)
    ),
    Quantity("energy", "energy balance", kind=ENERGY_SUMS),
    Quantity(
        "shaft",
        "what laws of a shaft remember",
        kind=tuple(
            count(memory.name, memory.meaning, low=memory.low, high=memory.high)
            for law in SHAFT_LAWS
            for memory in law.memory
        ),
        shape=(2,),
    ),
    Quantity("progress", "counters of the driver", kind=PROGRESS_FIELDS),
    Quantity("extremes", "extremes of the run", kind=EXTREMES_FIELDS),
    Quantity(
        "passage", "what has been since the last mesh exit of each flank", kind=_PASSAGE_FIELDS, shape=(2,)
    ),
    Quantity("standing", "what says where the gear stands", kind=_STANDING_FIELDS),
    Quantity("stood", "standstills that have ended", kind=_STOOD_FIELDS),
    Quantity("history", "histories of the tooth pairs", kind=HISTORY_FIELDS, shape=(2 * SLOTS_HIGH,)),
    *ASPERITY_COUNTS,
    count("cycle_events", "both since the last mesh mark"),
    count("hold", "what friction holds at rest: see `record_types`", low=FREE, high=AT_REST),
    count(
        "held_pair", "history of the pair that rolls, if that is held", high=lambda scene: scene.histories - 1
    ),
    Quantity("pinion_slip", "direction in which the pinion turns in its hub, -1 or +1; 0 while it is held"),
    count("reversals", "changes of sliding of the flanks since the last mesh mark, or in a share of the run"),
    Quantity("counted_from", "when they have last been counted from zero", TIME),
    Quantity(
        "load_sign",
        "+1 where the vector sum of the mesh forces points forward, -1 behind its passage of zero",
    ),
    Quantity("ageing", "of friction of the joints, where it ages", kind=_AGEING_FIELDS),
)

HISTORY: Final = record_type(*HISTORY_FIELDS)
EXTREMES: Final = record_type(*EXTREMES_FIELDS)
STANDING: Final = record_type(*_STANDING_FIELDS)
STATE: Final = record_type(*STATE_FIELDS)
