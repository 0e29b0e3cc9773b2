r"""Mesh impacts: when a pair of teeth leaves the mesh and its load falls on the others.

At every mesh exit the leaving pair lets go, held back by whatever adhesion there is, and the contact that stays rings.
Exits follow each other at one tooth pitch of the gear, :math:`2\pi/z_2`, so that a record of the speed shows them even
without events: turned over the angle :math:`\theta = \int\omega\,\mathrm dt`, the bursts of oscillation form a comb of
that known spacing, of which only the place is sought.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr
from scipy import signal as dsp
from scipy.ndimage import uniform_filter1d

from gearidae.analysis.signal import FEWEST_SAMPLES, Floats, Signal, signals, stack
from gearidae.errors import SceneError

__all__ = ["LEAD", "WIDTH", "angle_of", "impact_windows", "lowest_frequency", "windows_of"]

LEAD = 0.02
"""A window begins this much before its impact, in pitches."""
WIDTH = 0.2
"""A window ends this much after its impact, in pitches, unless asked for otherwise."""

_LOWEST_RING = 20.0
"""Slowest oscillation taken for ringing, in mesh frequencies; slower is the change of speed from tooth to tooth."""
_STARTED = 0.05
"""A gear that has turned this far, in pitches, is no longer at rest."""
_SMOOTH = 0.01
"""Its speed is judged over this part of a pitch."""
_SMALLEST_STEP = 1e-6
_COMB = 200
"""Places tried for the comb of impacts within one pitch."""
_REACH = 0.12
"""The comb compares the oscillation this far before and after each place, in pitches."""
_FAINTEST = 0.03
"""Bursts below this part of the strongest do not count in placing the comb."""


def impact_windows(
    data: xr.Dataset | xr.DataArray, *, width: float = WIDTH, gear_teeth: int | None = None
) -> xr.Dataset:
    """Find the mesh impacts and the windows of time in which the contact rings.

    Parameters
    ----------
    data : Dataset or DataArray
        Gear speed along ``time``; other dimensions are runs. Where it comes with events, the impacts are the mesh
        exits on the drive flank; otherwise they are found in the speed.
    width : float, optional
        How far a window reaches after its impact, in pitches of the gear, 0.02 .. 1. It begins 0.02 before it.
    gear_teeth : int, optional
        Teeth of the gear; needed if neither events nor a scene come with the data.

    Returns
    -------
    Dataset, dims (..., impact)
        ``impact_time``, ``window_start``, ``window_stop`` [s]. Impacts are counted from the first one in the record;
        NaN where a window would leave the record or the gear does not turn forward throughout.

    Raises
    ------
    SceneError
        If there is no gear speed, or nothing tells the impacts.
    """
    batch = signals(data, gear_teeth=gear_teeth)
    found = [windows_of(each.forward(), check_width(width)) for each in batch.signals]
    names = {
        "impact_time": "time of the mesh impact",
        "window_start": "start of the impact's window",
        "window_stop": "end of the impact's window",
    }
    known = all(each.exits is not None for each in batch.signals)
    return xr.Dataset(
        {
            name: stack(
                batch, "impact", [row[:, column] for row in found], name, {"units": "s", "long_name": text}
            )
            for column, (name, text) in enumerate(names.items())
        },
        attrs={
            "source": "mesh exits on the drive flank" if known else "bursts of oscillation in the gear speed",
            "lead": LEAD,
            "width": width,
            "comment": "lead and width in pitches of the gear",
        },
    )


def windows_of(signal: Signal, width: float) -> Floats:
    """Impact times and windows of one run.

    Parameters
    ----------
    signal : Signal
        Gear speed.
    width : float
        In pitches.

    Returns
    -------
    ndarray, shape (n, 3)
        Time of the impact, start and end of its window [s]; NaN as for `impact_windows`.

    Raises
    ------
    SceneError
        If neither events nor the number of teeth are known.
    """
    if signal.gear_teeth is None:
        raise SceneError(
            "gear_teeth", None, "is missing: the data carry no scene, so say how many teeth the gear has"
        )
    pitch = 2.0 * math.pi / signal.gear_teeth
    signal = _until_stop(signal, pitch)
    time, angle = signal.time, np.maximum.accumulate(angle_of(signal))
    if len(angle) < FEWEST_SAMPLES:
        return np.empty((0, 3))
    if signal.exits is None:
        at = _comb(signal, angle, pitch)
    else:
        inside = (signal.exits >= time[0]) & (signal.exits <= time[-1])
        at = np.interp(signal.exits[inside], time, angle)
    rows = [_window(time, angle, place, pitch, width) for place in at]
    return np.array(rows).reshape(-1, 3)


def angle_of(signal: Signal) -> Floats:
    """Angle turned since the first sample [rad], shape of the samples."""
    steps = 0.5 * (signal.values[1:] + signal.values[:-1]) * signal.interval
    return np.concatenate([np.zeros(min(1, len(signal.values))), np.cumsum(steps)])


def lowest_frequency(speed: Floats, gear_teeth: int) -> float:
    """Slowest oscillation that counts as ringing at a speed [rad/s]: 20 mesh frequencies [Hz]."""
    return _LOWEST_RING * float(speed.mean()) * gear_teeth / (2.0 * math.pi)


def check_width(width: float) -> float:
    """Refuse a window that holds nothing, or more than one impact."""
    if not LEAD <= width <= 1.0:
        raise SceneError("width", width, f"must lie in {LEAD:g}..1 pitches")
    return width


def _until_stop(signal: Signal, pitch: float) -> Signal:
    """Cut a record where the gear comes to a stop; it may begin at rest, and noise may cross zero meanwhile."""
    started = int(np.searchsorted(np.maximum.accumulate(angle_of(signal)), _STARTED * pitch))
    turning = signal.values[started:]
    if len(turning) < FEWEST_SAMPLES:
        return signal
    step = max(float(np.median(turning)) * signal.interval, _SMALLEST_STEP * pitch)
    slow = uniform_filter1d(turning, max(1, min(round(_SMOOTH * pitch / step), len(turning))), mode="nearest")
    stopped = slow <= 0.0
    end = started + int(stopped.argmax())
    return replace(signal, values=signal.values[:end]) if stopped.any() else signal


def _window(
    time: Floats, angle: Floats, place: float, pitch: float, width: float
) -> tuple[float, float, float]:
    """Time of the impact at an angle, and its window; NaN if it is not whole."""
    first, last = place - LEAD * pitch, place + width * pitch
    if first < angle[0] or last > angle[-1]:
        return math.nan, math.nan, math.nan
    impact, start, stop = np.interp([place, first, last], angle, time)
    return float(impact), float(start), float(stop)


def _comb(signal: Signal, angle: Floats, pitch: float) -> Floats:
    """Angles of the impacts: where in the pitch the oscillation grows most from just before to just after."""
    cutoff = lowest_frequency(signal.values, round(2.0 * math.pi / pitch))
    if angle[-1] < 2.0 * _REACH * pitch or not 0.0 < cutoff < 0.4 * signal.rate:
        return np.empty(0)
    fast = dsp.sosfiltfilt(dsp.butter(2, cutoff, "highpass", fs=signal.rate, output="sos"), signal.values)
    energy = np.concatenate([[0.0], np.cumsum(fast[1:] ** 2) * signal.interval])
    places = pitch * np.arange(_COMB) / _COMB
    teeth = np.arange(math.ceil(angle[-1] / pitch) + 1)
    at = places[:, None] + pitch * teeth[None, :]
    whole = (at >= _REACH * pitch) & (at <= angle[-1] - _REACH * pitch)
    until, before, after = (np.interp(at + shift * pitch, angle, energy) for shift in (0.0, -_REACH, _REACH))
    faint = _FAINTEST * np.max(after - until, where=whole, initial=0.0) + np.finfo(float).tiny
    growth = np.log((after - until + faint) / (until - before + faint))
    # a place near the ends of the record has fewer teeth: the mean, not the sum, compares them fairly
    counts = np.maximum(1, whole.sum(axis=1))
    score = np.where(whole.any(axis=1), np.sum(growth, axis=1, where=whole) / counts, -np.inf)
    best = places[int(score.argmax())]
    found = best + pitch * teeth
    return np.asarray(found[found <= angle[-1]], dtype=np.float64)
