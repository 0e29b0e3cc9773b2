"""Pictures of datasets: one function each, takes a dataset, returns matplotlib axes or a figure.

A study may bring its picture with it, see `gearidae.studies.study.Picture`. Those of the teeth are loaded on first use,
because they need the contact laws, compiled.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names
from gearidae.plot.asperity_events import asperity_events as asperity_events
from gearidae.plot.coating import coating_map as coating_map
from gearidae.plot.ensembles import sobol_indices as sobol_indices
from gearidae.plot.ensembles import specimens as specimens
from gearidae.plot.ensembles import sticking_probability as sticking_probability
from gearidae.plot.files import write as write
from gearidae.plot.gears import gap as gap
from gearidae.plot.gears import gear_speed as gear_speed
from gearidae.plot.gears import transmission_error as transmission_error
from gearidae.plot.impacts import impact_forces as impact_forces
from gearidae.plot.journal import style as style
from gearidae.plot.outcome import outcome as outcome
from gearidae.plot.overview import overview as overview
from gearidae.plot.posterior import posterior as posterior
from gearidae.plot.roller import roller_force as roller_force
from gearidae.plot.roller import roller_gap as roller_gap
from gearidae.plot.spectra import cycle as cycle
from gearidae.plot.spectra import impact_spectrum as impact_spectrum
from gearidae.plot.spectra import orders as orders
from gearidae.plot.spectra import power_spectrum as power_spectrum
from gearidae.plot.spectra import spectrogram as spectrogram
from gearidae.plot.surface import surface as surface
from gearidae.plot.tooth_shape import tooth_outline as tooth_outline
from gearidae.plot.torque import contact_torque as contact_torque
from gearidae.plot.train_view import train as train
from gearidae.plot.work import work as work
from gearidae.studies.declared import studies

if TYPE_CHECKING:
    from gearidae.plot.animation import animate_teeth as animate_teeth
    from gearidae.plot.animation import animate_train as animate_train
    from gearidae.plot.errors_of_teeth import tooth_errors as tooth_errors
    from gearidae.plot.teeth_view import teeth as teeth

__getattr__, __dir__, __all__ = lazy_names(__name__)
_of_studies = {
    picture.name: picture.draw
    for study in studies().values()
    for picture in study.pictures
    if picture.draw is not None
}
globals().update(_of_studies)
__all__ = sorted({*__all__, *_of_studies})
