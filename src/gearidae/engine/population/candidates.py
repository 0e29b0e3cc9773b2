"""The candidates of a pair: asperities that are joined, and those that may join while gap and position change little.

They are chosen anew where the gap has fallen or the position has moved by more than a margin. Asperities are looked for
in a window of arcs, among those above the highest of `LEVELS` that no candidate is below.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import POPULATION
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.coverage import fraction_of
from gearidae.engine.pairs.tooth_pairs import flank_of_history
from gearidae.engine.population.contact_point import Spot, position_of_arc, spot_at
from gearidae.engine.population.layout import (
    ARC,
    BOUND,
    HEIGHT,
    INDEX,
    JOINED,
    K_DETACH,
    K_JOIN,
    K_OFFSET,
    KIND,
    REMEMBERED,
    SIGN,
    column,
    flank_of,
)

LEVELS: Final = (1.0, 2.0)
"""Roughnesses above which asperities are listed once more: a sixth of them, and one in fifty."""
GAP_MARGIN: Final = 0.25  # roughnesses
PLACE_MARGIN: Final = 0.01  # pitches


@compiled(inline=True)
def covers(m: Model, k: int, gap: float, position: float) -> bool:
    """Whether the candidates of the k-th history hold at a gap and a position of its pair."""
    contact = m.work.contact[k]
    return bool(contact.known != 0 and gap >= contact.gap and contact.low <= position <= contact.high)


@compiled
def forget(m: Model, k: int) -> None:
    """Empty the candidates of a history that is about another pair, or none: nothing of it is joined."""
    contact = m.work.contact[k]
    contact.known = contact.count = contact.joined = contact.started = 0


@compiled_once(POPULATION)
def choose(m: Model, k: int, flank: int, pair: int, gap: float, low: float, high: float) -> None:
    """Choose the candidates of a pair anew; what is joined stays so.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    flank, pair : int
        Flank and number of the pair.
    gap, low, high : float
        Least gap, and positions along the path between which they are to hold; margins are added.
    """
    contact, index, joined, kept = (
        m.work.contact[k],
        column(m, k, INDEX),
        column(m, k, JOINED),
        column(m, k, REMEMBERED),
    )
    for j in range(contact.joined):
        m.rows[kept + j] = m.rows[index + int(m.rows[joined + j])]
    choose_beside(m, k, flank, pair, gap, low, high)


@compiled
def choose_beside(m: Model, k: int, flank: int, pair: int, gap: float, low: float, high: float) -> None:
    """Candidates where the joined asperities are in the column `REMEMBERED`."""
    contact, scene, kept = m.work.contact[k], m.scene.population, column(m, k, REMEMBERED)
    contact.known, contact.count, contact.gap = 1, 0, gap - GAP_MARGIN
    contact.low, contact.high = low - PLACE_MARGIN, high + PLACE_MARGIN
    least = contact.gap - scene.join  # a candidate is higher
    tooth_flank, merged = flank_of(m, flank, pair), 0
    if scene.highest > least:
        before, after = spot_at(m, contact.low, False), spot_at(m, contact.high, False)
        middle = spot_at(m, 0.5 * (contact.low + contact.high), False)
        half_curvature = 0.5 * scene.steepness / max(before.radius, middle.radius, after.radius)
        reach = math.sqrt((scene.highest - least) / half_curvature)
        level = 0
        while level < len(LEVELS) and least >= LEVELS[level]:
            level += 1
        first = _first_from(m, level, tooth_flank, before.arc - reach)
        end = int(m.tables[scene.starts_at + level * (scene.flanks + 1) + tooth_flank + 1])
        for j in range(first, end):
            asperity = _listed(m, level, j)
            arc = m.tables[scene.arcs_at + asperity]
            if arc > after.arc + reach:
                break
            while merged < contact.joined and m.rows[kept + merged] < asperity:
                _add(m, k, int(m.rows[kept + merged]), 1.0)
                merged += 1
            if merged < contact.joined and m.rows[kept + merged] == asperity:
                _add(m, k, asperity, 1.0)
                merged += 1
            elif _may_join(m, k, asperity, contact.gap, before, after, half_curvature):
                _add(m, k, asperity, -1.0)
    while merged < contact.joined:
        _add(m, k, int(m.rows[kept + merged]), 1.0)
        merged += 1
    list_joined(m, k)


@compiled
def list_joined(m: Model, k: int) -> None:
    """Note which candidates of a history are joined, in the order of positions."""
    contact, sign, joined = m.work.contact[k], column(m, k, SIGN), column(m, k, JOINED)
    contact.joined = 0
    for j in range(contact.count):
        if m.rows[sign + j] > 0.0:
            m.rows[joined + contact.joined] = j
            contact.joined += 1


@compiled(inline=True)
def _listed(m: Model, level: int, j: int) -> int:
    """Index of the j-th asperity of a level among all."""
    return j if level == 0 else int(m.tables[m.scene.population.listed_at + j])


@compiled
def _first_from(m: Model, level: int, flank: int, arc: float) -> int:
    """Return the first asperity of a flank that is listed at a level and not before an arc, by bisection."""
    scene = m.scene.population
    starts = scene.starts_at + level * (scene.flanks + 1) + flank
    low, high = int(m.tables[starts]), int(m.tables[starts + 1])
    while low < high:
        middle = (low + high) // 2
        if m.tables[scene.arcs_at + _listed(m, level, middle)] < arc:
            low = middle + 1
        else:
            high = middle
    return low


@compiled(inline=True)
def _kind(m: Model, k: int, asperity: int) -> int:
    """Where the numbers of an asperity's kind are; in the pair of the k-th history, if the gear's tooth matters."""
    population = m.scene.population
    if population.by_gear_tooth != 0 and not _gear_covered(m, k, asperity):
        return int(m.tables[population.bare_kinds_at + asperity])
    return int(m.tables[population.kinds_at + asperity])


@compiled
def _gear_covered(m: Model, k: int, asperity: int) -> bool:
    """Whether an asperity meets a covered part of the gear's tooth in the pair of the k-th history."""
    population, flank = m.scene.population, flank_of_history(m, k)
    position = position_of_arc(m, m.tables[population.arcs_at + asperity])
    fraction = fraction_of(m, 1, flank, m.state.history[k].pair, position).value
    return bool(m.tables[population.gear_numbers_at + asperity] < fraction)


@compiled(inline=True)
def _may_join(
    m: Model, k: int, asperity: int, gap: float, before: Spot, after: Spot, half_curvature: float
) -> bool:
    """Whether a free asperity may join at a gap or a wider one, while the contact is between two spots."""
    arc, kind = m.tables[m.scene.population.arcs_at + asperity], _kind(m, k, asperity)
    x = max(before.arc - arc, arc - after.arc, 0.0)
    height = m.tables[m.scene.population.heights_at + asperity] - m.tables[kind + K_OFFSET]
    return bool(height - gap - half_curvature * x * x + m.tables[kind + K_JOIN] > 0.0)


@compiled
def _add(m: Model, k: int, asperity: int, sign: float) -> None:
    """Add an asperity to the candidates of a history, joined or free by its sign."""
    scene, contact = m.scene.population, m.work.contact[k]
    j, kind = contact.count, _kind(m, k, asperity)
    m.rows[column(m, k, INDEX) + j] = asperity
    m.rows[column(m, k, ARC) + j] = m.tables[scene.arcs_at + asperity]
    m.rows[column(m, k, HEIGHT) + j] = m.tables[scene.heights_at + asperity] - m.tables[kind + K_OFFSET]
    m.rows[column(m, k, KIND) + j] = kind
    m.rows[column(m, k, SIGN) + j] = sign
    m.rows[column(m, k, BOUND) + j] = m.tables[kind + (K_DETACH if sign > 0.0 else K_JOIN)]
    contact.count += 1
