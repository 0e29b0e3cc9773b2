"""Schedules of torques and of a held speed: linear or monotone cubic between their knots, constant outside them.

Of a linear schedule the current segment is part of the state and not searched: it changes at knots only, so that a step
never sees two of them. A cubic one is smooth from its first knot to its last, so that only these two are stops of the
solver; the piece between two knots is found from the one used before, which is work space and in no file.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.compiled import compiled, compiled_once
from gearidae.compiled.ready import SOLVER
from gearidae.laws.law import SCHEDULES, Range, ShaftLaw

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model

LEAST_CUBIC = 3
"""Knots that a cubic takes; two are joined by a straight line."""
_STOP_STEPS: Final = 40.0
"""Steps that the stops at both ends of a piece cost; the solver begins anew there."""
PARTS: Final = 16
"""Of a cubic piece, each of which is nearly straight."""


def pack_schedule(
    schedule: Sequence[tuple[float, float]], time_unit: float, unit: float, *, cubic: bool
) -> Floats:
    """Lay a schedule out as the functions below read it.

    Parameters
    ----------
    schedule : sequence of (time, value)
        [s], [SI].
    time_unit, unit : float
        tau [s] and the unit of the values.
    cubic : bool
        Whether to add the coefficients of the cubics, of powers one to three of the time since the knot, by pieces.
    """
    knots = np.array(schedule, np.float64).reshape(-1, 2) / np.array([time_unit, unit])
    if not cubic:
        return knots.ravel()
    from scipy.interpolate import PchipInterpolator  # a sixth of a second, and few scenes need it

    coefficients = PchipInterpolator(knots[:, 0], knots[:, 1]).c
    return np.concatenate([knots.ravel(), coefficients[2::-1].T.ravel()])


def segment_ends(schedule: Any, tables: Floats) -> Floats:
    """Times at which a schedule enters its segments: all knots, or the first and the last of a cubic one.

    Parameters
    ----------
    schedule : record
        ``SCHEDULE``.
    tables : ndarray
        Of the model.
    """
    times = tables[schedule.knots_at : schedule.knots_at + 2 * schedule.knot_count : 2]
    return times[[0, -1]] if schedule.cubic else times


def fastest_schedule(schedule: Any, tables: Floats, felt: float) -> float:
    """Angular frequency of the harmonic that is as steep as a cubic schedule, if it is felt; 0 else.

    Between two knots at which its slope is zero a cubic is steeper than their chord by half. Pieces between
    `steep_knots` do not count.

    Parameters
    ----------
    schedule : record
        ``SCHEDULE``.
    tables : ndarray
        Of the model.
    felt : float
        Impulse, see `gearidae.laws.shaft.harmonic.fastest_harmonic`.
    """
    if not schedule.cubic:
        return 0.0
    count, start = int(schedule.knot_count), int(schedule.knots_at)
    times, values = tables[start : start + 2 * count : 2], tables[start + 1 : start + 2 * count : 2]
    amplitude, omegas, steep = _steepness(times, values)
    omega = float(omegas[~steep].max(initial=0.0))
    return omega if amplitude > felt * omega else 0.0


def steep_knots(knots: Sequence[tuple[float, float]]) -> list[float]:
    """Times of the knots of a cubic schedule between which it is so steep that the solver rather stops at both.

    Steps that are short everywhere would be many for a piece of a nanosecond in a schedule of seconds.
    """
    times, values = np.array(knots, np.float64).T
    steep = _steepness(times, values)[2]
    return [float(t) for t in times[np.append(steep, False) | np.append(False, steep)]]


def _steepness(times: Floats, values: Floats) -> tuple[float, Floats, NDArray[np.bool_]]:
    """Amplitude of a cubic schedule, angular frequency of a harmonic as steep as each piece, and pieces to stop at."""
    amplitude = 0.5 * float(values.max() - values.min())
    if amplitude == 0.0:
        return 0.0, np.zeros(values.size - 1), np.zeros(values.size - 1, np.bool_)
    omegas = 1.5 * np.abs(np.diff(values) / np.diff(times)) / amplitude
    order = np.argsort(-omegas)
    # steps of a run that stops at the steepest pieces, and is bound by the steepest of the others
    steps = _STOP_STEPS * np.arange(omegas.size + 1) + (times[-1] - times[0]) * np.append(omegas[order], 0.0)
    steep = np.zeros(omegas.size, np.bool_)
    steep[order[: int(np.argmin(steps))]] = True
    return amplitude, omegas, steep


@compiled
def _piece(m: Model, which: int, t: float) -> int:
    """Index of the knot before a time, at most the last but one."""
    schedule = m.scene.schedule[which]
    j, times = m.work.piece[which], schedule.knots_at
    while j > 0 and t < m.tables[times + 2 * j]:
        j -= 1
    while j < schedule.knot_count - 2 and t >= m.tables[times + 2 * j + 2]:
        j += 1
    m.work.piece[which] = j
    return j


@compiled_once(SOLVER)
def _cubic_value(m: Model, which: int, t: float) -> float:
    """Value of a cubic schedule within its knots."""
    j = _piece(m, which, t)
    k = m.scene.schedule[which].knots_at + 2 * j
    c = m.scene.schedule[which].knots_at + 2 * m.scene.schedule[which].knot_count + 3 * j
    s = t - m.tables[k]
    return m.tables[k + 1] + s * (m.tables[c] + s * (m.tables[c + 1] + s * m.tables[c + 2]))


@compiled_once(SOLVER)
def _cubic_rate(m: Model, which: int, t: float) -> float:
    """Rate of change of a cubic schedule within its knots."""
    j = _piece(m, which, t)
    c = m.scene.schedule[which].knots_at + 2 * m.scene.schedule[which].knot_count + 3 * j
    s = t - m.tables[m.scene.schedule[which].knots_at + 2 * j]
    return m.tables[c] + s * (2.0 * m.tables[c + 1] + s * 3.0 * m.tables[c + 2])


@compiled(inline=True)
def schedule_value(m: Model, which: int, t: float, value: float) -> float:
    """Add the schedule at a time to a value."""
    schedule = m.scene.schedule[which]
    knots = schedule.knot_count
    if knots > 0:
        k, j = schedule.knots_at, m.state.segment[which]
        if j == 0:
            value += m.tables[k + 1]
        elif j == (2 if schedule.cubic != 0 else knots):
            value += m.tables[k + 2 * knots - 1]
        elif schedule.cubic != 0:
            value += _cubic_value(m, which, t)
        else:
            k += 2 * j
            share = (t - m.tables[k - 2]) / (m.tables[k] - m.tables[k - 2])
            value += m.tables[k - 1] + share * (m.tables[k + 1] - m.tables[k - 1])
    return value


@compiled
def schedule_rate(m: Model, which: int, t: float) -> float:
    """Rate of change of the schedule."""
    schedule = m.scene.schedule[which]
    k, j = schedule.knots_at, m.state.segment[which]
    if not 0 < j < (2 if schedule.cubic != 0 else schedule.knot_count):
        return 0.0
    if schedule.cubic != 0:
        return _cubic_rate(m, which, t)
    k += 2 * j
    return (m.tables[k + 1] - m.tables[k - 1]) / (m.tables[k] - m.tables[k - 2])


@compiled
def enter_segment(m: Model, which: int, t: float) -> None:
    """Enter the segment that begins at a knot, if this schedule has one at this time."""
    schedule = m.scene.schedule[which]
    if schedule.cubic != 0:
        last = schedule.knots_at + 2 * schedule.knot_count - 2
        if m.state.segment[which] == 0 and m.tables[schedule.knots_at] <= t:
            m.state.segment[which] = 1
        if m.state.segment[which] == 1 and m.tables[last] <= t:
            m.state.segment[which] = 2
        return
    while (
        m.state.segment[which] < schedule.knot_count
        and m.tables[schedule.knots_at + 2 * m.state.segment[which]] <= t
    ):
        m.state.segment[which] += 1


@compiled
def turns_within(m: Model, which: int) -> bool:
    """Whether a schedule may change its slope before it enters its next segment."""
    return bool(m.scene.schedule[which].cubic != 0 and m.state.segment[which] == 1)


@compiled
def straight_until(m: Model, t: float, stop: float) -> float:
    """Time until which all schedules are straight, or nearly so and go one way; at most the next stop."""
    for which in range(SCHEDULES):
        if turns_within(m, which):
            k = m.scene.schedule[which].knots_at + 2 * _piece(m, which, t)
            begin, part = m.tables[k], (m.tables[k + 2] - m.tables[k]) / PARTS
            done = math.floor((t - begin) / part)
            end = begin + (done + 1.0) * part
            stop = min(stop, end if end > t else end + part)
    return stop


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    return schedule_value(m, shaft, t, value)


@compiled
def _rate(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: float
) -> float:
    return value + schedule_rate(m, shaft, t)


@compiled
def _is_constant(m: Model, shaft: int, value: bool) -> bool:
    return bool(value and m.scene.schedule[shaft].knot_count == 0)


@compiled
def _is_steady(m: Model, shaft: int, t: float, value: bool) -> bool:
    return bool(value and not turns_within(m, shaft) and schedule_rate(m, shaft, t) == 0.0)


@compiled
def _range(m: Model, shaft: int, t: float, to: float, value: Range) -> Range:
    return range_of_schedule(m, shaft, t, to, 1.0, value)


@compiled
def range_of_schedule(m: Model, which: int, t: float, to: float, factor: float, value: Range) -> Range:
    """Add what a schedule changes, times a factor."""
    change = factor * (schedule_value(m, which, to, 0.0) - schedule_value(m, which, t, 0.0))
    return Range(value.moving, value.swing, value.low + min(change, 0.0), value.high + max(change, 0.0))


SCHEDULE = ShaftLaw(
    "schedule",
    drives=True,
    force=_force,
    rate=_rate,
    is_constant=_is_constant,
    is_steady=_is_steady,
    range=_range,
)
