"""What a checkpoint keeps of a population: which asperities are joined, and a digest of all.

The block has the digest's four numbers, the number of joined asperities, each by its index among all, and zeros up to a
multiple of `WORDS`, so that its length changes seldom.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from gearidae.engine.model.state import EMPTY, Floats, Model
from gearidae.engine.population.layout import INDEX, joined_candidates
from gearidae.engine.population.restore import take_joined
from gearidae.engine.setup.checkpoint_checks import refused, require

WORDS: Final = 64
FIRST: Final = 5  # words in front of the asperities


def joined_asperities(m: Model) -> Floats:
    """Return the joined asperities of all pairs by their indices among all, in rising order."""
    indices = [
        joined_candidates(m, k)[INDEX] for k in range(m.scene.histories) if m.state.history[k].pair != EMPTY
    ]
    return np.sort(np.concatenate([np.empty(0), *indices]))


def kept_asperities(m: Model) -> Floats:
    """Return what a checkpoint keeps; nothing of other contact models."""
    if m.scene.population.flanks == 0:
        return np.empty(0)
    joined = joined_asperities(m)
    block = np.zeros(WORDS * -(-(FIRST + joined.size) // WORDS))
    block[:4], block[4] = m.scene.population.digest, joined.size
    block[FIRST : FIRST + joined.size] = joined
    return block


def asperity_words(m: Model, words: float) -> int:
    """Length of a checkpoint's block of asperities, in words; an impossible one is refused."""
    if m.scene.population.flanks == 0:
        return 0
    most = FIRST + _total(m) + WORDS
    require(0.0 < words <= most and words % WORDS == 0.0, f"{words:g} words of asperities", "a block of them")
    return int(words)


def joined_in(m: Model, block: Floats) -> Floats:
    """Return the joined asperities of a block, once they have been checked.

    Raises
    ------
    SceneError
        If they are none that a run of this scene could have left, or it had other asperities.
    """
    if m.scene.population.flanks == 0:
        return np.empty(0)
    if not np.array_equal(block[:4], m.scene.population.digest):
        raise refused("asperities_sha256", "not that of the asperities that this scene has here")
    count = block[4]
    require(
        bool(0.0 <= count <= block.size - FIRST and count % 1.0 == 0.0),
        "joined asperities",
        "a number of them",
    )
    joined = block[FIRST : FIRST + int(count)]
    whole = (joined % 1.0 == 0.0) & (joined >= 0.0) & (joined < _total(m))
    require(
        bool(whole.all() and (np.diff(joined) > 0.0).all()),
        "joined asperities",
        "indices of asperities in order",
    )
    return joined


def restore_asperities(m: Model, y: Floats, joined: Floats) -> None:
    """Let asperities be joined at the state that has been taken back.

    Raises
    ------
    SceneError
        If one is of no pair that is near.
    """
    if m.scene.population.flanks > 0:
        require(take_joined(m, y, joined) == joined.size, "joined asperities", "those of pairs that are near")


def _total(m: Model) -> int:
    return int(m.tables[m.scene.population.starts_at + m.scene.population.flanks])
