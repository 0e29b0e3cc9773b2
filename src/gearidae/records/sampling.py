"""Sample times: uniform, and whole multiples of their spacing if the start of the run is one.

A continued run therefore has the sample times of a single run over both, to the last bit if the spacing is the same.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

_ON_GRID: Final = 1e-9
"""A start counts as a whole multiple within this part of a spacing."""


def first_sample(start: float, end: float, count: int) -> float:
    """Return the start over the spacing of the samples, rounded if it is a whole number but for rounding errors.

    Parameters
    ----------
    start, end : float
        Of the run, in any unit.
    count : int
        Samples, both ends included.
    """
    if start == 0.0 or count < 2:
        return 0.0
    due = start / ((end - start) / (count - 1))
    whole = float(round(due)) if due < 2.0**52 else due
    return whole if abs(due - whole) <= _ON_GRID * max(due, 1.0) else due


def sample_times(
    start: float, duration: float, count: int, numbers: range | None = None
) -> NDArray[np.float64]:
    """Times of the samples of a run.

    Parameters
    ----------
    start, duration : float
        Of the run [s].
    count : int
        Samples, both ends included; 0 for none.
    numbers : range, optional
        Which of them, in steps of 1; by default all.

    Returns
    -------
    ndarray
        [s]; of a run that begins at 0, `numpy.linspace`.
    """
    wanted = range(count) if numbers is None else numbers
    number = np.arange(wanted.start, wanted.stop, dtype=np.float64)
    times = (first_sample(start, start + duration, count) + number) * (duration / max(count - 1, 1))
    times[number == count - 1] = start + duration
    times[number == 0] = start
    return times
