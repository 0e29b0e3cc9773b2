"""Take signals out of datasets: uniform samples of one run each, in SI units, with what is known beside them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from gearidae.archive.select import judged_teeth
from gearidae.archive.train import judged_view
from gearidae.archive.variables import SAMPLES
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.records import EventKind, Flank
from gearidae.scene.carried import numbers_of
from gearidae.scene.quantity import whole
from gearidae.scene.units import cf_unit

FEWEST_SAMPLES = 16
"""A record shorter than this holds nothing to analyse."""
CALIBRATION = 0.015
"""Relative uncertainty of a speed of whose sensor nothing is known."""
_UNEVEN = 0.1
"""Largest departure of a sample's time from the uniform grid, in sampling intervals."""

_DIGITS = range(4, 10)
"""Digits to which times may be rounded."""
_WHOLE = 1e-3
"""Departure of a rounded time from a multiple of its step, by the rounding of a double."""
_MANY = 8
"""Distances that differ from the usual one by a step, as rounding makes many; missing samples are fewer, or larger."""


@dataclass(frozen=True, slots=True)
class Signal:
    """Uniform samples of one run.

    Attributes
    ----------
    start : float
        Time of the first sample [s].
    interval : float
        Time between samples [s].
    values : ndarray, shape (n,)
        Samples, finite; a run that ended early is cut where it ended.
    exits : ndarray, shape (m,), or None
        Times at which tooth pairs left the mesh on the drive flank [s]; None if no events are known.
    turnings : ndarray, shape (k, 2), or None
        Times at which the gaps of tooth pairs turned round [s], and which pairs these are; None if no events are known.
    gear_teeth : int or None
        Teeth of the gear, if the scene is known.
    calibration : float
        Relative uncertainty of the values, which all of them share [1].
    """

    start: float
    interval: float
    values: Floats
    exits: Floats | None = None
    gear_teeth: int | None = None
    calibration: float = CALIBRATION
    turnings: Floats | None = None

    @property
    def time(self) -> Floats:
        """Sample times [s]."""
        return np.asarray(self.start + self.interval * np.arange(len(self.values)), dtype=np.float64)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / self.interval

    def forward(self) -> Signal:
        """Return the record of a gear that turns forward: with the sign reversed where a sensor counts the other way.

        A gear that sticks turns back by less than a pitch. Where events are known, so is the direction.
        """
        angle = np.cumsum(self.values) * self.interval
        pitch = 2.0 * np.pi / (self.gear_teeth or 1)
        backward = len(angle) and angle[-1] < -pitch and angle.max() < pitch
        return replace(self, values=-self.values) if backward and self.exits is None else self


@dataclass(frozen=True, slots=True)
class Batch:
    """All signals of a dataset, one for each point of its swept dimensions.

    Attributes
    ----------
    name, units : str
        Of the analysed variable.
    dims : tuple of str
        Swept dimensions; empty for a single run.
    shape : tuple of int
    coords : mapping
        Coordinates of the swept dimensions, and scalar ones.
    signals : tuple of Signal
        In C order of `shape`.
    """

    name: str
    units: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    coords: Mapping[str, xr.DataArray]
    signals: tuple[Signal, ...]


def signals(
    data: xr.Dataset | xr.DataArray, variable: str = "gear_speed", gear_teeth: int | None = None
) -> Batch:
    """Take every run of a variable out of a dataset.

    Parameters
    ----------
    data : Dataset or DataArray
        From `simulate`, `sweep` or `open_archive`, a part of one, or measured samples along ``time`` [s]. Other
        dimensions are runs; of a train the mesh that drives the judged shaft is taken. Units are read from the
        attribute ``units`` and are SI where there is none.
    variable : str, optional
        Which variable of a Dataset.
    gear_teeth : int, optional
        Teeth of the gear, in place of what the scene says.

    Raises
    ------
    SceneError
        If the variable or its time is missing, the time is not uniform, or a sample within a record is missing.
    """
    if not isinstance(data, xr.Dataset | xr.DataArray):
        raise SceneError("signal", type(data).__name__, "must be an xarray Dataset or DataArray")
    if isinstance(data, xr.Dataset):
        data = judged_view(data)
    array = data if isinstance(data, xr.DataArray) else data.get(variable)
    if array is None:
        known = ", ".join(str(name) for name in data if "time" in data[name].dims)
        raise SceneError(
            "variable", variable, f"there is none of that name along time; there is {known or 'none'}"
        )
    if "time" not in array.dims or "time" not in array.coords:
        raise SceneError(
            "signal", variable, "lacks the dimension time with the sample times as its coordinate"
        )
    name = variable if array.name is None else str(array.name)
    units = SAMPLES[name].units if name in SAMPLES else str(array.attrs.get("units", "1"))
    array = array.transpose(..., "time")
    time, samples = to_si(array["time"], "s", "time"), to_si(array, units, name)
    start, interval = _uniform(time)
    if not np.isfinite(samples).any():  # of several runs, some may have failed at their start
        raise SceneError(name, "(no number)", f"none of its {len(time)} samples is a number")
    # a running mean has nothing for the first samples
    late = int(np.isfinite(samples).reshape(-1, samples.shape[-1]).any(axis=0).argmax())
    start, samples = start + late * interval, samples[..., late:]
    dims = tuple(str(dim) for dim in array.dims[:-1])
    teeth = whole("gear_teeth", gear_teeth, 1) if gear_teeth is not None else _gear_teeth(data.attrs)
    nothing = Signal(start, interval, np.empty(0), gear_teeth=teeth)
    events = _events_of(data, array, dims, nothing)
    return Batch(
        name=name,
        units=units,
        dims=dims,
        shape=samples.shape[:-1],
        coords={str(key): value for key, value in array.coords.items() if "time" not in value.dims},
        signals=tuple(
            replace(events(index), values=_until_end(samples[index], name, time, late))
            for index in np.ndindex(samples.shape[:-1])
        ),
    )


def stack(
    batch: Batch, dim: str, rows: Sequence[Floats], name: str, attrs: Mapping[str, Any]
) -> xr.DataArray:
    """Put one row of numbers per run together again; shorter rows are filled up with NaN.

    Parameters
    ----------
    batch : Batch
        Whose runs the rows belong to.
    dim : str
        Name of the new last dimension.
    rows : sequence of ndarray
        In the order of the runs.
    name : str
        Of the new variable.
    attrs : mapping
        Of the new variable.
    """
    longest = max((len(row) for row in rows), default=0)
    filled = np.full((len(rows), longest), np.nan)
    for target, row in zip(filled, rows, strict=True):
        target[: len(row)] = row
    return xr.DataArray(
        filled.reshape(*batch.shape, longest),
        dims=(*batch.dims, dim),
        coords={key: value.variable for key, value in batch.coords.items()},
        name=name,
        attrs=dict(attrs),
    )


def to_si(array: xr.DataArray, units: str, key: str) -> Floats:
    """Return the values of an array in SI units.

    Parameters
    ----------
    array : DataArray
        Its attribute ``units`` says what it is in; without one it is taken to be SI.
    units : str
        The SI unit wanted, as CF writes it (``rad s-1``).
    key : str
        How to call it in an error message.

    Returns
    -------
    ndarray of float64

    Raises
    ------
    SceneError
        If the values are no numbers or the unit does not fit.
    """
    try:
        return numbers_of(array, "rad/s" if units == "rad s-1" else cf_unit(units))
    except ValueError as error:
        raise SceneError(key, f"in {array.attrs.get('units', array.dtype)}", str(error)) from None


def _uniform(time: Floats) -> tuple[float, float]:
    """First time and interval of uniform sample times, which may be rounded."""
    if len(time) < FEWEST_SAMPLES:
        raise SceneError("time", f"({len(time)} samples)", f"a record needs {FEWEST_SAMPLES} samples or more")
    if not np.isfinite(time).all():
        missing = int((~np.isfinite(time)).argmax())
        raise SceneError("time", time[missing], f"sample {missing} has no time: every sample needs one")
    interval = (time[-1] - time[0]) / (len(time) - 1)
    if not interval > 0.0:
        raise SceneError("time", f"{time[0]:g}..{time[-1]:g} s", "must increase")
    late = np.abs(time - (time[0] + interval * np.arange(len(time))))
    if late.max() > _UNEVEN * interval + _rounding(time):
        worst = int(late.argmax())
        raise SceneError(
            "time",
            f"{time[worst]:.9g} s",
            f"sample {worst} is off the uniform grid of {interval:.6g} s; if only "
            "the times are wrong, give their interval in place of them (interval=..., --interval)",
        )
    return float(time[0]), float(interval)


def _rounding(time: Floats) -> float:
    """Return the step to which times are rounded [s], if their distances show it by differing by one step; else 0."""
    largest = float(np.abs(time).max())
    decade = math.floor(math.log10(largest))
    last = time[np.abs(time) >= 10.0**decade]  # where a number of digits leaves the largest step
    if len(last) <= _MANY:
        return 0.0
    for digits in _DIGITS:
        step = 10.0 ** (decade + 1 - digits)
        counts = np.rint(last / step)
        if np.abs(last / step - counts).max() < _WHOLE:
            distances = np.diff(counts)
            unusual = np.abs(distances - np.median(distances))
            return step if (unusual > 0.0).sum() >= _MANY and unusual.max() <= 1.0 else 0.0
    return 0.0


def _until_end(values: Floats, name: str, time: Floats, late: int) -> Floats:
    """Cut a record, whose first sample is number `late`, behind its last; refuse one in which others are missing."""
    present = np.isfinite(values)
    end = len(values) - int(present[::-1].argmax()) if present.any() else 0
    if not present[:end].all():
        first, count = int(present.argmin()), int((~present[:end]).sum())
        raise SceneError(
            name,
            values[first],
            f"sample {first + late} ({time[first + late]:.9g} s) is missing, within the record ({count} in all): "
            "interpolate them (bridge=..., --bridge of a file; .interpolate_na('time')), or take a part without any",
        )
    return values[:end]


def _gear_teeth(attrs: Mapping[Any, Any]) -> int | None:
    """Teeth of the gear from the scene among the attributes."""
    try:
        return judged_teeth(json.loads(attrs["scene"])).gear_teeth
    except (KeyError, TypeError, ValueError):
        return None


def _events_of(
    data: xr.Dataset | xr.DataArray, array: xr.DataArray, dims: tuple[str, ...], nothing: Signal
) -> Callable[[tuple[int, ...]], Signal]:
    """Return the source of what the events say of the run at an index of the swept dimensions.

    Parameters
    ----------
    nothing : Signal
        Without events and samples.
    """
    names = ("event_time", "event_kind", "event_flank", "event_pair")
    if not isinstance(data, xr.Dataset) or not all(name in data for name in names[:3]):
        return lambda _: nothing
    time, kind, flank = (data[name].values for name in names[:3])
    leaving = (kind == EventKind.MESH_EXIT) & (flank == Flank.DRIVE)
    turning = kind == EventKind.TURNING_POINT
    pair = 2 * data["event_pair"].values + flank if "event_pair" in data else None
    labels = {
        str(key): data[f"event_{key}"].values
        for key in array.coords
        if f"event_{key}" in data and key != "time"
    }

    def events(index: tuple[int, ...]) -> Signal:
        run = array.isel(dict(zip(dims, index, strict=True)))
        of_run = np.ones(len(time), np.bool_)
        for key, label in labels.items():
            of_run &= label == run[key].values.item()
        turned = of_run & turning
        return replace(
            nothing,
            exits=np.asarray(time[of_run & leaving], dtype=np.float64),
            turnings=None if pair is None else np.column_stack([time[turned], pair[turned]]),
        )

    return events
