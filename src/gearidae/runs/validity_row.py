"""One statement about how far a scene can be believed."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass

__all__ = ["ValidityRow", "rows_from_json", "rows_to_json"]


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


def rows_to_json(rows: Iterable[ValidityRow]) -> str:
    """Write rows as JSON, for the attribute of an archive; NaN and infinity become null.

    Parameters
    ----------
    rows : iterable of ValidityRow

    Returns
    -------
    str
    """
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

    Returns
    -------
    list of ValidityRow

    Raises
    ------
    ValueError
        If it is something else.
    """
    entries = json.loads(text)
    try:
        return [
            ValidityRow(
                **{
                    **entry,
                    "number": math.nan if entry["number"] is None else float(entry["number"]),
                    "bound": math.nan if entry["bound"] is None else float(entry["bound"]),
                }
            )
            for entry in entries
        ]
    except (TypeError, KeyError) as error:
        raise ValueError(f"holds no rows of validity: {error}") from error
