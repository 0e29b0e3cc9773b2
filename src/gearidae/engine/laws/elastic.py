"""Elastic bodies under the statistics of their asperities, as a law of a pair: see `gearidae.engine.elastic`."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.compiling import ELASTIC as ELASTIC_PART
from gearidae.engine.elastic.energy import (
    nodes_energies,
    nodes_length_force,
    nodes_losses,
    nodes_number,
    nodes_stored,
)
from gearidae.engine.elastic.limits import limit_of_nodes
from gearidae.engine.elastic.node_rows import TANGENT, row
from gearidae.engine.elastic.nodes import node_force
from gearidae.engine.elastic.static_condensation import condense_pair
from gearidae.engine.model.state import PHASE, Floats, Model, V, W
from gearidae.engine.pairs.coverage import (
    NONE,
    Shares,
    added,
    note_shares,
    noted_shares,
    path_position,
    rubs_by_material,
    shares_of,
    weighed,
)
from gearidae.engine.pairs.lengths import length_and_rates, slopes_along_path, weighed_length
from gearidae.engine.pairs.orbit import opening_of
from gearidae.engine.pairs.tooth_pairs import PairState, contact_length, flank_of_history, is_on_path
from gearidae.laws.pair_law import NO_PAIR_FORCE, PairForce, PairLaw, both_forces, of_path


@compiled_once(ELASTIC_PART, makes_arrays=True)
def _of_pair(m: Model, t: float, y: Floats, pair: PairState, settling: bool) -> PairForce:
    """Force of a pair; of materials with different coefficients with the limit of its friction."""
    note_shares(m, pair.k, pair.flank, pair.number, pair.position)
    length = contact_length(m, pair.position)
    if settling:
        load, slope = condense_pair(m, pair.k, pair.known, t, y, pair.gap, pair.rate, length)
    else:
        load, slope = node_force(m, pair.k, pair.known, t, y, pair.gap, pair.rate, length)
    limit = limit_by_gap = 0.0
    if rubs_by_material(m):
        follow = row(m, pair.k, TANGENT) if settling else np.zeros(m.scene.nodes)
        limit, limit_by_gap = limit_of_nodes(m, t, y, pair, length, follow)
    force = PairForce(load, slope, 0.0, 0.0, load, slope, 0.0, 0.0, 0.0, limit, limit_by_gap, 0.0)
    return both_forces(force, _along_path(m, t, y, pair)) if m.scene.curvature_force != 0 else force


@compiled(inline=True)
def _force(m: Model, t: float, y: Floats, pair: PairState, settling: bool, value: PairForce) -> PairForce:
    return both_forces(value, _of_pair(m, t, y, pair, settling))


@compiled
def _by_length(
    m: Model, t: float, y: Floats, k: int, number: int, gap: float, rate: float, length: float
) -> tuple[float, float, Shares, Shares]:
    """Energy of a contact per length: of its bodies with its rate, and of its materials with slopes.

    Where shares do not change, all of it is said to be of the bodies, as nothing but the length matters.
    """
    flank = flank_of_history(m, k)
    note_shares(m, k, flank, number, path_position(m, flank, number, y[PHASE]))
    bodies, change = nodes_length_force(m, k, t, y, gap, rate, length)
    if m.scene.covered_by_position == 0:
        return bodies, change, NONE, NONE
    energies, slopes = nodes_energies(m, k, y, gap)
    shares = noted_shares(m, k)
    return bodies - weighed(shares, energies), change - rate * weighed(shares, slopes), energies, slopes


@compiled_once(ELASTIC_PART)
def _along_path(m: Model, t: float, y: Floats, pair: PairState) -> PairForce:
    """Force along the path of contact that pays for the changing length, see `gearidae.engine.laws.pairs`.

    Its slope in the gap is left out, which only steers Newton's iteration.
    """
    if not (pair.known and is_on_path(m, pair.flank, pair.number)):  # just within reach
        return NO_PAIR_FORCE
    flank, number, k = pair.flank, pair.number, pair.k
    pitch = (1.0 - 2.0 * flank) / m.scene.phase_rate
    length, stretch, second_rate = length_and_rates(m, flank, number, y[PHASE], pitch, 0.0)
    bodies, _, (a, b, c), _ = _by_length(m, t, y, k, number, pair.gap, pair.rate, length)
    a1, b1, c1 = nodes_losses(m, k, y, pair.gap)
    energies = (a - a1, b - b1, c - c1)
    along, by_gap, by_position = slopes_along_path(m, flank, number, y[PHASE], energies, NONE)
    return of_path(-(bodies * stretch + along), -by_gap, -(bodies * second_rate + by_position))


@compiled_once(ELASTIC_PART)
def _power(
    m: Model, t: float, y: Floats, k: int, gap: float, w_rate: float, value: tuple[float, float]
) -> tuple[float, float]:
    flank, number = flank_of_history(m, k), m.state.history[k].pair
    opening = opening_of(m, flank, y[V])
    length, stretch, second_rate = length_and_rates(m, flank, number, y[PHASE], y[W], w_rate)
    bodies, change, energies, slopes = _by_length(m, t, y, k, number, gap, opening, length)
    energy = weighed_length(m, (flank, number, y[PHASE]), y[W], w_rate, energies, slopes)
    power = bodies * stretch + energy.rate
    rate = change * stretch + bodies * second_rate + energy.second_rate + opening * energy.by_gap
    return value[0] + power, value[1] + rate


@compiled_once(ELASTIC_PART)
def _joining(m: Model, k: int, y: Floats, gap: float, value: tuple[Shares, Shares]) -> tuple[Shares, Shares]:
    """Add the losses, with slopes in proportion to a rigid contact's."""
    losses = nodes_losses(m, k, y, gap)
    a, a1 = _loss(m, gap, 0, losses[0])
    b, b1 = _loss(m, gap, 1, losses[1])
    c, c1 = _loss(m, gap, 2, losses[2])
    return added(value, ((a, b, c), (a1, b1, c1)))


@compiled(inline=True)
def _loss(m: Model, gap: float, material: int, loss: float) -> tuple[float, float]:
    surface = m.scene.material[material]
    if surface.stretch_limit == 0.0:
        return 0.0, 0.0
    number, slope = loading_value(m.tables, surface.number_at, gap + surface.gap_offset)
    return loss, (loss * slope / number if number > 0.0 else 0.0)


@compiled_once(ELASTIC_PART)
def _energy(m: Model, y: Floats, pair: PairState, value: tuple[float, float]) -> tuple[float, float]:
    k, gap, length = pair.k, pair.gap, contact_length(m, pair.position)
    shares = shares_of(m, pair.flank, pair.number, pair.position)
    note_shares(m, k, pair.flank, pair.number, pair.position)
    stored = length * nodes_stored(m, k, m.state.time, y, gap, pair.rate, length)
    lost = length * weighed(shares, _joining(m, k, y, gap, (NONE, NONE))[0])
    return value[0] + stored, value[1] + lost


@compiled(inline=True)
def _in_contact(m: Model, k: int, y: Floats, gap: float, material: int, value: float) -> float:
    return value + nodes_number(m, k, y, gap, material)


def _acts(scene: Any) -> bool:
    return bool(scene.nodes > 0)


ELASTIC = PairLaw(
    name="elastic bodies",
    acts=_acts,
    force=_force,
    energy=_energy,
    joining=_joining,
    in_contact=_in_contact,
    power=_power,
)
