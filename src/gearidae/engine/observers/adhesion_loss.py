r"""The energy that asperities lose by joining, recorded at the turning point of a closing contact.

Per length a closing contact loses :math:`q = |E(0)|\,(\Psi(g) - \Psi(\zeta))`, in closed form; but while it closes its
length changes along the path of contact, so that it loses

.. math:: \int \ell\, dq = \ell q - \int q \dot\ell\, dt .

The last integral, the lag, is followed over the intervals of the balance's quadrature, and up to the turning point.
The work of the changing radius is less by the same: it has been worked out as if nothing were lost until the turning
point (`gearidae.engine.observers.balance`). So what the lag is out by is a work of the radius that is booked as a loss,
and leaves no residual.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.laws.pairs import joining_losses
from gearidae.engine.model.state import PHASE, Floats, Model, V, W
from gearidae.engine.pairs.coverage import NONE, Shares, path_position, shares_of, weighed
from gearidae.engine.pairs.lengths import weighed_length
from gearidae.engine.pairs.orbit import opening_of
from gearidae.engine.pairs.tooth_pairs import (
    contact_length,
    flank_of_history,
    is_on_path,
    list_known,
    pairs_on_path,
    path_gap,
)
from gearidae.formulas.quadrature import integral
from gearidae.laws.pair_law import in_reach


@compiled(inline=True)
def begin(m: Model, t: float) -> None:
    """Begin to follow the lags at a start."""
    m.work.adhesion_lag_time = t


@compiled
def step(m: Model, t: float, y: Floats, w_rate: float) -> None:
    """Follow the lags of closing contacts to an accepted time, if they have not been yet.

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
    h = t - m.work.adhesion_lag_time
    if h > 0.0:
        m.work.adhesion_lag_time = t
        _follow_pairs(m, h, y, w_rate)


@compiled_once(SOLVER)
def event(m: Model, t: float, y: Floats, w_rate: float, flank: int, pair: int, k: int, gap: float) -> None:
    """Add the adhesion loss of a pair's asperities, before the turning point of a closing contact is noted.

    Parameters
    ----------
    m, t, y, w_rate
        As for `step`.
    flank, pair, k : int
        Flank and number of the pair, and index of its history.
    gap : float
        Of the pair.
    """
    if m.state.history[k].direction > 0.0:
        return
    e, (losses, slopes) = m.state.energy, joining_losses(m, k, y, gap)
    if is_on_path(m, flank, pair):
        _follow_lag(m, k, flank, t - m.work.adhesion_lag_time, y, w_rate, losses, slopes)
    adhesion_lag, inside = m.state.history[k].adhesion_lag, path_position(m, flank, pair, y[PHASE])
    e.adhesion_loss += (
        contact_length(m, inside) * weighed(shares_of(m, flank, pair, inside), losses) - adhesion_lag
    )
    if m.scene.curvature_force == 0:
        e.radius_work -= adhesion_lag
        if m.scene.nodes == 0:
            _accumulate_before(m, flank, pair, y[PHASE], losses)


@compiled
def _accumulate_before(m: Model, flank: int, pair: int, phase: float, losses: Shares) -> None:
    """Keep the power of the changing radius continuous where adhesion losses per length have been added.

    From then on it lacks the losses times the rates of the lengths. They are taken out where the quadrature began, too,
    and what that leaves out until now is the losses times what the lengths have changed by.
    """
    first, last = pairs_on_path(m, flank)
    if m.state.flank_in_reach[flank] == 0 or not first <= pair <= last:
        return
    q = m.work.quadrature
    before = q.gear_travel * m.scene.phase_rate
    then = weighed_length(m, (flank, pair, before), q.gear_speed, q.gear_acceleration, losses, NONE)
    q.radius_power -= then.rate
    q.radius_power_rate -= then.second_rate
    now = weighed_length(m, (flank, pair, phase), 0.0, 0.0, losses, NONE)
    q.length_work += now.length - then.length


@compiled
def resume(m: Model, y: Floats) -> None:
    """Look again at the rates of the lags, which jump at a mesh mark."""
    _follow_pairs(m, 0.0, y, m.work.quadrature.gear_acceleration)


@compiled
def _follow_pairs(m: Model, span: float, y: Floats, w_rate: float) -> None:
    """Follow the lags of contacts that close over a span of time."""
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        flank, h = flank_of_history(m, k), m.state.history[k]
        gap = path_gap(m, flank, h.pair, y)
        if h.direction >= 0.0 or not in_reach(m, gap) or not is_on_path(m, flank, h.pair):
            continue
        losses, slopes = joining_losses(m, k, y, gap)
        _follow_lag(m, k, flank, span, y, w_rate, losses, slopes)


@compiled(inline=True)
def _follow_lag(
    m: Model, k: int, flank: int, span: float, y: Floats, w_rate: float, losses: Shares, slopes: Shares
) -> None:
    """Follow the lag of a pair that closes over a span of time, for its losses per length and their slopes there."""
    h, power, rate = m.state.history[k], 0.0, 0.0
    if losses[0] != 0.0 or losses[1] != 0.0 or losses[2] != 0.0:
        loss = weighed_length(m, (flank, h.pair, y[PHASE]), y[W], w_rate, losses, slopes)
        power, rate = loss.rate, loss.second_rate + opening_of(m, flank, y[V]) * loss.by_gap
    h.adhesion_lag += integral(span, h.adhesion_lag_power, power, h.adhesion_lag_power_rate, rate)
    h.adhesion_lag_power, h.adhesion_lag_power_rate = power, rate


@compiled
def total_adhesion_lag(m: Model) -> float:
    """Sum of the lags of all contacts that close."""
    adhesion_lag = 0.0
    for k in range(m.scene.histories):
        adhesion_lag += m.state.history[k].adhesion_lag
    return adhesion_lag
