"""Observations from small files: TOML, a table for each, or CSV, a row for each."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from gearidae.calibration.observations import Observation
from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.literal import literal, read_toml
from gearidae.scene.table_head import open_table
from gearidae.scene.text_table import check_regular

_FIELDS: Final = ("of", "value", "uncertainty", "misjudged")
"""What is said of an observation beside its conditions."""
_LARGEST: Final = 10_000_000  # bytes


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
        rows = list(kinds[source.suffix.lower()](source))
    except SceneError:
        raise
    except (OSError, ValueError) as error:
        reason = "is no text" if isinstance(error, UnicodeDecodeError) else error
        raise SceneError("observations", path, f"cannot be read: {reason}") from error
    observations = []
    for number, row in enumerate(rows, 1):
        try:
            observations.append(observation_of(row))
        except SceneError as error:
            raise SceneError(
                f"observation {number} of {source}: {error.key}", error.value, error.allowed
            ) from None
    if not observations:
        raise SceneError("observations", path, "must hold at least one observation")
    return observations


def observation_of(entry: Mapping[str, Any]) -> Observation:
    """Make an observation of what a file or a command line says of it.

    Parameters
    ----------
    entry : mapping of str to object
        ``of``, ``value``, ``uncertainty``, ``misjudged``, ``conditions`` (a table of keys, nested or dotted), or dotted
        keys of the scene, which are conditions, too.

    Raises
    ------
    SceneError
        If a name is not known, the value is missing, or something is not allowed.
    """
    fields = {name: entry[name] for name in _FIELDS if name in entry}
    conditions: dict[str, Any] = {}
    for name, value in entry.items():
        if name == "conditions":
            if not isinstance(value, Mapping):
                raise SceneError("conditions", shorten(value), "must be a table of keys and values")
            conditions |= dict(_dotted(value))
        elif "." in name:
            conditions[name] = value
        elif name not in _FIELDS:
            meant = (
                did_you_mean(name, (*_FIELDS, "conditions"))
                or f"known are {', '.join(_FIELDS)}, and keys with a dot"
            )
            raise SceneError(name, shorten(value), f"unknown word; {meant}")
    if "value" not in fields:
        raise SceneError("value", "(missing)", "is required: whether the gear stuck, or what was measured")
    return Observation(**fields, conditions=conditions)


def _dotted(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Keys of nested tables with their dots."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _dotted(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _tables(source: Path) -> list[Mapping[str, Any]]:
    check_regular(source, _LARGEST)
    data = read_toml(source.read_text(encoding="utf-8-sig"))
    unknown = [name for name in data if name != "observation"]
    listed = data.get("observation", [])
    if unknown or not isinstance(listed, list) or not all(isinstance(table, dict) for table in listed):
        shown = unknown[0] if unknown else "observation"
        raise SceneError(
            "observations", shown, f"must be tables [[observation]] in {source}, and nothing else"
        )
    return listed


def _rows(source: Path) -> Iterator[Mapping[str, Any]]:
    table = open_table(source, largest=_LARGEST, names=lambda headings: "value" in headings)
    for _, _, cells in table.rows():
        row = zip(table.headings, cells, strict=True)
        yield {name: literal(cell) for name, cell in row if cell}
