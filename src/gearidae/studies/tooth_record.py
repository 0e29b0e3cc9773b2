r"""Gaps of single pairs of teeth from a record of the whole mesh, and what they went through.

A record holds the transmission error u and the gear's travel :math:`R_2\varphi_2`, and with them the gap of every pair
(Teodorescu et al. 2009, Eqs. 4-6), with half the backlash b, base pitch :math:`p_b`, approach :math:`l_a` and tip
relief s:

.. math::

    g_i = b - u + s(\xi_i), \quad \xi_i = R_2 \varphi_2 - i p_b \qquad
    g_i^c = b + u + s(\xi_i^c), \quad \xi_i^c = 2 l_a - (R_2 \varphi_2 - (i + \tfrac12) p_b)

Where a gap turned round between two samples follows from the recorded events.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gearidae.archive.select import first_travel
from gearidae.arrays import Floats
from gearidae.contact.history import joined_height
from gearidae.errors import SceneError
from gearidae.mesh.involute import separation
from gearidae.records import EventKind, Flank
from gearidae.scene import GearScene

Integers = NDArray[np.int64]


class ToothRecord:
    """A stretch of the samples of one run, and the turning points of its gaps.

    Parameters
    ----------
    run : xarray.Dataset
        One run of a gear pair with its own events, in memory or in a file.
    scene : Scene
        Its scene.
    samples : slice
        The samples to take, at least one.
    events : slice
        Events among which all those of that time are.

    Raises
    ------
    SceneError
        If a sample is missing.
    """

    def __init__(self, run: xr.Dataset, scene: GearScene, samples: slice, events: slice) -> None:
        def read(name: str, cut: slice = samples) -> Floats:
            values: Floats = run[name].variable[cut].values
            if cut is samples and not (present := np.isfinite(values)).all():
                number = samples.start + int(present.argmin())
                raise SceneError(
                    name, "nan", f"sample {number} is missing: the teeth's histories need every sample"
                )
            return values

        self.geometry = scene.geometry
        self._half_backlash = 0.5 * scene.mesh.backlash
        self._relief_radius = scene.mesh.tip_relief_radius
        self.time = read("time")
        self.travel = read("gear_angle") * self.geometry.base_radius_gear + first_travel(run, scene)
        self.u = read("transmission_error")
        self._furthest = np.maximum.accumulate(self.travel)
        self.gear_speed, self.mesh_force = read("gear_speed"), read("mesh_force")
        gear_rate = self.gear_speed * self.geometry.base_radius_gear
        pinion_rate = read("pinion_speed") * self.geometry.base_radius_pinion
        self._motions = [
            _Motion(self.time, self.travel, gear_rate),
            _Motion(self.time, self.u, pinion_rate * (1.0 - self._error_slope(scene)) - gear_rate),
        ]
        when = read("event_time", events)
        turning = read("event_kind", events) == EventKind.TURNING_POINT
        turning &= (when > self.time[0]) & (when < self.time[-1])
        pair, flank = read("event_pair", events)[turning], read("event_flank", events)[turning]
        order = np.lexsort((when[turning], pair, flank))
        self._turning_times = when[turning][order]
        self._turning_pairs, self._turning_flanks = pair[order], flank[order]

    def place(self, flank: Flank, pair: int, travel: Floats) -> Floats:
        """Place of a pair along the path of contact of its flank [m]."""
        if flank == Flank.DRIVE:
            return travel - pair * self.geometry.base_pitch
        return 2.0 * self.geometry.approach + (pair + 0.5) * self.geometry.base_pitch - travel

    def gap(self, flank: Flank, place: Floats, u: Floats) -> Floats:
        """Gap of a pair [m] at a place along its path, where the transmission error is `u`."""
        relief = separation(self.geometry, place, self._relief_radius)[0]
        return self._half_backlash + (u if flank == Flank.COAST else -u) + relief

    def path_to(
        self, flank: Flank, pair: int, ends: tuple[int, int], reach: float
    ) -> tuple[int, Floats, Integers]:
        """Gaps that a pair went through since it came near its path of contact.

        Parameters
        ----------
        ends : tuple of int
            A sample that must be among them, and the one to end with.
        reach : float
            How far outside the path a pair is near [m].

        Returns
        -------
        start : int
            The sample begun with.
        gaps : ndarray
            Gaps of the samples ``start`` to ``last``, and those at turning points between them [m].
        places : ndarray, shape (last - start + 1,)
            Where in `gaps` the samples are.
        """
        length, (first, last) = self.geometry.path_length, ends
        here = float(self.place(flank, pair, np.zeros(1))[0])
        first_travel = -reach - here if flank == Flank.DRIVE else here - length - reach
        start = min(int(np.searchsorted(self._furthest, first_travel)), first)
        cut = slice(start, last + 1)
        gaps = self.gap(flank, self.place(flank, pair, self.travel[cut]), self.u[cut])
        times, turned = self._turning_points(flank, pair, start, last)
        order = np.argsort(np.concatenate([self.time[cut], times]), kind="stable")
        places = np.empty(len(order), dtype=np.int64)
        places[order] = np.arange(len(order))
        return start, np.concatenate([gaps, turned])[order], places[: len(gaps)]

    def _turning_points(self, flank: Flank, pair: int, start: int, last: int) -> tuple[Floats, Floats]:
        """Times at which a pair's gap turned round between two samples, and the gaps there."""
        first, end = np.searchsorted(self._turning_flanks, [flank, flank + 1])
        low, high = first + np.searchsorted(self._turning_pairs[first:end], [pair, pair + 1])
        times = self._turning_times[low:high]
        times = times[(times > self.time[start]) & (times < self.time[last])]
        if not times.size:
            return times, times
        travel, u = (motion.at(times) for motion in self._motions)
        return times, self.gap(flank, self.place(flank, pair, travel), u)

    def _error_slope(self, scene: GearScene) -> Floats:
        """Slope of the static transmission error in the pinion's angle over R1, at the samples."""
        radius = self.geometry.base_radius_pinion
        angle = (self.u + self.travel) / radius
        slope = np.zeros_like(angle)
        for one in scene.mesh.static_error:
            slope -= one.order * one.amplitude / radius * np.sin(one.order * angle + one.phase)
        return slope


class _Motion:
    """A coordinate between its samples, from values and rates: quintics with accelerations from a spline of the rates.

    A contact may ring with a few samples in a period, and forces change by e^6 in a roughness: at six samples in a
    period cubics of the right slopes would be off by 3e-3 of the amplitude, these are by some 1e-4.
    """

    def __init__(self, time: Floats, values: Floats, rates: Floats) -> None:
        self._time, self._values, self._rates = time, values, rates
        self._accelerations = CubicSpline(time, rates)(time, 1) if len(time) > 1 else np.zeros_like(rates)

    def at(self, times: Floats) -> Floats:
        """Values at some times between the first and the last sample."""
        k = np.clip(np.searchsorted(self._time, times, side="right") - 1, 0, len(self._time) - 2)
        step = self._time[k + 1] - self._time[k]
        s = (times - self._time[k]) / step
        first, last = (
            (self._values[j], step * self._rates[j], step**2 * self._accelerations[j]) for j in (k, k + 1)
        )
        return (
            (1.0 - s**3 * (10.0 - 15.0 * s + 6.0 * s**2)) * first[0]
            + (s - s**3 * (6.0 - 8.0 * s + 3.0 * s**2)) * first[1]
            + 0.5 * s**2 * (1.0 - s) ** 3 * first[2]
            + s**3 * (10.0 - 15.0 * s + 6.0 * s**2) * last[0]
            - s**3 * (4.0 - 7.0 * s + 3.0 * s**2) * last[1]
            + 0.5 * s**3 * (1.0 - s) ** 2 * last[2]
        )


def joined_heights(gaps: Floats, wanted: Integers, limit: float) -> Floats:
    """Follow the joined height along a path of gaps, from a contact on which nothing is stretched.

    Parameters
    ----------
    gaps : ndarray, shape (n,)
        Gaps one after the other, turning points among them [m].
    wanted : ndarray of int, shape (m,)
        Gap at which the joined height is computed.
    limit : float
        Stretch limit of an asperity [m].

    Returns
    -------
    ndarray, shape (m,)
        Height above which asperities are joined [m].
    """
    steps = np.diff(gaps)
    moving = np.flatnonzero(steps)  # a gap that stays has no direction
    turns = moving[1:][np.diff(np.sign(steps[moving])) != 0.0]
    knots = np.concatenate([[0], turns])
    joined = np.empty(len(knots))
    height = joined[0] = gaps[0]
    for k, gap in enumerate(gaps[turns].tolist(), 1):
        height = joined[k] = joined_height(height, gap, limit)
    before = joined[np.searchsorted(knots, wanted, side="right") - 1]
    here = gaps[wanted]
    return np.minimum(np.maximum(before, here - limit), here)
