"""From one contact model, or one layout of nodes, to another in the middle of a run."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearidae.engine.elastic.histories import accumulate_points, init_nodes
from gearidae.engine.elastic.node_rows import (
    GAP,
    GAP_SHARE,
    JOINED,
    first_unknown,
    point_gaps,
    profile_of,
    row_of,
)
from gearidae.engine.events.sliding import settle_start
from gearidae.engine.laws.statistical import set_all_branches, set_joined
from gearidae.engine.model.state import EMPTY, MATERIALS, Floats, Model, assign
from gearidae.engine.motion.static_solve import SETTLED, settle_nodes
from gearidae.engine.observers.balance import carry_balance
from gearidae.engine.observers.exposures.bins import exposure_table
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.setup.problem import Problem

_ROUNDS = 20  # each brings the deflections ten times nearer to those of what is joined, or more


def change_over(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which the elastic problem continues where the asperity problem stopped.

    The whole state is kept: motion, mesh, dry resistance, sums and what every pair remembers. The deflections are those
    that the pressures cause (some hundredths of the roughness, which is when this happens), and every node is stretched
    as its pair was.

    Parameters
    ----------
    old : Problem
        The asperity problem.
    new : Problem
        The same scene's elastic problem, fresh.
    checkpoint : ndarray
        Where the asperity problem stands.
    """
    m, source = new.model, old.model
    time, state = old.restored(checkpoint)
    take_over(source, m)
    m.state.deep_exits = m.state.extremes.mesh_exits
    y = np.concatenate([state, np.zeros(new.start.size - state.size)])
    join_as_pairs(m, y)
    return _handed_over(source, state, new, time, y)


def _handed_over(source: Model, state: Floats, new: Problem, time: float, y: Floats) -> Floats:
    """Checkpoint of the new problem: held friction is decided on anew, and the change of the stored energy booked."""
    if new.model.scene.friction.any_friction != 0:
        settle_start(new.model, time, y, False)
    for model in (source, new.model):
        follow_orbit(model, time)
    carry_balance(source, state, new.model, y)
    return new.checkpoint(time, y)


def join_as_pairs(m: Model, y: Floats) -> None:
    """Set the deflections that go with the pairs' joined heights, in place.

    What is joined goes with the gaps along the contact, and these with the pressures of what is joined.
    """
    _settle(m, y, lambda: _join(m, y))


def _settle(m: Model, y: Floats, join: Callable[[], None]) -> None:
    """Solve for deflections and for what is joined with them in turn, in place."""
    for _ in range(_ROUNDS):
        before = y.copy()
        join()
        settle_nodes(m, float(m.state.time), y)
        if np.max(np.abs(y - before)) <= SETTLED:
            break


def join_anew(m: Model, y: Floats, absent: tuple[bool, ...]) -> None:
    """Take the joined heights along all contacts to other materials, and settle the deflections with them, in place.

    Parameters
    ----------
    m : Model
        With the joined heights that have been carried over.
    y : ndarray
        State, with the deflections where the search begins; changed.
    absent : tuple of bool
        For each material, whether it has not been there: it begins with nothing stretched.
    """
    rows = m.rows.copy()
    carried = Model(*(rows if part is m.rows else part for part in m))
    _settle(m, y, lambda: _limit(carried, m, y, absent))


def _limit(carried: Model, m: Model, y: Floats, absent: tuple[bool, ...]) -> None:
    """Detach asperities that cannot stretch as far as the carried heights; absent materials begin unstretched."""
    gaps = np.empty(int(m.scene.points))
    for k in range(int(m.scene.histories)):
        h = m.state.history[k]
        if h.pair == EMPTY:
            continue
        point_gaps(m, k, y, float(h.gap), gaps)
        h.stretched = 0
        for material in range(MATERIALS):
            limit, heights = m.scene.material[material].stretch_limit, row_of(m, k, JOINED + material)
            heights[:] = (
                gaps if absent[material] else np.maximum(row_of(carried, k, JOINED + material), gaps - limit)
            )
            if h.direction > 0.0:
                heights[:] = np.minimum(heights, gaps)
            if limit > 0.0 and (heights < gaps).any():
                h.stretched = 1
            accumulate_points(m, k, material)


def take_over(source: Model, m: Model) -> None:
    """Take the state over, with the histories in the slots that the new model has for them."""
    slots, new_slots = int(source.scene.slots), int(m.scene.slots)
    histories = [(k // slots, h.copy()) for k, h in enumerate(source.state.history[: source.scene.histories])]
    assign(m.state, source.state)
    m.state.bound_exceeded = 0
    m.state.history["pair"] = EMPTY
    for flank, h in histories:
        if h.pair != EMPTY:
            assign(m.state.history[flank * new_slots + (int(h.pair) & (new_slots - 1))], h)
    set_all_branches(m)
    carry_exposures(source, m)


def remember(source: Model, m: Model, k: int) -> None:
    """Take a pair's joined heights to other materials or to rigid bodies, and set the energy of what is joined."""
    h = m.state.history[k]
    for material in range(MATERIALS):
        before, limit = source.scene.material[material], float(m.scene.material[material].stretch_limit)
        joined = float(h.joined[material])
        if before.stretch_limit == 0.0:  # it has remembered nothing
            joined = float(h.gap)
        joined = max(joined, float(h.gap) - limit)
        if h.direction > 0.0:
            joined = min(joined, float(h.gap))
        h.joined[material] = joined
        # that of a contact with nodes is kept with these, and a material that cannot stretch has none
        h.adhered_energy[material] = 0.0
        if limit > 0.0 and m.scene.nodes == 0:
            set_joined(m, k, material, joined)
        stretched = h.direction > 0.0 and joined + limit <= h.gap
        h.at_pull_off[material] = int(limit > 0.0 and stretched)


def to_rigid(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which the asperity problem goes on where the elastic problem has had light contacts for long.

    The motion is kept, and how far asperities are stretched in the middle of each contact; what the deflections stored,
    some hundredths of a roughness, is booked as change of the model.

    Parameters
    ----------
    old : Problem
        The elastic problem.
    new : Problem
        The same scene's asperity problem; whatever it has been through is forgotten.
    checkpoint : ndarray
        Where the elastic problem stands.
    """
    m, source = new.model, old.model
    time, state = old.restored(checkpoint)
    take_over(source, m)
    m.state.rigid_again = 0
    y = state[: new.start.size].copy()
    slots, new_slots = int(source.scene.slots), int(m.scene.slots)
    for k in range(int(m.scene.histories)):
        h = m.state.history[k]
        if h.pair != EMPTY:
            h.joined -= state[first_unknown(source, k // new_slots * slots + (int(h.pair) & (slots - 1)))]
            h.stretched = 0
            remember(source, m, k)
    return _handed_over(source, state, new, time, y)


def carry_exposures(source: Model, m: Model) -> None:
    """Take over what the flanks have been exposed to, if the new model keeps as many bins; else it begins anew.

    The work of friction begins with friction, and ends with it.
    """
    if source.scene.bins == m.scene.bins > 0:
        before, after = exposure_table(source), exposure_table(m)
        both = min(before.shape[1], after.shape[1])
        after[:, :both] = before[:, :both]


def extend_nodes(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which nodes that reach further go on where those of a contact have been pressed too deep.

    Everything is kept but for the nodes' positions: joined heights are carried to the new ones by interpolation along
    the contact, and deflections are solved for.

    Parameters
    ----------
    old : Problem
        The elastic problem so far.
    new : Problem
        Elastic problem laid out for deeper contacts, with as many nodes.
    checkpoint : ndarray
        Where the old one stands.
    """
    m, source = new.model, old.model
    time, state = old.restored(checkpoint)
    assign(m.state, source.state)
    m.state.bound_exceeded = 0
    m.rows[m.scene.node_rows_at : m.scene.error_weights_at] = source.rows[
        source.scene.node_rows_at : source.scene.error_weights_at
    ]
    carry_exposures(source, m)
    y = state.copy()
    _interpolate(source, state, m, y)
    settle_nodes(m, time, y)
    note_gaps(m, y)
    return _handed_over(source, state, new, time, y)


def carry_nodes(source: Model, state: Floats, m: Model, y: Floats) -> bool:
    """Carry deflections and what nodes remember to another model with nodes, in place.

    Returns
    -------
    bool
        Whether both have the same nodes and units, so that all is kept to the last bit; else the deflections are where
        the search for the new ones begins, and `note_gaps` is wanted once they are settled.
    """
    old, new = profile_of(source, False), profile_of(m, False)
    same = (
        np.array_equal(old, new)
        and source.scene.force_unit == m.scene.force_unit
        and source.scene.histories == m.scene.histories
    )
    if same:
        m.rows[m.scene.node_rows_at : m.scene.error_weights_at] = source.rows[
            source.scene.node_rows_at : source.scene.error_weights_at
        ]
        y[-int(m.scene.nodes * m.scene.histories) :] = state[-int(m.scene.nodes * m.scene.histories) :]
        return True
    _interpolate(source, state, m, y)
    return False


def note_gaps(m: Model, y: Floats) -> None:
    """Note gaps and the energy of what is joined along all contacts, once the deflections are settled."""
    nodes = int(m.scene.nodes)
    for k in range(int(m.scene.histories)):
        first = first_unknown(m, k)
        gap = m.state.history[k].gap
        row_of(m, k, GAP)[:] = gap + profile_of(m, False) + y[first : first + nodes]
        for material in range(MATERIALS):
            accumulate_points(m, k, material)


def _interpolate(source: Model, state: Floats, m: Model, y: Floats) -> None:
    """Carry deflections, shares and joined heights to the positions of other nodes, pair by pair."""
    before = {
        (k // int(source.scene.slots), int(source.state.history[k].pair)): k
        for k in range(int(source.scene.histories))
    }
    for k in range(int(m.scene.histories)):
        key = (k // int(m.scene.slots), int(m.state.history[k].pair))
        old = before.get(key)
        if old is None:
            continue
        first, was = first_unknown(m, k), first_unknown(source, old)
        deflections = state[was : was + int(source.scene.nodes)]
        y[first : first + int(m.scene.nodes)] = _along(source, m, deflections, False)
        row_of(m, k, GAP_SHARE)[:] = _along(source, m, row_of(source, old, GAP_SHARE), False)
        for material in range(MATERIALS):
            heights = row_of(source, old, JOINED + material) - profile_of(source, True)
            row_of(m, k, JOINED + material)[:] = _along(source, m, heights, True) + profile_of(m, True)


def _along(source: Model, m: Model, values: Floats, finer: bool) -> Floats:
    """Carry values from positions along the old contact to those along the new one, flat beyond the last."""
    # takes a sixth of a second to import, and few runs need it
    from scipy.interpolate import PchipInterpolator

    here, there = np.sqrt(profile_of(source, finer)), np.sqrt(profile_of(m, finer))
    return np.asarray(PchipInterpolator(here, values)(np.minimum(there, here[-1])))


def _join(m: Model, y: Floats) -> None:
    """Stretch every point as its pair is stretched."""
    for k in range(int(m.scene.histories)):
        h = m.state.history[k]
        if h.pair == EMPTY:
            continue
        init_nodes(m, k, y, float(h.gap))
        for material in range(MATERIALS):
            row_of(m, k, JOINED + material)[:] += h.joined[material] - h.gap
            if h.joined[material] < h.gap:
                h.stretched = 1
            accumulate_points(m, k, material)
