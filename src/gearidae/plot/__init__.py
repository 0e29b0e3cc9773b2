"""Pictures of datasets: one function each, takes a dataset, returns matplotlib axes or a figure.

Those of the teeth are loaded on first use, because they need the contact laws, compiled.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names
from gearidae.plot.coating import coating_map, starting_torque
from gearidae.plot.ensembles import sobol_indices, sticking_probability
from gearidae.plot.files import write
from gearidae.plot.gears import gap, gear_speed, transmission_error
from gearidae.plot.life import coverage_along_flank, life
from gearidae.plot.lives import lives
from gearidae.plot.outcome import outcome
from gearidae.plot.outcome_map import outcome_map
from gearidae.plot.overview import overview
from gearidae.plot.posterior import posterior
from gearidae.plot.roller import roller_force, roller_gap
from gearidae.plot.spectra import cycle, impact_spectrum, power_spectrum, spectrogram
from gearidae.plot.surface import surface
from gearidae.plot.threshold import sticking_threshold
from gearidae.plot.torque import contact_torque

if TYPE_CHECKING:
    from gearidae.plot.animation import animate_teeth
    from gearidae.plot.teeth_view import teeth

__all__ = [
    "animate_teeth",
    "coating_map",
    "contact_torque",
    "coverage_along_flank",
    "cycle",
    "gap",
    "gear_speed",
    "impact_spectrum",
    "life",
    "lives",
    "outcome",
    "outcome_map",
    "overview",
    "posterior",
    "power_spectrum",
    "roller_force",
    "roller_gap",
    "sobol_indices",
    "spectrogram",
    "starting_torque",
    "sticking_probability",
    "sticking_threshold",
    "surface",
    "teeth",
    "transmission_error",
    "write",
]

__getattr__, __dir__ = lazy_names(globals(), {"animate_teeth": "animation", "teeth": "teeth_view"})
