"""Search the smallest drive torque at which a gear at rest begins to turn against adhesion.

Of discrete asperities (contact.roughness = "discrete"): the distribution over drawn gears, whose torque rises slowly
until each has turned one pitch. Of a train: the torque without inertia, and what each mesh and hub takes. Of drawn
errors of teeth (mesh.pitch_error_rms), with --seeds: the torque of each gear.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.value_text import coverage_text
from gearidae.archive.variables import COVERAGE_KEY, SAM_FRACTION
from gearidae.errors import SceneError
from gearidae.scene.pairs import sweep_values
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.specimens import gears_text
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.arrays import Floats
    from gearidae.scene import Scene

SEEDS: Final = 20
"""Gears of a population by default."""
SLOW_ENOUGH: Final = 0.1
"""Change of the median by half the rate below which a rate is slow enough."""
_TORQUE_WORDS: Final = "starting torque of the drive"
_OWN: Final = "the drive's own"
_REST: Final = "initial.rest_time"
_ALONG: Final = ("sam_fraction",)
_AFTER: Final = ("rest_time",)


def _written(
    *,
    over: Annotated[
        str | None,
        Option("SAM fractions, coating.sam_fraction=1:0.4:-0.1. Default: the coating of the case as it is."),
    ] = None,
    rest: Annotated[
        str | None, Option("Times at rest before the start, 1 ms,1 s: of hubs and a pin that age.")
    ] = None,
) -> dict[str, Any]:
    fractions: Any = "own"
    if over is not None:
        ((key, fractions),) = sweep_values([over]).items()
        if key != COVERAGE_KEY:
            raise SceneError(
                "--over", over, f"must be {COVERAGE_KEY} and its values; set other keys by --set"
            )
    times = None if rest is None else sweep_values([f"{_REST}={rest}"])[_REST]
    return {"sam_fraction": fractions, "rest_time": times}


def _announced(
    scene: Scene, _: int | None, *, sam_fraction: Any, rest_time: Any, seeds: int | None, **__: Any
) -> str:
    coatings = "own coating" if sam_fraction == "own" else f"{len(sam_fraction)} fractions of the coating"
    coatings += "" if rest_time is None else f", {len(rest_time)} times at rest"
    if not scene.contact.is_discrete:
        each = "" if seeds is None else f"{gears_text(seeds)}, "
        return f"{each}{coatings}; one torque is tried after the other"
    return f"{gears_text(seeds or SEEDS)}, {coatings}; each is run several times, with a torque that rises slowly"


def _train_sentence(ds: xr.Dataset) -> str:
    """Say what starts a train, and what takes most of it."""
    shaft, torques, static = ds.attrs["drive_shaft"], _simulated(ds).values, ds["static_torque"].values
    slowly = "" if np.isfinite(ds["simulated_torque"]).any() else ", without inertia"
    low, high = (with_prefix(float(f(torques)), "N m", 4) for f in (np.min, np.max))
    if ds.sizes["sam_fraction"] > 1:
        return f"The train starts at {low} to {high} on {shaft}, by its coating{slowly}."
    if math.isinf(static[0]):
        return f"No torque on {shaft} starts the train: adhesion or a hub locks it."
    parts = ds["parts"].isel(sam_fraction=0)
    most = parts.isel(part=int(np.argmax(parts.values)))
    share = 100.0 * float(most) / float(static[0]) if static[0] > 0.0 else 0.0
    taken = f"; {most['part'].item()} takes {share:.3g} % of it" if share > 0.0 else ""
    also = (
        ""
        if slowly or math.isnan(static[0])
        else f", at {with_prefix(float(static[0]), 'N m', 4)} without inertia"
    )
    return f"The train starts at {low} on {shaft}{slowly}{also}{taken}."


def _sentence(ds: xr.Dataset) -> str:
    if "drive_shaft" in ds.attrs:
        return _train_sentence(ds)
    if ds.sizes["sam_fraction"] > 1:
        torques = _simulated(ds).values
        low, high = (with_prefix(float(f(torques)), "N m", 4) for f in (np.nanmin, np.nanmax))
        return f"A gear at rest starts at {low} to {high} on the pinion, by its coating."
    torque, drive = float(_simulated(ds)[0]), float(ds.attrs.get("drive_torque", math.nan))
    if torque == float(ds["simulated_stuck"][0]):
        starts = f"it starts at {with_prefix(torque, 'N m', 4)} on the pinion"
        return f"Adhesion of the teeth does not hold a gear at rest: {starts}."
    starts = f"A gear at rest starts at {with_prefix(torque, 'N m', 4)} on the pinion"
    if not drive > 0.0:
        return f"{starts}."
    verdict = "starts it" if drive >= torque else "does not start it"
    return f"{starts}: the drive's own {with_prefix(drive, 'N m', 4)} {verdict}."


def _rests_sentence(ds: xr.Dataset) -> str:
    """Say what the shortest and the longest rest need."""
    ordered = ds.isel(rest_time=np.argsort(ds["rest_time"].values))
    torques, times = _simulated(ordered).values, ordered["rest_time"].values
    needs = [
        f"{with_prefix(float(torques[i]), 'N m', 4)} after {_time(float(times[i]))} at rest"
        for i in ((0, -1) if times.size > 1 else (0,))
    ]
    return f"The gear starts at {' and at '.join(needs)}, torque on the pinion."


def _time(seconds: float) -> str:
    return with_prefix(seconds, "s", 4) if seconds > 0.0 else "no time"


def _simulated(ds: xr.Dataset) -> xr.DataArray:
    """Simulated torques; static ones if none have been simulated."""
    simulated = ds["simulated_torque"]
    return simulated if np.isfinite(simulated).any() else ds["static_torque"]


def _points(ds: xr.Dataset) -> list[tuple[str, xr.Dataset]]:
    """Coverages or times at rest in words, and what has been found there."""
    if "rest_time" in ds.dims:
        points = [ds.isel(rest_time=number) for number in range(ds.sizes["rest_time"])]
        return [(f"after {_time(float(point['rest_time']))} at rest", point) for point in points]
    points = [ds.isel(sam_fraction=number) for number in range(ds.sizes["sam_fraction"])]
    return [(coverage_text(float(point["sam_fraction"])), point) for point in points]


def _rows(ds: xr.Dataset) -> Rows:
    """Torques at each coverage or after each rest."""
    shaft = ds.attrs.get("drive_shaft", "the pinion")
    yield f"Starting torque on {shaft}", "simulated", "sticks at, and without inertia"
    for name, point in _points(ds):
        turns, sticks, static = (
            with_prefix(float(point[which]), "N m", 4)
            for which in ("simulated_torque", "simulated_stuck", "static_torque")
        )
        also = "" if np.isnan(point["static_torque"]) else f", static {static}"
        words = f"sticks at {sticks}{also}"
        if np.isnan(point["simulated_torque"]):
            turns, words = "-", f"no simulated torque{also}"
            message = str(point["message"].values) if "message" in point else ""
            words += f": {message}" if message else ""
        yield name, turns, words
        if "parts" in point:
            yield from _parts(point["parts"], "of the static torque")


def _parts(parts: xr.DataArray, words: str) -> Rows:
    """Parts of a starting torque, where there are several."""
    taken = [
        (str(name), float(value)) for name, value in zip(parts["part"].values, parts.values, strict=True)
    ]
    taken = [(name, value) for name, value in taken if value != 0.0 and np.isfinite(value)]
    for name, value in taken if len(taken) > 1 else ():
        yield name, with_prefix(value, "N m", 3), words


def _gears_sentence(ds: xr.Dataset) -> str:
    """Say what the gears of the worst coverage or after the longest rest need, and how many the drive starts."""
    longest = -ds["rest_time"] if "rest_time" in ds.dims else ds["sam_fraction"]
    name, worst = _points(ds)[int(np.argmin(longest.values))]
    count, middle = _followed(worst), _torque(worst["quantiles"].sel(quantile=0.5), worst)
    sentence = f"{name[0].upper()}{name[1:]}: {_half(count)} at {middle} on the pinion"
    drive = float(ds.attrs.get("drive_torque", math.nan))
    if not drive > 0.0:
        return f"{sentence}."
    started = int(worst["starts"].sum())
    how_many = f"starts {started} of them"
    if count == 1:
        how_many = "starts it" if started else "does not start it"
    return f"{sentence}; the drive's own {with_prefix(drive, 'N m', 4)} {how_many}."


def _half(count: int) -> str:
    """Begin a sentence about the median of some gears."""
    return "one gear of this design starts" if count == 1 else f"half of {count} gears of this design start"


def _teeth_sentence(ds: xr.Dataset) -> str:
    """Say what the gears of the worst coverage need."""
    coated, worst = _points(ds)[int(np.argmin(ds["sam_fraction"].values))]
    low, middle, high = (_found(value) for value in worst["quantiles"].values.tolist())
    count = _followed_teeth(worst)
    spread = "" if count == 1 else f", 80 % of them between {low} and {high}"
    return f"{coated}: {_half(count)} at {middle} on the pinion{spread}."


def _followed_teeth(point: xr.Dataset) -> int:
    return int((point["message"] == "").sum())


def _found(torque: float) -> str:
    return with_prefix(torque, "N m", 3) if math.isfinite(torque) else "more than was tried"


def _teeth_rows(ds: xr.Dataset) -> Rows:
    """Quantiles, chance and failures at each coverage."""
    drive = float(ds.attrs["drive_torque"])
    for name, point in _points(ds):
        count = _followed_teeth(point)
        yield f"Starting torque of {gears_text(count)}, {name}", "", ""
        for share, torque in zip(
            point["quantile"].values.tolist(), point["quantiles"].values.tolist(), strict=True
        ):
            yield f"{100.0 * share:.0f} % of the gears start below", _found(torque), ""
        yield "teeth without errors", _found(float(point["static_torque"])), "static: without inertia"
        if drive > 0.0:
            started = round(float(point["chance"]) * count)
            words = f"{started} of {count} start at the drive's own {with_prefix(drive, 'N m', 4)}"
            yield "chance of starting", f"{float(point['chance']):.3g}", words
        yield from _failures(point)


def _gears_rows(ds: xr.Dataset) -> Rows:
    """Quantiles, gears that did not start, chance at the drive's own torque, and rate, at each point."""
    drive = float(ds.attrs.get("drive_torque", math.nan))
    for name, point in _points(ds):
        count = _followed(point)
        yield f"Starting torque of {gears_text(count)}, {name}", "", ""
        for share in point["quantile"].values.tolist():
            below = f"{100.0 * share:.0f} % of the gears start below"
            yield below, _torque(point["quantiles"].sel(quantile=share), point), ""
        if "parts" in point and np.isfinite(point["parts"]).any():
            yield from _parts(point["parts"].median("seed", skipna=True), "median of the gears that start")
        if failed := point.sizes["seed"] - count:
            yield "left out", f"{failed} of {point.sizes['seed']}", "their runs could not be finished"
            yield from _failures(point)
        rests = round(float(point["not_started"]) * count)
        yield (
            "not started",
            f"{rests} of {count}",
            f"when the ramp ended at {_torque(point['ramp_end'], point)}",
        )
        if drive > 0.0:
            started = int(point["starts"].sum())
            turned = f"turn one pitch at the drive's own {with_prefix(drive, 'N m', 4)}, there at once"
            yield "chance of starting", f"{started / count:.3g}", f"{started} of {count} {turned}"
        change = float(point["median_change"])
        words = f"twice this rate changes the median by {100.0 * change:.2g} %"
        words += "" if change < SLOW_ENOUGH else ": not slow enough to rely on it"
        yield "rate of the torque", f"{with_prefix(1e-3 * float(point['rate']), 'N m', 3)} per ms", words
        if "age" in point and np.isfinite(point["age"]).any():
            age = float(point["age"].median("seed", skipna=True))
            yield "age of the joints at the start", _time(age), "median of the gears that start"
        yield (
            "damping of the mesh",
            f"{float(point['damping']):.3g} N s/m",
            "at least 3 % of critical in this study",
        )


def _failures(point: xr.Dataset) -> Rows:
    """Gears that are left out, and why."""
    if "message" in point:
        for seed, message in zip(
            point["seed"].values.tolist(), point["message"].values.tolist(), strict=True
        ):
            if message:
                yield f"gear of seed {seed}", "-", message


def _followed(point: xr.Dataset) -> int:
    """Gears whose runs could be finished."""
    return point.sizes["seed"] - (int(point["failed"].sum()) if "failed" in point else 0)


def _torque(value: xr.DataArray, point: xr.Dataset) -> str:
    if np.isfinite(value):
        return with_prefix(float(value), "N m", 3)
    return f"more than {with_prefix(float(point['ramp_end']), 'N m', 3)}"


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the starting torque against the SAM fraction.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.starting_torque`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        On a logarithmic scale; fractions at which adhesion does not hold the gear have no point.

    Raises
    ------
    SceneError
        If the dataset is none of starting torques, or adhesion holds the gear nowhere.
    """
    from matplotlib.ticker import StrMethodFormatter

    from gearidae.drawing.parameter_axis import parameter_axis
    from gearidae.drawing.style import label_axis

    STUDY.require(ds)
    along = parameter_axis(ds["sam_fraction"])
    percent = along.positions
    ax = _torques_over(ds, percent, ax)
    ax.set_yscale("log")
    label_axis(ax.yaxis, f"starting torque on {ds.attrs.get('drive_shaft', 'the pinion')}", "N m")
    ax.set_xlabel(along.label)
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    if len(percent) > 1:
        ax.set_xlim(percent.min(), percent.max())
    else:
        ax.set_xticks(percent)
    return ax


def picture_of_rests(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the starting torque over the time at rest.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.starting_torque` with times at rest.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With times on a logarithmic scale; a start without rest is drawn at a tenth of the shortest time.

    Raises
    ------
    SceneError
        If the dataset is something else, or nothing holds the gear.
    """
    from gearidae.drawing.style import label_axis

    RESTS.require(ds)
    ds = ds.sortby("rest_time")
    times = ds["rest_time"].values
    shortest = float(times[times > 0.0].min()) if (times > 0.0).any() else 1.0
    ax = _torques_over(ds, np.where(times > 0.0, times, 0.1 * shortest), ax)
    ax.set_xscale("log")
    ax.set_ylim(bottom=0.0)
    label_axis(ax.yaxis, _TORQUE_WORDS, "N m")
    label_axis(ax.xaxis, "time at rest", "s")
    return ax


def _torques_over(ds: xr.Dataset, positions: Floats, ax: Axes | None) -> Axes:
    """Draw both torques over some places, and the drive's own."""
    from gearidae.drawing.style import line_colour, line_style, line_width, mark_value, new_axes, tidy

    ax = new_axes(ax, height=3.8)
    drawn = False
    for number, (name, label) in enumerate(
        (("static_torque", "static: without inertia"), ("simulated_torque", "simulated: from rest"))
    ):
        torque = ds[name].values
        held = np.isfinite(torque) & (torque > 0.0)
        if held.any():
            drawn = True
            ax.plot(
                positions[held],
                torque[held],
                color=line_colour(number),
                linestyle=line_style(number),
                marker=".",
                linewidth=line_width(1.2),
                label=label,
            )
    if not drawn:
        raise SceneError("plot", "starting_torque", "adhesion does not hold the gear at any of these points")
    tidy(ax)
    if ds.attrs.get("drive_torque", 0.0) > 0.0:
        mark_value(ax.axhline, ds.attrs["drive_torque"], _OWN)
    ax.legend(frameon=False, fontsize="small")
    return ax


def picture_of_gears(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the distribution function of a population's starting torques, a line for each coverage or time at rest.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.starting_torque` of a scene with a population.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With the drive's own torque; gears that did not start are missing from the top of their line.

    Raises
    ------
    SceneError
        If the dataset is something else, or no gear has started.
    """
    (GEAR_RESTS if "rest_time" in ds.dims else GEARS).require(ds)
    return _distribution(ds, ax)


def picture_of_teeth(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the distribution function of the starting torques of gears whose teeth have errors.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.starting_torque` with seeds, of smooth contacts.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        As for a population; gears that adhesion does not hold count from the left edge on.

    Raises
    ------
    SceneError
        If the dataset is something else, or no gear has started.
    """
    TEETH.require(ds)
    return _distribution(ds, ax)


def _distribution(ds: xr.Dataset, ax: Axes | None) -> Axes:
    """Draw which share of the gears starts below a torque, a line for each coverage."""
    from matplotlib.ticker import LogLocator, NullFormatter

    from gearidae.drawing.style import (
        label_axis,
        line_colour,
        line_style,
        line_width,
        mark_value,
        new_axes,
        tidy,
    )

    if not np.isfinite(ds["starting_torque"]).any():
        raise SceneError("plot", "starting_torques", "no gear has started")
    ax = new_axes(ax, height=3.8)
    count = ds.sizes["seed"]
    for number, (name, point) in enumerate(_points(ds)):
        torques = point["starting_torque"]
        torque = np.sort(torques.values[np.isfinite(torques.values)])
        ax.step(
            torque,
            np.arange(1, torque.size + 1) / count,
            where="post",
            color=line_colour(number),
            linestyle=line_style(number),
            marker=".",
            linewidth=line_width(1.2),
            label=name,
        )
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylim(0.0, 1.02)
    label_axis(ax.xaxis, _TORQUE_WORDS, "N m")
    ax.set_ylabel(f"share of {gears_text(count)}")
    tidy(ax)
    if ds.attrs.get("drive_torque", 0.0) > 0.0:
        mark_value(ax.axvline, ds.attrs["drive_torque"], _OWN)
    ax.legend(frameon=False, fontsize="small")
    return ax


def _torque_columns(along: tuple[str]) -> dict[str, Column]:
    """Columns of starting torques along the coverage or the time at rest."""
    return {
        "static_torque": Column(along, "N m", "starting torque without inertia"),
        "simulated_torque": Column(
            along, "N m", "smallest simulated torque at which the gear turns from rest"
        ),
        "simulated_stuck": Column(along, "N m", "largest simulated torque at which the gear sticks"),
        "parts": Column((*along, "part"), "N m", "what each part takes of the static torque", required=False),
        "part": Column(("part",), "", "what takes a starting torque", required=False),
        "message": Column(along, "", "how the run of a torque has failed", required=False),
    }


def _gear_columns(along: tuple[str]) -> dict[str, Column]:
    """Columns of a population's starting torques along the coverage or the time at rest."""
    return {
        "starting_torque": Column(
            (*along, "seed"), "N m", "torque at the last moment of rest; NaN if the gear did not start"
        ),
        "starts": Column(
            (*along, "seed"), "1", "whether the drive's own torque turns the gear from rest by one pitch"
        ),
        "failed": Column(
            (*along, "seed"),
            "1",
            "whether the run of the gear could not be finished: shares are those of the others",
            required=False,
        ),
        "parts": Column(
            (*along, "seed", "part"), "N m", "what each part takes of the starting torque", required=False
        ),
        "part": Column(("part",), "", "what takes a starting torque", required=False),
        "age": Column(
            (*along, "seed"),
            "s",
            "age of the joints at the last moment of rest: the time at rest before, and in the run",
            required=False,
        ),
        "message": Column((*along, "seed"), "", "how the run of the gear has failed", required=False),
        "place": Column(("seed",), "1", "place of the start, in pitches", required=False),
        "quantiles": Column(
            (*along, "quantile"),
            "N m",
            "quantiles of the starting torque, gears that did not start included; NaN beyond the ramp",
        ),
        "not_started": Column(along, "1", "share that had not started when the ramp ended"),
        "chance": Column(along, "1", "share that the drive's own torque starts"),
        "rate": Column(along, "N m s-1", "rise of the torque"),
        "ramp_end": Column(along, "N m", "torque at which the ramp ended", required=False),
        "median_change": Column(along, "1", "relative change of the median from twice this rate"),
        "damping": Column(along, "N s m-1", "damping of the mesh"),
        "seed": Column(("seed",), "1", "contact.seed of the gear", required=False),
        "quantile": Column(("quantile",), "1", "share of the gears below", required=False),
    }


def coordinate(study: Study, points: Sequence[float]) -> dict[str, tuple[str, Floats, dict[str, str]]]:
    """Coordinate of one of these studies: its coverages, or its times at rest."""
    if "rest_time" in study.columns:
        return {"rest_time": ("rest_time", np.array(points), study.columns["rest_time"].attributes())}
    return {"sam_fraction": ("sam_fraction", np.array(points), SAM_FRACTION.attributes)}


STUDY = Study(
    kind="starting_torque",
    words="study of starting torques",
    maker="starting-torque",
    title="Starting torque",
    command=_written,
    options=("impacts", "lowest", "tolerance", "seeds"),
    announcement=_announced,
    examples=(
        "gearidae starting-torque mine.toml",
        "gearidae starting-torque mine.toml --over coating.sam_fraction=1:0.4:-0.1 --impacts 1",
        'gearidae starting-torque mine.toml --rest "1 ms,1 s"',
        "gearidae starting-torque mine.toml --set mesh.pitch_error_rms='3 nm' --seeds 20",
    ),
    columns=_torque_columns(_ALONG),
    sentence=_sentence,
    rows=_rows,
    pictures=(
        Picture("starting_torque", "Smallest torque at which a gear at rest begins to turn", draw=picture),
    ),
)
RESTS = Study(
    kind="starting_rests",
    words="study of starting torques over the time at rest",
    maker="starting-torque --rest",
    columns={
        "rest_time": Column(_AFTER, "s", "time at rest before the start"),
        **_torque_columns(_AFTER),
    },
    sentence=_rests_sentence,
    rows=_rows,
    pictures=(
        Picture(
            "starting_rests",
            "Smallest torque at which a gear that has stood begins to turn",
            draw=picture_of_rests,
        ),
    ),
)
GEARS = Study(
    kind="starting_torques",
    words="study of a population's starting torques",
    maker="starting-torque",
    columns=_gear_columns(_ALONG),
    sentence=_gears_sentence,
    rows=_gears_rows,
    pictures=(
        Picture("starting_torques", "Share of the gears that start below a torque", draw=picture_of_gears),
    ),
)
GEAR_RESTS = Study(
    kind="starting_torques_rests",
    words="study of a population's starting torques over the time at rest",
    maker="starting-torque --rest",
    columns={
        "rest_time": Column(_AFTER, "s", "time at rest before the start"),
        **_gear_columns(_AFTER),
    },
    sentence=_gears_sentence,
    rows=_gears_rows,
    pictures=(
        Picture(
            "starting_torques_rests",
            "Share of the gears that have stood which start below a torque",
            draw=picture_of_gears,
        ),
    ),
)
TEETH = Study(
    kind="starting_teeth",
    words="study of starting torques of gears with errors of teeth",
    maker="starting-torque --seeds",
    columns={
        "starting_torque": Column(
            (*_ALONG, "seed"), "N m", "smallest simulated torque at which the gear turns from rest"
        ),
        "stuck_torque": Column((*_ALONG, "seed"), "N m", "largest simulated torque at which it sticks"),
        "quantiles": Column(
            (*_ALONG, "quantile"), "N m", "quantiles of the starting torque; NaN beyond those tried"
        ),
        "not_started": Column(_ALONG, "1", "share that no torque has started"),
        "chance": Column(_ALONG, "1", "share that the drive's own torque starts"),
        "static_torque": Column(_ALONG, "N m", "starting torque without inertia, of teeth without errors"),
        "message": Column((*_ALONG, "seed"), "", "how the run of the gear has failed", required=False),
        "seed": Column(("seed",), "1", "seed of the gear", required=False),
        "quantile": Column(("quantile",), "1", "share of the gears below", required=False),
    },
    sentence=_teeth_sentence,
    rows=_teeth_rows,
    pictures=(
        Picture("starting_teeth", "Share of the gears that start below a torque", draw=picture_of_teeth),
    ),
)
