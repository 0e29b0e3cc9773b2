"""Search where the gear begins to stick, against the number of mesh exits waited for."""

# Every mesh exit is a tooth that adhesion may hold back, so that a verdict holds for the exits that were waited for.
# One run that sticks after k exits answers for all numbers of exits: it passes up to k of them and no more.

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Unpack

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.judge import is_scheduled
from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError, SolverError
from gearidae.runs.execution import RunOptions, SideBySide, prepared
from gearidae.runs.run_cache import RunCache
from gearidae.runs.sweep_plan import values_of
from gearidae.scene import is_long_train, require_gears, require_meshes
from gearidae.scene.keys import find_key
from gearidae.scene.pairs import sweep_values
from gearidae.scene.quantity import number, whole
from gearidae.studies.bracket import bracket
from gearidae.studies.specimens import gears_of, gears_text, seed_of, seeds_that_draw
from gearidae.studies.study import Column, Option, Picture, Rows, Study
from gearidae.studies.threshold_run import ThresholdRun, run_until, value_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.scene import Scene

log = logging.getLogger(__name__)

_PARTS = 4
"""Parts into which a bracket is divided at a time, however many runs go side by side: results do not depend on that."""
_WIDTH = 1.0 / 256.0
"""Usual width of a bracket over that of `between`."""
_PATIENCE = 1.5
"""Time that a run gets, over that of the exits at the steady speed."""
_USUAL = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


def sticking_threshold(
    scene: Scene,
    over: str = "coating.sam_fraction",
    between: tuple[Any, Any] = (1.0, 0.4),
    exits: int = 100,
    *,
    width: float | None = None,
    seeds: int | None = None,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Value of a key at which the gear begins to stick, against the number of mesh exits waited for.

    Parameters
    ----------
    scene : Scene
        With gears, a pair or a train, whose judged shaft counts with the mesh that drives it. Torques that follow a
        schedule are run for ``run.duration``, in which a gear must stick or pass all exits; constant ones for as long
        as it takes.
    over : str, optional
        Key of a number.
    between : tuple of two values, optional
        Of that key, in SI units or with a unit: at one the gear sticks within `exits`, at the other it does not.
    exits : int, optional
        Mesh exits to wait for.
    width : float, optional
        Width at which a bracket is narrow enough, in the key's SI unit; by default 1/256 of that of `between`.
    seeds : int, optional
        Gears of one design, each with a limit of its own: with seeds of errors of teeth (``mesh.pitch_error_rms``), of
        discrete asperities, or of both, numbered from the scene's own on.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`.
        With ``archive``, finished runs are kept beside it until it is written.

    Returns
    -------
    Dataset
        Along ``exits`` (1, 2, 5, 10 ... up to `exits`), in the key's unit: ``limit``, the middle of the bracket whose
        ends are ``sticks``, where a run sticks or stops within so many exits, and ``passes``, where it passes them, as
        at all values tried beyond. NaN where no run has stuck so early. Along ``run`` all runs: ``value``,
        ``exits_passed`` until it stuck or its time was over, ``stick_time`` (NaN if it has not stuck) and
        ``simulated_time``. A gear that still moves when the time is over counts only for the exits that it has passed.
        Runs that could not be finished are left out; ``left_out`` counts them. The log names both.

        With `seeds` the brackets are along ``seed`` too, with the ``mean`` of the limits along ``exits`` and the
        ``deviation`` of one gear from it (standard deviation), both of the gears that have stuck so early, which
        ``stuck`` counts; ``gear`` tells the seed of each run. A gear that does alike at both ends has no limit; its
        ``message`` says so.

    Raises
    ------
    SceneError
        If the scene has no gears; a setting is not allowed; the gear does alike at both ends; or in the time of a
        schedule it neither sticks nor passes the exits.
    SolverError
        If the run at one of the ends could not be finished.
    Interrupted
        On Ctrl-C, with the brackets so far as its ``dataset``.

    Notes
    -----
    Near the limit the outcome is not monotone in the key: a bracket is one place where it changes, the one nearest to
    the end that does not stick among the values tried.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> found = gd.studies.sticking_threshold(scene, between=(0.4, 0.7), exits=5)  # doctest: +SKIP
    >>> float(found.limit.sel(exits=5))  # doctest: +SKIP
    """
    scene = require_meshes(scene)
    ends = _ends(scene, over, between)
    base, execution = prepared(scene, options, samples="off", trains=True)
    width = abs(ends[1] - ends[0]) * _WIDTH if width is None else number("width", width)
    _check(exits, width)
    if not is_scheduled(base.to_dict()):  # a schedule has a time of its own
        base = base.replace({"run.duration": _window(base, exits)})
    waits = [*(number for number in _USUAL if number < exits), exits]
    rounds = 1 + math.ceil(math.log(abs(ends[1] - ends[0]) / width, _PARTS))
    most = 2 + (_PARTS - 1) * rounds * len(waits)
    settings: list[Any] = [over, *ends, exits, width]
    if seeds is None:
        runs: list[ThresholdRun] = []

        def so_far() -> xr.Dataset:
            return _dataset(scene, over, runs, waits, ends, width)

        def work(kept: RunCache | None) -> xr.Dataset:
            with execution.side_by_side(kept, most) as compute:
                _search(_Pool(base, over, exits, compute, runs), ends, waits, width)
            return so_far()

        return STUDY.compute(execution, base, work, settings, origin=scene, so_far=so_far)
    gears = [_Gear(base.replace(gear)) for gear in gears_of(base, seeds)]

    def gears_so_far() -> xr.Dataset:
        found = [_dataset(gear.scene, over, gear.runs, waits, ends, width) for gear in gears]
        return _dataset_of_gears(scene, over, gears, found)

    def work_on_gears(kept: RunCache | None) -> xr.Dataset:
        with execution.side_by_side(kept, most * len(gears)) as compute:
            _search_gears(gears, over, exits, compute, ends, waits, width)
        return gears_so_far()

    return GEARS.compute(
        execution, base, work_on_gears, [GEARS.kind, *settings, seeds], origin=scene, so_far=gears_so_far
    )


@dataclass
class _Gear:
    """One gear of a design: its scene, its runs so far, and why it has no limit."""

    scene: Scene
    runs: list[ThresholdRun] = field(default_factory=list)
    message: str = ""


def _search_gears(
    gears: Sequence[_Gear],
    over: str,
    exits: int,
    compute: SideBySide,
    ends: tuple[float, float],
    waits: Sequence[int],
    width: float,
) -> None:
    """Search the limits of one gear after the other; one without a limit does not end the search."""
    for gear in gears:
        try:
            _search(_Pool(gear.scene, over, exits, compute, gear.runs), ends, waits, width)
        except _NoLimitError as error:
            gear.message = str(error)
            log.warning("the gear of seed %d has no limit: %s", seed_of(gear.scene), error)
        except SolverError as error:
            gear.message = str(error)
            log.warning("the gear of seed %d is left out: %s", seed_of(gear.scene), error)
    if all(gear.message for gear in gears):
        raise SceneError(
            "between", list(ends), f"no gear has a limit there; the last one: {gears[-1].message}"
        )


class _NoLimitError(SceneError):
    """A gear does alike at both ends, or is slow at one."""


@dataclass
class _Pool:
    """The runs so far, and where more of them are computed."""

    scene: Scene
    over: str
    exits: int
    compute: SideBySide
    runs: list[ThresholdRun]

    def run(self, values: Sequence[float]) -> bool:
        """Run the values that have not been run; whether there were any. Runs that fail are named and left out."""
        done = {earlier.value for earlier in self.runs}
        todo = sorted({value for value in values if value not in done})
        scenes = [self.scene.replace({self.over: value}) for value in todo]
        solved = self.compute(run_until, scenes, self.exits)
        for value, (solution, _) in zip(todo, solved, strict=True):
            run = ThresholdRun.of(value, solution, self.exits)
            _refuse_short(self.scene, run, self.exits)
            if run.failure is not None:
                log.warning("one run is left out: %s", run.failure)
            elif run.slow:
                log.warning("one run says nothing of more mesh exits: %s", run.slow_in_words(self.exits))
            self.runs.append(run)
        return bool(todo)


def _refuse_short(scene: Scene, run: ThresholdRun, exits: int) -> None:
    """Refuse a schedule in whose time a gear neither sticks nor passes all exits: one run then gives no answer."""
    unanswered = run.failure is None and math.isnan(run.stick_time) and run.passed < exits
    if unanswered and is_scheduled(scene.to_dict()):
        allowed = (
            f"must be at most {run.passed}, or run.duration longer: at {run.value:g} the gear does not stick in the "
            f"{run.window:g} s of its schedule and passes no more"
        )
        raise SceneError("exits", exits, allowed)


def _search(pool: _Pool, ends: tuple[float, float], waits: Sequence[int], width: float) -> None:
    """Narrow the brackets of all numbers of exits."""
    pool.run(ends)
    _check_ends(pool, ends)
    while True:
        wanted: list[float] = []
        for exits in waits:
            sticks, passes = _bracket(pool.runs, exits)
            if abs(passes - sticks) > width:  # never so of NaN
                inner = np.linspace(sticks, passes, _PARTS + 1)[1:-1]
                wanted += inner.tolist()
        if not pool.run(wanted):  # around a value whose run has failed, a bracket stays wide
            return


def _followed(runs: Sequence[ThresholdRun]) -> list[ThresholdRun]:
    return [run for run in runs if run.failure is None]


def _bracket(runs: Sequence[ThresholdRun], exits: int) -> tuple[float, float]:
    """Value nearest to the passing end at which a run sticks within so many exits, and the next beyond it."""
    runs = [run for run in _followed(runs) if run.passed >= exits or not run.slow]
    first, last = (pick(runs, key=lambda run: run.value) for pick in (min, max))
    passed = {run.value: run.passed >= exits for run in runs}
    return bracket(passed, falling=first.passed > last.passed)


def _check_ends(pool: _Pool, ends: tuple[float, float]) -> None:
    """Require that one end sticks and the other does not, and that neither has failed."""
    first, second = (next(run for run in pool.runs if run.value == end) for end in ends)
    for run in (first, second):
        if run.failure is not None:
            raise run.failure
        if run.slow:
            allowed = f"must be values at which it sticks or passes: {run.slow_in_words(pool.exits)}"
            raise _NoLimitError("between", list(ends), allowed)
    if (first.passed < pool.exits) == (second.passed < pool.exits):
        what = "sticks" if first.passed < pool.exits else "passes them"
        passed = f"{first.passed} and {second.passed} mesh exits"
        allowed = f"must have one end at which the gear sticks within {pool.exits} exits: at both it {what} ({passed})"
        raise _NoLimitError("between", list(ends), allowed)


def _dataset(
    scene: Scene,
    over: str,
    runs: Sequence[ThresholdRun],
    waits: Sequence[int],
    ends: tuple[float, float],
    width: float,
) -> xr.Dataset:
    """Make the dataset of brackets and runs."""
    ordered = sorted(_followed(runs), key=lambda run: run.value)
    brackets = np.array(
        [_bracket(ordered, wait) for wait in waits] if ordered else [(np.nan, np.nan)] * len(waits)
    )
    values = {
        "exits": np.array(waits),
        "limit": brackets.mean(axis=1),
        "sticks": brackets[:, 0],
        "passes": brackets[:, 1],
        "value": np.array([run.value for run in ordered]),
        "exits_passed": np.array([run.passed for run in ordered], dtype=np.int64),
        "stick_time": np.array([run.stick_time for run in ordered]),
        "simulated_time": np.array([run.window for run in ordered]),
    }
    attributes = {
        **provenance(scene, "searched the sticking threshold", swept=(over,)),
        "title": f"{scene.name}: sticking threshold",
        "summary": f"Limit of {over} at which the gear begins to stick, against mesh exits waited for.",
        "between": list(ends),
        "width": width,
        "left_out": len(runs) - len(ordered),
    }
    return STUDY.dataset(values, attributes, over=over, unit=find_key(type(scene), over).unit or "1")


def _dataset_of_gears(
    scene: Scene, over: str, gears: Sequence[_Gear], found: Sequence[xr.Dataset]
) -> xr.Dataset:
    """Put the brackets and runs of all gears together."""
    seeds = [seed_of(gear.scene) for gear in gears]
    without = np.array([bool(gear.message) for gear in gears])[:, None]  # two ends alone are no bracket
    brackets = {
        name: np.where(without, np.nan, np.stack([one[name].values for one in found]))
        for name in ("limit", "sticks", "passes")
    }
    stuck = np.isfinite(brackets["limit"])
    limits = [column[here] for column, here in zip(brackets["limit"].T, stuck.T, strict=True)]
    values = {
        "exits": found[0]["exits"].values,
        "seed": np.array(seeds),
        **brackets,
        "mean": np.array([column.mean() if column.size else np.nan for column in limits]),
        "deviation": np.array([column.std(ddof=1) if column.size > 1 else np.nan for column in limits]),
        "stuck": stuck.sum(axis=0),
        "message": np.array([gear.message for gear in gears]),
        "gear": np.repeat(seeds, [one.sizes["run"] for one in found]),
    }
    along = ("value", "exits_passed", "stick_time", "simulated_time")
    values |= {name: np.concatenate([one[name].values for one in found]) for name in along}
    attributes = {
        **found[0].attrs,
        **provenance(scene, "searched sticking thresholds", swept=(over, *seeds_that_draw(scene))),
        "title": f"{scene.name}: sticking thresholds of {gears_text(len(gears))}",
        "summary": f"Limits of {over} at which gears of one design begin to stick, against mesh exits waited for.",
        "left_out": sum(int(one.attrs["left_out"]) for one in found),
    }
    return GEARS.dataset(values, attributes, over=over, unit=find_key(type(scene), over).unit or "1")


def _ends(scene: Scene, over: str, between: tuple[Any, Any]) -> tuple[float, float]:
    """Both ends in SI units."""
    if len(between) != 2:
        raise SceneError("between", list(between), "must be two values")
    low, high = (value_of(scene.replace({over: end}), over) for end in values_of("between", between))
    if low == high:
        raise SceneError("between", list(between), "must be two different values")
    return low, high


def _check(exits: int, width: float) -> None:
    whole("exits", exits, 1)
    if not 0.0 < width < math.inf:
        raise SceneError("width", width, "must be positive")


def _window(scene: Scene, exits: int) -> float:
    """Simulated time that a run gets [s]."""
    from gearidae.runs.estimates import waiting_speed

    if is_long_train(scene):
        from gearidae.runs.train_statics import waiting_time

        return _PATIENCE * (exits + 1) * waiting_time(scene)
    gears = require_gears(scene)
    return _PATIENCE * (exits + 1) * 2.0 * math.pi / (gears.gears.gear_teeth * waiting_speed(gears))


def _written(
    *,
    over: Annotated[
        str, Option("Key and two values: the gear sticks at one of them, coating.sam_fraction=0.4,0.7.")
    ],
) -> dict[str, Any]:
    ((key, ends),) = sweep_values([over]).items()
    if len(ends) != 2 or ends[0] == ends[1]:
        raise SceneError(
            "--over", over, f"needs two different values, at one of which the gear sticks: {key}=0.4,0.7"
        )
    return {"over": key, "between": (ends[0], ends[1])}


def _announced(
    _: Scene, __: int | None, *, over: str, between: tuple[Any, Any], exits: int, seeds: int | None
) -> str:
    words = f"{over} between {between[0]} and {between[1]}, for up to {exits} mesh exits"
    return words if seeds is None else f"{words}, of {gears_text(seeds)}"


def _sentence(ds: xr.Dataset) -> str:
    key, point = _key(ds), ds.isel(exits=-1)
    exits = int(ds["exits"][-1])
    if np.isnan(point["limit"]):
        return f"No run has stuck within {exits} mesh exits so far."
    sticks, passes = _ends_in_words(point)
    return f"Within {exits} mesh exits the gear sticks at {key} = {sticks} and not at {passes}."


def _rows(ds: xr.Dataset) -> Rows:
    """Limit and bracket for each number of exits."""
    yield f"Sticking limit of {_key(ds)}", "", ""
    for exits in ds["exits"].values:
        point = ds.sel(exits=exits)
        waited = f"within {exits} mesh exit{'s' if exits > 1 else ''}"
        if np.isnan(point["limit"]):
            yield waited, "-", "no run has stuck so early"
            continue
        sticks, passes = _ends_in_words(point)
        yield waited, _number(float(point["limit"]), point), f"sticks at {sticks}, passes at {passes}"
    left_out = int(ds.attrs.get("left_out", 0))
    yield "runs", str(ds.sizes["run"]), f"{left_out} more could not be finished" if left_out else ""


def _gears_sentence(ds: xr.Dataset) -> str:
    key, point = _key(ds), ds.isel(exits=-1)
    exits, count = int(ds["exits"][-1]), int(point["stuck"])
    if not count:
        return f"No gear has stuck within {exits} mesh exits so far."
    return (
        f"Within {exits} mesh exits {count} of {ds.sizes['seed']} gears stick, at {key} = {_spread(point)}."
    )


def _spread(point: xr.Dataset) -> str:
    """Say the mean limit with its standard error, and that of single gears."""
    limits, unit = point["limit"].values, str(point["limit"].attrs["units"])
    limits = limits[np.isfinite(limits)]
    unit = "" if unit == "1" else f" {unit}"
    if limits.size < 2:
        return f"{float(point['mean']):.4g}{unit}"
    one = float(point["deviation"])
    mean = f"{float(point['mean']):.4g} +- {one / math.sqrt(limits.size):.2g}{unit}"
    return f"{mean} (one gear +- {one:.2g}, from {limits.min():.4g} to {limits.max():.4g})"


def _gears_rows(ds: xr.Dataset) -> Rows:
    """Mean limit for each number of exits, and the limit of each gear for the largest."""
    yield f"Sticking limit of {_key(ds)}, mean of the gears", "", ""
    for index in range(ds.sizes["exits"]):
        point = ds.isel(exits=index)
        exits, count = int(point["exits"]), int(point["stuck"])
        waited = f"within {exits} mesh exit{'s' if exits > 1 else ''}"
        if not count:
            yield waited, "-", "no gear has stuck so early"
            continue
        value, _, rest = _spread(point).partition(" (")
        remark = rest.rstrip(")")
        yield waited, value, f"{count} of {ds.sizes['seed']} gears" + (f"; {remark}" if remark else "")
    last = ds.isel(exits=-1)
    for seed in ds["seed"].values.tolist():
        gear = last.sel(seed=seed)
        limit, message = float(gear["limit"]), str(gear["message"].values)
        value = "-" if math.isnan(limit) else _number(limit, gear)
        yield f"gear of seed {seed}", value, message
    left_out = int(ds.attrs.get("left_out", 0))
    yield "runs", str(ds.sizes["run"]), f"{left_out} more could not be finished" if left_out else ""


def _key(ds: xr.Dataset) -> str:
    return str(ds["limit"].attrs["long_name"]).removeprefix("sticking limit of ")


def _ends_in_words(point: xr.Dataset) -> tuple[str, str]:
    return _number(float(point["sticks"]), point), _number(float(point["passes"]), point)


def _number(value: float, point: xr.Dataset) -> str:
    """Write a value of a bracket with as many digits as distinguish its ends, four at least."""
    sticks, passes, unit = float(point["sticks"]), float(point["passes"]), str(point["limit"].attrs["units"])
    digits = next((n for n in range(4, 17) if f"{sticks:.{n}g}" != f"{passes:.{n}g}"), 17)
    return f"{value:.{digits}g}" + ("" if unit == "1" else f" {unit}")


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the limit at which a gear begins to stick against the mesh exits waited for, with its bracket.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.sticking_threshold`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is no sticking threshold.
    """
    from gearidae.drawing.parameter_axis import parameter_axis
    from gearidae.drawing.style import NEGATIVE, POSITIVE, line_width, new_axes, tidy

    STUDY.require(ds)
    ax = new_axes(ax, height=3.8)
    ds = ds.isel(exits=np.isfinite(ds["limit"].values))
    if not ds.sizes["exits"]:
        raise SceneError("plot", "sticking_threshold", "no run has stuck")
    exits = ds["exits"].values
    together = xr.concat([ds[name].drop_attrs() for name in ("passes", "limit", "sticks")], "end")
    along = parameter_axis(together.rename(_key(ds).rpartition(".")[2]).assign_attrs(ds["limit"].attrs))
    passes, limit, sticks = along.positions
    ax.plot(exits, passes, "^", color=POSITIVE, markersize=5, label="passes")
    ax.plot(exits, limit, color="0.3", linewidth=line_width(1.2), label="limit")
    ax.plot(exits, sticks, "X", color=NEGATIVE, markersize=5, label="sticks")
    ax.set_xscale("log")
    ax.set_xticks(exits, [str(number) for number in exits])
    ax.minorticks_off()
    ax.set_xlabel("mesh exits waited for")
    ax.set_ylabel(along.label)
    tidy(ax)
    ax.margins(x=0.03)
    ax.legend(frameon=False, fontsize="small")
    return ax


def picture_of_gears(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the limits at which gears of one design begin to stick against the mesh exits waited for, and their mean.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.sticking_threshold` with seeds.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With a line for each gear, and bars of one standard deviation of a gear at the mean.

    Raises
    ------
    SceneError
        If the dataset is something else, or no gear has stuck.
    """
    from gearidae.drawing.parameter_axis import parameter_axis
    from gearidae.drawing.style import line_colour, line_width, new_axes, tidy

    GEARS.require(ds)
    ax = new_axes(ax, height=3.8)
    ds = ds.isel(exits=ds["stuck"].values > 0)
    if not ds.sizes["exits"]:
        raise SceneError("plot", "sticking_thresholds", "no gear has stuck")
    exits = ds["exits"].values
    together = xr.concat([*(ds["limit"].drop_attrs().drop_vars("seed")), ds["mean"].drop_attrs()], "line")
    along = parameter_axis(together.rename(_key(ds).rpartition(".")[2]).assign_attrs(ds["limit"].attrs))
    *gears, mean = along.positions
    lines = ax.plot(exits, np.transpose(gears), color="0.7", marker=".", linewidth=line_width(0.7))
    lines[0].set_label(gears_text(len(gears)))
    colour = line_colour(0)
    ax.errorbar(
        exits,
        mean,
        yerr=along.factor * np.nan_to_num(ds["deviation"].values),
        color=colour,
        marker="o",
        markersize=4,
        capsize=3,
        linewidth=line_width(1.2),
        label="mean, and one gear",
    )
    ax.set_xscale("log")
    ax.set_xticks(exits, [str(number) for number in exits])
    ax.minorticks_off()
    ax.set_xlabel("mesh exits waited for")
    ax.set_ylabel(along.label)
    tidy(ax)
    ax.margins(x=0.05)
    ax.legend(frameon=False, fontsize="small")
    return ax


_RUN_COLUMNS = {
    "value": Column(("run",), "{unit}", "{over}", required=False),
    "exits_passed": Column(
        ("run",), "1", "mesh exits until the gear stuck, or the run was over", required=False
    ),
    "stick_time": Column(("run",), "s", "when the gear stuck", required=False),
    "simulated_time": Column(("run",), "s", "simulated time", required=False),
}


def _brackets(dims: tuple[str, ...]) -> dict[str, Column]:
    """Columns of brackets against the exits."""
    return {
        "exits": Column(("exits",), "1", "mesh exits waited for", required=False),
        "limit": Column(dims, "{unit}", "sticking limit of {over}"),
        "sticks": Column(dims, "{unit}", "{over} at which the gear sticks"),
        "passes": Column(dims, "{unit}", "{over} at which it does not"),
    }


STUDY = Study(
    kind="sticking_threshold",
    words="sticking threshold",
    maker="threshold",
    title="Threshold",
    command=_written,
    options=("exits", "seeds"),
    announcement=_announced,
    examples=(
        "gearidae threshold mine.toml --over coating.sam_fraction=0.4,0.8 --exits 20",
        "gearidae threshold mine.toml --over coating.sam_fraction=0.4,0.8 --exits 20 --seeds 20",
    ),
    columns={**_brackets(("exits",)), **_RUN_COLUMNS},
    sentence=_sentence,
    rows=_rows,
    pictures=(
        Picture("sticking_threshold", "Sticking limit against the mesh exits waited for", draw=picture),
    ),
)
GEARS = Study(
    kind="sticking_thresholds",
    words="study of the sticking thresholds of gears",
    maker="threshold --seeds",
    columns={
        **_brackets(("seed", "exits")),
        "seed": Column(("seed",), "1", "seed of the gear", required=False),
        "mean": Column(("exits",), "{unit}", "mean of the limits of the gears that have stuck"),
        "deviation": Column(("exits",), "{unit}", "standard deviation of the limit of one gear"),
        "stuck": Column(("exits",), "1", "gears that have stuck"),
        "message": Column(("seed",), "", "why the gear has no limit", required=False),
        "gear": Column(("run",), "1", "seed of the gear of the run", required=False),
        **_RUN_COLUMNS,
    },
    sentence=_gears_sentence,
    rows=_gears_rows,
    pictures=(
        Picture(
            "sticking_thresholds",
            "Sticking limits of gears of one design against the mesh exits waited for",
            draw=picture_of_gears,
        ),
    ),
)
