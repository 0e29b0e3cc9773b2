r"""From a measured speed signal to the state of the coating.

The frequencies :math:`f_0, f_1, \dots` at which the contact rings after successive mesh impacts are compared with
those of a coating map. With :math:`x = \ln f`, a fraction :math:`\varphi` explains the signal as well as

.. math::

    \chi^2(\varphi) = \min_c \left[ \frac{c^2}{s^2} +
                     \sum_n \frac{\left(x_n - X_\varphi(n + n_0) - c\right)^2}{s_n^2} \right]

is small, where :math:`X_\varphi` interpolates the map, :math:`s_n` joins the measurement's uncertainty with that of
the map, and c is an error that all impacts share. If the record begins with the map's start, :math:`n_0 = 0`. Otherwise
:math:`n_0` is free: a worn contact is pressed deeper by each impact, from wherever it began, and it is the step from
one impact to the next that tells the fraction.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.interpolate import PchipInterpolator

from gearidae.analysis.impacts import check_width
from gearidae.analysis.measured import read_signal
from gearidae.analysis.ringing import HIGHEST, rings_of
from gearidae.analysis.signal import Floats, signals
from gearidae.errors import SceneError
from gearidae.studies.coating_map import require_map

__all__ = ["Assessment", "assess"]

_GRID = 1001
_MODEL = 0.005
"""Relative uncertainty of each of the map's frequencies, from interpolation."""
_COMMON = 0.01
"""Relative uncertainty that all impacts of a signal share, from finding them all a little early or late."""
_WITHIN = 3.84
"""Rise of chi-square within the 95 % interval (one parameter)."""
_FITS = 9.0
"""Largest chi-square for each impact of a signal that the map explains: three standard uncertainties."""
_FEWEST_LEFT = 3
"""Impacts needed beside one that is left out."""
_PLAIN = 0.1
"""Intervals wider than this say nothing about the coating."""
_GAP = 0.02
"""Fractions further apart than this, with none in between that explains the signal, are different answers."""
_SPEEDS = 0.15
"""Largest relative difference between the signal's median speed and the map's."""
_BEFORE, _BEYOND = 1, 6
"""Impacts by which the map's sequences are continued at both ends."""
_STEPS = 20
"""Places tried between two impacts."""

_HISTORIES = ("auto", "start", "unknown")


@dataclass(frozen=True, slots=True)
class Assessment:
    """What a signal says about the coating.

    Attributes
    ----------
    sam_fraction : float
        Most likely fraction [1]; NaN if the signal cannot tell.
    low, high : float
        95 % interval [1]; NaN if the signal cannot tell.
    verdict : str
        - ``clear``: one fraction explains the signal.
        - ``ambiguous``: quite different fractions do; `low` and `high` are the ends of what is possible.
        - ``no impacts``: nothing rings above the noise.
        - ``outside the map``: it rings lower or higher than anything in the map.
        - ``does not fit``: no fraction of the map explains it.
    explanation : str
        The same in a sentence.
    frequencies : tuple of float
        Frequency of each impact response [Hz]; NaN where nothing stands out.
    history : str
        ``start`` if the record was taken to begin with the map's start, ``unknown`` if not.
    """

    sam_fraction: float
    low: float
    high: float
    verdict: str
    explanation: str
    frequencies: tuple[float, ...]
    history: str

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty of the fraction [1]: a quarter of the interval."""
        return 0.25 * (self.high - self.low)

    @property
    def conclusive(self) -> bool:
        """Whether the signal tells the fraction."""
        return self.verdict == "clear"

    def __str__(self) -> str:
        return self.explanation


@dataclass(frozen=True, slots=True)
class _Fit:
    """Chi-square over the fractions of the grid."""

    fractions: Floats
    chi2: Floats
    impacts: int
    history: str

    @property
    def best(self) -> int:
        return int(self.chi2.argmin())

    @property
    def explains(self) -> bool:
        return bool(self.chi2[self.best] <= _FITS * self.impacts)


def assess(
    signal: xr.Dataset | xr.DataArray | str | os.PathLike[str],
    map: xr.Dataset,  # noqa: A002 - what it is called in the field, and in the command line
    *,
    history: str = "auto",
) -> Assessment:
    """Tell the SAM fraction from the speed of the gear.

    Parameters
    ----------
    signal : Dataset, DataArray or path-like
        One run: gear speed along time, or a file of it, see `read_signal`.
    map : Dataset
        From `coating_map`, for the same gears at the same torque.
    history : {'auto', 'start', 'unknown'}, optional
        Whether the record begins with the start that the map was made for. ``auto`` supposes so, unless that does
        not explain the signal.

    Returns
    -------
    Assessment

    Raises
    ------
    SceneError
        If the signal or the map is not what is expected, naming what is missing.
    """
    chart = _one_line(require_map(map))
    if history not in _HISTORIES:
        raise SceneError("history", history, f"must be one of {', '.join(_HISTORIES)}")
    data = read_signal(signal) if isinstance(signal, str | os.PathLike) else signal
    batch = signals(data, gear_teeth=_gear_teeth(chart))
    if len(batch.signals) != 1:
        count, dim = len(batch.signals), batch.dims[0]
        raise SceneError("signal", f"({count} runs)", f"must be one run: pick one with .sel({dim}=...)")
    one = batch.signals[0]
    rings = rings_of(one, check_width(float(chart.attrs["width"])))
    frequencies = tuple(ring.frequency for ring in rings)
    numbers = np.array([n for n, ring in enumerate(rings) if math.isfinite(ring.frequency)])
    if not len(numbers):
        why = (
            "no mesh impact rings above the noise"
            if any(math.isfinite(ring.time) for ring in rings)
            else "the gear does not turn through a mesh impact"
        )
        why += ", so the signal says nothing about the coating"
        return Assessment(math.nan, math.nan, math.nan, "no impacts", why, frequencies, "unknown")
    measured = np.array([rings[n].frequency for n in numbers])
    relative = np.array([rings[n].uncertainty for n in numbers]) / measured
    spread = np.hypot(relative, _MODEL)
    fractions, sequences = _sequences(chart)
    # From the likeliest supposition to the loosest: a start of another kind shows in the first impact alone.
    suppositions = [(0, False), (0, True), (1, True)]
    if history != "auto":
        suppositions = [(0, history == "unknown")]
    fits = [
        _fit(fractions, sequences, numbers[skip:], np.log(measured[skip:]), spread[skip:], free=free)
        for skip, free in suppositions
        if not skip or len(numbers) >= _FEWEST_LEFT + skip
    ]
    fit = next((each for each in fits if each.explains), fits[0])
    return _judge(fit, chart, frequencies, measured, float(np.median(one.values)), one.rate, sequences)


def _one_line(chart: xr.Dataset) -> xr.Dataset:
    """Refuse a map of several lines, and bring a single one in order of rising fractions."""
    further = [str(dim) for dim in chart["impact_frequency"].dims if dim not in ("sam_fraction", "impact")]
    if further:
        dim = further[0]
        raise SceneError(
            "map", f"(dimension {dim})", f"has several lines: pick the signal's with .sel({dim}=...)"
        )
    chart = chart.transpose("sam_fraction", "impact", ...).sortby("sam_fraction")
    if int(np.isfinite(chart["characteristic_frequency"].values).sum()) < 2:
        raise SceneError("map", "(dataset)", "needs at least two fractions at which impacts ring")
    return chart


def _gear_teeth(chart: xr.Dataset) -> int:
    try:
        return int(json.loads(chart.attrs["scene"])["gears"]["gear_teeth"])
    except (KeyError, TypeError, ValueError):
        raise SceneError("map", "(dataset)", "its scene does not say how many teeth the gear has") from None


def _sequences(chart: xr.Dataset) -> tuple[Floats, Floats]:
    """Fine grid of fractions, and for each the logarithms of the map's frequencies, impact by impact.

    The sequences are continued by `_BEFORE` and `_BEYOND` impacts, their steps changing by a constant ratio, as those
    of a contact that approaches a settled state do.

    Returns
    -------
    fractions : ndarray, shape (n,)
    sequences : ndarray, shape (n, _BEFORE + impacts + _BEYOND)
        NaN where the map has nothing.
    """
    known, table = chart["sam_fraction"].values, np.log(chart["impact_frequency"].values)
    fractions = np.linspace(known[0], known[-1], _GRID)
    inside = np.full((_GRID, table.shape[1]), np.nan)
    for column, values in enumerate(table.T):
        here = np.isfinite(values)
        if here.sum() >= 2:
            inside[:, column] = PchipInterpolator(known[here], values[here], extrapolate=False)(fractions)
    sequences = np.full((_GRID, _BEFORE + table.shape[1] + _BEYOND), np.nan)
    for row, values in zip(sequences, inside, strict=True):
        count = int(np.isfinite(values).argmin()) if np.isnan(values).any() else len(values)
        if not count:
            continue
        row[_BEFORE : _BEFORE + count] = values[:count]
        steps = np.diff(values[:count])
        ahead = behind = 0.0
        fading = growing = 1.0
        if len(steps):
            ahead, behind = float(steps[-1]), float(steps[0])
        if len(steps) > 1 and steps[0] * steps[1] > 0.0:
            growing = min(2.0, max(1.0, float(steps[0] / steps[1])))
        if len(steps) > 1 and steps[-1] * steps[-2] > 0.0:
            fading = min(1.0, float(steps[-1] / steps[-2]))
        for place in range(_BEFORE + count, min(_BEFORE + count + _BEYOND, len(row))):
            ahead *= fading
            row[place] = row[place - 1] + ahead
        for place in range(_BEFORE - 1, -1, -1):
            behind *= growing
            row[place] = row[place + 1] - behind
    return fractions, sequences


def _fit(
    fractions: Floats, sequences: Floats, numbers: np.ndarray, x: Floats, spread: Floats, *, free: bool
) -> _Fit:
    """Chi-square of every fraction: impact n against the map's n, or against its n + n0 with the best n0."""
    weight = 1.0 / spread**2
    if not free:
        past_end = numbers + _BEFORE >= sequences.shape[1]
        numbers, x, weight = numbers[~past_end], x[~past_end], weight[~past_end]
        model = sequences[:, _BEFORE + numbers]
        return _Fit(fractions, _chi_square(x - model, weight), max(1, len(numbers)), "start")
    steps = numbers - numbers[0]
    furthest = sequences.shape[1] - 1 - int(steps[-1])
    if furthest < 0:  # a long record: its first impacts are the ones that tell
        kept = steps < sequences.shape[1]
        return _fit(fractions, sequences, numbers[kept], x[kept], spread[kept], free=True)
    places = np.arange(furthest * _STEPS + 1) / _STEPS
    at = places[:, None] + steps[None, :]
    whole = np.minimum(at.astype(np.int64), sequences.shape[1] - 2)
    part = at - whole
    left, right = sequences[:, whole], sequences[:, whole + 1]
    model = np.where(part > 0.0, left + part * (right - left), left)
    each = _chi_square(x - model, weight)
    return _Fit(fractions, each.min(axis=1), len(numbers), "unknown")


def _chi_square(deviation: Floats, weight: Floats) -> Floats:
    """Sum over the impacts (last axis), the best common error taken out; infinite where the map holds nothing."""
    alone = np.sum(weight * deviation**2, axis=-1)
    shared = np.sum(weight * deviation, axis=-1) ** 2 / (1.0 / _COMMON**2 + weight.sum())
    return np.asarray(np.where(np.isnan(alone), np.inf, alone - shared))


def _judge(
    fit: _Fit,
    chart: xr.Dataset,
    frequencies: tuple[float, ...],
    measured: Floats,
    speed: float,
    rate: float,
    sequences: Floats,
) -> Assessment:
    """Turn chi-square into a fraction, an interval and words."""
    best, fractions = fit.best, fit.fractions
    needed = float(np.nanmax(chart["characteristic_frequency"].values)) / HIGHEST
    too_slow = (
        f"; sampled at {rate:.3g} Hz, below the map's {needed:.3g} Hz, it may not show what rings faster"
        if rate < needed
        else ""
    )
    if not fit.explains:
        return _misfit(fit, frequencies, measured, sequences, too_slow)
    possible = fractions[fit.chi2 <= fit.chi2[best] + _WITHIN]
    low, high = float(possible[0]), float(possible[-1])
    # the grid is finite: an interval is never narrower than its spacing
    spacing = float(fractions[1] - fractions[0])
    low, high = max(float(fractions[0]), low - spacing), min(float(fractions[-1]), high + spacing)
    fraction = float(fractions[best])
    known = chart["median_gear_speed"].dropna("sam_fraction")
    expected = float(np.interp(fraction, known["sam_fraction"].values, known.values))
    if abs(speed - expected) > _SPEEDS * expected:
        why = (
            f"the gear turns at {speed:.3g} rad/s where the map has {expected:.3g} rad/s: another torque or load, "
            "which shifts the frequencies"
        )
        return Assessment(math.nan, math.nan, math.nan, "does not fit", why, frequencies, fit.history)
    split = np.diff(possible).max(initial=0.0) > _GAP
    heard = ", ".join(f"{value:.4g}" for value in measured[:5]) + (" ..." if len(measured) > 5 else "")
    if split or high - low > _PLAIN:
        why = (
            f"impacts ring at {heard} Hz, which SAM fractions from {low:.3f} to {high:.3f} explain alike; a record "
            "with more impacts, or from the start, can tell"
        )
        return Assessment(math.nan, low, high, "ambiguous", why, frequencies, fit.history)
    since = "counted from the start" if fit.history == "start" else "the start not being in the record"
    why = f"SAM fraction {fraction:.3f} (95 %: {low:.3f} to {high:.3f}); impacts ring at {heard} Hz, {since}{too_slow}"
    if low == fractions[0] > 0.0:
        why += "; the map ends there, and less could be left"
    return Assessment(fraction, low, high, "clear", why, frequencies, fit.history)


def _misfit(
    fit: _Fit, frequencies: tuple[float, ...], measured: Floats, sequences: Floats, too_slow: str
) -> Assessment:
    """Say why no fraction explains a signal."""
    first = np.exp(sequences[:, _BEFORE])
    lowest, highest = float(np.nanmin(first)), float(np.nanmax(np.exp(sequences)))
    heard = ", ".join(f"{value:.4g}" for value in measured[:5])
    verdict = "outside the map"
    if np.all(measured < lowest * (1.0 - 3.0 * _COMMON)):
        why = f"impacts ring at {heard} Hz, lower than anything in the map (from {lowest:.4g} Hz)"
    elif measured[0] > float(np.nanmax(first)) and fit.best == 0:
        why = (
            f"impacts ring at {heard} Hz, higher than the map's most worn coating, {fit.fractions[0]:.3g}, does "
            f"(up to {highest:.4g} Hz): less is left, or the gears have run longer"
        )
    else:
        verdict = "does not fit"
        why = f"impacts ring at {heard} Hz, a sequence that no SAM fraction of the map explains"
    return Assessment(math.nan, math.nan, math.nan, verdict, why + too_slow, frequencies, fit.history)
