r"""How far Adams' formulas look back, how long their steps are, and when IDA's own are better.

IDA holds the difference to its own prediction against the tolerance. While the formulas are Adams', that says nothing
of their error, so IDA is kept at order one and told by the weights of its norm what to make of it. A formula that looks
back on k rates differs from one of k - 1 by e_k, which is the error of the latter (Shampine and Gordon, Computer
Solution of Ordinary Differential Equations, 1975). With E some times e_k over the tolerance, the weights are scaled so
that IDA rejects the step where E > 1, and finds the next step longer by :math:`(2 E)^{-1/(k+1)}` where it does not.

The order follows the least e_k: one rate fewer if that does better, one more if that would, and after a rejected step,
where the force may have had a kink, whichever of the lower orders does best.

Formulas that look back on six or seven rates swing a vibration up, by some millionths a step, and those with four or
five damp it by as little. The error of a large vibration is the same either way; a small one that grows would never
come to rest, so it is given to the latter.

No step is longer than its excitation allows, about a sixth of a period of torques and mesh: seen at steps as long as
periods, an excitation looks like none, and the estimate of the error is none the wiser.

Three things none of the formulas can do, and there IDA's take over: steps that are long against the fastest vibration,
for which they are not stable; tolerances so close to rounding that the difference of two states, which IDA's do not
take, shows it; and the end of a vibration that is down to the tolerance, whose every swing turns its histories, for
ever, where IDA's formulas damp it away. Either kind begins afresh.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.integrate import adams
from gearidae.engine.model import layout as at
from gearidae.engine.model.tooth_pairs import in_flight, nearest_gap
from gearidae.engine.sundials import names as sun

__all__ = ["change_wanted", "furthest_back", "overshoots", "set_pace", "tell"]

Floats = NDArray[np.float64]

CAUTION: Final = 5.0  # E over e_k; the error of a run then is some tens of tolerances
# Squared step times squared frequency for which formulas are stable with some margin: those that look back on six rates
# or fewer, on seven, on eight.
LONGEST: Final = 0.64
LONGEST_7: Final = 0.3
LONGEST_8: Final = 0.1
CALM: Final = 5  # rates that those which damp look back on, at most
LOUD: Final = 1e3  # swing from which any formula will do, over the tolerance
QUIET: Final = 10.0  # swing below which there is nothing to follow
COARSEST: Final = 0.2 / float(np.finfo(float).eps)  # a state over its tolerance
HURRY: Final = 4.0  # how much longer a step could be, for its error, that is held back too much
PATIENCE: Final = 20.0  # steps until formulas are changed
# By how much steps grow at least, or else stay, and at most, and most of all from a start.
GROW: Final = 1.5  # fewer steps than with IDA's 2, at the same error
GROW_MOST: Final = 2.0
GROW_START: Final = 8.0
GROW_IDA: Final = 2.0  # both, of IDA's own steps
IDA_ORDER: Final = 5
OVERSHOOT: Final = 0.5  # how far below the lowest gap a step may end
MOST: Final = CAUTION**-2  # squared error of the lower order
LEAST_CUT: Final = 0.9  # IDA's own, where it shortens a step at all
# Squares of twice the error between which a step is kept or cut by that, by rates looked back on.
KEPT: Final = tuple(GROW ** (-2.0 * (back + 1.0)) for back in range(adams.DEEPEST + 1))
EASED: Final = tuple(LEAST_CUT ** (-2.0 * (back + 1.0)) for back in range(adams.DEEPEST + 1))


@compiled
def tell(solver: int, desk: Floats) -> int:
    """Tell IDA what its order and steps may do by the formulas now used; 0 if all went well."""
    by_adams = desk[adams.ADAMS] != 0.0
    flag = sun.IDASetMaxOrd(solver, 1 if by_adams else IDA_ORDER)
    flag |= sun.IDASetEtaFixedStepBounds(solver, 1.0, GROW if by_adams else GROW_IDA)
    flag |= sun.IDASetEtaMax(solver, GROW_START if by_adams else GROW_IDA)
    return flag


@compiled(inline=True)
def furthest_back(desk: Floats, h: float) -> int:
    """Rates to look back on in a step of length h."""
    if desk[adams.SWING] < LOUD**2:
        return min(int(desk[adams.BACK]), CALM)
    turned = h * h * desk[adams.FASTEST]
    most = 8 if turned <= LONGEST_8 else 7 if turned <= LONGEST_7 else 6
    return min(int(desk[adams.BACK]), most)


@compiled(inline=True)
def overshoots(d: Floats, desk: Floats) -> bool:
    """Whether a step would end far below the lowest gap that the model holds for, where forces are extrapolated."""
    y = desk[adams.NEW_STATE :]
    return bool(min(nearest_gap(d, 0, y), nearest_gap(d, 1, y)) < d[at.LOWEST_GAP] - OVERSHOOT)


@compiled(inline=True)
def _shorter(twice: float, back: int, least: float) -> float:
    """Squared factor to shorten the next step by, no less than `least`, for the square of twice the error."""
    if (
        KEPT[back] < twice < EASED[back]
    ):  # as good as any by which IDA keeps the step, or makes it a tenth shorter
        return max(0.8 if twice < 1.0 else 1.2, least)
    if twice <= least ** (back + 1):
        return least
    return float(twice ** (1.0 / (back + 1.0)))


@compiled(inline=True)
def _best(n: int, desk: Floats, h: float, error: float, weights: Floats) -> tuple[int, float]:
    """How far to look back after a step of this squared error, and the squared error expected of that."""
    used, known = int(desk[adams.USED]), int(desk[adams.KNOWN])
    best, least = used, error
    if error > MOST:
        for back in range(1, used):
            other = adams.spread(n, desk, h, back, weights)
            if other < least:
                best, least = back, other
        return best, least
    lower = adams.spread(n, desk, h, used - 1, weights) if used > 1 else math.inf
    if lower <= error:
        return used - 1, lower
    if used == known:  # nothing says that it would be worse
        return min(used + 1, adams.DEEPEST), error
    if used < adams.DEEPEST:
        upper = adams.spread(n, desk, h, used + 1, weights)
        if upper < error:
            return used + 1, upper
    return used, error


@compiled(inline=True)
def _excitation(desk: Floats, d: Floats) -> float:
    """Angular frequency of the fastest torque, or of the mesh where a pair may touch; no step turns it by more."""
    if in_flight(d):
        return float(d[at.TORQUE_WAVE])
    along = d[at.MESH_WAVE] * d[at.PHASE_RATE] * abs(desk[adams.NEW_STATE + at.W])
    return float(max(d[at.TORQUE_WAVE], along))


@compiled(inline=True)
def set_pace(n: int, desk: Floats, d: Floats, h: float, correction: Floats, weights: Floats) -> None:
    """Choose how far to look back next, and the weights by which IDA judges this step and chooses the next one.

    Parameters
    ----------
    n : int
        States.
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`; with the new state and rates.
    d : ndarray
        The scene, see `layout`.
    h : float
        Length of the step, over tau.
    correction : ndarray, shape (n,)
        What IDA holds against the tolerance.
    weights : ndarray, shape (n,)
        One over the tolerances; changed.
    """
    adams.set_differences(desk, h)
    used = int(desk[adams.USED])
    error = adams.spread(n, desk, h, used, weights)
    back, least = _best(n, desk, h, error, weights)
    desk[adams.BACK] = back
    desk[adams.SINCE] += 1.0
    looking = min(back, used)
    unstable = h * h * desk[adams.FASTEST] / LONGEST
    twice = 4.0 * least / MOST  # squared, over the greatest error allowed
    hurried = twice < (unstable / HURRY**2) ** (looking + 1)
    desk[adams.HELD] = desk[adams.HELD] + 1.0 if hurried and unstable * GROW**2 > 1.0 else 0.0
    most = GROW_START if desk[adams.KNOWN] == used else GROW_MOST
    bound = max(most**-2.0, unstable, (h * _excitation(desk, d)) ** 2)
    shorter = _shorter(twice, looking, bound)
    wanted = max(0.5 * shorter, 1.05) if error > MOST else min(0.5 * shorter, 0.99)
    total = adams.squares(n, correction, 0, weights)
    if total > 0.0:
        # IDA's estimate at order one is the norm of the correction, times this step's share of the last two
        last = h if desk[adams.KNOWN] == 1.0 else desk[adams.LAST_STEP]
        scale = wanted * (h + last) / (h * math.sqrt(total / n))
        for j in range(n):
            weights[j] *= scale


@compiled(inline=True)
def change_wanted(desk: Floats, d: Floats, y: Floats, yp: Floats) -> bool:
    """Whether the other formulas would be better from here on; note it for the next start.

    Parameters
    ----------
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`.
    d : ndarray
        The scene, see `layout`.
    y, yp : ndarray, shape (n,)
        State and rates at an accepted time.
    """
    if desk[adams.OWN] == 0.0:
        return False
    first = int(d[at.WEIGHTS_AT])
    coarse = 0.0
    for j in range(y.size):
        coarse = max(coarse, abs(y[j]) * d[first + j])
    fastest = desk[adams.FASTEST]
    swing = math.inf
    if fastest > 0.0:
        swing = (y[at.V] ** 2 + yp[at.V] ** 2 / fastest) * d[first + at.V] ** 2
    desk[adams.SWING] = swing
    if desk[adams.ADAMS] != 0.0:
        change = swing < QUIET**2 or coarse > COARSEST or desk[adams.HELD] > PATIENCE
        desk[adams.WANTED] = not change
        return change
    change = (
        swing > (2.0 * QUIET) ** 2
        and coarse < 0.5 * COARSEST
        and desk[adams.LAST_STEP] ** 2 * fastest < 0.25 * LONGEST
        and desk[adams.SINCE] > PATIENCE
    )
    desk[adams.WANTED] = change
    return change
