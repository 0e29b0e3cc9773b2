"""Checkpoints: the state of a run as one vector of words, taken back once it has been checked.

A checkpoint holds state only: a header (layout, scene, contact model, sizes), the record ``STATE``, the state vector,
of an elastic contact what its nodes remember, the exposures of the flanks where they are kept, and of a population the
asperities that are joined, with a digest of all. Constants, offsets
and addresses are made from the scene by the process that resumes, never read, and so is what follows from the state.
What compiled code uses as an index, a count or a flag is bounded (`gearidae.engine.setup.checkpoint_checks`) before
anything runs.
"""

from __future__ import annotations

import hashlib
from typing import Final

import numpy as np

from gearidae.engine.elastic.kept_rows import KEPT_ROWS, kept_rows, restore_rows
from gearidae.engine.model.state import (
    EMPTY,
    MOTION,
    STATE,
    Floats,
    Model,
    Record,
    assign,
    copied,
    empty_history,
)
from gearidae.engine.observers.exposures.bins import exposures_of
from gearidae.engine.setup.checkpoint_checks import check, refused
from gearidae.engine.setup.kept_asperities import asperity_words, joined_in, kept_asperities

HEADER: Final = 8
"""Words in front of the state: layout, scene (four), contact model, states, words of node rows and exposures."""

_LAYOUT: Final = int(hashlib.sha256(repr((STATE.descr, MOTION, KEPT_ROWS)).encode()).hexdigest()[:8], 16)
_WORDS: Final = STATE.itemsize // 8
_DEPTHS: Final = 64
_NOTHING: Final = empty_history()


def scene_digest(text: str) -> tuple[float, ...]:
    """Four numbers that identify a scene."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    return tuple(float(int(digest[8 * k : 8 * k + 8], 16)) for k in range(4))


def pack(m: Model, digest: tuple[float, ...], depth: int, y: Floats) -> Floats:
    """Put a run's state into one vector.

    Histories that are about no pair are written as empty: what they held last is read by nothing.

    Parameters
    ----------
    digest : tuple of four floats
        See `scene_digest`.
    depth : int
        0 for the asperity model, 1 and more for the layouts of the elastic model.
    y : ndarray, shape (n,)
        State vector.
    """
    state = copied(m.state)
    histories = state.history
    histories[histories["pair"] == EMPTY] = _NOTHING
    rows = np.concatenate([kept_rows(m), exposures_of(m), kept_asperities(m)])
    header = [float(_LAYOUT), *digest, float(depth), float(y.size), float(rows.size)]
    return np.concatenate([header, np.frombuffer(state.tobytes(), np.float64), y, rows])


def depth_of(checkpoint: Floats, digest: tuple[float, ...]) -> int:
    """Contact model of a checkpoint: 0 for the asperity model, 1 and more for the layouts of the elastic model.

    Raises
    ------
    SceneError
        If it is of another scene, or of another layout of the state.
    """
    if checkpoint.ndim != 1 or checkpoint.size < HEADER + _WORDS:
        raise refused(f"{checkpoint.size} numbers", "too short to be one")
    if checkpoint[0] != float(_LAYOUT):
        raise refused("its layout", "of another version of gearidae; run the scene again")
    if tuple(checkpoint[1:5]) != digest:
        raise refused("its scene", "not of this scene")
    depth = checkpoint[5]
    if depth not in range(_DEPTHS):
        raise refused(f"contact model {depth}", "not one that a run takes")
    return int(depth)


def unpack(m: Model, checkpoint: Floats, y: Floats) -> Floats:
    """Take a checkpoint back, once its bounds have been checked.

    Parameters
    ----------
    m : Model
        Of the contact model that `depth_of` names; changed.
    checkpoint : ndarray
        From `pack`.
    y : ndarray, shape (n,)
        Set to the state vector.

    Returns
    -------
    ndarray
        Joined asperities of a population, which `restore_asperities` takes.

    Raises
    ------
    SceneError
        If it is of another size, or `check` refuses it.
    """
    nodes = kept_rows(m).size
    count = (
        nodes + int(m.scene.exposures) + asperity_words(m, checkpoint[HEADER - 1] - nodes - m.scene.exposures)
    )
    if checkpoint.size != HEADER + _WORDS + y.size + count or tuple(checkpoint[6:HEADER]) != (
        float(y.size),
        float(count),
    ):
        raise refused(f"{checkpoint.size} numbers", "not as many as this scene has")
    ends = np.cumsum([HEADER, _WORDS, y.size])
    state = _state_of(checkpoint)
    # copies: compiled functions take arrays that may be written only
    vector, rows = checkpoint[ends[1] : ends[2]].copy(), checkpoint[ends[2] :].copy()
    rows, exposures, asperities = np.split(rows, [nodes, nodes + int(m.scene.exposures)])
    joined = joined_in(m, asperities)
    check(m, state, vector, rows, exposures)
    assign(m.state, state)
    y[:] = vector
    restore_rows(m, rows)
    exposures_of(m)[:] = exposures
    return joined


def exceeded(checkpoint: Floats) -> bool:
    """Whether a checkpoint that `depth_of` has accepted stands where the contact model's bound has been exceeded."""
    return bool(_state_of(checkpoint).bound_exceeded != 0)


def elastic_so_far(checkpoint: Floats) -> bool:
    """Whether bodies have been elastic in the run of a checkpoint that `depth_of` has accepted."""
    return bool(_state_of(checkpoint).deep_exits >= 0)


def rigid_again(checkpoint: Floats) -> bool:
    """Whether a checkpoint that `depth_of` has accepted stands where elastic contacts have been light for long."""
    return bool(_state_of(checkpoint).rigid_again != 0)


def _state_of(checkpoint: Floats) -> Record:
    return np.frombuffer(checkpoint[HEADER : HEADER + _WORDS].tobytes(), STATE)[0]
