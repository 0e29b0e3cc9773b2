"""Records of a gear's speed as a rig might deliver them: clean simulated speeds, and what happens to them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from scipy import signal as dsp

import gearidae as gd
from gearidae.analysis.signal import CALIBRATION
from gearidae.arrays import Floats

__all__ = ["CONDITIONS", "FRACTIONS", "RATE", "Condition", "Key", "clean_speeds", "cutoff", "record"]

FRACTIONS = (0.97, 0.9, 0.78, 0.637, 0.56, 0.45)
"""None is a point of the maps; the last is below them: its gear sticks after three impacts, and turns back."""
RATE = 200e3
"""Sampling rate of the clean speeds [Hz]."""
DURATION = 0.3
_PORTABLE_RTOL = 1e-5

Key = tuple[str, float, float]
"""Driver, torque in parts of the preset's, fraction."""
Change = Callable[[Floats, Floats, np.random.Generator], Floats]
"""From time [s], speed [rad/s] and a generator to the sensor's speed [rad/s]."""


@dataclass(frozen=True)
class Condition:
    """What differs between a clean record and the one that is assessed.

    Attributes
    ----------
    decibels : float
        Ratio of the first impact's ring (root mean square) to white noise.
    torque : float
        Drive torque in parts of the preset's, which `assess` does not get.
    driver : str
        That makes the clean speed: ``auto`` or ``sksundae``.
    change : callable or None
        What a sensor adds.
    start, stop : float
        Part of the record that is kept [s].
    quantum : float
        Step to which the speed is rounded [rad/s]; 0 for none.
    slower : int
        Divides the sampling rate.
    filtered : bool
        Whether a low-pass filter stands before the sampling, and `assess` knows of it.
    calibration : float
        Relative uncertainty of the speed that `assess` gets [1].
    """

    decibels: float = 20.0
    torque: float = 1.0
    driver: str = "auto"
    change: Change | None = None
    start: float = 0.0
    stop: float = DURATION
    quantum: float = 0.0
    slower: int = 1
    filtered: bool = False
    calibration: float = CALIBRATION


def _offset(time: Floats, speed: Floats, rng: np.random.Generator, *, by: float) -> Floats:
    return speed + by


def _gain(time: Floats, speed: Floats, rng: np.random.Generator, *, by: float) -> Floats:
    return speed * by


def _drift(time: Floats, speed: Floats, rng: np.random.Generator, *, by: float) -> Floats:
    return speed + by * time / DURATION


def _tone(
    time: Floats, speed: Floats, rng: np.random.Generator, *, frequency: float, amplitude: float
) -> Floats:
    return speed + amplitude * np.sin(2.0 * np.pi * (frequency * time + rng.uniform()))


def _walk(time: Floats, speed: Floats, rng: np.random.Generator, *, by: float) -> Floats:
    steps = rng.standard_normal(len(time)) * by * np.sqrt(np.diff(time, prepend=time[0]) / DURATION)
    return speed + np.cumsum(steps)


CONDITIONS: Mapping[str, Condition] = {
    "white noise, 40 dB": Condition(decibels=40.0),
    "white noise, 20 dB": Condition(),
    "white noise, 10 dB": Condition(decibels=10.0),
    "white noise, 0 dB": Condition(decibels=0.0),
    "white noise, -10 dB": Condition(decibels=-10.0),
    "random walk of 0.02 rad/s": Condition(change=partial(_walk, by=0.02)),
    "hum of 50 Hz, 0.01 rad/s": Condition(change=partial(_tone, frequency=50.0, amplitude=0.01)),
    "tone of 3 kHz, 0.01 rad/s": Condition(change=partial(_tone, frequency=3e3, amplitude=0.01)),
    "offset of 0.02 rad/s": Condition(change=partial(_offset, by=0.02)),
    "gain 1 % too low": Condition(change=partial(_gain, by=0.99)),
    "gain 4 % too low": Condition(change=partial(_gain, by=0.96)),
    "gain 4 % too high": Condition(change=partial(_gain, by=1.04)),
    "gain 4 % too low, stated": Condition(change=partial(_gain, by=0.96), calibration=0.04),
    "gain 4 % too high, stated": Condition(change=partial(_gain, by=1.04), calibration=0.04),
    "drift of 0.05 rad/s": Condition(change=partial(_drift, by=0.05)),
    "rounded to 0.001 rad/s": Condition(decibels=40.0, quantum=0.001),
    "rounded to 0.005 rad/s": Condition(decibels=40.0, quantum=0.005),
    "rounded to 0.02 rad/s": Condition(decibels=40.0, quantum=0.02),
    "torque 20 % too low": Condition(torque=0.8),
    "torque 10 % too low": Condition(torque=0.9),
    "torque 10 % too high": Condition(torque=1.1),
    "torque 20 % too high": Condition(torque=1.2),
    "first 0.11 s": Condition(stop=0.11),
    "from 0.1 s on": Condition(start=0.1),
    "from 0.1 s on, torque 10 % too high": Condition(start=0.1, torque=1.1),
    "sampled at half the rate": Condition(slower=2),
    "low-pass filter before sampling": Condition(filtered=True),
    "portable driver, rtol 1e-5": Condition(driver="sksundae"),
}


def clean_speeds(keys: set[Key]) -> dict[Key, Floats]:
    """Simulate the preset at low speed, once for each key.

    Parameters
    ----------
    keys : set of Key

    Returns
    -------
    dict of Key to ndarray, shape (60001,)
        Speed of the gear at `RATE` [rad/s].
    """
    scene = gd.preset("teodorescu2009_low_speed")
    torque = scene.to_dict()["drive"]["torque"]
    speeds = {}
    for driver, part, fraction in sorted(keys):
        changed = scene.replace(
            {
                "coating.sam_fraction": fraction,
                "drive.torque": part * torque,
                "run.samples": round(DURATION * RATE) + 1,
                "run.rtol": _PORTABLE_RTOL if driver == "sksundae" else 1e-6,
            }
        )
        ds = gd.simulate(changed, backend=driver)
        speeds[driver, part, fraction] = ds["gear_speed"].values.astype(np.float64)
    return speeds


def record(speed: Floats, condition: Condition, rate: float, rng: np.random.Generator) -> xr.DataArray:
    """What a rig would deliver of a clean speed.

    Parameters
    ----------
    speed : ndarray, shape (n,)
        At `RATE` [rad/s].
    condition : Condition
    rate : float
        Sampling rate [Hz], a divisor of `RATE`.
    rng : Generator

    Returns
    -------
    DataArray, dims (time,)
        Speed [rad/s] over time [s].
    """
    time = np.arange(len(speed)) / RATE
    sensed = speed if condition.change is None else condition.change(time, speed, rng)
    every = round(RATE / rate) * condition.slower
    if condition.filtered:
        low = dsp.butter(8, cutoff(condition, rate), fs=RATE, output="sos")
        sensed = dsp.sosfilt(low, sensed, zi=dsp.sosfilt_zi(low) * sensed[0])[0]
    noise = ring_rms(speed) * 10.0 ** (-condition.decibels / 20.0)
    kept = slice(round(condition.start * RATE), round(condition.stop * RATE) + 1, every)
    values = sensed[kept] + noise * rng.standard_normal(len(sensed[kept]))
    if condition.quantum:
        values = condition.quantum * np.round(values / condition.quantum)
    return xr.DataArray(values, dims="time", coords={"time": time[kept]})


def cutoff(condition: Condition, rate: float) -> float:
    """Cut-off frequency of the filter before the sampling [Hz].

    At 0.3 of the rate a Butterworth filter of order 8 is 45 dB down where images would show below 0.42 of the rate.
    """
    return 0.3 * rate / condition.slower


def ring_rms(speed: Floats) -> float:
    """Root mean square of the first impact's ring [rad/s]: 10 ms from the preset's first mesh exit, above 700 Hz."""
    high = dsp.butter(2, 700.0, "highpass", fs=RATE, output="sos")
    first = slice(round(_FIRST_EXIT * RATE), round((_FIRST_EXIT + 0.01) * RATE))
    return float(np.std(dsp.sosfiltfilt(high, speed)[first]))


_FIRST_EXIT = 0.0208
