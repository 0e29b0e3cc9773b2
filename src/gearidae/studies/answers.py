"""What a study has found: one sentence that answers its question, and rows of names, values and remarks.

The same words stand on the terminal and in the report.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Final

import xarray as xr

from gearidae.studies.declared import studies
from gearidae.studies.study import Rows

_SHARES: Final = (0.9, 0.5, 0.1)
"""Of the gears that still turn, for which the passages are given."""
_MOST_FRACTIONS: Final = 13
_ENDINGS: Final = {
    "coverage": "the requested coverage is reached",
    "passages": "the requested passages are reached",
    "interrupted": "the study was interrupted",
}


@dataclass(frozen=True, slots=True)
class Answer:
    """What a study has found.

    Attributes
    ----------
    sentence : str
        The answer.
    rows : tuple of (str, str, str)
        Name, value and remark; a row without a value is a heading.
    """

    sentence: str
    rows: tuple[tuple[str, str, str], ...]


def answer(ds: xr.Dataset, kind: str) -> Answer:
    """Say what a study has found.

    Parameters
    ----------
    kind : str
        From `gearidae.studies.products.open_product`, other than ``runs``.
    """
    study = studies()[kind]
    return Answer(study.sentence(ds), tuple(study.rows(ds)))


def count_rows(words: xr.DataArray) -> Rows:
    """Count the members of which words are true, the most frequent first."""
    for word, count in Counter(words.values.tolist()).most_common():
        yield str(word), str(count), f"{100.0 * count / words.size:.3g} % of the members"
