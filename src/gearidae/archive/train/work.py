"""Where the work of a train's drive goes: what each mesh, hub, shaft and the load take."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from gearidae.archive.select import is_train
from gearidae.errors import SceneError

if TYPE_CHECKING:
    from gearidae.records.train_results import TrainSolution
    from gearidae.scene import TrainScene

MESH_LOSSES = ("adhesion_loss", "damping_loss", "film_loss", "friction_loss")
SHAFT_LOSSES = ("hub_loss", "resistance_loss", "drag_loss")


class Share(NamedTuple):
    """What one part takes of the drive's work.

    Attributes
    ----------
    name : str
        ``mesh second``, ``hub of middle``, ``drags of middle``, ``pin``, ``load``, ``kinetic energy``, ``contacts``,
        ``not accounted for``.
    energy : float
        [J].
    share : float
        Of the drive's work; the shares add up to 1. NaN where the drive has done none.
    """

    name: str
    energy: float
    share: float


def work_shares(ds: xr.Dataset) -> list[Share]:
    """List what has become of the drive's work in a run of a train.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of a train of several meshes.

    Returns
    -------
    list of Share
        From the drive to the load: each mesh (adhesion, damping, film, friction), each hub, dry resistance and drags
        of each shaft, pin, load, the change of kinetic energy and of that in contacts, less the work of the changing
        radius. Empty of a run that has not followed its balance (``run.balance``).

    Raises
    ------
    SceneError
        If it is no single run of a train of several meshes.
    """
    if not is_train(ds) or "drive_work" not in ds or ds["drive_work"].dims:
        raise SceneError("dataset", type(ds).__name__, "must be a single run of a train of several meshes")
    drive = float(ds["drive_work"])
    if math.isnan(drive):
        return []
    parts = [(name, energy) for name, energy in _parts(ds) if energy != 0.0]
    return [Share(name, energy, energy / drive if drive != 0.0 else math.nan) for name, energy in parts]


def passed_on(ds: xr.Dataset) -> dict[str, float]:
    """Efficiencies of the meshes and hubs of a run, by their names in `work_shares`; NaN where nothing arrived."""
    parts = (("mesh", "mesh", "mesh_efficiency"), ("hub of", "shaft", "hub_efficiency"))
    return {
        f"{words} {name}": float(passed)
        for words, dim, efficiency in parts
        for name, passed in zip(ds[dim].values, ds[efficiency].values, strict=True)
    }


def _parts(ds: xr.Dataset) -> Iterator[tuple[str, float]]:
    for k, name in enumerate(ds["mesh"].values.tolist()):
        yield f"mesh {name}", sum(float(ds[loss][k]) for loss in MESH_LOSSES)
    for words, losses in (("hub", SHAFT_LOSSES[:1]), ("drags", SHAFT_LOSSES[1:])):
        for i, name in enumerate(ds["shaft"].values.tolist()):
            yield f"{words} of {name}", sum(float(ds[loss][i]) for loss in losses)
    yield "pin", float(ds["pin_loss"])
    yield "load", float(ds["load_work"])
    yield "kinetic energy", float(ds["kinetic_change"])
    yield "contacts", float(ds["stored_change"] - ds["radius_work"])
    yield "not accounted for", float(ds["residual"])


def efficiencies(scene: TrainScene, solution: TrainSolution) -> dict[str, Any]:
    """Efficiencies of the meshes, the hubs and the train, by their names in a dataset; NaN where nothing arrived."""
    train, energy = scene.train, solution.energy
    work_in, work_out = (np.asarray(solution.mesh_totals[name]) for name in ("work_in", "work_out"))
    arriving = np.zeros(len(train.shafts))
    np.add.at(arriving, [mesh.b for mesh in train.meshes], work_in)
    arriving[train.drive] = energy["drive_work"]
    lost = sum(float(np.sum(solution.mesh_totals[name])) for name in MESH_LOSSES)
    lost += sum(float(np.sum(solution.shaft_totals[name])) for name in SHAFT_LOSSES)
    lost += energy["pin_loss"] + energy["load_work"]
    return {
        "mesh_efficiency": _over(work_out, work_in),
        "hub_efficiency": 1.0 - _over(np.asarray(solution.shaft_totals["hub_loss"]), arriving),
        "efficiency": float(_over(energy["load_work"], lost if energy["drive_work"] != 0.0 else 0.0)),
    }


def _over(part: Any, whole: Any) -> Any:
    """Ratio of two works; NaN where nothing arrived."""
    there = np.asarray(whole) > 0.0
    return np.where(there, part / np.where(there, whole, 1.0), math.nan)
