"""Pictures of what a speed signal is made of: one cycle, its spectrum, the ringing after mesh impacts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from textwrap import wrap
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from gearidae import analysis
from gearidae.analysis.ringing import hidden
from gearidae.analysis.spectra import banded, crowded_from
from gearidae.analysis.verdict import START_UP
from gearidae.archive.pieces import pieces, reached
from gearidae.archive.select import judged_teeth, run_scene, runs, scene_of, swept_dims
from gearidae.arrays import Floats
from gearidae.drawing.density import DECADES, draw_density, is_apart, legend_on_density, line_on_density
from gearidae.drawing.style import (
    Run,
    characters,
    label_axis,
    legend,
    line_width,
    new_axes,
    runs_of,
    scale_for,
    thin,
    tidy,
)
from gearidae.errors import SceneError
from gearidae.scene.orbit import has_orbit
from gearidae.scene.pitch_errors import has_pitch_errors
from gearidae.scene.prefixes import with_prefix

_SETTLED = 0.2
"""Part of a run left out of its spectrum, because it has not settled."""
_MOST_DECADES = 14
"""As much of a spectrum that reaches to the ring, far below the mesh; rounding is another three decades down."""
_ONE_SPEED = 0.1
"""Range of the mean speeds of a record's quarters, over its mean, up to which its mesh has one frequency."""
_FEWEST_BANDS = 32
"""Of frequency, that a spectrogram shows."""
_PADDING = 8
_STANDS = 0.01
"""Speed over the largest of a record below which a gear stands: what is left of the ring after it has stuck."""
_FLAT = ("tukey", 0.2)
"""Window in which the first impact, soon after the start-up, is not lost in the taper."""
_MULTIPLES = 6.0
_MARKED_IF_WIDE = 4
"""Multiples of the highest line that a linear axis shows, and of the mesh that are marked on a logarithmic one."""
_WITH_SIDEBANDS = 1.5
"""Orders of the mesh that are shown where sidebands are marked."""
_LINE = 11.0
"""Points from one line of words to the next."""
_MOST_SAMPLES = 2**19
"""Samples of a run that are analysed for a picture, which could not show more lines."""


def cycle(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the gear's speed over the last cycle of the drive (Teodorescu et al. 2009, Fig. 5).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        One period of the drive torque's first harmonic, or one pitch of the gear where there is none: of a gear that
        stands in the end the last one that it turned.

    Raises
    ------
    SceneError
        If the dataset has no samples of the gear's speed.
    """
    shown = runs_of(ds, "gear_speed")
    ax = new_axes(ax)
    harmonics = scene_of(ds).get("drive", {}).get("harmonic", [])
    driven = [float(harmonic["frequency"]) for harmonic in harmonics if "frequency" in harmonic][:1]
    by_drive = bool(driven) and driven[0] * float(ds["time"][-1] - ds["time"][0]) > 1.0
    shaft = ds.attrs.get("judged_shaft")  # of a train
    name = "cycle of the drive" if by_drive else f"pitch of {shaft or 'the gear'}"
    pitch = 2.0 * math.pi / judged_teeth(scene_of(ds)).gear_teeth
    drawn = []
    for run in shown:
        end = reached(run.data["gear_speed"])
        speed = _between(run.data, end - _MOST_SAMPLES, end)["gear_speed"]
        if by_drive:
            drawn.append(speed.sel(time=slice(float(speed["time"][-1]) - 1.0 / driven[0], None)))
        else:
            drawn.append(_last_pitch(speed, pitch))
    scale = scale_for(max(float(last["time"][-1] - last["time"][0]) for last in drawn), "s")
    for run, last in zip(shown, drawn, strict=True):
        at, values = thin(last["time"] - last["time"][0], last)
        ax.plot(
            at * scale.factor,
            values,
            color=run.colour,
            linestyle=run.line,
            linewidth=line_width(1.0),
            label=run.label,
        )
    ax.set_xlabel(f"time within the last {name} ({scale.unit})")
    ax.set_ylabel(f"speed of {shaft} (rad/s)" if shaft else "gear speed (rad/s)")
    tidy(ax)
    legend(ax, shown)
    return ax


def power_spectrum(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the power spectral density of the gear's speed (Teodorescu et al. 2009, Fig. 6).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair. The first fifth of it is left out; of a longer record than half a
        million samples the last half million is analysed.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With the frequencies of the drive and of the mesh and its multiples marked, from the mean speed of the fastest
        run whose speed stays within a tenth; of run-ups and braked runs `orders` marks the mesh. Where teeth have
        errors of their own, gears runout, or the pinion orbits in its hub, the turns of both shafts and the sidebands
        beside the mesh are marked too. If there is no drive frequency and the teeth ring far above the mesh after
        impacts, both axes are logarithmic, up to beyond the ringing, the frequencies of which are marked for a single
        run; the spectrum is averaged over bands of 1/24 octave there, and only the start-up is left out. The estimate
        is named in the picture.

    Raises
    ------
    SceneError
        If the dataset has no samples of the gear's speed.
    """
    shown = runs_of(ds, "gear_speed")
    ax = new_axes(ax)
    harmonics = scene_of(ds).get("drive", {}).get("harmonic", [])
    drive = [float(harmonic["frequency"]) for harmonic in harmonics if "frequency" in harmonic]
    settled = [_settled(run, _SETTLED) for run in shown]
    mesh = max((_mesh_frequency(ds, part) for part in settled if _has_one_speed(part)), default=0.0)
    found = [_impacts(run) for run in shown]
    responses = [] if drive else [impacts["frequency"].values for impacts in found if impacts is not None]
    rings = sorted({float(ring) for values in responses for ring in values if ring > 0.0})
    lines = [line for line in (mesh, *drive) if line > 0.0]
    wide = bool(rings and lines) and rings[-1] > _MULTIPLES * max(lines)
    # one segment: the lines stand still, and the resolution separates them; zeros draw their shape instead of a zigzag
    for run in shown:
        part = _settled(run, START_UP if wide else _SETTLED)
        density = analysis.power_spectrum(
            part, segment=_length(part), padding=_PADDING, window=_FLAT if wide else "hann"
        )
        resolution = float(density.attrs["resolution"])
        frequency, power = density["frequency"].values, density.values
        if wide:
            frequency, power = banded(frequency[1:], power[1:], resolution)  # 0 has no position on the axis
        ax.semilogy(
            frequency, power, color=run.colour, linestyle=run.line, linewidth=line_width(0.9), label=run.label
        )
    nyquist = float(density["frequency"][-1])
    if wide:
        ax.set_xscale("log")
        ax.set_xlim(2.0 * resolution, min(nyquist, 2.0 * rings[-1]))
    else:
        ax.set_xlim(0.0, min(nyquist, _MULTIPLES * max(lines)) if lines else nyquist)
    _fit_heights(ax, wide)
    _mark_all(ax, drive, mesh, rings if wide and len(shown) == 1 else [])
    if mesh > 0.0:
        _mark_sidebands(ax, mesh, _turns(ds))
    _name_estimate(ax, resolution, wide)
    label_axis(ax.xaxis, "frequency", "Hz")
    _note_aliases(ax, _alias_note(shown, found))
    ax.set_ylabel("power spectral density\n((rad/s)²/Hz)")
    tidy(ax)
    legend(ax, shown)
    return ax


def orders(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the spectrum of the gear's speed over its turns: lines of a run-up stand still there.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair; of a longer record the last half million samples.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        Up to four times the order of the mesh, which is marked with its multiples, and the pinion's turn. Where teeth
        have errors of their own, gears runout, or the pinion orbits in its hub, it is drawn up to one and a half times
        the order of the mesh, with the turns of both shafts and the sidebands beside the mesh, one and two turns of the
        pinion away.

    Raises
    ------
    SceneError
        If the dataset has no samples of speed and angle, or a gear does not turn.
    """
    shown = runs_of(ds, "gear_speed")
    ax = new_axes(ax)
    gears = judged_teeth(scene_of(ds))
    mesh = gears.gear_teeth
    turns = _turns(ds)
    highest = (_WITH_SIDEBANDS if turns else _MARKED_IF_WIDE * 1.1) * mesh
    for run in shown:
        end = reached(run.data["gear_speed"])
        part = run.data[["gear_speed", "gear_angle"]].isel(time=slice(max(end - _MOST_SAMPLES, 0), end))
        density = analysis.order_spectrum(part).sel(order=slice(0.0, highest))
        ax.semilogy(
            density["order"],
            density,
            color=run.colour,
            linestyle=run.line,
            linewidth=line_width(0.9),
            label=run.label,
        )
    ax.set_xlim(0.0, highest)
    _fit_heights(ax, wide=False)
    if turns:
        _mark_sidebands(ax, float(mesh), turns)
    else:
        _mark(ax, mesh / gears.pinion_teeth, gears.pinion)
    _mark_all(ax, [], float(mesh), [])
    ax.set_xlabel(f"order (per turn of {ds.attrs.get('judged_shaft', 'the gear')})")
    _note_aliases(ax, alias_note(ds))
    ax.set_ylabel("power spectral density\n((rad/s)²)")
    tidy(ax)
    legend(ax, shown)
    return ax


def spectrogram(ds: xr.Dataset, ax: Axes | None = None, *, highest: float | None = None) -> Axes:
    """Draw the power spectral density of the gear's speed over time.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run of a gear pair, all of which is read into memory.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    highest : float, optional
        Highest frequency to be shown [Hz]; by default four times that of the impact response, or of the mesh at the
        highest speed, or all.

    Returns
    -------
    Axes
        With the frequency of the mesh and those of the shafts, where they stand apart from zero, as lines at the speed
        of each instant.

    Raises
    ------
    SceneError
        If the dataset is a sweep or has no samples of the gear's speed.
    """
    run = _single(ds)
    density, found = analysis.spectrogram(run), analysis.impact_frequencies(run)
    gears = judged_teeth(scene_of(ds))
    half = 0.5 * float(density.attrs["segment_length"])
    turns = _mean_speed(run, density["time"].values, half) / (2.0 * math.pi)
    mesh = gears.gear_teeth * turns
    if highest is None:
        rings = found["frequency"].values
        highest = 4.0 * max([*rings[np.isfinite(rings)], 0.0])
        # Nothing is known of a ring that may be an alias, and a slow mesh is below the first band.
        if not highest:
            highest = max(4.0 * float(np.nanmax(mesh)), _FEWEST_BANDS * float(density["frequency"][1]))
    density = density.sel(frequency=slice(0.0, highest))
    ax = new_axes(ax, height=3.6)
    scale = scale_for(float(run["time"][-1]), "s")
    across = density["time"].values * scale.factor
    draw_density(ax, across, density["frequency"].values, density.values, "(rad/s)²/Hz")
    shown = float(density["frequency"][-1])
    lines = {"mesh": mesh, gears.pinion: mesh / gears.pinion_teeth, gears.gear: turns}
    for (name, line), style in zip(lines.items(), ("-", "--", ":"), strict=True):
        if is_apart(line, shown):
            line_on_density(ax, across, line, name, style)
    ax.set_ylim(0.0, shown)
    if ax.get_lines():
        legend_on_density(ax, "small")
    label_axis(ax.yaxis, "frequency", "Hz")
    ax.set_xlabel(f"time ({scale.unit})")
    _note_aliases(ax, str(found.attrs.get("note", "")))
    return ax


def impact_spectrum(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the spectrum of the first impact response (Teodorescu et al. 2009, Fig. 9).

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair. It is looked for in the first half million samples.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        Density over that of the ring, whose frequency stands beside the peak of a single run and else in the legend.

    Raises
    ------
    SceneError
        If the dataset has no samples of the gear's speed, or no impact rings.
    """
    shown = runs_of(ds, "gear_speed")
    ax = new_axes(ax)
    drawn, highest, nyquist = [], 0.0, math.inf
    responses: list[xr.Dataset | None] = []
    for run in shown:
        record = _between(run.data, 0, _MOST_SAMPLES)
        found = analysis.impact_frequencies(record)
        responses.append(found)
        rings = found["frequency"]
        ringing = np.flatnonzero(np.isfinite(rings.values))
        if not ringing.size or hidden(found)[: ringing[0]].any():
            continue  # also where only later responses are slow enough to show
        density = analysis.impact_spectrum(record).isel(impact=int(ringing[0]))
        ring = float(rings[ringing[0]])
        highest, nyquist = max(highest, ring), float(density["frequency"][-1])
        drawn.append(replace(run, label=f"{run.label}: {ring:.0f} Hz".removeprefix(": ")))
        at_ring = float(density.sel(frequency=ring, method="nearest"))
        ax.plot(
            density["frequency"],
            density / at_ring,
            color=run.colour,
            linestyle=run.line,
            linewidth=line_width(1.0),
            label=drawn[-1].label,
        )
    note = _alias_note(shown, responses)
    if not highest:
        why = "no impact rings in the dataset"
        raise SceneError("plot", "impact_spectrum", f"{why} ({note})" if note else why)
    ax.set_xlim(0.0, min(nyquist, 2.0 * highest))
    ax.set_ylim(0.0, 1.25)
    label_axis(ax.xaxis, "frequency", "Hz")
    ax.set_ylabel("power spectral density\nover that of the ring")
    _note_aliases(ax, note)
    tidy(ax)
    if len(drawn) == 1:
        options: dict[str, Any] = {"xytext": (3, 2), "textcoords": "offset points"}
        ax.annotate(drawn[0].label, (highest, 1.0), **options, fontsize="small", color=drawn[0].colour)
    legend(ax, drawn)
    return ax


def alias_note(ds: xr.Dataset) -> str:
    """Say which of the drawn runs ring faster than their sampling shows, so that lines of a spectrum may be aliases.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep of a gear pair.

    Returns
    -------
    str
        Of several such runs about the one that rings fastest; empty if there is none.

    Raises
    ------
    SceneError
        If the dataset has no samples of the gear's speed.
    """
    shown = runs_of(ds, "gear_speed")
    return _alias_note(shown, [_impacts(run) for run in shown])


def _alias_note(shown: Sequence[Run], found: Sequence[xr.Dataset | None]) -> str:
    """Say of which runs the responses may be aliases."""
    noted = [
        (float(np.nanmax(responses["contact_frequency"])), run.label, str(responses.attrs["note"]))
        for run, responses in zip(shown, found, strict=True)
        if responses is not None and "note" in responses.attrs
    ]
    if not noted:
        return ""
    _, label, note = max(noted)
    others = f" (and {len(noted) - 1} more of the {len(shown)} runs shown)" if len(noted) > 1 else ""
    return f"{label}{others}: {note}" if label else note


def _note_aliases(ax: Axes, note: str) -> None:
    """Say below a picture that lines of it may be aliases."""
    if note:
        ax.annotate(
            "\n".join(wrap(note, characters(ax))),
            (0.0, 0.0),
            xycoords=("axes fraction", ax.xaxis.label),
            xytext=(0, -3),
            textcoords="offset points",
            va="top",
            fontsize="small",
        )


def _single(ds: xr.Dataset) -> xr.Dataset:
    members = list(runs(ds)) if "gear_speed" in ds else []
    if len(members) != 1:
        raise SceneError(
            "plot",
            f"({len(members)} runs)",
            "a spectrogram shows one run with a gear speed: pick it with .sel",
        )
    return members[0][1]


def _settled(run: Run, share: float) -> xr.Dataset:
    """Leave a share of a run out at its start."""
    time, end = run.data["time"], reached(run.data["gear_speed"])
    begin, stop = float(time[0]), float(time[end - 1])
    part = _between(run.data, end - _MOST_SAMPLES, end)
    return part.sel(time=slice(begin + share * (stop - begin), stop))


def _between(run: xr.Dataset, first: int, end: int) -> xr.Dataset:
    """Pick the speeds from one index to before another, and the events meanwhile; read them, if in a file."""
    first, end = max(first, 0), min(end, run.sizes["time"])
    if first == 0 and end == run.sizes["time"]:
        return run
    others = [name for name in run.data_vars if "time" in run[name].dims and name != "gear_speed"]
    part = run.drop_vars(others).isel(time=slice(first, end))
    begin, stop = float(part["time"][0]), float(part["time"][-1])
    events = [
        options + np.flatnonzero((times >= begin) & (times <= stop))
        for options, times in pieces(run["event_time"])
    ]
    return part.isel(event=np.concatenate([*events, np.empty(0, dtype=np.int64)])).load()


def _impacts(run: Run) -> xr.Dataset | None:
    """Frequencies of the impact responses of a run, where it has any."""
    record = _between(run.data, 0, _MOST_SAMPLES)
    try:
        return analysis.impact_frequencies(record)
    except SceneError:  # too short a record, or one without events
        return None


def _fit_heights(ax: Axes, wide: bool) -> None:
    """Show what is in view: some decades below the top; if the axis reaches to the ring, all that is not rounding."""
    low, high = ax.get_xlim()
    inside = []
    for line in ax.get_lines():
        at, power = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        inside.append(power[(at >= low) & (at <= high) & (power > 0.0)])
    values = np.concatenate([*inside, np.ones(1)] if not any(map(len, inside)) else inside)
    top = float(values.max())
    bottom = max(float(values.min()), top * 10.0**-_MOST_DECADES) if wide else top * 10.0**-DECADES
    ax.set_ylim(0.5 * bottom if wide else bottom, 3.0 * top)


def _mark_all(ax: Axes, drive: list[float], mesh: float, rings: list[float]) -> None:
    """Mark drive, mesh with its multiples as far as they stand apart, and rings, as far as they are in view."""
    low, high = ax.get_xlim()
    wide = ax.get_xscale() == "log"
    marks = [(line, "drive") for line in drive]
    if mesh > 0.0:
        last = _MARKED_IF_WIDE if wide else int(high / mesh)
        marks += [
            (multiple * mesh, "mesh" if multiple == 1 else "" if wide else f"{multiple} mesh")
            for multiple in range(1, 1 + last)
        ]
    marks += [(ring, "" if number else "rings") for number, ring in enumerate(rings)]
    for line, text in marks:
        if low <= line <= high:
            _mark(ax, line, text)


def _turns(ds: xr.Dataset) -> dict[str, int]:
    """Teeth of the gears whose turns show in a spectrum: by errors of teeth, a runout, or the orbit of the pinion."""
    scene = run_scene(ds.isel(dict.fromkeys(swept_dims(ds), 0)))
    mesh, gears = scene.mesh, scene.gears
    if mesh is None or gears is None:
        return {}
    alike = not (has_pitch_errors(scene) or mesh.pinion_runout or mesh.gear_runout or has_orbit(scene))
    return {} if alike else {"pinion": gears.pinion_teeth, "gear": gears.gear_teeth}


def _mark_sidebands(ax: Axes, mesh: float, turns: Mapping[str, int]) -> None:
    """Mark the turns of the shafts, and the lines of the mesh that are one and two of the pinion's turns away.

    Sidebands a turn of the gear apart are nearer than a picture shows; they are what is between.
    """
    low, high = ax.get_xlim()
    wide = ax.get_xscale() == "log"
    for number, (name, teeth) in enumerate(turns.items()):
        if low <= mesh / teeth <= high:
            _mark(ax, mesh / teeth, name, down=_LINE * (2 + number))
    if not turns or wide:  # on a logarithmic axis they are beside the mesh as close as its own mark is wide
        return
    pinion_frequency = mesh / turns["pinion"]
    for multiple in (-2, -1, 1, 2):
        ax.axvline(
            mesh + multiple * pinion_frequency,
            color="0.6",
            linewidth=line_width(0.7),
            linestyle=":",
            zorder=0,
        )
    _mark(ax, mesh + 2.0 * pinion_frequency, "\N{PLUS-MINUS SIGN} 1, 2 pinion", down=_LINE, line=False)


def _name_estimate(ax: Axes, resolution: float, wide: bool) -> None:
    """Say in a corner how the spectrum was estimated."""
    window, length = ("Tukey" if wide else "Hann"), with_prefix(1.0 / resolution, "s")
    words = f"{window} window over {length}, resolution {with_prefix(resolution, 'Hz')}"
    if wide:
        words += f"\naveraged over 1/24 octave above {crowded_from(resolution):.0f} Hz"
    ax.text(0.995, 0.9, words, transform=ax.transAxes, ha="right", va="top", fontsize="small", color="0.35")


def _length(run: xr.Dataset) -> float:
    """Length of a record, one interval for each sample [s]."""
    time = run["time"].values
    return float(time[-1] - time[0]) * len(time) / (len(time) - 1)


def _mean_speed(run: xr.Dataset, middle: Floats, half: float) -> Floats:
    """Mean of the gear's speed, without its sign, half a segment to both sides of each time [rad/s]."""
    time, speed = run["time"].values, run["gear_speed"].values
    turned = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (speed[1:] + speed[:-1]))])
    begin, end = np.maximum(middle - half, time[0]), np.minimum(middle + half, time[-1])
    return np.asarray(np.abs(np.interp(end, time, turned) - np.interp(begin, time, turned)) / (end - begin))


def _mesh_frequency(ds: xr.Dataset, run: xr.Dataset) -> float:
    teeth = judged_teeth(scene_of(ds)).gear_teeth
    return abs(float(run["gear_speed"].mean())) * teeth / (2.0 * math.pi)


def _has_one_speed(run: xr.Dataset) -> bool:
    """Tell whether the mean speeds of the quarters of a record lie within a tenth of that of the whole."""
    speed = run["gear_speed"].values
    means = [float(np.mean(part)) for part in np.array_split(speed, 4) if part.size]
    return max(means) - min(means) <= _ONE_SPEED * abs(float(np.mean(speed)))


def _last_pitch(speed: xr.DataArray, pitch: float) -> xr.DataArray:
    """Pick the last pitch that a gear turned before it stood, or all if it turned less."""
    values, time = np.abs(speed.values), speed["time"].values
    moving = np.flatnonzero(values > _STANDS * values.max())
    if not moving.size:
        return speed
    end = int(moving[-1])
    turned = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (speed.values[1:] + speed.values[:-1]))])
    before = np.flatnonzero(np.abs(turned[end] - turned[:end]) >= pitch)
    return speed.isel(time=slice(int(before[-1]) if before.size else 0, end + 1))


def _mark(ax: Axes, frequency: float, text: str, *, down: float = 0.0, line: bool = True) -> None:
    """Name a line of a spectrum at its top, or some points further down."""
    if line:
        ax.axvline(frequency, color="0.75", linewidth=line_width(0.7), zorder=0)
    ax.annotate(
        text,
        (frequency, 0.985),
        xycoords=ax.get_xaxis_transform(),
        xytext=(2, -down),
        textcoords="offset points",
        va="top",
        fontsize="small",
        color="0.35",
    )
