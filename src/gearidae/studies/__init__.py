"""Studies: simulations, or the static contact, used to answer a question.

`coating_map`, `sticking_threshold`, `starting_torque` and `static_starting_torque`, what the teeth did
(`tooth_contacts`), derivatives (`sensitivity`), and estimates on paper. The older names are those of
`gearidae.analysis` too. Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.runs.estimates import effective_mass, resting_gap, steady_speed
    from gearidae.runs.plausibility import doubts
    from gearidae.runs.run_time import run_time
    from gearidae.runs.validity import validity
    from gearidae.studies.calibrate import calibrate
    from gearidae.studies.coating_map import coating_map
    from gearidae.studies.ensemble import ensemble
    from gearidae.studies.equilibrium import contact_resonance, natural_frequency
    from gearidae.studies.life import life
    from gearidae.studies.life_signals import assess_life
    from gearidae.studies.lives import lives
    from gearidae.studies.observation_files import read_observations
    from gearidae.studies.observations import Observation
    from gearidae.studies.operating_map import operating_map
    from gearidae.studies.predict import predict
    from gearidae.studies.products import open_life, open_lives, open_map, open_posterior
    from gearidae.studies.sensitivity import sensitivity
    from gearidae.studies.starting_torque import starting_torque, static_starting_torque
    from gearidae.studies.sticking_probability import sticking_probability
    from gearidae.studies.sticking_threshold import sticking_threshold
    from gearidae.studies.surviving_share import surviving_share
    from gearidae.studies.tooth_contacts import tooth_contacts

__all__ = [
    "Observation",
    "assess_life",
    "calibrate",
    "coating_map",
    "contact_resonance",
    "doubts",
    "effective_mass",
    "ensemble",
    "life",
    "lives",
    "natural_frequency",
    "open_life",
    "open_lives",
    "open_map",
    "open_posterior",
    "operating_map",
    "predict",
    "read_observations",
    "resting_gap",
    "run_time",
    "sensitivity",
    "starting_torque",
    "static_starting_torque",
    "steady_speed",
    "sticking_probability",
    "sticking_threshold",
    "surviving_share",
    "tooth_contacts",
    "validity",
]

_HOME = {
    "Observation": "observations",
    "assess_life": "life_signals",
    "calibrate": "calibrate",
    "coating_map": "coating_map",
    "contact_resonance": "equilibrium",
    "doubts": "gearidae.runs.plausibility",
    "effective_mass": "gearidae.runs.estimates",
    "life": "life",
    "lives": "lives",
    "ensemble": "ensemble",
    "natural_frequency": "equilibrium",
    "open_life": "products",
    "open_lives": "products",
    "open_map": "products",
    "open_posterior": "products",
    "operating_map": "operating_map",
    "predict": "predict",
    "read_observations": "observation_files",
    "resting_gap": "gearidae.runs.estimates",
    "run_time": "gearidae.runs.run_time",
    "sensitivity": "sensitivity",
    "starting_torque": "starting_torque",
    "static_starting_torque": "starting_torque",
    "steady_speed": "gearidae.runs.estimates",
    "sticking_probability": "sticking_probability",
    "sticking_threshold": "sticking_threshold",
    "surviving_share": "surviving_share",
    "tooth_contacts": "tooth_contacts",
    "validity": "gearidae.runs.validity",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
