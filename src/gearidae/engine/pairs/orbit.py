r"""Orbit of the pinion in its hub: where its centre stands under the force that drives it, and what the gaps get of it.

A pinion with the radial clearance c in its hub, which a force P pushes, stands at :math:`\mathbf r = c\,P/|P|`: the
journal follows the force. With x along the centres the drive flank presses along
:math:`\mathbf n = (\sin\alpha, \cos\alpha)` and the coast flank along :math:`(\sin\alpha, -\cos\alpha)`. Both gaps
close by what r has along these. So the error of the mesh has the term :math:`-\mathbf n\cdot\mathbf r`, and the coast
gap, :math:`b + u` without it, has :math:`-2 c \sin\alpha\,P_x/|P|` besides: gears that come nearer have less play.

The direction of P depends on time alone, so that both are functions of time. They are polynomials through six values of
the law, which lie at the multiples of a step since its last knot: the same ones whatever has been asked before.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import COAST, DRIVE, Model
from gearidae.laws.shaft.own import law_force

VALUES: Final = 6
"""Of the law, that a polynomial goes through."""
_LEAST_DIVISOR: Final = 1e-300


@compiled(inline=True)
def follow_orbit(m: Model, t: float) -> None:
    """Let gaps, and the error of the mesh, be those of a time: whatever asks for them at a time calls this first."""
    if m.scene.orbit != 0.0 and (m.work.orbit.step == 0.0 or m.work.orbit.time != t):
        _set_orbit(m, t)


@compiled_once(SOLVER)
def _set_orbit(m: Model, t: float) -> None:
    """Put what the orbit adds at a time to the work space, and the clearance of the coast flank."""
    s, o = m.scene, m.work.orbit
    begin, end = 0.0, math.inf
    if m.work.law_until > 0.0:
        begin, end = m.work.law_from, m.work.law_until
    step = min(s.orbit_step, (end - begin) / (VALUES - 1))
    first = min(math.floor((t - begin) / step) - 2, math.floor((end - begin) / step) - (VALUES - 1))
    first = max(first, 0)
    origin = begin + first * step
    if o.step != step or o.origin != origin:
        _lay_out(m, origin, step)
    along = (t - origin) / step
    for which in range(2):
        c, value, rate, second_rate = o.value[which], 0.0, 0.0, 0.0
        for k in range(VALUES - 1, -1, -1):  # Newton's form and its derivatives
            x = along - k
            second_rate = second_rate * x + 2.0 * rate
            rate = rate * x + value
            value = value * x + c[k]
        if which == 0:
            o.error, o.error_rate, o.error_acceleration = value, rate / step, second_rate / (step * step)
        else:
            o.play_rate, o.play_acceleration = rate / step, second_rate / (step * step)
            s.clearance[COAST] = s.clearance[DRIVE] + value
            s.nearest[COAST] = s.clearance[COAST] + s.orbit_nearest
    o.time = t
    m.work.mesh_error.known = 0


@compiled
def _lay_out(m: Model, origin: float, step: float) -> None:
    """Work out divided differences of what the orbit adds to the error of the mesh and to the coast gap."""
    s, o = m.scene, m.work.orbit
    o.origin, o.step = origin, step
    for k in range(VALUES):
        x, y = law_force(m, DRIVE, origin + k * step, 0.0, 0.0)
        size = max(math.hypot(x, y), _LEAST_DIVISOR)
        o.value[0, k] = -s.orbit * (s.orbit_sine * x + s.orbit_cosine * y) / size
        o.value[1, k] = -s.orbit_play * (s.orbit_x * x + s.orbit_y * y) / size
    for which in range(2):
        for order in range(1, VALUES):
            for k in range(VALUES - 1, order - 1, -1):
                o.value[which, k] = (o.value[which, k] - o.value[which, k - 1]) / order


@compiled(inline=True)
def orbit_anew(m: Model) -> None:
    """Forget the values of the law, of which other ones count behind a knot."""
    m.work.orbit.step = 0.0


@compiled(inline=True)
def opening_of(m: Model, flank: int, v: float) -> float:
    """Rate of the gaps of a flank on the path of contact, for the rate of u."""
    return v + m.work.orbit.play_rate if flank else -v


@compiled(inline=True)
def acceleration_of_gap(m: Model, flank: int, slope: float, w: float, v_rate: float, w_rate: float) -> float:
    """Second derivative of a gap with the slope of its tip relief, for the accelerations of u and of the gear."""
    acceleration = (1.0 - 2.0 * flank) * (slope * w_rate - v_rate)
    if flank:
        acceleration += m.work.orbit.play_acceleration
    if slope != 0.0:
        acceleration += m.scene.relief_slope * m.scene.phase_rate * w * w
    return acceleration
