"""Fields that hold lists: harmonics, and schedules of time and value."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from pydantic import AfterValidator, BeforeValidator

from gearidae.scene.group import Group, shorten

__all__ = ["increasing", "one_or_more", "pairs"]


def one_or_more(keys: str) -> BeforeValidator:
    """Accept a single table, or a list of them, of `keys`."""

    def as_list(value: object) -> object:
        if isinstance(value, (Mapping, Group)):
            return (value,)
        if isinstance(value, (list, tuple)):
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
    for i, pair in enumerate(value):
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise ValueError(f"entry {i} is {shorten(pair)}, but must be a [time, value] pair")
    return tuple(tuple(pair) for pair in value)


def _check_increasing(value: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    times = [time for time, _ in value]
    for before, after in pairwise(times):
        if after <= before:
            raise ValueError(f"times must strictly increase, but {after:g} s follows {before:g} s")
    return value


pairs = BeforeValidator(_as_pairs)
increasing = AfterValidator(_check_increasing)
