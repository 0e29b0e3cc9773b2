"""How many samples a run needs to show how its contacts ring: ``run.samples = "ringing"``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from gearidae.analysis.ringing import HIGHEST
from gearidae.errors import SceneError
from gearidae.runs.equilibrium import contact_resonance
from gearidae.runs.estimates import mean_force, steady_speed
from gearidae.runs.release import exits
from gearidae.scene import GearScene, Scene
from gearidae.scene.run import MOST_SAMPLES

_MOST_EXITS: Final = 5
"""Mesh exits that are followed; each presses a worn contact deeper than the one before."""
_FASTER: Final = 1.5
"""Real exits press deeper than slow ones: the presets' pairs ring up to 1.41 times as fast as estimated, at 40 %."""


def ringing_frequency(scene: Scene) -> float:
    """Highest frequency at which the contacts of a run ring after its first mesh exits.

    Each exit in slow motion presses the staying pairs, see `gearidae.runs.release`; they ring with what has joined.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    float
        [Hz], to some 50 %; NaN without gears, or where no torque presses the teeth together or none holds them.
    """
    if not isinstance(scene, GearScene) or not (force := mean_force(scene)) > 0.0:
        return math.nan
    turned = steady_speed(scene) * scene.run.duration * scene.gears.gear_teeth / (2.0 * math.pi)
    followed = exits(scene, force, max(1, min(_MOST_EXITS, math.ceil(min(turned, _MOST_EXITS)))))
    found = [contact_resonance(scene, leaving.joined) for leaving in followed]
    return max((frequency for frequency in found if frequency > 0.0), default=math.nan) * _FASTER


def ringing_samples(scene: Scene) -> int | None:
    """Samples with which `ringing_frequency` lies below the part of the sampling rate that shows no aliases.

    Returns
    -------
    int or None
        None where the frequency is not known.
    """
    frequency = ringing_frequency(scene)
    return None if math.isnan(frequency) else math.ceil(scene.run.duration * frequency / HIGHEST) + 1


def counted(scenes: Sequence[Scene]) -> int | None:
    """Return the samples of runs that share a time axis, where their scenes ask for those of the ringing.

    Returns
    -------
    int or None
        None where they ask for others.

    Raises
    ------
    SceneError
        If none of the scenes says how fast its contacts ring, or there would be too many samples.
    """
    if scenes[0].run.samples != "ringing":
        return None
    wanted = max((number for scene in scenes if (number := ringing_samples(scene))), default=0)
    if not 2 <= wanted <= MOST_SAMPLES:
        why = (
            f"would be {wanted} samples, more than {MOST_SAMPLES:g}"
            if wanted
            else "needs gears that a torque presses"
        )
        raise SceneError("run.samples", "ringing", f"{why}: give a number of samples or a rate")
    return wanted
