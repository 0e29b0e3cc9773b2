"""Reading signals: spectra, mesh impacts, and the state of the coating from them.

Names are loaded on first use, so that drawing and reading do not wait for the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.analysis.impacts import impact_windows as impact_windows
    from gearidae.analysis.orders import order_spectrum as order_spectrum
    from gearidae.analysis.orders import resample as resample
    from gearidae.analysis.ringing import characteristic_frequency as characteristic_frequency
    from gearidae.analysis.ringing import impact_frequencies as impact_frequencies
    from gearidae.analysis.ringing import impact_spectrum as impact_spectrum
    from gearidae.analysis.spectra import power_spectrum as power_spectrum
    from gearidae.analysis.spectra import spectrogram as spectrogram
    from gearidae.monitor.assessment import Assessment as Assessment
    from gearidae.monitor.assessment import assess as assess
    from gearidae.monitor.declared.coating_map import coating_map as coating_map
    from gearidae.monitor.measured import read_signal as read_signal
    from gearidae.monitor.online import OnlineAssessment as OnlineAssessment
    from gearidae.runs.equilibrium import contact_resonance as contact_resonance
    from gearidae.studies._starting_torque import starting_torque as starting_torque
    from gearidae.studies._starting_torque import static_starting_torque as static_starting_torque
    from gearidae.studies._tooth_contacts import tooth_contacts as tooth_contacts
    from gearidae.studies.products import open_map as open_map

__getattr__, __dir__, __all__ = lazy_names(__name__)
