"""Intervals over which sliding work is integrated: one to six accepted steps of rigid bodies.

The number of steps follows from the error estimate of the interval before, as an integrator chooses its steps. An
interval ends with the step in which a force is expected to pass zero: a contact that pulls does no sliding work, and
where the integral begins or ceases in between, it is the better the shorter the interval is. Where more than 600 steps
go to a pitch, an interval is no longer than a hundredth of a pitch.

Pressures are looked at where an interval ends, and just after a contact has left its place: a cubic, which gives the
pressure at the edge, is most accurate close to its ends. Sliding work goes on from there, so that its sum does not
depend on the number of places.
"""

from __future__ import annotations

import math

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model

__all__ = ["begin_intervals", "next_interval", "next_look", "start_with_one_step", "time_to_zero"]

MOST_STEPS = 6
"""Accepted steps in an interval, where its error estimate allows."""
ALLOWED = 1e-3
"""Error estimate of sliding work, over the mean work of as many steps."""
LENGTHENING = 2.0
"""How much longer than an interval the next one is where no error is estimated, and how much shorter at the utmost."""
FADING = 0.9
"""What is left of the work of former intervals and of their steps, from one interval to the next."""
PER_PITCH = 100.0
"""Intervals in a pitch, at least, where there are as many steps: as pairs meet, forces change within half of one."""


@compiled(inline=True)
def begin_intervals(m: Model) -> None:
    """Begin at a start of the integration, with nothing known of the work of former steps."""
    m.work.exposing.work = m.work.exposing.counted = 0.0
    start_with_one_step(m)


@compiled(inline=True)
def start_with_one_step(m: Model) -> None:
    """Begin an interval of one step, as a contact has begun or ended."""
    m.work.exposing.steps, m.work.exposing.at_once, m.work.exposing.wanted = 0, 1, 1
    m.work.exposing.error = 0.0


@compiled(inline=True)
def time_to_zero(m: Model, k: int, force: float, rate: float) -> float:
    """Time until the force of the pair with the k-th history is expected to pass zero.

    It is infinite beyond the longest interval, and where the pair has not pulled: most contacts cease to push as they
    separate, without a kink.
    """
    own = m.work.exposing.pair[k]
    if force < 0.0:
        own.pulls = 1
    if own.pulls == 0 or force * (force + rate * MOST_STEPS * m.work.driver.step) >= 0.0:
        return math.inf
    return -force / rate


@compiled(inline=True)
def next_interval(m: Model, to_zero: float, speed: float) -> None:
    """End an interval, and choose the steps of the next one.

    Parameters
    ----------
    m : Model
    to_zero : float
        Time until the first force is expected to pass zero.
    speed : float
        With which contacts move along the path, in pitches.
    """
    exposing, step = m.work.exposing, m.work.driver.step
    steps, gone = _steps_by_error(m), abs(speed) * step
    if steps * gone * PER_PITCH > 1.0:
        steps = max(int(1.0 / (PER_PITCH * gone)), 1)
    if to_zero < steps * step:
        steps = int(to_zero / step) + 1
    exposing.steps, exposing.at_once, exposing.error = 0, steps, 0.0


@compiled(inline=True)
def next_look(m: Model, way: float, speed: float) -> None:
    """Choose the step after which pressures are looked at next.

    Parameters
    ----------
    m : Model
    way : float
        To the nearest edge of a place, in places.
    speed : float
        As for `next_interval`.
    """
    exposing = m.work.exposing
    left, gone = exposing.at_once - exposing.steps, abs(speed) * m.work.driver.step * m.scene.places_per_pitch
    if way < left * gone:
        left = int(way / gone) + 1
    exposing.wanted = exposing.steps + left


@compiled(inline=True)
def _steps_by_error(m: Model) -> int:
    """Steps for which the error estimate of the next interval will be what is allowed."""
    exposing = m.work.exposing
    exposing.counted += exposing.steps
    allowed, error = ALLOWED * exposing.work * exposing.steps, exposing.error * exposing.counted
    exposing.work *= FADING
    exposing.counted *= FADING
    longer = LENGTHENING
    if error > 0.0:  # 1 where it is what is allowed
        longer = (LENGTHENING * allowed + error) / (allowed + LENGTHENING * error)
    return min(max(int(longer * exposing.steps + 0.5), 1), MOST_STEPS)
