"""The first key in which two scenes differ."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

MAY_CHANGE: Final = ("name", "drive", "load", "coating", "initial", "run")
"""What may differ between a run and the one that it goes on from, whose end is its start."""


def may_change(tables: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the keys and tables in which a run may differ from the one that it goes on from.

    Parameters
    ----------
    tables : mapping
        Of the run before, as `Scene.to_dict` gives them; of a train the coatings of its meshes are among them.
    """
    return (*MAY_CHANGE, *(f"meshes.{name}.coating" for name in tables.get("meshes", ())))


def first_difference(
    first: Mapping[str, Any], second: Mapping[str, Any], ignored: Iterable[str] = ()
) -> tuple[str, Any, Any] | None:
    """Name the first key in which two scenes differ.

    Parameters
    ----------
    first, second : mapping
        As `Scene.to_dict` gives them, or an archive holds them.
    ignored : iterable of str, optional
        Dotted keys, or names of tables, in which they may differ.

    Returns
    -------
    key : str
        Dotted, with the numbers of list entries.
    value, other_value : object
        What both hold there; None where one lacks it. The whole is None if there is no difference.
    """
    allowed = [_plain(key) for key in ignored]
    for key, mine, theirs in _differences(first, second, ""):
        plain = _plain(key)
        if not any(plain == prefix or plain.startswith(f"{prefix}.") for prefix in allowed):
            return key, mine, theirs
    return None


def _plain(key: str) -> str:
    """Leave out the numbers of list entries."""
    return ".".join(part for part in key.split(".") if not part.isdecimal())


def _differences(first: Any, second: Any, key: str) -> Iterator[tuple[str, Any, Any]]:
    if isinstance(first, dict) and isinstance(second, dict):
        for name in sorted({*first, *second}):
            yield from _differences(first.get(name), second.get(name), f"{key}.{name}".lstrip("."))
    elif isinstance(first, list) and isinstance(second, list) and len(first) == len(second):
        for number, (mine, theirs) in enumerate(zip(first, second, strict=True)):
            yield from _differences(mine, theirs, f"{key}.{number}")
    elif first != second:
        yield key, first, second
