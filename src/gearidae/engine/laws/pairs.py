r"""All laws of a tooth pair, and their sums.

Laws of contacts come first: many surfaces on average, elastic bodies, or asperities one by one, of which a mesh has
one. Sums of forces and energies begin at -0.0, to which adding a number gives that number.

The length of a contact, and with it the number of asperities in touch, changes along the path of contact, and shares of
the materials that change with tooth and position change it as well. In the paper's model no force pays for that; see
`gearidae.engine.observers.balance`, which books the power. With ``mesh.radius_force`` a force does: a pair with the
length :math:`\ell s_m` of each material, of the energy :math:`U_m` per length, pushes the gear along its motion
:math:`x_2` with

.. math:: -\sum_m U_m \frac{d(\ell s_m)}{dx_2} \quad \left( = -\ell U \frac{R'}{2R} \text{ where shares stay} \right)

at fixed gap. As the phase of the mesh is the gear's, the pinion has no part in it. U is zero at detachment. What
elastic bodies store besides, B per length, adds :math:`-B\,d\ell/dx_2`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.laws.attraction import ATTRACTION
from gearidae.engine.laws.discrete import DISCRETE
from gearidae.engine.laws.elastic import ELASTIC
from gearidae.engine.laws.statistical import STATISTICAL
from gearidae.engine.model.state import PHASE, Floats, Model, Record, U, V, W
from gearidae.engine.pairs.coverage import NONE, Shares
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.tooth_pairs import (
    PairState,
    flank_of_history,
    is_on_path,
    list_known,
    pair_motion,
    pair_within,
    path_gap,
    was_within,
)
from gearidae.engine.population.contact_point import state_of_pair
from gearidae.formulas.quadrature import Ends
from gearidae.laws.law import Verb
from gearidae.laws.pair_law import PairForce, PairLaw, in_reach
from gearidae.laws.pairs import MESH_LAWS

PAIR_LAWS: Final[tuple[PairLaw, ...]] = (STATISTICAL, ELASTIC, DISCRETE, ATTRACTION, *MESH_LAWS)
"""In the order of additions. `pair_laws` of a mesh is the sum of 1, 2, 4.. by their order here of those that it has."""

_NOTHING: Final = PairForce(*(-0.0,) * 12)


def laws_of_mesh(scene: Record) -> int:
    """Sum of 1, 2, 4.. of the laws that a mesh has, by its constants in ``SCENE``."""
    return sum(1 << k for k, law in enumerate(PAIR_LAWS) if law.acts(scene))


def _asked(law: PairLaw, verb: Verb, rest: Verb) -> Verb:
    """Verb of a law that is asked of meshes that have the law only, before the verbs of the laws behind it."""
    bit = 1 << PAIR_LAWS.index(law)

    # one closure a law, the first law outermost: what is inside is compiled into each closure around it
    @compiled(inline=True)
    def ask(*arguments: Any) -> Any:
        value = arguments[-1]
        if arguments[0].scene.pair_laws & bit != 0:
            value = verb(*arguments)
        return rest(*arguments[:-1], value)

    return ask


def _within_step(law: PairLaw) -> Verb | None:
    """Force of a law; of one that loses energy where the pair was within the cut-off at the beginning of the step."""
    verb = law.force
    if verb is None or law.loss is None:
        return verb

    @compiled(inline=True)
    def ask(m: Any, t: float, y: Any, pair: Any, settling: bool, value: PairForce) -> PairForce:
        if was_within(m, pair.k, pair.number):
            value = verb(m, t, y, pair, settling, value)
        return value

    return ask


@compiled(inline=True)
def _no_more(*arguments: Any) -> Any:
    return arguments[-1]


def _sum(verbs: Iterable[Verb | None]) -> Any:
    """Make one function of a verb of each law, in the order of the list."""
    total: Verb = _no_more
    for law, verb in reversed(list(zip(PAIR_LAWS, verbs, strict=True))):
        if verb is not None:
            total = _asked(law, verb, total)
    return total


_force = _sum(_within_step(law) for law in PAIR_LAWS)
_energy = _sum(law.energy for law in PAIR_LAWS)
_joining = _sum(law.joining for law in PAIR_LAWS)
_in_contact = _sum(law.in_contact for law in PAIR_LAWS)
_power = _sum(law.power for law in PAIR_LAWS)
mesh_force = _sum(law.mesh_force for law in PAIR_LAWS)
"""Add the force on a mesh by the rate of the transmission error alone: (m, rate, value) -> value."""
mesh_by_rate = _sum(law.mesh_by_rate for law in PAIR_LAWS)
"""Add the slope of that: (m, value) -> value."""


@compiled(inline=True)
def force_of_pair(m: Model, t: float, y: Floats, pair: PairState, settling: bool) -> PairForce:
    """Force of a pair within reach by all laws of its mesh; `settling` as for `PairLaw`."""
    return _force(m, t, y, pair, settling, _NOTHING)


@compiled
def joining_losses(m: Model, k: int, y: Floats, gap: float) -> tuple[Shares, Shares]:
    """What each material of a pair has lost per length by joining since the last turning point, and slopes in the gap.

    Of each as if it covered everything.
    """
    return _joining(m, k, y, gap, (NONE, NONE))


@compiled(inline=True)
def asperities_in_contact(m: Model, k: int, y: Floats, gap: float, material: int) -> float:
    """Asperities of a material of a pair in contact per length, over their density."""
    return _in_contact(m, k, y, gap, material, -0.0)


@compiled_once(SOLVER)
def stored_energy(m: Model, y: Floats) -> tuple[float, float]:
    """Stored energy of all contacts, and the part lost by asperities in contact since the last turning point.

    Parameters
    ----------
    m : Model
        With the histories as they are at `y`.
    y : ndarray
        State.

    Returns
    -------
    stored, pending : float
        Scaled; the true stored energy is their difference.
    """
    stored = pending = 0.0
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        pair = state_of_pair(m, flank_of_history(m, k), m.state.history[k].pair, y)
        if in_reach(m, pair.gap):
            energy, lost = _energy(m, y, pair, (-0.0, -0.0))
            stored += energy
            pending += lost
    return stored, pending


@compiled_once(SOLVER)
def radius_power(m: Model, t: float, y: Floats, w_rate: float) -> tuple[float, float]:
    """Power of the changing radius, what length adds to a pair's energy times the length's rate, and its own rate."""
    power = rate = 0.0
    if m.scene.curvature_force != 0:  # it is the work of a force then, which motion and contacts exchange
        return power, rate
    for i in range(list_known(m, y)):
        k = m.work.known[i]
        flank, pair = flank_of_history(m, k), m.state.history[k].pair
        gap = path_gap(m, flank, pair, y)
        if in_reach(m, gap) and is_on_path(m, flank, pair):
            more, change = _power(m, t, y, k, gap, w_rate, (-0.0, -0.0))
            power += more
            rate += change
    return power, rate


# -- losses ----------------------------------------------------------------------------------------------------------


def _booking(law: PairLaw) -> Verb:
    """Verb that books what a law takes in a step from the mesh and from all pairs, and adds it."""
    name = law.losses[0].name
    of_mesh: Any = law.mesh_loss
    of_pair: Any = law.loss

    if of_mesh is not None:

        @compiled
        def book(m: Any, h: float, y: Any, yp: Any, value: float) -> float:
            r = m.work.resistance
            rates = Ends(r.mesh_speed, r.mesh_acceleration, y[V], yp[V])
            lost, error = of_mesh(m, h, y[U] - r.mesh_travel, rates, (0.0, 0.0))
            m.state.energy[name] += lost
            m.state.energy.loss_error += error
            return value + lost

        return book

    @compiled
    def book_pairs(m: Any, h: float, y: Any, yp: Any, value: float) -> float:
        r, taken = m.work.resistance, (0.0, 0.0)
        before = r.mesh_travel, r.mesh_speed, m.scene.phase_rate * r.gear_travel, r.gear_speed
        now = y[U], y[V], y[PHASE], y[W]
        for k in range(m.scene.histories):
            if m.work.within[k] == 0.0:
                continue
            flank, number = flank_of_history(m, k), pair_within(m, k)
            follow_orbit(m, r.time)
            start = pair_motion(m, flank, number, before, r.mesh_acceleration, r.gear_acceleration)
            follow_orbit(m, r.time + h)
            end = pair_motion(m, flank, number, now, yp[V], yp[W])
            taken = of_pair(m, h, start, end, taken)
        m.state.energy[name] += taken[0]
        m.state.energy.loss_error += taken[1]
        return value + taken[0]

    return book_pairs


LOSING_PAIRS: Final = sum(1 << k for k, law in enumerate(PAIR_LAWS) if law.loss is not None)
"""Of `pair_laws`: those that take energy from pairs, which pass the cut-off as an event."""
LOSING: Final = sum(1 << k for k, law in enumerate(PAIR_LAWS) if law.losses)
"""Of `pair_laws`: those with a loss."""
_losses = _sum(_booking(law) if law.losses else None for law in PAIR_LAWS)


@compiled_once(SOLVER)
def book_losses_of_mesh(m: Model, h: float, y: Floats, yp: Floats, value: float) -> float:
    """Book what laws of a mesh take in a step that began where ``m.work.resistance`` says, and add it."""
    return _losses(m, h, y, yp, value)
