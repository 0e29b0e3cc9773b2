"""Work of friction, tooth by tooth and place by place: the losses of the energy balance, divided.

The weights of the balance's quadrature are applied to the power of each pair, so that the sum over all teeth and places
of a flank is the loss of that flank to rounding. The work of a step counts at one state of the motion in it, the middle
where that is known. A pair of the mean law rubs at its place there. That of a population rubs at the places of its
joined asperities, in proportion to the limits of their friction: with the law ``shear`` each has its own work, since
all slide at one speed. With ``coulomb`` those that are pulled have negative limits, and the pair's work is shared by
those that push.
"""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.laws.discrete import candidate_limit, candidate_load
from gearidae.engine.model.state import PHASE, Floats, Model
from gearidae.engine.observers.exposures.bins import ROWS, bin_at, row_of
from gearidae.engine.pairs.coverage import path_position
from gearidae.engine.pairs.tooth_pairs import flank_of_history
from gearidae.engine.population.contact_point import pair_now, position_of_arc, spot_at
from gearidae.engine.population.layout import ARC, HEIGHT, JOINED, KIND, column


@compiled(inline=True)
def keeps_friction_work(m: Model) -> bool:
    """Whether the work of friction is kept: where there are exposures or impacts, and flanks have friction."""
    exposed = m.scene.bins > 0 and m.scene.exposure_rows > ROWS.friction
    return bool(exposed or (m.scene.follow.impacts != 0 and m.scene.friction.flanks != 0))


@compiled(inline=True)
def begin_powers(m: Model) -> None:
    """Begin to note the powers of friction of all pairs at a time, if they are kept."""
    for k in range(m.scene.histories if keeps_friction_work(m) else 0):
        exposure = m.work.exposing.pair[k]
        exposure.friction = exposure.friction_rate = 0.0


@compiled(inline=True)
def note_power(m: Model, k: int, power: float, rate: float) -> None:
    """Note the power of friction of the pair with the k-th history, and its rate."""
    exposure = m.work.exposing.pair[k]
    exposure.friction, exposure.friction_rate = power, rate


@compiled(inline=True)
def add_friction_work(m: Model, weight: float, rate_weight: float) -> None:
    """Add to the work of a step the powers of friction that have been noted, and their rates, with weights."""
    for k in range(m.scene.histories if keeps_friction_work(m) else 0):
        exposure = m.work.exposing.pair[k]
        exposure.rubbed += weight * exposure.friction + rate_weight * exposure.friction_rate


@compiled_once(FRICTION)
def divide_friction_work(m: Model, y: Floats) -> None:
    """Add the work of a step to the impacts of the pairs, and to the places where they rub at a state."""
    for k in range(m.scene.histories):
        exposure, pair = m.work.exposing.pair[k], int(m.state.history[k].pair)
        work, exposure.rubbed = exposure.rubbed, 0.0
        if work == 0.0:
            continue
        m.state.history[k].impact.friction_loss += work
        if m.scene.bins == 0:
            continue
        flank = flank_of_history(m, k)
        row = row_of(m, flank, pair) + ROWS.friction * m.scene.bins
        if m.work.contact[k].joined > 0 and _divide_asperities(m, y, k, pair, row, work):
            continue
        m.rows[row + bin_at(m, path_position(m, flank, pair, y[PHASE]))] += work


@compiled
def _divide_asperities(m: Model, y: Floats, k: int, pair: int, row: int, work: float) -> bool:
    """Add the work of a population's pair to the places of its asperities; whether one of them has a limit."""
    now = pair_now(m, flank_of_history(m, k), pair, y)
    at, total = spot_at(m, now.position, now.moves), 0.0
    joined, arcs, heights, kinds = (
        column(m, k, JOINED),
        column(m, k, ARC),
        column(m, k, HEIGHT),
        column(m, k, KIND),
    )
    half_curvature = 0.5 * m.scene.population.steepness / at.radius
    for adds in range(2):  # their sum first
        share = work / total if adds == 1 else 1.0
        for i in range(m.work.contact[k].joined):
            j = int(m.rows[joined + i])
            x, kind = m.rows[arcs + j] - at.arc, int(m.rows[kinds + j])
            overlap = m.rows[heights + j] - now.gap - half_curvature * x * x
            load, stiffness = candidate_load(m, kind, overlap)
            limit = max(candidate_limit(m, kind, overlap, load, stiffness)[0], 0.0)
            if adds == 0:
                total += limit
            else:
                m.rows[row + bin_at(m, position_of_arc(m, m.rows[arcs + j]))] += share * limit
        if total == 0.0:
            return False
    return True
