"""Surfaces: from a measured map of heights to the three numbers of the rough contact; the library of named ones.

Reads height maps and scenes' keys; needs neither the contact laws nor the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.surfaces.files import read_scan as read_scan
    from gearidae.surfaces.measured import MeasuredSurface as MeasuredSurface
    from gearidae.surfaces.measured import surface_from as surface_from
    from gearidae.surfaces.moments import Asperities as Asperities
    from gearidae.surfaces.moments import from_moments as from_moments
    from gearidae.surfaces.named import library as library
    from gearidae.surfaces.synthetic import gaussian_map as gaussian_map

__getattr__, __dir__, __all__ = lazy_names(__name__)
