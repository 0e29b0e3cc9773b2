"""Read ``key=value`` and ``key=values`` as they are written on the command line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Decimal, DecimalException
from typing import Any

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.literal import literal
from gearidae.scene.units import from_text

_LONGEST_RANGE = 100_000
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_DASHED = re.compile(rf"{_NUMBER}\s*(?:-|\u2013|\.{{2,3}}|to)\s*{_NUMBER}(?:\s*[^\W\d].*)?")
"""A range as it is written in prose (``0.4-0.6``)."""


def assignments(
    pairs: Sequence[str], option: str = "--set", example: str = "coating.sam_fraction=0.5"
) -> dict[str, Any]:
    """Read the pairs of ``--set``, or of another option that is written so.

    Parameters
    ----------
    pairs : sequence of str
        ``key=value``, the value written as in a case file; texts need no quotes (``mesh.backlash=0.2 um``).
    option, example : str, optional
        What errors shall name.

    Raises
    ------
    SceneError
        If a pair has no ``=`` or a key stands twice.
    """
    return {key: literal(text) for key, text in texts(pairs, option, example).items()}


def texts(pairs: Sequence[str], option: str, example: str) -> dict[str, str]:
    """Read pairs whose values are texts, as they stand.

    Parameters
    ----------
    pairs : sequence of str
        ``key=text``.
    option, example : str
        What errors shall name.

    Raises
    ------
    SceneError
        If a pair has no ``=`` or a key stands twice.
    """
    by_key: dict[str, str] = {}
    for pair in pairs:
        key, text = _split(pair, option, example)
        if key in by_key:
            raise SceneError(option, key, "is given twice")
        by_key[key] = text
    return by_key


def sweep_values(pairs: Sequence[str]) -> dict[str, list[Any]]:
    """Read the pairs of ``--over``.

    Parameters
    ----------
    pairs : sequence of str
        ``key=start:stop:step`` (both ends included if the steps meet them; a unit stands behind the step),
        ``key=a,b,c``, or ``key=[a, b]`` for values that contain commas themselves.

    Returns
    -------
    dict
        Key to list of values.

    Raises
    ------
    SceneError
        If a pair cannot be read or a key stands twice.
    """
    by_key = texts(pairs, "--over", "coating.sam_fraction=1:0.4:-0.05")
    return {key: _listed(key, text) for key, text in by_key.items()}


def quantity(option: str, text: str | float, unit: str) -> float:
    """Read the quantity of an option.

    Parameters
    ----------
    option : str
        What errors shall name.
    text : str or float
        A number in SI, or one with a unit.
    unit : str
        The SI unit.

    Raises
    ------
    SceneError
        If it is neither.
    """
    try:
        return float(text)
    except ValueError:
        pass
    try:
        return from_text(str(text), unit)
    except ValueError as error:
        raise SceneError(option, text, str(error)) from None


def quantities(option: str, values: object, unit: str) -> Floats:
    """Read one quantity or several, each as for `quantity`, into an array."""
    several: Any = [values] if isinstance(values, int | float | str) else values
    return np.array([quantity(option, value, unit) for value in several], dtype=np.float64)


def _split(pair: str, option: str, example: str) -> tuple[str, str]:
    key, equals, text = pair.partition("=")
    key, text = key.strip(), text.strip()
    if not equals or not key or not text:
        raise SceneError(option, pair, f"must read key=value, such as {example}")
    return key, text


def _listed(key: str, text: str) -> list[Any]:
    """Values of one key."""
    if ":" in text:
        return _range(key, text)
    if text.startswith("["):
        value = literal(text)
        return value if isinstance(value, list) else [value]
    if _DASHED.fullmatch(text):
        raise SceneError(key, text, "is no range: one is written start:stop:step, such as 0.4:0.6:0.05")
    return [literal(part.strip()) for part in text.split(",")]


def _range(key: str, text: str) -> list[Any]:
    """Evenly spaced numbers, both ends included; in decimals, so that 1:0.4:-0.05 ends at exactly 0.4.

    A unit stands behind the step, or behind each of the three.
    """
    parts = [part.strip().partition(" ") for part in text.split(":")]
    units = [unit.strip() for _, _, unit in parts]
    try:
        if set(units[:-1]) not in ({""}, {units[-1]}):
            raise ValueError
        start, stop, step = (Decimal(number) for number, _, _ in parts)
        count = int((stop - start) / step) + 1
    except (ValueError, OverflowError, DecimalException):
        allowed = "must be start:stop:step with a step other than 0, such as 1:0.4:-0.05 or 4:10:2 aN m"
        raise SceneError(key, text, allowed) from None
    if (stop - start) * step < 0:
        raise SceneError(key, text, "the step must lead from start to stop")
    if count > _LONGEST_RANGE:
        raise SceneError(key, text, f"has {count} values, more than {_LONGEST_RANGE}")
    values = [start + number * step for number in range(count)]
    return [f"{value} {units[-1]}" for value in values] if units[-1] else [float(value) for value in values]
