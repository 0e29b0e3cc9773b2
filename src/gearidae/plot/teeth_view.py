"""The teeth in mesh at one time: where they meet, how far apart, with what force and in what state."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from gearidae.archive.select import run_scene
from gearidae.drawing.picture import new_picture
from gearidae.drawing.style import NEGATIVE, POSITIVE, quantity_text, scale_for
from gearidae.plot.asperities import COATING, FLANKS, close_up, joined_asperities
from gearidae.plot.speed_strip import speed_strip
from gearidae.plot.tooth_shape import GearPicture, contact_points, tooth_outline
from gearidae.records import Flank
from gearidae.records.tooth_states import ContactState, MeshState, ToothContact
from gearidae.scene import GearScene, require_gears
from gearidae.scene.pitch_errors import errors_of_teeth

STATE_WORDS = {
    ContactState.OPEN: "open",
    ContactState.LOADING: "loading",
    ContactState.PARTLY_STRETCHED: "partly stretched",
    ContactState.FULLY_STRETCHED: "fully stretched",
}
"""States of a contact in words."""
_MARKS = {
    ContactState.OPEN: ("o", "white"),
    ContactState.LOADING: ("o", POSITIVE),
    ContactState.PARTLY_STRETCHED: ("^", "#E69F00"),
    ContactState.FULLY_STRETCHED: ("s", NEGATIVE),
}
_ALONG = "along the flank (µm), heights \N{MULTIPLICATION SIGN} {}"
_TEETH = 5  # on either side of the pitch point
_ACROSS, _DOWN, _UP = 4.6, 1.9, 2.0  # modules shown
_LONGEST = 1.4  # modules of the longest arrow
_NO_ARROW = 0.01  # of the largest force: less has no arrow
_SHOWN, MOST_PLAY = 0.12, 0.15
"""Modules of the largest error of a tooth where it is drawn larger than it is, and pitches of the backlash at most."""
_ROUNDED = 8.0  # roughnesses up to which the gap at a rounded end counts as near


def teeth(
    ds: xr.Dataset, *, time: float | None = None, figure: Figure | SubFigure | None = None
) -> Figure | SubFigure:
    """Draw the teeth in mesh at one time, with close-ups of the pairs that meet.

    The gears are drawn to scale, from the involutes of the scene and the recorded motion. Gaps are nanometres: the
    close-ups show them, with heights stretched by the factor they state. Where teeth have errors of their own, gaps and
    errors are drawn larger than they are between the gears too, by the factor stated there. It holds for the
    flank that is nearer to contact; the other one has what play is left.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair; from a sweep, one selected with ``sel``.
    time : float, optional
        Time [s], of which the nearest sample is shown; by default the last sample.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw, about as high as wide; by default a new one.

    Returns
    -------
    matplotlib Figure or SubFigure

    Raises
    ------
    SceneError
        If the dataset is of a roller, of several runs, or has no samples, the time lies outside of them, or the run
        cannot be repeated.

    Notes
    -----
    Force and state of each pair are those of the model, for which the scene runs again up to the time, see
    `gearidae.analysis.tooth_contacts`. The asperities drawn are a sample of the model's; those of a population are its
    own, with the joined ones marked.
    """
    (state,) = mesh_states(ds, [math.inf if time is None else float(time)])
    view = TeethView(ds, [state], figure)
    view.draw(state)
    return view.figure


def mesh_states(ds: xr.Dataset, times: ArrayLike) -> list[MeshState]:
    """Return the states of the pairs of teeth at some times, from `gearidae.analysis.tooth_contacts`.

    The engine is loaded only here: the other pictures do without.
    """
    from gearidae.studies._tooth_contacts import tooth_contacts

    return tooth_contacts(ds, times)


def recorded_until(ds: xr.Dataset) -> float:
    """Time of the last sample of a run of gears [s]."""
    from gearidae.studies._tooth_contacts import last_time

    return last_time(ds)


def pairs_at_most(scene: GearScene) -> int:
    """Return how many pairs of one flank can be near each other at a time: one to three."""
    geometry = scene.geometry
    end = math.sqrt(2.0 * scene.mesh.tip_relief_radius * _ROUNDED * scene.surface.roughness)
    return min(math.ceil((geometry.path_length + 2.0 * end) / geometry.base_pitch), 3)


def nearest_pairs(state: MeshState, count: int) -> list[ToothContact]:
    """Return the pairs of the flank that is nearest, at most one for each number modulo `count`."""
    nearest = min(state.contacts, key=lambda contact: contact.gap).flank
    taken: dict[int, ToothContact] = {}
    for contact in sorted(state.contacts, key=lambda contact: contact.gap):
        if contact.flank == nearest:
            taken.setdefault(contact.pair % count, contact)
    return sorted(taken.values(), key=lambda contact: contact.pair)


def enlarged(scene: GearScene) -> float:
    """How many times their size gaps and errors of teeth are drawn: 1 without errors."""
    largest = max(float(np.abs(errors).max()) for errors in errors_of_teeth(scene))
    if largest == 0.0:
        return 1.0
    return max(float(f"{_SHOWN * scene.geometry.module / largest:.1g}"), 1.0)


class TeethView:
    """A figure in which the teeth of one run can be drawn time after time.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair.
    states : sequence of MeshState
        What will be drawn; the largest force among them sets the scale of the arrows.
    figure : matplotlib Figure or SubFigure, optional
        Where; by default a new one.
    """

    def __init__(
        self, ds: xr.Dataset, states: Sequence[MeshState], figure: Figure | SubFigure | None = None
    ) -> None:
        self._scene = require_gears(run_scene(ds))
        self._picture = tooth_outline(self._scene, gaps=enlarged(self._scene), most_play=MOST_PLAY)
        self._largest = max(
            (abs(contact.force) for state in states for contact in state.contacts), default=0.0
        )
        self._pair_count = pairs_at_most(self._scene)
        self.figure = figure or new_picture((7.6, 7.2), panels=True)
        self._mesh = self.figure.add_axes((0.015, 0.525, 0.97, 0.43))
        width = 0.985 / self._pair_count
        self._close = [
            self.figure.add_axes((0.085 + k * width, 0.245, width - 0.1, 0.145))
            for k in range(self._pair_count)
        ]
        self._time_factor, self._cursor = speed_strip(
            self.figure.add_axes((0.085, 0.055, 0.9, 0.08)), ds, "gear"
        )
        self._legend()

    def draw(self, state: MeshState) -> None:
        """Draw a state in place of the one before."""
        shown = nearest_pairs(state, self._pair_count)
        _draw_mesh(self._mesh, self._picture, state, shown, self._largest)
        for number, ax in enumerate(self._close):
            ax.clear()
            here = [contact for contact in shown if contact.pair % self._pair_count == number]
            ax.set_visible(bool(here))
            for contact in here:
                factor = close_up(ax, self._scene, contact)
                joined = joined_asperities(self._scene, contact)
                _caption(ax, contact, factor, joined, narrow=self._pair_count > 2)
        self._cursor.set_xdata([state.time * self._time_factor] * 2)
        self._mesh.set_title(_headline(state), loc="left", fontsize="medium")

    def _legend(self) -> None:
        """Explain the marks of the mesh, and below the close-ups their colours."""
        handles = [
            Line2D([], [], marker=mark, color="0.1", mfc=face, linestyle="", label=STATE_WORDS[state])
            for state, (mark, face) in _MARKS.items()
        ]
        asperities = [
            Line2D([], [], color=colour, linewidth=3.0, label=label)
            for colour, label in (
                (POSITIVE, "pressed"),
                (NEGATIVE, "stretched"),
                (COATING, "monolayer"),
            )
        ]
        for entries, top in ((handles, 0.515), (asperities, 0.182)):
            self.figure.legend(
                handles=entries,
                loc="upper left",
                bbox_to_anchor=(0.012, top),
                ncols=len(entries),
                frameon=False,
                fontsize="small",
                handletextpad=0.5,
                columnspacing=1.4,
                borderaxespad=0.0,
            )
        self.figure.text(
            0.99,
            0.179,
            "all asperities of each flank, the joined ones marked"
            if self._scene.contact.is_discrete
            else "asperities drawn: a sample of the model's",
            ha="right",
            va="top",
            fontsize="small",
        )


def _draw_mesh(
    ax: Axes, picture: GearPicture, state: MeshState, shown: Sequence[ToothContact], largest: float
) -> None:
    """Draw both gears to scale, the lines of action, and the pairs on them."""
    ax.clear()
    ax.set_axis_off()
    module = picture.geometry.module
    turned = picture.turned(state.travel, state.transmission_error, shown[0].flank)
    for wheel, angle, colour in zip((picture.pinion, picture.gear), turned, FLANKS, strict=True):
        outline = wheel.outline(angle, _TEETH) / module
        ax.fill(*outline.T, facecolor=colour, edgecolor="0.25", linewidth=0.7)
    for flank in (Flank.DRIVE, Flank.COAST):
        ends = (
            np.stack([picture.line(flank, number) for number in (0.0, picture.geometry.path_length)]) / module
        )
        used = shown[0].flank == flank
        ax.plot(
            *ends.T, color="0.1" if used else "0.55", linewidth=1.0, linestyle="-" if used else (0, (4, 3))
        )
    ax.plot(0.0, 0.0, "+", color="0.1", markersize=9)
    for contact in shown:
        _draw_contact(ax, picture, contact, largest)
    way = math.copysign(1.0, state.gear_speed)
    for name, height in (("pinion, drives", _UP - 0.28), ("gear", -_DOWN + 0.18)):
        ax.text(-_ACROSS + 0.1, height, f"{name}  {'→' if way > 0 else '←'}", fontsize="small", va="center")
    _scale_bar(ax, module)
    if picture.gaps != 1.0:
        words = f"gaps, and errors of single teeth, \N{MULTIPLICATION SIGN} {picture.gaps:g}"
        ax.text(_ACROSS - 0.15, _UP - 0.28, words, fontsize="small", ha="right", va="center")
    ax.set_xlim(-_ACROSS, _ACROSS)
    ax.set_ylim(-_DOWN, _UP)
    ax.set_aspect("equal")


def _draw_contact(ax: Axes, picture: GearPicture, contact: ToothContact, largest: float) -> None:
    """Mark where a pair meets, and draw its force on the gear."""
    module = picture.geometry.module
    at = contact_points(picture, contact.flank, contact.place, contact.gap)[1] / module
    along = picture.line(contact.flank, picture.geometry.approach + 1.0)
    if abs(contact.force) > _NO_ARROW * largest and contact.state != ContactState.OPEN:
        # long enough to be seen beside the mark
        length = _LONGEST * max(abs(contact.force) / largest, 0.2)
        ax.annotate(
            "",
            tuple(at + along * math.copysign(length, contact.force)),
            tuple(at),
            arrowprops={
                "arrowstyle": "-|>",
                "color": POSITIVE if contact.force > 0.0 else NEGATIVE,
                "linewidth": 2.2,
                "mutation_scale": 14,
                "shrinkA": 0,
                "shrinkB": 0,
            },
            zorder=5,
        )
    mark, face = _MARKS[contact.state]
    ax.plot(*at, mark, color="0.1", markerfacecolor=face, markersize=8, zorder=6)
    across = np.array([-along[1], along[0]]) * (1.0 if along[0] > 0.0 else -1.0)
    ax.annotate(
        f"{contact.pair}",
        tuple(at + 0.42 * across),
        ha="center",
        va="center",
        fontsize="small",
        weight="bold",
        zorder=7,
        bbox={"boxstyle": "circle,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
    )


def _scale_bar(ax: Axes, module: float) -> None:
    """Draw a length of one, two or five in modules' place."""
    power = 10.0 ** math.floor(math.log10(module))
    length = next(step * power for step in (5.0, 2.0, 1.0) if step * power <= module)
    scale = scale_for(length, "m")
    right, height = _ACROSS - 0.15, -_DOWN + 0.18
    ax.plot([right - length / module, right], [height, height], color="0.1", linewidth=2.0)
    ax.text(
        right - length / module - 0.08,
        height,
        f"{length * scale.factor:g} {scale.unit}",
        ha="right",
        va="center",
        fontsize="small",
    )


def _caption(ax: Axes, contact: ToothContact, factor: float, joined: float, *, narrow: bool) -> None:
    """Say beside a close-up what it shows."""
    flank = "drive" if contact.flank == Flank.DRIVE else "coast"
    parted = ",\n" if narrow else ", "
    lines = [
        f"Pair {contact.pair}, {flank} flank",
        parted.join([f"gap {quantity_text(contact.gap, 'm')}", _force(contact)]),
        *([] if math.isnan(joined) else [f"{_joined_words(contact)} {joined:.2g}"]),
        parted.join(_states(contact)),
    ]
    size = "x-small" if narrow else "small"
    ax.set_title("\n".join(lines), loc="left", fontsize=size)
    ax.set_xlabel(
        f"along the flank (µm), heights \N{MULTIPLICATION SIGN} {_round(factor)}",
        fontsize=size,
        labelpad=1,
    )
    if ax.get_position().x0 < 0.2:
        ax.set_ylabel("height (nm)", fontsize="small", labelpad=1)


def _joined_words(contact: ToothContact) -> str:
    return "expected asperities in contact" if contact.asperities is None else "joined asperities:"


def _force(contact: ToothContact) -> str:
    if contact.force == 0.0:
        return "no force"
    return f"{'pushes' if contact.force > 0.0 else 'pulls'} with {quantity_text(abs(contact.force), 'N')}"


def _states(contact: ToothContact) -> list[str]:
    """State of a pair in words, of its materials where they differ."""
    if len(set(contact.states.values())) == 1:
        return [STATE_WORDS[contact.state]]
    names = {"bare": "bare", "coated": "monolayer", "mixed": "monolayer on bare"}
    return [f"{names[part]} {STATE_WORDS[state]}" for part, state in sorted(contact.states.items())]


def _headline(state: MeshState) -> str:
    return (
        f"t = {quantity_text(state.time, 's', 6)}    gear {state.gear_speed:.4g} rad/s    "
        f"force of all pairs {quantity_text(state.mesh_force, 'N')}"
    )


def _round(factor: float) -> str:
    """Two digits."""
    return f"{float(f'{factor:.2g}'):g}"
