"""Run gears from their start with keys drawn from distributions: which share has started by which time.

A gear has started when it has turned one pitch forward. Finished runs are kept beside the output, in OUT.nc.journal,
until it is written.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.output_selection import read_keep
from gearidae.archive.provenance import provenance
from gearidae.archive.select import what_of
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweeping import run_plan
from gearidae.scene import GearScene, TrainScene, require_meshes
from gearidae.scene.judged import judged_pitch, judged_shaft
from gearidae.scene.pairs import quantities
from gearidae.scene.pairs import texts as read_texts
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.announcement import draw_words
from gearidae.studies.design import check_design, plain_design
from gearidae.studies.members import along_members, draw_members
from gearidae.studies.options import VARY_EXAMPLE, Vary
from gearidae.studies.shares import check_confidence, wilson
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.runs.run_cache import RunCache
    from gearidae.scene import Scene

_MEMBERS: Final = 64
"""By default: a probability of one half is then known to 0.12."""
_HALF: Final = 0.5
"""Pitches: a gear that has come one, and is more than this behind where it was, has come it backwards."""
_TO_THE_END: Final = 1e-9
"""Part of the longest time within which a run has come to its end: the gear has not turned a pitch."""


def start_probability(
    scene: Scene,
    vary: Mapping[str, Any],
    size: int = _MEMBERS,
    by: Sequence[Any] | float | str | None = None,
    design: Literal["sobol", "random"] = "sobol",
    *,
    seed: int = 0,
    confidence: float = 0.95,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Share of gears that have started by given times.

    Each member runs from the scene's own start until its gear has turned one pitch forward, or the last time is over.
    Of a gear that moves at the start the pitch counts, too: set ``initial.gear_speed`` to 0 for a start from rest.

    Parameters
    ----------
    scene : Scene
        With gears, a pair or a train, whose judged shaft has to turn one pitch of the mesh that drives it.
    vary : mapping of str to object
        Keys and their distributions, as for `ensemble`; ``{"contact.seed": "seeds"}`` numbers seeds of populations,
        ``{"mesh.pitch_error_seed": "seeds"}`` those of errors of teeth.
    size : int, optional
        Number of members.
    by : sequence, optional
        Times since the start of the run [s], or texts with a unit; by default the scene's ``run.duration``. The last
        one is how long the runs are.
    design : {"sobol", "random"}, optional
        Scrambled Sobol' points, which cover the distributions more evenly, or pseudo-random ones.
    seed : int, optional
        Seed of the design.
    confidence : float, optional
        Of the interval.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`.

    Returns
    -------
    Dataset
        Along ``by`` [s]: ``probability`` with its confidence interval ``low`` to ``high`` (Wilson 1927,
        doi:10.2307/2276774), ``started`` and ``members``. Along ``member``: the keys' values as coordinates (SI),
        ``start_time`` [s], at which the gear had turned a pitch (NaN if it has not), and ``followed`` [s], until when
        the run says whether it has. A member whose run failed does not count beyond that time.

    Raises
    ------
    SceneError
        If the scene is a roller, or a key, a distribution, a time or a setting is not allowed.
    Interrupted
        On Ctrl-C; finished runs are kept beside the archive.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.load_case("cases/start_up.toml")  # doctest: +SKIP
    >>> vary = {"load.torque": "normal(30 pN m, 4 pN m)"}
    >>> found = gd.studies.start_probability(scene, vary, by=["3 ms", "5 ms"])  # doctest: +SKIP
    """
    base, execution = prepared(require_meshes(scene), options, samples="off", trains=True)
    check_confidence(confidence)
    check_design(size, design, seed, indices=False)
    times = _times(base, by)
    base = _followed(base, times)
    drawn = draw_members(base, vary, lambda of: plain_design(of, int(size), design, int(seed)))
    plan, words, selection = drawn.plan, drawn.words, read_keep(("reached",), base)

    def work(kept: RunCache | None) -> xr.Dataset:
        runs = along_members(run_plan(plan, execution, kept, selection), tuple(words))
        return _dataset(scene, base, runs, times, confidence)

    settings = [times.tolist(), words, int(size), design, int(seed), confidence]
    return STUDY.compute(
        execution, base, work, settings, origin=scene, selection=selection, scenes=plan.scenes
    )


def _times(scene: Scene, by: Sequence[Any] | float | str | None) -> Floats:
    """Times in rising order [s]."""
    times = quantities("by", scene.run.duration if by is None else by, "s")
    if not times.size or not np.isfinite(times).all() or times.min() <= 0.0:
        raise SceneError("by", str(by)[:60], "must be times above 0, such as [2e-3, 5e-3] or '5 ms'")
    return np.unique(times)


def _followed(scene: GearScene | TrainScene, times: Floats) -> GearScene | TrainScene:
    """Let a scene end at the last time, or where its gear, or judged shaft, has turned one pitch."""
    return scene.replace(
        {
            "run.duration": float(times[-1]),
            "run.stop": f"turns {_turns(scene)!r}",
            "run.checkpoints": [],
            "run.asperity_events": False,
        }
    )


def _turns(scene: GearScene | TrainScene) -> float:
    """Turns of the gear, of a train of the load's shaft, in which the gear or the judged shaft turns one pitch."""
    if isinstance(scene, GearScene):
        return 1.0 / scene.gears.gear_teeth
    shafts = scene.train.shafts
    faster = shafts[scene.train.load].ratio / shafts[judged_shaft(scene)].ratio
    return judged_pitch(scene) / (2.0 * math.pi) * float(faster)


def _dataset(scene: Scene, base: Scene, runs: xr.Dataset, times: Floats, confidence: float) -> xr.Dataset:
    reached, longest = runs["reached"].values, float(times[-1])
    stopped = (runs["status"].values == "finished") & (reached < (1.0 - _TO_THE_END) * longest)
    # a pitch backwards ends the run, too; that of a train is known where it has been looked at last
    forward = runs["turned_back"].values < _HALF
    begun = stopped & forward
    start_time = np.where(begun, reached, np.nan)
    followed = np.where(runs["status"].values == "finished", longest, reached)
    known = begun | (followed >= times[:, None] * (1.0 - _TO_THE_END))
    started = np.where(begun, reached, np.inf) <= times[:, None]
    counts = list(zip(started.sum(axis=1).tolist(), known.sum(axis=1).tolist(), strict=True))
    low, high = np.transpose([wilson(hits, size, confidence) for hits, size in counts])
    columns = {
        "by": times,
        "probability": np.array([hits / size if size else np.nan for hits, size in counts]),
        "low": low,
        "high": high,
        "started": np.array([hits for hits, _ in counts]),
        "members": np.array([size for _, size in counts]),
        "start_time": start_time,
        "followed": followed,
    }
    attributes = {
        **provenance(base, "followed starts"),
        "title": f"{scene.name}: starts of {start_time.size} gears",
        "summary": "Share of gears that have turned a pitch by given times, with its confidence interval.",
        "confidence": confidence,
    }
    kept = {name: runs[name] for name in runs.coords if runs[name].dims == ("member",)}
    return STUDY.dataset(columns, attributes, percent=f"{100.0 * confidence:g}").assign_coords(kept)


def _written(
    *,
    vary: Vary,
    by: Annotated[
        list[str] | None, Option("Times since the start, '2 ms' '5 ms'. Default: run.duration.", many=True)
    ] = None,
) -> dict[str, Any]:
    return {"vary": read_texts(vary, "--vary", VARY_EXAMPLE), "by": by}


def _announced(
    scene: Scene,
    workers: int | None,
    *,
    vary: Mapping[str, str],
    by: Sequence[str] | None,
    size: int,
    design: str,
    seed: int,
) -> str:
    check_design(size, design, seed, indices=False)
    gears = require_meshes(scene)
    return draw_words(_followed(gears, _times(gears, by)), vary, size, workers)


def _sentence(ds: xr.Dataset) -> str:
    last = ds.isel(by=-1)
    hits, members = int(last["started"]), int(last["members"])
    after = with_prefix(float(last["by"]), "s")
    what = f"{what_of(ds)}s"
    if not members:
        return f"Of none of {ds.sizes['member']} {what} it is known whether it has started after {after}."
    return f"{hits} of {members} {what} have started after {after}: probability {_in_words(last, ds)}."


def _in_words(point: xr.Dataset, ds: xr.Dataset) -> str:
    low, high, percent = float(point["low"]), float(point["high"]), 100.0 * float(ds.attrs["confidence"])
    return f"{float(point['probability']):.3g}, {percent:g} % between {low:.3g} and {high:.3g}"


def _rows(ds: xr.Dataset) -> Rows:
    """Probability at each time, and when the gears that have started did."""
    yield str(ds.attrs["title"]), "", ""
    for number in range(ds.sizes["by"]):
        point = ds.isel(by=number)
        value, _, band = _in_words(point, ds).partition(", ")
        counted = f"{int(point['started'])} of {int(point['members'])}"
        yield f"started after {with_prefix(float(point['by']), 's')}", value, f"{band}; {counted}"
    times = ds["start_time"].values
    times = times[np.isfinite(times)]
    if times.size:
        low, middle, high = (with_prefix(float(time), "s") for time in np.quantile(times, (0.05, 0.5, 0.95)))
        yield "start time of those", middle, f"90 % between {low} and {high}"
    if lost := int((ds["followed"].values < float(ds["by"][-1]) * (1.0 - _TO_THE_END)).sum()):
        yield "unfinished runs", str(lost), "do not count beyond where they ended"


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of gears that have started over time, with its interval at the given times.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.start_probability`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is something else.
    """
    from gearidae.drawing.style import line_colour, line_width, new_axes, scale_for, tidy

    STUDY.require(ds)
    ax = new_axes(ax)
    end = float(ds["by"][-1])
    scale = scale_for(end, "s")
    times = np.sort(ds["start_time"].values)
    times = times[np.isfinite(times)]
    steps = np.concatenate([[0.0], times, [end]]) * scale.factor
    shares = np.concatenate([np.arange(times.size + 1), [times.size]]) / ds.sizes["member"]
    ax.step(steps, shares, where="post", color=line_colour(0), linewidth=line_width(1.2), label="members")
    share = ds["probability"].values
    ax.errorbar(
        ds["by"].values * scale.factor,
        share,
        # a share of 0 or 1 is an end of its interval but for rounding
        yerr=np.maximum([share - ds["low"].values, ds["high"].values - share], 0.0),
        fmt="o",
        markersize=4,
        capsize=3,
        color=line_colour(1),
        label=f"{100.0 * float(ds.attrs['confidence']):g} % interval",
    )
    ax.set_xlabel(f"time ({scale.unit})")
    ax.set_ylabel("share that has started")
    tidy(ax)
    ax.set_ylim(-0.02, 1.02)
    ax.set_xlim(0.0, 1.03 * end * scale.factor)
    ax.legend(frameon=False, fontsize="small")
    return ax


_BY: Final = ("by",)
STUDY = Study(
    kind="start_probability",
    words="study of starts",
    maker="start-probability",
    title="Starts",
    command=_written,
    options=("size", "design", "seed"),
    announcement=_announced,
    members=lambda vary, size, **_: (vary, size),
    examples=(
        "gearidae start-probability start_up --vary 'load.torque=normal(30 pN m, 4 pN m)' --by '3 ms' '5 ms'",
    ),
    columns={
        "by": Column(_BY, "s", "time since the start of the run"),
        "probability": Column(_BY, "1", "share of the gears that have turned a pitch"),
        "low": Column(_BY, "1", "lower end of its {percent} % confidence interval"),
        "high": Column(_BY, "1", "upper end of its {percent} % confidence interval"),
        "started": Column(_BY, "1", "gears that have turned a pitch"),
        "members": Column(_BY, "1", "gears of which it is known whether they have"),
        "start_time": Column(("member",), "s", "when the gear had turned a pitch"),
        "followed": Column(("member",), "s", "until when it is known whether it has"),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("start_probability", "Share of gears that have started over time", draw=picture),),
    member_columns=("start_time",),
)
