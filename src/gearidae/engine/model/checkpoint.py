"""Checkpoints: the state of a run as one vector of words, and the checks before a run resumes from one.

A checkpoint holds state only: a header (layout, scene, contact model, sizes), the record ``STATE``, the state vector
and, of an elastic contact, the rows of its nodes. Constants, offsets and addresses are made from the scene by the
process that resumes, never read. Every number is compared with what the scene allows before anything runs.
"""

from __future__ import annotations

import hashlib
from typing import Any, Final

import numpy as np

from gearidae.engine.model.state import (
    EMPTY,
    GEARS,
    MATERIALS,
    PHASE,
    SCHEDULES,
    STATE,
    Floats,
    Model,
    Record,
    assign,
)
from gearidae.engine.model.tooth_pairs import gap_and_rate
from gearidae.engine.model.torques.schedule import segment_ends
from gearidae.errors import SceneError

__all__ = ["HEADER", "depth_of", "exceeded", "pack", "scene_digest", "unpack"]

HEADER: Final = 8
"""Words in front of the state: layout, scene (four), contact model, states, words of node rows."""

_LAYOUT: Final = int(hashlib.sha256(repr(STATE.descr).encode()).hexdigest()[:8], 16)
_WORDS: Final = STATE.itemsize // 8
_SLACK: Final = 1e-6  # roughnesses, and
_SLACK_TOLERANCES: Final = 100.0  # relative tolerances: joined heights and gaps are known no better
_PHASE_HIGH: Final = 64.0  # pitches; whole ones are taken out of the phase long before
_PITCHES_HIGH: Final = 2.0**53
_DEPTHS: Final = 64
_FLAGS: Final = {0, 1}


def scene_digest(text: str) -> tuple[float, ...]:
    """Four numbers that tell one scene from another."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    return tuple(float(int(digest[8 * k : 8 * k + 8], 16)) for k in range(4))


def pack(m: Model, digest: tuple[float, ...], depth: int, y: Floats) -> Floats:
    """Put a run's state into one vector.

    Parameters
    ----------
    m : Model
    digest : tuple of four floats
        See `scene_digest`.
    depth : int
        0 for the asperity model, 1 and more for the layouts of the elastic model.
    y : ndarray, shape (n,)
        State vector.
    """
    rows = _node_rows(m)
    header = [float(_LAYOUT), *digest, float(depth), float(y.size), float(rows.size)]
    state = np.frombuffer(m.state.tobytes(), np.float64)
    return np.concatenate([header, state, y, rows])


def depth_of(checkpoint: Floats, digest: tuple[float, ...]) -> int:
    """Contact model of a checkpoint: 0 for the asperity model, 1 and more for the layouts of the elastic model.

    Raises
    ------
    SceneError
        If it is of another scene, or of another layout of the state.
    """
    if checkpoint.ndim != 1 or checkpoint.size < HEADER + _WORDS:
        raise _refused(f"{checkpoint.size} numbers", "too short to be one")
    if checkpoint[0] != float(_LAYOUT):
        raise _refused("its layout", "of another version of gearidae; run the scene again")
    if tuple(checkpoint[1:5]) != digest:
        raise _refused("its scene", "not of this scene")
    depth = checkpoint[5]
    if depth not in range(_DEPTHS):
        raise _refused(f"contact model {depth}", "not one that a run takes")
    return int(depth)


def unpack(m: Model, checkpoint: Floats, y: Floats) -> None:
    """Take a checkpoint back, once all its numbers have been checked against the scene.

    Parameters
    ----------
    m : Model
        Of the contact model that `depth_of` names; changed.
    checkpoint : ndarray
        From `pack`.
    y : ndarray, shape (n,)
        Set to the state vector.

    Raises
    ------
    SceneError
        If a number is none that a run of this scene could have left.
    """
    rows = _node_rows(m)
    if checkpoint.size != HEADER + _WORDS + y.size + rows.size or tuple(checkpoint[6:HEADER]) != (
        float(y.size),
        float(rows.size),
    ):
        raise _refused(f"{checkpoint.size} numbers", "not as many as this scene has")
    ends = np.cumsum([HEADER, _WORDS, y.size])
    state: Record = np.frombuffer(checkpoint[HEADER : ends[1]].tobytes(), STATE)[0]
    vector, nodes = checkpoint[ends[1] : ends[2]], checkpoint[ends[2] :]
    _require(bool(np.isfinite(vector).all()), "the state vector", "finite numbers")
    _require(bool(np.isfinite(nodes).all()), "the nodes", "finite numbers")
    _check_numbers(state, STATE, "")
    _check_run(m, state)
    if m.scene.kind == GEARS:
        _check_mesh(m, state, float(vector[PHASE]))
    for k in range(len(state.history)):
        _check_history(m, state, k, vector)
    assign(m.state, state)
    y[:] = vector
    rows[:] = nodes


def exceeded(checkpoint: Floats) -> bool:
    """Whether a checkpoint that `depth_of` has accepted stands where the contact model's bound has been exceeded."""
    state: Record = np.frombuffer(checkpoint[HEADER : HEADER + _WORDS].tobytes(), STATE)[0]
    return bool(state.bound_exceeded != 0)


def _node_rows(m: Model) -> Floats:
    start = m.scene.node_rows_at
    return m.rows[start : start + m.scene.node_row_length * m.scene.histories]


def _check_numbers(record: Record, dtype: np.dtype[Any], prefix: str) -> None:
    """Let every real number be finite."""
    for name in dtype.names or ():
        value, kind = record[name], dtype[name].base
        if kind.names:
            for part in np.atleast_1d(value):
                _check_numbers(part, kind, f"{prefix}{name}.")
        elif kind.kind == "f":
            _require(bool(np.isfinite(value).all()), f"{prefix}{name}", "finite")


def _check_run(m: Model, s: Record) -> None:
    """Check time, schedules, roots, energies and counters."""
    scene = m.scene
    slack = 1e-12 * scene.start  # of a start that has been through other units
    _require(scene.start - slack <= s.time <= scene.end, "time", "within the run")
    knots = m.tables[scene.knots_at : scene.knots_at + scene.knot_count]
    _require(_between(s.next_knot, knots, s.time), "next_knot", "the coming one")
    for which in range(SCHEDULES):
        times = segment_ends(scene.schedule[which], m.tables)
        _require(_between(s.segment[which], times, s.time), "segment", "that of the time")
    _require(s.slip in (-1.0, 0.0, 1.0) and (scene.dry != 0 or s.slip == 1.0), "slip", "a direction")
    _require(s.slipping in _FLAGS and s.bound_exceeded in _FLAGS, "flags", "0 or 1")
    _require(s.stop_armed in _FLAGS, "stop_armed", "0 or 1")
    _require(set(s.near.tolist()) <= _FLAGS, "near", "0 or 1")
    _require(s.last_flank in (-1, 0, 1), "last_flank", "a flank")
    _require(0 <= s.roots <= scene.root_limit and s.last_root <= s.time, "roots", "before the time")
    _check_extremes(s.extremes, float(s.time))
    sums = ("throughput", "quadrature_error", "loss_error", "peak_kinetic")
    _require(all(s.energy[name] >= 0.0 for name in sums), "energy", "positive sums")
    p = s.progress
    _require(all(p[name] >= 0 for name in p.dtype.names), "counters", "positive")
    _require(p.next_sample <= scene.samples, "next_sample", "of the run")
    if scene.samples > 1:
        spacing = (scene.end - scene.start) / (scene.samples - 1)
        due = (s.time - scene.start) / spacing
        _require(abs(p.next_sample - due) <= 2.0 + 1e-9 * s.time / spacing, "next_sample", "that of the time")


def _between(index: int, times: Floats, time: float) -> bool:
    """Whether an index counts the times that have been passed; one at this very time may wait."""
    return bool((times < time).sum() <= index <= (times <= time).sum())


def _check_extremes(e: Record, time: float) -> None:
    """Check that extremes are in order, and times of the past."""
    _require(e.begun in _FLAGS and e.held in _FLAGS, "flags of the extremes", "0 or 1")
    _require(
        e.lowest_speed <= e.highest_speed and e.smallest_force <= e.largest_force, "extremes", "in order"
    )
    counts = (e.reversals, e.mesh_exits, e.held_exits)
    _require(min(counts) >= 0 and e.held_exits <= e.mesh_exits, "counts of the extremes", "positive")
    times = (e.largest_force_time, e.smallest_force_time, e.held_time, *e.part["time"])
    _require(all(0.0 <= one <= time for one in times), "times of the extremes", "in the past")
    for part in e.part:
        _require(part.begun in _FLAGS and part.lowest <= part.highest, "parts of the extremes", "in order")
    _require(e.fall >= 0.0 and e.rise >= 0.0 and e.bottom <= e.top, "extremes since start-up", "in order")


def _check_mesh(m: Model, s: Record, phase: float) -> None:
    """Check the phase, its marks and the whole pitches taken out of it."""
    _require(abs(phase) <= _PHASE_HIGH, "phase", "within the pitches that are kept")
    whole = abs(s.turns) < _PITCHES_HIGH and s.turns % m.scene.slots == 0.0
    _require(bool(whole), "turns", "whole rounds of the histories")
    _require(abs(s.mark_low - phase) <= 2.0 and abs(s.mark_high - phase) <= 2.0, "marks", "next to the phase")
    _require(s.mark_low <= s.mark_high, "marks", "in order")


def _check_history(m: Model, s: Record, k: int, y: Floats) -> None:
    """Check one pair's history: pair, flags, and joined heights that its gap permits."""
    h, scene = s.history[k], m.scene
    used = k < scene.histories
    if h.pair == EMPTY or not used:
        _require(h.pair == EMPTY, f"history {k}", "empty")
        return
    slots, coast = int(scene.slots), int(k // scene.slots)
    if scene.kind == GEARS:
        near = abs(h.pair - y[PHASE]) <= _PHASE_HIGH + 4 * slots
        _require(
            bool(near) and k == coast * slots + (int(h.pair) & (slots - 1)), f"pair {h.pair}", "in its slot"
        )
    else:
        _require(h.pair == 0, f"pair {h.pair}", "the roller")
    _require(h.direction in (-1.0, 0.0, 1.0), "direction", "a direction")
    flags = [h.in_contact, h.loaded, h.stretched, *h.fully_stretched.tolist()]
    _require(set(flags) <= _FLAGS, "flags of a history", "0 or 1")
    _require(h.length >= 0.0, "length", "positive")
    gap = float(gap_and_rate(m, coast, int(h.pair), y)[0])
    slack = (_SLACK + _SLACK_TOLERANCES * scene.rtol) * (1.0 + abs(h.gap))
    if gap < scene.cutoff:
        _require(abs(gap - h.gap) <= slack, "gap of a history", "that of its pair")
    if h.gap >= scene.cutoff or scene.nodes > 0:
        return
    for material in range(MATERIALS):
        limit, joined = scene.material[material].stretch_limit, h.joined[material]
        if limit == 0.0:
            continue
        _require(
            h.direction <= 0.0 or joined <= h.gap + slack, "joined", "below the gap of a pair that opens"
        )
        _require(
            h.direction >= 0.0 or joined >= h.gap - limit - slack,
            "joined",
            "within reach of a pair that closes",
        )


def _require(condition: bool, what: str, allowed: str) -> None:
    if not condition:
        raise _refused(what, f"not what a run of this scene leaves there: it must be {allowed}")


def _refused(what: str, why: str) -> SceneError:
    return SceneError("checkpoint", what, why)
