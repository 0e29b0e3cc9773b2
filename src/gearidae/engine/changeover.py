"""From one contact model, or one layout of nodes, to another in the middle of a run."""

from __future__ import annotations

import numpy as np

from gearidae.engine.elastic.histories import book_points, init_nodes
from gearidae.engine.elastic.rows import GAP, JOINED, SHARE, first_unknown, profile_of, row_of
from gearidae.engine.elastic.static_solve import SETTLED, settle_nodes
from gearidae.engine.energy.balance import carry_balance
from gearidae.engine.model.problem import Problem
from gearidae.engine.model.state import EMPTY, MATERIALS, Floats, Model, assign

__all__ = ["change_over", "deepen"]

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
    state = np.empty(old.start.size)
    time = old.restore(checkpoint, state)
    _take_over(source, m)
    y = np.concatenate([state, np.zeros(new.start.size - state.size)])
    # what is joined goes with the gaps along the contact, and these with the pressures of what is joined
    for _ in range(_ROUNDS):
        before = y.copy()
        _join(m, y)
        settle_nodes(m, time, y)
        if np.max(np.abs(y - before)) <= SETTLED:
            break
    carry_balance(source, state, m, y)
    return new.checkpoint(time, y)


def _take_over(source: Model, m: Model) -> None:
    """Take the state over, with the histories in the slots that the new model has for them."""
    slots, own = int(source.scene.slots), int(m.scene.slots)
    histories = [(k // slots, h.copy()) for k, h in enumerate(source.state.history[: source.scene.histories])]
    assign(m.state, source.state)
    m.state.bound_exceeded = 0
    m.state.history["pair"] = EMPTY
    for coast, h in histories:
        if h.pair != EMPTY:
            assign(m.state.history[coast * own + (int(h.pair) & (own - 1))], h)


def deepen(old: Problem, new: Problem, checkpoint: Floats) -> Floats:
    """Checkpoint from which nodes that reach further go on where those of a contact have been pressed too deep.

    Everything is kept but for the nodes' places: joined heights are carried to the new ones by interpolation along the
    contact, and deflections are solved for.

    Parameters
    ----------
    old : Problem
        The elastic problem so far.
    new : Problem
        The same, laid out for deeper contacts, with as many nodes.
    checkpoint : ndarray
        Where the old one stands.
    """
    m, source = new.model, old.model
    state = np.empty(old.start.size)
    time = old.restore(checkpoint, state)
    assign(m.state, source.state)
    m.state.bound_exceeded = 0
    m.rows[m.scene.node_rows_at : m.scene.error_weights_at] = source.rows[
        source.scene.node_rows_at : source.scene.error_weights_at
    ]
    nodes, y = int(m.scene.nodes), state.copy()
    for k in range(int(m.scene.histories)):
        first = first_unknown(m, k)
        y[first : first + nodes] = _along(source, m, state[first : first + nodes], False)
        row_of(m, k, SHARE)[:] = _along(source, m, row_of(source, k, SHARE), False)
        for material in range(MATERIALS):
            heights = row_of(source, k, JOINED + material) - profile_of(source, True)
            row_of(m, k, JOINED + material)[:] = _along(source, m, heights, True) + profile_of(m, True)
    settle_nodes(m, time, y)
    for k in range(int(m.scene.histories)):
        first = first_unknown(m, k)
        gap = m.state.history[k].gap
        row_of(m, k, GAP)[:] = gap + profile_of(m, False) + y[first : first + nodes]
        for material in range(MATERIALS):
            book_points(m, k, material)
    carry_balance(source, state, m, y)
    return new.checkpoint(time, y)


def _along(source: Model, m: Model, values: Floats, finer: bool) -> Floats:
    """Carry values from places along the old contact to those along the new one, flat beyond the last."""
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
            book_points(m, k, material)
