r"""What the flanks are exposed to, tooth by tooth and bin by bin, kept at the solver's own steps.

For both flanks of every tooth of the pinion and every bin along the path of contact four sums are kept, in `rows`:

- asperities that have come into contact, :math:`\int \ell\, d\Psi` for each material. What a contact has joined at an
  accepted time is :math:`\Psi(\zeta)`, with the play operator's joined height :math:`\zeta` there; all turning points
  are accepted times, so that nothing is missed between them;
- the energy that they have lost by it, in the proportion of the energy balance (where shares change with tooth and
  bin, as if the material covered everything);
- sliding work :math:`\int W |v_s| dt` of contacts that push, :math:`v_s` being the sum of both gears' angular speeds
  times the distance from the pitch point. It is integrated over one to six steps at once
  (`gearidae.engine.observers.exposures.sliding`), and to every onset and separation;
- the largest pressure, :math:`W / (L \sqrt{2 R \sigma})`, at the same times, at turning points, and where a contact
  passes from one bin to the next.

An elastic contact is looked at as often as the energy balance closes an interval. Where a contact passes from one bin
to the next in such an interval, what it has joined is divided by its gap there, on the cubic of the gap; of elastic
contacts, and of sliding work, in proportion to the way. Contacts on the tip relief count at the end of the path.

Asperities of a population are counted one by one, each in its own bin (`contacts.add_asperity_switches`); sliding
work and pressure are those of the whole pair, where it touches. The work of friction is a fifth sum, of flanks that
have friction (module `friction_work` of this package).
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import EXPOSURES
from gearidae.engine.events.pair_events import PairEvent
from gearidae.engine.laws.pairs import force_of_pair
from gearidae.engine.model.state import MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.observers.exposures.bins import bin_at, row_of, way_to_edge
from gearidae.engine.observers.exposures.contacts import (
    adds_often,
    begin_contacts,
    join,
    joins,
    joins_here,
    note_pressure,
    see_pressure,
    turn_to_closing,
)
from gearidae.engine.observers.exposures.sliding import (
    add_sliding,
    begin_intervals,
    choose_pressure_step,
    next_interval,
    sliding_speeds,
    start_with_one_step,
    time_to_zero,
)
from gearidae.engine.pairs.coverage import path_position
from gearidae.engine.pairs.tooth_pairs import PairState, flank_of_history, pair_gap


@compiled_once(EXPOSURES)
def begin(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Note what is in contact at a start; nothing is exposed yet."""
    m.work.exposing.time, m.work.exposing.begun = t, 1
    m.work.exposing.often = 1 if adds_often(m) else 0
    begin_intervals(m)
    for k in range(m.scene.histories):
        m.work.exposing.pair[k].known = 0
    forces_at(m, t, y)
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        k = noted.history
        if m.state.history[k].pair != noted.pair:
            continue
        _begin_pair(m, t, k, noted.pair, noted.position)
        begin_contacts(m, y, k, noted.position, noted.gap)
        sliding = sliding_speeds(m, y, yp[V], yp[W])
        push = noted.force, noted.slope * noted.gap_rate + noted.drift
        add_sliding(m, t, k, sliding, noted.position, (noted.gap, noted.gap_rate), push)
        see_pressure(m, t, k, noted.position, push)


@compiled_once(EXPOSURES)
def _follow(m: Model, t: float, y: Floats, yp: Floats, whole: bool) -> None:
    """Add what the flanks have been exposed to since the last call, up to an accepted time.

    Parameters
    ----------
    m : Model
        With the histories before the event at this time, if there is one.
    t : float
        Time over tau.
    y, yp : ndarray
        State there and its rate.
    whole : bool
        Whether the contacts of pairs that are closing are added, too, for somebody who looks or a restart.
    """
    exposing = m.work.exposing
    if exposing.begun == 0 or (t <= exposing.time and not whole):
        return
    forces_at(m, t, y)
    sliding = sliding_speeds(m, y, yp[V], yp[W])
    to_zero, way = math.inf, math.inf
    ends = whole or m.scene.nodes > 0 or exposing.steps >= exposing.steps_per_interval
    for i in range(m.work.pair_forces.count):
        noted = m.work.pair_forces.pair[i]
        k = noted.history
        if m.state.history[k].pair != noted.pair:
            continue
        _begin_new(m, k, noted.pair, noted.position)
        gap, push, rate = noted.gap, noted.force, noted.slope * noted.gap_rate + noted.drift
        if ends:
            if joins_here(m, k, noted.position, gap) or (whole and m.state.history[k].direction <= 0.0):
                join(m, t, y, k, noted.position, (gap, noted.gap_rate))
            add_sliding(m, t, k, sliding, noted.position, (gap, noted.gap_rate), (push, rate))
            to_zero = min(to_zero, time_to_zero(m, k, push, rate))
        see_pressure(m, t, k, noted.position, (push, rate))
        if push > 0.0:
            way = min(way, way_to_edge(m, k, noted.position, sliding[2]))
    if ends:
        exposing.time = t
        next_interval(m, to_zero, sliding[2])
    choose_pressure_step(m, way, sliding[2])


@compiled(inline=True)
def step(m: Model, t: float, y: Floats, yp: Floats, root: bool, closed: bool) -> None:
    """Count an accepted step, and follow the exposures where that is wanted after it.

    Forces of elastic contacts have to be evaluated for it: that is done where the energy balance has `closed` an
    interval.
    """
    exposing = m.work.exposing
    if m.scene.nodes > 0:
        if closed:
            _follow(m, t, y, yp, False)
    elif root and m.scene.population.flanks != 0:  # forces may jump here
        _follow(m, t, y, yp, True)
    elif not root:
        exposing.steps += 1
        if exposing.steps >= exposing.wanted:
            _follow(m, t, y, yp, False)


@compiled(inline=True)
def event(m: Model, t: float, y: Floats, yp: Floats, event: PairEvent) -> None:
    """Add what a contact has been exposed to up to an event, before its history takes that.

    Most turning points add nothing. That is found out in the caller's code.
    """
    if m.work.exposing.begun == 0:
        return
    flank, pair, k, gap = event.flank, event.pair, event.k, event.gap
    if event.touches:
        _touch(m, t, y, yp, flank, pair, k)
    if not event.turns:
        return
    exposure = m.work.exposing.pair[k]
    if m.state.history[k].direction < 0.0:
        inside = path_position(m, flank, pair, y[PHASE])
        if (
            gap < exposure.lowest
            or bin_at(m, inside) != exposure.seen_bin
            or m.scene.nodes > 0
            or joins(m, k, gap)
        ):
            _close(m, t, y, yp, flank, pair, k, gap)
    elif m.work.exposing.often == 0:
        exposure.turned = 1
    else:
        _open(m, y, flank, pair, k, gap)


@compiled
def finish(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Bring all sums up to an accepted time, of contacts that are closing, too."""
    _follow(m, t, y, yp, True)


@compiled_once(EXPOSURES)
def _open(m: Model, y: Floats, flank: int, pair: int, k: int, gap: float) -> None:
    """Note a contact that begins to close, whose contacts are added up often."""
    _begin_new(m, k, pair, path_position(m, flank, pair, y[PHASE]))
    turn_to_closing(m, y, k, gap)


@compiled_once(EXPOSURES)
def _close(m: Model, t: float, y: Floats, yp: Floats, flank: int, pair: int, k: int, gap: float) -> None:
    """Add what a contact that ceases to close has been exposed to: the pressure is largest where the gap is least."""
    exposure, inside = m.work.exposing.pair[k], path_position(m, flank, pair, y[PHASE])
    _begin_new(m, k, pair, inside)
    if joins(m, k, gap):
        join(m, t, y, k, inside, (gap, 0.0))
    here, elastic = bin_at(m, inside), m.scene.nodes > 0
    if elastic or gap < exposure.lowest or here != exposure.seen_bin:
        exposure.lowest = min(exposure.lowest, gap)
        force, _ = _force(m, t, y, (flank, pair, k), (gap, 0.0, inside))
        if elastic:  # the slope of the force has a jump here
            add_sliding(m, t, k, sliding_speeds(m, y, yp[V], yp[W]), inside, (gap, 0.0), (force, 0.0))
            see_pressure(m, t, k, inside, (force, 0.0))
        elif force > 0.0:
            note_pressure(m, k, here, inside, force)


@compiled_once(EXPOSURES)
def _touch(m: Model, t: float, y: Floats, yp: Floats, flank: int, pair: int, k: int) -> None:
    """Add what a contact has been exposed to up to its onset or separation, and take single steps from there."""
    gap, rate, _, inside = pair_gap(m, flank, pair, y[U], y[V], y[PHASE], y[W])
    _begin_new(m, k, pair, inside)
    if joins_here(m, k, inside, gap):
        join(m, t, y, k, inside, (gap, rate))
    force, slope = _force(m, t, y, (flank, pair, k), (gap, rate, inside))
    add_sliding(m, t, k, sliding_speeds(m, y, yp[V], yp[W]), inside, (gap, rate), (force, slope * rate))
    see_pressure(m, t, k, inside, (force, slope * rate))
    start_with_one_step(m)


@compiled(inline=True)
def _begin_new(m: Model, k: int, pair: int, inside: float) -> None:
    """Begin with a pair that has come near since the exposures of all pairs were last added up."""
    exposure, before = m.work.exposing.pair[k], m.work.exposing.time
    if exposure.known == 0 or exposure.pair != pair or exposure.time < before:
        _begin_pair(m, before, k, pair, inside)


@compiled
def _begin_pair(m: Model, t: float, k: int, pair: int, inside: float) -> None:
    """Begin with a pair in which nothing is in contact."""
    exposure = m.work.exposing.pair[k]
    exposure.known, exposure.pair, exposure.time = 1, pair, t
    exposure.position, exposure.bin = inside, bin_at(m, inside)
    exposure.seen_time, exposure.seen_position, exposure.seen_bin = t, exposure.position, exposure.bin
    exposure.turned, exposure.pulls, exposure.lowest = 0, 0, m.scene.cutoff
    exposure.power = exposure.power_rate = exposure.force = exposure.force_rate = exposure.gap_rate = 0.0
    exposure.gap, exposure.side = m.scene.cutoff, 1
    for material in range(MATERIALS):
        exposure.front[material] = exposure.added[material] = 0.0
    exposure.row = row_of(m, flank_of_history(m, k), pair)


@compiled
def _force(
    m: Model, t: float, y: Floats, which: tuple[int, int, int], there: tuple[float, float, float]
) -> tuple[float, float]:
    """Force of a pair, given by flank, number and history, with a gap, a gap rate and a position; slope in the gap."""
    (flank, number, k), (gap, rate, inside) = which, there
    pair = PairState(flank, number, k, True, gap, rate, 0.0, inside, 0.0, False)
    force = force_of_pair(m, t, y, pair, False)
    return force.load, force.by_gap
