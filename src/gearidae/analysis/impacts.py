r"""Mesh impacts: when a pair of teeth leaves the mesh and its load falls on the others.

At every mesh exit the leaving pair separates against its adhesion, and the remaining contact rings.
Exits follow each other at one tooth pitch of the gear, :math:`2\pi/z_2`, so that a record of the speed shows them even
without events: turned over the angle :math:`\theta = \int\omega\,\mathrm dt`, the bursts of oscillation form a comb of
that known spacing, of which only the phase is sought.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
import xarray as xr

from gearidae.analysis.signal import FEWEST_SAMPLES, Signal, signals, stack
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.quantity import number

LEAD = 0.02
"""A window begins this much before its impact, in pitches."""
WIDTH = 0.2
"""A window ends this much after its impact, in pitches, by default."""

_LOWEST_RING = 20.0
"""Slowest oscillation taken for ringing, in mesh frequencies; slower is the change of speed from tooth to tooth."""
_STARTED = 0.05
"""A gear that has turned this far, in pitches, is no longer at rest."""
_SMOOTH = 0.01
"""Its speed is judged over this part of a pitch."""
_SMALLEST_STEP = 1e-6
_COMB = 200
"""Phases tried for the comb of impacts within one pitch."""
_REACH = 0.12
"""The comb compares the oscillation this far before and after each impact, in pitches."""
_FAINTEST = 0.03
"""Bursts below this part of the strongest do not count in placing the comb."""
_CLEARLY = 0.2
"""Another spacing than the pitch must explain the bursts better by this, in the mean logarithm of their growth."""
_FURTHEST = 0.12
"""Largest error of calibration that is sought."""
_FEWEST_BURSTS = 3
"""With fewer, their spacing says too little."""
_FIRST_BURSTS = 8
_DRIFT = 0.02
"""Pitches by which the last impact moves from one spacing that is tried to the next."""


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
        If there is no gear speed, or nothing determines the impacts.
    """
    batch = signals(data, gear_teeth=gear_teeth)
    windows = [windows_of(signal.forward(), check_width(width)) for signal in batch.signals]
    names = {
        "impact_time": "time of the mesh impact",
        "window_start": "start of the impact's window",
        "window_stop": "end of the impact's window",
    }
    known = all(signal.exits is not None for signal in batch.signals)
    return xr.Dataset(
        {
            name: stack(
                batch, "impact", [row[:, column] for row in windows], name, {"units": "s", "long_name": text}
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
    rows = [_window(time, angle, impact_angle, pitch, width) for impact_angle in at]
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
    if not LEAD <= (width := number("width", width)) <= 1.0:
        raise SceneError("width", width, f"must lie in {LEAD:g}..1 pitches")
    return width


def _until_stop(signal: Signal, pitch: float) -> Signal:
    """Cut a record where the gear comes to a stop; it may begin at rest, and noise may cross zero meanwhile."""
    started = int(np.searchsorted(np.maximum.accumulate(angle_of(signal)), _STARTED * pitch))
    turning = signal.values[started:]
    if len(turning) < FEWEST_SAMPLES:
        return signal
    step = max(float(np.median(turning)) * signal.interval, _SMALLEST_STEP * pitch)
    slow = scipy.ndimage.uniform_filter1d(
        turning, max(1, min(round(_SMOOTH * pitch / step), len(turning))), mode="nearest"
    )
    stopped = slow <= 0.0
    end = started + int(stopped.argmax())
    return replace(signal, values=signal.values[:end]) if stopped.any() else signal


def _window(
    time: Floats, angle: Floats, impact_angle: float, pitch: float, width: float
) -> tuple[float, float, float]:
    """Time of the impact at an angle, and its window; NaN if it is not whole."""
    first, last = impact_angle - LEAD * pitch, impact_angle + width * pitch
    if first < angle[0] or last > angle[-1]:
        return math.nan, math.nan, math.nan
    impact, start, stop = np.interp([impact_angle, first, last], angle, time)
    return float(impact), float(start), float(stop)


def _comb(signal: Signal, angle: Floats, pitch: float) -> Floats:
    """Angles of the impacts: where in the pitch the oscillation grows most from just before to just after."""
    bursts = _bursts(signal, angle, pitch)
    if bursts is None:
        return np.empty(0)
    spacing, score = 1.0, bursts.score(1.0)[0]
    if signal.calibration > 0.0:
        other, higher = bursts.best(1.0 - signal.calibration, 1.0 + signal.calibration)
        spacing = other if higher > score + _CLEARLY else 1.0
    angles = bursts.score(spacing)[1] + spacing * pitch * np.arange(bursts.pitches + 1)
    return np.asarray(angles[angles <= angle[-1]], dtype=np.float64)


def unlike_pitch(signal: Signal) -> float:
    """Distance of the bursts of oscillation where it is not the gear's pitch, as a wrong calibration makes it.

    Parameters
    ----------
    signal : Signal
        Gear speed, with the gear's teeth.

    Returns
    -------
    float
        In pitches; 1 where a pitch within the calibration's uncertainty explains the bursts as well, or too few of them
        are in the record.
    """
    pitch = 2.0 * math.pi / (signal.gear_teeth or 1)
    signal = _until_stop(signal, pitch)
    bursts = _bursts(signal, np.maximum.accumulate(angle_of(signal)), pitch) if len(signal.values) else None
    if bursts is None or signal.calibration >= _FURTHEST:
        return 1.0
    spacing, score = bursts.best(1.0 - _FURTHEST, 1.0 + _FURTHEST)
    expected = bursts.best(1.0 - signal.calibration, 1.0 + signal.calibration)[1]
    evident = bursts.score(spacing)[2] >= _FEWEST_BURSTS and score > expected + _CLEARLY
    return spacing if evident else 1.0


@dataclass(frozen=True, slots=True)
class _Bursts:
    """Oscillation over the angle, in which impacts are sought.

    Attributes
    ----------
    angle : ndarray, shape (n,)
        Turned since the first sample [rad].
    energy : ndarray, shape (n,)
        Integral of the squared oscillation until then.
    pitch : float
        [rad].
    """

    angle: Floats
    energy: Floats
    pitch: float

    @property
    def pitches(self) -> int:
        """Pitches in the record, the last one begun."""
        return math.ceil(float(self.angle[-1]) / self.pitch)

    def score(self, spacing: float, most: int | None = None) -> tuple[float, float, int]:
        """Growth of the oscillation at impacts of one spacing.

        Parameters
        ----------
        spacing : float
            In pitches.
        most : int, optional
            How many of the impacts to take, from the first one on; all by default.

        Returns
        -------
        score : float
            Mean logarithm of the growth at the best angle of the first impact.
        place : float
            That angle [rad].
        impacts : int
            How many of them are whole.
        """
        pitch, last = self.pitch, float(self.angle[-1])
        offsets = spacing * pitch * np.arange(_COMB) / _COMB
        at = offsets[:, None] + spacing * pitch * np.arange((most or self.pitches) + 1)[None, :]
        whole = (at >= _REACH * pitch) & (at <= last - _REACH * pitch)
        until, before, after = (
            np.interp(at + shift * pitch, self.angle, self.energy) for shift in (0.0, -_REACH, _REACH)
        )
        faint = _FAINTEST * np.max(after - until, where=whole, initial=0.0) + np.finfo(float).tiny
        growth = np.log((after - until + faint) / (until - before + faint))
        # an angle near the ends of the record has fewer teeth: the mean, not the sum, compares them fairly
        counts = np.maximum(1, whole.sum(axis=1))
        score = np.where(whole.any(axis=1), np.sum(growth, axis=1, where=whole) / counts, -np.inf)
        best = int(score.argmax())
        return float(score[best]), float(offsets[best]), int(whole[best].sum())

    def best(self, low: float, high: float) -> tuple[float, float]:
        """Spacing from `low` to `high` [pitches] at which the growth is largest, and its score.

        The more impacts, the more finely the spacing shows: it is sought with a few of them, then nearby with more.
        """
        middle, half, most = 0.5 * (low + high), 0.5 * (high - low), _FIRST_BURSTS
        while True:
            step = _DRIFT / min(most, self.pitches + 1)
            spacings = middle + half * np.linspace(-1.0, 1.0, 2 * math.ceil(half / step) + 1)
            scores = [self.score(float(spacing), most)[0] for spacing in spacings]
            middle = float(spacings[int(np.argmax(scores))])
            if most > self.pitches:
                return middle, max(scores)
            half, most = 2.0 * step, 4 * most


def _bursts(signal: Signal, angle: Floats, pitch: float) -> _Bursts | None:
    """Oscillation faster than the change of speed from tooth to tooth; None if the record is too short for it."""
    cutoff = lowest_frequency(signal.values, round(2.0 * math.pi / pitch))
    if angle[-1] < 2.0 * _REACH * pitch or not 0.0 < cutoff < 0.4 * signal.rate:
        return None
    fast = scipy.signal.sosfiltfilt(
        scipy.signal.butter(2, cutoff, "highpass", fs=signal.rate, output="sos"), signal.values
    )
    return _Bursts(angle, np.concatenate([[0.0], np.cumsum(fast[1:] ** 2) * signal.interval]), pitch)
