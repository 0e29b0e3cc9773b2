"""One statement about how far a scene can be believed, and the attribute of an archive that keeps all of them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

ATTRIBUTE = "validity"
"""Name of the attribute."""
EXPECTED_ASPERITIES = "expected_asperities"
"""Name of the row that says whether the force of one pair of teeth is the mean over many."""
_LONGEST = 100_000
"""Characters of it; what is written has some four thousand."""


@dataclass(frozen=True, slots=True)
class ValidityRow:
    """A quantity of a scene beside the limit it is compared with.

    Attributes
    ----------
    name : str
        Short name, such as ``expected_asperities``.
    quantity : str
        What it is, in words.
    value : str
        The number with its unit, for people.
    limit : str
        What it is compared with, with its unit.
    verdict : str
        What follows, in words.
    holds : bool
        Whether the quantity keeps to its limit; nothing is stopped if it does not.
    number : float
        The number itself, SI; NaN if the scene has none.
    bound : float
        The limit itself, SI; NaN if there is none.
    unit : str
        Unit of both; "1" for pure numbers.
    """

    name: str
    quantity: str
    value: str
    limit: str
    verdict: str
    holds: bool
    number: float
    bound: float
    unit: str


def contact_subject(*, roller: bool, swept: Sequence[str] = ()) -> str:
    """Say in words which contact the rows are about.

    Parameters
    ----------
    roller : bool
        Whether the scene is that of a roller, else of gears.
    swept : sequence of str, optional
        Keys or dimensions in which the runs of a sweep differ.
    """
    if roller:
        contact = "of the roller at its closest approach, with rigid bodies"
    else:
        contact = "of one pair at the pitch point, at rest under the mean torque"
    if not swept:
        return contact
    return f"{contact}, for the scene that the runs were derived from: {', '.join(swept)} may change it"


def mean_note(rows: Iterable[ValidityRow]) -> str:
    """Say in a line what stands beside a verdict where the force of one pair of teeth is not the mean over many.

    Returns
    -------
    str
        Such as ``"mean over many gears: 5.13e-08 asperities in contact"``; empty where the mean law holds, or the
        contact is not known.
    """
    for row in rows:
        if row.name == EXPECTED_ASPERITIES and not row.holds and not math.isnan(row.number):
            return f"mean over many gears: {row.value} asperities in contact"
    return ""


def rows_to_json(rows: Iterable[ValidityRow]) -> str:
    """Write rows as JSON, for the attribute of an archive; NaN and infinity become null."""
    kept = [
        {key: None if isinstance(value, float) and not math.isfinite(value) else value for key, value in row}
        for row in (asdict(each).items() for each in rows)
    ]
    return json.dumps(kept, allow_nan=False)


def rows_from_json(text: str) -> list[ValidityRow]:
    """Read rows back.

    Parameters
    ----------
    text : str
        What `rows_to_json` wrote.

    Raises
    ------
    ValueError
        If it is something else.
    """
    try:
        entries = json.loads(text)
    except RecursionError as error:
        raise ValueError("holds no rows of validity: tables within tables") from error
    if not isinstance(entries, list):
        raise ValueError(f"holds no rows of validity, but one {type(entries).__name__}")
    return [_row(entry) for entry in entries]


def holds_rows(text: object) -> bool:
    """Whether an attribute read from a file is what `rows_to_json` writes."""
    if not isinstance(text, str) or len(text) > _LONGEST:
        return False
    try:
        rows_from_json(text)
    except ValueError:
        return False
    return True


_TYPES = {field.name: field.type for field in fields(ValidityRow)}


def _row(entry: Any) -> ValidityRow:
    """One row from its table, each entry of the type that it is written with."""
    if not isinstance(entry, dict) or entry.keys() != _TYPES.keys():
        raise ValueError("holds no rows of validity: other entries than theirs")
    read: dict[str, Any] = {}
    for name, kind in _TYPES.items():
        value = entry[name]
        if kind == "float":
            value = math.nan if value is None else value
            if not isinstance(value, int | float) or isinstance(value, bool):
                raise ValueError(f"holds no rows of validity: {name} is no number")
            value = float(value) if abs(value) < 1e308 or isinstance(value, float) else math.nan
        elif not isinstance(value, bool if kind == "bool" else str):
            raise ValueError(f"holds no rows of validity: {name} is no {kind}")
        read[name] = value
    return ValidityRow(**read)
