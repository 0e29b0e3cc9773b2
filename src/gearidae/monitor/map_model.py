"""What a coating map predicts: the sequence of impact frequencies for every fraction, and the speed of the gear."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np
import scipy
import xarray as xr

from gearidae.analysis.impacts import check_width
from gearidae.arrays import Floats
from gearidae.errors import SceneError

BEFORE, AFTER = 1, 6
"""Impacts by which the map's sequences are continued at both ends."""
_MOST_ALIKE = 0.95
"""Correlation of two impacts at most, where one covariance stands for all."""
_GRID = 1001
_INTERPOLATION = 0.4
SEEDS = "seeds"
"""Attribute of a map made over seeds: of how many gears each point is."""
GEARS = "gear_frequency"
"""Variable of such a map: frequencies of each gear."""
FEWEST_GEARS = 5
_TORQUE = "torque"
"""The one dimension beside the fraction that an assessment can estimate: that of ``drive.torque``."""
_VARIABLES = (
    "characteristic_frequency",
    "uncertainty",
    "impact_frequency",
    "impact_uncertainty",
    "median_gear_speed",
    "min_gear_speed",
)


@dataclass(frozen=True, slots=True)
class Scatter:
    """How far the frequencies of one gear are from those of a map over seeds.

    Attributes
    ----------
    covariance : ndarray, shape (..., n, impacts, impacts)
        Of the logarithms of the frequencies of the impacts of one gear.
    gears : int
        Of which the map is made.
    """

    covariance: Floats
    gears: int

    def of(self, impacts: np.ndarray) -> Floats:
        """Covariance of some impacts, shape (..., n, k, k); beyond those of the map they are like the last two."""
        last = self.covariance.shape[-1] - 1
        at = np.minimum(impacts, last)
        picked = self.covariance[..., at[:, None], at[None, :]]
        twice = (at[:, None] == at[None, :]) & ~np.eye(len(at), dtype=bool)
        alike = self.covariance[..., max(last - 1, 0), last] if last else 0.0 * self.covariance[..., 0, 0]
        return np.asarray(np.where(twice, alike[..., None, None], picked))

    def deviation(self) -> Floats:
        """Largest standard deviation of the logarithm of a frequency at each fraction, shape (..., n)."""
        variances = np.diagonal(self.covariance, axis1=-2, axis2=-1)
        return np.asarray(np.sqrt(variances.max(axis=-1)))


@dataclass(frozen=True, slots=True)
class MapModel:
    """A coating map on a fine grid of fractions.

    Attributes
    ----------
    fractions : ndarray, shape (n,)
        Rising [1].
    known : ndarray, shape (k,)
        Those of the map at which impacts ring, on all of its lines [1].
    torques : ndarray, shape (m,), or None
        Drive torques of the map's lines, rising [N m]; None for a map at one torque.
    sequences : ndarray, shape (m or 1, n, BEFORE + impacts + AFTER)
        Logarithm of the frequency [ln Hz] after each impact; NaN where the map has nothing.
    spread : ndarray, shape (m or 1, n)
        Relative uncertainty of the frequencies from interpolating between the fractions of the map.
    speeds : ndarray, shape (m or 1, n)
        Median speed of the gear [rad/s]; NaN where it sticks.
    slowest : float
        Smallest speed of the gear in any run of the map [rad/s].
    highest_first, highest : float
        Highest frequency after the first impact, and after any [Hz].
    first_impact : float
        Angle from the start to the first impact [rad], roughly: time times median speed; NaN if the map lacks times.
    width : float
        Of the impact windows, in pitches.
    scatter : Scatter, or None
        Of a map over seeds, its covariance of shape (m or 1, n, impacts, impacts).
    one_draw : bool
        Whether the teeth of the map's gears have drawn errors, and the map is that of one drawing.
    """

    fractions: Floats
    known: Floats
    torques: Floats | None
    sequences: Floats
    spread: Floats
    speeds: Floats
    slowest: float
    highest_first: float
    highest: float
    first_impact: float
    width: float
    gear_teeth: int
    scatter: Scatter | None = None
    one_draw: bool = False

    def scatter_at(self, torque: float) -> Scatter | None:
        """Scatter between the gears at one torque, that of the nearest line."""
        if self.scatter is None:
            return None
        line = 0 if self.torques is None else int(np.abs(np.log(self.torques / torque)).argmin())
        return Scatter(self.scatter.covariance[line], self.scatter.gears)

    def at_torque(self, torque: float) -> tuple[Floats, Floats, Floats]:
        """Sequences, their uncertainty and speeds at one torque, interpolated in its logarithm.

        Parameters
        ----------
        torque : float
            Drive torque [N m]; without effect on a map at one torque.

        Returns
        -------
        sequences : ndarray, shape (n, k)
        spread, speeds : ndarray, shape (n,)
        """
        if self.torques is None:
            return self.sequences[0], self.spread[0], self.speeds[0]
        index = int(np.clip(np.searchsorted(self.torques, torque) - 1, 0, len(self.torques) - 2))
        low, high = np.log(self.torques[index : index + 2])
        part = (math.log(torque) - low) / (high - low)
        lower, upper = self.sequences[index], self.sequences[index + 1]
        speeds = self.speeds[index] ** (1.0 - part) * self.speeds[index + 1] ** part
        spread = (1.0 - part) * self.spread[index] + part * self.spread[index + 1]
        return lower + part * (upper - lower), spread, speeds

    def torque_at(self, speed: float) -> float:
        """Drive torque [N m] at which the gear turns at a speed [rad/s]; continued beyond the map's ends.

        The median over the fractions: how fast the gear turns depends on the coating by a per cent.
        """
        if self.torques is None:
            raise ValueError("the map holds one torque")
        known, at = np.log(np.nanmedian(self.speeds, axis=1)), np.log(self.torques)
        index = int(np.clip(np.searchsorted(known, math.log(speed)) - 1, 0, len(known) - 2))
        slope = (at[index + 1] - at[index]) / (known[index + 1] - known[index])
        return float(math.exp(at[index] + slope * (math.log(speed) - known[index])))


def require_map(chart: object) -> xr.Dataset:
    """Make sure that a dataset is a coating map.

    Returns
    -------
    Dataset
        The same.

    Raises
    ------
    SceneError
        If it is not, naming what is missing.
    """
    if not isinstance(chart, xr.Dataset):
        raise SceneError("map", type(chart).__name__, "must be a Dataset from coating_map")
    missing = [name for name in _VARIABLES if name not in chart]
    missing += [name for name in ("sam_fraction", "impact") if name not in chart.dims]
    missing += [name for name in ("scene", "width") if name not in chart.attrs]
    if missing:
        lacking = ", ".join(missing)
        raise SceneError(
            "map", "(dataset)", f"is no coating map: it lacks {lacking}; make one with coating_map"
        )
    for name in (*_VARIABLES, "sam_fraction"):
        _check_numbers(chart, name)
    return chart


def _check_numbers(chart: xr.Dataset, name: str) -> None:
    """Refuse a variable of a map that is not numbers along the fractions, or along the impacts if it is of these."""
    if name not in chart.variables or chart[name].dtype.kind not in "fiu":
        raise SceneError("map", "(dataset)", f"its {name} must be numbers")
    wanted = {"sam_fraction", "impact"} if name.startswith("impact_") else {"sam_fraction"}
    lacking = wanted - set(chart[name].dims)
    if lacking:
        raise SceneError(
            "map", "(dataset)", f"its {name} must have the dimension {' and '.join(sorted(lacking))}"
        )
    if name == "sam_fraction" and not np.isfinite(chart[name].values).all():
        raise SceneError("map", "(dataset)", "its fractions must be finite numbers")
    if name == "impact_frequency" and (chart[name].values <= 0.0).any():
        raise SceneError("map", "(dataset)", "its frequencies must be above zero")


def map_model(chart: object) -> MapModel:
    """Put a coating map on a fine grid.

    Parameters
    ----------
    chart : Dataset
        From `coating_map`: over the fraction, or over the fraction and ``drive.torque``.

    Raises
    ------
    SceneError
        If it is no coating map, has lines over another key, or too few points.
    """
    data = require_map(chart)
    torques = _torques(data)
    if torques is None:
        data = data.expand_dims(_TORQUE)
    data = data.sortby([_TORQUE, "sam_fraction"] if torques is not None else "sam_fraction")
    frequency = data["impact_frequency"].transpose(_TORQUE, "sam_fraction", "impact").values
    if (np.isfinite(frequency[:, :, 0]).sum(axis=1) < 2).any():
        raise SceneError("map", "(dataset)", "needs at least two fractions at which impacts ring")
    known = data["sam_fraction"].values
    if (np.diff(known) <= 0.0).any():
        raise SceneError("map", "(dataset)", "holds a fraction twice")
    fractions = np.linspace(known[0], known[-1], _GRID)
    speeds = data["median_gear_speed"].transpose(_TORQUE, "sam_fraction").values
    speeds = np.where(speeds > 0.0, speeds, np.nan)  # a gear that sticks has no speed to compare with
    if (np.isfinite(speeds).sum(axis=1) < 2).any():
        raise SceneError("map", "(dataset)", "needs at least two fractions at which the gear turns")
    return MapModel(
        fractions=fractions,
        known=known[np.isfinite(frequency[:, :, 0]).all(axis=0)],
        torques=torques,
        sequences=np.stack([_sequences(fractions, known, table) for table in frequency]),
        spread=np.stack([_spread(fractions, known, table) for table in frequency]),
        speeds=np.stack([_interpolated(fractions, known, row) for row in speeds]),
        slowest=float(np.nanmin(data["min_gear_speed"].values)),
        highest_first=float(np.nanmax(frequency[:, :, 0])),
        highest=float(np.nanmax(frequency)),
        first_impact=_first_impact(data),
        width=_width(data),
        gear_teeth=_gear_teeth(data),
        scatter=_scatter(data, fractions),
        one_draw=SEEDS not in data.attrs and _draws_teeth(data),
    )


def _scatter(chart: xr.Dataset, fractions: Floats) -> Scatter | None:
    """Scatter of a map over seeds on the grid; None of another map."""
    if SEEDS not in chart.attrs:
        return None
    gears, known = int(chart.attrs[SEEDS]), chart["sam_fraction"].values
    tables = np.log(chart[GEARS].transpose(_TORQUE, "sam_fraction", "gear", "impact").values)
    lines = []
    for line in tables:
        points = np.stack([_covariance(table) for table in line])
        rows = [np.interp(fractions, known, row) for row in points.reshape(len(known), -1).T]
        lines.append(np.stack(rows, axis=1).reshape(len(fractions), *points.shape[1:]))
    return Scatter(np.stack(lines), gears)


def _covariance(table: Floats) -> Floats:
    """Covariance of the logarithms of one further gear's frequencies, shape (impacts, impacts).

    Parameters
    ----------
    table : ndarray, shape (gears, impacts)
        Logarithms; NaN where a gear does not ring.

    Returns
    -------
    ndarray
        That of the gears, drawn towards one with the same variances and one covariance of all impacts, the more so the
        fewer gears there are: the smallest eigenvalues of few gears are too small (Ledoit and Wolf 2004,
        doi:10.1016/S0047-259X(03)00096-4). It is wider by what mean and variance of few gears are uncertain (the
        variance of Student's distribution). Impacts that not all gears have are like the last that they have.
    """
    gears, impacts = table.shape
    whole = table[:, : int(np.append(np.isfinite(table).all(axis=0), False).argmin())]
    count = whole.shape[1]
    if not count:
        return np.zeros((impacts, impacts))
    sample = np.atleast_2d(np.cov(whole, rowvar=False))
    same = np.diag(np.diag(sample))
    if count > 1:
        apart = ~np.eye(count, dtype=bool)
        same[apart] = max(float(sample[apart].mean()), 0.0)
        # by rounding and by chance more than variances allow: no impacts are the same
        limit = _MOST_ALIKE * np.sqrt(np.outer(np.diag(sample), np.diag(sample)))
        same[apart] = np.minimum(same, limit)[apart]
    weight = min(1.0, (count + 1) / gears)
    estimate = (1.0 - weight) * sample + weight * same
    estimate *= (1.0 + 1.0 / gears) * (gears - 1.0) / (gears - 3.0)
    return Scatter(estimate, gears).of(np.arange(impacts))


def _draws_teeth(chart: xr.Dataset) -> bool:
    """Whether the scene of a map draws errors of teeth."""
    try:
        return bool(json.loads(chart.attrs["scene"])["mesh"].get("pitch_error_rms", 0.0) > 0.0)
    except (AttributeError, KeyError, TypeError, ValueError):
        return False


def _torques(chart: xr.Dataset) -> Floats | None:
    """Torques of the lines of a map, rising; None where it has one line."""
    further = [str(dim) for dim in chart["impact_frequency"].dims if dim not in ("sam_fraction", "impact")]
    if not further:
        return None
    for dim in further:
        described = str(chart[dim].attrs.get("long_name", "")) if dim in chart.coords else ""
        if dim != _TORQUE or not described.startswith("drive.torque"):
            raise SceneError(
                "map",
                f"(dimension {dim})",
                f"has several lines: pick the signal's with .sel({dim}=...), or --line {dim}=...; "
                "only drive.torque is estimated",
            )
    torques = np.sort(chart[_TORQUE].values.astype(np.float64))
    if len(torques) < 2 or torques[0] <= 0.0 or (np.diff(torques) <= 0.0).any():
        raise SceneError(
            "map",
            f"(torque {', '.join(f'{value:g}' for value in torques)})",
            "must hold two different torques above zero, or more",
        )
    return np.asarray(torques, dtype=np.float64)


def _first_impact(chart: xr.Dataset) -> float:
    """Angle from the start to the first impact [rad]; older maps do not tell."""
    if "impact_time" not in chart or chart["impact_time"].dtype.kind != "f":
        return math.nan
    angles = (chart["impact_time"].isel(impact=0) * chart["median_gear_speed"]).values
    return float(np.nanmedian(angles)) if np.isfinite(angles).any() else math.nan


def _width(chart: xr.Dataset) -> float:
    try:
        return check_width(float(chart.attrs["width"]))
    except (TypeError, ValueError):
        raise SceneError(
            "map", "(dataset)", "its attribute width must be a number (the windows, in pitches)"
        ) from None


def _gear_teeth(chart: xr.Dataset) -> int:
    try:
        return int(json.loads(chart.attrs["scene"])["gears"]["gear_teeth"])
    except (KeyError, TypeError, ValueError):
        raise SceneError("map", "(dataset)", "its scene does not say how many teeth the gear has") from None


def _interpolated(fractions: Floats, known: Floats, values: Floats) -> Floats:
    """Values between those of the map; NaN where they are unknown on one side."""
    here = np.isfinite(values)
    if here.sum() < 2:
        return np.full(len(fractions), np.nan)
    return np.asarray(
        scipy.interpolate.PchipInterpolator(known[here], values[here], extrapolate=False)(fractions)
    )


def _spread(fractions: Floats, known: Floats, table: Floats) -> Floats:
    """Uncertainty of interpolated logarithms: a part of how far a curve and straight lines through the points differ.

    That part is 0.4: maps with steps of 0.1 and 0.05 err by that much against one with steps of 0.01.
    """
    apart = np.zeros(len(fractions))
    for column in np.log(table).T:
        here = np.isfinite(column)
        if here.sum() >= 2:
            curve = _interpolated(fractions, known, column)
            lines = np.interp(fractions, known[here], column[here])
            apart = np.fmax(apart, np.abs(curve - lines))
    return _INTERPOLATION * apart


def _sequences(fractions: Floats, known: Floats, table: Floats) -> Floats:
    """Logarithm of the frequencies on the grid, each sequence continued at both ends.

    Parameters
    ----------
    fractions : ndarray, shape (n,)
    known : ndarray, shape (m,)
        Fractions of the map.
    table : ndarray, shape (m, impacts)
        Its frequencies [Hz].

    Returns
    -------
    ndarray, shape (n, BEFORE + impacts + AFTER)
    """
    impacts = table.shape[1]
    inside = np.stack([_interpolated(fractions, known, np.log(column)) for column in table.T], axis=1)
    sequences = np.full((len(fractions), BEFORE + impacts + AFTER), np.nan)
    for row, values in zip(sequences, inside, strict=True):
        count = int(np.isfinite(values).argmin()) if np.isnan(values).any() else impacts
        if count:
            _continue(row, values[:count])
    return sequences


def _continue(row: Floats, values: Floats) -> None:
    """Fill a row with a sequence and its continuation, whose steps change by a constant ratio.

    So do those of a contact that approaches a settled state.
    """
    count = len(values)
    row[BEFORE : BEFORE + count] = values
    steps = np.diff(values)
    ahead = behind = 0.0
    fading = growing = 1.0
    if len(steps):
        ahead, behind = float(steps[-1]), float(steps[0])
    if len(steps) > 1 and steps[0] * steps[1] > 0.0:
        growing = min(2.0, max(1.0, float(steps[0] / steps[1])))
    if len(steps) > 1 and steps[-1] * steps[-2] > 0.0:
        fading = min(1.0, float(steps[-1] / steps[-2]))
    for index in range(BEFORE + count, min(BEFORE + count + AFTER, len(row))):
        ahead *= fading
        row[index] = row[index - 1] + ahead
    for index in range(BEFORE - 1, -1, -1):
        behind *= growing
        row[index] = row[index + 1] - behind
