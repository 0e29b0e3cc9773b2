"""Reading signals: spectra, mesh impacts, and the state of the coating from them."""

from gearidae.analysis.assess import Assessment, assess
from gearidae.analysis.impacts import impact_windows
from gearidae.analysis.maps import coating_map, open_map
from gearidae.analysis.measured import read_signal
from gearidae.analysis.resting import contact_resonance
from gearidae.analysis.ringing import characteristic_frequency, impact_frequencies, impact_spectrum
from gearidae.analysis.spectra import power_spectrum, spectrogram
from gearidae.analysis.starting import starting_torque, static_starting_torque

__all__ = [
    "Assessment",
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
]
