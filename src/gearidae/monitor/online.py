"""The coating's state while a record is being taken: an estimate after each impact."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gearidae.analysis.signal import CALIBRATION, FEWEST_SAMPLES, Signal, signals
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.monitor.assessment import Assessment, judge
from gearidae.monitor.map_model import map_model
from gearidae.monitor.sensor import check_sensor
from gearidae.scene.carried import numbers_of

_NOTHING = Assessment(math.nan, math.nan, math.nan, "no impacts", "no record yet", (), "unknown")


class OnlineAssessment:
    """Assessment of a record that arrives in pieces.

    The estimate is that of `assess` for all that has been fed, whatever the pieces were: the place of the impacts is
    found from the whole record, so it is kept (8 bytes a sample), and evaluated anew once the gear has turned through
    a further pitch. One evaluation takes some hundredths of a second for a record of 30,000 samples.

    Parameters
    ----------
    map : Dataset
        From `coating_map`.
    history, anti_alias_filter, calibration, offset : optional
        As for `assess`.

    Raises
    ------
    SceneError
        If the map or a setting is not what is expected.

    Examples
    --------
    >>> import gearidae as gd
    >>> online = gd.analysis.OnlineAssessment(chart)  # doctest: +SKIP
    >>> for time, speed in sensor:  # doctest: +SKIP
    ...     if online.feed(time, speed):
    ...         print(online.estimate)
    """

    def __init__(
        self,
        map: xr.Dataset,  # noqa: A002 - as in assess
        *,
        history: str = "auto",
        anti_alias_filter: float | str | None = None,
        calibration: float | str = CALIBRATION,
        offset: float | str = 0.0,
    ) -> None:
        self._model = map_model(map)
        self._sensor = check_sensor(history, anti_alias_filter, calibration, offset)
        self._times: list[Floats] = []
        self._speeds: list[Floats] = []
        self._last = -math.inf
        self._turned = 0.0
        self._pitches = 0
        self._estimate = _NOTHING
        self._stale = False

    @property
    def impacts(self) -> int:
        """Pitches that the gear has turned through, each with one impact."""
        return self._pitches

    @property
    def estimate(self) -> Assessment:
        """Assessment of all that has been fed; the same as `assess` gives for it."""
        if self._stale:
            record = self._record()
            self._estimate = _NOTHING if record is None else judge(record, self._model, self._sensor)
            self._stale = False
        return self._estimate

    def feed(self, time: ArrayLike, speed: ArrayLike) -> bool:
        """Add samples.

        Parameters
        ----------
        time : array_like, shape (n,) or ()
            Sample times [s], uniform and later than all before.
        speed : array_like, shape (n,) or ()
            Speed of the gear [rad/s].

        Returns
        -------
        bool
            Whether the gear has turned through a further pitch, so that the estimate has been made anew.

        Raises
        ------
        SceneError
            If the samples are no finite numbers of one shape, or not later than those before.
        """
        times, speeds = _column("time", time, "s"), _column("speed", speed, "rad/s")
        if times.shape != speeds.shape:
            raise SceneError("speed", f"({len(speeds)} samples)", f"must be as many as times, {len(times)}")
        if not len(times):
            return False
        if times[0] <= self._last or (np.diff(times) <= 0.0).any():
            raise SceneError(
                "time", f"{times[0]:.9g} s", f"must increase, and be later than {self._last:.9g} s"
            )
        self._turned += self._angle(times, speeds)
        self._times.append(times)
        self._speeds.append(speeds)
        self._last = float(times[-1])
        self._stale = True
        pitches = int(max(0.0, self._turned) * self._model.gear_teeth / (2.0 * math.pi))
        if pitches <= self._pitches:
            return False
        self._pitches = pitches
        _ = self.estimate
        return True

    def _angle(self, times: Floats, speeds: Floats) -> float:
        """Angle turned within new samples, and from the last one before them [rad]."""
        if self._speeds:
            times = np.concatenate([self._times[-1][-1:], times])
            speeds = np.concatenate([self._speeds[-1][-1:], speeds])
        return float(np.trapezoid(speeds, times))

    def _record(self) -> Signal | None:
        """All samples as one uniform record; None while they are too few."""
        if sum(len(piece) for piece in self._times) < FEWEST_SAMPLES:
            return None
        times, speeds = np.concatenate(self._times), np.concatenate(self._speeds)
        # the pieces are kept as one, so that they are not put together again from the first one
        self._times, self._speeds = [times], [speeds]
        array = xr.DataArray(speeds, dims="time", coords={"time": times})
        return signals(array, gear_teeth=self._model.gear_teeth).signals[0]


def _column(name: str, values: ArrayLike, unit: str) -> Floats:
    """Samples as a vector of finite numbers [SI]."""
    try:
        column = np.atleast_1d(numbers_of(values, unit))
    except (TypeError, ValueError) as error:
        raise SceneError(name, type(values).__name__, f"must be a list of numbers: {error}") from None
    if column.ndim != 1 or not np.isfinite(column).all():
        raise SceneError(name, f"(shape {column.shape})", "must be a list of finite numbers")
    return column
