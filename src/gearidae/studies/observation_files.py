"""Observations from small files: TOML, a table for each, or CSV, a row for each."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.literal import literal, read_toml
from gearidae.studies.observations import Observation

__all__ = ["observation_of", "read_observations"]

_OWN: Final = ("of", "value", "uncertainty", "misjudged")
"""What is said of an observation beside its conditions."""


def read_observations(path: str | os.PathLike[str]) -> list[Observation]:
    """Read observations for `calibrate` from a file.

    Parameters
    ----------
    path : path-like
        ``.toml``: a list of tables ``[[observation]]`` with ``of``, ``value``, ``uncertainty`` and ``misjudged`` as
        `Observation` has them, and its conditions as a table. ``.csv``: a row for each observation, below the names
        of the columns, which are those words and, for the conditions, keys of the scene; an empty cell is not given.

    Returns
    -------
    list of Observation

    Raises
    ------
    SceneError
        If the file cannot be read, or an observation is not allowed; named by its number from 1.
    """
    source = Path(path)
    kinds = {".toml": _tables, ".csv": _rows}
    if source.suffix.lower() not in kinds:
        raise SceneError("observations", path, f"must be a file that ends in {' or '.join(kinds)}")
    try:
        text = source.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise SceneError("observations", path, f"cannot be read ({reason})") from error
    found = []
    for number, given in enumerate(kinds[source.suffix.lower()](text, source), 1):
        try:
            found.append(observation_of(given))
        except SceneError as error:
            raise SceneError(
                f"observation {number} of {source}: {error.key}", error.value, error.allowed
            ) from None
    if not found:
        raise SceneError("observations", path, "must hold at least one observation")
    return found


def observation_of(given: Mapping[str, Any]) -> Observation:
    """Make an observation of what a file or a command line says of it.

    Parameters
    ----------
    given : mapping of str to object
        ``of``, ``value``, ``uncertainty``, ``misjudged``, ``conditions`` (a table of keys, nested or dotted), or dotted
        keys of the scene, which are conditions, too.

    Returns
    -------
    Observation

    Raises
    ------
    SceneError
        If a name is not known, the value is missing, or something is not allowed.
    """
    own = {name: given[name] for name in _OWN if name in given}
    conditions: dict[str, Any] = {}
    for name, value in given.items():
        if name == "conditions":
            if not isinstance(value, Mapping):
                raise SceneError("conditions", shorten(value), "must be a table of keys and values")
            conditions |= dict(_dotted(value))
        elif "." in name:
            conditions[name] = value
        elif name not in _OWN:
            meant = (
                did_you_mean(name, (*_OWN, "conditions"))
                or f"known are {', '.join(_OWN)}, and keys with a dot"
            )
            raise SceneError(name, shorten(value), f"unknown word; {meant}")
    if "value" not in own:
        raise SceneError("value", "(missing)", "is required: whether the gear stuck, or what was measured")
    return Observation(**own, conditions=conditions)


def _dotted(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Keys of nested tables with their dots."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _dotted(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _tables(text: str, source: Path) -> list[Mapping[str, Any]]:
    try:
        data = read_toml(text)
    except ValueError as error:
        raise SceneError("observations", source, f"is no TOML: {error}") from None
    unknown = [name for name in data if name != "observation"]
    listed = data.get("observation", [])
    if unknown or not isinstance(listed, list) or not all(isinstance(each, dict) for each in listed):
        shown = unknown[0] if unknown else "observation"
        raise SceneError(
            "observations", shown, f"must be tables [[observation]] in {source}, and nothing else"
        )
    return listed


def _rows(text: str, source: Path) -> Iterator[Mapping[str, Any]]:
    lines = (line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#"))
    table = csv.DictReader(lines, skipinitialspace=True, strict=True)
    try:
        for row in table:
            if None in row or None in row.values():
                raise SceneError(
                    "observations", source, f"has a row with other than {len(table.fieldnames or ())} cells"
                )
            yield {name.strip(): literal(cell.strip()) for name, cell in row.items() if cell.strip()}
    except csv.Error as error:
        raise SceneError("observations", source, f"is no CSV: {error}") from None
