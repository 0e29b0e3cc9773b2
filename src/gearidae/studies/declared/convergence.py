"""Compare quantities of a run over a ladder of tolerances: which converge at what cost, and which are chaotic.

Each tolerance is run several times, with neighbouring tolerances and with initial gaps that differ by 1e-9. Finished
runs are kept beside the output, in OUT.nc.journal, until it is written.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.output_selection import OutputSelection, read_keep
from gearidae.archive.provenance import provenance
from gearidae.archive.train import judged_view
from gearidae.archive.variables import by_name
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.progress import in_words
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweep_plan import SweepPlan
from gearidae.runs.sweeping import run_plan
from gearidae.scene.pairs import quantity
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.scene import Scene

LADDER: Final = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
"""Tolerances by default."""
_OF_GEARS: Final = ("min_gear_speed", "max_gear_speed", "largest_mesh_force", "gear_angle", "adhesion_loss")
_OF_ROLLERS: Final = ("final_speed", "largest_mesh_force", "adhesion_loss")
_TOLERANCES: Final = (1.0, 0.9, 0.95, 1.05, 1.1)
"""Tolerances of a step of the ladder, over its own."""
_GAPS: Final = (-2e-9, -1e-9, 1e-9, 2e-9)
"""Relative changes of the initial gap."""
_REMAINING: Final = 0.1
"""Error of the tightest tolerance, over the difference to the one before, which is ten times as large."""
_FALLS: Final = 0.25
"""Scatter at the tightest tolerance over that two steps before, up to which it is one of the solver."""
_CONVERGES, _CHAOTIC, _NOT_YET, _NONE = "converges", "chaotic", "not yet", "none"
_EACH: Final = ("figure", "rtol")


def convergence(
    scene: Scene,
    of: Sequence[str] | None = None,
    target: float = 1e-3,
    *,
    rtols: Sequence[float] = LADDER,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    r"""Error and cost of quantities of a run against its tolerance, from independent runs.

    At each tolerance of a ladder nine runs are made: five with tolerances within 10 % of it, four with initial gaps
    that differ by some :math:`10^{-9}`. The mean of those at the tightest tolerance is the reference of the others.

    Parameters
    ----------
    scene : Scene
    of : sequence of str, optional
        Extremes (``stick_time``, ``largest_mesh_force``), terms of the energy balance (``adhesion_loss``), and sampled
        variables (``gear_angle``), of which the value at the end of the run counts. By default speeds, force, angle and
        adhesion loss. Of a train they are of the judged shaft and of the mesh that drives it, losses of the whole.
    target : float, optional
        Relative error that is wanted.
    rtols : sequence of float, optional
        The ladder, three tolerances or more, each a tenth of the one before by default.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`.

    Returns
    -------
    Dataset, dims (figure, rtol, run)
        ``value`` of each run; ``error`` (root of the mean square of the distance to the reference) and ``scatter``
        (standard deviation; also of the neighbours in tolerance and in the gap alone), relative to the ``reference``.
        Along ``rtol`` the median ``wall_time`` and ``steps`` of a run, and the runs that are ``unfinished``. Along
        ``figure`` the ``verdict``: *converges*, with the loosest ``rtol_to_take`` from which on the error stays within
        the target, and its time; *chaotic*, where the scatter is above the target and does not fall with the tolerance,
        with the number of ``starts`` whose mean has the target as its standard error; *not yet* at these tolerances;
        *none* if no run has a value.

    Raises
    ------
    SceneError
        If a quantity is none of a run, or the target or a tolerance is not allowed.
    Interrupted
        On Ctrl-C; finished runs are kept beside the archive.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> found = gd.studies.convergence(scene, of=["adhesion_loss", "stick_time"])  # doctest: +SKIP
    """
    base, execution = prepared(scene, options, samples=2, trains=True)
    names = list((_OF_GEARS if base.roller is None else _OF_ROLLERS) if of is None else of)
    selection = _keep(base, names)
    ladder = _ladder(rtols)
    if not 0.0 < target < 1.0:
        raise SceneError("target", target, "must be above 0 and below 1")
    plan = _plan(base, ladder)

    def work(kept: Any) -> xr.Dataset:
        runs = judged_view(run_plan(plan, execution, kept, selection))
        return _dataset(scene, runs, names, ladder, target)

    settings = [names, ladder.tolist(), target]
    return STUDY.compute(
        execution, base, work, settings, origin=scene, selection=selection, scenes=plan.scenes
    )


def _keep(base: Scene, names: list[str]) -> OutputSelection:
    """Keep of each run what the quantities need; refuse what is none."""
    try:
        selection = read_keep([*names, "steps"], base)
    except SceneError as error:
        raise SceneError("of", error.value, error.allowed) from None
    known = by_name()
    for name in names:
        if name not in known or known[name].dims not in ((), ("time",)):
            raise SceneError("of", name, "has more than a number for each run, or for each sample")
    return selection


def _ladder(rtols: Sequence[float]) -> Floats:
    """Tolerances from the loosest to the tightest."""
    ladder = np.sort(np.unique(np.asarray(rtols, dtype=np.float64)))[::-1]
    if ladder.ndim != 1 or ladder.size < 3:
        raise SceneError("rtols", str(rtols)[:60], "must be three tolerances or more, all different")
    return ladder


def _plan(base: Scene, ladder: Floats) -> SweepPlan:
    """Runs of all tolerances, each with its neighbours."""
    key = "initial.gap" if base.roller is None else "roller.height"
    gap = float(base.initial.gap if base.initial is not None else base.roller.height)  # type: ignore[union-attr]
    size = abs(gap) or base.surface.roughness
    rows = [(factor * rtol, 0.0) for rtol in ladder for factor in _TOLERANCES]
    rows += [(rtol, change) for rtol in ladder for change in _GAPS]
    axis: dict[str, list[Any]] = {
        "name": [f"run {number}" for number in range(len(rows))],
        "run.rtol": [float(rtol) for rtol, _ in rows],
        key: [gap + change * size for _, change in rows],
    }
    scenes = [
        base.replace({"run.rtol": rtol, key: at}) for rtol, at in zip(*list(axis.values())[1:], strict=True)
    ]
    return SweepPlan(base, (axis,), scenes)


def _by_step(values: Floats, steps: int) -> Floats:
    """Put the runs of a plan into rows, one for each tolerance."""
    near, shifted = np.split(values, [steps * len(_TOLERANCES)])
    return np.concatenate([near.reshape(steps, -1), shifted.reshape(steps, -1)], axis=1)


def _dataset(
    scene: Scene, runs: xr.Dataset, names: Sequence[str], ladder: Floats, target: float
) -> xr.Dataset:
    def of(name: str) -> Floats:
        variable = runs[name]
        return _by_step(
            np.asarray((variable.isel(time=-1) if "time" in variable.dims else variable).values, float),
            len(ladder),
        )

    known = by_name()
    values = np.stack([of(name) for name in names])
    times = np.median(of("wall_time"), axis=1)
    judged = [judge(row, ladder, target) for row in values]
    columns: dict[str, Any] = {
        "figure": np.array(names),
        "rtol": ladder,
        "run": np.arange(values.shape[2]),
        "value": values,
        "unit": np.array([known[name].units for name in names]),
        "wall_time": times,
        "steps": np.median(of("steps"), axis=1),
        "unfinished": _by_step(runs["status"].values != "finished", len(ladder)).sum(axis=1),
    }
    columns |= {name: np.array([verdict[name] for verdict in judged]) for name in judged[0]}
    columns["time_to_take"] = np.array(
        [math.nan if math.isnan(rtol) else times[ladder == rtol][0] for rtol in columns["rtol_to_take"]]
    )
    attributes = {
        **provenance(scene, "compared tolerances", swept=("run.rtol",)),
        "title": f"{scene.name}: convergence of {', '.join(names)}",
        "summary": "Error and cost of quantities of a run against its tolerance, with the scatter of neighbours.",
        "target": target,
    }
    return STUDY.dataset(columns, attributes)


def judge(values: Floats, ladder: Floats, target: float) -> dict[str, Any]:
    """Judge whether a quantity converges.

    Parameters
    ----------
    values : ndarray, shape (tolerances, runs)
        From the loosest tolerance to the tightest; NaN where a run has none.
    ladder : ndarray, shape (tolerances,)
    target : float

    Returns
    -------
    dict
        The variables of `convergence` that follow from them.
    """
    steps, neighbours = len(ladder), len(_TOLERANCES)
    result = {
        "reference": math.nan,
        "error": np.full(steps, math.nan),
        "scatter": np.full(steps, math.nan),
        "scatter_of_tolerance": np.full(steps, math.nan),
        "scatter_of_gap": np.full(steps, math.nan),
        "verdict": _NONE,
        "rtol_to_take": math.nan,
        "starts": math.nan,
    }
    finite = np.isfinite(values)
    if not finite[-1].any():
        return result
    if not finite[-2:].all():  # some of the neighbours stick, say, and others do not
        return result | {"verdict": _CHAOTIC}
    reference = float(values[-1].mean())
    size = abs(reference) or float(np.nanmax(np.abs(values))) or 1.0
    means, scatter = values.mean(axis=1), values.std(axis=1, ddof=1) / size
    error = np.sqrt(((values - reference) ** 2).mean(axis=1)) / size
    error[-1] = scatter[-1] + _REMAINING * abs(means[-1] - means[-2]) / size
    result |= {
        "reference": reference,
        "error": error,
        "scatter": scatter,
        "scatter_of_tolerance": values[:, :neighbours].std(axis=1, ddof=1) / size,
        "scatter_of_gap": values[:, neighbours:].std(axis=1, ddof=1) / size,
    }
    within = np.flatnonzero(~(error <= target))
    first = 0 if not within.size else int(within[-1]) + 1
    if first < steps:
        return result | {"verdict": _CONVERGES, "rtol_to_take": float(ladder[first])}
    if scatter[-1] <= target or scatter[-1] <= _FALLS * scatter[-3]:
        return result | {"verdict": _NOT_YET}
    spread = float(values[-2:].std(ddof=1)) / size
    return result | {"verdict": _CHAOTIC, "starts": math.ceil((spread / target) ** 2)}


def _written(*, target: Annotated[str, Option("Relative error that is wanted.")] = "0.1 %") -> dict[str, Any]:
    return {"target": quantity("--target", target, "1")}


def _announced(*_: Any, **__: Any) -> str:
    runs = len(LADDER) * (len(_TOLERANCES) + len(_GAPS))
    return f"{runs} runs, with tolerances from {LADDER[0]:g} to {LADDER[-1]:g}"


def _sentence(ds: xr.Dataset) -> str:
    parts = [f"{name} {_verdict(ds.sel(figure=name))}" for name in ds["figure"].values.tolist()]
    return f"To {100.0 * float(ds.attrs['target']):.3g} %: {'; '.join(parts)}."


def _verdict(figure: xr.Dataset) -> str:
    verdict, starts = str(figure["verdict"].item()), float(figure["starts"])
    if verdict == _CONVERGES:
        return f"converges at rtol {float(figure['rtol_to_take']):g} ({in_words(float(figure['time_to_take']))} a run)"
    if verdict == _NONE:
        return "has no value in these runs"
    if verdict == _NOT_YET:
        return f"has not converged at rtol {float(figure['rtol'][-1]):g}: its error is {_percent(figure['error'][-1])}"
    if math.isnan(starts):
        return "is chaotic: neighbouring runs have a value or none"
    scatter = _percent(figure["scatter"][-1])
    return f"is chaotic: it scatters by {scatter}, and the mean of {starts:.0f} starts is needed"


def _percent(share: xr.DataArray) -> str:
    return f"{100.0 * float(share):.2g} %"


def _rows(ds: xr.Dataset) -> Rows:
    """Error, scatter and time at each tolerance."""
    for name in ds["figure"].values.tolist():
        figure = ds.sel(figure=name)
        known, unit = bool(figure["error"].notnull().any()), str(figure["unit"].item()).removeprefix("1")
        yield (
            f"{name}: {float(figure['reference']):.6g} {unit}".rstrip() if known else name,
            "",
            _verdict(figure),
        )
        for number, rtol in enumerate(ds["rtol"].values.tolist() if known else ()):
            at = figure.isel(rtol=number)
            by_rtol, by_gap = (_percent(at[f"scatter_of_{name}"]) for name in ("tolerance", "gap"))
            scatter = f"scatter {by_rtol} by tolerance, {by_gap} by gap"
            yield (
                f"rtol {rtol:g}",
                f"error {_percent(at['error'])}",
                f"{scatter}; {in_words(float(at['wall_time']))}",
            )
    if lost := int(ds["unfinished"].sum()):
        yield "unfinished runs", str(lost), f"of {ds['value'][0].size}"


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the error of each quantity against the time of a run.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.convergence`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        On logarithmic scales, from the loosest tolerance on the left; lines of chaotic quantities are dashed.

    Raises
    ------
    SceneError
        If the dataset is something else.
    """
    from gearidae.drawing.style import line_colour, line_width, mark_value, new_axes, tidy

    STUDY.require(ds)
    ax = new_axes(ax, height=3.8)
    for number, name in enumerate(ds["figure"].values.tolist()):
        figure = ds.sel(figure=name)
        converges = figure["verdict"].item() == _CONVERGES
        ax.plot(
            figure["wall_time"].values,
            100.0 * figure["error"].where(figure["error"] > 0.0).values,
            color=line_colour(number),
            marker="." if converges else "x",
            linestyle="-" if converges else "--",
            linewidth=line_width(1.2),
            label=f"{name}: {figure['verdict'].item()}",
        )
    mark_value(ax.axhline, 100.0 * float(ds.attrs["target"]), "target")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("time of a run (s)")
    ax.set_ylabel("error (%)")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


STUDY = Study(
    kind="convergence",
    words="study of convergence",
    maker="convergence",
    title="Convergence",
    command=_written,
    options=("of",),
    announcement=_announced,
    examples=('gearidae convergence mine.toml --of adhesion_loss stick_time --target "0.1 %"',),
    columns={
        "figure": Column(("figure",), "1", "quantity"),
        "rtol": Column(("rtol",), "1", "relative tolerance of the runs"),
        "run": Column(("run",), "1", "number of the run at its tolerance"),
        "value": Column((*_EACH, "run"), "", "value of a run, in the quantity's unit"),
        "unit": Column(("figure",), "1", "unit of the quantity"),
        "reference": Column(("figure",), "", "mean at the tightest tolerance, in the quantity's unit"),
        "error": Column(_EACH, "1", "relative distance of the runs to the reference"),
        "scatter": Column(_EACH, "1", "relative standard deviation of the runs"),
        "scatter_of_tolerance": Column(_EACH, "1", "that of runs with neighbouring tolerances"),
        "scatter_of_gap": Column(_EACH, "1", "that of runs with neighbouring initial gaps"),
        "wall_time": Column(("rtol",), "s", "median time of a run"),
        "steps": Column(("rtol",), "1", "median number of steps of a run"),
        "unfinished": Column(("rtol",), "1", "runs that could not be finished"),
        "verdict": Column(("figure",), "1", "converges, chaotic, not yet or none"),
        "rtol_to_take": Column(
            ("figure",), "1", "loosest tolerance from which on the error is within the target"
        ),
        "time_to_take": Column(("figure",), "s", "median time of a run at that tolerance"),
        "starts": Column(("figure",), "1", "starts whose mean has the target as its standard error"),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("convergence", "Error of each quantity against the time of a run", draw=picture),),
)
