r"""The table of impacts: a row at each separation of a pair, with what its force has done since the onset.

The force of each pair in contact is evaluated by its laws at every accepted time, with its rate along the motion.
Impulse and work are integrals of the cubics with these values and rates; extremes are those of the cubics. All turning
points of the gap are accepted times, so that no corner of the force lies between two of them. Before an asperity
detaches the rate of its load is infinite: there the parabola with the rate before is taken.

The pair takes :math:`-(W \dot g + P \dot x)` from the motion, W being the force along the line of action, g the gap, P
the force along the path of contact and x the position there. Friction of the flanks is added as the energy balance
integrates it.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from gearidae.compiled import compiled, compiled_once, name_type
from gearidae.engine.compiling import IMPACTS
from gearidae.engine.elastic.static_condensation import following_slope
from gearidae.engine.laws.pairs import force_of_pair
from gearidae.engine.model.record_types import Record
from gearidae.engine.model.state import SLOTS_HIGH, Floats, Model, V, W
from gearidae.engine.pairs.orbit import acceleration_of_gap
from gearidae.engine.pairs.tooth_pairs import (
    contact_length,
    flank_of_history,
    history_of,
    in_flight,
    list_known,
)
from gearidae.engine.population.contact_point import state_of_pair
from gearidae.formulas.interpolation import turning_point
from gearidae.formulas.quadrature import integral
from gearidae.laws.pair_law import in_reach
from gearidae.records import EVENT, EventKind
from gearidae.records.impacts import COLUMNS, IMPACT

IMPACT_NUMBERS: Final = len(IMPACT)
"""Numbers of an impact."""
IMPACTS_AT_ONCE: Final = 2 * SLOTS_HIGH
"""Most that can end at one accepted time."""
_ONSET, _SEPARATION = float(EventKind.ONSET), float(EventKind.SEPARATION)
_FULL_STRETCH: Final = float(EventKind.FULL_STRETCH)
_KIND, _PAIR, _FLANK, _GAP_RATE = EVENT.kind, EVENT.pair, EVENT.flank, EVENT.gap_rate
MET, SEEN = 1, 2
"""Whether a run has met a contact, or has seen its onset."""


class Load(NamedTuple):
    """Force of a pair and the power that it takes from the motion, each with its rate."""

    force: float
    rate: float
    power: float
    power_rate: float


name_type(Load(0.0, 0.0, 0.0, 0.0), "Load")


def units(scene: Record) -> Floats:
    """Units of the columns in SI units, of a scene."""
    return np.array([column.unit.in_si(scene) for column in COLUMNS])


@compiled_once(IMPACTS)
def begin(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note the forces of all contacts at a start; those that are new to the run begin with it."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        if m.state.history[k].in_contact == 0:
            m.state.history[k].impact.begun = 0
            continue
        now = _load_of(m, t, y, yp, k)
        if m.state.history[k].impact.begun == 0:
            _open(m, t, k, MET, 0.0, now.force)
        _note(m, t, k, now)


@compiled(inline=True)
def step(m: Model, t: float, y: Floats, yp: Floats, root: bool) -> None:
    """Follow all contacts to an accepted time, with histories before the events of a root."""
    if not in_flight(m):
        _follow(m, t, y, yp, root)


@compiled_once(IMPACTS)
def _follow(m: Model, t: float, y: Floats, yp: Floats, root: bool) -> None:
    """Add what the force of each contact has done since the accepted time before."""
    steep = root and m.scene.population.flanks != 0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        if m.state.history[k].in_contact == 0:
            continue
        now = _load_of(m, t, y, yp, k)
        if m.state.history[k].impact.begun == 0:  # a pair that has come within reach in contact
            _open(m, t, k, MET, 0.0, now.force)
        else:
            _add(m, t, k, now, steep)
        _note(m, t, k, now)


@compiled
def write_impacts(
    m: Model, t: float, y: Floats, yp: Floats, events: Floats, new: tuple[int, int], rows: Floats, count: int
) -> int:
    """Begin with each onset among the events of an accepted time, write a row for each separation; the number of rows.

    Parameters
    ----------
    m : Model
        Behind all that has happened there.
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there and its rate.
    events : ndarray, shape (n, EVENT_NUMBERS)
    new : tuple of int
        First of these events, and how many events there are.
    rows : ndarray, shape (n, IMPACT_NUMBERS)
        Scaled numbers; drivers keep room for `IMPACTS_AT_ONCE`.
    count : int
        Rows already there.
    """
    jumps = m.scene.nodes > 0 or m.scene.population.flanks != 0
    for i in range(new[0], new[1]):
        kind = events[i, _KIND]
        jumps |= kind in (_FULL_STRETCH, _ONSET)
        if kind == _ONSET:
            _begin_with(m, t, y, yp, events[i])
        elif kind == _SEPARATION and count < rows.shape[0]:
            count += _fill(m, t, events[i], rows[count])
    if jumps:
        _renew(m, t, y, yp)
    return count


@compiled(inline=True)
def _history_of(m: Model, event: Floats) -> int:
    """Index of the history of the pair of an event."""
    return history_of(m, int(event[_FLANK]), int(event[_PAIR] - m.state.whole_pitches))


@compiled_once(IMPACTS)
def _begin_with(m: Model, t: float, y: Floats, yp: Floats, event: Floats) -> None:
    """Begin with the contact of an onset."""
    k, speed = _history_of(m, event), -event[_GAP_RATE] * m.scene.time_unit / m.scene.length_unit
    _open(m, t, k, SEEN, speed, _load_of(m, t, y, yp, k).force)


@compiled_once(IMPACTS)
def _renew(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Look at the forces of all contacts behind events at which they, or their rates, may have jumped."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        if m.state.history[k].impact.begun != 0:
            now = _load_of(m, t, y, yp, k)
            _note_extreme(m, t, k, now.force)
            _note(m, t, k, now)


@compiled_once(IMPACTS)
def _fill(m: Model, t: float, event: Floats, row: Floats) -> int:
    """Write what the contact of a separation has been, and end with it; whether it has been followed."""
    k = _history_of(m, event)
    impact = m.state.history[k].impact
    if impact.begun == 0:
        return 0
    lost, rubbed = impact.energy_lost, impact.friction_loss
    if m.scene.friction.flanks != 0:
        if m.scene.follow.friction == 0:  # nobody has integrated it
            rubbed = math.nan
        lost += rubbed
    row[IMPACT.pair], row[IMPACT.flank] = event[_PAIR], event[_FLANK]
    row[IMPACT.time], row[IMPACT.begin], row[IMPACT.duration] = t, impact.begin, t - impact.begin
    row[IMPACT.approach_speed] = impact.approach_speed if impact.begun == SEEN else math.nan
    row[IMPACT.largest_force], row[IMPACT.smallest_force] = impact.largest_force, impact.smallest_force
    row[IMPACT.largest_force_time], row[IMPACT.impulse] = impact.largest_force_time, impact.impulse
    row[IMPACT.energy_lost], row[IMPACT.friction_loss] = lost, rubbed
    impact.begun = 0
    return 1


@compiled
def _open(m: Model, t: float, k: int, how: int, speed: float, force: float) -> None:
    """Begin with a contact."""
    impact = m.state.history[k].impact
    impact.begun, impact.begin, impact.approach_speed = how, t, speed
    impact.largest_force = impact.smallest_force = force
    impact.largest_force_time = t
    impact.impulse = impact.energy_lost = impact.friction_loss = 0.0


@compiled(inline=True)
def _note(m: Model, t: float, k: int, now: Load) -> None:
    """Note the load of a pair, to go on from."""
    last = m.work.impact[k]
    last.time, last.force, last.force_rate = t, now.force, now.rate
    last.power, last.power_rate = now.power, now.power_rate


@compiled(inline=True)
def _note_extreme(m: Model, t: float, k: int, force: float) -> None:
    """Note a force of a contact where it is an extreme."""
    impact = m.state.history[k].impact
    if force > impact.largest_force:
        impact.largest_force, impact.largest_force_time = force, t
    impact.smallest_force = min(impact.smallest_force, force)


@compiled
def _add(m: Model, t: float, k: int, now: Load, steep: bool) -> None:
    """Add what the load of a pair has done up to a time, whose rate there may be infinite."""
    impact, last = m.state.history[k].impact, m.work.impact[k]
    h, rate, power_rate = t - last.time, now.rate, now.power_rate
    if h <= 0.0:
        return
    if steep:
        rate = 2.0 * (now.force - last.force) / h - last.force_rate
        power_rate = 2.0 * (now.power - last.power) / h - last.power_rate
    impact.impulse += integral(h, last.force, now.force, last.force_rate, rate)
    impact.energy_lost += integral(h, last.power, now.power, last.power_rate, power_rate)
    if last.force_rate * rate < 0.0:
        share, force = turning_point(h, last.force, last.force_rate, now.force, rate)
        _note_extreme(m, last.time + share * h, k, force)
    _note_extreme(m, t, k, now.force)


@compiled_once(IMPACTS)
def _load_of(m: Model, t: float, y: Floats, yp: Floats, k: int) -> Load:
    """Load of the pair that the k-th history is about."""
    flank = flank_of_history(m, k)
    pair = state_of_pair(m, flank, m.state.history[k].pair, y)
    if not in_reach(m, pair.gap):
        return Load(0.0, 0.0, 0.0, 0.0)
    f, sign = force_of_pair(m, t, y, pair, False), 1.0 - 2.0 * flank
    by_gap = f.by_gap
    if m.scene.nodes > 0:
        by_gap += _following(m, k, y, pair.position)
    gap_acceleration = acceleration_of_gap(m, flank, pair.slope, y[W], yp[V], yp[W])
    rate = by_gap * pair.rate + f.by_rate * gap_acceleration + f.by_position * pair.position_rate
    power, power_rate = -f.load * pair.rate, -(rate * pair.rate + f.load * gap_acceleration)
    if f.path != 0.0:
        position_acceleration = sign * m.scene.phase_rate * yp[W] if pair.moves else 0.0
        path_rate = f.path_by_gap * pair.rate + f.path_by_position * pair.position_rate
        power -= f.path * pair.position_rate
        power_rate -= path_rate * pair.position_rate + f.path * position_acceleration
    return Load(f.load, rate, power, power_rate)


@compiled_once(IMPACTS, makes_arrays=True)
def _following(m: Model, k: int, y: Floats, position: float) -> float:
    """By how much the slope of an elastic pair in the gap differs while its deflections follow."""
    return following_slope(m, k, y, contact_length(m, position), np.empty(m.scene.nodes))
