"""The teeth in mesh for the viewer of a report: shapes once, and what moves at evenly spaced samples."""

from __future__ import annotations

import base64
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.select import is_roller, motion_samples, run_scene
from gearidae.archive.variables import EVENTS, columns
from gearidae.errors import SceneError
from gearidae.plot.asperities import SAMPLES, half_width, joined_asperities, rough_sample
from gearidae.plot.style import runs_of
from gearidae.plot.teeth_view import STATE_WORDS, mesh_states, nearest_pairs, pairs_at_most
from gearidae.plot.tooth_shape import ToothedWheel, mesh_picture
from gearidae.scene import MATERIAL_NAMES, Scene

if TYPE_CHECKING:
    from gearidae.studies.tooth_states import MeshState, ToothContact

MOST_STATES = 3000
"""States embedded at most, over all runs."""
FRAME = ("time", "phase", "transmission_error", "gear_speed", "mesh_force")
"""Numbers of a state: time [s], travel in pitches (its fraction), u [m], speed [rad/s], force [N]; then its pairs."""
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
)
"""Numbers of a pair: number, `Flank`, place, radius, gap [m], force [N], joined heights [m], a `ContactState` each, and
how many asperities are joined on average. NaN where there is no such pair or part, or the record does not tell."""


def pack_teeth(ds: xr.Dataset, most_states: int = MOST_STATES) -> dict[str, Any]:
    """Pack the teeth in mesh of all shown runs.

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
        row. Empty for rollers, and where samples or events have not been kept.
    """
    if is_roller(ds) or any(name not in ds.variables for name in (*columns(False), *EVENTS)):
        return {}
    try:
        shown = runs_of(ds, "transmission_error")
    except SceneError:  # no run has samples
        return {}
    if not all(motion_samples(run.data) for run in shown):
        return {}
    share = max(2, most_states // len(shown))
    return {
        "columns": {"frame": FRAME, "pair": PAIR},
        "words": {str(int(state)): words for state, words in STATE_WORDS.items()},
        "runs": [{"label": run.label or "run", **_pack_run(run.data, share)} for run in shown],
    }


def _pack_run(run: xr.Dataset, most: int) -> dict[str, Any]:
    scene = run_scene(run)
    picture, module = mesh_picture(scene), scene.geometry.module
    samples = motion_samples(run)
    # samples themselves and not times between, so that what is shown is what was recorded
    every = max(1, math.ceil((samples - 1) / (most - 1)))
    times = float(run["time"][samples - 1]) / max(samples - 1, 1) * np.arange(0, samples, every)
    places = pairs_at_most(scene)
    rows = [_row(scene, state, places) for state in mesh_states(run, times)]
    return {
        "every": every,
        "places": places,
        "module": module,
        "approach": picture.geometry.approach,
        "path": picture.geometry.path_length,
        "angle": picture.geometry.pressure_angle,
        "pitch": picture.geometry.base_pitch,
        "halfBacklash": picture.half_backlash,
        "pinion": _wheel(picture.pinion, module),
        "gear": _wheel(picture.gear, module),
        "roughness": scene.surface.roughness,
        "asperityRadius": scene.surface.asperity_radius,
        "halfWidth": half_width(scene),
        "asperities": [_encode(np.stack(rough_sample(scene, pair)).ravel()) for pair in range(SAMPLES)],
        "states": _encode(np.array(rows).ravel()),
    }


def _row(scene: Scene, state: MeshState, places: int) -> list[float]:
    """Return the numbers of a state; each of its pairs in a place of its own."""
    phase = state.travel / scene.geometry.base_pitch
    row = [state.time, phase % 1.0, state.transmission_error, state.gear_speed, state.mesh_force]
    pairs = {one.pair % places: one for one in nearest_pairs(state, places)}
    for place in range(places):
        row += _pair(scene, pairs[place]) if place in pairs else [math.nan] * len(PAIR)
    return row


def _pair(scene: Scene, one: ToothContact) -> list[float]:
    joined = [one.joined.get(part, math.nan) for part in MATERIAL_NAMES]
    states = [float(one.states[part]) if part in one.states else math.nan for part in MATERIAL_NAMES]
    numbers = [float(one.pair), float(one.flank), one.place, one.radius, one.gap, one.force]
    return [*numbers, *joined, *states, joined_asperities(scene, one)]


def _wheel(wheel: ToothedWheel, module: float) -> dict[str, Any]:
    return {
        "tooth": [round(float(number), 4) for number in (wheel.tooth / module).ravel()],
        "teeth": wheel.teeth,
        "centre": wheel.centre / module,
        "base": wheel.base_radius,
        "rim": wheel.rim_radius / module,
        "turning": wheel.turning,
    }


def _encode(values: NDArray[Any]) -> str:
    return base64.b64encode(np.asarray(values).astype("<f4").tobytes()).decode("ascii")
