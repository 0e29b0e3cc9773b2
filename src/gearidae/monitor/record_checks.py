"""What may be wrong with a record although a coating map explains it: stops, rounding, aliasing, interference."""

from __future__ import annotations

import math

import numpy as np
import scipy

from gearidae.analysis.impacts import angle_of, windows_of
from gearidae.analysis.ringing import HIGHEST, Ring, piece_of
from gearidae.analysis.signal import FEWEST_SAMPLES, Signal
from gearidae.arrays import Floats
from gearidae.monitor.fitting import Fit, RingSet, sequences_from
from gearidae.monitor.map_model import BEFORE, MapModel

_SMOOTH = 0.02
"""The speed is averaged over this part of a pitch before it is compared with the map's smallest."""
_MARGIN = 0.02
"""A speed is below the map's smallest if it is by this part of the usual speed, and by four times the noise."""
_ON_GRID = 0.05
"""Largest departure of a rounded value from a multiple of the quantum, in quanta (single precision leaves some)."""
_DITHERED = 0.45
"""Noise of this many quanta turns rounding into white noise: rounding alone has at most 1/sqrt(12) = 0.29."""
_SHOWN = 1.0
"""Without noise, a ring of at least this many quanta survives the rounding."""
_ROUNDING = 0.01
"""Relative uncertainty of the frequency of a ring with an amplitude of one quantum."""
_IMAGE = 0.02
"""Relative uncertainty of a frequency that is seen as an image, from continuing the map."""
_HARMONICS = 3
_FEWEST = 3
"""Impacts needed where a coating more worn than the map's could be seen as an image."""
_BEYOND = 2.0
"""By how much coatings more worn than the map's ring higher than the map, while the gear still turns."""
_EVERY = 4
_STEPS = 10
"""Every fourth fraction, and ten shares between two impacts, are tried as images."""
_APART = 0.02
"""An image that means a fraction this near to the interval is no other answer."""
_LIKELY = 9.0
"""Images count as an explanation up to this loss of twice the log-likelihood: one in ninety."""
_PRECISION = 0.005
"""Relative precision to which a ring that is no image is predicted by the map."""
_OTHER_TORQUES = np.linspace(0.0, 1.0, 5)
"""Shifts by another torque that are tried with a map at one torque, in parts of the largest that the speed allows."""
_OTHER_SPEED = 2.0
"""With a map at one torque, a speed that differs from the map's by more than so many standard uncertainties is that of
another torque."""
_SURE = 0.005
"""Relative standard uncertainty of that difference at least."""
_LONE, _ABOVE_NOISE, _AGREEING, _MOST_ALONE, _NEIGHBOURS = 0.4, 6.0, 0.2, 2, 9
"""Up to two samples are alone if they are off the median of nine by this part of the usual speed, and those beside them
by less than a fifth of that: a missed pulse halves the speed, ringing goes on for many samples. Lone samples are also
off by six standard deviations of the noise: the speed of a gear that stands is noise alone."""
_FADED = 0.5
"""A ring falls below this part of its amplitude before the next impact; in all runs of the preset, to a hundredth."""


def unsteadiness(signal: Signal) -> float:
    """Change of the median speed from the first half of a record to the second, in parts of itself.

    Parameters
    ----------
    signal : Signal
        Gear speed.

    Returns
    -------
    float
        Over whole pitches if the record has two, so that the ripple from tooth to tooth does not count.
    """
    angle = np.maximum.accumulate(angle_of(signal))
    pitch = 2.0 * math.pi / (signal.gear_teeth or 1)
    half = 0.5 * float(angle[-1])
    if half >= pitch:
        half = pitch * math.floor(half / pitch)
    if half <= 0.0:
        return 0.0
    early, late = np.interp([half, angle[-1] - half], angle, np.arange(len(angle)))
    # medians, since a worn coating's dips are no drift
    first = float(np.median(signal.values[: int(early) + 1]))
    last = float(np.median(signal.values[int(late) :]))
    return abs(first - last) / (0.5 * (first + last)) if first + last > 0.0 else 0.0


def lone_samples(signal: Signal) -> list[int]:
    """Find the first of one or two samples that are far off between others that agree: spikes and missed pulses."""
    usual = scipy.ndimage.median_filter(signal.values, _NEIGHBOURS, mode="nearest")
    off = np.abs(signal.values - usual)
    least = max(_LONE * abs(float(np.median(signal.values))), _ABOVE_NOISE * _noise(signal.values))
    edges = np.flatnonzero(np.diff(off > least, prepend=False, append=False))
    return [
        int(start)
        for start, end in zip(edges[::2], edges[1::2], strict=True)
        if end - start <= _MOST_ALONE
        and max(off[max(start - 1, 0)], off[min(end, len(off) - 1)]) < _AGREEING * off[start:end].max()
    ]


def stop(signal: Signal, model: MapModel) -> str:
    """Say so if the gear stops or turns back.

    Parameters
    ----------
    signal : Signal
        Gear speed with the gear's teeth.

    Returns
    -------
    str
        Empty if it does not. A gear that starts from rest is judged from when it has reached half of its usual speed.
    """
    usual = float(np.median(signal.values))
    if usual <= 0.0:
        return "the gear stands still or turns back for half of the record"
    smallest, noise = _smallest_speed(signal, model, usual)
    if smallest < -4.0 * noise:
        return f"the gear turns back, to {smallest:.3g} rad/s"
    return "the gear stops" if smallest <= _MARGIN * usual else ""


def slower_than_map(signal: Signal, model: MapModel) -> str:
    """Say so if the gear slows down further than in any run of the map.

    Parameters
    ----------
    signal : Signal
        Gear speed, in the median above zero.

    Returns
    -------
    str
        Empty if it does not.
    """
    usual = float(np.median(signal.values))
    smallest, noise = _smallest_speed(signal, model, usual)
    # another torque slows the gear down throughout
    limit = model.slowest * min(1.0, usual / float(np.nanmedian(model.speeds)))
    if smallest >= limit - max(_MARGIN * usual, 4.0 * noise):
        return ""
    return f"the gear slows down to {smallest:.3g} rad/s, below the map's smallest speed, {limit:.3g} rad/s"


def _smallest_speed(signal: Signal, model: MapModel, usual: float) -> tuple[float, float]:
    """Smallest speed once the gear has come to half of its usual one, and the noise in it [rad/s].

    Averaged over a part of a pitch, so that neither noise nor a single dip counts.
    """
    pitch = 2.0 * math.pi / model.gear_teeth
    count = max(1, min(round(_SMOOTH * pitch / (usual * signal.interval)), len(signal.values)))
    slow = scipy.ndimage.uniform_filter1d(signal.values, count, mode="nearest")
    slow = slow[int((slow >= 0.5 * usual).argmax()) :]
    return float(slow.min()), _noise(signal.values) / math.sqrt(count)


def _noise(values: Floats) -> float:
    """Standard deviation of white noise in a record [its unit], from the median difference of neighbours."""
    return 1.48 * float(np.median(np.abs(np.diff(values)))) / math.sqrt(2.0)


def quantum(values: Floats) -> float:
    """Step to which a record is rounded [its unit]; 0 if it is not.

    Parameters
    ----------
    values : ndarray, shape (n,)

    Returns
    -------
    float
        The smallest difference between values that occur, if all of them are multiples of it apart.
    """
    levels = np.unique(values)
    if len(levels) < 2:
        return 0.0
    steps = np.diff(levels)
    apart = steps[steps > 1e-9 * max(abs(float(levels[0])), abs(float(levels[-1])))]
    if not len(apart):
        return 0.0
    smallest = float(apart.min())
    # the mean of all differences of one step is less rounded itself than the smallest of them
    step = float(apart[apart < 1.5 * smallest].mean())
    multiples = apart / step
    off = np.abs(multiples - np.round(multiples))
    return step if float(off.max()) < _ON_GRID else 0.0


def too_coarse(ring: Ring, step: float) -> bool:
    """Whether a ring is so small beside the rounding that its frequency is not the contact's.

    Parameters
    ----------
    step : float
        Quantum [rad/s].

    Returns
    -------
    bool
        Rounding turns a ring smaller than a quantum into steps, whose harmonics can be stronger than the ring. Noise
        of half a quantum before the rounding prevents that.
    """
    return ring.amplitude < _SHOWN * step and ring.noise < _DITHERED * step


def widened(ring: Ring, step: float) -> float:
    """Standard uncertainty of a ring's frequency [Hz], rounding included.

    Parameters
    ----------
    step : float
        Quantum [rad/s].
    """
    return math.hypot(ring.uncertainty, _ROUNDING * ring.frequency * min(1.0, step / ring.amplitude))


def persistent(signal: Signal, rings: list[Ring], shown: list[int], width: float) -> bool:
    """Whether what stands out after the impacts is there before them too: a tone of something else.

    Parameters
    ----------
    signal : Signal
        Gear speed, with the gear's teeth.
    rings : list of Ring
        Of all impacts.
    shown : list of int
        Which of them ring.
    width : float
        Of the windows, in pitches.

    Returns
    -------
    bool
        By the median over the impacts from the second on: before the first one the start may still ring.
    """
    windows, left = windows_of(signal, width), []
    for number in shown:
        _, start, stop = windows[number]
        if number == 0 or 2.0 * start - stop < signal.start:
            continue
        after = piece_of(signal, start, stop)
        before = piece_of(signal, 2.0 * start - stop, start)[-len(after) :]
        if len(before) >= FEWEST_SAMPLES:
            part = rings[number].frequency * signal.interval
            left.append(_strength(before, part) / _strength(after, part))
    return bool(left) and float(np.median(left)) > _FADED


def _strength(piece: Floats, frequency: float) -> float:
    """Amplitude at a frequency [in parts of the sampling rate] within a window, straight line taken out."""
    turns = np.exp(-2j * math.pi * frequency * np.arange(len(piece)))
    taper = np.hanning(len(piece))
    return float(abs((scipy.signal.detrend(piece) * taper * turns).sum()) / taper.sum())


def alias(model: MapModel, rings: RingSet, fit: Fit, rate: float, cutoff: float) -> str:
    """Say so if what shows could be the image of faster ringing.

    Parameters
    ----------
    fit : Fit
        That explains the record without images.
    rate : float
        Sampling rate [Hz].
    cutoff : float
        Nothing above this frequency was in the speed when it was sampled [Hz]; infinite if no filter is known.

    Returns
    -------
    str
        Empty if it could not. It could if another fraction of the map rings, in its first three harmonics, above half
        the sampling rate and its images explain the record; if the record has fewer than three impacts and a
        coating more worn than the map's could; or if the torque is not that of the map and some of the map's first
        impacts ring faster than the sampling shows.
    """
    if cutoff <= 0.5 * rate:
        return ""
    highest = model.highest_first if fit.history == "start" else model.highest
    # what shows below HIGHEST of the rate is the image of something above the rest of it
    lowest_image = (1.0 - HIGHEST) * rate
    if len(rings.numbers) < _FEWEST and lowest_image < min(_BEYOND * highest, cutoff):
        return (
            f"sampled at {rate:.3g} Hz without a low-pass filter, {len(rings.numbers)} impact(s) do not tell ringing "
            f"at these frequencies from images of ringing above {lowest_image:.3g} Hz"
        )
    if model.highest_first > HIGHEST * rate and _at_another_torque(model, rings, fit):
        return (
            f"sampled at {rate:.3g} Hz without a low-pass filter, and at another torque than the map's by the gear's "
            "speed, the record does not tell ringing from images of faster ringing; a map over drive.torque can"
        )
    other = _image_of(model, rings, fit, rate, cutoff)
    if math.isnan(other):
        return ""
    return (
        f"sampled at {rate:.3g} Hz without a low-pass filter, the ringing of a SAM fraction of {other:.2f} would show "
        f"at the same frequencies"
    )


def _at_another_torque(model: MapModel, rings: RingSet, fit: Fit) -> bool:
    """Whether the gear turns at another speed than in a map at one torque, so that all its frequencies are shifted."""
    if model.torques is not None:
        return False
    return abs(math.log(rings.speed / float(model.speeds[0, fit.best]))) > _OTHER_SPEED * max(
        rings.calibration, _SURE
    )


def _image_of(model: MapModel, rings: RingSet, fit: Fit, rate: float, cutoff: float) -> float:
    """Another fraction whose images explain the record best; NaN if none does."""
    torque = float(fit.torques[fit.best])
    sequences = model.at_torque(torque)[0][::_EVERY]
    fractions = model.fractions[::_EVERY]
    steps = rings.numbers - rings.numbers[0]
    kept = steps < sequences.shape[1]
    if fit.history == "start":
        kept &= rings.numbers + BEFORE < sequences.shape[1]
        predicted = sequences[:, None, BEFORE + rings.numbers[kept]]
    else:
        starts = np.arange((sequences.shape[1] - 1 - int(steps[kept][-1])) * _STEPS + 1) / _STEPS
        predicted = sequences_from(sequences, starts, steps[kept])
    if not kept.any():
        return math.nan
    misfit = np.full(len(fractions), np.inf)
    scatter = model.scatter_at(torque)
    uncertainty = rings.uncertainty[kept]
    if scatter is not None:  # what a gear of the design shows is as uncertain by itself
        uncertainty = np.hypot(uncertainty, scatter.deviation()[fit.best] * rings.frequency[kept])
    for shift in _shifts(model, rings):
        chi2, folded = _misfit_of_images(
            np.exp(predicted + shift[:, None, None]),
            rings.frequency[kept],
            uncertainty,
            rate,
            cutoff,
        )
        misfit = np.minimum(misfit, np.where(folded, chi2, np.inf).min(axis=1))
    possible = fit.possible
    misfit[(fractions > possible[0] - _APART) & (fractions < possible[-1] + _APART)] = np.inf
    best = int(misfit.argmin())
    return float(fractions[best]) if misfit[best] <= fit.chi2[fit.best] + _LIKELY else math.nan


def _shifts(model: MapModel, rings: RingSet) -> list[Floats]:
    """Shifts of the logarithm of the frequencies of each fraction that another torque could cause."""
    if model.torques is not None:
        return [np.zeros(len(model.fractions[::_EVERY]))]
    largest = np.nan_to_num(np.log(rings.speed / model.speeds[0, ::_EVERY]))
    return [part * largest for part in _OTHER_TORQUES]


def _misfit_of_images(
    ringing: Floats, measured: Floats, uncertainty: Floats, rate: float, cutoff: float
) -> tuple[Floats, np.ndarray]:
    """Misfit of what sampled ringing would show, and whether any of it would be an image.

    An image is predicted less sharply than what is seen directly, the less so the faster its original is. Twice the
    negative log-likelihood therefore counts the width of each prediction too; else the vaguest would explain most.

    Parameters
    ----------
    ringing : ndarray, shape (n, p, m)
        Frequencies of the contact [Hz]; NaN where unknown.
    measured, uncertainty : ndarray, shape (m,)
        Of the record [Hz].

    Returns
    -------
    misfit, folded : ndarray, shape (n, p)
    """
    direct = uncertainty**2 + (_PRECISION * measured) ** 2
    nearest = np.full(ringing.shape, np.inf)
    image = np.zeros(ringing.shape, dtype=bool)
    for harmonic in range(1, _HARMONICS + 1):
        frequency = harmonic * ringing
        folds = frequency > 0.5 * rate
        shown = np.abs(frequency - rate * np.round(frequency / rate))
        variance = uncertainty**2 + (_IMAGE * frequency) ** 2
        chi2 = (shown - measured) ** 2 / variance + np.log(np.maximum(1.0, variance / direct))
        # a harmonic stands out as an image only where its fundamental is itself out of sight
        allowed = np.isfinite(chi2) & (frequency <= cutoff)
        if harmonic > 1:
            allowed &= folds & (ringing > HIGHEST * rate)
        better = allowed & (chi2 < nearest)
        nearest = np.where(better, chi2, nearest)
        image = np.where(better, folds, image)
    return np.asarray(nearest.sum(axis=-1)), np.asarray(image.any(axis=-1))
