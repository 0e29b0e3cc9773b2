r"""The energy that asperities lose by joining, recorded at the turning point of a closing contact.

Per length a closing contact loses :math:`q = |E(0)|\,(\Psi(g) - \Psi(\zeta))`, in closed form; but while it closes its
length changes along the path of contact, so that it loses

.. math:: \int \ell\, dq = \ell q - \int q \dot\ell\, dt .

The last integral, the lag, is followed from step to step. The work of the changing radius is less by the same: it has
been worked out as if nothing were lost until the turning point (`gearidae.engine.followers.balance`).
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.contact.kernels.law import loading_value
from gearidae.engine.compiling import SOLVER
from gearidae.engine.elastic.energy import nodes_joining_loss
from gearidae.engine.energy.contacts import joining_loss
from gearidae.engine.energy.coverage import losses_by_material
from gearidae.engine.formulas.quadrature import integral
from gearidae.engine.model.state import GEARS, MATERIALS, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.coverage import WHOLE, note_shares, path_position, shares_of
from gearidae.engine.pairs.lengths import length_and_rates, material_lengths
from gearidae.engine.pairs.tooth_pairs import contact_length, history_of, pair_gap, pairs_on_path

__all__ = ["begin", "event", "joining_lag", "resume", "step"]


@compiled(inline=True)
def begin(m: Model, t: float) -> None:
    """Begin to follow the lags at a start."""
    m.work.lag_time = t


@compiled(inline=True)
def step(m: Model, t: float, y: Floats, w_rate: float) -> None:
    """Follow the lags of closing gear contacts to an accepted time.

    Parameters
    ----------
    m : Model
        With its mesh marks as they were in the step.
    t : float
        Time over tau.
    y : ndarray
        State there.
    w_rate : float
        Acceleration of the gear's surface there.
    """
    h = t - m.work.lag_time
    if m.scene.kind == GEARS and h > 0.0:
        m.work.lag_time = t
        for coast in range(2):
            if m.state.near[coast] != 0:
                _follow_flank(m, coast, h, y, w_rate)


@compiled_once(SOLVER)
def event(m: Model, y: Floats, coast: int, pair: int, k: int, gap: float) -> None:
    """Add the adhesion loss of a pair's asperities, before the turning point of a closing contact is noted."""
    if m.state.history[k].direction > 0.0:
        return
    length = 1.0
    if m.scene.kind == GEARS:
        length = contact_length(m, pair_gap(m, coast, pair, y[U], y[V], y[PHASE], y[W])[3])
        lag = m.state.history[k].lag
        m.state.energy.adhesion_loss -= lag
        if m.scene.radius_force == 0:
            m.state.energy.radius_work -= lag
    if m.scene.nodes > 0:
        if m.scene.by_place != 0:
            note_shares(m, k, coast, pair, path_position(m, coast, pair, y[PHASE]))
        m.state.energy.adhesion_loss += length * nodes_joining_loss(m, k, y, gap)
        return
    shares = WHOLE
    if m.scene.by_place != 0:
        shares = shares_of(m, k, coast, pair, path_position(m, coast, pair, y[PHASE]))
    loss = joining_loss(m, k, gap, shares)
    m.state.energy.adhesion_loss += length * loss
    if m.scene.kind != GEARS or m.scene.radius_force != 0:
        return
    if m.scene.by_place != 0:
        _book_materials_before(m, coast, pair, k, y, gap)
    else:
        _book_before(m, coast, pair, loss, length)


@compiled
def resume(m: Model, y: Floats) -> None:
    """Look again at the rates of the lags, which jump at a mesh mark."""
    for coast in range(2):
        if m.state.near[coast] != 0:
            _follow_flank(m, coast, 0.0, y, m.work.quadrature.gear_acceleration)


@compiled
def _book_before(m: Model, coast: int, pair: int, loss: float, length: float) -> None:
    """Keep the power of the changing radius continuous where an adhesion loss per length has been added.

    From then on it lacks the loss times the rate of the length. It is taken out where the quadrature began, too, and
    what that leaves out until now is the loss times what the length has changed by.
    """
    first, last = pairs_on_path(m, coast)
    if m.state.near[coast] == 0 or not first <= pair <= last:
        return
    q = m.work.quadrature
    before = q.gear_travel * m.scene.phase_rate
    was, rate, bend = length_and_rates(m, coast, pair, before, q.gear_speed, q.gear_acceleration)
    q.radius_power -= loss * rate
    q.radius_power_rate -= loss * bend
    q.length_work += loss * (length - was)


@compiled_once(SOLVER)
def _book_materials_before(m: Model, coast: int, pair: int, k: int, y: Floats, gap: float) -> None:
    """Do the same for each material of a pair whose shares change along the path."""
    first, last = pairs_on_path(m, coast)
    if m.state.near[coast] == 0 or not first <= pair <= last:
        return
    q = m.work.quadrature
    before = q.gear_travel * m.scene.phase_rate
    was, rates, bends = material_lengths(m, k, coast, pair, before, q.gear_speed, q.gear_acceleration)
    now = material_lengths(m, k, coast, pair, y[PHASE], 0.0, 0.0)[0]
    losses = losses_by_material(m, k, y, gap)[0]
    for material in range(MATERIALS):
        q.radius_power -= losses[material] * rates[material]
        q.radius_power_rate -= losses[material] * bends[material]
        q.length_work += losses[material] * (now[material] - was[material])


@compiled
def _follow_flank(m: Model, coast: int, h: float, y: Floats, w_rate: float) -> None:
    """Follow the lags of a flank whose contacts close."""
    sign = 1.0 - 2.0 * coast
    gap = m.scene.half_backlash - sign * y[U]
    if gap >= m.scene.cutoff:
        return
    first, last = pairs_on_path(m, coast)
    for pair in range(first, last + 1):
        k = history_of(m, coast, pair)
        own = m.state.history[k]
        if own.pair != pair or own.direction >= 0.0:
            continue
        power = rate = 0.0
        if m.scene.by_place != 0:
            power, rate = _material_lags(m, coast, pair, k, gap, y, w_rate)
            own.lag += integral(h, own.lag_power, power, own.lag_rate, rate)
            own.lag_power, own.lag_rate = power, rate
            continue
        loss, loss_slope = _loss(m, k, y, gap)
        if loss != 0.0:
            _, stretch, bend = length_and_rates(m, coast, pair, y[PHASE], y[W], w_rate)
            power, rate = loss * stretch, loss * bend - loss_slope * sign * y[V] * stretch
        own.lag += integral(h, own.lag_power, power, own.lag_rate, rate)
        own.lag_power, own.lag_rate = power, rate


@compiled_once(SOLVER)
def _material_lags(
    m: Model, coast: int, pair: int, k: int, gap: float, y: Floats, w_rate: float
) -> tuple[float, float]:
    """Rate of the lag of a pair whose shares change along the path, and the rate of that."""
    power = rate = 0.0
    losses, slopes = losses_by_material(m, k, y, gap)
    if losses[0] == 0.0 and losses[1] == 0.0 and losses[2] == 0.0:
        return 0.0, 0.0
    _, stretches, bends = material_lengths(m, k, coast, pair, y[PHASE], y[W], w_rate)
    closing = (1.0 - 2.0 * coast) * y[V]
    for material in range(MATERIALS):
        power += losses[material] * stretches[material]
        rate += losses[material] * bends[material] - slopes[material] * closing * stretches[material]
    return power, rate


@compiled
def _loss(m: Model, k: int, y: Floats, gap: float) -> tuple[float, float]:
    """What a pair has lost per length since its last turning point, and its slope in the gap.

    Of an elastic contact the slope is that of a rigid one in proportion.
    """
    loss = change = lost = 0.0
    for material in range(MATERIALS):
        own = m.scene.material[material]
        if own.stretch_limit > 0.0 and (m.scene.nodes > 0 or gap < m.state.history[k].joined[material]):
            number, slope = loading_value(m.tables, own.number_at, gap + own.gap_offset)
            joining = own.joining_energy * own.force_scale
            lost += joining * number
            loss += joining * number + own.force_scale * m.state.history[k].adhered_energy[material]
            change += joining * slope
    if m.scene.nodes > 0:
        loss = nodes_joining_loss(m, k, y, gap)
        return loss, (loss * change / lost if lost > 0.0 else 0.0)
    return loss, change


@compiled
def joining_lag(m: Model) -> float:
    """Sum of the lags of all contacts that close."""
    lag = 0.0
    for k in range(m.scene.histories):
        lag += m.state.history[k].lag
    return lag
