"""A run of a train as its judged pair, for readers of pairs; and any run of gears along shafts and meshes."""

from __future__ import annotations

import xarray as xr

from gearidae.archive.select import TABLE_OF_PAIR, is_train, refuse_parts, run_scene
from gearidae.archive.train.dataset import coordinates
from gearidae.archive.train.variables import COORDINATES, MESH_TOTALS, SHAFT_TOTALS, TRAIN_SAMPLES, TWO_SHAFTS
from gearidae.archive.train.work import MESH_LOSSES
from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.errors import SceneError
from gearidae.scene import GearScene

_OF_SHAFTS = {
    "shaft_speed": ("pinion_speed", "gear_speed"),
    "shaft_angle": ("pinion_angle", "gear_angle"),
    "hub_load": ("pinion_hub_load", "gear_hub_load"),
    "hub_friction": ("pinion_hub_friction", "gear_hub_friction"),
    "hub_loss": ("pinion_hub_loss", "gear_hub_loss"),
    "hub_sliding": ("pinion_hub_sliding", "gear_hub_sliding"),
}
"""Variables along the shafts, and those of a pair that they are made of."""
_OF_MESHES = (
    *("mesh_force", "transmission_error", "drive_gap", "coast_gap", "pairs_in_contact"),
    "asperities_in_contact",
    *MESH_TOTALS,
)


def judged_view(ds: xr.Dataset) -> xr.Dataset:
    """Return a run of a train as that of a pair: the shaft that is judged, the mesh that drives it, the drive.

    Anything else is returned as it is. Losses are those of the whole train, so that the energy balance is whole.

    Raises
    ------
    SceneError
        If some of the shafts or meshes of a train have been selected.
    """
    refuse_parts(ds)
    if not is_train(ds):
        return ds
    losses = {name: ds[name].sum("mesh", keep_attrs=True) for name in MESH_LOSSES if name in ds}
    hubs, drags = ds.get("hub_loss"), ds.get("drag_loss")
    mesh = ds["mesh"].values.tolist().index(ds.attrs["judged_mesh"])
    shaft = ds["shaft"].values.tolist().index(ds.attrs["judged_shaft"])
    view = ds.isel(mesh=mesh, shaft=shaft).drop_vars([name for name in COORDINATES if name in ds.variables])
    view = view.assign(losses)
    if hubs is not None and drags is not None:
        # the pair has one term for all dry resistance, one for all drags; friction of hubs stands at the gear's
        view = view.assign(
            drag_loss=drags.sum("shaft"),
            dry_loss=ds["load_work"] + ds["resistance_loss"].sum("shaft"),
            gear_hub_loss=hubs.sum("shaft"),
        )
        nothing = {name: ((), 0.0) for name in ENERGY_BALANCE if name not in view}
        view = view.assign(nothing)
        for name, variable in ENERGY_BALANCE.items():
            view[name].attrs = variable.attributes
    if "event_mesh" in ds:
        own = (ds["event_mesh"] == mesh) | ((ds["event_mesh"] < 0) & (ds["event_shaft"].isin([-1, shaft])))
        view = view.isel(event=own.values)
    return view


def train_form(ds: xr.Dataset) -> xr.Dataset:
    """Return a run of gears with ``shaft`` and ``mesh``, whatever its scene's form is.

    That of a pair is a table of its variables, for comparisons: what judges and draws runs takes the pair's own.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of a train, which is returned as it is, or of a pair: its shafts are ``pinion`` and ``gear``, its
        mesh is ``mesh``.

    Raises
    ------
    SceneError
        If it is a run of a roller.
    """
    if ds.attrs.get("form") == TABLE_OF_PAIR or is_train(ds):
        return ds
    scene = run_scene(ds)
    if not isinstance(scene, GearScene):
        raise SceneError("dataset", "of a roller", "must be a run of gears")
    train = scene.train
    made = {}
    for name, sides in _OF_SHAFTS.items():
        if all(side in ds for side in sides):
            made[name] = xr.concat([ds[side].drop_attrs() for side in sides], "shaft", coords="minimal")
    for name in _OF_MESHES:
        if name in ds:
            made[name] = ds[name].expand_dims(mesh=1)
    catalogue = {**TRAIN_SAMPLES, **SHAFT_TOTALS, **MESH_TOTALS}
    old = {side for sides in _OF_SHAFTS.values() for side in sides if side in ds}
    two = {name for name in old if name not in TWO_SHAFTS}
    view = ds.drop_vars([*two, *(name for name in _OF_MESHES if name in ds)]).assign(made)
    for name in made:
        if name in catalogue:
            view[name].attrs = catalogue[name].attributes
    names = {"form": TABLE_OF_PAIR, "judged_shaft": "gear", "judged_mesh": "mesh", "drive_shaft": "pinion"}
    return view.assign_coords(coordinates(train, train.load)).assign_attrs(names)
