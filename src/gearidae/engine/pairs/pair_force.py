"""What every law of a tooth pair returns, and what that is for both gears: one type and one projection."""

from __future__ import annotations

from typing import Final, NamedTuple

from gearidae.compiled import compiled, name_type
from gearidae.engine.model.state import Model
from gearidae.engine.pairs.tooth_pairs import PairState


class PairForce(NamedTuple):
    """Force of one pair at one gap, rate and place, scaled, with its slopes.

    Laws are additive: a new one fills in what it has, and leaves the rest at zero.

    Attributes
    ----------
    load, by_gap, by_rate, by_place : float
        Force along the line of action, which drives the flanks apart, and its slopes in the gap, in the gap's rate and
        along the path of contact. The last is left out where it only steers Newton's iteration a little.
    contact, contact_by_gap : float
        What asperities in contact carry of it, on which friction acts, and its slope in the gap.
    path, path_by_gap, path_by_place : float
        Force along the path of contact at fixed gap, per pitch, and its slopes.
    limit, limit_by_gap, limit_by_place : float
        Largest friction, of a law that knows its contacts one by one, and its slopes.
    """

    load: float
    by_gap: float
    by_rate: float
    by_place: float
    contact: float
    contact_by_gap: float
    path: float
    path_by_gap: float
    path_by_place: float
    limit: float
    limit_by_gap: float
    limit_by_place: float


NO_PAIR_FORCE: Final = PairForce(*(0.0,) * 12)


@compiled(inline=True)
def of_contact(load: float, by_gap: float) -> PairForce:
    """Force that asperities in contact carry alone."""
    return PairForce(load, by_gap, 0.0, 0.0, load, by_gap, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled(inline=True)
def of_path(path: float, by_gap: float, by_place: float) -> PairForce:
    """Force along the path of contact alone."""
    return PairForce(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, path, by_gap, by_place, 0.0, 0.0, 0.0)


@compiled(inline=True)
def both_forces(a: PairForce, b: PairForce) -> PairForce:
    """Sum of what two laws return for the same pair."""
    return PairForce(
        a.load + b.load,
        a.by_gap + b.by_gap,
        a.by_rate + b.by_rate,
        a.by_place + b.by_place,
        a.contact + b.contact,
        a.contact_by_gap + b.contact_by_gap,
        a.path + b.path,
        a.path_by_gap + b.path_by_gap,
        a.path_by_place + b.path_by_place,
        a.limit + b.limit,
        a.limit_by_gap + b.limit_by_gap,
        a.limit_by_place + b.limit_by_place,
    )


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

name_type(NO_PAIR_FORCE, "PairForce")
name_type(NO_MESH_FORCES, "MeshForces")


@compiled(inline=True)
def add_pair(m: Model, total: MeshForces, pair: PairState, f: PairForce) -> MeshForces:
    """Add the force of a pair to the sums.

    The gap falls with u on the drive flank and rises on the coast flank; the phase carries a coast pair backwards along
    its path.
    """
    turn, sign, slope = m.scene.phase_rate, 1.0 - 2.0 * pair.coast, pair.slope
    relief = relief_u = relief_phase = force_w = relief_v = relief_w = 0.0
    force_phase = f.by_place
    if f.path != 0.0 or f.path_by_gap != 0.0:
        relief, relief_u, relief_phase = sign * turn * f.path, -turn * f.path_by_gap, turn * f.path_by_place
    if slope != 0.0:  # on the tip relief
        along = f.by_gap * slope / turn
        force_phase += along
        force_w = f.by_rate * slope
        relief += sign * f.load * slope
        relief_u -= f.by_gap * slope
        relief_phase += along * slope + 2.0 * f.by_place * slope + f.load * m.scene.relief_slope
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
