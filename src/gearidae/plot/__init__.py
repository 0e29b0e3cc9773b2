"""Pictures of datasets: one function each, takes a dataset, returns matplotlib axes or a figure."""

from gearidae.plot.coating import coating_map, starting_torque
from gearidae.plot.files import write
from gearidae.plot.gears import gap, gear_speed, transmission_error
from gearidae.plot.overview import overview
from gearidae.plot.roller import roller_force, roller_gap
from gearidae.plot.spectra import cycle, impact_spectrum, power_spectrum, spectrogram
from gearidae.plot.torque import contact_torque

__all__ = [
    "coating_map",
    "contact_torque",
    "cycle",
    "gap",
    "gear_speed",
    "impact_spectrum",
    "overview",
    "power_spectrum",
    "roller_force",
    "roller_gap",
    "spectrogram",
    "starting_torque",
    "transmission_error",
    "write",
]
