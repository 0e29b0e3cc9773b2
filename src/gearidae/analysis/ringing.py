r"""The characteristic impact response: the frequency at which a loaded contact rings after a mesh impact.

The pair of teeth that stays in mesh is a spring, of stiffness :math:`k = -\mathrm dW/\mathrm dg` at its load, between
the gears' effective mass :math:`m_e = (R_1^2/I_1 + R_2^2/I_2)^{-1}`. It rings near
:math:`\sqrt{k/m_e}/2\pi`, higher the deeper the last impacts have pressed it: asperities once joined stay joined and
stretch, which adds to the stiffness, the more so the less of the coating is left. With a whole coating the frequency
is the same after every impact; with a worn one it rises from impact to impact.

Each impact's window is tapered (Hann) and transformed; among the peaks that stand out of the noise the one with the
largest acceleration, :math:`(2\pi f)^2 S(f)`, is the ring, because the acceleration is the contact force on the gear.
Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Figs. 9 and 10.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray

from gearidae.analysis.impacts import LEAD, WIDTH, check_width, lowest_frequency, windows_of
from gearidae.analysis.signal import FEWEST_SAMPLES, Signal, signals, stack
from gearidae.arrays import Floats
from gearidae.scene.prefixes import with_prefix

HIGHEST = 0.42
"""Ringing above this part of the sampling rate is left out: it could be the image of something still faster."""
_FEWEST_TURNINGS = 4
"""Of a pair's gap within a window, for its frequency."""

_PADDING = 8
_PROMINENCE = math.log(4.0)
_ABOVE_NOISE = 30.0
"""A peak must be this many times the median of the spectrum: chance passes it once in a thousand million bins."""
_ROUNDING = 4.0
"""What counts as noise in any case, in units of the last digit of the largest sample."""
_SHORTER = (0.8, 0.6)
"""Shorter windows, in parts of the full one, in which a frequency is measured again for its uncertainty."""


@dataclass(frozen=True, slots=True)
class Ring:
    """One impact's response.

    Attributes
    ----------
    time : float
        Time of the impact [s]; NaN where its window is not whole.
    frequency : float
        [Hz]; NaN if nothing stands out of the noise.
    uncertainty : float
        Standard uncertainty [Hz].
    amplitude : float
        Of the ring, averaged over its window, in the unit of the signal.
    noise : float
        Standard deviation of the white noise in the window, in the unit of the signal.
    own : float
        Frequency of the contact itself in the window [Hz], from the turning points of the run's events; NaN if unknown.
    """

    time: float
    frequency: float = math.nan
    uncertainty: float = math.nan
    amplitude: float = math.nan
    noise: float = math.nan
    own: float = math.nan


@dataclass(frozen=True, slots=True)
class _Peak:
    """The ring in one spectrum: frequency and random uncertainty [Hz], amplitude and noise of the signal."""

    frequency: float = math.nan
    random: float = math.nan
    amplitude: float = math.nan
    noise: float = math.nan


def characteristic_frequency(
    data: xr.Dataset | xr.DataArray, *, width: float = WIDTH, gear_teeth: int | None = None
) -> xr.DataArray:
    """Frequency of the first impact response in a record (Teodorescu et al. 2009, Fig. 10).

    Parameters
    ----------
    data : Dataset or DataArray
        Gear speed along ``time``; other dimensions are runs. ``data.sel(time=slice(...))`` picks a part.
    width : float, optional
        How far the impact's window reaches, in pitches of the gear. Within 0.12 .. 0.3 it changes the result by no
        more than its uncertainty.
    gear_teeth : int, optional
        Teeth of the gear; needed if the data carry no scene.

    Returns
    -------
    DataArray, dims (...)
        Frequency [Hz]; NaN if no impact rings, or the first does so faster than the sampling shows, which the attribute
        ``note`` says. Coordinates along the same dimensions: ``uncertainty`` [Hz], the
        standard uncertainty, and ``impacts``, the number of impacts that ring.

    Raises
    ------
    SceneError
        If there is no gear speed, or nothing determines the impacts.

    Notes
    -----
    Only the first impact can be compared between coatings: each one presses a worn contact deeper than the one
    before. `impact_frequencies` has them all.
    """
    frequencies = impact_frequencies(data, width=width, gear_teeth=gear_teeth)
    ringing = np.isfinite(frequencies["frequency"].values)
    known = ringing | hidden(frequencies)
    first = known.argmax(axis=-1) if known.shape[-1] else np.zeros(ringing.shape[:-1], dtype=np.int64)
    picked = {}
    for name in ("frequency", "uncertainty"):
        values = frequencies[name].values
        padded = values if values.shape[-1] else np.full((*values.shape[:-1], 1), np.nan)
        picked[name] = np.take_along_axis(padded, first[..., None], axis=-1)[..., 0]
    dims = frequencies["frequency"].dims[:-1]
    kept = {key: value for key, value in frequencies.coords.items() if "impact" not in value.dims}
    return xr.DataArray(
        picked["frequency"],
        dims=dims,
        coords={
            **kept,
            "uncertainty": (
                dims,
                picked["uncertainty"],
                {"units": "Hz", "long_name": "standard uncertainty of the characteristic frequency"},
            ),
            "impacts": (
                dims,
                ringing.sum(axis=-1),
                {"units": "1", "long_name": "number of impacts that ring"},
            ),
        },
        name="characteristic_frequency",
        attrs={
            "long_name": "frequency of the first impact response",
            "units": "Hz",
            **{
                key: frequencies.attrs[key]
                for key in ("window", "lead", "width", "sampling_rate", "note")
                if key in frequencies.attrs
            },
        },
    )


def impact_frequencies(
    data: xr.Dataset | xr.DataArray, *, width: float = WIDTH, gear_teeth: int | None = None
) -> xr.Dataset:
    """Frequency at which the contact rings after every mesh impact.

    Parameters
    ----------
    data, width, gear_teeth
        As for `characteristic_frequency`.

    Returns
    -------
    Dataset, dims (..., impact)
        ``frequency`` and its standard ``uncertainty`` [Hz], ``impact_time`` [s]. NaN where nothing stands out of the
        noise, and where the contact rings faster than the sampling shows: what is seen there are aliases. Then an
        attribute ``note`` says so. Of a run whose events are kept, ``contact_frequency`` [Hz] is that of the contact
        itself, from the times at which the gap turns round; else the ringing is followed from impact to impact.

    Raises
    ------
    SceneError
        If there is no gear speed, or nothing determines the impacts.
    """
    batch = signals(data, gear_teeth=gear_teeth)
    responses = [rings_of(signal.forward(), check_width(width)) for signal in batch.signals]
    columns: dict[str, tuple[str, dict[str, Any]]] = {
        "frequency": ("frequency of the impact response", {"units": "Hz"}),
        "uncertainty": ("standard uncertainty of the frequency", {"units": "Hz"}),
        "time": ("time of the mesh impact", {"units": "s"}),
        "own": ("frequency of the contact by its turning points", {"units": "Hz"}),
    }
    names = {"time": "impact_time", "own": "contact_frequency"}
    ds = xr.Dataset(
        {
            names.get(name, name): stack(
                batch,
                "impact",
                [np.array([getattr(ring, name) for ring in rings]) for rings in responses],
                name,
                {"long_name": text, **attrs},
            )
            for name, (text, attrs) in columns.items()
        },
        coords={"impact": _numbers(max(len(rings) for rings in responses))},
        attrs={
            "window": "hann",
            "lead": LEAD,
            "width": width,
            "comment": "lead and width of the windows in pitches of the gear",
            "sampling_rate": batch.signals[0].rate,
        },
    )
    aliased = hidden(ds)
    if aliased.any():
        rate, fastest = batch.signals[0].rate, float(np.nanmax(ds["contact_frequency"].values))
        ds.attrs["note"] = (
            f"contacts ring at up to {with_prefix(fastest, 'Hz', 3)}: sampled at {with_prefix(rate, 'Hz', 3)}, "
            f"{aliased.sum()} of {aliased.size} responses may be aliases; they need "
            f'{with_prefix(fastest / HIGHEST, "Hz", 3)} (run.samples = "ringing")'
        )
    return ds


def hidden(frequencies: xr.Dataset) -> NDArray[np.bool_]:
    """Where the contact itself rings faster than the sampling shows; see `impact_frequencies`."""
    return np.asarray(frequencies["contact_frequency"].values > HIGHEST * frequencies.attrs["sampling_rate"])


def impact_spectrum(
    data: xr.Dataset | xr.DataArray, *, width: float = WIDTH, gear_teeth: int | None = None
) -> xr.DataArray:
    """Power spectral density in the window of every mesh impact (Teodorescu et al. 2009, Fig. 9).

    Parameters
    ----------
    data, width, gear_teeth
        As for `characteristic_frequency`.

    Returns
    -------
    DataArray, dims (..., impact, frequency)
        One-sided density of the gear speed [(rad s-1)2 Hz-1] over ``frequency`` [Hz], Hann window, straight line
        taken out, zero-padded. NaN where a window is not whole.

    Raises
    ------
    SceneError
        If there is no gear speed, or nothing determines the impacts.
    """
    batch = signals(data, gear_teeth=gear_teeth)
    windows = [windows_of(signal.forward(), check_width(width)) for signal in batch.signals]
    pieces = [
        [piece_of(signal, start, stop) for _, start, stop in rows]
        for signal, rows in zip(batch.signals, windows, strict=True)
    ]
    longest = max((len(piece) for row in pieces for piece in row), default=0)
    size = _padded(max(longest, FEWEST_SAMPLES), 4)
    impacts = max((len(row) for row in pieces), default=0)
    density = np.full((len(pieces), impacts, size // 2 + 1), np.nan)
    rate = batch.signals[0].rate
    for target, row in zip(density, pieces, strict=True):
        for line, piece in zip(target, row, strict=False):
            if len(piece) >= FEWEST_SAMPLES:
                line[:] = _periodogram(piece, rate, size)[1]
    frequency = np.fft.rfftfreq(size, 1.0 / rate)
    return xr.DataArray(
        density.reshape(*batch.shape, impacts, len(frequency)),
        dims=(*batch.dims, "impact", "frequency"),
        coords={
            **{key: value.variable for key, value in batch.coords.items()},
            "impact": _numbers(impacts),
            "frequency": xr.Variable("frequency", frequency, {"units": "Hz", "long_name": "frequency"}),
        },
        name="impact_spectrum",
        attrs={
            "long_name": "power spectral density of gear_speed around the mesh impacts",
            "units": "(rad s-1)2 Hz-1",
            "sampling_rate": rate,
            "window": "hann",
            "lead": LEAD,
            "width": width,
            "comment": "lead and width of the windows in pitches of the gear",
        },
    )


def rings_of(signal: Signal, width: float) -> list[Ring]:
    """Responses to all impacts of one run, in their order.

    Parameters
    ----------
    signal : Signal
        Gear speed.
    width : float
        Of the windows, in pitches.

    Returns
    -------
    list of Ring
        One for each impact in the record.
    """
    teeth = signal.gear_teeth or 0
    rings = [
        replace(_ring(signal, row, teeth), own=own_frequency(signal, row))
        for row in windows_of(signal, width)
    ]
    highest = HIGHEST * signal.rate
    before, expected = math.nan, 0.0
    for number, ring in enumerate(rings):
        if ring.own > highest:
            rings[number] = Ring(ring.time, own=ring.own)
            continue
        if math.isfinite(ring.own):
            continue  # the contact is seen to ring no faster
        if ring.frequency > highest or expected > highest:
            # from here on the ringing is faster than the sampling shows; what is seen are images
            return [*rings[:number], *(Ring(later.time, own=later.own) for later in rings[number:])]
        if math.isfinite(ring.frequency):
            growth = ring.frequency / before if before < ring.frequency else 1.0
            before, expected = ring.frequency, ring.frequency * growth
    return rings


def own_frequency(signal: Signal, window: Floats) -> float:
    """Frequency at which the gap of a pair oscillates in a window [Hz]: half its turning points over their time.

    Of several pairs in mesh that counts which turns round most often. NaN where events are not known, or too few.
    """
    if signal.turnings is None or math.isnan(window[1]):
        return math.nan
    times, pairs = signal.turnings.T
    inside = (times >= window[1]) & (times <= window[2])
    fastest = math.nan
    for pair in np.unique(pairs[inside]):
        at = times[inside & (pairs == pair)]
        if len(at) >= _FEWEST_TURNINGS and at[-1] > at[0]:
            fastest = np.fmax(fastest, 0.5 * (len(at) - 1) / float(at[-1] - at[0]))
    return float(fastest)


def _ring(signal: Signal, window: Floats, teeth: int) -> Ring:
    """Response in one window, compared over shorter windows that begin alike."""
    impact, start, stop = window
    piece = piece_of(signal, start, stop)
    if len(piece) < FEWEST_SAMPLES:
        return Ring(impact)
    lowest = lowest_frequency(piece, teeth)
    peak = _peak(piece, signal.rate, lowest)
    frequency = peak.frequency
    if math.isnan(frequency):
        return Ring(impact)
    same = [frequency]
    for part in _SHORTER:
        piece = piece_of(signal, start, start + part * (stop - start))
        if len(piece) < FEWEST_SAMPLES:
            continue
        other = _peak(piece, signal.rate, lowest, near=frequency).frequency
        # where noise or the change of speed hides the ring, another peak is nearest, beyond a line's width
        if abs(other - frequency) < 2.0 * signal.rate / len(piece):
            same.append(other)
    spread = 0.5 * (max(same) - min(same))
    return Ring(impact, frequency, math.hypot(spread, peak.random), peak.amplitude, peak.noise)


def _peak(piece: Floats, rate: float, lowest: float, near: float | None = None) -> _Peak:
    """Ring in a window; NaN if nothing stands out.

    The ring is the peak of largest acceleration, or the one nearest to a frequency that is known already.

    For a tone of peak-to-noise ratio q in a window of length T the best that can be had is sqrt(3/q)/(2 pi T)
    (Cramer and Rao); a Hann window loses a factor of 1.6.
    """
    size = _padded(len(piece), _PADDING)
    frequency, density = _periodogram(piece, rate, size)
    first = int(np.searchsorted(frequency, lowest))
    if first >= len(frequency) - 2:
        return _Peak()
    rounding = _ROUNDING * np.finfo(float).eps * float(np.abs(piece).max())
    floor = float(np.median(density[first:])) + 2.0 * rounding**2 / rate + np.finfo(float).tiny
    logarithm = np.log(density + np.finfo(float).tiny)
    peaks, _ = scipy.signal.find_peaks(logarithm, prominence=_PROMINENCE)
    peaks = peaks[(peaks >= first) & (density[peaks] > _ABOVE_NOISE * floor)]
    if not len(peaks):
        return _Peak()
    if near is None:
        top = int(peaks[np.argmax(density[peaks] * frequency[peaks] ** 2)])
    else:
        top = int(peaks[np.argmin(np.abs(frequency[peaks] - near))])
    left, middle, right = logarithm[top - 1 : top + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    ratio = density[top] * math.log(2.0) / floor
    random = 1.6 * math.sqrt(3.0 / ratio) * rate / (2.0 * math.pi * len(piece))
    # a Hann window is 1.5 bins wide; the median of white noise's spectrum is ln 2 of its mean
    amplitude = math.sqrt(2.0 * density[top] * 1.5 * rate / len(piece))
    noise = math.sqrt(0.5 * rate * floor / math.log(2.0))
    return _Peak(float(frequency[top] + shift * frequency[1]), random, amplitude, noise)


def piece_of(signal: Signal, start: float, stop: float) -> Floats:
    """Samples of a window.

    Parameters
    ----------
    start, stop : float
        Its ends [s]; NaN if it is not whole.

    Returns
    -------
    ndarray, shape (n,)
        None if it is not whole.
    """
    if math.isnan(start):
        return np.empty(0)
    first = math.ceil((start - signal.start) / signal.interval - 1e-9)
    last = math.floor((stop - signal.start) / signal.interval + 1e-9)
    return signal.values[first : last + 1]


def _periodogram(piece: Floats, rate: float, size: int) -> tuple[Floats, Floats]:
    # of a constant, a straight line's fit leaves its rounding error, other on each processor; nothing is left of zero
    piece = piece - piece[0]
    frequency, density = scipy.signal.periodogram(piece, rate, window="hann", nfft=size, detrend="linear")
    return frequency, density


def _numbers(count: int) -> xr.Variable:
    return xr.Variable(
        "impact", np.arange(count), {"units": "1", "long_name": "number of the impact in the record, from 0"}
    )


def _padded(size: int, factor: int) -> int:
    """Length of the transform: a power of two, at least `factor` times the samples."""
    return 1 << (factor * size - 1).bit_length()
