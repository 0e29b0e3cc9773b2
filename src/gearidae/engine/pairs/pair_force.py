"""What the forces of tooth pairs are for both gears: one sum and one projection."""

from __future__ import annotations

from typing import Final, NamedTuple

from gearidae.compiled import compiled, name_type
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.tooth_pairs import PairState
from gearidae.laws.pair_law import PairForce


class MeshForces(NamedTuple):
    """Sums over the pairs, scaled.

    Attributes
    ----------
    force, relief : float
        F along the line of action, and Fs, what the gear gets besides: by tip relief and along the path of contact.
    force_u, force_phase, relief_u, relief_phase : float
        Their partial derivatives in u and phase. Of a roller u is the negative height.
    force_v, force_w, relief_v, relief_w : float
        Those in the rate of u and the gear's surface velocity.
    """

    force: float
    relief: float
    force_u: float
    force_phase: float
    relief_u: float
    relief_phase: float
    force_v: float
    force_w: float
    relief_v: float
    relief_w: float


NO_MESH_FORCES: Final = MeshForces(*(0.0,) * 10)

name_type(NO_MESH_FORCES, "MeshForces")


@compiled(inline=True)
def add_pair(m: Model, total: MeshForces, pair: PairState, f: PairForce) -> MeshForces:
    """Add the force of a pair to the sums.

    The gap falls with u on the drive flank and rises on the coast flank; the phase carries a coast pair backwards along
    its path.
    """
    phase_rate, sign, slope = m.scene.phase_rate, 1.0 - 2.0 * pair.flank, pair.slope
    relief = relief_u = relief_phase = force_w = relief_v = relief_w = 0.0
    force_phase = f.by_position
    if f.path != 0.0 or f.path_by_gap != 0.0:
        relief, relief_u, relief_phase = (
            sign * phase_rate * f.path,
            -phase_rate * f.path_by_gap,
            phase_rate * f.path_by_position,
        )
    if slope != 0.0:  # on the tip relief
        along = f.by_gap * slope / phase_rate
        force_phase += along
        force_w = f.by_rate * slope
        relief += sign * f.load * slope
        relief_u -= f.by_gap * slope
        relief_phase += along * slope + 2.0 * f.by_position * slope + f.load * m.scene.relief_slope
        relief_v, relief_w = -force_w, force_w * slope
    return MeshForces(
        total.force + sign * f.load,
        total.relief + relief,
        total.force_u - f.by_gap,
        total.force_phase + force_phase,
        total.relief_u + relief_u,
        total.relief_phase + relief_phase,
        total.force_v - f.by_rate,
        total.force_w + force_w,
        total.relief_v + relief_v,
        total.relief_w + relief_w,
    )
