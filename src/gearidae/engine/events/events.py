"""The guard function monitored by the solver, and the handling of its roots.

`guard` is the root function; `handle` deals with what the root found there stands for: it records events, takes the
joined heights at turning points and tells the driver whether to restart the integration: where the equations have
jumped, or where the present step is too long for what is to come. Between events
`gearidae.engine.events.histories` follows the pairs.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.elastic.nodes import middle_gap
from gearidae.engine.events.asperity_events import asperity_guard, flip_asperities, record_flips
from gearidae.engine.events.dry_resistance import dry_guard, stick_or_slip
from gearidae.engine.events.mesh_marks import cross_mark, crossed_mark, mark_guard, outruns_relief
from gearidae.engine.events.pair_events import handle_pair, newly_stretched, pair_guard
from gearidae.engine.events.run_stop import stop_guard
from gearidae.engine.followers.balance import sample_radius_power
from gearidae.engine.followers.joining import sample_joining
from gearidae.engine.model.state import COAST, DRIVE, GEARS, MATERIALS, ROLLER, Floats, Model
from gearidae.engine.pairs.tooth_pairs import (
    gap_and_rate,
    history_of,
    in_flight,
    nearest_gap,
    pair_at,
    pairs_near,
)

__all__ = ["CONTINUE", "CROWDED", "RESTART", "balance_can_wait", "guard", "handle"]

LIGHT_EXITS = 4
"""Mesh exits without a deep contact after which elastic bodies are no longer needed."""

CONTINUE, RESTART, CROWDED = 0, 1, 2

_TINY: Final = 1e-300


@compiled(inline=True)
def guard(m: Model, t: float, y: Floats) -> float:
    """Root function: falls through zero at the first of all possible events.

    Every single guard (a pair's onset or separation, its turning point, full stretch of a material, a mark of the
    mesh, the dry resistance, a flank coming near) is positive while it waits, so that the least of them waits for
    them all. What has happened is disarmed by `handle`, and the next in the same step is found in its turn.
    """
    least = math.inf
    if m.scene.kind == GEARS:
        least = mark_guard(m, y)
        if m.scene.stop != 0:
            least = min(least, stop_guard(m, y))
        if m.scene.dry != 0:
            least = min(least, dry_guard(m, t, y))
        if m.state.near[COAST] == 0:
            least = min(least, nearest_gap(m, COAST, y) - m.scene.cutoff)
    if m.state.near[DRIVE] == 0:
        least = min(least, nearest_gap(m, DRIVE, y) - m.scene.cutoff)
    if m.scene.population.flanks != 0:
        least = min(least, asperity_guard(m, y))
        return least if least != 0.0 else _TINY
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair == pair:
            gap, rate = gap_and_rate(m, coast, pair, y)
            least = min(least, pair_guard(m, k, gap, rate, middle_gap(m, k, y, gap)))
    # a guard that stays at exactly zero just after its root would be an error to the root finder; zero counts as
    # not yet fallen
    return least if least != 0.0 else _TINY


@compiled
def handle(m: Model, t: float, y: Floats, events: Floats, count: int) -> tuple[int, int]:
    """Deal with all guards that have fallen at t.

    Parameters
    ----------
    m : Model
        Histories, marks and modes change in place.
    t : float
        Time over tau; `accept` has been there.
    y : ndarray, shape (n,)
        State there; set to rest where dry resistance takes hold.
    events : ndarray, shape (n, 5)
        See `gearidae.engine.events.record`.
    count : int
        Events already there.

    Returns
    -------
    count, action : int
        New number of events, and `CONTINUE`, `RESTART` or `CROWDED`.
    """
    action = CONTINUE
    lost, crossed = m.state.energy.adhesion_loss, False
    if m.scene.kind == GEARS:
        crossed = crossed_mark(m, y)
        if crossed:
            count = cross_mark(m, t, y, events, count)
            m.state.cycle_events = 0
            if m.scene.nodes > 0 and _light(m):
                m.state.light = 1
            # the force of a pair there jumps, or it would part unseen
            if not in_flight(m) and (m.scene.radius_force != 0 or outruns_relief(m, t, y)):
                action = RESTART
        if m.scene.dry != 0 and dry_guard(m, t, y) <= 0.0:
            action = RESTART
            count = stick_or_slip(m, t, y, events, count)
    if m.scene.population.flanks != 0:
        if flip_asperities(m, y):
            action = RESTART
        count, chatter = record_flips(m, t, events, count)
        if chatter or _crowded(m, t):
            action = CROWDED
        return count, action
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair == pair:
            count = handle_pair(m, t, y, coast, pair, k, events, count)
    joined = m.scene.nodes > 0 and m.scene.kind == GEARS and m.state.energy.adhesion_loss != lost
    if crossed:
        sample_joining(m, y)
    if crossed or joined:
        sample_radius_power(m, t, y)
    if _crowded(m, t):
        action = CROWDED
    return count, action


@compiled
def _light(m: Model) -> bool:
    """Whether contacts of elastic bodies have not been deep for so long that the asperity model would do, if it may."""
    passed = m.state.extremes.mesh_exits - m.state.deep_exits
    return bool(m.scene.light_gap < math.inf and passed >= LIGHT_EXITS)


@compiled
def _crowded(m: Model, t: float) -> bool:
    """Count a root, and return whether roots recur without progress in time."""
    s = m.state
    if t - s.last_root > m.scene.root_spacing * (1.0 + t):
        s.roots = 0
    s.last_root = t
    s.roots += 1
    return bool(s.roots > m.scene.root_limit)


@compiled
def balance_can_wait(m: Model, t: float, y: Floats) -> bool:
    """Whether the energy balance needs no sample at a root, before `handle` is called.

    That is so where gears' pairs touch, part or turn round and nothing else happens: up to their third derivative the
    powers know nothing of it.
    """
    if m.scene.kind == ROLLER or m.scene.nodes > 0 or m.state.bound_exceeded != 0:
        return False
    if m.scene.population.flanks != 0:  # forces jump
        return False
    if in_flight(m) or t - m.work.quadrature.time > m.scene.balance_span:
        return False
    if crossed_mark(m, y) or (m.scene.dry != 0 and dry_guard(m, t, y) <= 0.0):
        return False
    reach = pairs_near(m, y)
    for i in range(reach.total):
        coast, pair = pair_at(reach, i)
        k = history_of(m, coast, pair)
        if m.state.history[k].pair == pair:
            gap, _ = gap_and_rate(m, coast, pair, y)
            for material in range(MATERIALS):
                if newly_stretched(m, k, material, gap):
                    return False
    return True
