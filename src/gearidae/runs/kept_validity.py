"""How far the model holds for a scene, kept with its runs: the attribute ``validity`` of an archive."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearidae.archive.select import run_scene, scene_of, swept_dims
from gearidae.scene import Scene
from gearidae.scene.validity_row import ATTRIBUTE, ValidityRow, rows_from_json

if TYPE_CHECKING:
    import xarray as xr


def with_validity(ds: xr.Dataset, scene: Scene) -> xr.Dataset:
    """Add the rows of `gearidae.studies.validity` to a dataset that is about to be written.

    A dataset that stays in memory does without: the rows take about as long as a short run.

    Parameters
    ----------
    scene : Scene
        That was run; of a sweep, the one that its runs were derived from.

    Returns
    -------
    xarray.Dataset
        The same object, with the attribute ``validity``; that of a run has the yielding of asperities at its largest
        force.
    """
    from gearidae.runs.validity import validity_attribute  # loads the contact laws

    ds.attrs[ATTRIBUTE] = validity_attribute(scene, largest_force(ds))
    return ds


def largest_force(ds: xr.Dataset) -> float:
    """Largest force of a run in either direction [N], as its solver kept it; NaN of a sweep, and before a run."""
    if swept_dims(ds):
        return math.nan
    forces = [
        float(abs(ds[name]).max()) for name in ("largest_mesh_force", "smallest_mesh_force") if name in ds
    ]
    return max(forces, default=math.nan)


def validity_of(ds: xr.Dataset) -> list[ValidityRow]:
    """Return how far the model holds for a dataset: the rows that it carries, or else those of its scene.

    Parameters
    ----------
    ds : xarray.Dataset
        A run, a sweep (the rows are those of the scene that its runs were derived from), or one run that was picked
        from a sweep (the rows are its own).

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    swept = swept_dims(ds)
    scene = Scene.from_dict(scene_of(ds)) if swept else run_scene(ds)
    picked = "swept" in ds.attrs and not swept
    if not picked and (rows := rows_from_json(ds.attrs.get(ATTRIBUTE))):
        return rows
    from gearidae.runs.validity import validity_rows

    return validity_rows(scene, largest_force(ds))
