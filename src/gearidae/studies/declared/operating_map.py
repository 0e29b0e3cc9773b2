"""Map over two keys where the gear turns, where it sticks, and where its teeth cross the backlash.

Finished runs are kept beside the archive, in OUT.nc.journal, until the archive is written.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final, Unpack

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.codes import CODE_ATTRIBUTES, Outcome, sticking, verdict_codes
from gearidae.errors import SceneError
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweep_plan import plan_sweep
from gearidae.runs.sweeping import run_study
from gearidae.scene import require_meshes
from gearidae.scene.pairs import sweep_values
from gearidae.studies.announcement import grid_words
from gearidae.studies.members import STICKS
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.arrays import Floats
    from gearidae.scene import Scene

_SIGNS: Final = {
    Outcome.TURNS: ".",
    Outcome.CROSSES_BACKLASH: "x",
    Outcome.STICKS: "#",
    Outcome.UNFINISHED: "?",
}
_LOOKS: Final = {
    Outcome.UNFINISHED: ("0.8", "not finished"),
    Outcome.TURNS: ("#0072B2", "turns"),
    Outcome.CROSSES_BACKLASH: ("#E69F00", "crosses the backlash"),
    Outcome.STICKS: ("#D55E00", "sticks"),
}
_WIDEST: Final = 80
"""Values of the second key that stand in a line."""
_OUTCOME = {
    "long_name": "what the gear does",
    "units": "1",
    "flag_values": np.array(list(Outcome), dtype=np.int8),
    "flag_meanings": " ".join(word.name.lower() for word in Outcome),
    "comment": "a gear that sticks may have crossed the backlash before: flank_changes says how often",
}


def operating_map(
    scene: Scene,
    over: Mapping[str, Iterable[Any]],
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """What the gears do over two keys.

    Parameters
    ----------
    scene : Scene
        With gears, a pair or a train, whose judged shaft and its mesh are looked at.
    over : mapping of str to iterable
        Two keys, such as ``drive.torque`` and ``coating.sam_fraction``, and their values, as for `gearidae.sweep`.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`.

    Returns
    -------
    Dataset
        Along both keys: ``outcome`` (an `Outcome` as a number: the gear sticks; else the contact has gone over to the
        other flank, so that the teeth have crossed the backlash; else it turns), ``flank_changes``, ``verdict``,
        ``verdict_code``, ``sticks``, and what the solver keeps of each run. Runs that could not be finished say so in
        their ``status``.

    Raises
    ------
    SceneError
        If the scene is a roller, there are not two keys, or a key, a value or a setting is not allowed.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> over = {"drive.torque": [4e-18, 4.5e-18, 5e-18], "coating.sam_fraction": [0.4, 0.6, 0.8]}
    >>> chart = gd.studies.operating_map(scene, over)  # doctest: +SKIP
    >>> ax = gd.plot.outcome_map(chart)  # doctest: +SKIP
    """
    base, execution = prepared(scene, options, samples="off", trains=True)
    require_meshes(base)
    if not isinstance(over, Mapping) or len(over) != 2:
        allowed = 'must be two keys and their values, {"drive.torque": [...], "coating.sam_fraction": [...]}'
        raise SceneError(
            "over", over if not isinstance(over, Mapping) else ", ".join(map(str, over)), allowed
        )
    plan = plan_sweep(base, over)

    def finish(ds: xr.Dataset) -> xr.Dataset:
        return _judged(ds).assign_attrs(
            title=f"{base.name}: operating map over {' and '.join(over)}",
            summary=f"What the gears do over {' and '.join(over)}: turn, cross the backlash, or stick.",
        )

    return run_study(plan, execution, {"study": "operating_map"}, finish)


def _judged(ds: xr.Dataset) -> xr.Dataset:
    """Add verdicts as numbers, and the outcome."""
    dims = ds["status"].dims
    codes = verdict_codes(ds["verdict"].values)
    stuck = sticking(codes)
    outcome = np.where(ds["flank_changes"].values > 0, Outcome.CROSSES_BACKLASH, Outcome.TURNS)
    outcome[stuck == 1.0] = Outcome.STICKS
    outcome[np.isnan(stuck)] = Outcome.UNFINISHED
    return ds.assign(
        verdict_code=(dims, codes, CODE_ATTRIBUTES),
        sticks=(dims, stuck, STICKS),
        outcome=(dims, outcome.astype(np.int8), _OUTCOME),
    )


def _check(ds: xr.Dataset) -> None:
    """Refuse what is no operating map."""
    if "outcome" not in ds or ds["outcome"].ndim != 2:
        raise SceneError("plot", "outcome_map", "needs an operating map, from studies.operating_map")


def _written(
    *,
    over: Annotated[
        list[str],
        Option(
            "Two keys and their values, drive.torque=4e-18:5e-18:1e-19 coating.sam_fraction=1:0.4:-0.1.",
            repeatable=True,
            completes="keys",
        ),
    ],
) -> dict[str, Any]:
    values = sweep_values(over)
    if len(values) != 2:
        example = "drive.torque=4e-18,5e-18 coating.sam_fraction=1:0.4:-0.1"
        raise SceneError("--over", " ".join(over), f"must be two keys and their values: {example}")
    return {"over": values}


def _sentence(ds: xr.Dataset) -> str:
    legend = ", ".join(f"{count} {words}" for _, words, count in _legend(ds))
    return f"{ds['outcome'].size} runs: {legend}."


def _legend(ds: xr.Dataset) -> Iterator[tuple[str, str, int]]:
    for code, sign in _SIGNS.items():
        if count := int((ds["outcome"].values == code).sum()):
            yield sign, code.name.lower().replace("_", " "), count


def _rows(ds: xr.Dataset) -> Rows:
    """A line for each value of the first key, a sign for each of the second."""
    down, across = map(str, ds["outcome"].dims)
    yield str(ds.attrs["title"]), "", ""
    ends = [_short(value) for value in ds[across].values[[0, -1]]]
    yield f"{down}, downwards", f"{across}, from {ends[0]} to {ends[1]}", ""
    for row in range(ds.sizes[down]):
        codes = ds["outcome"].values[row, :_WIDEST].tolist()
        signs = "".join(_SIGNS[Outcome(code)] for code in codes)
        yield _short(ds[down].values[row]), signs + ("..." if ds.sizes[across] > _WIDEST else ""), ""
    yield ", ".join(f"{sign} {words}: {count}" for sign, words, count in _legend(ds)), "", ""


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float | int | np.number) else str(value)


def picture(chart: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw what the gears do over two keys, one coloured cell for each run.

    Parameters
    ----------
    chart : xarray.Dataset
        From `gearidae.studies.operating_map`; the first key upwards, the second to the right.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With a cross on the runs that stick after their teeth have crossed the backlash.

    Raises
    ------
    SceneError
        If the dataset is no operating map.
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    from gearidae.drawing.parameter_axis import cell_edges, parameter_axis, scale_axis
    from gearidae.drawing.style import legend_columns, line_width, new_axes

    _check(chart)
    for dim in chart["outcome"].dims:
        chart = chart.sortby(str(dim)) if chart[dim].dtype.kind in "fiu" else chart
    ax = new_axes(ax, height=4.2)
    vertical, horizontal = (chart[dim] for dim in chart["outcome"].dims)
    codes = list(_LOOKS)
    norm = BoundaryNorm(np.arange(codes[0] - 0.5, codes[-1] + 1.0), len(codes))
    colours = ListedColormap([colour for colour, _ in _LOOKS.values()])
    across, along = parameter_axis(horizontal), parameter_axis(vertical)
    ax.pcolormesh(
        cell_edges(across),
        cell_edges(along),
        chart["outcome"].values,
        cmap=colours,
        norm=norm,
        edgecolor="w",
        linewidth=line_width(0.4),
    )
    _mark_crossings(ax, chart, across.positions, along.positions)
    scale_axis(ax, "x", across)
    scale_axis(ax, "y", along)
    present = set(chart["outcome"].values.ravel().tolist())
    handles = [
        Patch(color=colour, label=words) for code, (colour, words) in _LOOKS.items() if code in present
    ]
    ax.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=legend_columns(ax, [str(handle.get_label()) for handle in handles]),
        frameon=False,
        fontsize="small",
    )
    return ax


def _mark_crossings(ax: Axes, chart: xr.Dataset, across: Floats, along: Floats) -> None:
    """Put a cross on the gears that stick after their teeth have crossed the backlash."""
    both = (chart["outcome"].values == Outcome.STICKS) & (chart["flank_changes"].values > 0)
    rows, columns = np.nonzero(both)
    if rows.size:
        ax.plot(
            across[columns],
            along[rows],
            linestyle="none",
            marker="x",
            markersize=4,
            color=_LOOKS[Outcome.CROSSES_BACKLASH][0],
        )


STUDY = Study(
    kind="operating_map",
    words="operating map",
    maker="operating-map",
    title="Operating map",
    command=_written,
    announcement=lambda scene, workers, over: grid_words(scene, over, workers),
    examples=(
        "gearidae operating-map mine.toml --over drive.torque=4e-18:5e-18:2e-19 coating.sam_fraction=1:0.4:-0.1",
    ),
    columns={
        "outcome": Column(("key", "other key"), "1", "what the gear does"),
        "verdict_code": Column(("key", "other key"), "1", "verdict as a number"),
        "sticks": Column(("key", "other key"), "1", "whether the gear sticks"),
    },
    check=_check,
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("outcome_map", "What the gears do over two keys", draw=picture),),
    rows_are_drawn=True,
)
