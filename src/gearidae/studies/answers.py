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

from gearidae.archive.select import scene_of
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


def _life_sentence(ds: xr.Dataset) -> str:
    last = float(ds["passages"][-1])
    ending = str(ds.attrs.get("ending", ""))
    if ending == "sticks":
        end = float(ds.attrs.get("passages_to_sticking", math.nan))
        between = f"between {last:.4g} and {end:.4g} passages of each tooth of the pinion"
        return f"The gear sticks {between}{_hours(ds, end)}."
    return (
        f"After {last:.4g} passages of each tooth of the pinion{_hours(ds, last)} "
        f"{_ENDINGS.get(ending, 'the life ends')}."
    )


def _hours(ds: xr.Dataset, passages: float) -> str:
    """Say how long passages take at the speed with which a life begins; nothing if that is not known."""
    gears, speed = scene_of(ds).get("gears"), float(ds["mean_gear_speed"][0])
    if not gears or not speed > 0.0 or not math.isfinite(passages):
        return ""
    hours = passages * 2.0 * math.pi * gears["pinion_teeth"] / (gears["gear_teeth"] * speed) / 3600.0
    return f" ({hours:.3g} h at {speed:.4g} rad/s)"


def _life_rows(ds: xr.Dataset) -> Rows:
    """Coverage, speed and frequency at the steps of the life."""
    yield "Passages of each tooth", "coverage", "mean speed, smallest speed, characteristic frequency"
    for number in range(ds.sizes["passages"]):
        one = ds.isel(passages=number)
        shares = ", ".join(f"{round(100.0 * share, 6):.4g} %" for share in one["coverage"].values)
        speed = f"{float(one['mean_gear_speed']):.4g} rad/s, {float(one['min_gear_speed']):.4g} rad/s"
        rings = float(one["characteristic_frequency"]) if "characteristic_frequency" in one else math.nan
        more = "" if math.isnan(rings) else f", {rings:.4g} Hz"
        yield f"{float(one['passages']):.4g}", shares, f"{one['verdict'].values!s}, {speed}{more}"
    counted = {name: ds.attrs.get(f"mesh_cycles_{name}") for name in ("jumped", "simulated")}
    if None not in counted.values():
        jumped = f"{float(counted['jumped']):.4g} jumped, {ds.attrs['windows']} windows"  # type: ignore[arg-type]
        yield "mesh cycles simulated", f"{float(counted['simulated']):.4g}", jumped  # type: ignore[arg-type]


def _lives_sentence(ds: xr.Dataset) -> str:
    members, stuck = ds.sizes["member"], int((ds["sticks"] > 0.0).sum())
    if not stuck:
        return f"None of {members} gears sticks as far as they were followed."
    half = next(value for name, value, _ in _surviving_rows(ds) if " 50 % " in name)
    return f"{stuck} of {members} gears stick; half still turn after {half} passages of each tooth of the pinion."


def _lives_rows(ds: xr.Dataset) -> Rows:
    """How the lives end, and after how many passages shares of the gears still turn."""
    yield str(ds.attrs["title"]), "", ""
    yield from count_rows(ds["ending"])
    if (ds["sticks"] > 0.0).any():
        yield from _surviving_rows(ds)
    if np.isfinite(ds["final_coverage"]).any():
        low, middle, high = np.nanquantile(ds["final_coverage"].values, (0.05, 0.5, 0.95))
        spread = f"90 % between {100.0 * low:.4g} % and {100.0 * high:.4g} %"
        yield "coverage at the end", f"{100.0 * middle:.4g} %", spread
    yield "windows", str(int(np.nansum(ds["windows"].values))), "simulated"


def _surviving_rows(ds: xr.Dataset) -> Rows:
    from gearidae.studies._surviving_share import surviving_share

    found = surviving_share(ds)
    passages, shares = found["passages"].values, found["share"].values
    followed = max(passages[-1], np.nanmax(ds["passages_turning"].values))
    for share in _SHARES:
        fallen = np.flatnonzero(shares <= share)
        value = f"{passages[fallen[0]]:.4g}" if fallen.size else f"more than {followed:.4g}"
        yield f"passages until {100.0 * share:.0f} % still turn", value, "of each tooth of the pinion"


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
    "life": (_life_sentence, _life_rows),
    "lives": (_lives_sentence, _lives_rows),
    "starting_torque": (_starting_sentence, _starting_rows),
    "starting_torques": (starts_sentence, starts_rows),
}
