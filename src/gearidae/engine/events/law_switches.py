"""Switches of laws: guards of the laws that act on a shaft, and knots and zeros of registered torque laws."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.record import record
from gearidae.engine.model.state import DRIVE, MOTION, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.mesh_error import pinion_speed
from gearidae.engine.pairs.shaft_angle import torque_angle
from gearidae.laws.shaft.own import SHIFT, jumps_with_speed, law_jump, law_value, on_its_side, switch_value
from gearidae.laws.shafts import guard, switch
from gearidae.records import Flank

_NO_FLANK: Final = float(Flank.NONE)

IMPULSE_MISSED: Final = 0.5
"""Of the tolerance of a speed: impulse over the mass that a step may miss of a law that jumps in it."""
NOTED: Final = 0.01
"""Of that, from which a jump is counted: the error test may keep the steps of a law that chatters below it."""
JUMPS_HIGH: Final = 300
"""Jumps of laws in close succession, beyond which they chatter."""
APART: Final = 12
"""Steps without a jump after which the next is no succession; a start takes as many to reach its step length."""
HOVERS: Final = 10.0
"""Tolerances of a speed about that of the last jump, within which the next is a succession after any number of steps.

A small force drives the shaft back over a jump of a large one: steps grow on the way back and shrink before the jump,
some 40 from one to the next. A vibration that passes a jump goes farther, or is beyond what the tolerance resolves."""
_STEP_SHARES: Final = (0.0, *sorted(k * 0.5 * (math.sqrt(5.0) - 1.0) % 1.0 for k in range(1, 13)), 1.0)
"""Shares of a step at which the function of a law's switch is evaluated: multiples of the golden section, so that no
wave has the same phase at all of them."""
_SECTIONS: Final = 8
"""Steps of a golden-section search: they narrow a dip between three of these times to a fiftieth."""
_GOLDEN: Final = 0.5 * (3.0 - math.sqrt(5.0))


@compiled
def set_law_window(m: Model) -> None:
    """Set the times between which the present piece of the laws holds: from the last knot to the next stop."""
    next_knot, last, coming = m.state.next_knot, m.scene.start, m.scene.end
    if next_knot > 0:
        last = m.tables[m.scene.knots_at + next_knot - 1]
    if next_knot < m.scene.knot_count:
        coming = m.tables[m.scene.knots_at + next_knot]
    m.work.law_from, m.work.law_until = last * (1.0 + SHIFT), coming * (1.0 - SHIFT)


@compiled
def _speed(m: Model, shaft: int, y: Floats) -> float:
    """Surface velocity of a shaft."""
    return float(pinion_speed(m, y)[0]) if shaft == DRIVE else float(y[W])


@compiled_once(SOLVER)
def shaft_guard(m: Model, y: Floats) -> float:
    """Least distance of all laws that act on the shafts to their next switch."""
    least = math.inf
    for shaft in range(2):
        if m.scene.torque[shaft].acts != 0:
            least = guard(m, shaft, torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y), least)
    return least


@compiled
def set_shaft_sides(m: Model, y: Floats) -> None:
    """Switch all laws that act on the shafts to a state at which a run begins: one that goes on may have other keys."""
    for shaft in range(2):
        angle, speed = torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y)
        while m.scene.torque[shaft].acts != 0 and switch(m, shaft, angle, speed, -1) >= 0:
            pass


@compiled
def switch_shafts(m: Model, t: float, y: Floats, events: Floats, count: int) -> tuple[int, bool]:
    """Switch all laws that act on the shafts whose guards have fallen; the new number of events, and whether any has.

    Events are written as `gearidae.engine.events.record.record` does.
    """
    switched = False
    for shaft in range(2):
        angle, speed = torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y)
        kind = switch(m, shaft, angle, speed, -1) if m.scene.torque[shaft].acts != 0 else -1
        while kind >= 0:
            count, switched = record(m, events, count, t, float(kind), 0, _NO_FLANK, 0.0), True
            kind = switch(m, shaft, angle, speed, -1)
    return count, switched


@compiled
def _value(m: Model, shaft: int, t: float, y: Floats) -> float:
    return switch_value(m, shaft, t, torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y))


@compiled_once(SOLVER)
def law_guard(m: Model, t: float, y: Floats) -> float:
    """Least of the functions whose zeros are where laws switch, each with the sign that makes it positive now."""
    least = math.inf
    for shaft in range(2):
        if m.work.torque_switch[shaft] != 0 and m.work.law_side[shaft] != 0.0:
            least = min(least, m.work.law_side[shaft] * _value(m, shaft, t, y))
    return least


@compiled_once(SOLVER)
def set_law_sides(m: Model, t: float, y: Floats) -> bool:
    """Note on which side of their zeros these functions are; whether one has changed its side since."""
    changed = False
    for shaft in range(2):
        if m.work.torque_switch[shaft] != 0:
            side = math.copysign(1.0, _value(m, shaft, t, y))
            changed |= m.work.law_side[shaft] == -side
            m.work.law_side[shaft] = side
    return changed


@compiled
def note_law_jump(m: Model, t: float, y: Floats, always: bool) -> None:
    """Count a jump of a law: a zero of its own function, or one within a step that is tried from this state.

    Laws of the time or the angle may jump many times while the speed stays, and count only if their jump may be beyond
    the tolerance (`always`). A law that jumps as a function of the speed alone, within `HOVERS` of the shaft's speed,
    counts however short the step is.
    """
    speeds = math.nan, math.nan
    for shaft in range(2):
        angle, speed = torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y)
        about = HOVERS / _weight(m, shaft)
        if m.work.torque_law[shaft] != 0 and jumps_with_speed(
            m, shaft, t, angle, (speed - about, speed + about)
        ):
            speeds = (speed, speeds[1]) if shaft == 0 else (speeds[0], speed)
    if always or speeds[0] == speeds[0] or speeds[1] == speeds[1]:
        m.work.law_jumps += 1
        m.work.law_steps = 0
        m.work.law_speed[0], m.work.law_speed[1] = speeds


@compiled
def note_law_iterates(m: Model, t: float, last: Floats, y: Floats) -> None:
    """Count a jump of a law between the last iterate whose forces are known and what follows from them.

    Of a law that chatters a short step may begin and end on one side of the jump, and be driven back there by forces
    of the other side: what they change is below the tolerance, so that the iteration stops there. In a longer one the
    iterates go to and fro.
    """
    jumps = m.scene.law_switches != 0 and (law_guard(m, t, last) < 0.0) != (law_guard(m, t, y) < 0.0)
    for shaft in range(2):
        if m.scene.torque[shaft].law_unknown != 0:
            before = torque_angle(m, shaft, last[U], last[PHASE]), _speed(m, shaft, last)
            after = torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y)
            jumps |= law_jump(m, shaft, t, 0.0, before, after) > 0.0
    if jumps:
        note_law_jump(m, t, y, False)


@compiled(inline=True)
def _weight(m: Model, shaft: int) -> float:
    """One over the tolerance of a shaft's speed."""
    return float(m.rows[m.scene.error_weights_at + (V if shaft == DRIVE else W)])


@compiled(inline=True)
def laws_chatter(m: Model, y: Floats) -> bool:
    """Count an accepted step; whether laws have jumped too often without a while between."""
    m.work.law_steps += 1
    if m.work.law_steps > APART and not _hovers(m, y):
        m.work.law_jumps = 0
    return bool(m.work.law_jumps > JUMPS_HIGH)


@compiled
def _hovers(m: Model, y: Floats) -> bool:
    """Whether a shaft has still the speed at which its law has last jumped."""
    first, second = m.work.law_speed[0], m.work.law_speed[1]
    near = HOVERS / _weight(m, 0), HOVERS / _weight(m, 1)
    return bool(abs(_speed(m, 0, y) - first) < near[0] or abs(_speed(m, 1, y) - second) < near[1])


@compiled
def _distance(
    m: Model,
    shaft: int,
    t: float,
    h: float,
    share: float,
    first: tuple[float, float],
    last: tuple[float, float],
) -> float:
    """How far the function of a law's switch is from zero on its side, at a share of a step."""
    angle, speed = first[0] + share * (last[0] - first[0]), first[1] + share * (last[1] - first[1])
    return float(m.work.law_side[shaft] * switch_value(m, shaft, t + share * h, angle, speed))


@compiled
def _returns(
    m: Model, shaft: int, t: float, h: float, first: tuple[float, float], last: tuple[float, float]
) -> bool:
    """Whether the function of a law's switch has another sign within a step than at both ends.

    About a time at which the function is nearer to zero than at both neighbours, a golden-section search follows it
    down.
    """
    if m.work.law_side[shaft] == 0.0:
        return False
    before = _distance(m, shaft, t, h, _STEP_SHARES[0], first, last)
    here = _distance(m, shaft, t, h, _STEP_SHARES[1], first, last)
    for i in range(1, len(_STEP_SHARES) - 1):
        if here < 0.0:
            return True
        there = _distance(m, shaft, t, h, _STEP_SHARES[i + 1], first, last)
        shares = _STEP_SHARES[i - 1], _STEP_SHARES[i], _STEP_SHARES[i + 1]
        if here < before and here <= there and _dips(m, shaft, t, h, shares, here, first, last):
            return True
        before, here = here, there
    return False


@compiled
def _dips(
    m: Model,
    shaft: int,
    t: float,
    h: float,
    shares: tuple[float, float, float],
    least: float,
    first: tuple[float, float],
    last: tuple[float, float],
) -> bool:
    """Whether the function is beyond zero about the middle one of three times, where its distance is the least."""
    low, middle, high = shares
    for _ in range(_SECTIONS):
        further = high - middle > middle - low
        end = high if further else low
        share = middle + _GOLDEN * (end - middle)
        value = _distance(m, shaft, t, h, share, first, last)
        if value < 0.0:
            return True
        if value < least:
            low, high = (middle, high) if further else (low, middle)
            middle, least = share, value
        elif further:
            high = share
        else:
            low = share
    return False


@compiled
def note_iterate_of_laws(m: Model, t: float, y: Floats) -> bool:
    """Look at an iterate where IDA iterates by itself; whether it passes over a law's jump, so that the attempt fails.

    An iterate of an accepted step is no jump more; an attempt that fails is one, of a law that chatters.
    """
    if misses_laws(m, t, y, False):
        note_law_jump(m, m.work.adams.time, m.work.adams.state, False)
        return True
    if m.scene.law_switches != 0 and law_guard(m, t, y) < 0.0:
        m.work.law_beyond = 1
    return False


@compiled
def note_step_of_laws(m: Model, t: float, y: Floats) -> None:
    """Note where the next step begins, where IDA iterates by itself.

    A jump that this step has kept small is counted, and one between its iterates, as by `note_law_iterates`.
    """
    a = m.work.adams
    if t > a.time:
        misses_laws(m, t, y, True)
    if m.work.law_beyond != 0 and law_guard(m, t, y) >= 0.0:
        note_law_jump(m, t, y, False)
    m.work.law_beyond = 0
    a.time = t
    for j in range(MOTION):
        a.state[j] = y[j]


@compiled_once(SOLVER)
def misses_laws(m: Model, t: float, y: Floats, counts: bool) -> bool:
    """Whether a step that is tried passes over a law's jump on its way to a time and a state; `counts` its jumps, too.

    Of a law that says nothing of its jumps, the impulse that may be missed must be beyond the tolerance. Of one that
    has a function with zeros there, two zeros within the step count. A single one is found as a root; until there the
    polynomial of the step has a part of the jump behind it, which must not be beyond the tolerance either: the error
    test sees no more than a tenth of that, for it looks at the highest difference alone.
    """
    a = m.work.adams
    h = t - a.time
    for shaft in range(2):
        switches = m.work.torque_switch[shaft] != 0
        if m.scene.torque[shaft].law_unknown == 0 and not switches:
            continue
        mass = m.scene.pinion_inverse_mass if shaft == DRIVE else m.scene.gear_inverse_mass
        mass *= _weight(m, shaft)
        first = torque_angle(m, shaft, a.state[U], a.state[PHASE]), _speed(m, shaft, a.state)
        last = torque_angle(m, shaft, y[U], y[PHASE]), _speed(m, shaft, y)
        if not switches:
            missed = h * law_jump(m, shaft, a.time, h, first, last) * mass
            if counts and missed > 0.0:
                note_law_jump(m, a.time, a.state, missed > NOTED * IMPULSE_MISSED)
            if missed > IMPULSE_MISSED:
                return True
        elif on_its_side(m, shaft, t, last[0], last[1]):
            if _returns(m, shaft, a.time, h, first, last):
                return True
        else:
            jump = law_value(m, shaft, t, last[0], last[1]) - law_value(m, shaft, a.time, first[0], first[1])
            if h * abs(jump) * mass > IMPULSE_MISSED:
                if counts:  # of a law that chatters, each second attempt fails here
                    note_law_jump(m, a.time, a.state, False)
                return True
    return False
