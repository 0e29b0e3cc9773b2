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
    from gearidae import analysis as analysis
    from gearidae import contact as contact
    from gearidae import plot as plot
    from gearidae import report as report
    from gearidae import scene as scene
    from gearidae import studies as studies
    from gearidae import surfaces as surfaces
    from gearidae import testing as testing
    from gearidae import torques as torques
    from gearidae import wear as wear
    from gearidae.analysis.verdict import outcomes as outcomes
    from gearidae.archive import open_archive as open_archive
    from gearidae.archive import save as save
    from gearidae.archive.concat import concat as concat
    from gearidae.citing import cite as cite
    from gearidae.errors import GearidaeError as GearidaeError
    from gearidae.errors import Interrupted as Interrupted
    from gearidae.errors import SceneError as SceneError
    from gearidae.errors import SolverError as SolverError
    from gearidae.populations import population as population
    from gearidae.report import explore as explore
    from gearidae.report import write_report as write_report
    from gearidae.runs.compile_ahead import compile as compile  # noqa: A004
    from gearidae.runs.simulation import simulate as simulate
    from gearidae.runs.sweeping import sweep as sweep
    from gearidae.scene import Scene as Scene
    from gearidae.scene import describe_key as describe_key
    from gearidae.scene import describe_keys as describe_keys
    from gearidae.scene import dump_case as dump_case
    from gearidae.scene import load_case as load_case
    from gearidae.scene import preset as preset
    from gearidae.scene.combinations import combinations as combinations
    from gearidae.scene.pitch_errors import pitch_errors as pitch_errors
    from gearidae.studies.products import open as open  # noqa: A004
    from gearidae.surfaces import surface_from as surface_from
    from gearidae.testing.comparison import compare as compare
    from gearidae.torques import register_torque as register_torque
    from gearidae.torques import torque_names as torque_names
    from gearidae.torques import unregister_torque as unregister_torque

__version__ = "0.3.0"

__getattr__, __dir__, __all__ = lazy_names(__name__)


def _results(ds: Any) -> Any:
    """Make the accessor `ds.gearidae`, `gearidae.studies.results.Results`."""
    return import_module("gearidae.studies.results").Results(ds)


def _register() -> None:
    import xarray as xr

    if not hasattr(xr.Dataset, "gearidae"):
        xr.register_dataset_accessor("gearidae")(_results)  # type: ignore[no-untyped-call]


when_imported("xarray", _register)
