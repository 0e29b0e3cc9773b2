"""Laws of a mesh and of its pairs that know gaps and rates alone: they declare keys, constants and losses.

Laws of contacts need tables of asperities, which whoever reads a file must not load. They stand in the engine, with the
list of all laws of a pair and their sums (`gearidae.engine.laws.pairs`).
"""

from __future__ import annotations

from typing import Any, Final

from gearidae.laws.pair.damping import DAMPING
from gearidae.laws.pair.film import FILM
from gearidae.laws.pair_law import PairLaw

MESH_LAWS: Final[tuple[PairLaw, ...]] = (DAMPING, FILM)
"""In the order of additions."""


def number_of_mesh(scene: Any, name: str) -> float:
    """Number of a key of these laws in a scene's mesh."""
    return float(getattr(scene.mesh, name))


def has_mesh_law(scene: Any, law: PairLaw) -> bool:
    """Whether the mesh of a scene has one of these laws."""
    return scene.mesh is not None and law.acts(scene.mesh)
