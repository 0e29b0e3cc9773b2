r"""Attraction of a pair's flanks across their gap: the closed form of `gearidae.contact.attraction`, scaled.

Per unit length a material with the constant c pulls with :math:`-c\,h^{-5/2}`, h its own gap. It would do so at any
distance: the pull at the cut-off is taken off everywhere, so that force and energy end there continuously and nothing
is lost where a pair leaves.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model


class Pull(NamedTuple):
    """Attraction of one material per unit length: force, its slope in the gap, and energy."""

    force: float
    slope: float
    energy: float


@compiled
def attraction(m: Model, material: int, gap: float) -> Pull:
    """Attraction that a material of a pair would have if it covered everything, or with its share in the constant."""
    own = m.scene.material[material]
    c, far = own.attraction, m.scene.cutoff + own.gap_offset
    if c == 0.0 or gap >= m.scene.cutoff:
        return Pull(0.0, 0.0, 0.0)
    h = gap + own.gap_offset
    near = max(h, m.scene.attraction_floor)
    pull, last = c / (near * near * math.sqrt(near)), c / (far * far * math.sqrt(far))
    slope = 2.5 * pull / near if h > m.scene.attraction_floor else 0.0
    energy = -2.0 / 3.0 * pull * near + pull * (h - near)
    return Pull(last - pull, slope, energy + 2.0 / 3.0 * last * far - last * (h - far))
