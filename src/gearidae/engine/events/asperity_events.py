"""Events of a population: asperities join and detach, each at a root of its own.

A free asperity waits with the guard ``-(overlap + join)``, a joined one with ``overlap + detach``; the least of all is
watched. Once it has switched its guard is the width of its hysteresis, so that nothing chatters. The guard is looked at
where steps end. In between an asperity may dip below and come back: guards and their rates at both ends make a cubic
for each candidate that falls at first and rises in the end, and its minimum says whether to look there.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import POPULATION
from gearidae.engine.events.record import EVENTS_AT_ONCE, record, record_asperity, record_contact
from gearidae.engine.laws.discrete import candidate_energy
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.tooth_pairs import PairState, flank_of_history, list_known
from gearidae.engine.population.candidates import choose, covers, list_joined
from gearidae.engine.population.contact_point import overlap_slopes, pair_of, spot_at
from gearidae.engine.population.layout import (
    ARC,
    BOUND,
    HEIGHT,
    INDEX,
    K_DETACH,
    K_JOIN,
    KIND,
    REMEMBERED,
    SIGN,
    column,
    flank_of,
)
from gearidae.records import EventKind

_ONSET, _DETACHMENT = float(EventKind.ASPERITY_ONSET), float(EventKind.ASPERITY_DETACHMENT)
_PAIR_ONSET, _PAIR_SEPARATION = float(EventKind.ONSET), float(EventKind.SEPARATION)
_FLANK_CHANGE: Final = float(EventKind.FLANK_CHANGE)
SWITCHES_HIGH: Final = EVENTS_AT_ONCE // 2
"""Events of asperities at one time, which are too many to follow."""
CYCLE_HIGH: Final = 100_000
"""Events of asperities from one mesh mark to the next, beyond which they are too many to follow."""
NO_CANDIDATE: Final = 1.0
"""Guard over the roughness beyond which it does not matter how far it is."""


@compiled_once(POPULATION)
def asperity_guard(m: Model, y: Floats) -> float:
    """Least guard of all candidates of the pairs near, `NO_CANDIDATE` at most; chooses candidates where it must."""
    least = NO_CANDIDATE
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        now = pair_of(m, k, y)
        if not covers(m, k, now.gap, now.position):
            contact, gap, low, high = m.work.contact[k], now.gap, now.position, now.position
            if contact.started != 0:
                gap, low, high = (
                    min(gap, contact.start_gap),
                    min(low, contact.start_position),
                    max(high, contact.start_position),
                )
            choose(m, k, now.flank, now.number, gap, low, high)
        at = spot_at(m, now.position, now.moves)
        half_curvature = 0.5 * m.scene.population.steepness / at.radius
        for j in range(m.work.contact[k].count):
            least = min(least, _guard(m, k, j, now, at.arc, half_curvature))
    return least


@compiled(inline=True)
def _guard(m: Model, k: int, j: int, now: PairState, arc: float, half_curvature: float) -> float:
    """Guard of a candidate of the k-th history."""
    x = m.rows[column(m, k, ARC) + j] - arc
    overlap = m.rows[column(m, k, HEIGHT) + j] - now.gap - half_curvature * x * x
    return m.rows[column(m, k, SIGN) + j] * (overlap + m.rows[column(m, k, BOUND) + j])


@compiled_once(POPULATION)
def switch_asperities(m: Model, y: Floats) -> bool:
    """Join or detach all asperities whose guards have fallen, for `record_switches` to record; whether any has.

    The integration must then begin anew: loads jump, and the rest of the step has been made without them.

    Parameters
    ----------
    m : Model
        Candidates, energy balance and counters change.
    y : ndarray, shape (n,)
        State at the root.
    """
    asperity_switches = 0
    for k in range(m.scene.histories):
        m.work.contact[k].asperity_switches = 0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        contact = m.work.contact[k]
        if contact.count == 0:
            continue
        now, switched = pair_of(m, k, y), column(m, k, REMEMBERED)
        at = spot_at(m, now.position, now.moves)
        half_curvature = 0.5 * m.scene.population.steepness / at.radius
        for j in range(contact.count):
            guard = _guard(m, k, j, now, at.arc, half_curvature)
            if guard < 0.0:
                _switch(m, k, j, guard)
                m.rows[switched + contact.asperity_switches] = j
                contact.asperity_switches += 1
        if contact.asperity_switches > 0:
            list_joined(m, k)
            m.state.cycle_events += contact.asperity_switches
            asperity_switches += contact.asperity_switches
    return asperity_switches > 0


@compiled
def _switch(m: Model, k: int, j: int, guard: float) -> None:
    """Join or detach a candidate, and book the energy that it loses."""
    sign, bound, kind = column(m, k, SIGN) + j, column(m, k, BOUND) + j, int(m.rows[column(m, k, KIND) + j])
    energy = candidate_energy(m, kind, m.rows[sign] * guard - m.rows[bound])
    if m.rows[sign] < 0.0:
        m.state.energy.adhesion_loss -= energy
        m.state.asperity_onsets += 1
    else:
        m.state.energy.adhesion_loss += energy
        m.state.asperity_detachments += 1
    _switch_state(m, k, j)


@compiled
def _switch_state(m: Model, k: int, j: int) -> None:
    """Make a free candidate a joined one, or the other way round."""
    sign, kind = column(m, k, SIGN) + j, int(m.rows[column(m, k, KIND) + j])
    m.rows[sign] = -m.rows[sign]
    m.rows[column(m, k, BOUND) + j] = m.tables[kind + (K_DETACH if m.rows[sign] > 0.0 else K_JOIN)]


@compiled
def record_switches(m: Model, t: float, y: Floats, events: Floats, count: int) -> tuple[int, bool]:
    """Record what `switch_asperities` has found, and pairs that come into contact or part with it.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State there.
    count : int
        See `gearidae.engine.events.record`.

    Returns
    -------
    count : int
        New number of events.
    crowded : bool
        Whether there have been more than can be recorded at once, or in one mesh cycle.
    """
    asperity_switches = 0
    for k in range(m.scene.histories):
        contact, h = m.work.contact[k], m.state.history[k]
        flank = flank_of_history(m, k)
        for i in range(contact.asperity_switches):
            asperity_switches += 1
            if m.scene.population.quiet == 0 and asperity_switches < SWITCHES_HIGH:
                j = int(m.rows[column(m, k, REMEMBERED) + i])
                kind = _ONSET if m.rows[column(m, k, SIGN) + j] > 0.0 else _DETACHMENT
                asperity = m.rows[column(m, k, INDEX) + j]
                asperity -= m.tables[m.scene.population.starts_at + flank_of(m, flank, h.pair)]
                count = record_asperity(m, events, count, (t, kind, h.pair, flank, h.gap_rate), asperity)
        if contact.asperity_switches > 0 and (contact.joined > 0) != (h.in_contact != 0):
            h.in_contact = 1 - h.in_contact
            kind = _PAIR_ONSET if h.in_contact != 0 else _PAIR_SEPARATION
            count = record_contact(m, y, events, count, (t, kind, h.pair, flank, h.gap_rate))
            if h.in_contact != 0:
                if m.state.last_flank == 1 - flank:
                    count = record(m, events, count, t, _FLANK_CHANGE, h.pair, flank, h.gap_rate)
                m.state.last_flank = flank
        contact.asperity_switches = 0
    return count, asperity_switches >= SWITCHES_HIGH or m.state.cycle_events > CYCLE_HIGH


@compiled_once(POPULATION)
def join_at_start(m: Model, y: Floats) -> None:
    """Join asperities that overlap at a start, and detach those that a new material does not hold."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        now = pair_of(m, k, y)
        choose(m, k, now.flank, now.number, now.gap, now.position, now.position)
        at = spot_at(m, now.position, now.moves)
        half_curvature = 0.5 * m.scene.population.steepness / at.radius
        for j in range(m.work.contact[k].count):
            if _guard(m, k, j, now, at.arc, half_curvature) < 0.0:
                _switch_state(m, k, j)
        list_joined(m, k)
        m.state.history[k].in_contact = 1 if m.work.contact[k].joined > 0 else 0


@compiled_once(POPULATION)
def note_step_start(m: Model, y: Floats) -> None:
    """Note the pairs at a state from which the next step goes on; `asperity_guard` has been asked there."""
    for k in range(m.scene.histories):
        m.work.contact[k].started = 0
    for i in range(list_known(m, y)):
        contact, now = m.work.contact[m.work.known[i]], pair_of(m, m.work.known[i], y)
        contact.started, contact.start_moves = 1, 1 if now.moves else 0
        contact.start_gap, contact.start_rate = now.gap, now.rate
        contact.start_position, contact.start_position_rate = now.position, now.position_rate


@compiled_once(POPULATION)
def first_grazing_minimum(m: Model, y: Floats, h: float) -> float:
    """Share of a step at which the guard of a candidate is least and below zero, though it is above at both ends.

    Parameters
    ----------
    y : ndarray, shape (n,)
        State at the end of the step, where `asperity_guard` has been asked.
    h : float
        Length of the step over tau, from where `note_step_start` has been.

    Returns
    -------
    float
        The earliest such share, or -1.
    """
    first = 2.0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        contact = m.work.contact[k]
        if contact.started == 0:
            continue
        now = pair_of(m, k, y)
        before = PairState(
            now.flank,
            now.number,
            k,
            True,
            contact.start_gap,
            contact.start_rate,
            0.0,
            contact.start_position,
            contact.start_position_rate,
            contact.start_moves != 0,
        )
        first = min(first, _first_dip_of(m, k, before, now, h))
    return first if first < 1.0 else -1.0


@compiled
def _first_dip_of(m: Model, k: int, before: PairState, now: PairState, h: float) -> float:
    """Earliest dip of the candidates of a pair between two states; 2 if there is none."""
    first = 2.0
    at0, at1 = spot_at(m, before.position, before.moves), spot_at(m, now.position, now.moves)
    bend0, bend1 = (
        0.5 * m.scene.population.steepness / at0.radius,
        0.5 * m.scene.population.steepness / at1.radius,
    )
    for j in range(m.work.contact[k].count):
        g0, g1 = _guard(m, k, j, before, at0.arc, bend0), _guard(m, k, j, now, at1.arc, bend1)
        arc, sign = m.rows[column(m, k, ARC) + j], m.rows[column(m, k, SIGN) + j]
        d0 = overlap_slopes(m, at0, arc - at0.arc)[0] * before.position_rate
        d1 = overlap_slopes(m, at1, arc - at1.arc)[0] * now.position_rate
        r0, r1 = h * sign * (d0 - before.rate), h * sign * (d1 - now.rate)
        if g0 > 0.0 and g1 > 0.0 and r0 < 0.0 < r1:
            share, least = _lowest(g0, g1, r0, r1)
            if least < 0.0:
                first = min(first, share)
    return first


@compiled
def _lowest(g0: float, g1: float, r0: float, r1: float) -> tuple[float, float]:
    """Minimum of the cubic with these values and slopes at 0 and 1, the first slope negative and the last positive."""
    a, b = 3.0 * (r0 + r1 - 2.0 * (g1 - g0)), 3.0 * (g1 - g0) - 2.0 * r0 - r1  # slope: a s^2 + 2 b s + r0
    root = math.sqrt(max(b * b - a * r0, 0.0))
    share = -r0 / (b + root) if b > 0.0 else (root - b) / a
    value = g0 + share * (r0 + share * (b + share * a / 3.0))
    return share, value
