"""Contact length of a pair along the path of contact, alone and weighed by what its materials have, with its rates.

A pair on a contact of length l stores l times the sum of its materials' energies by their shares s: what changes along
the path is l s of each material, all of it l where the shares do not change.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, Floats, Model, V, W
from gearidae.engine.pairs.coverage import WHOLE, Shares, path_position, share_changes, weighed
from gearidae.engine.pairs.orbit import opening_of
from gearidae.engine.pairs.tooth_pairs import flank_of_history

SHORTEST_SQ = 1e-12
"""Least square of a contact length: a step that is tried may lead beyond the path, to where there is none."""


@compiled
def length_and_rates(
    m: Model, flank: int, pair: int, phase: float, w: float, w_rate: float
) -> tuple[float, float, float]:
    """Contact length of a pair on the path of contact, its rate and the rate of that."""
    sign = m.scene.phase_rate * (1.0 - 2.0 * flank)
    curvature = m.scene.sum_curvature
    # l^2 = r - c r^2 with r the pinion's radius of curvature
    radius = m.scene.start_radius + (m.scene.coast_phase + pair - phase if flank else phase - pair)
    length = math.sqrt(max(radius - radius * radius * curvature, SHORTEST_SQ))
    half = 0.5 - radius * curvature
    along = sign * w
    rate = half * along / length
    return length, rate, (half * sign * w_rate - curvature * along * along - rate * rate) / length


class WeighedLength(NamedTuple):
    """A contact length times what its materials have per length, by their shares.

    Attributes
    ----------
    length, rate, second_rate : float
        With two derivatives in time while the values stay.
    by_gap : float
        Slope of the rate in the gap.
    """

    length: float
    rate: float
    second_rate: float
    by_gap: float


@compiled(inline=True)
def weighed_length(
    m: Model, where: tuple[int, int, float], w: float, w_rate: float, values: Shares, slopes: Shares
) -> WeighedLength:
    """Weigh the contact length of a pair on the path of contact.

    Parameters
    ----------
    where : tuple
        Flank and number of the pair, and phase of the gear.
    w, w_rate : float
        Surface velocity of the gear, and the rate of that.
    values, slopes : tuple of three floats
        What each material has per length, as if it covered everything, and its slope in the gap.
    """
    flank, pair, phase = where
    length, rate, second_rate = length_and_rates(m, flank, pair, phase, w, w_rate)
    if m.scene.covered_by_position != 0:
        return _by_position(m, where, (w, w_rate), (length, rate, second_rate), values, slopes)
    a = weighed(WHOLE, values)
    return WeighedLength(a * length, a * rate, a * second_rate, weighed(WHOLE, slopes) * rate)


@compiled(inline=True)
def slopes_along_path(
    m: Model, flank: int, pair: int, phase: float, values: Shares, slopes: Shares
) -> tuple[float, float, float]:
    """Slope along the path of a pair's contact length times what its materials have, per pitch, and slopes of that.

    Parameters
    ----------
    flank, pair : int
        Flank and number of the pair.
    phase : float
        Phase of the gear.
    values, slopes : tuple of three floats
        As for `weighed_length`.

    Returns
    -------
    along, by_gap, by_position : float
    """
    pitch = (1.0 - 2.0 * flank) / m.scene.phase_rate  # speed at which the pair goes a pitch in a unit of time
    length = weighed_length(m, (flank, pair, phase), pitch, 0.0, values, slopes)
    return length.rate, length.by_gap, length.second_rate


@compiled(inline=True)
def length_power(
    m: Model, k: int, y: Floats, w_rate: float, energies: Shares, slopes: Shares
) -> tuple[float, float]:
    """What the changing length adds to the energy of the pair of the k-th history in a unit of time, and its rate.

    Parameters
    ----------
    k : int
        Index of the history.
    y : ndarray
        State.
    w_rate : float
        Acceleration of the gear's surface.
    energies, slopes : tuple of three floats
        Of each material per length, and in the gap, as for `weighed_length`.
    """
    flank = flank_of_history(m, k)
    where = flank, m.state.history[k].pair, y[PHASE]
    energy = weighed_length(m, where, y[W], w_rate, energies, slopes)
    return energy.rate, energy.second_rate + opening_of(m, flank, y[V]) * energy.by_gap


@compiled
def _by_position(
    m: Model,
    where: tuple[int, int, float],
    speed: tuple[float, float],
    lengths: tuple[float, float, float],
    values: Shares,
    slopes: Shares,
) -> WeighedLength:
    """Weigh a contact length, given with its rates, where shares change along the path."""
    flank, pair, phase = where
    length, rate, second_rate = lengths
    shares, changes, second_changes = share_changes(m, flank, pair, path_position(m, flank, pair, phase))
    along = m.scene.phase_rate * (1.0 - 2.0 * flank)
    v, v_rate = along * speed[0], along * speed[1]
    a, a1 = weighed(shares, values), weighed(changes, values) * v
    a2 = weighed(second_changes, values) * v * v + weighed(changes, values) * v_rate
    return WeighedLength(
        a * length,
        a * rate + a1 * length,
        a * second_rate + 2.0 * a1 * rate + a2 * length,
        weighed(shares, slopes) * rate + weighed(changes, slopes) * v * length,
    )
