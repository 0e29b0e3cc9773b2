"""Dynamics of rough, adhesive, monolayer-protected MEMS gears.

>>> import gearidae as gd
>>> scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
>>> ds = gd.simulate(scene)  # doctest: +SKIP

Public names are loaded on first use, so that ``import gearidae`` itself stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gearidae.lazy import lazy_names, when_imported

if TYPE_CHECKING:
    from gearidae import analysis, contact, plot, report, scene, studies, surfaces, torques, wear
    from gearidae.analysis.verdict import outcomes
    from gearidae.archive import open_archive, save
    from gearidae.archive.concat import concat
    from gearidae.errors import GearidaeError, Interrupted, SceneError, SolverError
    from gearidae.population import population
    from gearidae.report import write_report
    from gearidae.runs.simulation import simulate
    from gearidae.runs.sweeping import sweep
    from gearidae.scene import Scene, describe_key, describe_keys, dump_case, load_case, preset
    from gearidae.surfaces import surface_from
    from gearidae.torques import register_torque, torque_names, unregister_torque

__version__ = "0.2.0"

__all__ = [
    "GearidaeError",
    "Interrupted",
    "Scene",
    "SceneError",
    "SolverError",
    "__version__",
    "analysis",
    "concat",
    "contact",
    "describe_key",
    "describe_keys",
    "dump_case",
    "load_case",
    "open_archive",
    "outcomes",
    "plot",
    "population",
    "preset",
    "register_torque",
    "report",
    "save",
    "scene",
    "simulate",
    "studies",
    "surface_from",
    "surfaces",
    "sweep",
    "torque_names",
    "torques",
    "unregister_torque",
    "wear",
    "write_report",
]

# Public name -> the module it lives in; a module that is public itself maps to None.
_HOME: dict[str, str | None] = {
    "GearidaeError": "errors",
    "Interrupted": "errors",
    "Scene": "scene",
    "SceneError": "errors",
    "SolverError": "errors",
    "analysis": None,
    "concat": "archive.concat",
    "contact": None,
    "describe_key": "scene",
    "describe_keys": "scene",
    "dump_case": "scene",
    "load_case": "scene",
    "open_archive": "archive",
    "outcomes": "analysis.verdict",
    "plot": None,
    "population": "population",
    "preset": "scene",
    "register_torque": "torques",
    "report": None,
    "save": "archive",
    "scene": None,
    "simulate": "runs.simulation",
    "studies": None,
    "surface_from": "surfaces",
    "surfaces": None,
    "sweep": "runs.sweeping",
    "torque_names": "torques",
    "torques": None,
    "unregister_torque": "torques",
    "wear": None,
    "write_report": "report",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)


def _results(ds: Any) -> Any:
    """Make the accessor `ds.gearidae`, `gearidae.analysis.accessor.Results`."""
    return import_module("gearidae.analysis.accessor").Results(ds)


def _register() -> None:
    import xarray as xr

    if not hasattr(xr.Dataset, "gearidae"):
        xr.register_dataset_accessor("gearidae")(_results)  # type: ignore[no-untyped-call]


when_imported("xarray", _register)
