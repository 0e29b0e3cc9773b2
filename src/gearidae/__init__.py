"""Dynamics of rough, adhesive, monolayer-protected MEMS gears.

>>> import gearidae as gd
>>> scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
>>> ds = gd.simulate(scene)  # doctest: +SKIP

Public names are loaded on first use, so that ``import gearidae`` itself stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearidae import analysis, contact, plot
    from gearidae.archive import open_archive
    from gearidae.errors import GearidaeError, SceneError, SolverError
    from gearidae.scene import Scene, load_case, preset
    from gearidae.simulation import simulate
    from gearidae.sweeping import sweep

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
    "simulate",
    "sweep",
]

# Public name -> the module it lives in; a module that is public itself maps to None.
_HOME: dict[str, str | None] = {
    "GearidaeError": "gearidae.errors",
    "Scene": "gearidae.scene",
    "SceneError": "gearidae.errors",
    "SolverError": "gearidae.errors",
    "analysis": None,
    "contact": None,
    "load_case": "gearidae.scene",
    "open_archive": "gearidae.archive",
    "plot": None,
    "preset": "gearidae.scene",
    "simulate": "gearidae.simulation",
    "sweep": "gearidae.sweeping",
}


def __getattr__(name: str) -> Any:
    """Load a public name on first use (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'gearidae' has no attribute {name!r}")
    home = _HOME[name]
    value = import_module(f"gearidae.{name}") if home is None else getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """List the public names, loaded or not."""
    return sorted({*globals(), *_HOME})
