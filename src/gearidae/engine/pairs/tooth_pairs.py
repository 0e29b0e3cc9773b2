"""Tooth pairs in mesh: gap and rate of each, from the scaled state (Teodorescu et al. 2009, Eqs. 4-6).

A pair is known by its number i. On the drive flank it stands ``phase - i`` pitches along the path of contact, on the
coast flank, mirrored about the pitch point and half a pitch later, ``coast_phase + i - phase``. A roller is pair 0 of
the drive flank of a gear that is held, at one point of a path of contact without length. All functions take the
records of `gearidae.engine.model.state` and the state's numbers, and are compiled.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled, compiled_once, name_type
from gearidae.engine.compiling import SOLVER
from gearidae.engine.model.state import COAST, DRIVE, PHASE, Floats, Model, U, V, W
from gearidae.engine.pairs.orbit import acceleration_of_gap
from gearidae.laws.pair_law import NO_PAIR_FORCE, GapMotion, in_reach

# -- the walk over the pairs -----------------------------------------------------------------------------------------


class Reach(NamedTuple):
    """Pairs to look at, of both flanks: the first number and how many.

    ``for k in range(reach.total): coast, pair = pair_at(reach, k)`` is the walk over them.
    """

    drive_first: int
    drive_count: int
    coast_first: int
    total: int


@compiled(inline=True)
def _reach(m: Model, phase: float, drive: bool, coast: bool) -> Reach:
    """Pairs within reach of the given flanks."""
    s = m.scene
    drive_first = coast_first = drive_count = coast_count = 0
    if drive:
        drive_first = math.ceil(phase - s.contact_ratio - s.reach)
        drive_count = math.floor(phase + s.reach) - drive_first + 1
    if coast:
        coast_first = math.ceil(phase - s.coast_phase - s.reach)
        coast_count = math.floor(phase - s.coast_phase + s.contact_ratio + s.reach) - coast_first + 1
    return Reach(drive_first, drive_count, coast_first, drive_count + coast_count)


@compiled(inline=True)
def all_pairs(m: Model, y: Floats) -> Reach:
    """Pairs within reach along the path of contact, however wide their gaps."""
    return pairs_along(m, y[PHASE])


@compiled(inline=True)
def pairs_along(m: Model, phase: float) -> Reach:
    """`all_pairs` of a phase."""
    return _reach(m, phase, True, True)


@compiled(inline=True)
def pairs_touching(m: Model, y: Floats) -> Reach:
    """Pairs of the flanks whose nearest gap is within the cut-off: tip relief only opens a gap."""
    drive, coast = in_reach(m, nearest_gap(m, DRIVE, y)), in_reach(m, nearest_gap(m, COAST, y))
    return _reach(m, y[PHASE], drive, coast)


@compiled(inline=True)
def pairs_near(m: Model, y: Floats) -> Reach:
    """Pairs of the flanks that were near at the last accepted time."""
    return _reach(m, y[PHASE], m.state.flank_in_reach[DRIVE] != 0, m.state.flank_in_reach[COAST] != 0)


@compiled(inline=True)
def pairs_felt(m: Model, y: Floats) -> Reach:
    """Pairs of the flanks that touch at a state or were near at the last accepted time: any may have a force."""
    drive = m.state.flank_in_reach[DRIVE] != 0 or in_reach(m, nearest_gap(m, DRIVE, y))
    coast = m.state.flank_in_reach[COAST] != 0 or in_reach(m, nearest_gap(m, COAST, y))
    return _reach(m, y[PHASE], drive, coast)


@compiled(inline=True)
def pair_at(reach: Reach, k: int) -> tuple[int, int]:
    """Flank and number of the k-th pair of a walk."""
    if k < reach.drive_count:
        return DRIVE, reach.drive_first + k
    return COAST, reach.coast_first + (k - reach.drive_count)


@compiled(inline=True)
def list_known(m: Model, y: Floats) -> int:
    """List the pairs that are near and whose histories are about them; how many there are.

    ``for i in range(list_known(m, y)): k = m.work.known[i]`` goes through their histories.
    """
    count, reach = 0, pairs_near(m, y)
    for i in range(reach.total):
        flank, number = pair_at(reach, i)
        k = history_of(m, flank, number)
        if m.state.history[k].pair == number:
            m.work.known[count] = k
            count += 1
    return count


@compiled(inline=True)
def history_of(m: Model, flank: int, pair: int) -> int:
    """Index of a pair's history; they go round, with at least as many of them as pairs can be within reach."""
    slots = m.scene.slots
    return flank * slots + (pair & (slots - 1))


@compiled(inline=True)
def flank_of_history(m: Model, k: int) -> int:
    """Flank of the pair with the k-th history."""
    return COAST if k >= m.scene.slots else DRIVE


@compiled
def pairs_on_path(m: Model, flank: int) -> tuple[int, int]:
    """First and last number of a flank's pairs on the path of contact.

    The last two mesh marks decide, so that a step that ends at a mark sees the side it comes from.
    """
    between = 0.5 * (m.state.mesh_mark_below + m.state.mesh_mark_above)
    lowest = between - m.scene.coast_phase if flank else between - m.scene.contact_ratio
    return math.ceil(lowest), math.floor(lowest + m.scene.contact_ratio)


@compiled
def is_on_path(m: Model, flank: int, pair: int) -> bool:
    """Whether a pair is one of `pairs_on_path`."""
    first, last = pairs_on_path(m, flank)
    return bool(first <= pair <= last)


# -- kinematics ------------------------------------------------------------------------------------------------------


class PairState(NamedTuple):
    """A pair at a state.

    Attributes
    ----------
    flank, number : int
        Its flank and number.
    k : int
        Index of its history.
    known : bool
        Whether that is about this pair.
    gap, rate : float
        Its gap and gap rate, tip relief included.
    slope : float
        Of the tip relief along the path.
    position, position_rate : float
        Along the path of contact, and its rate; clipped to the path, and 0, beyond it.
    moves : bool
        Whether it is on the path.
    """

    flank: int
    number: int
    k: int
    known: bool
    gap: float
    rate: float
    slope: float
    position: float
    position_rate: float
    moves: bool


name_type(PairState(0, 0, 0, True, 0.0, 0.0, 0.0, 0.0, 0.0, True), "PairState")
name_type(NO_PAIR_FORCE, "PairForce")


@compiled(inline=True)
def pair_state(m: Model, flank: int, number: int, y: Floats) -> PairState:
    """Return a pair at a state."""
    k = history_of(m, flank, number)
    known = m.state.history[k].pair == number
    gap, rate, slope, inside = pair_gap(m, flank, number, y[U], y[V], y[PHASE], y[W])
    moves = 0.0 < inside < m.scene.contact_ratio
    position_rate = (1.0 - 2.0 * flank) * m.scene.phase_rate * y[W] if moves else 0.0
    return PairState(flank, number, k, known, gap, rate, slope, inside, position_rate, moves)


@compiled
def pair_gap(
    m: Model, flank: int, pair: int, u: float, v: float, phase: float, w: float
) -> tuple[float, float, float, float]:
    """Gap, its rate, slope of the separation ds/dxi, and the position along the path clipped to it (in pitches)."""
    s = m.scene
    along = s.coast_phase + pair - phase if flank else phase - pair
    inside = min(max(along, 0.0), s.contact_ratio)
    outside = along - inside
    toward = -v if not flank else v + m.work.orbit.play_rate
    gap = s.clearance[flank] + (u if flank else -u)
    if s.pitch_errors != 0:
        gap += pitch_error(m, flank, pair)
    if outside == 0.0:
        return gap, toward, 0.0, inside
    slope = s.relief_slope * outside
    gap += 0.5 * s.relief_curvature * outside * outside
    path_speed = -w if flank else w
    return gap, toward + slope * path_speed, slope, inside


@compiled
def pair_motion(
    m: Model,
    flank: int,
    number: int,
    motion: tuple[float, float, float, float],
    v_rate: float,
    w_rate: float,
) -> GapMotion:
    """Gap of a pair with two rates at a state (u, v, phase and w) with accelerations."""
    u, v, phase, w = motion
    gap, rate, slope, _ = pair_gap(m, flank, number, u, v, phase, w)
    return GapMotion(gap, rate, acceleration_of_gap(m, flank, slope, w, v_rate, w_rate))


@compiled_once(SOLVER)
def pitch_error(m: Model, flank: int, pair: int) -> float:
    """By how much the teeth of a pair stand back, of a scene with pitch errors: it opens the gap of the pair.

    A tooth that stands back from its drive flank is nearer with its back. The coast flank of a space of the pinion
    belongs to the next tooth of the gear. What has been looked up is kept: two remainders take as long as the rest of
    a gap. Compiled once, as any more code in `pair_gap` makes runs without errors slower, too.
    """
    kept, tag = m.work.pitch_error[history_of(m, flank, pair)], pair + m.state.whole_pitches + 0.5
    if kept.tag != tag:
        s, number = m.scene, int(pair + m.state.whole_pitches)
        error = m.tables[s.pinion_errors_at + number % int(s.pinion_teeth)]
        error += m.tables[s.gear_errors_at + (number + flank) % int(s.gear_teeth)]
        kept.tag, kept.value = tag, -error if flank else error
    return kept.value


@compiled
def path_gap(m: Model, flank: int, pair: int, y: Floats) -> float:
    """Gap of a pair on the path of contact."""
    gap = m.scene.clearance[flank] + (y[U] if flank else -y[U])
    return gap + pitch_error(m, flank, pair) if m.scene.pitch_errors != 0 else gap


@compiled
def gap_and_rate(m: Model, flank: int, pair: int, y: Floats) -> tuple[float, float]:
    """Gap and gap rate of a pair."""
    gap, rate, _, _ = pair_gap(m, flank, pair, y[U], y[V], y[PHASE], y[W])
    return gap, rate


@compiled(inline=True)
def on_path(pair: PairState, position: float, position_rate: float, moves: bool) -> PairState:
    """Return the same pair with another position along the path of contact."""
    return PairState(
        pair.flank,
        pair.number,
        pair.k,
        pair.known,
        pair.gap,
        pair.rate,
        pair.slope,
        position,
        position_rate,
        moves,
    )


@compiled(inline=True)
def was_within(m: Model, k: int, number: int) -> bool:
    """Whether a pair, of which k is the index of its history, was within the cut-off at the last event.

    It is noted for meshes with a law that loses energy, see `gearidae.engine.events.cutoff`.
    """
    return bool(m.work.within[k] == number + 0.5)


@compiled(inline=True)
def pair_within(m: Model, k: int) -> int:
    """Number of the pair with the k-th history that was within the cut-off then."""
    return math.floor(m.work.within[k])


@compiled(inline=True)
def acts(m: Model, pair: PairState) -> bool:
    """Whether a pair may have a force: within the cut-off, or until it has been seen to leave that."""
    return bool(in_reach(m, pair.gap) or was_within(m, pair.k, pair.number))


@compiled
def contact_length(m: Model, inside: float) -> float:
    """Length of a contact of given gap, ``sqrt(R / pb)`` with R the reduced radius of two involutes; 1 of a roller."""
    return length_at(m.scene.start_radius + inside, m.scene.sum_curvature)


@compiled(inline=True)
def length_at(pinion: float, sum_curvature: float) -> float:
    """`contact_length` where the pinion's involute has a radius of curvature."""
    return math.sqrt(pinion - pinion * pinion * sum_curvature)


@compiled
def flank_gaps(m: Model, y: Floats) -> tuple[float, float, int]:
    """Smallest gaps of the drive and the coast flank, scaled, and number of pairs in contact."""
    drive_gap = coast_gap = math.inf
    touching, reach = 0, all_pairs(m, y)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        gap = pair_gap(m, flank, pair, y[U], y[V], y[PHASE], y[W])[0]
        if flank:
            coast_gap = min(coast_gap, gap)
        else:
            drive_gap = min(drive_gap, gap)
        touching += gap < m.scene.contact_gap
    return drive_gap, coast_gap, touching


@compiled
def rigid_separation(m: Model, u: float, phase: float) -> float:
    """Distance of the nearer flank of pairs on the path of contact; with errors of teeth, of the nearest pair."""
    if m.scene.pitch_errors == 0:
        return min(m.scene.nearest[DRIVE] - u, m.scene.nearest[COAST] + u)
    least = math.inf
    reach = pairs_along(m, phase)
    for i in range(reach.total):
        flank, pair = pair_at(reach, i)
        least = min(least, pair_gap(m, flank, pair, u, 0.0, phase, 0.0)[0])
    return least


@compiled
def nearest_gap(m: Model, flank: int, y: Floats) -> float:
    """Gap on the path of contact of the teeth that stand out farthest, which no pair of this flank undercuts."""
    return m.scene.nearest[flank] + (y[U] if flank else -y[U])


@compiled
def in_flight(m: Model) -> bool:
    """Whether both flanks are too far away for any pair to touch."""
    return bool(m.state.flank_in_reach[DRIVE] == 0 and m.state.flank_in_reach[COAST] == 0)
