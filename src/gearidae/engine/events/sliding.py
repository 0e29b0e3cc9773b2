"""Events of dry friction: a flank begins to rub or ends, sliding turns round, sticks and slips, gears come to rest.

Friction of flanks, hubs and the set-valued laws of the shafts are elements, whose directions of slip are part
of the state. Each element that slips has its speed for a guard, and what is held the distance of its friction from the
limit. A guard that has fallen is dealt with by one decision: alone, an element is held if its friction needs to be no
larger than its limit; where both gears stand still, all elements are decided on at once
(`gearidae.engine.friction.rest`).
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.events.record import note_directions, record_changes
from gearidae.engine.friction.ageing import begin_ageing
from gearidae.engine.friction.forces import NO_FORCE, Shafts, has_element, solve_shafts
from gearidae.engine.friction.hubs import has_hubs
from gearidae.engine.friction.pairs import RUBS, lever_rate, levers
from gearidae.engine.friction.rest import list_elements, rest_margin, way_from_rest
from gearidae.engine.model.record_types import (
    AT_REST,
    FREE,
    HELD_GEAR,
    HELD_PAIR,
    HELD_PINION,
    STUCK,
)
from gearidae.engine.model.state import DRIVE, LOAD, Floats, Model, Record, V, W
from gearidae.engine.motion.shafts import forces_at_shafts
from gearidae.engine.pairs.mesh_error import pinion_speed, rate_of
from gearidae.engine.pairs.orbit import follow_orbit

STILL: Final = 1e-10
"""Speed over sigma/tau by which sliding reverses before that counts, so that an element just let go waits for it."""
AT_ONCE: Final = 1e-7
"""Speed of both gears over sigma/tau below which an element that comes to rest brings both to rest, if they stay."""
ACROSS: Final = 1e-3
"""Sine of the angle between the levers of two elements, above which both gears stand where both elements rest."""
A_WHILE: Final = 1e3
"""Time over tau, long beside a vibration, for which friction must hold gears that creep, so that they come to rest."""
REVERSALS_HIGH: Final = 100_000
"""Changes of sliding from one mesh mark to the next, beyond which they are too many to follow."""
PASSES_HIGH: Final = 20
"""Decisions at one time, each of which lets a guard fall again, beyond which no choice is consistent."""


@compiled(inline=True)
def _sliding_speed(m: Model, noted: Record, surface_speed: float, w: float) -> float:
    first, second = levers(m, noted.position)
    return first * surface_speed - second * w


@compiled(inline=True)
def _is_known(m: Model, noted: Record) -> bool:
    return bool(m.state.history[noted.history].pair == noted.pair)


@compiled(inline=True)
def friction_guard(m: Model, t: float, y: Floats) -> float:
    """Least guard of all friction; that of a gear which slips by laws of its shaft alone needs no force."""
    if m.scene.friction.any_friction == 0 and m.state.hold == FREE:
        return m.state.slip * y[W] + STILL
    return sliding_guard(m, t, y)


@compiled_once(FRICTION)
def sliding_guard(m: Model, t: float, y: Floats) -> float:
    """Least guard of all that has friction."""
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    least, state, w = math.inf, m.state, y[W]
    for i in range(m.work.pair_forces.count if m.scene.friction.flanks != 0 else 0):
        noted = m.work.pair_forces.pair[i]
        if not _is_known(m, noted):
            continue
        slide, limit = state.history[noted.history].slide, noted.limit
        if slide == 0:  # a pair far away is no measure of how near the crossing is
            least = min(least, 1.0 if abs(limit) <= RUBS else RUBS - limit)
            continue
        least = min(least, limit - 0.5 * RUBS)
        if slide != STUCK:
            least = min(least, slide * _sliding_speed(m, noted, surface_speed, w) + STILL)
    if state.hold == AT_REST:
        list_elements(m, t, y)
        return min(least, rest_margin(m, pinion, gear) + 2.0 * NO_FORCE)
    if state.hold != FREE or has_hubs(m):
        shafts = solve_shafts(m, t, y, surface_speed, pinion, gear)
        least = min(least, shafts.margin + 2.0 * NO_FORCE, shafts.corner)
    if has_element(m, LOAD) and state.slip != 0.0:
        least = min(least, state.slip * w + STILL)
    if has_element(m, DRIVE) and state.pinion_slip != 0.0:
        least = min(least, state.pinion_slip * surface_speed + STILL)
    return least


@compiled_once(FRICTION)
def rest_reserve(m: Model, t: float, y: Floats) -> float:
    """How far a train that stands still in a state is from being let go at a time; below zero once nothing holds it."""
    _, pinion, gear = forces_at_shafts(m, t, y)
    list_elements(m, t, y)
    return rest_margin(m, pinion, gear)


@compiled_once(FRICTION)
def begin_sliding(m: Model, t: float, y: Floats) -> None:
    """Set all directions of slip from the speeds of a start, and decide on what stands still there."""
    state = m.state
    state.hold, state.held_pair, state.reversals, state.load_sign = FREE, 0, 0, 1.0
    for k in range(m.scene.histories):
        state.history[k].slide = 0
    state.pinion_slip, state.slip = _sign(pinion_speed(m, y)[0]), _sign(y[W])
    settle_start(m, t, y, True)


@compiled_once(FRICTION)
def settle_start(m: Model, t: float, y: Floats, fresh: bool) -> None:
    """Deal with all guards of friction that have fallen at a start, of which no events are recorded."""
    if m.scene.friction.ages != 0:
        begin_ageing(m, t, y)
    for _ in range(PASSES_HIGH):
        if not settle_sliding(m, t, y, fresh):
            return
        fresh = False
    m.state.reversals = REVERSALS_HIGH + 1


@compiled
def follow_sliding(m: Model, t: float, y: Floats, events: Floats, count: int) -> tuple[int, bool]:
    """Deal with all guards of friction that have fallen, and with those that fall by that; see `settle_sliding`.

    A guard below zero at a start would never be found. Where they go on to fall, the run ends: see
    `gearidae.engine.events.events.chatters`.

    Returns
    -------
    count : int
        New number of events.
    restart : bool
        Whether the integration must begin anew.
    """
    passes = 0
    note_directions(m)
    while passes <= PASSES_HIGH and settle_sliding(m, t, y, False):
        passes += 1
    if passes > PASSES_HIGH:
        m.state.reversals = REVERSALS_HIGH + 1
    return record_changes(m, t, events, count), passes > 0


@compiled_once(FRICTION)
def settle_sliding(m: Model, t: float, y: Floats, fresh: bool) -> bool:
    """Deal with all guards of friction that have fallen, once.

    Parameters
    ----------
    t : float
        Time over tau; `accept` has been there.
    y : ndarray, shape (n,)
        State; speeds of what comes to rest are set to that.
    fresh : bool
        Whether directions of slip have just been guessed from speeds, so that all that stands still is decided on.

    Returns
    -------
    bool
        Whether forces have jumped, so that the integration must begin anew.
    """
    state, w = m.state, y[W]
    if m.scene.friction.any_friction == 0 and state.hold == FREE and not _has_fallen(state.slip, w, fresh):
        return False
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    jumped = _drop_unloaded(m)
    kind, history = FREE, 0
    for i in range(m.work.pair_forces.count if m.scene.friction.flanks != 0 else 0):
        noted = m.work.pair_forces.pair[i]
        h = state.history[noted.history]
        if not _is_known(m, noted):
            continue
        speed = _sliding_speed(m, noted, surface_speed, w)
        if h.slide == 0 and noted.limit > RUBS:
            h.slide = STUCK if state.hold == AT_REST else int(_sign(speed))
            jumped = True  # the rest of the step has been made without it
        if h.slide != 0 and h.slide != STUCK and _has_fallen(float(h.slide), speed, fresh):
            if kind == HELD_PAIR:  # it has the same levers, or both gears come to rest
                h.slide = -h.slide
            else:
                kind, history = HELD_PAIR, noted.history
    if has_element(m, LOAD) and state.slip != 0.0 and _has_fallen(state.slip, w, fresh):
        kind = HELD_GEAR
    rubs = has_element(m, DRIVE) and state.pinion_slip != 0.0
    if rubs and _has_fallen(state.pinion_slip, surface_speed, fresh):
        kind = HELD_PINION
    if state.hold == AT_REST:
        list_elements(m, t, y)
        if rest_margin(m, pinion, gear) < -1.5 * NO_FORCE:
            _decide_at_rest(m, t, y)
            return True
        return jumped
    if has_hubs(m) and solve_shafts(m, t, y, surface_speed, pinion, gear).corner <= 0.0:
        state.load_sign = -state.load_sign
        # Beside zero the load is smooth, as the step has seen it: a restart there would cost ten short steps, whose
        # errors do not cancel over a vibration (4.4 bounds of the balance; 0.1 without).
        jumped |= m.work.friction.continued != 0
        m.work.friction.continued = 0
    if kind == FREE and state.hold != FREE:
        if solve_shafts(m, t, y, surface_speed, pinion, gear).margin >= -1.5 * NO_FORCE:
            return jumped
        kind, history = state.hold, state.held_pair
    if kind == FREE:
        return jumped
    _decide(m, t, y, kind, history)
    return True


@compiled
def follow_creeping(m: Model, t: float, y: Floats, events: Floats, count: int) -> tuple[int, bool]:
    """Bring gears to rest that creep towards it; as `follow_sliding`."""
    note_directions(m)
    stopped = stop_creeping(m, t, y)
    return record_changes(m, t, events, count) if stopped else count, stopped


@compiled_once(FRICTION)
def stop_creeping(m: Model, t: float, y: Floats) -> bool:
    """Bring gears to rest that creep towards it, by less than a tolerance, and whom friction then holds.

    Without a vibration no sliding turns round, so that no guard falls. What a rising torque draws along creeps as
    slowly, and is held for a moment only.
    """
    slow = max(AT_ONCE, 1.0 / m.rows[m.scene.error_weights_at + V])
    fastest = max(abs(pinion_speed(m, y)[0]), abs(y[W]))
    stays = m.state.hold != AT_REST and fastest <= slow and _rests(m, t, y) and _rests(m, t + A_WHILE, y)
    follow_orbit(m, t)
    if not stays:
        return False
    _decide_at_rest(m, t, y)
    return True


@compiled(inline=True)
def _has_fallen(slip: float, speed: float, fresh: bool) -> bool:
    """Whether the guard of an element that slips has fallen."""
    return bool(slip * speed + STILL <= 0.0 or (fresh and abs(speed) <= STILL))


@compiled
def _drop_unloaded(m: Model) -> bool:
    """Forget the directions of pairs that rub no longer; whether there are any."""
    jumped = False
    for k in range(m.scene.histories):
        h, rubs = m.state.history[k], False
        for i in range(m.work.pair_forces.count if h.slide != 0 else 0):
            noted = m.work.pair_forces.pair[i]
            rubs |= noted.history == k and noted.pair == h.pair and noted.limit >= 0.5 * RUBS
        if h.slide != 0 and not rubs:
            h.slide, jumped = 0, True
    if m.state.hold == HELD_PAIR and m.state.history[m.state.held_pair].slide != STUCK:
        m.state.hold = FREE
        jumped = True
    return jumped


@compiled
def _decide(m: Model, t: float, y: Floats, kind: int, history: int) -> None:
    """Decide on an element that has come to rest, or is held no longer."""
    state, a1, a2 = m.state, m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass
    state.reversals += 1
    surface_speed, error = pinion_speed(m, y)
    first, second = _levers_of(m, kind, history)
    excess = (first * surface_speed + second * y[W]) / (a1 * first**2 + a2 * second**2)
    surface_speed -= a1 * first * excess
    w = y[W] - a2 * second * excess
    let_go = state.hold == kind and state.held_pair == history  # what moves has directions already
    if state.hold != FREE and not let_go and _holds_both(m, first, second):
        _decide_at_rest(m, t, y)
        return
    fastest = max(abs(surface_speed), abs(w))
    stops = not let_go and fastest <= AT_ONCE
    if stops and (fastest == 0.0 or state.hold != FREE or _rests(m, t, y)):
        _decide_at_rest(m, t, y)
        return
    y[W], y[V] = w, rate_of(error, surface_speed, w)
    if state.hold != FREE and not let_go:
        _set_slip(m, state.hold, state.held_pair, 1.0)  # it has the same levers
    state.hold, state.held_pair = kind, history
    _set_slip(m, kind, history, 0.0)
    _let_go(m, t, y)


@compiled
def _holds_both(m: Model, first: float, second: float) -> bool:
    """Whether both gears stand where an element with these levers is at rest, too: their speeds are then errors."""
    held_first, held_second = _levers_of(m, m.state.hold, m.state.held_pair)
    across = abs(first * held_second - second * held_first)
    return bool(across > ACROSS * math.hypot(first, second) * math.hypot(held_first, held_second))


@compiled
def _let_go(m: Model, t: float, y: Floats) -> None:
    """Let go of the element that is held, if that takes more friction than its limit."""
    state = m.state
    surface_speed, pinion, gear = forces_at_shafts(m, t, y)
    shafts = solve_shafts(m, t, y, surface_speed, pinion, gear)
    if shafts.margin < -NO_FORCE:
        kind, state.hold = state.hold, FREE
        slip = _sign(shafts.held)
        _set_slip(m, kind, state.held_pair, slip)
        if kind == HELD_PAIR and has_hubs(m):  # hubs that nearly lock may need less friction for more load
            shafts = solve_shafts(m, t, y, surface_speed, pinion, gear)
            if slip * _sliding_rate(m, state.held_pair, surface_speed, y[W], shafts) < 0.0:
                _set_slip(m, kind, state.held_pair, -slip)


@compiled
def _sliding_rate(m: Model, history: int, surface_speed: float, w: float, shafts: Shafts) -> float:
    """Rate of the sliding speed of a pair: by the accelerations, and as its levers change along the path."""
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        if noted.history == history:
            first, second = levers(m, noted.position)
            return first * shafts.pinion - second * shafts.gear + lever_rate(m, noted, surface_speed, w)
    return 0.0


@compiled
def _rests(m: Model, t: float, y: Floats) -> bool:
    """Whether gears that hardly move would be held where they are: bringing to rest what is not would not end."""
    v, w = y[V], y[W]
    y[V], y[W] = rate_of(pinion_speed(m, y)[1], 0.0, 0.0), 0.0
    _, pinion, gear = forces_at_shafts(m, t, y)
    list_elements(m, t, y)
    y[V], y[W] = v, w
    return bool(rest_margin(m, pinion, gear) >= -NO_FORCE)


@compiled
def _decide_at_rest(m: Model, t: float, y: Floats) -> None:
    """Decide on all elements at once, where both gears stand still."""
    state, work = m.state, m.work.friction
    state.reversals += 1
    y[V], y[W] = rate_of(pinion_speed(m, y)[1], 0.0, 0.0), 0.0
    _, pinion, gear = forces_at_shafts(m, t, y)
    list_elements(m, t, y)
    if rest_margin(m, pinion, gear) >= -NO_FORCE:
        state.hold = AT_REST
        for i in range(work.count):
            _set_slip(m, work.element[i].hold, work.element[i].history, 0.0)
    else:
        way = way_from_rest(m, pinion, gear)
        state.hold = FREE
        for i in range(work.count):
            element = work.element[i]
            slip = _sign(element.pinion * way.pinion + element.gear * way.gear)
            if i == way.element:
                state.hold, slip = element.hold, 0.0
                if element.hold == HELD_PAIR:
                    state.held_pair = element.history
            _set_slip(m, element.hold, element.history, slip)


@compiled
def _levers_of(m: Model, kind: int, history: int) -> tuple[float, float]:
    """Speed of an element per surface velocity of the pinion and of the gear."""
    if kind == HELD_GEAR:
        return 0.0, 1.0
    if kind == HELD_PINION:
        return 1.0, 0.0
    for i in range(m.work.pair_forces.count):
        if m.work.pair_forces.pair[i].history == history:
            first, second = levers(m, m.work.pair_forces.pair[i].position)
            return first, -second
    return 1.0, 0.0


@compiled
def _slip_of(m: Model, kind: int, history: int) -> float:
    """Direction in which an element slips, 0 while it is held."""
    if kind == HELD_GEAR:
        return m.state.slip
    if kind == HELD_PINION:
        return m.state.pinion_slip
    slide = m.state.history[history].slide
    return 0.0 if slide == STUCK else float(slide)


@compiled
def _set_slip(m: Model, kind: int, history: int, slip: float) -> None:
    """Set that direction."""
    if kind == HELD_GEAR:
        m.state.slip = slip
    elif kind == HELD_PINION:
        m.state.pinion_slip = slip
    else:
        m.state.history[history].slide = STUCK if slip == 0.0 else int(slip)


@compiled(inline=True)
def _sign(speed: float) -> float:
    return 1.0 if speed > 0.0 else -1.0
