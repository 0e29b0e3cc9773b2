"""A whole train at one time: its gears about their centres, the loads of its hubs, and which meshes push or pull."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import xarray as xr
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Polygon
from matplotlib.text import Annotation
from numpy.typing import ArrayLike

from gearidae.archive.pieces import reached
from gearidae.archive.select import is_train, refuse_parts, run_scene, single_run
from gearidae.arrays import Floats
from gearidae.drawing.picture import new_picture
from gearidae.drawing.style import NEGATIVE, POSITIVE, quantity_text
from gearidae.errors import SceneError
from gearidae.plot.speed_strip import speed_strip
from gearidae.plot.train_shape import PlacedGear, errors_before_turning, pitch_point, train_gears
from gearidae.scene.scene import is_long_train

SHAFT_COLOURS: Final = ("#d3e5f3", "#f1d9a8", "#cfe8d8", "#ead6e4", "#dddddd", "#f6d9cc")
"""Of the gears of each shaft, again from the first where there are more."""
OF_SHAFTS: Final = ("shaft_angle", "shaft_speed", "hub_load", "hub_load_angle")
OF_MESHES: Final = ("mesh_force", "pairs_in_contact")
"""Samples that a picture of the whole train shows, of each shaft and of each mesh."""
_SAMPLES: Final = (*OF_SHAFTS, *OF_MESHES, "transmission_error")
_WIDTH, _STRIP, _LEGEND, _TITLE = 7.6, 1.15, 0.3, 0.35  # inches
LONGEST, SHORTEST = 0.17, 0.12
"""Longest arrow over the diagonal of the picture, and shortest over the longest: it shows where a small load points."""
NO_ARROW = 1e-3
"""Share of the largest load below which a load has no arrow."""


@dataclass(frozen=True, slots=True)
class TrainState:
    """A sample of a train; arrays along its shafts or meshes.

    Attributes
    ----------
    time : float
        [s].
    angle, speed : ndarray
        Of each shaft, in its own forward sense [rad], [rad/s].
    load, load_angle : ndarray
        Of each hub [N], and its direction in the frame [rad].
    force : ndarray
        Of each mesh [N].
    pairs : ndarray
        In contact in each mesh; damping and attraction act without any, too.
    """

    time: float
    angle: Floats
    speed: Floats
    load: Floats
    load_angle: Floats
    force: Floats
    pairs: Floats


def train(
    ds: xr.Dataset, *, time: float | None = None, figure: Figure | SubFigure | None = None
) -> Figure | SubFigure:
    """Draw a whole train at one time: its gears about their centres, and the load of each hub as an arrow.

    The gears are drawn to scale, from the involutes and centres of the scene and the recorded angles. Gears of one
    shaft have one colour; those of different planes lie over each other. A dot stands below tooth 0 of each gear. The
    mark at each pitch point shows whether the teeth push, pull or do not touch.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a train of several meshes; from a sweep, one selected with ``sel``.
    time : float, optional
        Time [s], of which the nearest sample is shown; by default the last sample.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw; by default a new one.

    Returns
    -------
    matplotlib Figure or SubFigure

    Raises
    ------
    SceneError
        If the dataset is not of a train, of several runs, or has no samples, or the time lies outside of them.
    """
    run = train_run(ds)
    (state,) = train_states(run, [math.inf if time is None else float(time)])
    view = TrainView(run, [state], figure)
    view.draw(state)
    return view.figure


def train_run(ds: xr.Dataset) -> xr.Dataset:
    """Return the single run of a train that a dataset is, up to its last sample.

    Raises
    ------
    SceneError
        If it is something else, or has no samples.
    """
    if not is_train(ds):
        raise SceneError(
            "dataset",
            str(ds.attrs.get("title", "(no title)"))[:60],
            "must be a run of a train of several meshes: the picture teeth and explore show a pair of gears",
        )
    ds = single_run(ds)
    run_scene(ds)  # refuses several runs
    refuse_parts(ds)
    for name in _SAMPLES:
        if name not in ds or not ds.sizes["time"]:
            raise SceneError("dataset", name, "the dataset has no samples of it")
    count = reached(ds["gear_speed"])
    if not count:
        raise SceneError("dataset", "shaft_angle", "the dataset has no samples of it")
    return ds.isel(time=slice(count))


def train_states(run: xr.Dataset, times: ArrayLike) -> list[TrainState]:
    """Return the samples nearest to some times [s]; infinity is the last one.

    Raises
    ------
    SceneError
        If a time lies outside of them.
    """
    wanted = np.atleast_1d(np.asarray(times, dtype=float))
    recorded = run["time"].values
    wanted = np.where(np.isposinf(wanted), recorded[-1], wanted)
    step = float(np.diff(recorded).max(initial=0.0))
    for time in wanted:
        if not recorded[0] - step <= time <= recorded[-1] + step:
            raise SceneError("time", float(time), f"must lie in {recorded[0]:g}..{recorded[-1]:g} s")
    after = np.clip(np.searchsorted(recorded, wanted), 1, max(recorded.size - 1, 1))
    after = np.minimum(after, recorded.size - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(wanted - recorded[before] <= recorded[after] - wanted, before, after)
    picked = run[list(_SAMPLES)].isel(time=nearest).load()
    columns = [picked[name].transpose("time", ...).values for name in (*OF_SHAFTS, *OF_MESHES)]
    return [TrainState(float(recorded[k]), *row) for k, *row in zip(nearest, *columns, strict=True)]


def placed_gears(run: xr.Dataset) -> tuple[PlacedGear, ...]:
    """Lay out the gears of a run, from `train_run`, unturned."""
    scene = run_scene(run)
    assert is_long_train(scene)
    first = run[["shaft_angle", "transmission_error"]].isel(time=0).load()
    errors = errors_before_turning(
        scene.train, first["shaft_angle"].values, first["transmission_error"].values
    )
    return train_gears(scene.train, errors)


class TrainView:
    """A figure in which a train can be drawn time after time.

    Parameters
    ----------
    run : xarray.Dataset
        From `train_run`.
    states : sequence of TrainState
        What will be drawn; the largest load among them sets the scale of the arrows.
    figure : matplotlib Figure or SubFigure, optional
        Where; by default a new one.
    """

    def __init__(
        self, run: xr.Dataset, states: Sequence[TrainState], figure: Figure | SubFigure | None = None
    ) -> None:
        scene = run_scene(run)
        assert is_long_train(scene)
        self._train = scene.train
        self._judged = [shaft.name for shaft in scene.train.shafts].index(run.attrs["judged_shaft"])
        self._gears = placed_gears(run)
        self._largest = max(float(state.load.max()) for state in states)
        self._longest = LONGEST * math.hypot(*np.ptp(self._corners([]), axis=0))
        low, high = self._corners(states)
        across, up = high - low
        height = min(max(_WIDTH * up / across, 1.8), 8.0)
        whole = _TITLE + height + _LEGEND + _STRIP
        self.figure = figure or new_picture((_WIDTH, whole), panels=True)
        self._ax = self.figure.add_axes((0.01, (_LEGEND + _STRIP) / whole, 0.98, height / whole))
        self._ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        self._ax.set_axis_off()
        self._wheels = [self._wheel(gear) for gear in self._gears]
        self._marks = [
            self._dot(_micro(pitch_point(self._train, mesh)), 5.0, 60) for mesh in self._train.meshes
        ]
        self._hubs = [self._hub(_micro(np.array(shaft.centre))) for shaft in self._train.shafts]
        self._legend((_STRIP + 0.5 * _LEGEND) / whole)
        strip = self.figure.add_axes((0.085, 0.42 / whole, 0.9, (_STRIP - 0.45) / whole))
        self._time_factor, self._cursor = speed_strip(strip, run, run.attrs["judged_shaft"])

    def draw(self, state: TrainState) -> None:
        """Draw a state in place of the one before."""
        for gear, (outline, tooth) in zip(self._gears, self._wheels, strict=True):
            angle = float(state.angle[gear.shaft])
            outline.set_xy(_micro(gear.outline(angle)))
            tooth.set_data(*_micro(gear.mark_at(angle))[:, None])
        for mark, force, pairs in zip(self._marks, state.force, state.pairs, strict=True):
            mark.set_markerfacecolor("white" if pairs == 0.0 else POSITIVE if force > 0.0 else NEGATIVE)
        for number, shaft in enumerate(self._train.shafts):
            self._draw_hub(number, _micro(np.array(shaft.centre)), state)
        self._cursor.set_xdata([state.time * self._time_factor] * 2)
        judged = self._train.shafts[self._judged].name
        self._ax.set_title(
            f"t = {quantity_text(state.time, 's', 6)}    {judged} {state.speed[self._judged]:.4g} rad/s",
            loc="left",
            fontsize="medium",
        )

    def _corners(self, states: Sequence[TrainState]) -> Floats:
        """Lower left and upper right corner around the gears and the arrows of some states, shape (2, 2) [um]."""
        points = [gear.centre + way * 1.04 * gear.tip_radius for gear in self._gears for way in (-1.0, 1.0)]
        ends = [
            _micro(np.array(shaft.centre)) + 1.1 * self._arrow(number, state)
            for number, shaft in enumerate(self._train.shafts)
            for state in states
        ]
        around = np.concatenate([_micro(np.array(points)), *([ends] if ends else [])])
        return np.stack([around.min(axis=0), around.max(axis=0)])

    def _arrow(self, number: int, state: TrainState) -> Floats:
        """Arrow of a hub's load [um]; short ones are drawn longer, so that they show where the load points."""
        load, angle = float(state.load[number]), float(state.load_angle[number])
        if not load > NO_ARROW * self._largest:
            return np.zeros(2)
        length = self._longest * max(load / self._largest, SHORTEST)
        return length * np.array([math.cos(angle), math.sin(angle)])

    def _wheel(self, gear: PlacedGear) -> tuple[Polygon, Line2D]:
        outline = Polygon(
            _micro(gear.outline(0.0)),
            facecolor=SHAFT_COLOURS[gear.shaft % len(SHAFT_COLOURS)],
            edgecolor="0.25",
            linewidth=0.5,
            alpha=0.9,
            zorder=10 * gear.plane,
        )
        self._ax.add_artist(outline)
        tooth = self._dot(_micro(gear.mark_at(0.0)), 2.5, 10 * gear.plane + 1)
        tooth.set_markerfacecolor("0.1")
        return outline, tooth

    def _dot(self, at: Floats, size: float, order: int) -> Line2D:
        dot = Line2D([at[0]], [at[1]], marker="o", color="0.1", markersize=size, linestyle="", zorder=order)
        self._ax.add_artist(dot)
        return dot

    def _hub(self, at: Floats) -> tuple[FancyArrowPatch, Annotation]:
        """Lay out the arrow and the words of a hub."""
        self._dot(at, 4.0, 61)
        arrow = FancyArrowPatch(
            tuple(at),
            tuple(at),
            arrowstyle="-|>",
            color="0.1",
            linewidth=2.0,
            mutation_scale=12,
            shrinkA=0,
            shrinkB=0,
            zorder=62,
        )
        self._ax.add_artist(arrow)
        words = self._ax.annotate(
            "",
            tuple(at),
            (0.0, 0.0),
            textcoords="offset points",
            ha="center",
            fontsize="small",
            zorder=63,
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.75},
        )
        return arrow, words

    def _draw_hub(self, number: int, at: Floats, state: TrainState) -> None:
        """Turn the arrow of a hub to its load; the words stand where it does not point."""
        arrow, words = self._hubs[number]
        along = self._arrow(number, state)
        arrow.set_positions(tuple(at), tuple(at + along))
        arrow.set_visible(bool(along.any()))
        below = along[1] > 0.0
        words.set_position((0.0, -6.0 if below else 6.0))
        words.set_verticalalignment("top" if below else "bottom")
        words.set_text(
            f"{self._train.shafts[number].name}\n{quantity_text(float(state.load[number]), 'N', 3)}"
        )

    def _legend(self, height: float) -> None:
        faces = (("push", POSITIVE), ("pull", NEGATIVE), ("do not touch", "white"))
        handles = [
            Line2D([], [], marker="o", color="0.1", mfc=face, linestyle="", label=f"teeth {words}")
            for words, face in faces
        ]
        self.figure.legend(
            handles=handles,
            loc="center left",
            bbox_to_anchor=(0.012, height),
            ncols=len(handles),
            frameon=False,
            fontsize="small",
            handletextpad=0.4,
            columnspacing=1.2,
            borderaxespad=0.0,
        )
        words = f"arrows: loads of the hubs, the longest {quantity_text(self._largest, 'N', 3)}"
        self.figure.text(0.99, height, words, ha="right", va="center", fontsize="small")


def _micro(points: Floats) -> Floats:
    return 1e6 * points
