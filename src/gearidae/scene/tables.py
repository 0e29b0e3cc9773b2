"""Fields that hold lists: harmonics, and schedules of time and value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator

from gearidae.scene.group import Group, shorten
from gearidae.scene.units import refuse_bare

MOST_TABLES: Final = 1_000
"""Harmonics of one torque, or of the static error: all of them are summed in every evaluation of the residual."""
MOST_KNOTS: Final = 100_000
"""Knots of one schedule: the solver starts anew at each."""
CLOSEST_KNOTS: Final = 1e-12
"""Least distance of two knots over the time of the later: SUNDIALS distinguishes times to 100 roundings, 2e-14, and
takes steps between the two."""


def one_or_more(keys: str) -> BeforeValidator:
    """Accept a single table, or a list of them, of `keys`."""

    def as_list(value: object) -> object:
        if isinstance(value, (Mapping, Group)):
            return (value,)
        if isinstance(value, (list, tuple)):
            if len(value) > MOST_TABLES:
                raise ValueError(f"has {len(value)} entries; there may be {MOST_TABLES} at most")
            return tuple(value)
        raise ValueError(f"must be a table {{{keys}}} or a list of such tables")

    return BeforeValidator(as_list)


def _as_pairs(value: object) -> object:
    """Turn nested lists or an array of shape (n, 2) into a tuple of pairs; what they hold is read later."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(value, (list, tuple)):
        raise ValueError("must be a list of [time, value] pairs")
    if not value:
        raise ValueError("must not be empty: give at least one [time, value] pair, or leave it out")
    if len(value) > MOST_KNOTS:
        raise ValueError(f"has {len(value)} knots; there may be {MOST_KNOTS} at most")
    for i, pair in enumerate(value):
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise ValueError(f"entry {i} is {shorten(pair)}, but must be a [time, value] pair")
    for column in zip(*value, strict=True):
        refuse_bare(column)
    return tuple(tuple(pair) for pair in value)


def check_increasing(times: NDArray[np.float64]) -> None:
    """Refuse times of knots [s] that do not increase, or by less than the solver can step.

    Raises
    ------
    ValueError
        Naming the first two knots for which it is so.
    """
    steps = np.diff(times)
    wrong = np.flatnonzero((steps <= 0.0) | (steps < CLOSEST_KNOTS * times[1:]))
    if not wrong.size:
        return
    row = int(wrong[0])
    before, after = times[row : row + 2].tolist()
    if after <= before:
        raise ValueError(
            f"times must strictly increase, but {after:g} s follows {before:g} s (knot {row + 2})"
        )
    raise ValueError(
        f"the knots at {before!r} s and {after!r} s are too close to step between:"
        f" they must be {CLOSEST_KNOTS:g} of the time apart, {CLOSEST_KNOTS * after:.2g} s"
    )


def _check_pairs(value: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    check_increasing(np.array([time for time, _ in value]))
    return value


pairs = BeforeValidator(_as_pairs)
increasing = AfterValidator(_check_pairs)
