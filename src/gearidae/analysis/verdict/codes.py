"""Verdicts as numbers, for arrays: one code a word."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray


class VerdictCode(IntEnum):
    """Verdict of a run, as stored in ``verdict_code``; `gearidae.outcomes` says what the words mean."""

    UNFINISHED = -1
    TURNS_SMOOTHLY = 0
    IRREGULAR = 1
    RUNNING_UP = 2
    RUNNING_DOWN = 3
    STICKS = 4
    RUNS_BACK = 5
    RUNS = 6
    STOPS = 7
    REBOUNDS = 8
    FLIES = 9
    TURNS_BACK = 10

    @property
    def word(self) -> str:
        """The verdict's word."""
        return self.name.lower().replace("_", " ")


class Outcome(IntEnum):
    """What a gear does at one point of an operating map."""

    UNFINISHED = -1
    TURNS = 0
    CROSSES_BACKLASH = 1
    STICKS = 2


CODE_ATTRIBUTES: dict[str, Any] = {
    "long_name": "outcome of the run as a number",
    "units": "1",
    "flag_values": np.array(list(VerdictCode), dtype=np.int8),
    "flag_meanings": " ".join(code.name.lower() for code in VerdictCode),
}

_CODES = {code.word: int(code) for code in VerdictCode}
_STUCK = (VerdictCode.STICKS, VerdictCode.RUNS_BACK)
STUCK = tuple(code.word for code in _STUCK)
"""Verdicts that count as sticking wherever runs are counted; ``stops`` and ``turns back`` do not."""


def verdict_codes(words: Sequence[str] | NDArray[np.str_]) -> NDArray[np.int8]:
    """Turn words into codes.

    Parameters
    ----------
    words : array_like of str

    Returns
    -------
    ndarray of int8
        Of the same shape, see `VerdictCode`.
    """
    texts = np.asarray(words)
    codes = np.array([_CODES[str(word)] for word in texts.ravel()], dtype=np.int8)
    return codes.reshape(texts.shape)


def sticking(codes: NDArray[np.int8]) -> NDArray[np.float64]:
    """Whether runs end stuck.

    Parameters
    ----------
    codes : ndarray of int8

    Returns
    -------
    ndarray
        1 where the verdict is ``sticks`` or ``runs back``, NaN where it is ``unfinished``, else 0.
    """
    stuck = np.isin(codes, _STUCK).astype(np.float64)
    stuck[codes == VerdictCode.UNFINISHED] = np.nan
    return stuck
