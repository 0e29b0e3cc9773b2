r"""Spectra of whole records: power spectral density and spectrogram, by `scipy.signal`.

Both are one-sided densities: integrated over frequency they give the variance of the signal,

.. math::

    \int_0^{f_s/2} S(f)\, \mathrm{d}f = \overline{(x - \bar x)^2},

whatever the window. Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Figs. 6 and 9.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import scipy
import xarray as xr

from gearidae.analysis.impacts import WIDTH, windows_of
from gearidae.analysis.ringing import own_frequency
from gearidae.analysis.signal import FEWEST_SAMPLES, Batch, signals, stack
from gearidae.archive.select import is_roller, is_train, run_scene, runs
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.mesh.pair_contact import pair_contact
from gearidae.mesh.train_modes import natural_frequencies
from gearidae.scene import Scene, is_long_train
from gearidae.scene.quantity import whole

_MOST_PADDING = 64
_PER_OCTAVE = 24
"""Bands of an octave over which a spectrum on a logarithmic axis is averaged."""
_PIECES = 64
"""A spectrogram's segment is this part of the record by default."""


def power_spectrum(
    data: xr.Dataset | xr.DataArray,
    variable: str = "gear_speed",
    *,
    segment: float | None = None,
    window: str | tuple[str, float] = "hann",
    padding: int = 1,
) -> xr.DataArray:
    """Power spectral density by Welch's method (Teodorescu et al. 2009, Fig. 6).

    Parameters
    ----------
    data : Dataset or DataArray
        Samples along ``time``; other dimensions are runs. ``data.sel(time=slice(...))`` picks a part.
    variable : str, optional
        Which variable of a Dataset.
    segment : float, optional
        Length of the segments that are averaged, overlapping by half [s]; by default half the record. Lines closer
        than about two over this length are not resolved.
    window : str or tuple, optional
        Taper, by its scipy name; with its parameter where it has one, ``("tukey", 0.2)``.
    padding : int, optional
        Length of the transform over that of a segment, filled up by zeros: so many times closer values of the same
        estimate, with no more resolution.

    Returns
    -------
    DataArray, dims (..., frequency)
        One-sided density [unit of the signal squared per Hz] over ``frequency`` [Hz]. Attributes say how it was
        made: ``sampling_rate`` [Hz], ``window``, ``segment_length`` [s], ``overlap`` [1]. NaN for runs shorter than
        a segment.

    Raises
    ------
    SceneError
        If the variable is missing, the time is not uniform, or the segment or the window is not allowed.

    Warns
    -----
    UserWarning
        If the sampling rate is below twice the frequency of the loaded contact.
    """
    padding = whole("padding", padding, 1, _MOST_PADDING)
    batch = signals(data, variable)
    size, rate = _segment(batch, segment, 0.5), batch.signals[0].rate
    warn_of_aliasing(data, batch)
    taper = _taper(window, size)
    long = padding * size
    rows = [
        scipy.signal.welch(
            signal.values, rate, window=taper, noverlap=size // 2, nfft=long, detrend="constant"
        )[1]
        if len(signal.values) >= size
        else np.full(long // 2 + 1, np.nan)
        for signal in batch.signals
    ]
    spectrum = stack(
        batch, "frequency", rows, f"{batch.name}_power_spectrum", _attributes(batch, window, size, 0.5)
    )
    return spectrum.assign_coords(frequency=_frequency(long, 1.0 / rate))


def spectrogram(
    data: xr.Dataset | xr.DataArray,
    variable: str = "gear_speed",
    *,
    segment: float | None = None,
    overlap: float = 0.75,
    window: str = "hann",
) -> xr.DataArray:
    """Power spectral density over time.

    Parameters
    ----------
    data : Dataset or DataArray
        Samples along ``time``; other dimensions are runs.
    variable : str, optional
        Which variable of a Dataset.
    segment : float, optional
        Length of the segments [s]; by default 1/64 of the record.
    overlap : float, optional
        Part of a segment shared with the next, 0 <= overlap < 1.
    window : str, optional
        Taper, by its scipy name.

    Returns
    -------
    DataArray, dims (..., frequency, time)
        One-sided density [unit of the signal squared per Hz]; ``time`` [s] is the middle of each segment, from
        which a straight line is taken out, so that a run-up itself does not show. Attributes as for `power_spectrum`.

    Raises
    ------
    SceneError
        If the variable is missing, the time is not uniform, or a setting is not allowed.

    Warns
    -----
    UserWarning
        As `power_spectrum` does.
    """
    if not 0.0 <= overlap < 1.0:
        raise SceneError("overlap", overlap, "must lie in 0..1, below 1")
    batch = signals(data, variable)
    first = batch.signals[0]
    size = _segment(batch, segment, 1.0 / _PIECES)
    warn_of_aliasing(data, batch)
    shared = min(size - 1, round(overlap * size))
    taper = _taper(window, size)
    longest = max(len(signal.values) for signal in batch.signals)
    columns = 1 + (longest - size) // (size - shared)
    made = np.full((len(batch.signals), size // 2 + 1, columns), np.nan)
    for target, signal in zip(made, batch.signals, strict=True):
        if len(signal.values) >= size:
            density = scipy.signal.spectrogram(
                signal.values, first.rate, window=taper, noverlap=shared, detrend="linear", mode="psd"
            )[2]
            target[:, : density.shape[1]] = density
    middle = first.start + first.interval * (0.5 * size + (size - shared) * np.arange(columns))
    return xr.DataArray(
        made.reshape(*batch.shape, *made.shape[1:]),
        dims=(*batch.dims, "frequency", "time"),
        coords={
            **{key: value.variable for key, value in batch.coords.items()},
            "frequency": _frequency(size, first.interval),
            "time": xr.Variable("time", middle, {"units": "s", "long_name": "middle of the segment"}),
        },
        name=f"{batch.name}_spectrogram",
        attrs=_attributes(batch, window, size, shared / size)
        | {"scaling": "density, one-sided; a straight line is taken out of each segment"},
    )


def _segment(batch: Batch, length: float | None, part: float) -> int:
    """Samples per segment."""
    interval = batch.signals[0].interval
    longest = max(len(signal.values) for signal in batch.signals)
    size = max(FEWEST_SAMPLES, int(part * longest)) if length is None else round(length / interval)
    if size == longest + 1:  # n samples span n - 1 intervals: "the whole record" may mean either
        size = longest
    if not FEWEST_SAMPLES <= size <= longest:
        shown = f"({longest} samples)" if length is None else f"{length:g} s"
        shortest, whole = FEWEST_SAMPLES * interval, longest * interval
        raise SceneError("segment", shown, f"must lie in {shortest:.4g}..{whole:.4g} s, the record's length")
    return size


def _taper(window: str | tuple[str, float], size: int) -> Floats:
    try:
        return np.asarray(scipy.signal.get_window(window, size), dtype=np.float64)
    except (ValueError, TypeError):
        raise SceneError("window", window, "is no window that scipy.signal knows by name") from None


def _frequency(size: int, interval: float) -> xr.Variable:
    frequency = np.fft.rfftfreq(size, interval)
    return xr.Variable("frequency", frequency, {"units": "Hz", "long_name": "frequency"})


def _attributes(batch: Batch, window: str | tuple[str, float], size: int, overlap: float) -> dict[str, Any]:
    interval = batch.signals[0].interval
    return {
        "long_name": f"power spectral density of {batch.name}",
        "units": f"({batch.units})2 Hz-1",
        "sampling_rate": 1.0 / interval,
        "window": window if isinstance(window, str) else " ".join(map(str, window)),
        "segment_length": size * interval,
        "overlap": overlap,
        "resolution": 1.0 / (size * interval),
        "scaling": "density, one-sided; the mean of each segment is taken out",
    }


def warn_of_aliasing(data: xr.Dataset | xr.DataArray, batch: Batch) -> None:
    """Warn of a record whose sampling rate is below twice the frequency of the contact.

    That is the largest after a mesh exit by the turning points of the events, and else estimated from the drive torque.

    Parameters
    ----------
    data : Dataset or DataArray
        Runs of gears with their drive torque; nothing is known of others.
    batch : Batch
        Their signals.
    """
    if not isinstance(data, xr.Dataset) or "scene" not in data.attrs or "drive_torque" not in data:
        return
    if is_roller(data):
        return
    rate = batch.signals[0].rate
    frequency = max(_contact_frequency(run_scene(run), run) for _, run in runs(data))
    if batch.name == "gear_speed":  # what impacts are found in
        known = [signal for signal in batch.signals if signal.turnings is not None and signal.gear_teeth]
        seen = (own_frequency(signal, window) for signal in known for window in windows_of(signal, WIDTH))
        frequency = max(frequency, *(value for value in seen if value > 0.0), 0.0)
    if rate < 2.0 * frequency:
        warnings.warn(
            f"sampling at {rate:.4g} Hz is below twice the frequency of the loaded contact, {frequency:.4g} Hz: the "
            "spectrum may show oscillations of the contact at lower frequencies (aliasing)",
            stacklevel=3,
        )


def _contact_frequency(scene: Scene, run: xr.Dataset) -> float:
    """Frequency of one pair about the gap at which it carries the mean drive torque [Hz]; 0 if it carries none.

    Of a train the highest of all, with one pair in each mesh at the gap at which it carries the mesh's mean force.
    """
    if is_long_train(scene):
        if not is_train(run) or "mesh_force" not in run:
            return 0.0
        forces = np.nan_to_num(abs(run["mesh_force"]).mean("time").values)
        return max(natural_frequencies(scene, forces), default=0.0)
    assert scene.gears is not None
    contact, geometry = pair_contact(scene), scene.geometry
    pinion, gear = geometry.base_radius_pinion, geometry.base_radius_gear
    torque = float(np.nan_to_num(np.abs(run["drive_torque"]).mean()))
    gap = contact.resting_gap(torque / pinion, 1e-3)
    if math.isnan(gap):
        return 0.0
    inverse_mass = pinion**2 / scene.gears.pinion_inertia + gear**2 / scene.gears.gear_inertia
    return math.sqrt(max(contact.joined_stiffness(gap), 0.0) * inverse_mass) / (2.0 * math.pi)


def crowded_from(resolution: float) -> float:
    """Return the frequency above which a band of 1/24 octave is wider than the resolution [Hz]."""
    return float(resolution / (2.0 ** (1.0 / _PER_OCTAVE) - 1.0))


def banded(frequency: Floats, density: Floats, resolution: float) -> tuple[Floats, Floats]:
    """Average a spectrum over bands of 1/24 octave, where these are wider than its resolution.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        In equal steps [Hz].
    density : ndarray, shape (n,)
        Power spectral density.
    resolution : float
        Inverse of the record's length [Hz].

    Returns
    -------
    frequency, density : ndarray, shape (m,)
        The values below about 35 times the resolution, then the mean density of each band at its middle: the power in
        a band stays what it is.
    """
    from_here = crowded_from(resolution)
    crowded = frequency >= from_here
    if not crowded.any():
        return frequency, density
    number = np.floor(_PER_OCTAVE * np.log2(frequency[crowded] / from_here)).astype(np.int64)
    _, first, count = np.unique(number, return_index=True, return_counts=True)
    means = np.add.reduceat(density[crowded], first) / count
    middles = np.add.reduceat(frequency[crowded], first) / count
    return np.concatenate([frequency[~crowded], middles]), np.concatenate([density[~crowded], means])
