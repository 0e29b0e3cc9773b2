"""What a study has found: one sentence that answers its question, and rows of names, values and remarks.

The same words stand on the terminal and in the report.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.scene.prefixes import with_prefix
from gearidae.studies.declared import studies
from gearidae.studies.gear_answers import Rows, starts_rows, starts_sentence

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
    if kind in studies():
        study = studies()[kind]
        return Answer(study.sentence(ds), tuple(study.rows(ds)))
    sentence, rows = _ANSWERS[kind]
    return Answer(sentence(ds), tuple(rows(ds)))


def count_rows(words: xr.DataArray) -> Rows:
    """Count the members of which words are true, the most frequent first."""
    for word, count in Counter(words.values.tolist()).most_common():
        yield str(word), str(count), f"{100.0 * count / words.size:.3g} % of the members"


def _starting_sentence(ds: xr.Dataset) -> str:
    if ds.sizes["sam_fraction"] > 1:
        torques = _simulated(ds).values
        low, high = (with_prefix(float(f(torques)), "N m", 4) for f in (np.nanmin, np.nanmax))
        return f"A gear at rest starts at {low} to {high} on the pinion, by its coating."
    torque, drive = float(_simulated(ds)[0]), float(ds.attrs.get("drive_torque", math.nan))
    if torque == float(ds["simulated_stuck"][0]):
        return f"Adhesion does not hold a gear at rest: it starts at {with_prefix(torque, 'N m', 4)} on the pinion."
    starts = f"A gear at rest starts at {with_prefix(torque, 'N m', 4)} on the pinion"
    if not drive > 0.0:
        return f"{starts}."
    own = "starts it" if drive >= torque else "does not start it"
    return f"{starts}: the drive's own {with_prefix(drive, 'N m', 4)} {own}."


def _simulated(ds: xr.Dataset) -> xr.DataArray:
    """Simulated torques; static ones if none have been simulated."""
    simulated = ds["simulated_torque"]
    return simulated if np.isfinite(simulated).any() else ds["static_torque"]


def _starting_rows(ds: xr.Dataset) -> Rows:
    """Torques at each coverage."""
    yield "Starting torque on the pinion", "simulated", "sticks at, and without inertia"
    for number in range(ds.sizes["sam_fraction"]):
        one = ds.isel(sam_fraction=number)
        turns, sticks, static = (
            with_prefix(float(one[name]), "N m", 4)
            for name in ("simulated_torque", "simulated_stuck", "static_torque")
        )
        yield f"SAM {100.0 * float(one['sam_fraction']):.4g} %", turns, f"sticks at {sticks}, static {static}"


_ANSWERS: Final[dict[str, tuple[Callable[[xr.Dataset], str], Callable[[xr.Dataset], Any]]]] = {
    "starting_torque": (_starting_sentence, _starting_rows),
    "starting_torques": (starts_sentence, starts_rows),
}
