"""The guard function monitored by the solver, and the handling of its roots.

`guard` is the root function. `handle_mesh` deals with what has happened to mesh and gear at its root, and says whether
the integration must begin anew: where the equations have jumped, or where the present step is too long for what is to
come. `gearidae.engine.events.pair_events` deals with what has happened to the pairs, and
`gearidae.engine.events.histories` follows them between events.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.elastic.nodes import middle_gap
from gearidae.engine.events.asperity_events import asperity_guard
from gearidae.engine.events.cutoff import cutoff_guard, watches_cutoff
from gearidae.engine.events.law_switches import law_guard, shaft_guard
from gearidae.engine.events.mesh_marks import cross_mark, crossed_mark, mark_guard, outruns_relief
from gearidae.engine.events.pair_events import pair_guard
from gearidae.engine.events.sliding import REVERSALS_HIGH, friction_guard
from gearidae.engine.events.stops import stop_guard
from gearidae.engine.model.state import COAST, DRIVE, Floats, Model
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.tooth_pairs import (
    flank_of_history,
    gap_and_rate,
    in_flight,
    list_known,
    nearest_gap,
)

PROGRESS = 1e-6
"""Share of a run in which `REVERSALS_HIGH` changes of sliding are too many."""
LIGHT_EXITS = 4
"""Mesh exits without a deep contact after which elastic bodies are no longer needed."""

STOP, ROOT = 1, 2
"""IDA's flags for a stop and for a root."""

_ABOVE_ZERO: Final = 1e-300


@compiled(inline=True)
def guard(m: Model, t: float, y: Floats) -> float:
    """Root function: falls through zero at the first of all possible events.

    Every single guard (those of `mesh_guard`, of friction, the stop) is positive while it waits, so that the
    least of them waits for them all. What has happened is disarmed where it is dealt with, and the next in the same
    step is found in its turn.
    """
    follow_orbit(m, t)
    least = mesh_guard(m, t, y)
    if m.scene.stop != 0:
        least = min(least, stop_guard(m, t, y))
    if m.scene.friction.may_stick != 0:
        least = min(least, friction_guard(m, t, y))
    if m.scene.guarded != 0:
        least = min(least, shaft_guard(m, y))
    # a guard that stays at exactly zero just after its root would be an error to the root finder; zero counts as
    # not yet fallen
    return least if least != 0.0 else _ABOVE_ZERO


@compiled(inline=True)
def mesh_guard(m: Model, t: float, y: Floats) -> float:
    """Least of the guards of a mesh, its pairs and the laws of its shafts.

    They are a pair's onset or separation, its turning point, full stretch of a material, a mark of the mesh, a flank
    coming near, a pair at the cut-off, and the switch of a torque law.
    """
    least = mark_guard(m, y)
    if m.scene.law_switches != 0:
        least = min(least, law_guard(m, t, y))
    if watches_cutoff(m):
        least = min(least, cutoff_guard(m, y))
    if m.state.flank_in_reach[COAST] == 0:
        least = min(least, nearest_gap(m, COAST, y) - m.scene.cutoff)
    if m.state.flank_in_reach[DRIVE] == 0:
        least = min(least, nearest_gap(m, DRIVE, y) - m.scene.cutoff)
    if m.scene.population.flanks != 0:
        return min(least, asperity_guard(m, y))
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        gap, rate = gap_and_rate(m, flank_of_history(m, k), m.state.history[k].pair, y)
        least = min(least, pair_guard(m, k, gap, rate, middle_gap(m, k, y, gap)))
    return least


@compiled
def handle_mesh(
    m: Model, t: float, y: Floats, steps: tuple[float, float], events: Floats, count: int
) -> tuple[int, bool, bool]:
    """Deal with the guards of mesh and gear that have fallen at t, before the guards of the pairs.

    Parameters
    ----------
    m : Model
        Marks and modes change in place.
    t : float
        Time over tau; `accept` has been there.
    y : ndarray, shape (n,)
        State there.
    steps : tuple of float
        Lengths of the last whole step and of the present one so far, over tau.
    events : ndarray, shape (n, EVENT_NUMBERS)
        See `gearidae.engine.events.record`.
    count : int
        Events already there.

    Returns
    -------
    count : int
        New number of events.
    crossed, restart : bool
        Whether the phase has crossed a mark of the mesh, and whether the integration must begin anew.
    """
    restart, crossed = False, crossed_mark(m, y)
    if crossed:
        count = cross_mark(m, t, y, events, count)
        m.state.cycle_events = m.state.reversals = 0
        if m.scene.nodes > 0 and _light(m):
            m.state.rigid_again = 1
        # the force of a pair there jumps, or it would part unseen
        restart = not in_flight(m) and (m.scene.curvature_force != 0 or outruns_relief(m, y, steps))
    return count, crossed, restart


@compiled
def _light(m: Model) -> bool:
    """Whether contacts of elastic bodies have not been deep for so long that the asperity model would do, if it may."""
    passed = m.state.extremes.mesh_exits - m.state.deep_exits
    return bool(m.scene.light_gap < math.inf and passed >= LIGHT_EXITS)


@compiled
def chatters(m: Model, t: float) -> bool:
    """Count a root, and return whether roots recur without progress in time."""
    s = m.state
    many = s.reversals > REVERSALS_HIGH
    if t - s.counted_from > PROGRESS * (m.scene.end - m.scene.start):
        s.counted_from, s.reversals = t, 0
    if t - s.last_root > m.scene.root_spacing * (1.0 + t):
        s.roots = 0
    s.last_root = t
    s.roots += 1
    return bool(s.roots > m.scene.root_limit or many)
