r"""Order and step length of Adams' formulas, and when IDA's own are better.

IDA compares the difference from its own prediction with the tolerance. This is not the error of an Adams formula, so
IDA is kept at order one and the weights of its norm are scaled. The formula of order k differs from that of order k - 1
by e_k, which is the error of the latter (Shampine and Gordon, Computer Solution of Ordinary Differential Equations,
1975). With E some times e_k over the tolerance, the weights are scaled so that IDA rejects the step where E > 1, and
finds the next step longer by :math:`(2 E)^{-1/(k+1)}` where it does not.

The order follows the least e_k: one less if that does better, one more if that would, and after a rejected step,
where the force may have had a kink, the best of the lower orders.

Orders six and seven amplify a vibration, by some millionths a step, and orders four and five damp it by as little. The
error of a large vibration is the same either way; a small one that grows would never come to rest, so it is given to
the latter.

No step is longer than its excitation allows, about a sixth of a period of torques and mesh: seen at steps as long as
periods, an excitation looks like none, and the estimate of the error does not notice. Nor is it longer than the load
of a hub allows that passes beside zero: see `gearidae.engine.friction.forces.load_pace`.

IDA's own formulas are used in three cases: steps that are long against the fastest vibration, for which the Adams
formulas are unstable; tolerances close to rounding, which affects the difference of two states that IDA's formulas do
not contain; and vibrations with an amplitude near the tolerance, which would change the histories without end and are
damped by IDA's formulas. Each change of formulas is a restart.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine import adams
from gearidae.engine.friction.forces import load_pace
from gearidae.engine.friction.hubs import has_hubs
from gearidae.engine.model.state import COAST, DRIVE, LOAD, MOST_ORDERS, PHASE, Floats, Model, Record, U, V, W
from gearidae.engine.pairs.tooth_pairs import in_flight, nearest_gap, rigid_separation
from gearidae.engine.sundials import names as sun

SAFETY: Final = 5.0  # E over e_k; the error of a run then is some tens of tolerances
# Squared step times squared frequency, up to which orders six or less, seven and eight are stable with some margin.
STABLE: Final = 0.64
STABLE_7: Final = 0.3
STABLE_8: Final = 0.1
MAX_DAMPED_ORDER: Final = 5
HIGH_AMPLITUDE: Final = 1e3  # over the tolerance: above it every order is allowed
LOW_AMPLITUDE: Final = 10.0  # over the tolerance: below it IDA's own formulas are used
HIGHEST_RESOLUTION: Final = 0.2 / float(np.finfo(float).eps)  # a state over its tolerance
STABILITY_LIMIT_RATIO: Final = (
    4.0  # how much longer a step could be, for its error, that stability limits too much
)
SWITCH_STEPS: Final = 20  # steps until formulas are changed
# Where the load of a hub turns round beside zero, errors are as large as the tolerance and have one sign, passage after
# passage: 4.5 bounds of the balance in 2,000 of them. With both, 0.5 at most, at no more steps than a restart at each
# passage takes. Either alone leaves 1.3 to 3.8.
TURNS_LOAD: Final = 0.5  # longest step, over the time in which the load changes by itself
TURNS_SLOWLY: Final = 0.25  # longest step, over that time, whose error counts as elsewhere
ONE_WAY: Final = 10.0  # by how much the errors of longer ones count more
# By how much steps grow at least, or else stay, and at most, and most of all from a start.
GROW: Final = 1.5  # fewer steps than with IDA's 2, at the same error
GROW_MOST: Final = 2.0
GROW_START: Final = 8.0
GROW_IDA: Final = 2.0  # both, of IDA's own steps
IDA_ORDER: Final = 5
OVERSHOOT: Final = 0.5  # how far below the lowest gap a step may end
MOST: Final = SAFETY**-2  # squared error of the lower order
LEAST_CUT: Final = 0.9  # IDA's own, where it shortens a step at all
# Squares of twice the error between which a step is kept or cut by that, by order.
KEPT: Final = tuple(GROW ** (-2.0 * (order + 1.0)) for order in range(MOST_ORDERS + 1))
EASED: Final = tuple(LEAST_CUT ** (-2.0 * (order + 1.0)) for order in range(MOST_ORDERS + 1))


@compiled
def configure_ida(solver: int, m: Model) -> int:
    """Set IDA's limits of order and step growth for the formulas in use; return 0 on success.

    A step longer than those before it together may pass over a whole sector of a law that says nothing of its jumps,
    and begin and end in two others that are alike.
    """
    by_adams = m.work.adams.used != 0
    unknown = m.scene.torque[DRIVE].law_unknown != 0 or m.scene.torque[LOAD].law_unknown != 0
    flag = sun.IDASetMaxOrd(solver, 1 if by_adams else IDA_ORDER)
    flag |= sun.IDASetEtaFixedStepBounds(solver, 1.0, GROW if by_adams else GROW_IDA)
    flag |= sun.IDASetEtaMax(solver, GROW_START if by_adams and not unknown else GROW_IDA)
    return flag


@compiled(inline=True)
def max_stable_order(a: Record, h: float) -> int:
    """Highest stable order for a step of length h, at most the order wanted."""
    if a.amplitude_sq < HIGH_AMPLITUDE**2:
        return min(a.next_order, MAX_DAMPED_ORDER)
    turned = h * h * a.omega_sq
    most = 8 if turned <= STABLE_8 else 7 if turned <= STABLE_7 else 6
    return min(a.next_order, most)


@compiled(inline=True)
def below_gap_bound(m: Model, a: Record) -> bool:
    """Whether a step would end far below the lowest gap of the model's range, where forces are extrapolated."""
    bound, y = m.scene.lowest_gap - OVERSHOOT, a.new_state
    if min(nearest_gap(m, DRIVE, y), nearest_gap(m, COAST, y)) >= bound:
        return False
    return bool(rigid_separation(m, y[U], y[PHASE]) < bound)


@compiled(inline=True)
def _shorter(twice: float, order: int, least: float) -> float:
    """Squared factor to shorten the next step by, no less than `least`, for the square of twice the error."""
    # as good as any by which IDA keeps the step, or makes it a tenth shorter
    if KEPT[order] < twice < EASED[order]:
        return max(0.8 if twice < 1.0 else 1.2, least)
    if twice <= least ** (order + 1):
        return least
    return float(twice ** (1.0 / (order + 1.0)))


@compiled(inline=True)
def _best(n: int, a: Record, h: float, error: float, weights: Floats) -> tuple[int, float]:
    """Order after a step of this squared error, and the squared error expected of that."""
    used, known = a.order_used, a.n_history
    best, least = used, error
    if error > MOST:
        for order in range(1, used):
            other = adams.order_error_sq(n, a, h, order, weights)
            if other < least:
                best, least = order, other
        return best, least
    lower = adams.order_error_sq(n, a, h, used - 1, weights) if used > 1 else math.inf
    if lower <= error:
        return used - 1, lower
    if used == known:  # nothing says that it would be worse
        return min(used + 1, MOST_ORDERS), error
    if used < MOST_ORDERS:
        upper = adams.order_error_sq(n, a, h, used + 1, weights)
        if upper < error:
            return used + 1, upper
    return used, error


@compiled(inline=True)
def _excitation(m: Model) -> float:
    """Angular frequency of the fastest torque, or of the mesh where a pair may touch; no step turns it by more."""
    flying = in_flight(m)
    if flying and m.scene.angle_omega == 0.0:
        return float(m.scene.torque_omega)
    per_pitch = m.scene.angle_omega if flying else max(m.scene.mesh_omega, m.scene.angle_omega)
    along = per_pitch * m.scene.phase_rate * abs(m.work.adams.new_state[W])
    return float(max(m.scene.torque_omega, along))


@compiled(inline=True)
def control_step(n: int, m: Model, h: float, correction: Floats, weights: Floats) -> None:
    """Choose the next order, and the weights by which IDA judges this step and chooses the next one.

    Parameters
    ----------
    n : int
        States.
    m : Model
        With the new state and rates in ``m.work.adams``.
    h : float
        Length of the step, over tau.
    correction : ndarray, shape (n,)
        What IDA compares with the tolerance.
    weights : ndarray, shape (n,)
        One over the tolerances; changed.
    """
    a, fastest = m.work.adams, _excitation(m)
    if has_hubs(m):
        first = m.scene.error_weights_at
        pace = load_pace(m, max(m.rows[first + V], m.rows[first + W]))
        fastest = max(fastest, pace / TURNS_LOAD)
        if h * pace > TURNS_SLOWLY:
            for j in range(n):
                weights[j] *= ONE_WAY
    adams.set_differences(a, h)
    used = a.order_used
    error = adams.order_error_sq(n, a, h, used, weights)
    best, least = _best(n, a, h, error, weights)
    a.next_order = best
    a.attempts += 1
    order = min(best, used)
    unstable = h * h * a.omega_sq / STABLE
    twice = 4.0 * least / MOST  # squared, over the greatest error allowed
    limited = twice < (unstable / STABILITY_LIMIT_RATIO**2) ** (order + 1)
    a.limited_steps = a.limited_steps + 1 if limited and unstable * GROW**2 > 1.0 else 0
    most = GROW_START if a.n_history == used else GROW_MOST
    bound = max(most**-2.0, unstable, (h * fastest) ** 2)
    shorter = _shorter(twice, order, bound)
    wanted = max(0.5 * shorter, 1.05) if error > MOST else min(0.5 * shorter, 0.99)
    total = adams.weighed_squares(n, correction, weights)
    if total > 0.0:
        # IDA's estimate at order one is the norm of the correction, times this step's share of the last two
        last = h if a.n_history == 1 else a.last_step
        scale = wanted * (h + last) / (h * math.sqrt(total / n))
        for j in range(n):
            weights[j] *= scale


@compiled(inline=True)
def change_wanted(m: Model, y: Floats, yp: Floats) -> bool:
    """Whether the other formulas would be better from here on; note it for the next start.

    Parameters
    ----------
    y, yp : ndarray, shape (n,)
        State and rates at an accepted time.
    """
    a, first = m.work.adams, m.scene.error_weights_at
    if a.native_newton == 0:
        return False
    resolution = 0.0
    for j in range(y.size):
        resolution = max(resolution, abs(y[j]) * m.rows[first + j])
    amplitude_sq = math.inf
    if a.omega_sq > 0.0:
        amplitude_sq = (y[V] ** 2 + yp[V] ** 2 / a.omega_sq) * m.rows[first + V] ** 2
    a.amplitude_sq = amplitude_sq
    if a.used != 0:
        change = (
            amplitude_sq < LOW_AMPLITUDE**2
            or resolution > HIGHEST_RESOLUTION
            or a.limited_steps > SWITCH_STEPS
        )
        a.wanted = 0 if change else 1
        return change
    change = (
        amplitude_sq > (2.0 * LOW_AMPLITUDE) ** 2
        and resolution < 0.5 * HIGHEST_RESOLUTION
        and a.last_step**2 * a.omega_sq < 0.25 * STABLE
        and a.attempts > SWITCH_STEPS
    )
    a.wanted = 1 if change else 0
    return change
