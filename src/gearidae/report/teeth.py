"""The teeth in mesh for the viewer of a report: shapes once, and what moves at evenly spaced samples."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.select import is_roller, motion_samples, run_scene, run_value
from gearidae.arrays import Floats
from gearidae.drawing.style import Run, runs_of
from gearidae.errors import SceneError
from gearidae.plot.asperities import flank_asperities, half_width, joined_asperities, touching_arc
from gearidae.plot.teeth_view import (
    MOST_PLAY,
    STATE_WORDS,
    enlarged,
    mesh_states,
    nearest_pairs,
    pairs_at_most,
)
from gearidae.records import sampled_columns
from gearidae.report import html
from gearidae.report.gears import pack_gears
from gearidae.scene import MATERIAL_NAMES, GearScene, require_gears

if TYPE_CHECKING:
    from gearidae.records import Flank
    from gearidae.records.tooth_states import MeshState, ToothContact

MOST_STATES = 3000
"""States embedded at most, over all runs."""
FRAME = ("time", "travel", "transmission_error", "gear_speed", "mesh_force")
"""Numbers of a state: time [s], travel in pitches since both gears stood so, u [m], speed [rad/s], force [N]; then its
pairs."""
PAIR = (
    "number",
    "flank",
    "place",
    "radius",
    "gap",
    "force",
    "joined_bare",
    "joined_coated",
    "joined_mixed",
    "bare",
    "coated",
    "mixed",
    "count",
    "row",
    "arc",
    "joined_from",
    "joined_to",
)
"""Numbers of a pair: number, `Flank`, position, radius, gap [m], force [N], joined heights [m], a `ContactState` each,
how many asperities are joined (without a population: on average), which row of asperities is drawn, where the pair
touches in that row [m], and which of the run's ``joined`` are its own. NaN where there is no such pair or part, and of
joined heights where the bodies deflect."""
_TALLEST = 500
"""Asperities of a row that are embedded at most: the tallest."""


def pack_teeth(ds: xr.Dataset, most_states: int = MOST_STATES) -> dict[str, Any]:
    """Pack the teeth in mesh of all shown runs, which run again for it.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    most_states : int, optional
        States to embed at most.

    Returns
    -------
    dict
        ``columns`` (`FRAME` and `PAIR`), ``words`` (of the states), and per run its ``label``, what follows from its
        scene (lengths in m, shapes in modules), and ``states``: base64 text of little-endian float32 numbers, row by
        row. Empty for rollers, and where samples have not been kept.

    Raises
    ------
    SceneError
        If a run cannot be repeated.
    """
    return pack_runs(runs_with_teeth(ds), most_states)


def pack_runs(shown: list[Run], most_states: int = MOST_STATES) -> dict[str, Any]:
    """Pack the teeth in mesh of some runs, as `pack_teeth` does."""
    if not shown:
        return {}
    share = max(2, most_states // len(shown))
    return {
        "columns": {"frame": FRAME, "pair": PAIR},
        "words": {str(int(state)): words for state, words in STATE_WORDS.items()},
        "runs": [{"label": run.label or "run", **_pack_run(run.data, share)} for run in shown],
    }


def runs_with_teeth(ds: xr.Dataset) -> list[Run]:
    """Return the runs whose teeth a report can show: none of rollers, nor where samples have not been kept."""
    if is_roller(ds) or any(name not in ds.variables for name in sampled_columns(roller=False)):
        return []
    try:
        shown = runs_of(ds, "transmission_error")
    except SceneError:  # no run has samples
        return []
    return shown if all(motion_samples(run.data) for run in shown) else []


def time_to_repeat(shown: list[Run]) -> float:
    """Wall time that some runs have taken [s]."""
    return sum(float(run_value(run.data, "wall_time")) for run in shown)


def _pack_run(run: xr.Dataset, most: int) -> dict[str, Any]:
    scene = require_gears(run_scene(run))
    samples = motion_samples(run)
    # samples themselves and not times between, so that what is shown is what was recorded
    every = max(1, math.ceil((samples - 1) / (most - 1)))
    times = float(run["time"][samples - 1]) / max(samples - 1, 1) * np.arange(0, samples, every)
    count = pairs_at_most(scene)
    asperities = _Asperities(scene)
    rows = [_row(asperities, state, count) for state in mesh_states(run, times)]
    return {
        "every": every,
        "places": count,
        **pack_gears(scene, gaps=enlarged(scene), most_play=MOST_PLAY),
        "roughness": scene.surface.roughness,
        "halfWidth": half_width(scene),
        "population": scene.contact.is_discrete,
        "asperities": list(asperities.rows),
        "joined": html.numbers(np.array(asperities.joined)),
        "states": html.numbers(np.array(rows).ravel()),
    }


class _Asperities:
    """Asperities that the pairs of a run show: each row once, and those that are joined at each state.

    Parameters
    ----------
    scene : Scene
        With gears.

    Attributes
    ----------
    scene : Scene
    rows : dict of str to int
        Positions along the flank [m], heights [m], tip radii [m] and materials of a row, as base64 text, and its
        number.
    joined : list of float
        Positions and heights of joined asperities of a population, of all pairs one after the other.
    """

    def __init__(self, scene: GearScene) -> None:
        self.scene = scene
        self.rows: dict[str, int] = {}
        self.joined: list[float] = []
        self._drawn = lru_cache(maxsize=8)(self._read)  # pairs follow one another

    def of(self, contact: ToothContact) -> list[float]:
        """Return the last four numbers of a pair, see `PAIR`."""
        points, row = self._drawn(contact.pair, contact.flank)
        first = len(self.joined) // 2
        self.joined += points[list(contact.asperities or ())].ravel().tolist()
        return [row, touching_arc(self.scene, contact.place), first, len(self.joined) // 2]

    def _read(self, pair: int, flank: Flank) -> tuple[Floats, int]:
        """Positions and heights of the asperities of a pair, shape (n, 2), and the number of the row of its tallest."""
        drawn = flank_asperities(self.scene, pair, flank)
        tallest = drawn.some(np.argsort(-drawn.height)[:_TALLEST])
        row = self.rows.setdefault(html.numbers(np.stack(tallest).ravel()), len(self.rows))
        return np.stack([drawn.arc, drawn.height], axis=1), row


def _row(asperities: _Asperities, state: MeshState, count: int) -> list[float]:
    """Return the numbers of a state; each of its pairs in columns of its own."""
    geometry = asperities.scene.geometry
    # as many pitches as bring both gears back to where they were: float32 keeps the position of millions of pitches
    turns = math.lcm(geometry.pinion_teeth, geometry.gear_teeth)
    travel = state.travel / geometry.base_pitch % turns
    row = [state.time, travel, state.transmission_error, state.gear_speed, state.mesh_force]
    pairs = {contact.pair % count: contact for contact in nearest_pairs(state, count)}
    for number in range(count):
        row += _pair(asperities, pairs[number]) if number in pairs else [math.nan] * len(PAIR)
    return row


def _pair(asperities: _Asperities, contact: ToothContact) -> list[float]:
    joined = [contact.joined.get(part, math.nan) for part in MATERIAL_NAMES]
    states = [float(contact.states[part]) if part in contact.states else math.nan for part in MATERIAL_NAMES]
    numbers = [
        float(contact.pair),
        float(contact.flank),
        contact.place,
        contact.radius,
        contact.gap,
        contact.force,
    ]
    return [*numbers, *joined, *states, joined_asperities(asperities.scene, contact), *asperities.of(contact)]
