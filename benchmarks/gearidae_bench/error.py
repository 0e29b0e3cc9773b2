"""Error of a run against its reference, and run time of a method at a given error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["run_error", "time_at_error"]

Floats = NDArray[np.float64]


def run_error(
    speed: Floats, position: Floats, other_speed: Floats, other_position: Floats, length: float
) -> float:
    """Largest error over a run's samples, of scale.

    Parameters
    ----------
    speed, position : ndarray, shape (n,)
        The reference: speed of the gear [rad/s] or roller [m/s], transmission error or height [m].
    other_speed, other_position : ndarray, shape (m,)
        The run; one that broke off has fewer samples.
    length : float
        The roughness sigma [m].

    Returns
    -------
    float
        The larger of ``max |speed error| / (max speed - min speed)`` and ``max |position error| / sigma``. The
        speed error is divided by the fluctuation, not by the mean: the stricter measure. Infinite for a run that
        stopped early or is not finite.
    """
    if other_speed.shape != speed.shape or other_position.shape != position.shape:
        return float("inf")
    by_speed = np.abs(other_speed - speed).max() / np.ptp(speed)
    by_position = np.abs(other_position - position).max() / length
    error = float(max(by_speed, by_position))
    return error if np.isfinite(error) else float("inf")


def time_at_error(errors: Sequence[float], times: Sequence[float], wanted: float) -> float:
    """Run time of a method where its error is `wanted`, by log-log interpolation along its best points.

    Parameters
    ----------
    errors, times : sequence of float
        What the method reached at its tolerances; infinite errors count as not reached.
    wanted : float
        Error of scale.

    Returns
    -------
    float
        [s]; NaN if the method never got that accurate. A method whose loosest run is already more accurate than
        `wanted` takes as long as that run.
    """
    points = sorted(
        (e, t) for e, t in zip(errors, times, strict=True) if np.isfinite(e) and e > 0.0 and t > 0.0
    )
    # the work-precision front: from the most accurate run to ever faster ones
    front: list[tuple[float, float]] = []
    for error, time in points:
        if not front or time < front[-1][1]:
            front.append((error, time))
    if not front or front[0][0] > wanted:
        return float("nan")
    logs = np.log(np.array(front))
    return float(np.exp(np.interp(np.log(wanted), logs[:, 0], logs[:, 1])))
