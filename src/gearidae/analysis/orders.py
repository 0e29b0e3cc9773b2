r"""Spectra over turns of a shaft instead of over time: run-ups and braked runs have sharp lines there.

What repeats :math:`k` times a turn has the order :math:`k` at every speed; an error of one tooth has orders of whole
numbers, the mesh that of the number of teeth. Integrated over the orders, the density gives the variance over angle.
"""

from __future__ import annotations

import math

import numpy as np
import scipy
import xarray as xr

from gearidae.analysis.signal import FEWEST_SAMPLES
from gearidae.arrays import Floats
from gearidae.errors import SceneError

_ANGLES = ("gear_angle", "pinion_angle")


def resample(ds: xr.Dataset, over: str = "gear_angle", *, step: float | None = None) -> xr.Dataset:
    """Take the samples of a run in equal steps of an angle.

    Parameters
    ----------
    ds : Dataset
        A single run with samples of the angle.
    over : str, optional
        ``"gear_angle"`` or ``"pinion_angle"``.
    step : float, optional
        Step of the angle [rad]; by default the mean between two samples.

    Returns
    -------
    Dataset, dims (the angle)
        Each variable of ``time``, and ``time`` [s] itself, as its mean over a step of the angle, so that oscillations
        faster than the step do not appear as slow ones. The coordinate [rad] is the middle of each step, counted in the
        direction of the run. Where the shaft turns back, the samples until it goes on are left out: ``left_out`` [1]
        is their share.

    Raises
    ------
    SceneError
        If there is no such angle, the dataset has several runs, the shaft gets nowhere, or the step is not allowed.
    """
    if over not in _ANGLES:
        raise SceneError("over", over, f"must be one of {', '.join(_ANGLES)}")
    if over not in ds:
        raise SceneError("over", over, "is not in the dataset")
    if ds[over].dims != ("time",):
        raise SceneError("over", f"({', '.join(map(str, ds[over].dims))})", "one run has samples along time")
    reached = np.isfinite(ds[over].values)
    run = ds.isel(time=reached)
    angle = run[over].values
    if angle.size < FEWEST_SAMPLES:
        raise SceneError("over", f"({angle.size} samples)", f"needs at least {FEWEST_SAMPLES}")
    way = math.copysign(1.0, angle[-1] - angle[0])
    farthest = np.maximum.accumulate(way * angle)
    onward = np.concatenate([[True], np.diff(farthest) > 0.0])
    path = farthest[onward]
    length = float(path[-1] - path[0])
    if path.size < FEWEST_SAMPLES:
        raise SceneError("over", over, "the shaft does not turn in this run")
    step = length / (len(angle) - 1) if step is None else float(step)
    if not 0.0 < step <= length / FEWEST_SAMPLES:
        raise SceneError("step", f"{step:g} rad", f"must lie in 0..{length / FEWEST_SAMPLES:.4g} rad")
    # a hair more than a whole number of steps is rounding of the length
    edges = path[0] + step * np.arange(math.floor(length / step * (1.0 + 1e-12)) + 1)
    made = {
        name: (over, _step_means(path, run[name].values[onward], edges, step), run[name].attrs)
        for name in ("time", *run.data_vars)
        if run[name].dims == ("time",) and name != over and run[name].dtype.kind in "fiu"
    }
    middles = xr.Variable(over, way * (edges[:-1] + 0.5 * step), {"units": "rad", "long_name": over})
    attrs = {**ds.attrs, "step": step, "left_out": 1.0 - float(np.mean(onward))}
    return xr.Dataset(made, {over: middles}, attrs)


def order_spectrum(
    ds: xr.Dataset,
    variable: str = "gear_speed",
    *,
    over: str = "gear_angle",
    segment: float | None = None,
) -> xr.DataArray:
    """Power spectral density over turns of a shaft, by Welch's method with a Hann window.

    Parameters
    ----------
    ds : Dataset
        A single run with samples of the angle.
    variable : str, optional
        Which variable.
    over : str, optional
        ``"gear_angle"`` or ``"pinion_angle"``: the shaft whose turns are counted.
    segment : float, optional
        Length of the segments that are averaged, overlapping by half [turns]; by default half the run. Orders closer
        than about two over this length are not resolved.

    Returns
    -------
    DataArray, dims (order,)
        One-sided density [unit of the signal squared] over the ``order`` [1, per turn of the shaft]; a straight line
        is taken out of each segment, so that a run-up itself does not show. Attributes say how it was made.

    Raises
    ------
    SceneError
        As `resample` does; if the variable is missing or the segment is not allowed.
    """
    if variable not in ds or variable == over:
        raise SceneError("variable", variable, "is no signal of the dataset")
    turned = resample(ds[[variable, over]], over)
    values, step = turned[variable].values, float(turned.attrs["step"])
    per_turn = 2.0 * math.pi / step
    shortest, longest = FEWEST_SAMPLES / per_turn, len(values) / per_turn
    size = len(values) // 2 if segment is None else round(segment * per_turn)
    if not FEWEST_SAMPLES <= size <= len(values):
        shown = f"({len(values)} samples)" if segment is None else f"{segment:g} turns"
        raise SceneError("segment", shown, f"must lie in {shortest:.4g}..{longest:.4g} turns")
    order, density = scipy.signal.welch(
        values, per_turn, window="hann", nperseg=size, noverlap=size // 2, detrend="linear"
    )
    return xr.DataArray(
        density,
        dims="order",
        coords={"order": ("order", order, {"units": "1", "long_name": f"order, per turn of {over}"})},
        name=f"{variable}_order_spectrum",
        attrs={
            "long_name": f"power spectral density of {variable} over orders",
            "units": f"({ds[variable].attrs.get('units', '1')})2",
            "window": "hann",
            "segment_length": size / per_turn,
            "overlap": 0.5,
            "resolution": per_turn / size,
            "left_out": turned.attrs["left_out"],
            "scaling": "density, one-sided; a straight line is taken out of each segment",
        },
    )


def _step_means(path: Floats, values: Floats, edges: Floats, step: float) -> Floats:
    """Mean over each step of the angle, of straight lines between the samples."""
    parts = 0.5 * (values[1:] + values[:-1]) * np.diff(path)
    integral = np.concatenate([[0.0], np.cumsum(parts)])
    # inside an interval the integral of a straight line is a parabola, which interp alone would flatten
    index = np.clip(np.searchsorted(path, edges, side="right") - 1, 0, len(path) - 2)
    within = edges - path[index]
    slope = (values[index + 1] - values[index]) / (path[index + 1] - path[index])
    return np.asarray(np.diff(integral[index] + within * (values[index] + 0.5 * slope * within)) / step)
