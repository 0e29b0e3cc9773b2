"""Runs of trains for the page of `explore`: where each gear stands, forces of meshes, loads of hubs; ``train.js``."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.pieces import reached
from gearidae.archive.select import refuse_parts, run_scene, runs
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.plot.train_shape import PlacedGear, pitch_point
from gearidae.plot.train_view import LONGEST, NO_ARROW, OF_MESHES, OF_SHAFTS, SHORTEST, placed_gears
from gearidae.report.frames import ShownRun, largest_of, pack_frames, picked, range_of, thinning
from gearidae.report.outcomes import ascending
from gearidae.report.series import reduced
from gearidae.scene import is_long_train
from gearidae.scene.train import Train

_PLOTS: Final = (("shaft_speed", "shaft"), ("mesh_force", "mesh"), ("hub_load", "shaft"))
"""Curves over time, one for each shaft or mesh."""


def pack_trains(ds: xr.Dataset, most_values: int) -> dict[str, Any]:
    """Pack the runs of a dataset of trains for the page of `explore`.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of a train of several meshes, or a sweep.
    most_values : int
        Numbers to embed at most.

    Returns
    -------
    dict
        What `gearidae.report.frames.pack_frames` packs, and the names of ``shafts`` and ``meshes``, which shaft is
        ``judged``, the ``largest`` load of a hub [N], how arrows show it (``arrows``: ``longest`` over the diagonal,
        ``shortest`` over the longest, ``least`` load that has one over the largest) and ``ranges`` of the curves:
        speeds over those that the ratios give a shaft, forces of meshes, loads of hubs. Each of the ``gears`` holds the
        ``wheels``, ``hubs`` and ``pitches`` of a train; lengths in um.

    Raises
    ------
    SceneError
        If the dataset has no samples.
    """
    refuse_parts(ds)
    samples = _samples(ds)
    ds = ascending(ds).isel(time=slice(samples))
    members = [run for _, run in runs(ds)]
    shafts, meshes = (ds[dim].values.tolist() for dim in ("shaft", "mesh"))
    columns = [f"{name} {shaft}" for name in OF_SHAFTS for shaft in shafts]
    columns += [f"{name} {mesh}" for name in OF_MESHES for mesh in meshes]
    curves = 2 * len(shafts) + len(meshes)
    every, size = thinning(samples, len(members), len(columns), curves, most_values)
    gears: list[dict[str, Any]] = []
    shown = []
    for run in members:
        train, count = _train(run), _reached(run)
        number = 0
        if count:
            drawn = _pack_train(train, placed_gears(run))
            if drawn not in gears:
                gears.append(drawn)
            number = gears.index(drawn)
        shown.append(ShownRun(number, _frames(run, every, count), _curves(run, train, size)))
    loads = slice(2 * len(shafts), 3 * len(shafts))
    return {
        **pack_frames(ds, columns, every, gears, shown),
        "shafts": shafts,
        "meshes": meshes,
        "judged": shafts.index(ds.attrs["judged_shaft"]),
        "largest": max(largest_of(run.frames[:, loads]) for run in shown),
        "arrows": {"longest": LONGEST, "shortest": SHORTEST, "least": NO_ARROW},
        "ranges": [range_of(lines) for lines in _by_plot([run.curves for run in shown], shafts, meshes)],
    }


def _samples(ds: xr.Dataset) -> int:
    """Samples that the longest run has."""
    missing = [name for name in (*OF_SHAFTS, *OF_MESHES, "transmission_error") if name not in ds]
    if missing:
        raise SceneError("explore", missing[0], "the dataset has no samples of it")
    samples = max(_reached(run) for _, run in runs(ds)) if ds.sizes["time"] else 0
    if not samples:
        raise SceneError("explore", "shaft_angle", "no run has samples of it")
    return samples


def _reached(run: xr.Dataset) -> int:
    return reached(run["shaft_angle"].isel(shaft=0))


def _train(run: xr.Dataset) -> Train:
    scene = run_scene(run)
    assert is_long_train(scene)
    return scene.train


def _frames(run: xr.Dataset, every: int, count: int) -> Floats:
    """One of so many samples, as far as the run has come, shape (n, columns)."""
    columns = [
        # float32 keeps the angle of one turn to less than a nanometre of a gear, not that of thousands
        values % (2.0 * math.pi) if name == "shaft_angle" else values
        for name in (*OF_SHAFTS, *OF_MESHES)
        for values in (picked(line, every, count) for line in _lines(run, name))
    ]
    return np.stack(columns, axis=1)


def _curves(run: xr.Dataset, train: Train, size: int) -> list[Floats]:
    """Curves of all plots; speeds as the judged shaft has them where all turn by their ratios."""
    judged = train.shafts[[shaft.name for shaft in train.shafts].index(run.attrs["judged_shaft"])]
    found = []
    for name, _ in _PLOTS:
        for k, line in enumerate(_lines(run, name)):
            ratio = float(train.shafts[k].ratio / judged.ratio) if name == "shaft_speed" else 1.0
            found.append(reduced(line, size) / ratio)
    return found


def _lines(run: xr.Dataset, name: str) -> list[xr.DataArray]:
    """Variable of each shaft, or of each mesh."""
    dim = next(str(dim) for dim in run[name].dims if dim != "time")
    return [run[name].isel({dim: k}) for k in range(run.sizes[dim])]


def _by_plot(curves: list[list[Floats]], shafts: list[str], meshes: list[str]) -> list[list[Floats]]:
    """Put the curves of all runs together that are in one plot."""
    first, found = 0, []
    for _, dim in _PLOTS:
        last = first + len(shafts if dim == "shaft" else meshes)
        found.append([curve for run in curves for curve in run[first:last]])
        first = last
    return found


def _pack_train(train: Train, gears: tuple[PlacedGear, ...]) -> dict[str, Any]:
    numbers = {gear.name: number for number, gear in enumerate(gears)}
    return {
        "wheels": [_wheel(gear) for gear in gears],
        "hubs": [_micro(np.array(shaft.centre)) for shaft in train.shafts],
        "pitches": [
            {
                "at": _micro(pitch_point(train, mesh)),
                "module": 1e6 * mesh.geometry.module,
                "wheels": [numbers[mesh.driver], numbers[mesh.driven]],
            }
            for mesh in train.meshes
        ],
    }


def _wheel(gear: PlacedGear) -> dict[str, Any]:
    """Pack a gear by its tooth 0 and the angle from one tooth to the next [rad], counter-clockwise."""
    size = len(gear.points) // gear.teeth
    (x, y), (a, b) = gear.points[0], gear.points[size]
    return {
        "shaft": gear.shaft,
        "centre": _micro(gear.centre),
        "tooth": _micro(gear.points[:size]),
        "teeth": gear.teeth,
        "step": math.copysign(2.0 * math.pi / gear.teeth, x * b - y * a),
        "mark": _micro(gear.mark),
        "reach": round(1e6 * gear.tip_radius, 4),
        "sense": gear.sense,
    }


def _micro(points: Floats) -> list[float]:
    """Numbers of points in um, to 0.1 nm."""
    return [round(float(number), 4) for number in (1e6 * points).ravel()]
