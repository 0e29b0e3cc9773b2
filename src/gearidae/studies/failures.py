"""Words of the runs of a study that have no answer: one such run does not end a study of several."""

from __future__ import annotations

from typing import Final

FAILS: Final = "fails: "
"""What such a word begins with; the message follows."""


def failure_of(word: str) -> str:
    """Return the message of a run that has failed; empty of another."""
    return word.removeprefix(FAILS) if word.startswith(FAILS) else ""
