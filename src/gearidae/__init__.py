"""Dynamics of rough, adhesive, monolayer-protected MEMS gears.

>>> import gearidae as gd
>>> scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
>>> ds = gd.simulate(scene)  # doctest: +SKIP

Public names are loaded on first use, so that ``import gearidae`` itself stays cheap.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae import analysis, contact, plot, studies
    from gearidae.archive import open_archive
    from gearidae.errors import GearidaeError, SceneError, SolverError
    from gearidae.runs.simulation import simulate
    from gearidae.runs.sweeping import sweep
    from gearidae.scene import Scene, load_case, preset
    from gearidae.torques import register_torque, unregister_torque

__version__ = "0.1.0"

__all__ = [
    "GearidaeError",
    "Scene",
    "SceneError",
    "SolverError",
    "__version__",
    "analysis",
    "contact",
    "load_case",
    "open_archive",
    "plot",
    "preset",
    "register_torque",
    "simulate",
    "studies",
    "sweep",
    "unregister_torque",
]

# Public name -> the module it lives in; a module that is public itself maps to None.
_HOME: dict[str, str | None] = {
    "GearidaeError": "errors",
    "Scene": "scene",
    "SceneError": "errors",
    "SolverError": "errors",
    "analysis": None,
    "contact": None,
    "load_case": "scene",
    "open_archive": "archive",
    "plot": None,
    "preset": "scene",
    "register_torque": "torques",
    "simulate": "runs.simulation",
    "studies": None,
    "sweep": "runs.sweeping",
    "unregister_torque": "torques",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
