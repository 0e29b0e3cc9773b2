"""Pictures of the page on assumptions: Figs. 2, 4, 7 and 10 of the paper and the sticking limit, in small multiples."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import StrMethodFormatter
from numpy.typing import NDArray

import gearidae as gd
from gearidae.drawing.style import COLOURS, LINE_STYLES
from gearidae_pages.coating_assumptions import ALL_ASSUMPTIONS, LAWS, Assumption, LowSpeed

__all__ = ["draw_all", "draw_frequencies", "draw_high_speed", "draw_impacts", "draw_limits", "draw_low_speed"]

Panels: TypeAlias = NDArray[np.object_]

_CONTACTS: Final = tuple(dict.fromkeys(assumption.contact for assumption in ALL_ASSUMPTIONS))
_COATINGS: Final = tuple(dict.fromkeys(assumption.coating for assumption in ALL_ASSUMPTIONS))
_WORN: Final = (1.0, 0.5, 0.47, 0.45)  # of Fig. 7
_MAP: Final = np.round(np.linspace(1.0, 0.5, 26), 3)
_PERIOD: Final = 1e-4  # of the drive's 10 kHz [s]
_MARKERS: Final = "osD^"


def draw_all(low: Sequence[LowSpeed], folder: Path) -> None:
    """Draw all pictures of the page into a folder."""
    pictures = {
        "coating_impacts": draw_impacts(),
        "coating_high_speed": draw_high_speed(),
        "coating_low_speed": draw_low_speed(),
        "coating_frequencies": draw_frequencies(),
        "coating_limits": draw_limits(low),
    }
    for name, figure in pictures.items():
        figure.savefig(folder / f"{name}.png", metadata={"Software": None})


def draw_impacts() -> Figure:
    """Draw the force on the rollers over time (Fig. 2), with what is tension enlarged below."""
    figure, axes = _new(2, 2, 8.0, 5.2, sharey=False)
    for column, name in enumerate(("roller_slow", "roller_fast")):
        scene = gd.preset(name)
        for number, law in enumerate(LAWS):
            for which, fraction in (("bare", 0.0), ("SAM", 1.0)):
                run = gd.simulate(Assumption(law).of(scene, coating__sam_fraction=fraction))
                for row in range(2):
                    axes[row, column].plot(
                        1e6 * run["time"],
                        1e6 * run["force"],
                        color=COLOURS[0 if which == "SAM" else 1],
                        linestyle=LINE_STYLES[number],
                        linewidth=1.3,
                        label=f"{which}, {LAWS[law]}",
                    )
        assert scene.roller is not None
        axes[0, column].set_title(f"{scene.roller.speed:g} m/s", fontsize="medium", loc="left")
        axes[1, column].set_ylim(-2.0, 1.0)
        axes[1, column].set_xlabel("time (µs)")
    axes[0, 0].set_ylabel("force (µN)")
    axes[1, 0].set_ylabel("force (µN), enlarged")
    axes[0, 0].legend(frameon=False, fontsize="small")
    return figure


def draw_high_speed() -> Figure:
    """Draw the mean of the gear's speed over one period of the drive (Fig. 4), without and with the radius force."""
    figure, axes = _new(1, 2, 8.0, 3.4)
    base = gd.preset("teodorescu2009")
    for column, force in enumerate((False, True)):
        ax = axes[0, column]
        for number, law in enumerate(LAWS):
            for which, fraction in (("bare", 0.0), ("SAM", 1.0)):
                scene = Assumption(law, radius_force=force).of(base, coating__sam_fraction=fraction)
                time, speed = _smoothed(gd.simulate(scene))
                colour = COLOURS[0 if which == "SAM" else 1]
                label = f"{which}, {LAWS[law]}"
                ax.plot(
                    1e3 * time, speed, color=colour, linestyle=LINE_STYLES[number], linewidth=1.3, label=label
                )
        ax.set_title("with the radius force" if force else "without", fontsize="medium", loc="left")
        ax.set_xlabel("time (ms)")
        ax.set_ylim(2890.0, 2894.0)
    axes[0, 0].set_ylabel("speed, mean over a period (rad/s)")
    axes[0, 1].legend(frameon=False, fontsize="small")
    return figure


def _smoothed(run: xr.Dataset) -> tuple[Any, Any]:
    """Time [s] and the gear's speed [rad/s], both as means over one period of the drive."""
    time, speed = run["time"].values, run["gear_speed"].values
    width = round(_PERIOD / (time[1] - time[0]))
    window = np.full(width, 1.0 / width)
    return np.convolve(time, window, "valid"), np.convolve(speed, window, "valid")


def draw_low_speed() -> Figure:
    """Draw the gear's speed at the fractions of Fig. 7, a row for each coating and a column for each contact."""
    figure, axes = _new(len(_COATINGS), len(_CONTACTS), 9.6, 8.4)
    base = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 3001})
    for assumption in ALL_ASSUMPTIONS:
        row, column = _COATINGS.index(assumption.coating), _CONTACTS.index(assumption.contact)
        ax = axes[row, column]
        for number, fraction in enumerate(_WORN):
            run = gd.simulate(assumption.of(base, coating__sam_fraction=fraction))
            ax.plot(
                run["time"],
                run["gear_speed"],
                color=COLOURS[number],
                linestyle=LINE_STYLES[number],
                linewidth=1.0,
                label=f"SAM {100 * fraction:g} %",
            )
        if row == 0:
            ax.set_title(assumption.contact, fontsize="small", loc="left")
        if row == len(_COATINGS) - 1:
            ax.set_xlabel("time (s)")
        if column == 0:
            ax.set_ylabel(f"{assumption.coating}\nspeed (rad/s)", fontsize="small")
    axes[-1, 0].legend(frameon=False, fontsize="x-small", loc="lower left")
    return figure


def draw_frequencies() -> Figure:
    """Draw the characteristic frequency over the SAM fraction (Fig. 10), a panel for each coating."""
    figure, axes = _new(1, len(_COATINGS), 9.6, 3.4)
    base = gd.preset("teodorescu2009_low_speed")
    for assumption in ALL_ASSUMPTIONS:
        ax, number = axes[0, _COATINGS.index(assumption.coating)], _CONTACTS.index(assumption.contact)
        chart = gd.analysis.coating_map(assumption.of(base), _MAP)
        ax.plot(
            100.0 * chart["sam_fraction"],
            1e-3 * chart["characteristic_frequency"],
            color=COLOURS[number],
            linestyle=LINE_STYLES[number],
            linewidth=1.3,
            label=assumption.contact,
        )
        ax.set_title(assumption.coating, fontsize="small", loc="left")
        ax.set_xlabel("SAM (%)")
        ax.set_yscale("log")
        ax.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        ax.yaxis.set_minor_formatter(StrMethodFormatter("{x:g}"))
        ax.tick_params(axis="y", which="minor", labelsize="x-small")
    axes[0, 0].set_ylabel("frequency of the first impact (kHz)")
    axes[0, -1].legend(frameon=False, fontsize="x-small")
    return figure


def draw_limits(low: Sequence[LowSpeed]) -> Figure:
    """Draw the SAM fraction below which the gears stick, a row for each coating."""
    figure, axes = _new(1, 1, 7.0, 3.2)
    ax = axes[0, 0]
    for outcome in low:
        row, number = _COATINGS.index(outcome.assumption.coating), _CONTACTS.index(outcome.assumption.contact)
        ax.plot(
            50.0 * (outcome.sticks + outcome.turns),
            row + 0.16 * (number - 1.5),
            marker=_MARKERS[number],
            markersize=6,
            linestyle="none",
            color=COLOURS[number],
            label=outcome.assumption.contact if row == 0 else None,
        )
    ax.set_yticks(range(len(_COATINGS)), _COATINGS)
    ax.invert_yaxis()
    ax.set_xlim(0.0, 65.0)
    ax.set_xlabel("sticks within 0.3 s below a SAM fraction of (%)")
    ax.legend(frameon=False, fontsize="small", loc="lower right")
    return figure


def _new(
    rows: int, columns: int, width: float, height: float, sharey: Literal["row", False] = "row"
) -> tuple[Figure, Panels]:
    """Return a figure with panels that share their axes by column, and by row if not said otherwise."""
    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, sharex="col", sharey=sharey)
    for ax in axes.flat:
        assert isinstance(ax, Axes)
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(visible=True, color="0.9", linewidth=0.6)
        ax.set_axisbelow(True)
        ax.tick_params(labelsize="small")
    return figure, axes
