"""The state in which a run ended, carried by its dataset, so that another run can go on from it.

It is the engine's checkpoint as text (compressed, some kilobytes), an attribute of single runs: a dataset in memory has
it as its archive does. Only the engine knows what its words mean, and checks their bounds.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import zlib
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from gearidae.errors import SceneError
from gearidae.records import Words

_LARGEST: Final = 2**26
"""Bytes of a state; those of elastic contacts take up to a megabyte."""
END_DIGEST: Final = "end_state_name"
"""Attribute that tells one end from another: the name that runs which go on from there have in ``started_from``."""
VERDICT: Final = "end_verdict"
"""Attribute with what a verdict of a train that goes on has to know of the runs before."""


def packed_state(words: Words) -> str:
    """Write a checkpoint as text.

    Levels above 3 make it no smaller, and take three to five times as long: a tenth of a run of a millisecond.
    """
    return base64.b64encode(zlib.compress(np.ascontiguousarray(words).tobytes(), 3)).decode()


def end_state_attributes(start: float, words: Words | None, verdict: Words | None = None) -> dict[str, Any]:
    """Attributes of a run's dataset: when it began, if not at 0, and the state in which it ended, if there is one.

    With a state, `verdict` is what `gearidae.analysis.verdict.chain` has of a train.
    """
    attributes: dict[str, Any] = {} if start == 0.0 else {"start_time": start}
    if words is not None:
        attributes |= {"end_state": packed_state(words), END_DIGEST: fingerprint(words)}
        attributes |= {} if verdict is None else {VERDICT: packed_state(verdict)}
    return attributes


def fingerprint(words: Words) -> str:
    """Tell one state from another."""
    return hashlib.sha256(np.ascontiguousarray(words).tobytes()).hexdigest()[:16]


def end_state_of(attributes: Mapping[Any, Any]) -> tuple[Words, float]:
    """Read the state in which a run ended, and when that run began [s].

    Parameters
    ----------
    attributes : mapping
        Of the dataset of a single run.

    Returns
    -------
    words : ndarray of 8-byte words
    start : float

    Raises
    ------
    SceneError
        If there is none, or it is damaged.
    """
    if "swept" in attributes:
        raise SceneError("start", "(a sweep)", "must be a single run")
    text = attributes.get("end_state")
    if text is None:
        status = str(attributes.get("status", "no status"))[:40]
        raise SceneError("start", f"(a run with status {status})", "carries no state to go on from")
    try:
        start = float(attributes.get("start_time", 0.0))
        if not 0.0 <= start < np.inf:
            raise ValueError
        return _words_of(text), start
    except (TypeError, ValueError, binascii.Error, zlib.error):
        raise SceneError("start", "end_state", "is damaged: it is no state that a run has left") from None


def end_verdict_of(attributes: Mapping[Any, Any]) -> Words | None:
    """Read what the verdict of a train that goes on has to know; None of a pair, or of an archive without.

    Raises
    ------
    SceneError
        If it is damaged.
    """
    if VERDICT not in attributes:
        return None
    try:
        return _words_of(attributes[VERDICT])
    except (TypeError, ValueError, binascii.Error, zlib.error):
        raise SceneError("start", VERDICT, "is damaged: it is nothing that a run has left") from None


def _words_of(text: Any) -> Words:
    """Take the words out of their text."""
    if not isinstance(text, str):
        raise TypeError
    unpack = zlib.decompressobj()
    content = unpack.decompress(base64.b64decode(text, validate=True), _LARGEST)
    if not unpack.eof or len(content) % 8:
        raise ValueError
    return np.frombuffer(content, np.float64).copy()
