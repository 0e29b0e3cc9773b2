"""Dry load: the torque of the load resists the gear in either direction (Teodorescu et al. 2009, Eq. 2).

Constant part, harmonics, schedule and law of the load add up to its limit, as they do to the torque of a drive, and are
cut off at zero together: a resistance never pushes. Its keys are those of the table ``load``
(`gearidae.scene.torque.Load`), which reads no constant and no schedule below zero.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from gearidae.compiled import compiled
from gearidae.formulas.quadrature import Ends, torque_work
from gearidae.laws.friction_law import FrictionLaw, Holder, slip_of
from gearidae.laws.law import LOAD, REAL, Loss
from gearidae.laws.shafts import driving_along, driving_force, driving_range

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


@compiled(inline=True)
def _limit(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    return value + max(driving_force(m, shaft, t, angle, speed), 0.0)


@compiled(inline=True)
def _least(m: Model, shaft: int, t: float, angle: float, value: float) -> float:
    return value + max(driving_range(m, shaft, t, t, angle)[0], 0.0)


@compiled(inline=True)
def _begin(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: bool
) -> bool:
    noted = m.work.quadrature.friction[shaft]
    noted.dry_force, noted.dry_rate = driving_along(m, shaft, t, angle, speed, acceleration)
    return value


@compiled(inline=True)
def _loss(
    m: Model,
    shaft: int,
    h: float,
    t: float,
    angle: float,
    travel: float,
    speeds: Ends,
    value: tuple[float, float],
) -> tuple[float, float]:
    noted = m.work.quadrature.friction[shaft]
    force, rate = driving_along(m, shaft, t, angle, speeds.end, speeds.end_rate)
    if min(force, noted.dry_force) < 0.0:  # cut off within the interval: what is left of a straight line
        most = max(force, noted.dry_force, 0.0)
        work = 0.5 * most * most / abs(force - noted.dry_force) * travel if most > 0.0 else 0.0
        error = abs(work)
    else:
        work, error = torque_work(h, travel, Ends(noted.dry_force, noted.dry_rate, force, rate), speeds)
    noted.dry_force, noted.dry_rate = force, rate
    loss = slip_of(m, shaft) * work
    m.state.energy.dry_loss += loss
    return value[0] + abs(loss), value[1] + error


@compiled(inline=True)
def _book(m: Model, shaft: int, energy: float) -> float:
    m.state.energy.dry_loss += energy
    return 0.0


def _there(scene: Any, shaft: int) -> bool:
    load = scene.load
    if shaft != LOAD or load is None:
        return False
    return load.torque != 0.0 or bool(load.harmonic) or bool(load.schedule) or load.law is not None


def _mean(scene: Any, shaft: int, average: Callable[..., float]) -> float:
    """Of constant part and schedule; harmonics and laws are left out."""
    return average(scene, scene.load.torque, scene.load.schedule)


DRY_LOAD = FrictionLaw(
    "dry resistance",
    limit=_limit,
    holders=(Holder("dry_resistance", 1),),
    losses=(Loss("dry_loss", "energy lost to dry resistance", since="", group="useful"),),
    loss=_loss,
    begin=_begin,
    noted=(
        ("dry_force", REAL),
        ("dry_rate", REAL),
    ),  # torque over base radius before it is cut off, and its rate
    book=_book,
    least=_least,
    key="load.torque",
    there=_there,
    mean=_mean,
)
