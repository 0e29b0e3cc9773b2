"""From a measured speed signal to the state of the coating.

`fitting` says how well each fraction explains the frequencies after the impacts, `doubts` what may be wrong with the
record nevertheless; here both become a fraction, an interval and a verdict in words.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from gearidae.analysis import doubts
from gearidae.analysis.assessment_table import assessment_table
from gearidae.analysis.fitting import COMMON, SPEED_RANGE, Fit, Heard, first_explanation
from gearidae.analysis.map_model import BEFORE, MapModel, map_model
from gearidae.analysis.measured import read_signal
from gearidae.analysis.ringing import HIGHEST, Ring, rings_of
from gearidae.analysis.signal import Floats, Signal, signals
from gearidae.errors import SceneError

__all__ = ["Assessment", "assess", "check_settings", "judge"]

_PLAIN = 0.1
"""Intervals wider than this say nothing about the coating."""
_GAP = 0.02
"""Fractions further apart than this, with none in between that explains the signal, are different answers."""
_FEWEST_TO_TELL_START = 2
"""With fewer impacts the frequencies cannot contradict that the record begins with the map's start."""
_SAME_START, _SAME_START_ALONE = 0.1, 0.04
"""Pitches by which the first impact of a record from the start may be elsewhere than in the map; of a single one."""

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
        - ``clear``: one fraction explains the signal, and nothing of what follows applies.
        - ``ambiguous``: quite different fractions do; `low` and `high` are the ends of what is possible.
        - ``no impacts``: nothing rings above the noise.
        - ``outside the map``: it rings lower or higher than anything in the map.
        - ``does not fit``: no fraction of the map explains it, what stands out is no response to the impacts, or the
          gear turns at another speed than in the map.
        - ``gear stops``: it stops, turns back, or turns more slowly than in any run of the map.
        - ``rounded too coarsely``: the ringing is smaller than the step to which the speed is rounded.
        - ``sampled too slowly``: what is heard could be the image of faster ringing.
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

    def _repr_html_(self) -> str:
        """Return a table for a notebook: the answer, and what it rests on."""
        return assessment_table(self)


def assess(
    signal: xr.Dataset | xr.DataArray | str | os.PathLike[str],
    map: xr.Dataset,  # noqa: A002 - what it is called in the field, and in the command line
    *,
    history: str = "auto",
    anti_alias_filter: float | None = None,
) -> Assessment:
    """Tell the SAM fraction from the speed of the gear.

    Parameters
    ----------
    signal : Dataset, DataArray or path-like
        One run: gear speed along time, or a file of it, see `read_signal`.
    map : Dataset
        From `coating_map`, for the same gears. Of a map over ``drive.torque`` too, the torque is estimated from the
        gear's speed; of a map at one torque, a difference of the speed from the map's widens the interval.
    history : {'auto', 'start', 'unknown'}, optional
        Whether the record begins with the start that the map was made for. ``auto`` supposes so if the first
        impact comes when the map's does, unless that does not explain the signal.
    anti_alias_filter : float, optional
        Cut-off frequency of a low-pass filter before the sampling [Hz]. Without it, ringing above half the sampling
        rate may be in the record, at another frequency than its own.

    Returns
    -------
    Assessment

    Raises
    ------
    SceneError
        If the signal or the map is not what is expected, naming what is missing.
    """
    model = map_model(map)
    cutoff = check_settings(history, anti_alias_filter)
    data = read_signal(signal) if isinstance(signal, str | os.PathLike) else signal
    batch = signals(data, gear_teeth=model.gear_teeth)
    if len(batch.signals) != 1:
        count, dim = len(batch.signals), batch.dims[0]
        raise SceneError(
            "signal",
            f"({count} runs)",
            f"must be one run: pick one with .sel({dim}=...), or --select {dim}=...",
        )
    return judge(batch.signals[0], model, history, cutoff)


def check_settings(history: str, anti_alias_filter: float | None) -> float:
    """Refuse settings that are none; return the cut-off frequency [Hz], infinite where no filter is known.

    Parameters
    ----------
    history : str
    anti_alias_filter : float or None

    Returns
    -------
    float

    Raises
    ------
    SceneError
        Naming the setting.
    """
    if history not in _HISTORIES:
        raise SceneError("history", history, f"must be one of {', '.join(_HISTORIES)}")
    if anti_alias_filter is None:
        return math.inf
    try:
        cutoff = float(anti_alias_filter)
    except (TypeError, ValueError):
        cutoff = math.nan
    if not cutoff > 0.0:
        raise SceneError("anti_alias_filter", anti_alias_filter, "must be a frequency in Hz, above zero")
    return cutoff


def judge(signal: Signal, model: MapModel, history: str, cutoff: float) -> Assessment:
    """Tell the SAM fraction from one uniform record.

    Parameters
    ----------
    signal : Signal
        Gear speed, with the gear's teeth.
    model : MapModel
    history : str
    cutoff : float
        Cut-off frequency of the filter before the sampling [Hz]; infinite if none is known.

    Returns
    -------
    Assessment
    """
    given, signal = signal, signal.forward()
    found = _judged(signal, model, history, cutoff)
    if signal is given:
        return found
    return replace(found, explanation=f"{found.explanation}; the speed is taken with its sign reversed")


def _judged(signal: Signal, model: MapModel, history: str, cutoff: float) -> Assessment:
    """Judge the record of a gear that turns forward."""
    rings = rings_of(signal, model.width)
    step = doubts.quantum(signal.values)
    frequencies = tuple(ring.frequency for ring in rings)
    speed = float(np.median(signal.values))
    silent = Assessment(
        math.nan, math.nan, math.nan, "no impacts", "", frequencies, "unknown", gear_speed=speed
    )
    ringing = [n for n, ring in enumerate(rings) if math.isfinite(ring.frequency)]
    shown = [n for n in ringing if not doubts.too_coarse(rings[n], step)]
    if not ringing:
        return replace(silent, explanation=_silence(rings))
    if 2 * len(shown) < len(ringing):
        why = (
            f"the speed is rounded to {step:.3g} rad/s, but the contact rings with "
            f"{max(rings[n].amplitude for n in ringing):.2g} rad/s only, which such steps distort"
        )
        return replace(silent, verdict="rounded too coarsely", explanation=why)
    heard = Heard(
        np.array(shown),
        np.array([rings[n].frequency for n in shown]),
        np.array([doubts.widened(rings[n], step) for n in shown]),
        speed,
        doubts.unsteadiness(signal),
    )
    stopped = doubts.stop(signal, model)
    if stopped:
        return replace(silent, verdict="gear stops", explanation=_stop_words(stopped, heard))
    if doubts.persistent(signal, rings, shown, model.width):
        return replace(silent, verdict="does not fit", explanation=_tone_words(heard))
    fit = first_explanation(
        model, heard, history, may_be_start=_may_be_start(signal, model, rings, len(shown))
    )
    found = _read(fit, model, heard, replace(silent, history=fit.history), signal.rate)
    return _vetoed(found, signal, model, heard, fit, cutoff) if found.conclusive else found


def _may_be_start(signal: Signal, model: MapModel, rings: list[Ring], shown: int) -> bool:
    """Whether the first impact is as far from the start of the record as from that of the map's runs."""
    if math.isnan(model.first_impact):
        return shown >= _FEWEST_TO_TELL_START
    angle = (rings[0].time - signal.start) * float(np.median(signal.values))
    within = _SAME_START if shown >= _FEWEST_TO_TELL_START else _SAME_START_ALONE
    return abs(angle - model.first_impact) < within * 2.0 * math.pi / model.gear_teeth


def _silence(rings: list[Ring]) -> str:
    """Why a record without ringing says nothing."""
    why = (
        "no mesh impact rings above the noise"
        if any(math.isfinite(ring.time) for ring in rings)
        else "the gear does not turn through a mesh impact"
    )
    return why + ", so the signal says nothing about the coating"


def _stop_words(stopped: str, heard: Heard) -> str:
    """Why a gear that stops says nothing by its ringing."""
    return (
        f"{stopped}: adhesion holds it, or nothing drives it; that impacts ring at {_listed(heard.frequency)} Hz "
        "then says nothing about the coating"
    )


def _tone_words(heard: Heard) -> str:
    """Why a tone says nothing about the contact."""
    return (
        f"what stands out after the impacts, at {_listed(heard.frequency)} Hz, is there before them too: a tone of "
        "something else, and no response to the impacts"
    )


def _vetoed(
    found: Assessment, signal: Signal, model: MapModel, heard: Heard, fit: Fit, cutoff: float
) -> Assessment:
    """Take a clear answer back where something is wrong with the record."""
    why = doubts.slower_than_map(signal, model)
    verdict, text = "gear stops", _stop_words(why, heard)
    if not why:
        why = doubts.alias(model, heard, fit, signal.rate, cutoff)
        verdict = "sampled too slowly"
        text = f"impacts seem to ring at {_listed(heard.frequency)} Hz, but {why}"
    if not why:
        return found
    nothing = math.nan
    return replace(found, sam_fraction=nothing, low=nothing, high=nothing, verdict=verdict, explanation=text)


def _read(fit: Fit, model: MapModel, heard: Heard, silent: Assessment, rate: float) -> Assessment:
    """Turn chi-square into a fraction, an interval and words."""
    needed = model.highest_first / HIGHEST
    too_slow = (
        f"; sampled at {rate:.3g} Hz, below the map's {needed:.3g} Hz, it may not show what rings faster"
        if rate < needed
        else ""
    )
    another = _other_speed(fit, model, heard)
    if not fit.explains and (not another or model.torques is None):
        return _misfit(fit, model, heard, silent, too_slow)
    if another:
        return replace(silent, verdict="does not fit", explanation=another)
    fractions, possible = fit.fractions, fit.possible
    # the grid is finite: an interval is never narrower than its spacing
    spacing = float(fractions[1] - fractions[0])
    low = max(float(fractions[0]), float(possible[0]) - spacing)
    high = min(float(fractions[-1]), float(possible[-1]) + spacing)
    torque = math.nan if model.torques is None else model.torque_at(heard.speed)
    found = replace(silent, low=low, high=high, torque=torque)
    at = _listed(heard.frequency)
    if np.diff(possible).max(initial=0.0) > _GAP or high - low > _PLAIN:
        why = (
            f"impacts ring at {at} Hz, which SAM fractions from {low:.3f} to {high:.3f} explain alike; "
            f"{_what_would_tell(fit, model, heard)} can tell"
        )
        return replace(found, verdict="ambiguous", explanation=why)
    fraction = float(fractions[fit.best])
    since = "counted from the start" if fit.history == "start" else "the start not being in the record"
    why = f"SAM fraction {fraction:.3f} (95 %: {low:.3f} to {high:.3f}); impacts ring at {at} Hz, {since}"
    why += _torque_words(fit, model, heard) + too_slow
    if low == fractions[0] > 0.0:
        why += "; the map ends there, and less could be left"
    return replace(found, sam_fraction=fraction, verdict="clear", explanation=why)


def _other_speed(fit: Fit, model: MapModel, heard: Heard) -> str:
    """Say so if the gear turns so much faster or slower than in the map that this is no comparison."""
    if model.torques is not None:
        low, high = float(np.nanmin(model.speeds)), float(np.nanmax(model.speeds))
        if low * (1.0 - COMMON) <= heard.speed <= high * (1.0 + COMMON):
            return ""
        return (
            f"the gear turns at {heard.speed:.3g} rad/s where the map has {low:.3g} to {high:.3g} rad/s: another "
            "torque"
        )
    expected = float(model.speeds[0, fit.best])
    if not abs(heard.speed - expected) > SPEED_RANGE * expected:  # NaN where the map's own gear sticks
        return ""
    return (
        f"the gear turns at {heard.speed:.3g} rad/s where the map has {expected:.3g} rad/s: another torque or load, "
        "which shifts the frequencies"
    )


def _what_would_tell(fit: Fit, model: MapModel, heard: Heard) -> str:
    """What else would tell fractions apart that explain a record alike."""
    expected = float(model.speeds[0, fit.best])
    if model.torques is None and abs(heard.speed - expected) > COMMON * expected:
        return (
            f"the gear turns at {heard.speed:.3g} rad/s where the map has {expected:.3g} rad/s, so the torque is "
            "another; a map over drive.torque"
        )
    return "a record with more impacts, or from the start,"


def _torque_words(fit: Fit, model: MapModel, heard: Heard) -> str:
    """What the gear's speed says about the torque."""
    if model.torques is not None:
        return f", the torque being {model.torque_at(heard.speed):.3g} N m by the gear's speed"
    expected = float(model.speeds[0, fit.best])
    if not abs(heard.speed - expected) > COMMON * expected:
        return ""
    return (
        f"; the gear turns at {heard.speed:.3g} rad/s where the map has {expected:.3g} rad/s, and the interval allows "
        "for another torque"
    )


def _misfit(fit: Fit, model: MapModel, heard: Heard, silent: Assessment, too_slow: str) -> Assessment:
    """Say why no fraction explains a signal."""
    sequences = model.sequences
    first = np.exp(sequences[..., BEFORE])
    lowest, highest = float(np.nanmin(first)), float(np.nanmax(np.exp(sequences)))
    at, measured = _listed(heard.frequency), heard.frequency
    verdict = "outside the map"
    if np.all(measured < lowest * (1.0 - 3.0 * COMMON)):
        why = f"impacts ring at {at} Hz, lower than anything in the map (from {lowest:.4g} Hz)"
    elif measured[0] > float(np.nanmax(first)) and fit.best == 0:
        why = (
            f"impacts ring at {at} Hz, higher than the map's most worn coating, {fit.fractions[0]:.3g}, does "
            f"(up to {highest:.4g} Hz): less is left, or the gears have run longer"
        )
    else:
        verdict = "does not fit"
        why = f"impacts ring at {at} Hz, a sequence that no SAM fraction of the map explains"
    return replace(silent, verdict=verdict, explanation=why + too_slow)


def _listed(frequencies: Floats) -> str:
    """Show the first frequencies [Hz]."""
    text = ", ".join(f"{value:.4g}" for value in frequencies[:5])
    return text + (" ..." if len(frequencies) > 5 else "")
