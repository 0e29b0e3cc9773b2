"""Surfaces that were measured: from a map of heights to the three numbers of the rough contact.

Reads height maps and scenes' keys; needs neither the contact laws nor the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.surfaces.files import read_scan
    from gearidae.surfaces.measured import MeasuredSurface, surface_from
    from gearidae.surfaces.moments import Asperities, from_moments
    from gearidae.surfaces.synthetic import gaussian_map

__all__ = ["Asperities", "MeasuredSurface", "from_moments", "gaussian_map", "read_scan", "surface_from"]

_HOME = {
    "Asperities": "moments",
    "MeasuredSurface": "measured",
    "from_moments": "moments",
    "gaussian_map": "synthetic",
    "read_scan": "files",
    "surface_from": "measured",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
