"""Map the frequency of the impact response against the SAM fraction.

Finished runs are kept beside the map, in MAP.nc.journal, until the map is written.
"""

# Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Fig. 10: one line for one pair of gears and one torque.

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gearidae.analysis.impacts import WIDTH, check_width
from gearidae.analysis.ringing import characteristic_frequency, impact_frequencies
from gearidae.archive import dimension_names
from gearidae.archive.provenance import provenance
from gearidae.archive.value_text import coverage_text
from gearidae.archive.variables import COVERAGE_KEY
from gearidae.errors import SceneError
from gearidae.monitor.map_model import FEWEST_GEARS, GEARS, SEEDS, require_map
from gearidae.runs.execution import Execution, RunOptions
from gearidae.runs.running import prepare
from gearidae.runs.sweep_plan import SweepPlan, plan_sweep, values_of
from gearidae.runs.sweeping import run_plan
from gearidae.scene import describe_key, require_gears
from gearidae.scene.carried import numbers_of
from gearidae.scene.keys import scene_value
from gearidae.scene.pairs import sweep_values
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.announcement import grid_words
from gearidae.studies.specimens import gears_of
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from gearidae.runs.run_cache import RunCache
    from gearidae.scene import Scene

FRACTIONS = np.round(np.linspace(1.0, 0.5, 51), 4)
"""Fractions of a map by default."""
_TORQUE = "drive.torque"
_MOST_FRACTIONS: Final = 13
"""Of a line, in the summary."""
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
    seeds: int | None = None,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Characteristic frequency against SAM fraction (Teodorescu et al. 2009, Fig. 10).

    With `archive`, every finished run is kept in a file beside it (``MAP.nc.journal``) until the map is written, so
    that a map that was cut off can be resumed.

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
    seeds : int, optional
        Gears of the design that each point is made of, 5 or more: with seeds of errors of teeth
        (``mesh.pitch_error_rms``), of discrete asperities, or of both, numbered from the scene's own on. The map is
        then that of a gear that has not been measured itself: the scatter between the gears widens what `assess` says.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`.

    Returns
    -------
    Dataset, dims (..., sam_fraction, impact)
        ``characteristic_frequency`` and its standard ``uncertainty`` [Hz], of the first impact; ``impact_frequency``
        and ``impact_uncertainty`` [Hz] of each, at ``impact_time`` [s]; ``median_gear_speed`` and
        ``min_gear_speed`` [rad/s]. NaN where nothing rings, where the contact rings faster than the samples show
        (the attribute ``note`` says so), and of a run that could not be finished, which says so in
        its ``status`` and ``message``. The scene and how it was made are attributes.

        With `seeds` frequencies are geometric means over the gears, NaN where fewer than half of them ring, and
        ``gear_frequency`` [Hz] has those of each gear, dims (..., sam_fraction, impact, gear).

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
    require_gears(scene)
    fractions = _fractions(sam_fraction)
    width = check_width(width)
    keys = further_keys(scene, over)
    execution = Execution(**options, method=scene.run.method)
    gears = [{}] if seeds is None else _gears(scene, seeds)
    plans = _plans(scene, fractions, keys, gears, execution.backend)
    numbers = {key: [_number(scene, key, value) for value in listed] for key, listed in keys.items()}

    def work(kept: RunCache | None) -> xr.Dataset:
        # one line at a time: what is kept of a run is a few numbers of some megabytes
        every = [_line(run_plan(plan, execution, kept), width) for plan in plans]
        notes = [line.attrs for line in every if "note" in line.attrs]
        lines = every
        if seeds is not None:
            lines = [_of_gears(every[first : first + seeds]) for first in range(0, len(every), seeds)]
        return _assembled(lines, numbers).assign_attrs(
            _attributes(scene, (COVERAGE_KEY, *keys), {**every[0].attrs, **(notes[0] if notes else {})}),
            **({} if seeds is None else {SEEDS: seeds}),
        )

    scenes = [run for plan in plans for run in plan.scenes]
    settings = {COVERAGE_KEY: fractions, **numbers, "width": width}
    settings |= {} if seeds is None else {SEEDS: seeds}
    return STUDY.compute(execution, plans[0].base, work, settings, origin=scene, scenes=scenes)


def _gears(scene: Scene, seeds: int) -> Sequence[Mapping[str, int]]:
    """Seeds of the gears of a map."""
    if len(gears := gears_of(scene, seeds)) < FEWEST_GEARS:
        raise SceneError(
            "seeds", seeds, f"must be {FEWEST_GEARS} or more, for a scatter that is known by half"
        )
    return gears


def _plans(
    scene: Scene,
    fractions: list[float],
    keys: Mapping[str, list[Any]],
    gears: Sequence[Mapping[str, int]],
    backend: str,
) -> list[SweepPlan]:
    """Plan the runs of each line of the map, gear by gear, before any of them is run."""
    plans = []
    for values, gear in itertools.product(itertools.product(*keys.values()), gears):
        changes = dict(zip(keys, values, strict=True)) | gear
        base = prepare(
            scene.replace(changes) if changes else scene, rtol=None, t_end=None, samples=None, backend=backend
        )
        plans.append(plan_sweep(base, {COVERAGE_KEY: fractions}))
    return plans


def _fractions(sam_fraction: ArrayLike | None) -> list[float]:
    """Fractions as a list; sweep checks their values."""
    try:
        fractions = np.atleast_1d(numbers_of(FRACTIONS if sam_fraction is None else sam_fraction, "1"))
    except (TypeError, ValueError):
        raise SceneError("sam_fraction", sam_fraction, "must be a list of numbers") from None
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
    if COVERAGE_KEY in over:
        raise SceneError("over", COVERAGE_KEY, "is the map's own axis: give it as sam_fraction")
    return {str(key): values_of(str(key), values) for key, values in over.items()}


def _line(runs: xr.Dataset, width: float) -> xr.Dataset:
    """One line of the map; what a run that could not be finished has left is no frequency of it."""
    finished = runs["status"] == "finished"
    impacts = impact_frequencies(runs, width=width)
    first = characteristic_frequency(runs, width=width)
    line = xr.Dataset(
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
    return line.where(finished).assign({name: runs[name] for name in ("status", "message")})


def _of_gears(lines: list[xr.Dataset]) -> xr.Dataset:
    """One line of a map of the same line of several gears."""
    gears = xr.concat(lines, dim="gear", join="outer", combine_attrs="drop_conflicts")
    count = len(lines)
    logarithm, first = (_log(gears[name]) for name in ("impact_frequency", "characteristic_frequency"))
    rings, first_rings = (2 * values.notnull().sum("gear") >= count for values in (logarithm, first))
    speeds = gears[["median_gear_speed", "min_gear_speed", "impact_time"]].mean("gear", keep_attrs=True)
    speeds["min_gear_speed"] = gears["min_gear_speed"].min("gear", keep_attrs=True)
    unfinished = gears["status"].values != "finished"
    worst = xr.DataArray(unfinished.argmax(axis=0), dims="sam_fraction")
    means = {
        "characteristic_frequency": _exp(first.mean("gear")).where(first_rings),
        "uncertainty": (gears["uncertainty"] ** 2).mean("gear") ** 0.5,
        "impact_frequency": _exp(logarithm.mean("gear")).where(rings),
        "impact_uncertainty": ((gears["impact_uncertainty"] ** 2).mean("gear") ** 0.5).where(rings),
    }
    means = {name: mean.assign_attrs(gears[name].attrs) for name, mean in means.items()}
    every = gears["impact_frequency"].transpose("sam_fraction", "impact", "gear").values
    return (
        xr.Dataset(means | dict(speeds), attrs=lines[0].attrs)
        .assign(STUDY.dataset({GEARS: every, "gear": np.arange(count)}, {}))
        .assign({name: gears[name].isel(gear=worst) for name in ("status", "message")})
    )


def _log(values: xr.DataArray) -> xr.DataArray:
    """Logarithm of frequencies, with their dimensions."""
    return values.copy(data=np.log(values.values))


def _exp(values: xr.DataArray) -> xr.DataArray:
    """Frequencies of their logarithms."""
    return values.copy(data=np.exp(values.values))


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
        coords={name: joined[name].variable for name in ("sam_fraction", "impact", "gear") if name in joined},
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


def _written(
    *,
    over: Annotated[
        list[str] | None,
        Option(
            "SAM fractions, coating.sam_fraction=1:0.5:-0.01, and other keys for several lines; repeatable.",
            repeatable=True,
            completes="keys",
        ),
    ] = None,
) -> dict[str, Any]:
    values = sweep_values([pair for pair in over or [] if pair.strip() != _TORQUE])
    fractions = values.pop(COVERAGE_KEY, FRACTIONS.tolist())
    usual_torques = any(pair.strip() == _TORQUE for pair in over or [])
    if usual_torques and values:
        raise SceneError("--over", _TORQUE, f"needs values beside {', '.join(values)}: {_TORQUE}=4e-18,5e-18")
    return {"sam_fraction": fractions, "over": _TORQUE if usual_torques else values}


def _announced(
    scene: Scene, workers: int | None, *, sam_fraction: list[Any], over: object, seeds: int | None
) -> str:
    gears: dict[str, list[Any]] = {}
    if seeds is not None:
        drawn = gears_of(scene, seeds)  # one key stands for all seeds of a gear
        gears = {key: [gear[key] for gear in drawn] for key in list(drawn[0])[:1]}
    return grid_words(scene, {COVERAGE_KEY: sam_fraction} | further_keys(scene, over) | gears, workers)


def _sentence(ds: xr.Dataset) -> str:
    frequency = ds["characteristic_frequency"].values
    note = f" {str(ds.attrs['note'])[:1].upper()}{str(ds.attrs['note'])[1:]}." if "note" in ds.attrs else ""
    if not np.isfinite(frequency).any():
        return note.strip() or "Nothing rings at any coverage."
    low, high = (with_prefix(float(f(frequency)), "Hz", 4) for f in (np.nanmin, np.nanmax))
    ends = [f"{100.0 * float(f(ds['sam_fraction'])):.4g} %" for f in (np.max, np.min)]
    gears = ""
    if SEEDS in ds.attrs:
        scatter = _log(ds[GEARS].isel(impact=0)).std("gear", ddof=1)
        least, most = (100.0 * float(f(scatter)) for f in (np.nanmin, np.nanmax))
        gears = f" One of {ds.attrs[SEEDS]} gears is {least:.2g} to {most:.2g} % from their mean (standard deviation)."
    return f"From SAM {ends[0]} to {ends[1]} the teeth ring at {low} to {high}.{gears}{note}"


def _rows(ds: xr.Dataset) -> Rows:
    """Frequencies at some of the fractions, line by line."""
    # without the impacts, of which there may be none
    gears = [GEARS] if SEEDS in ds.attrs else []
    ds = ds[["characteristic_frequency", "uncertainty", "min_gear_speed", *gears]]
    further = [dim for dim in ds["characteristic_frequency"].dims if dim != "sam_fraction"]
    lines = ds.stack(line=further) if further else ds.expand_dims("line")
    count = ds.sizes["sam_fraction"]
    picked = np.unique(np.linspace(0, count - 1, min(count, _MOST_FRACTIONS)).round().astype(int))
    for number in range(lines.sizes["line"]):
        line = lines.isel(line=number)
        held = ", ".join(f"{dim} = {line[dim].item():g}" for dim in further)
        yield held or "Frequency of the first impact response", "", ""
        for index in picked:
            point = line.isel(sam_fraction=int(index))
            value, spread = float(point["characteristic_frequency"]), float(point["uncertainty"])
            text = f"{value:.0f} +- {spread:.0f} Hz" if np.isfinite(value) else "-"
            slowest = float(point["min_gear_speed"])
            remark = "" if slowest > 0.0 else "the gear stops within the run"
            if gears and slowest > 0.0 and np.isfinite(value):
                apart = float(_log(point[GEARS].isel(impact=0)).std("gear", ddof=1))
                remark = f"between gears {100.0 * apart:.2g} %"
            if np.isnan(slowest):
                remark = "its run could not be finished"
            yield coverage_text(float(point["sam_fraction"])), text, remark


STUDY = Study(
    kind="coating_map",
    words="coating map",
    maker="coating-map",
    title="Map",
    command=_written,
    options=("seeds",),
    announcement=_announced,
    examples=("gearidae coating-map mine.toml -o map.nc",),
    columns={
        "characteristic_frequency": Column(("sam_fraction",), "Hz", "frequency of the first impact response"),
        "uncertainty": Column(("sam_fraction",), "Hz", "its standard uncertainty"),
        "impact_frequency": Column(("sam_fraction", "impact"), "Hz", "frequency of each impact response"),
        "impact_uncertainty": Column(("sam_fraction", "impact"), "Hz", "its standard uncertainty"),
        "impact_time": Column(("sam_fraction", "impact"), "s", "time of the impact"),
        "median_gear_speed": Column(("sam_fraction",), "rad s-1", "median speed of the gear"),
        "min_gear_speed": Column(("sam_fraction",), "rad s-1", "smallest speed of the gear"),
        GEARS: Column(
            ("sam_fraction", "impact", "gear"), "Hz", "frequency of each impact of each gear", required=False
        ),
        "gear": Column(
            ("gear",), "1", "number of the gear, from 0 for the scene's own seeds", required=False
        ),
    },
    check=require_map,
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("coating_map", "Frequency of the impact response against the coverage"),),
)
