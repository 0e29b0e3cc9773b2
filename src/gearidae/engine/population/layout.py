"""Where a population lies among a model's tables and rows.

Tables hold all asperities of all flanks, one flank after the other and each in the order of positions; an asperity is
known by its index among them. Rows hold for each pair's history its candidates, those that may join or detach soon:
`FIELDS` columns of as many numbers as a flank has asperities at most.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.engine.model.state import Floats, Model

# columns of the candidates
INDEX: Final = 0  # of the asperity among all,
ARC: Final = 1  # its position on the flank,
HEIGHT: Final = 2  # its height less the recess of its material,
KIND: Final = 3  # and where the numbers of its kind are
SIGN: Final = 4  # 1 if it is joined, -1 if it is free,
BOUND: Final = 5  # and the distance of detachment or of joining
JOINED: Final = 6  # indices among the candidates of those that are joined, in the order of positions
REMEMBERED: Final = 7  # asperities that are joined while candidates are chosen anew
FIELDS: Final = 8

# numbers of a kind: of asperities of one material and radius
K_TABLE: Final = 0  # where the table of its law begins
K_SCALE: Final = 1  # roughness over the law's unit of length
K_LOAD: Final = 2  # units of the law's load and energy
K_ENERGY: Final = 3
K_JOIN: Final = 4  # distances of joining and detachment, over the roughness
K_DETACH: Final = 5
K_OFFSET: Final = 6  # recess of its material
K_MATERIAL: Final = 7  # index of its material
K_FRICTION: Final = 8  # coefficient of friction, or shear strength times the unit of area
K_AREA: Final = 9  # where the table of its contact area begins, for a shear strength
KINDS: Final = 10


@compiled(inline=True)
def column(m: Model, k: int, field: int) -> np.uintp:
    """Index of a column of the k-th history's candidates among the rows."""
    population = m.scene.population
    return np.uintp(population.rows_at + (k * FIELDS + field) * population.capacity)


def joined_candidates(m: Model, k: int) -> Floats:
    """Return the columns of the joined candidates of the k-th history, shape (FIELDS, joined)."""
    population = m.scene.population
    start = population.rows_at + k * FIELDS * population.capacity
    columns = m.rows[start : start + FIELDS * population.capacity].reshape(FIELDS, -1)
    return columns[:, columns[JOINED, : m.work.contact[k].joined].astype(np.int64)]


@compiled
def flank_of(m: Model, flank: int, pair: int) -> int:
    """Number of the pinion's flank that a pair has, among all; 0 for a roller."""
    if m.scene.pinion_teeth == 0.0:
        return 0
    return 2 * int((pair + m.state.whole_pitches) % m.scene.pinion_teeth) + flank
