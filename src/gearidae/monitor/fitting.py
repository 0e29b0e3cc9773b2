r"""How well each SAM fraction explains the frequencies after the impacts of a record.

With :math:`x = \ln f`, a fraction :math:`\varphi` explains a record as well as

.. math::

    \chi^2(\varphi) = \min_{c, u, \tau} \left[ \frac{c^2}{s^2}
                      + \frac{(\ln\omega - \ln\Omega_\varphi(\tau))^2}{s_\omega^2}
                      + \sum_n \frac{\left(x_n - X_\varphi(n + n_0; \tau) - c - u\right)^2}{s_n^2} \right]

is small. :math:`X_\varphi` interpolates the map, :math:`s_n` joins the measurement's uncertainty with that of the map,
and c is an error that all impacts share. If the record begins with the map's start, :math:`n_0 = 0`. Otherwise
:math:`n_0` is free: a worn contact is pressed deeper by each impact, from wherever it began, and it is the step from
one impact to the next that determines the fraction.

The torque :math:`\tau` is not known. The gear's speed :math:`\omega` determines it, since the low-speed steady state is
:math:`M_{10} = (R_1/R_2)\,\alpha\,\omega^2`: a map over torque is searched along :math:`\tau`, with :math:`u = 0`. A
map at one torque has no :math:`\tau`; there u may lie anywhere between 0 and
:math:`\tfrac12\ln(\tau/\tau_{\mathrm{map}}) = \ln(\omega/\Omega_\varphi)`, because the frequency goes with the torque
to a power between 0 (a worn contact, whose stiffness is that of its joined asperities) and 1/2 (a whole coating, whose
stiffness goes with its load).

Of a map over seeds, s and :math:`s_n` hold the scatter between the gears too, which depends on the fraction. Then
:math:`\ln\det C` of the covariances joins :math:`\chi^2`, above its smallest value of all fractions: else the fraction
that predicts least would explain most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearidae.analysis.signal import CALIBRATION
from gearidae.arrays import Floats
from gearidae.monitor.map_model import BEFORE, MapModel, Scatter

COMMON = 0.012
"""Relative uncertainty that all impacts share: windows a little early or late, and a speed off by half a per cent. It
grows with that of the speed."""
_MODEL = 0.005
"""Relative uncertainty of each of the map's frequencies, from interpolation."""
_LATE = 0.4
"""Relative uncertainty per impact since the first, in parts of that of the speed: if it is off, each window lies later
than the one before."""
_SURE = 1e-3
"""Relative uncertainty of the speed at least."""
_UNEVEN = 0.3
"""Uncertainty of one impact's shift by another torque, in parts of the shift in the speed."""
WITHIN = 3.84
"""Rise of chi-square within the 95 % interval (one parameter)."""
_FITS = 9.0
"""Largest chi-square for each impact of a record that the map explains: three standard uncertainties."""
SPEED_RANGE = 0.15
"""Largest relative difference between the record's speed and that of a map at one torque."""
_LESS_LIKELY = 4.0
"""What an unknown history adds to chi-square: seven to one that a record whose first impact comes when the map's does
begins with its start; above the rise within the interval, so that a start without misfit is not put in doubt."""
_FEWEST_LEFT = 3
"""Impacts needed beside one that is left out."""
_STEPS = 20
"""Shares of an impact tried between two impacts."""
_TORQUES = np.linspace(-2.5, 2.5, 11)
"""Torques tried around the likeliest, in standard uncertainties of the speed."""


@dataclass(frozen=True, slots=True)
class RingSet:
    """What of a record is compared with a map.

    Attributes
    ----------
    numbers : ndarray of int, shape (n,)
        Which impacts ring.
    frequency, uncertainty : ndarray, shape (n,)
        Their frequency and its standard uncertainty [Hz].
    speed : float
        Median speed of the gear [rad/s].
    unsteady : float
        By how much its mean speed changes from the first half of the record to the second, in parts of itself.
    calibration : float
        Relative uncertainty of the speed: the sensor's.
    """

    numbers: np.ndarray
    frequency: Floats
    uncertainty: Floats
    speed: float
    unsteady: float
    calibration: float = CALIBRATION

    @property
    def common(self) -> float:
        """Relative uncertainty of the frequencies that all impacts share."""
        return COMMON * max(1.0, self.calibration / CALIBRATION)

    def without_first(self) -> RingSet:
        """Rings of all impacts but the first that rings."""
        later = {name: getattr(self, name)[1:] for name in ("numbers", "frequency", "uncertainty")}
        return replace(self, **later)


@dataclass(frozen=True, slots=True)
class Fit:
    """Chi-square over the fractions of the grid.

    Attributes
    ----------
    fractions, chi2 : ndarray, shape (n,)
    impacts : int
        Compared.
    history : str
        ``start`` or ``unknown``.
    torques : ndarray, shape (n,)
        Likeliest torque for each fraction [N m]; NaN for a map at one torque.
    """

    fractions: Floats
    chi2: Floats
    impacts: int
    history: str
    torques: Floats

    @property
    def best(self) -> int:
        """Index of the likeliest fraction."""
        return int(self.chi2.argmin())

    @property
    def explains(self) -> bool:
        """Whether the likeliest fraction explains the record."""
        return bool(self.chi2[self.best] <= _FITS * self.impacts)

    @property
    def possible(self) -> Floats:
        """Fractions of the 95 % interval."""
        return np.asarray(self.fractions[self.chi2 <= self.chi2[self.best] + WITHIN])


def first_explanation(model: MapModel, rings: RingSet, history: str, *, may_be_start: bool = True) -> Fit:
    """Fit of the likeliest supposition about the record's history that explains it.

    Parameters
    ----------
    history : {'auto', 'start', 'unknown'}
    may_be_start : bool, optional
        Whether ``auto`` considers that the record begins with the map's start.

    Returns
    -------
    Fit
        If none explains the record, that of the likeliest supposition.
    """
    if history != "auto":
        return _fit(model, rings, free=history == "unknown")
    fit = _fit(model, rings, free=True)
    if may_be_start:
        fit = _either(_fit(model, rings, free=False), fit)
    if fit.explains or len(rings.numbers) <= _FEWEST_LEFT:
        return fit
    # a start of another kind shows in the first impact alone
    without = _fit(model, rings.without_first(), free=True)
    return without if without.explains else fit


def _either(start: Fit, unknown: Fit) -> Fit:
    """Fit with the history that explains a fraction better; the start has the larger prior probability."""
    later = unknown.chi2 + _LESS_LIKELY < start.chi2
    best = int(np.where(later, unknown.chi2 + _LESS_LIKELY, start.chi2).argmin())
    return Fit(
        start.fractions,
        np.where(later, unknown.chi2 + _LESS_LIKELY, start.chi2),
        start.impacts,
        unknown.history if later[best] else start.history,
        np.where(later, unknown.torques, start.torques),
    )


def _fit(model: MapModel, rings: RingSet, *, free: bool) -> Fit:
    """Fit over all torques that the speed allows."""
    if model.torques is None:
        return _fit_at_known_torque(model, rings, free=free)
    spread = math.hypot(max(rings.calibration, _SURE), rings.unsteady)
    likeliest = model.torque_at(rings.speed)
    best = Fit(
        model.fractions, np.full(len(model.fractions), np.inf), 1, "", np.full(len(model.fractions), np.nan)
    )
    for deviation in _TORQUES:
        # the speed goes with the square root of the torque
        torque = likeliest * math.exp(2.0 * spread * deviation)
        torque = float(np.clip(torque, model.torques[0], model.torques[-1]))
        sequences, uncertainty, speeds = model.at_torque(torque)
        chi2, impacts = _chi_square_of(
            sequences, rings, np.zeros_like(speeds), uncertainty, model.scatter_at(torque), free=free
        )
        chi2 = chi2 + (np.log(rings.speed / speeds) / spread) ** 2
        better = chi2 < best.chi2
        best = Fit(
            model.fractions,
            np.where(better, chi2, best.chi2),
            impacts,
            "unknown" if free else "start",
            np.where(better, torque, best.torques),
        )
    return best


def _fit_at_known_torque(model: MapModel, rings: RingSet, *, free: bool) -> Fit:
    """Fit to a map at one torque, whose shift by another torque is bounded by the speed."""
    sequences, speeds = model.sequences[0], model.speeds[0]
    shift = np.nan_to_num(np.log(rings.speed / speeds))
    # far from the map's speed nothing is to be explained by a shift: it is another machine
    shift = np.where(np.abs(shift) <= math.log1p(SPEED_RANGE), shift, 0.0)
    drifting = math.copysign(rings.unsteady, float(np.median(shift)) or 1.0)
    uneven = _UNEVEN * abs(float(np.median(shift)) + drifting)
    uncertainty = np.hypot(model.spread[0], math.hypot(uneven, rings.unsteady))
    scatter = model.scatter_at(math.nan)
    chi2, impacts = _chi_square_of(sequences, rings, shift, uncertainty, scatter, free=free)
    history = "unknown" if free else "start"
    return Fit(model.fractions, chi2, impacts, history, np.full(len(chi2), np.nan))


def _chi_square_of(
    sequences: Floats,
    rings: RingSet,
    shift: Floats,
    uncertainty: Floats,
    scatter: Scatter | None,
    *,
    free: bool,
) -> tuple[Floats, int]:
    """Chi-square of every fraction, and the number of impacts compared.

    Impact n is compared with the map's n, or with its n + n0 with the best n0. `uncertainty` is the relative one of
    what each fraction predicts for one impact, beside `_MODEL` and the scatter between gears.
    """
    numbers, x = rings.numbers, np.log(rings.frequency)
    variance = (rings.uncertainty / rings.frequency) ** 2 + _MODEL**2 + uncertainty[:, None] ** 2
    variance = variance + (_LATE * rings.calibration * (numbers - numbers[0])) ** 2
    if not free:
        kept = numbers + BEFORE < sequences.shape[1]
        deviation, variance = x[kept] - sequences[:, BEFORE + numbers[kept]], variance[:, kept]
        if scatter is None:
            return _chi_square(deviation, 1.0 / variance, shift, rings.common), max(1, int(kept.sum()))
        covariance = _covariance(scatter.of(numbers[kept]), variance, rings.common)
        return _chi_square_of_gears(deviation[:, None], covariance, shift)[:, 0], max(1, int(kept.sum()))
    steps = numbers - numbers[0]
    kept = steps < sequences.shape[1]  # of a long record the first impacts are the ones that tell
    steps, x, variance = steps[kept], x[kept], variance[:, kept]
    furthest = sequences.shape[1] - 1 - int(steps[-1])
    deviation = x - sequences_from(sequences, np.arange(furthest * _STEPS + 1) / _STEPS, steps)
    if scatter is None:
        chi2 = _chi_square(deviation, 1.0 / variance[:, None, :], shift[:, None], rings.common)
    else:
        covariance = _covariance(scatter.of(steps), variance, rings.common)
        chi2 = _chi_square_of_gears(deviation, covariance, shift)
    return np.asarray(chi2.min(axis=1)), len(steps)


def _covariance(scatter: Floats, variance: Floats, common: float) -> Floats:
    """Covariance of what each fraction predicts, shape (n, m, m)."""
    return scatter + common**2 + np.eye(variance.shape[1]) * variance[:, None, :]


def _chi_square_of_gears(deviation: Floats, covariance: Floats, shift: Floats) -> Floats:
    """Chi-square of correlated deviations, the best shift taken out, and how vague each fraction's prediction is.

    Parameters
    ----------
    deviation : ndarray, shape (n, p, m)
    covariance : ndarray, shape (n, m, m)
    shift : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n, p)
        With the logarithm of the determinant of the covariance, above the smallest of all fractions; infinite where the
        map holds nothing.
    """
    if not deviation.shape[-1]:
        return np.zeros(deviation.shape[:-1])
    vagueness = np.linalg.slogdet(covariance)[1]
    inverse = np.linalg.inv(covariance)
    weighted = deviation @ inverse
    squared, mean = (weighted * deviation).sum(axis=-1), weighted.sum(axis=-1)
    total = inverse.sum(axis=(-2, -1))[:, None]
    ends = np.minimum(shift, 0.0)[:, None], np.maximum(shift, 0.0)[:, None]
    taken = np.clip(mean / total, *ends)
    chi2 = squared - 2.0 * taken * mean + taken**2 * total + (vagueness - vagueness.min())[:, None]
    return np.asarray(np.where(np.isnan(chi2), np.inf, chi2))


def sequences_from(sequences: Floats, starts: Floats, steps: np.ndarray) -> Floats:
    """Sequences that begin between the impacts, interpolated between the impacts.

    Parameters
    ----------
    sequences : ndarray, shape (n, k)
    starts : ndarray, shape (p,)
        Where the record begins, in impacts.
    steps : ndarray of int, shape (m,)
        Impacts of the record, counted from its first.

    Returns
    -------
    ndarray, shape (n, p, m)
    """
    at = starts[:, None] + steps[None, :]
    whole = np.minimum(at.astype(np.int64), sequences.shape[1] - 2)
    part = at - whole
    left, right = sequences[:, whole], sequences[:, whole + 1]
    return np.asarray(np.where(part > 0.0, left + part * (right - left), left))


def _chi_square(deviation: Floats, weight: Floats, shift: Floats, common: float) -> Floats:
    """Sum over the impacts (last axis), the best shift and the best common error taken out.

    Infinite where the map holds nothing.
    """
    if not deviation.shape[-1]:
        return np.zeros(deviation.shape[:-1])
    total = weight.sum(axis=-1)
    mean = np.sum(weight * deviation, axis=-1) / total
    mean_left = mean - np.clip(mean, np.minimum(shift, 0.0), np.maximum(shift, 0.0))
    about_mean = np.sum(weight * (deviation - mean[..., None]) ** 2, axis=-1)
    chi2 = about_mean + mean_left**2 / (1.0 / total + common**2)
    return np.asarray(np.where(np.isnan(chi2), np.inf, chi2))
