"""Reading signals: spectra, mesh impacts, and the state of the coating from them.

Names are loaded on first use, so that drawing and reading do not wait for the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.analysis.assessment import Assessment, assess
    from gearidae.analysis.impacts import impact_windows
    from gearidae.analysis.measured import read_signal
    from gearidae.analysis.online import OnlineAssessment
    from gearidae.analysis.ringing import characteristic_frequency, impact_frequencies, impact_spectrum
    from gearidae.analysis.spectra import power_spectrum, spectrogram
    from gearidae.studies.coating_map import coating_map
    from gearidae.studies.equilibrium import contact_resonance
    from gearidae.studies.products import open_map
    from gearidae.studies.starting_torque import starting_torque, static_starting_torque
    from gearidae.studies.tooth_contacts import tooth_contacts

__all__ = [
    "Assessment",
    "OnlineAssessment",
    "assess",
    "characteristic_frequency",
    "coating_map",
    "contact_resonance",
    "impact_frequencies",
    "impact_spectrum",
    "impact_windows",
    "open_map",
    "power_spectrum",
    "read_signal",
    "spectrogram",
    "starting_torque",
    "static_starting_torque",
    "tooth_contacts",
]

_HOME = {
    "Assessment": "assessment",
    "OnlineAssessment": "online",
    "assess": "assessment",
    "characteristic_frequency": "ringing",
    "coating_map": "gearidae.studies.coating_map",
    "contact_resonance": "gearidae.studies.equilibrium",
    "impact_frequencies": "ringing",
    "impact_spectrum": "ringing",
    "impact_windows": "impacts",
    "open_map": "gearidae.studies.products",
    "power_spectrum": "spectra",
    "read_signal": "measured",
    "spectrogram": "spectra",
    "starting_torque": "gearidae.studies.starting_torque",
    "static_starting_torque": "gearidae.studies.starting_torque",
    "tooth_contacts": "gearidae.studies.tooth_contacts",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
