"""Seeds of populations: numbered from the scene's own on, and not drawn from a distribution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.specimen import SEED
from gearidae.errors import SceneError
from gearidae.scene.group import shorten

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.studies.design import Design

SEEDS: Final = "seeds"
"""Text that stands for a distribution of the key."""
NO_INDEX: Final = (
    "contact.seed has no index, because it is no continuous input: the share of the variance that the keys leave over "
    "is the scatter between the gears of one design"
)


def without_seeds(scene: Scene, vary: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the keys of an ensemble that have distributions: all but the seed, which is numbered.

    Raises
    ------
    SceneError
        If the seed is given a distribution, or the scene has no population.
    """
    if not isinstance(vary, Mapping) or SEED not in vary:
        return vary
    given = vary[SEED]
    if given != SEEDS:
        allowed = f'must be "{SEEDS}": the seeds of the members are numbered from the scene\'s own on'
        raise SceneError(SEED, shorten(given), allowed)
    if not scene.contact.is_discrete:
        raise SceneError(SEED, given, 'needs contact.roughness = "discrete": statistical ones draw nothing')
    return {key: text for key, text in vary.items() if key != SEED}


def seed_numbers(scene: Scene, drawn: Design) -> NDArray[np.int64]:
    """Seeds of the members of a design, shape (members,).

    Rows of the matrices A and B of a design for Sobol' indices have seeds of their own. A row of a matrix AB has the
    seed of the row of A, as it differs from it by one key alone.
    """
    rows = int(drawn.row.max()) + 1
    return np.asarray(scene.contact.seed + drawn.row + rows * (drawn.matrix == "B"), dtype=np.int64)
