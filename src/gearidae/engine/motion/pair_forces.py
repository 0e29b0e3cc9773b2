"""Forces of all pairs at a state: the one walk over the pairs that sums them, whatever laws they have."""

from __future__ import annotations

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION, SOLVER
from gearidae.engine.elastic.limits import limit_of_nodes
from gearidae.engine.elastic.node_rows import first_unknown
from gearidae.engine.elastic.static_condensation import (
    FINISH,
    PREDICT,
    SETTLE,
    following_slope,
    pair_deflections,
)
from gearidae.engine.laws.pairs import force_of_pair
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.pairs.coverage import note_shares, rubs_by_material
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.pair_force import NO_MESH_FORCES, MeshForces, add_pair
from gearidae.engine.pairs.tooth_pairs import (
    PairState,
    acts,
    contact_length,
    flank_of_history,
    pair_at,
    pair_state,
    pairs_felt,
    pairs_touching,
)
from gearidae.engine.population.contact_point import state_of_pair
from gearidae.laws.pair_law import PairForce


@compiled(inline=True)
def mesh_forces(m: Model, t: float, y: Floats, settling: bool) -> MeshForces:
    """Sum the forces of all pairs, with their slopes; the state of the run stays as it is.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray
        State.
    settling : bool
        Whether the deflections of elastic contacts are solved for, with slopes along which they follow; otherwise they
        are those of the state, and the slopes are at fixed deflection.
    """
    total = NO_MESH_FORCES
    follow_orbit(m, t)
    m.work.pair_forces.count = 0
    full = with_deflections(m, y) if m.scene.nodes > 0 and settling else y
    reach = pairs_felt(m, y)
    for i in range(reach.total):
        flank, number = pair_at(reach, i)
        pair = state_of_pair(m, flank, number, y)
        if acts(m, pair):
            force = force_of_pair(m, t, full, pair, settling)
            if m.scene.noting != 0:
                note_pair_force(m, pair, force)
            total = add_pair(m, total, pair, force)
    return total


@compiled_once(SOLVER)
def forces_at(m: Model, t: float, y: Floats) -> MeshForces:
    """`mesh_forces` at the deflections of the state, for what asks now and then."""
    return mesh_forces(m, t, y, False)


@compiled_once(SOLVER)
def force_of_one(m: Model, t: float, y: Floats, flank: int, number: int) -> float:
    """Force of a single pair along the line of action by all laws of the scene, positive where its flanks push."""
    follow_orbit(m, t)
    pair = state_of_pair(m, flank, number, y)
    return force_of_pair(m, t, y, pair, False).load if acts(m, pair) else 0.0


# -- slopes along which deflections follow ---------------------------------------------------------------------------


@compiled_once(FRICTION, makes_arrays=True)
def follow_slopes(m: Model, t: float, y: Floats, ahead: float, later: Floats) -> None:
    """Let the noted slopes of elastic pairs at a state be those along which their deflections follow the gaps.

    The deflections a short time `ahead` are written to the state `later`.
    """
    follow = np.empty(m.scene.nodes)
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        k, length = noted.history, contact_length(m, noted.position)
        more = following_slope(m, k, y, length, follow)
        noted.slope += more
        noted.contact_slope += more
        if rubs_by_material(m):
            pair = pair_state(m, flank_of_history(m, k), int(noted.pair), y)
            noted.limit_slope = limit_of_nodes(m, t, y, pair, length, follow)[1]
        first = first_unknown(m, k)
        for node in range(m.scene.nodes):
            later[first + node] = y[first + node] + ahead * follow[node] * noted.gap_rate


# -- deflections that are eliminated ---------------------------------------------------------------------------------


@compiled(makes_arrays=True)
def with_deflections(m: Model, y: Floats) -> Floats:
    """Whole state to which deflections can be put: `y` itself, or a longer copy of a state of the motion alone."""
    if y.size == m.scene.states:
        return y
    whole = m.rows[m.scene.trial_at : m.scene.trial_at + m.scene.states]
    for j in range(y.size):
        whole[j] = y[j]
    return whole


@compiled
def is_eliminated(m: Model) -> bool:
    """Whether there are nodes that the integrator does not see."""
    return bool(m.scene.nodes > 0 and m.work.adams.native_newton != 0)


@compiled
def set_deflections(m: Model, t: float, y: Floats, roughly: bool) -> None:
    """Solve for the deflections that go with the motion of a whole state, or only interpolate them, in place."""
    _ask_for_deflections(m, t, y, PREDICT if roughly else SETTLE)


@compiled
def finish_deflections(m: Model, t: float, y: Floats) -> None:
    """Put the deflections to the state at the end of a step, and note them for the prediction of the next ones."""
    for k in range(m.scene.histories):
        m.work.settling[k].reached = 0
    _ask_for_deflections(m, t, y, FINISH)
    for k in range(m.scene.histories):
        if m.work.settling[k].reached == 0:
            m.work.settling[k].last_known = m.work.settling[k].before_known = 0


@compiled_once(SOLVER)
def _ask_for_deflections(m: Model, t: float, y: Floats, kind: int) -> None:
    """Ask for the deflections of all pairs within reach, in one of the ways of `pair_deflections`."""
    follow_orbit(m, t)
    for j in range(first_unknown(m, 0), y.size):  # those of pairs out of reach are zero
        y[j] = 0.0
    reach = pairs_touching(m, y)
    for i in range(reach.total):
        flank, number = pair_at(reach, i)
        pair = pair_state(m, flank, number, y)
        if acts(m, pair):
            m.work.settling[pair.k].reached = 1
            note_shares(m, pair.k, flank, number, pair.position)
            pair_deflections(m, kind, t, y, pair, contact_length(m, pair.position))


@compiled(inline=True)
def note_pair_force(m: Model, pair: PairState, f: PairForce) -> None:
    """Note a pair and its force."""
    notes = m.work.pair_forces
    noted = notes.pair[notes.count]
    noted.history, noted.pair, noted.position = pair.k, pair.number, pair.position
    noted.gap, noted.gap_rate, noted.relief = pair.gap, pair.rate, pair.slope
    noted.force, noted.slope, noted.drift = f.load, f.by_gap, f.by_position * pair.position_rate
    noted.contact, noted.contact_slope, noted.damping = f.contact, f.contact_by_gap, f.by_rate
    noted.limit, noted.limit_slope = f.limit, f.limit_by_gap
    noted.limit_rate = f.limit_by_position * pair.position_rate + f.limit_by_gap * pair.rate
    notes.count += 1
