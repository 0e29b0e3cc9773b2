"""Studies: simulations, or the static contact, used to answer a question.

Each file of `gearidae.studies.declared` is a study; besides there are what the teeth did (`tooth_contacts`),
derivatives (`sensitivity`), and estimates on paper. The older names are those of `gearidae.analysis` too. Names are
loaded on first use; a study needs no line below, which is for type checkers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.calibration.declared.calibrate import calibrate as calibrate
    from gearidae.calibration.declared.predict import predict as predict
    from gearidae.calibration.observation_files import read_observations as read_observations
    from gearidae.calibration.observations import Observation as Observation
    from gearidae.monitor.declared.coating_map import coating_map as coating_map
    from gearidae.runs.equilibrium import contact_resonance as contact_resonance
    from gearidae.runs.equilibrium import natural_frequency as natural_frequency
    from gearidae.runs.estimates import effective_mass as effective_mass
    from gearidae.runs.estimates import resting_gap as resting_gap
    from gearidae.runs.estimates import steady_speed as steady_speed
    from gearidae.runs.plausibility import doubts as doubts
    from gearidae.runs.run_time import run_time as run_time
    from gearidae.runs.validity import validity as validity
    from gearidae.studies._sensitivity import sensitivity as sensitivity
    from gearidae.studies._starting_torque import starting_torque as starting_torque
    from gearidae.studies._starting_torque import static_starting_torque as static_starting_torque
    from gearidae.studies._sticking_probability import sticking_probability as sticking_probability
    from gearidae.studies._tooth_contacts import tooth_contacts as tooth_contacts
    from gearidae.studies.declared.ensemble import ensemble as ensemble
    from gearidae.studies.declared.operating_map import operating_map as operating_map
    from gearidae.studies.declared.pull_off import pull_off as pull_off
    from gearidae.studies.declared.threshold import sticking_threshold as sticking_threshold
    from gearidae.studies.products import open_life as open_life
    from gearidae.studies.products import open_lives as open_lives
    from gearidae.studies.products import open_map as open_map
    from gearidae.studies.products import open_posterior as open_posterior
    from gearidae.wear.declared.lives import surviving_share as surviving_share
    from gearidae.wear.lives.hub_life import hub_life as hub_life
    from gearidae.wear.lives.life import life as life
    from gearidae.wear.lives.life_dataset import assess_life as assess_life
    from gearidae.wear.lives.lives import lives as lives

__getattr__, __dir__, __all__ = lazy_names(__name__, "gearidae.studies.declared")
