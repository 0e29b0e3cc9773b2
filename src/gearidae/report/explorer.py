"""A page to look through the runs of an archive: sliders over swept keys and time, turning gears, forces, verdicts."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.headline import headline
from gearidae.archive.select import (
    first_travel,
    is_roller,
    is_train,
    motion_samples,
    refuse_train,
    run_scene,
    runs,
)
from gearidae.archive.target import whole_file
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.report import html
from gearidae.report.frame import page
from gearidae.report.frames import ShownRun, largest_of, pack_frames, picked, range_of, thinning
from gearidae.report.gears import pack_gears
from gearidae.report.outcomes import ascending
from gearidae.report.series import reduced
from gearidae.report.tables import outcome_table
from gearidae.report.teeth import pack_teeth
from gearidae.report.trains import pack_trains
from gearidae.scene import GearScene, require_gears

MOST_VALUES = 400_000
"""Numbers that a page holds at most (2.2 MB of text), shared by its runs."""
FRAME = (
    "travel",
    "transmission_error",
    "gear_speed",
    "gear_contact_torque",
    "mesh_force",
    "drive_gap",
    "coast_gap",
    "pairs_in_contact",
)
"""Numbers of a picture: travel of the gear in pitches, and samples [SI]."""
_CURVES = ("gear_speed", "gear_contact_torque")
_CLEARANCE = 0.4
"""Modules of backlash that are drawn at most: the pinion's teeth keep a land at their tips."""


def explore(
    ds: xr.Dataset, path: str | os.PathLike[str], *, overwrite: bool = False, teeth: bool = False
) -> Path:
    """Write a page to look through the runs of a dataset, with a slider for each swept key and one for the time.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of gears, a pair or a train, or a sweep, with samples. Of a part of the time,
        ``ds.sel(time=slice(0.1, 0.2))``, the page holds more pictures a second.
    path : path-like
        HTML file to write; it loads nothing from the network.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    teeth : bool, optional
        Whether to add the force and contact state of each pair of teeth with their asperities, for which seven runs at
        most run again; there are none of trains of several meshes.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the dataset is not of gears, has no samples, or the file exists and may not be replaced, or cannot be
        written; with `teeth`, if a run cannot be repeated.

    Notes
    -----
    Gears are drawn to scale from the scene's involutes and the recorded motion; the gaps between their teeth are
    drawn larger, by a factor that the page states. The arrow is the recorded force of all pairs on the gear. Of a train
    the page shows all gears about their centres, gaps to scale too, with an arrow for the load of each hub.
    """
    with whole_file(path, overwrite=overwrite, name="explore") as part:
        part.write_text(build_explorer(ds, teeth=teeth), encoding="utf-8")
    return Path(path)


def build_explorer(ds: xr.Dataset, *, most_values: int = MOST_VALUES, teeth: bool = False) -> str:
    """Make the page of `explore`.

    Parameters
    ----------
    most_values : int, optional
        Numbers to embed at most, without those of `teeth`.
    """
    if teeth:
        refuse_train(ds)
    data = pack_explorer(ds, most_values)
    viewer = '<div id="explorer"></div>\n<noscript><p>The page needs JavaScript.</p></noscript>\n'
    sections = [
        html.section("explore", "Gears and runs", viewer + html.json_block("explorer-data", data)),
        html.section("outcome", "Outcome", html.folded("Outcome of each run", outcome_table(ds))),
    ]
    view = "train.js" if is_train(ds) else "pair.js"
    scripts = ["common.js", "player.js", "mesh.js", "map.js", view, "explorer.js"]
    if teeth:
        player = '<div id="teeth-viewer"></div>\n' + html.json_block("teeth-data", pack_teeth(ds))
        sections.insert(1, html.section("teeth", "Teeth in mesh", player))
        scripts.append("teeth.js")
    return page(ds, "explore", headline(ds), sections, scripts)


def pack_explorer(ds: xr.Dataset, most_values: int = MOST_VALUES) -> dict[str, Any]:
    """Pack the runs of a dataset for the page of `explore`.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of gears or a sweep.
    most_values : int, optional
        Numbers to embed at most.

    Returns
    -------
    dict
        What `gearidae.report.frames.pack_frames` packs, with `FRAME` as ``columns`` and ``gears`` from
        `gearidae.report.gears.pack_gears`, each once; ``gaps`` (how many times their size they are drawn), ``largest``
        force [N] and ``ranges`` of the curves. Of trains what `gearidae.report.trains.pack_trains` packs.

    Raises
    ------
    SceneError
        If the dataset is not of gears or has no samples.
    """
    if is_train(ds):
        return pack_trains(ds, most_values)
    samples = _samples(ds)
    ds = ascending(ds).isel(time=slice(samples))
    packed = [(require_gears(run_scene(run)), run) for _, run in runs(ds)]
    every, size = thinning(samples, len(packed), len(FRAME), len(_CURVES), most_values)
    gaps = min(_factor(scene) for scene, _ in packed)
    gears: list[dict[str, Any]] = []
    shown = []
    for scene, run in packed:
        drawn = pack_gears(scene, gaps=gaps)
        if drawn not in gears:
            gears.append(drawn)
        curves = [reduced(run[name], size) for name in _CURVES]
        shown.append(ShownRun(gears.index(drawn), _frames(scene, run, every), curves))
    return {
        **pack_frames(ds, FRAME, every, gears, shown),
        "gaps": gaps,
        "largest": max(largest_of(run.frames[:, FRAME.index("mesh_force")]) for run in shown),
        "ranges": [range_of([run.curves[k] for run in shown]) for k in range(len(_CURVES))],
    }


def _samples(ds: xr.Dataset) -> int:
    """Samples that the longest run has; a dataset without gears that move is refused."""
    if is_roller(ds):
        raise SceneError(
            "explore", "a roller", "needs gears; gearidae report shows the force and gap of a roller"
        )
    missing = [name for name in ("gear_angle", *FRAME[1:]) if name not in ds.variables]
    if missing:
        raise SceneError("explore", missing[0], "the dataset has no samples of it")
    samples = max(motion_samples(run) for _, run in runs(ds)) if ds.sizes["time"] else 0
    if not samples:
        raise SceneError("explore", "gear_angle", "no run has samples of it")
    return samples


def _factor(scene: GearScene) -> float:
    """How many times their size gaps can be drawn: a whole number, at least 1."""
    backlash = scene.mesh.backlash
    return max(1.0, math.floor(_CLEARANCE * scene.geometry.module / backlash)) if backlash else 1.0


def _frames(scene: GearScene, run: xr.Dataset, every: int) -> Floats:
    """One of so many samples, as far as the run has come, shape (n, columns)."""
    count = motion_samples(run)
    angle, *columns = (picked(run[name], every, count) for name in ("gear_angle", *FRAME[1:]))
    geometry = scene.geometry
    travel = (angle * geometry.base_radius_gear + first_travel(run, scene)) / geometry.base_pitch
    # as many pitches as bring both gears back to where they were: float32 keeps the position of millions of pitches
    return np.stack([travel % math.lcm(geometry.pinion_teeth, geometry.gear_teeth), *columns], axis=1)
