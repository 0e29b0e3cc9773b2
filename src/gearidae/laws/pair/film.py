r"""Film of gas that two flanks squeeze out: a force against the rate of their gap.

A pair of the gap g has the force :math:`-c(g)\,\dot g` with :math:`c = c_0 (g_0/(g + g_0))^3`, the law of Reynolds'
equation for a film of the height :math:`g + g_0`; below a gap of zero the damping is :math:`c_0`. While a free flank of
the mass m approaches, the rate v of its gap obeys
:math:`m (v - v_a) = (c_0 g_0^3/2) ((g + g_0)^{-2} - (g_a + g_0)^{-2})`. At the cut-off the force jumps.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from gearidae.compiled import compiled
from gearidae.errors import SceneError
from gearidae.formulas.quadrature import Ends, integral_of_square
from gearidae.laws.law import Key, Loss
from gearidae.laws.pair_law import (
    GapMotion,
    MeshConstant,
    PairForce,
    PairLaw,
    both_forces,
    of_gap,
)

if TYPE_CHECKING:
    from gearidae.engine.model.state import Floats, Model
    from gearidae.engine.pairs.tooth_pairs import PairState


@compiled(inline=True)
def _force(m: Model, t: float, y: Floats, pair: PairState, settling: bool, value: PairForce) -> PairForce:
    height = m.scene.film_gap + max(pair.gap, 0.0)
    damping = m.scene.film_damping * (m.scene.film_gap / height) ** 3
    by_gap = 3.0 * damping * pair.rate / height if pair.gap > 0.0 else 0.0
    return both_forces(value, of_gap(-damping * pair.rate, by_gap, -damping))


class _Travel(NamedTuple):
    """A variable x whose squared rate is the power that a film takes."""

    x: float
    rate: float
    rate_rate: float


@compiled
def _travel(m: Model, at: GapMotion) -> _Travel:
    """Return x where the square root of the damping times the gap's rate is its rate: in closed form in the gap."""
    least, height = m.scene.film_gap, m.scene.film_gap + max(at.gap, 0.0)
    root = math.sqrt(m.scene.film_damping)
    x = root * (min(at.gap, 0.0) + 2.0 * least * (1.0 - math.sqrt(least / height)))
    root *= (least / height) ** 1.5
    thinning = -1.5 * at.rate * at.rate / height if at.gap > 0.0 else 0.0
    return _Travel(x, root * at.rate, root * (thinning + at.acceleration))


@compiled
def _loss(
    m: Model, h: float, before: GapMotion, now: GapMotion, value: tuple[float, float]
) -> tuple[float, float]:
    a, b = _travel(m, before), _travel(m, now)
    loss, error = integral_of_square(h, b.x - a.x, Ends(a.rate, a.rate_rate, b.rate, b.rate_rate))
    return value[0] + loss, value[1] + error


def _acts(scene: Any) -> bool:
    return bool(scene.film_damping != 0.0)


def _refuse(mesh: Any) -> None:
    if mesh.film_damping > 0.0 and mesh.film_gap == 0.0:
        raise SceneError("film_gap", mesh.film_gap, "must be above 0 where film_damping is")


FILM = PairLaw(
    name="film of gas",
    acts=_acts,
    constants=(
        MeshConstant(  # force per rate of the gap, at a gap of zero [F tau/sigma]
            "film_damping",
            Key(
                "N s/m",
                "damping of a film of gas between two flanks, at a gap of zero",
                at_most=1e9,
                example=2e-5,
            ),
            force=1,
            length=-1,
            time=1,
        ),
        MeshConstant(  # [sigma]
            "film_gap",
            Key(
                "m",
                "height of that film; the damping falls with the third power of height and gap together",
                at_most=1,
                least=1e-10,
                shown=("nm", -9),
                example=2e-8,
            ),
            length=1,
        ),
    ),
    losses=(Loss("film_loss", "energy lost to films of gas between flanks"),),
    refuse=_refuse,
    force=_force,
    loss=_loss,
)
