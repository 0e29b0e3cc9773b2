r"""Deflections eliminated from the equations of a motion: solved for in each evaluation of the force.

The deflections of a pair have no inertia. At a given motion they are the solution of
:math:`d = \kappa(\ell)\, p(g + s^2 + d)`, so that the force is a function of gap and history, and the motion has no
more unknowns than one of rigid bodies: Adams' formulas can integrate it.

They are found by Newton's method. It begins at a prediction: from the ends of the last two steps, where the deflections
d and their slopes d' in the gap are known, :math:`d - d'\,g` is extrapolated by a cubic in time, and d' takes the gap
into account. What is left after a step of Newton's is of second order in its length, so that most evaluations
need one or two. The force of the last step is corrected by the step's linear part.

The same linear equations give the deflections' slopes in the gap, and so the slope of the force along which the bodies
follow. A determinant that is not positive says that the contact lies beyond a fold of its static curve.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import ELASTIC
from gearidae.engine.elastic.newton_step import (
    DEFLECTION_SLOPE,
    NEWTON_STEP,
    SUMS,
    equation_space,
    influence_space,
    newton_step,
)
from gearidae.engine.elastic.node_rows import (
    BEFORE,
    BEFORE_TANGENT,
    DEFLECTION,
    LAST,
    LAST_TANGENT,
    TANGENT,
    first_unknown,
    row,
)
from gearidae.engine.elastic.nodes import force_of_nodes, influence
from gearidae.engine.model.state import EMPTY, Floats, Model
from gearidae.engine.pairs.tooth_pairs import PairState

SETTLE: Final = 0  # what to do with a pair's deflections: solve for them,
PREDICT: Final = 1  # only interpolate or extrapolate them,
FINISH: Final = 2  # or set them at the end of a step, and note them

TRIES: Final = 12  # steps of Newton's
STRIDE: Final = 0.25  # longest, in roughnesses
LEFT: Final = 0.01
"""Square of the last step of Newton's, in roughnesses, over the relative tolerance."""
FARTHEST: Final = 4.0  # time to extrapolate over, in steps
ROUNDING: Final = 1e-13  # of times


@compiled(makes_arrays=True)
def begin_deflections(m: Model, t: float, y: Floats) -> None:
    """Begin at a time at which nothing is known but the deflections."""
    n = m.scene.nodes
    for k in range(m.scene.histories):
        settling, h = m.work.settling[k], m.state.history[k]
        settling.evaluated = settling.before_known = 0
        settling.last_known = 0 if h.pair == EMPTY else 1
        settling.last_time, settling.last_gap, settling.last_rate = t, h.gap, 0.0
        first, last, tangent = first_unknown(m, k), row(m, k, LAST), row(m, k, LAST_TANGENT)
        for i in range(n):
            last[i], tangent[i] = y[first + i], 0.0


@compiled_once(ELASTIC, makes_arrays=True)
def pair_deflections(m: Model, kind: int, t: float, y: Floats, pair: PairState, length: float) -> None:
    """Do what `kind` says with a pair's deflections: `SETTLE`, `PREDICT` or `FINISH`; see `condense_pair`."""
    k, known, gap, rate = pair.k, pair.known, pair.gap, pair.rate
    if kind == SETTLE:
        condense_pair(m, k, known, t, y, gap, rate, length)
    elif kind == PREDICT:
        predict(m, k, known, t, y, gap, rate)
    else:
        _finish_pair(m, k, known, t, y, gap, rate, length)


@compiled_once(ELASTIC, makes_arrays=True)
def condense_pair(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> tuple[float, float]:
    """Solve for the deflections of a pair; its force and the force's slope in the gap while they follow, scaled.

    Where there are no stable ones, ``m.work.not_converged`` is set.

    Parameters
    ----------
    k : int
        Index of the pair's history.
    known : bool
        Whether that is about this pair.
    t : float
        Time over tau.
    y : ndarray
        State, with its deflections; the pair's deflections are set.
    gap, rate, length : float
        The pair's gap, gap rate and contact length.
    """
    n, first, settling = m.scene.nodes, first_unknown(m, k), m.work.settling[k]
    deflection, tangent = row(m, k, DEFLECTION), row(m, k, TANGENT)
    step, follow = equation_space(m, NEWTON_STEP), equation_space(m, DEFLECTION_SLOPE)
    sums = equation_space(m, SUMS)
    predict(m, k, known, t, y, gap, rate)
    enough = math.sqrt(LEFT * m.scene.rtol)
    influence(m, length, influence_space(m))
    force = slope = 0.0
    settled = False
    for _ in range(TRIES):
        force, slope = force_of_nodes(m, k, known, t, y, gap, rate, length)
        stable = newton_step(m, k, y)
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(step[i]))
        if not largest < math.inf:
            break
        share = 1.0 if largest <= STRIDE else STRIDE / largest
        for i in range(n):
            y[first + i] -= share * step[i]
        if largest <= enough:
            settled = stable
            break
    for i in range(n):
        force -= length * sums[i] * step[i]
        slope += length * sums[i] * follow[i]
        deflection[i], tangent[i] = y[first + i], follow[i]
    settling.evaluated, settling.known, settling.time, settling.gap = 1, int(known), t, gap
    if not settled:
        m.work.not_converged = 1
    return force, slope


@compiled_once(ELASTIC, makes_arrays=True)
def following_slope(m: Model, k: int, y: Floats, length: float, follow: Floats) -> float:
    """By how much a pair's slope in the gap differs while the deflections follow, after `force_of_nodes`.

    How they do, their slopes in the gap, is written to `follow`.
    """
    influence(m, length, influence_space(m))
    newton_step(m, k, y)
    slopes, sums, more = equation_space(m, DEFLECTION_SLOPE), equation_space(m, SUMS), 0.0
    for i in range(m.scene.nodes):
        follow[i] = slopes[i]
        more += sums[i] * slopes[i]
    return length * more


@compiled(makes_arrays=True)
def _finish_pair(
    m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float, length: float
) -> None:
    """Set a pair's deflections at the end of a step and note them; parameters as for `condense_pair`."""
    settling = m.work.settling[k]
    if settling.evaluated == 0 or abs(settling.time - t) > ROUNDING * abs(t):
        condense_pair(m, k, known, t, y, gap, rate, length)
    first, deflection, tangent = first_unknown(m, k), row(m, k, DEFLECTION), row(m, k, TANGENT)
    last, last_tangent = row(m, k, LAST), row(m, k, LAST_TANGENT)
    before, before_tangent = row(m, k, BEFORE), row(m, k, BEFORE_TANGENT)
    for i in range(m.scene.nodes):
        before[i], before_tangent[i] = last[i], last_tangent[i]
        last[i] = deflection[i] + tangent[i] * (gap - settling.gap)
        last_tangent[i] = tangent[i]
        y[first + i] = last[i]
    settling.before_known = settling.last_known if known else 0
    settling.before_time, settling.before_gap, settling.before_rate = (
        settling.last_time,
        settling.last_gap,
        settling.last_rate,
    )
    settling.last_known, settling.last_time, settling.last_gap, settling.last_rate = 1, t, gap, rate
    settling.evaluated = 0


@compiled(makes_arrays=True)
def predict(m: Model, k: int, known: bool, t: float, y: Floats, gap: float, rate: float) -> None:
    """Set a pair's deflections to where the search begins; at the end of the last step, to what they are there."""
    n, first, settling = m.scene.nodes, first_unknown(m, k), m.work.settling[k]
    if settling.evaluated != 0 and settling.time == t and settling.known == int(known):
        deflection, tangent = row(m, k, DEFLECTION), row(m, k, TANGENT)
        for i in range(n):
            y[first + i] = deflection[i] + tangent[i] * (gap - settling.gap)
        return
    if settling.last_known == 0 or not (known or t == settling.last_time):
        for i in range(n):
            y[first + i] = 0.0
        return
    last, last_tangent = row(m, k, LAST), row(m, k, LAST_TANGENT)
    moved = gap - settling.last_gap
    for i in range(n):
        y[first + i] = last[i] + last_tangent[i] * moved
    span, ahead = settling.last_time - settling.before_time, t - settling.last_time
    same_way = settling.before_rate * settling.last_rate > 0.0 and settling.last_rate * rate > 0.0
    if settling.before_known == 0 or not same_way or not span > 0.0 or abs(ahead) > FARTHEST * span:
        return
    before, before_tangent = row(m, k, BEFORE), row(m, k, BEFORE_TANGENT)
    back, x = settling.before_gap - settling.last_gap, ahead / span
    for i in range(n):
        rise = before[i] - last[i] - last_tangent[i] * back
        tangent_change = span * settling.before_rate * (before_tangent[i] - last_tangent[i])
        y[first + i] += ((tangent_change + 3.0 * rise) + (tangent_change + 2.0 * rise) * x) * x * x
