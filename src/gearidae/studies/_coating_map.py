"""Coating maps: how the impact response depends on how much of the monolayer is left.

Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Fig. 10: one line for one pair of gears and one torque.
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gearidae.analysis.impacts import WIDTH, check_width
from gearidae.analysis.ringing import characteristic_frequency, impact_frequencies
from gearidae.archive import dimension_names
from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError
from gearidae.scene import describe_key
from gearidae.scene.carried import numbers_of
from gearidae.scene.keys import scene_value
from gearidae.studies.products import open_map
from gearidae.studies.requirements import require_gears

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.runs.kept_runs import KeptRuns
    from gearidae.runs.sweep_plan import SweepPlan
    from gearidae.scene import Scene

FRACTIONS = np.round(np.linspace(1.0, 0.5, 51), 4)
"""Fractions of a map by default."""
_FRACTION = "coating.sam_fraction"
_TORQUE = "drive.torque"
_PARTS_OF_TORQUE = (0.7, 0.85, 1.0, 1.15, 1.3)
_SPEED = {
    "units": "rad s-1",
    "long_name": "median speed of the gear",
    "comment": "half the samples of the run are slower",
}
_SLOWEST = {
    "units": "rad s-1",
    "long_name": "smallest speed of the gear",
    "comment": "zero or less: it has stopped",
}


def coating_map(
    scene: Scene,
    sam_fraction: ArrayLike | None = None,
    *,
    over: Mapping[str, Iterable[Any]] | str | None = None,
    width: float = WIDTH,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Characteristic frequency against SAM fraction (Teodorescu et al. 2009, Fig. 10).

    With `archive`, every finished run is kept in a folder beside it (``MAP.nc.runs``) until the map is written, so that
    a map that was cut off can be resumed.

    Parameters
    ----------
    scene : Scene
        The pair of gears at the torque and the start that signals will be compared with.
    sam_fraction : array_like, optional
        Fractions of the coating; by default 51 from 1 to 0.5.
    over : mapping of str to iterable, or 'drive.torque', optional
        Values of further keys, such as ``{"drive.torque": [...]}``; one line of the map for each combination. The name
        ``drive.torque`` alone stands for 0.7, 0.85, 1, 1.15 and 1.3 times the scene's torque: what `assess` needs
        where the torque of a record is not known.
    width : float, optional
        Of the impact windows, in pitches, see `impact_windows`.
    executor, jobs, backend, progress
        As for `sweep`.
    archive : path-like, optional
        File to write the map to.
    overwrite : bool, optional
        Whether `archive` may replace a file, and the runs of an unfinished map beside it be discarded.
    resume : bool, optional
        Take the runs that an unfinished map into `archive` has kept, and compute the others only. A file that holds
        this very map already is returned as it is.

    Returns
    -------
    Dataset, dims (..., sam_fraction, impact)
        ``characteristic_frequency`` and its standard ``uncertainty`` [Hz], of the first impact; ``impact_frequency``
        and ``impact_uncertainty`` [Hz] of each, at ``impact_time`` [s]; ``median_gear_speed`` and
        ``min_gear_speed`` [rad/s]. NaN where nothing rings or a run could not go on. The scene and how it was made
        are attributes.

    Raises
    ------
    SceneError
        If the scene is a roller, a key, a value or a setting is not allowed, or the archive cannot be written.
    Interrupted
        On Ctrl-C: a `KeyboardInterrupt` that carries the runs of the line under way as its ``dataset``. Finished runs
        stay beside `archive`.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> chart = gd.analysis.coating_map(scene, [1.0, 0.8, 0.6, 0.5])  # doctest: +SKIP
    """
    # reading and drawing maps must not wait for the solver
    from gearidae.runs.execution import Execution, origin_of, run_kept
    from gearidae.runs.kept_runs import KeptRuns
    from gearidae.runs.sweeping import run_plan

    require_gears(scene)
    fractions = _fractions(sam_fraction)
    width = check_width(width)
    keys = further_keys(scene, over)
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, scene.run.method)
    plans = _plans(scene, fractions, keys, backend)
    numbers = {key: [_number(scene, key, value) for value in listed] for key, listed in keys.items()}

    def work(kept: KeptRuns | None) -> xr.Dataset:
        # one line at a time: what is kept of a run is a few numbers of some megabytes
        lines = [_line(run_plan(plan, how, kept), width) for plan in plans]
        return _assembled(lines, numbers).assign_attrs(_attributes(scene, (_FRACTION, *keys), lines[0].attrs))

    settings = json.dumps({_FRACTION: fractions, **numbers, "width": width})
    return run_kept(
        how,
        lambda target: KeptRuns(target, plans[0].base, how.driver),
        work,
        {**origin_of(scene), "settings": settings},
        read=open_map,
        scenes=[one for plan in plans for one in plan.scenes],
    )


def _plans(
    scene: Scene, fractions: list[float], keys: Mapping[str, list[Any]], backend: str
) -> list[SweepPlan]:
    """Plan the runs of each line of the map, before any of them is run."""
    from gearidae.runs.running import prepare
    from gearidae.runs.sweep_plan import plan_sweep

    plans = []
    for values in itertools.product(*keys.values()):
        changes = dict(zip(keys, values, strict=True))
        base = prepare(
            scene.replace(changes) if changes else scene, rtol=None, t_end=None, samples=None, backend=backend
        )
        plans.append(plan_sweep(base, {_FRACTION: fractions}))
    return plans


def _fractions(given: ArrayLike | None) -> list[float]:
    """Fractions as a list; sweep checks their values."""
    try:
        fractions = np.atleast_1d(numbers_of(FRACTIONS if given is None else given, "1"))
    except (TypeError, ValueError):
        raise SceneError("sam_fraction", given, "must be a list of numbers") from None
    if fractions.ndim != 1:
        raise SceneError("sam_fraction", f"(shape {fractions.shape})", "must be a list of numbers")
    return [float(value) for value in fractions]


def further_keys(scene: Scene, over: object) -> dict[str, list[Any]]:
    """Return the keys of a map beside the fraction, and their values, of `over`; the sweep checks the values."""
    if over is None:
        return {}
    if over == _TORQUE and isinstance(over, str):
        torque = scene.to_dict()["drive"].get("torque", 0.0)
        if not torque > 0.0:
            raise SceneError(
                "over", over, 'needs a drive torque above zero, or values: {"drive.torque": [...]}'
            )
        return {_TORQUE: [torque * part for part in _PARTS_OF_TORQUE]}
    if not isinstance(over, Mapping):
        raise SceneError(
            "over",
            over,
            'must be "drive.torque" or a table of keys and values, {"drive.torque": [4e-18, 5e-18]}',
        )
    if _FRACTION in over:
        raise SceneError("over", _FRACTION, "is the map's own axis: give it as sam_fraction")
    keys: dict[str, list[Any]] = {}
    for key, values in over.items():
        if isinstance(values, str | Mapping) or not isinstance(values, Iterable):
            raise SceneError(str(key), values, "must be a list of values to map over")
        keys[str(key)] = list(values)
        if not keys[str(key)]:
            raise SceneError(str(key), "[]", "must be a list of values to map over")
    return keys


def _line(runs: xr.Dataset, width: float) -> xr.Dataset:
    """One line of the map."""
    impacts = impact_frequencies(runs, width=width)
    first = characteristic_frequency(runs, width=width)
    return xr.Dataset(
        {
            "characteristic_frequency": first.drop_vars(["uncertainty", "impacts"]),
            "uncertainty": first["uncertainty"].drop_vars(["uncertainty", "impacts"]),
            "impact_frequency": impacts["frequency"],
            "impact_uncertainty": impacts["uncertainty"],
            "impact_time": impacts["impact_time"],
            "median_gear_speed": runs["gear_speed"].median("time").assign_attrs(_SPEED),
            "min_gear_speed": runs["gear_speed"].min("time").assign_attrs(_SLOWEST),
        },
        attrs=impacts.attrs,
    )


def _number(scene: Scene, key: str, value: Any) -> Any:
    """A swept value in SI units, as the scene holds it."""
    return scene_value(scene.replace({key: value}), key)


def _assembled(lines: list[xr.Dataset], keys: Mapping[str, list[Any]]) -> xr.Dataset:
    """All lines in one dataset, with a dimension for each further key."""
    if not keys:
        return lines[0]
    names = dimension_names(tuple(keys))
    joined = xr.concat(lines, dim="line", join="outer", combine_attrs="drop_conflicts")
    shape = tuple(len(values) for values in keys.values())
    chart = xr.Dataset(
        {
            str(name): xr.Variable(
                (*names.values(), *variable.dims[1:]),
                variable.values.reshape(*shape, *variable.shape[1:]),
                variable.attrs,
            )
            for name, variable in joined.transpose("line", ...).data_vars.items()
        },
        coords={name: joined[name].variable for name in ("sam_fraction", "impact")},
    )
    for key, name in names.items():
        info = describe_key(key)
        attrs = {"long_name": f"{key}: {info.description}", "units": info.unit or "1"}
        chart = chart.assign_coords({name: (name, keys[key], attrs)})
    return chart


def _attributes(scene: Scene, keys: tuple[str, ...], analysis: Mapping[Any, Any]) -> dict[str, Any]:
    return {
        **provenance(scene, "mapped the impact response", swept=keys),
        "title": f"{scene.name}: coating map",
        "summary": (
            "Frequency at which the loaded teeth ring after each mesh impact, against the fraction of the contact "
            "area that the monolayer covers. The attribute 'scene' holds the gears in SI units."
        ),
        **{str(key): value for key, value in analysis.items()},
    }
