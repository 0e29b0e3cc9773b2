"""Words of an assessment of the coating: why a record determines no fraction, and what the fraction rests on."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearidae.analysis.ringing import Ring
from gearidae.analysis.signal import Signal
from gearidae.arrays import Floats
from gearidae.monitor.fitting import SPEED_RANGE, Fit, RingSet
from gearidae.monitor.map_model import BEFORE, MapModel


def silence(rings: list[Ring]) -> str:
    """Why a record without ringing says nothing."""
    why = (
        "no mesh impact rings above the noise"
        if any(math.isfinite(ring.time) for ring in rings)
        else "the gear does not turn through a mesh impact"
    )
    return why + ", so the signal says nothing about the coating"


def stop_words(stopped: str, rings: RingSet) -> str:
    """Why a gear that stops says nothing by its ringing."""
    return (
        f"{stopped}: adhesion holds it, or nothing drives it; that impacts ring at {listed(rings.frequency)} Hz "
        "then says nothing about the coating"
    )


def tone_words(rings: RingSet) -> str:
    """Why a tone says nothing about the contact."""
    return (
        f"what stands out after the impacts, at {listed(rings.frequency)} Hz, is there before them too: a tone of "
        "something else, and no response to the impacts"
    )


def calibration_words(spacing: float, calibration: float, frequencies: list[float]) -> str:
    """Why a record whose bursts are no pitch apart says nothing."""
    return (
        f"impacts ring at {listed(np.array(frequencies))} Hz, but {spacing:.3f} pitches of the gear apart by the "
        f"speed, which then reads {100.0 * abs(spacing - 1.0):.2g} % too {'high' if spacing > 1.0 else 'low'} where an "
        f"error of {100.0 * calibration:.2g} % is assumed: correct the speed, or state its error"
    )


def other_speed(fit: Fit, model: MapModel, rings: RingSet) -> str:
    """Say so if the gear turns so much faster or slower than in the map that this is no comparison."""
    if model.torques is not None:
        low, high = float(np.nanmin(model.speeds)), float(np.nanmax(model.speeds))
        if low * (1.0 - rings.common) <= rings.speed <= high * (1.0 + rings.common):
            return ""
        return (
            f"the gear turns at {rings.speed:.3g} rad/s where the map has {low:.3g} to {high:.3g} rad/s: another "
            "torque"
        )
    expected = float(model.speeds[0, fit.best])
    if not abs(rings.speed - expected) > SPEED_RANGE * expected:  # NaN where the map's own gear sticks
        return ""
    return (
        f"the gear turns at {rings.speed:.3g} rad/s where the map has {expected:.3g} rad/s: another torque or load, "
        "which shifts the frequencies"
    )


def what_would_tell(fit: Fit, model: MapModel, rings: RingSet) -> str:
    """What else would tell fractions apart that explain a record alike."""
    expected = float(model.speeds[0, fit.best])
    if model.torques is None and abs(rings.speed - expected) > rings.common * expected:
        return (
            f"the gear turns at {rings.speed:.3g} rad/s where the map has {expected:.3g} rad/s, so the torque is "
            "another; a map over drive.torque"
        )
    if model.scatter is not None:
        return "a map of these gears' own teeth (mesh.pinion_pitch_error, mesh.gear_pitch_error), or more impacts,"
    return "a record with more impacts, or from the start,"


def torque_words(fit: Fit, model: MapModel, rings: RingSet) -> str:
    """What the gear's speed says about the torque."""
    if model.torques is not None:
        return f", the torque being {model.torque_at(rings.speed):.3g} N m by the gear's speed"
    expected = float(model.speeds[0, fit.best])
    if not abs(rings.speed - expected) > rings.common * expected:
        return ""
    return (
        f"; the gear turns at {rings.speed:.3g} rad/s where the map has {expected:.3g} rad/s, and the interval allows "
        "for another torque"
    )


def gears_words(fit: Fit, model: MapModel) -> str:
    """What the gears of a map over seeds, or the one drawing of another, mean for the answer."""
    if model.one_draw:
        return (
            "; the map's teeth are one drawing (mesh.pitch_error_seed): that of other gears is in no interval"
        )
    if (scatter := model.scatter_at(float(fit.torques[fit.best]))) is None:
        return ""
    return (
        f"; one gear of this design rings {100.0 * scatter.deviation()[fit.best]:.2g} % (standard deviation) off the "
        f"mean of the map's {scatter.gears}, which the interval includes"
    )


def below_map(fit: Fit, model: MapModel, rings: RingSet) -> str:
    """Say so if all impacts ring lower than anything in the map, by more than the error that they share.

    The chi-square of many impacts allows for more: what they share counts once in it. A gear that turns more slowly
    than the map's, by another torque, may ring lower where the map explains it.
    """
    lowest = float(np.exp(np.nanmin(model.sequences[..., BEFORE])))
    expected = float(model.speeds[0, fit.best])
    explained = fit.explains and model.torques is None and expected > 0.0
    slower = min(1.0, rings.speed / expected) if explained else 1.0
    common = rings.common
    if (
        scatter := model.scatter_at(float(fit.torques[-1]))
    ) is not None:  # of the full coating, which rings lowest
        common = math.hypot(common, float(scatter.deviation()[-1]))
    if (rings.frequency >= lowest * slower * (1.0 - 3.0 * common)).any():
        return ""
    return (
        f"impacts ring at {listed(rings.frequency)} Hz, lower than anything in the map (from {lowest:.4g} Hz)"
    )


def misfit(fit: Fit, model: MapModel, rings: RingSet) -> tuple[str, str]:
    """Verdict where no fraction explains a signal, and why."""
    if why := below_map(fit, model, rings):
        return "outside the map", why
    first = np.exp(model.sequences[..., BEFORE])
    highest = float(np.nanmax(np.exp(model.sequences)))
    at, measured = listed(rings.frequency), rings.frequency
    if measured[0] > float(np.nanmax(first)) and fit.best == 0:
        why = (
            f"impacts ring at {at} Hz, higher than the map's most worn coating, {fit.fractions[0]:.3g}, does "
            f"(up to {highest:.4g} Hz): less is left, or the gears have run longer"
        )
        return "outside the map", why
    return "does not fit", f"impacts ring at {at} Hz, a sequence that no SAM fraction of the map explains"


def listed(frequencies: Floats) -> str:
    """Show the first frequencies [Hz]."""
    text = ", ".join(f"{value:.4g}" for value in frequencies[:5])
    return text + (" ..." if len(frequencies) > 5 else "")


def lone_words(signal: Signal, alone: Sequence[int]) -> str:
    """Name a sample that is a spike."""
    first, values = alone[0], signal.values
    more = f" (and {len(alone) - 1} more like it)" if len(alone) > 1 else ""
    return (
        f"sample {first} ({signal.time[first]:.9g} s) is {values[first]:.4g} rad/s beside "
        f"{values[max(first - 1, 0)]:.4g} rad/s: a spike or a missed pulse, no motion of the gear{more}; leave such "
        "cells empty and bridge them (bridge=2, --bridge 2)"
    )
