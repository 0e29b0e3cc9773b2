"""What a set-valued law of a shaft is: dry friction, of which a law says how much it can hold, and never which way.

A shaft that turns is resisted by the limit, against its direction of slip; one at rest by what balances the other
forces, up to the limit. Directions of slip are part of the state of a run and change at events only, so that forces
are smooth within a step. Sticking and slipping are the same for all such laws and stand in the engine
(`gearidae.engine.friction`, `gearidae.engine.events.sliding`), which asks the sums over their list
(`gearidae.laws.frictions`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from gearidae.compiled import compiled
from gearidae.laws.law import LOAD, Coefficient, Loss, Verb

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model


class Holder(NamedTuple):
    """What a law says when it holds a gear: a kind of `gearidae.records.standing.Holding`.

    Attributes
    ----------
    name : str
        Its words, joined by underscores.
    number : int
        A power of two that no other kind has, and that stays as it is in archives.
    """

    name: str
    number: int


@compiled(inline=True)
def slip_of(m: Model, shaft: int) -> float:
    """Direction in which a shaft slips, -1 or 1; 0 while it is held."""
    return m.state.slip if shaft == LOAD else m.state.pinion_slip


@dataclass(frozen=True)
class FrictionLaw:
    """A set-valued law of a shaft. A verb that it has no use for is left out.

    Limits are torques over the base radius, speeds those of the base circles, all scaled; `m` is the model of a run,
    `shaft` is `DRIVE` or `LOAD`, `t` the time, `angle` [rad], `speed` and `acceleration` those of the shaft.

    Attributes
    ----------
    name : str
        Of a feature of a scene, too.
    limit : (m, shaft, t, angle, speed, value) -> value
        Adds the largest force with which it resists; never below zero.
    holders : tuple of Holder
        What holds a gear at rest that it holds.
    losses : tuple of Loss
    loss : (m, shaft, h, t, angle, travel, speeds, value) -> value
        Books its loss in an interval of the energy balance that ends at `t`, from its length, the travel of the base
        circle and the `gearidae.formulas.quadrature.Ends` of its speed; adds magnitude and error to the pair `value`.
    begin : (m, shaft, t, angle, speed, acceleration, value) -> value
        Notes at the beginning of an interval what `loss` needs; returns the value.
    noted : tuple of (name, type)
        Numbers that it notes for that, in ``WORK.quadrature.friction`` of the shaft.
    book : (m, shaft, energy) -> energy
        Books the energy that a shaft loses which is brought to rest at once; returns what is left of it, 0. The first
        law of a shaft with this verb does.
    least : (m, shaft, t, angle, value) -> value
        Adds the smallest limit of a shaft at rest whose harmonics are anywhere in their periods; by default the limit.
    fields : tuple of (name, type)
        Constants of a shaft, in ``SCENE.torque``.
    coefficients : tuple of Coefficient
        Constants that keys of the gears' table say; fields, too.
    key : str
        That asks for it in another table.
    there : (scene, shaft) -> bool
        Whether a scene has it on a shaft; by default where one of its keys is not 0. In Python.
    mean : (scene, shaft, average) -> float
        Mean limit over a run [N m] of a scene that has it; ``average(scene, constant, knots)`` is the mean size of a
        constant and a schedule. In Python.
    largest : (scene, shaft) -> float
        Bound of the limit [N m] of a scene that has it, by which the run's unit of force is chosen; left out where the
        torques of drive and load have it already. In Python.
    """

    name: str
    limit: Verb
    holders: tuple[Holder, ...]
    losses: tuple[Loss, ...]
    loss: Verb
    begin: Verb | None = None
    noted: tuple[tuple[str, str], ...] = ()
    book: Verb | None = None
    least: Verb | None = None
    fields: tuple[tuple[str, str], ...] = ()
    coefficients: tuple[Coefficient, ...] = ()
    key: str = ""
    there: Callable[[Any, int], bool] | None = None
    mean: Callable[[Any, int, Callable[..., float]], float] | None = None
    largest: Callable[[Any, int], float] | None = None
