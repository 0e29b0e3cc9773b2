"""Take a dataset apart into its runs: a single run, one picked from a sweep, and a whole sweep alike."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final, NamedTuple

import numpy as np
import xarray as xr

from gearidae.archive.attributes import complete_scene
from gearidae.archive.dataset import dimension_names
from gearidae.archive.pieces import reached
from gearidae.archive.provenance import provenance, surface_regimes
from gearidae.archive.row_variables import DIMS, LABELS, kinds_in, own_rows, row_indices
from gearidae.archive.variables import EXTREMES, OF_SWEPT_RUN, RUN, SAM_FRACTION, SAMPLES, run_label
from gearidae.errors import SceneError
from gearidae.records import sampled_columns
from gearidae.scene import GearScene, Scene, TrainScene
from gearidae.scene.judged import judged_mesh
from gearidae.scene.scene import ONE_STAGE


def scene_of(ds: xr.Dataset) -> dict[str, Any]:
    """Return the scene that a dataset carries, as plain data in SI units.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep` or `open_archive`.

    Returns
    -------
    dict
        Of a sweep, the scene that its runs were derived from; of a run picked from one, its own.

    Raises
    ------
    SceneError
        If the dataset carries none.
    """
    try:
        is_single = "scene" in ds.variables and not ds["scene"].dims
        scene = json.loads(ds["scene"].values.item() if is_single else ds.attrs["scene"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise SceneError(
            "dataset", type(ds).__name__, "must come from simulate, sweep or open_archive"
        ) from error
    if not isinstance(scene, dict):
        raise SceneError("dataset", type(ds).__name__, "must come from simulate, sweep or open_archive")
    complete_scene(scene)
    return scene


def is_roller(ds: xr.Dataset) -> bool:
    """Whether a dataset is of a roller scene, else of a gear pair."""
    return what_of(ds) == "roller"


def what_of(ds: xr.Dataset) -> str:
    """What runs or the members of a study are of: ``roller``, ``train`` of several meshes, or ``gear``."""
    scene = scene_of(ds)
    if scene.get("roller") is not None:
        return "roller"
    return "train" if len(scene.get("meshes") or ()) > 1 else "gear"


TABLE_OF_PAIR: Final = "pair along shaft and mesh"
"""Attribute ``form`` of the table that `gearidae.archive.train.train_form` makes of a pair."""


def is_train(ds: xr.Dataset) -> bool:
    """Whether a dataset is of a train of several meshes.

    Raises
    ------
    SceneError
        If it is a pair's table along shafts and meshes, which is no run.
    """
    if ds.attrs.get("form") == TABLE_OF_PAIR:
        allowed = (
            "is a table to compare with trains, from ds.gearidae.train(): give the run of the pair itself, "
            "and make the table from it again"
        )
        raise SceneError("dataset", f"({TABLE_OF_PAIR})", allowed)
    return "shaft" in ds.dims and "mesh" in ds.dims


def refuse_parts(ds: xr.Dataset) -> None:
    """Refuse a run of a train of which some shafts or meshes are selected: it is judged and drawn as a whole.

    Raises
    ------
    SceneError
        Saying how to select.
    """
    scene = scene_of(ds) if "judged_shaft" in ds.attrs else {}
    for dim, table, variable in (("shaft", "shafts", "shaft_speed"), ("mesh", "meshes", "mesh_force")):
        if dim in ds.coords and ds.sizes.get(dim, 1) < len(scene.get(table, ())):
            names = ", ".join(map(str, ds[dim].values.ravel()))
            allowed = (
                f"must have all shafts and meshes here: select in a variable, as ds.{variable}.sel({dim}=...)"
            )
            raise SceneError("dataset", f"({dim} {names} alone)", allowed)


def refuse_train(ds: xr.Dataset) -> None:
    """Refuse a run of a train of several meshes where single pairs of teeth, or a contact torque, are looked at.

    Raises
    ------
    SceneError
        Saying what there is of trains.
    """
    if is_train(ds):
        raise SceneError(
            "dataset",
            f"of a train ({ds.sizes['mesh']} meshes)",
            "must be of a pair of gears here: of trains there are speeds, forces of meshes, loads of hubs and works, "
            f"and none of single pairs of teeth; gearidae.plot.train draws the whole; {ONE_STAGE}",
        )


class JudgedTeeth(NamedTuple):
    """The pair of gears whose pitch counts, and what the shafts of both are called.

    Attributes
    ----------
    pinion, gear : str
        ``pinion`` and ``gear`` of a pair; of a train names of shafts.
    pinion_teeth, gear_teeth : int
    """

    pinion: str
    gear: str
    pinion_teeth: int
    gear_teeth: int


def judged_teeth(scene: Mapping[str, Any]) -> JudgedTeeth:
    """Return the teeth of a scene as plain data: of its pair, of a train in the mesh that drives the judged shaft.

    Raises
    ------
    KeyError
        If the scene has no gears.
    """
    if "meshes" not in scene:
        return JudgedTeeth(
            "pinion", "gear", int(scene["gears"]["pinion_teeth"]), int(scene["gears"]["gear_teeth"])
        )
    whole = TrainScene.from_dict(dict(scene))
    mesh = whole.train.meshes[judged_mesh(whole)]
    pinion, gear = (whole.train.shafts[shaft].name for shaft in (mesh.a, mesh.b))
    return JudgedTeeth(pinion, gear, mesh.geometry.pinion_teeth, mesh.geometry.gear_teeth)


def swept_dims(ds: xr.Dataset) -> tuple[str, ...]:
    """Dimensions along which the runs of a dataset differ; none for a single run."""
    of_runs = ("status", *sampled_columns(roller=is_roller(ds)), *EXTREMES)
    variable = next((ds[name] for name in of_runs if name in ds), None)
    return () if variable is None else tuple(str(dim) for dim in variable.dims if dim != "time")


def runs(ds: xr.Dataset) -> Iterator[tuple[dict[str, Any], xr.Dataset]]:
    """Go through the runs of a dataset, each with its own rows only.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, a sweep, or a selection from a sweep.

    Yields
    ------
    label : dict
        Dimension to value; empty for a single run.
    run : xarray.Dataset
        The run, without swept dimensions.
    """
    dims = swept_dims(ds)
    ds = own_rows(ds)
    rows = row_indices(ds, dims)
    all_told = all(kind.dim in rows for kind in kinds_in(ds))
    for number, index in enumerate(np.ndindex(*(ds.sizes[dim] for dim in dims))):
        run = ds.isel(dict(zip(dims, index, strict=True)))
        run = run.isel({dim: indices[number] for dim, indices in rows.items()})
        run = run if all_told else own_rows(run)
        yield {dim: run[dim].values.item() for dim in dims}, run


def run_value(run: xr.Dataset, name: str) -> Any:
    """Status or solver statistic of one run: a variable if it comes from a sweep, an attribute otherwise."""
    return run[name].values.item() if name in run.variables else run.attrs[name]


def run_scene(run: xr.Dataset) -> Scene:
    """Return the scene of one run, also of one that was picked from a sweep.

    Parameters
    ----------
    run : xarray.Dataset
        Without swept dimensions.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    if (dims := swept_dims(run)) and any(run.sizes[dim] != 1 for dim in dims):
        raise SceneError("dataset", f"runs along {', '.join(dims)}", "must be a single run: pick one")
    run = run.squeeze(dims) if dims else run
    refuse_other_labels(run)
    scene = Scene.from_dict(scene_of(run))
    if "scene" in run.variables:
        return scene
    swept: Mapping[str, list[Any]] = json.loads(run.attrs.get("swept", "{}"))
    changes = {}
    for key, dim in dimension_names(swept).items():
        if dim not in run.coords:
            raise SceneError("dataset", f"without {dim}", "must be a run of a sweep: its scene is not known")
        value = run[dim].values.item()
        if run[dim].attrs.get("comment"):  # values that are neither numbers nor words are numbered
            if not (isinstance(value, int) and 0 <= value < len(swept[key])):
                raise SceneError("dataset", f"{dim} {value}", f"must number one of {len(swept[key])} values")
            value = swept[key][value]
        changes[key] = value
    return scene.replace(changes)


def refuse_other_labels(ds: xr.Dataset) -> None:
    """Refuse a dataset whose labels differ from its scene's, which `xarray.concat` takes from the first run.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run, a sweep, or a selection from one. A coordinate is a label if it has the name of one key of the
        scene that has a number, as `gearidae.archive.dataset.dimension_names` gives it; swept keys are left out.

    Raises
    ------
    SceneError
        With the key whose label differs.
    """
    if "scene" in ds.variables and ds["scene"].dims:
        return  # each run has its own
    scene = scene_of(ds)
    swept = {} if "scene" in ds.variables else json.loads(ds.attrs.get("swept", "{}"))
    keys = {key: value for key, value in _numbers_in(scene, "") if key not in swept}
    others = {*LABELS, *dimension_names(swept).values()}
    for key, name in dimension_names(list(keys)).items():
        if name not in ds.coords or name in others:
            continue
        label = ds.coords[name]
        if label.dtype.kind not in "fiu":
            continue
        other = label.values[label.values != keys[key]]
        if other.size:
            allowed = f"is not that of its scene, {keys[key]:g}: join runs by gearidae.concat"
            raise SceneError(key, float(other.flat[0]), allowed)


def _numbers_in(table: Mapping[str, Any], above: str) -> Iterator[tuple[str, float]]:
    """Go through the keys of a scene that have a number."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _numbers_in(value, f"{above}{name}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{above}{name}", value


def first_travel(run: xr.Dataset, scene: GearScene) -> float:
    """Travel of the gear along the line of action where its angle is zero [m].

    Parameters
    ----------
    run : xarray.Dataset
        One run of a gear pair; in archives of version 0.2 the angle itself begins at the mesh phase.
    scene : Scene
        Its scene.
    """
    if run["gear_angle"].attrs.get("comment") != SAMPLES["gear_angle"].comment:
        return 0.0
    return scene.initial.mesh_phase * scene.geometry.base_pitch


def motion_samples(run: xr.Dataset) -> int:
    """Return how many samples of the motion a run has; none where the first ones are missing, as in a running mean.

    Parameters
    ----------
    run : xarray.Dataset
        One run of a gear pair.

    Raises
    ------
    SceneError
        If it is one of a train.
    """
    refuse_train(run)
    samples = reached(run["transmission_error"])
    if samples and not np.isfinite(run["transmission_error"].variable[0].values):
        return 0
    for name in ("gear_angle", "gear_speed", "pinion_speed", "mesh_force"):
        if samples and not np.isfinite(run[name].variable[samples - 1].values):
            samples = min(samples, reached(run[name]))
    return samples


def single_run(ds: xr.Dataset) -> xr.Dataset:
    """Make the dataset of a single run of one that was picked from a sweep.

    Parameters
    ----------
    ds : xarray.Dataset
        With one run: picked by ``sel`` or ``isel``, or a single run, which is returned as it is.

    Returns
    -------
    xarray.Dataset
        With the scene, the statistics, the rows of that run alone, where `gearidae.simulate`
        puts them.

    Raises
    ------
    SceneError
        If there are several runs, or their scene is not known.
    """
    if "swept" not in ds.attrs:
        return ds
    scene = run_scene(ds)
    ds = own_rows(ds.squeeze(swept_dims(ds)))
    numbers: dict[str, Any] = {name: ds[name].values.item() for name in (*RUN, *OF_SWEPT_RUN) if name in ds}
    numbers.pop("reached", None)
    swept = [str(name) for name in ds.coords if name not in (*LABELS, SAM_FRACTION.name)]
    gone = {*numbers, *swept, *(f"{dim}_{name}" for dim in DIMS for name in swept)}
    single = ds.drop_vars([name for name in gone if name in ds.variables])
    single = single.assign_coords(run_label(scene))
    of_sweep = ("history", "source", "date_created", "product_version", "backend", "method", "keep")
    if "held_by" in single:  # of a train; a single run has it where something holds
        held = single["held_by"].values.item()
        numbers |= {"held_by": held} if held else {}
        single = single.drop_vars("held_by")
    of_train = ("judged_shaft", "judged_mesh", "drive_shaft")
    single.attrs = {
        **provenance(scene, ""),
        **{name: ds.attrs[name] for name in of_sweep if name in ds.attrs},
        **numbers,
        **({name: ds.attrs[name] for name in of_train} if is_train(ds) else surface_regimes(scene)),
    }
    return single
