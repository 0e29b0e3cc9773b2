"""One statement about how far a scene can be believed, and the attribute of an archive that keeps all of them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

ATTRIBUTE = "validity"
"""Name of the attribute."""
EXPECTED_ASPERITIES = "expected_asperities"
"""Name of the row that says whether the force of one pair of teeth is the mean over many."""


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
        for row in (asdict(entry).items() for entry in rows)
    ]
    return json.dumps(kept, allow_nan=False)


def rows_from_json(text: object) -> list[ValidityRow]:
    """Read rows back, NaN for null; none from an attribute that is something else."""
    try:
        return [_row(entry) for entry in json.loads(text)]  # type: ignore[arg-type]
    except (TypeError, ValueError, KeyError, OverflowError, RecursionError):
        return []


def _row(entry: dict[str, Any]) -> ValidityRow:
    numbers = {name: math.nan if entry[name] is None else float(entry[name]) for name in ("number", "bound")}
    return ValidityRow(**{**entry, **numbers})
