"""From a measured speed signal to the state of the coating.

`fitting` says how well each fraction explains the frequencies after the impacts, `doubts` what may be wrong with the
record nevertheless; here both become a fraction, an interval and a verdict in words.
"""

from __future__ import annotations

import html
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Unpack

import numpy as np
import xarray as xr

from gearidae.analysis.impacts import unlike_pitch
from gearidae.analysis.ringing import HIGHEST, Ring, rings_of
from gearidae.analysis.signal import CALIBRATION, Signal, signals
from gearidae.errors import SceneError
from gearidae.monitor import record_checks
from gearidae.monitor.assessment_words import (
    below_map,
    calibration_words,
    gears_words,
    listed,
    lone_words,
    misfit,
    other_speed,
    silence,
    stop_words,
    tone_words,
    torque_words,
    what_would_tell,
)
from gearidae.monitor.fitting import Fit, RingSet, first_explanation
from gearidae.monitor.map_model import MapModel, map_model
from gearidae.monitor.measured import Reading, read_signal
from gearidae.monitor.sensor import Sensor, check_sensor
from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    import pandas as pd


_PLAIN = 0.1
"""Intervals wider than this say nothing about the coating."""
_GAP = 0.02
"""Fractions further apart than this, with none in between that explains the signal, are different answers."""
_COARSE = 0.1
"""Distance of the map's own fractions up to which what lies between is known by interpolation, see `map_model`."""
_FEWEST_TO_TELL_START = 2
"""With fewer impacts the frequencies cannot contradict that the record begins with the map's start."""
_SAME_START, _SAME_START_ALONE = 0.1, 0.04
"""Pitches by which the first impact of a record from the start may be elsewhere than in the map; of a single one."""
_FEWEST_RINGS = 3
"""Impacts that must ring before a calibration is said to be wrong."""


CALIBRATION_VERDICT = "check the speed's calibration"


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
        - ``clear``: one fraction explains the signal, and nothing of what follows applies.
        - ``ambiguous``: quite different fractions do; `low` and `high` are the ends of what is possible.
        - ``no impacts``: nothing rings above the noise.
        - ``outside the map``: it rings lower or higher than anything in the map.
        - ``does not fit``: no fraction of the map explains it, what stands out is no response to the impacts, a sample
          is a spike, or the gear turns at another speed than in the map.
        - ``gear stops``: it stops, turns back, or turns more slowly than in any run of the map.
        - ``rounded too coarsely``: the ringing is smaller than the step to which the speed is rounded.
        - ``sampled too slowly``: what shows could be the image of faster ringing.
    explanation : str
        The same in a sentence.
    frequencies : tuple of float
        Frequency of each impact response [Hz]; NaN where nothing stands out.
    history : str
        ``start`` if the record was taken to begin with the map's start, ``unknown`` if not.
    torque : float
        Drive torque estimated from the gear's speed [N m]; NaN unless the map is one over ``drive.torque``.
    gear_speed : float
        Median speed of the gear [rad/s].
    reading : str
        What was recognised in the file or table of the record, see `read_signal`.
    """

    sam_fraction: float
    low: float
    high: float
    verdict: str
    explanation: str
    frequencies: tuple[float, ...]
    history: str
    torque: float = math.nan
    gear_speed: float = math.nan
    reading: str = field(default="", compare=False)

    @property
    def uncertainty(self) -> float:
        """Standard uncertainty of the fraction [1]: a quarter of the interval."""
        return 0.25 * (self.high - self.low)

    @property
    def conclusive(self) -> bool:
        """Whether the signal determines the fraction."""
        return self.verdict == "clear"

    def __str__(self) -> str:
        return self.explanation

    def _repr_html_(self) -> str:
        """Return a table for a notebook: the answer, and what it rests on."""
        return assessment_table(self)


def assess(
    signal: xr.Dataset | xr.DataArray | pd.DataFrame | str | os.PathLike[str],
    map: xr.Dataset,  # noqa: A002 - what it is called in the field, and in the command line
    *,
    history: str = "auto",
    anti_alias_filter: float | str | None = None,
    calibration: float | str = CALIBRATION,
    offset: float | str = 0.0,
    **reading: Unpack[Reading],
) -> Assessment:
    """Tell the SAM fraction from the speed of the gear.

    Parameters
    ----------
    signal : Dataset, DataArray, DataFrame or path-like
        One run: gear speed along time, or a table or a file of it, see `read_signal`.
    map : Dataset
        From `coating_map`, for the same gears. Of a map over ``drive.torque`` too, the torque is estimated from the
        gear's speed; of a map at one torque, a difference of the speed from the map's widens the interval.
    history : {'auto', 'start', 'unknown'}, optional
        Whether the record begins with the start that the map was made for. ``auto`` supposes so if the first
        impact comes when the map's does, unless that does not explain the signal.
    anti_alias_filter : float or str, optional
        Cut-off frequency of a low-pass filter before the sampling [Hz], or ``"4 kHz"``. Without it, ringing above half
        the sampling rate may be in the record, at another frequency than its own.
    calibration : float or str, optional
        Relative standard uncertainty of the measured speed [1], or ``"4 %"``; at most 10 %.
    offset : float or str, optional
        Standard uncertainty of the sensor's zero [rad/s], or with a unit.
    **reading
        ``columns``, ``skip``, ``delimiter``, ``decimal``, ``bridge`` and ``interval``, as for `read_signal`.

    Returns
    -------
    Assessment

    Raises
    ------
    SceneError
        If the signal or the map is not what is expected, naming what is missing.
    """
    model = map_model(map)
    sensor = check_sensor(history, anti_alias_filter, calibration, offset)
    data = signal if isinstance(signal, xr.Dataset | xr.DataArray) else read_signal(signal, **reading)
    if data is signal and reading:
        raise SceneError(
            next(iter(reading)), "(given)", "is for files and DataFrames; this is a Dataset already"
        )
    batch = signals(data, gear_teeth=model.gear_teeth)
    if len(batch.signals) != 1:
        count, dim = len(batch.signals), batch.dims[0]
        raise SceneError(
            "signal",
            f"({count} runs)",
            f"must be one run: pick one with .sel({dim}=...), or --select {dim}=...",
        )
    assessment = judge(batch.signals[0], model, sensor)
    return replace(assessment, reading=str(data.attrs.get("reading", "")))


def judge(signal: Signal, model: MapModel, sensor: Sensor) -> Assessment:
    """Tell the SAM fraction from one uniform record.

    Parameters
    ----------
    signal : Signal
        Gear speed, with the gear's teeth.
    """
    speed = signal.forward()
    speed = replace(speed, calibration=sensor.uncertainty(float(np.median(speed.values))))
    assessment = _judged(speed, model, sensor)
    if alone := record_checks.lone_samples(speed):
        return _without_answer(assessment, "does not fit", lone_words(speed, alone))
    if assessment.verdict != "gear stops":
        assessment = _calibrated(assessment, speed, model)
    if speed.values is signal.values:
        return assessment
    return replace(
        assessment, explanation=f"{assessment.explanation}; the speed is taken with its sign reversed"
    )


def _calibrated(assessment: Assessment, signal: Signal, model: MapModel) -> Assessment:
    """Take an answer back where impacts ring, but not one pitch apart: windows and torque are then wrong."""
    spacing = unlike_pitch(signal)
    if spacing == 1.0:
        return assessment
    corrected = replace(signal, values=signal.values / spacing)
    responses = rings_of(corrected, model.width)
    ringing = [n for n, ring in enumerate(responses) if math.isfinite(ring.frequency)]
    if len(ringing) < _FEWEST_RINGS or record_checks.persistent(corrected, responses, ringing, model.width):
        return assessment
    frequencies = tuple(ring.frequency for ring in responses)
    why = calibration_words(spacing, signal.calibration, [frequencies[n] for n in ringing])
    return replace(_without_answer(assessment, CALIBRATION_VERDICT, why), frequencies=frequencies)


def _without_answer(assessment: Assessment, verdict: str, why: str) -> Assessment:
    nothing = math.nan
    return replace(
        assessment,
        sam_fraction=nothing,
        low=nothing,
        high=nothing,
        torque=nothing,
        verdict=verdict,
        explanation=why,
    )


def _judged(signal: Signal, model: MapModel, sensor: Sensor) -> Assessment:
    """Judge the record of a gear that turns forward."""
    responses = rings_of(signal, model.width)
    step = record_checks.quantum(signal.values)
    frequencies = tuple(ring.frequency for ring in responses)
    speed = float(np.median(signal.values))
    silent = Assessment(
        math.nan, math.nan, math.nan, "no impacts", "", frequencies, "unknown", gear_speed=speed
    )
    ringing = [n for n, ring in enumerate(responses) if math.isfinite(ring.frequency)]
    shown = [n for n in ringing if not record_checks.too_coarse(responses[n], step)]
    if not ringing:
        return replace(silent, explanation=silence(responses))
    if 2 * len(shown) < len(ringing):
        why = (
            f"the speed is rounded to {step:.3g} rad/s, but the contact rings with "
            f"{max(responses[n].amplitude for n in ringing):.2g} rad/s only, which such steps distort"
        )
        return replace(silent, verdict="rounded too coarsely", explanation=why)
    rings = RingSet(
        np.array(shown),
        np.array([responses[n].frequency for n in shown]),
        np.array([record_checks.widened(responses[n], step) for n in shown]),
        speed,
        record_checks.unsteadiness(signal),
        signal.calibration,
    )
    stopped = record_checks.stop(signal, model)
    if stopped:
        return replace(silent, verdict="gear stops", explanation=stop_words(stopped, rings))
    if record_checks.persistent(signal, responses, shown, model.width):
        return replace(silent, verdict="does not fit", explanation=tone_words(rings))
    may_be_start = _may_be_start(signal, model, responses, len(shown))
    fit = first_explanation(model, rings, sensor.history, may_be_start=may_be_start)
    assessment = _read(fit, model, rings, replace(silent, history=fit.history), signal.rate)
    return (
        _vetoed(assessment, signal, model, rings, fit, sensor.cutoff) if assessment.conclusive else assessment
    )


def _may_be_start(signal: Signal, model: MapModel, responses: list[Ring], shown: int) -> bool:
    """Whether the first impact is as far from the start of the record as from that of the map's runs."""
    if math.isnan(model.first_impact):
        return shown >= _FEWEST_TO_TELL_START
    angle = (responses[0].time - signal.start) * float(np.median(signal.values))
    within = _SAME_START if shown >= _FEWEST_TO_TELL_START else _SAME_START_ALONE
    return abs(angle - model.first_impact) < within * 2.0 * math.pi / model.gear_teeth


def _vetoed(
    assessment: Assessment, signal: Signal, model: MapModel, rings: RingSet, fit: Fit, cutoff: float
) -> Assessment:
    """Take a clear answer back where something is wrong with the record."""
    why = record_checks.slower_than_map(signal, model)
    verdict, text = "gear stops", stop_words(why, rings)
    if not why:
        why = record_checks.alias(model, rings, fit, signal.rate, cutoff)
        verdict = "sampled too slowly"
        text = f"impacts seem to ring at {listed(rings.frequency)} Hz, but {why}"
    if not why:
        return assessment
    return _without_answer(assessment, verdict, text)


def _read(fit: Fit, model: MapModel, rings: RingSet, silent: Assessment, rate: float) -> Assessment:
    """Turn chi-square into a fraction, an interval and words."""
    needed = model.highest_first / HIGHEST
    too_slow = (
        f"; sampled at {rate:.3g} Hz, below the map's {needed:.3g} Hz, it may not show what rings faster"
        if rate < needed
        else ""
    )
    another = other_speed(fit, model, rings)
    if not fit.explains and (not another or model.torques is None):
        verdict, why = misfit(fit, model, rings)
        return replace(silent, verdict=verdict, explanation=why + too_slow)
    if another:
        return replace(silent, verdict="does not fit", explanation=another)
    if why := below_map(fit, model, rings):
        return replace(silent, verdict="outside the map", explanation=why + too_slow)
    fractions, possible = fit.fractions, fit.possible
    # the grid is finite: an interval is never narrower than its spacing
    spacing = float(fractions[1] - fractions[0])
    low = max(float(fractions[0]), float(possible[0]) - spacing)
    high = min(float(fractions[-1]), float(possible[-1]) + spacing)
    torque = math.nan if model.torques is None else model.torque_at(rings.speed)
    answer = replace(silent, low=low, high=high, torque=torque)
    at = listed(rings.frequency)
    if np.diff(possible).max(initial=0.0) > _GAP or high - low > _PLAIN:
        why = (
            f"impacts ring at {at} Hz, which SAM fractions from {low:.3f} to {high:.3f} explain alike; "
            f"{what_would_tell(fit, model, rings)} can tell{gears_words(fit, model)}"
        )
        return replace(answer, verdict="ambiguous", explanation=why)
    fraction = float(fractions[fit.best])
    above, below = model.known[model.known > fraction], model.known[model.known < fraction]
    coarsest = _COARSE * (1.0 + 1e-9)  # steps of 0.1 are rounded
    if above.size and below.size and above[0] - below[-1] > coarsest:
        why = (
            f"impacts ring at {at} Hz, as between {below[-1]:.3g} and {above[0]:.3g}, where the map has no coverage: "
            f"one with steps of {_COARSE:g} or less can tell"
        )
        low, high = min(low, float(below[-1])), max(high, float(above[0]))
        return replace(answer, low=low, high=high, verdict="ambiguous", explanation=why)
    since = "counted from the start" if fit.history == "start" else "the start not being in the record"
    why = f"SAM fraction {fraction:.3f} (95 %: {low:.3f} to {high:.3f}); impacts ring at {at} Hz, {since}"
    why += torque_words(fit, model, rings) + gears_words(fit, model) + too_slow
    if low == fractions[0] > 0.0:
        why += "; the map ends there, and less could be left"
    return replace(answer, sam_fraction=fraction, verdict="clear", explanation=why)


def assessment_table(assessment: Assessment) -> str:
    """Write an assessment as HTML, without colours of its own, so that it can be read on any background.

    Returns
    -------
    str
        Verdict and explanation, then what is known of fraction, interval, torque, speed and frequencies.
    """
    rows = "".join(
        f"<tr><th style='text-align: left'>{html.escape(name)}</th>"
        f"<td style='text-align: left'>{html.escape(text)}</td></tr>"
        for name, text in _rows(assessment)
    )
    caption = f"<b>{html.escape(assessment.verdict)}</b>: {html.escape(assessment.explanation)}"
    return f"<table><caption style='text-align: left'>{caption}</caption>{rows}</table>"


def _rows(assessment: Assessment) -> Iterator[tuple[str, str]]:
    if not math.isnan(assessment.sam_fraction):
        yield "SAM fraction", f"{assessment.sam_fraction:.4g}"
    if not math.isnan(assessment.low):
        yield "95 % interval", f"{assessment.low:.4g} to {assessment.high:.4g}"
    yield (
        "record begins",
        {"start": "with the start of the map's runs"}.get(assessment.history, "at a time not known"),
    )
    if not math.isnan(assessment.gear_speed):
        yield "median gear speed", f"{assessment.gear_speed:.4g} rad/s"
    if not math.isnan(assessment.torque):
        yield "estimated drive torque", with_prefix(assessment.torque, "N m", 4)
    # "-" where nothing stands out
    frequencies = [with_prefix(frequency, "Hz", 4) for frequency in assessment.frequencies]
    if assessment.reading:
        yield "record read with", assessment.reading
    yield "impact responses", ", ".join(frequencies) or "none"
