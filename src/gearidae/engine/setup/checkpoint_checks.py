"""What a run of a scene can leave in a checkpoint: every number of ``STATE`` is compared with that.

Numbers that follow from others are compared with them (marks with the phase, gaps and flags of the histories with the
state vector, the adhered energy with the joined height); numbers that do not are held to what the scene, the time and
the sums allow. Slacks are those of the integration: gaps and rates are known to the tolerance, events to the root
search.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.contact.kernels.law import loading_value
from gearidae.engine.energy.kinetic import kinetic_energy
from gearidae.engine.events.mesh_marks import MARKS, first_mark
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
    empty_history,
)
from gearidae.engine.pairs.tooth_pairs import gap_and_rate
from gearidae.engine.torques.schedule import segment_ends
from gearidae.errors import SceneError

__all__ = ["check_histories", "check_state", "current_pairs", "refused", "require"]

_SLACK: Final = 1e-6  # roughnesses, and
_SLACK_TOLERANCES: Final = 100.0  # relative tolerances: joined heights and gaps are known no better
_SLACK_RATE: Final = (
    1e-3  # of the fastest motion so far: a gap's rate where its turning point has been located
)
_TAKEN_OVER: Final = (
    1.0  # roughnesses: what the elastic model takes over from the asperity model, which has no deflection
)
_PHASE_HIGH: Final = 64.0  # pitches; whole ones are taken out of the phase long before
_WHOLE_HIGH: Final = 2**53
"""Counters and whole pitches beyond which a double no longer counts."""
_LARGEST: Final = 1e200  # squares of what is really there are still finite
_ENERGY_SHARE: Final = 1e6
"""Times what has flowed through the energy balance: no work or loss is more, being a part of it but for the errors of
a run that is no longer sound."""
_JOINED_HIGH: Final = 1e6
"""Roughnesses: a step may have gone far below the tables before that was noticed."""
_LOSSES_HIGH: Final = 1e3  # of one asperity, per unit of length: the deepest contact has joined some ten
_FLAGS: Final = {0, 1}
_WORKS: Final = ("drive_work", "drag_loss", "dry_loss", "damping_loss", "adhesion_loss", "radius_work")


def require(condition: bool, what: str, allowed: str) -> None:
    """Refuse a checkpoint whose `what` is not what is allowed there."""
    if not condition:
        raise refused(what, f"not what a run of this scene leaves there: it must be {allowed}")


def refused(what: str, why: str) -> SceneError:
    """Return the error for a checkpoint that is not taken."""
    return SceneError("checkpoint", what, why)


def check_state(m: Model, state: Record, y: Floats) -> None:
    """Check all of a state but its histories.

    Parameters
    ----------
    m : Model
        Of the scene.
    state : record
        ``STATE`` of the checkpoint.
    y : ndarray, shape (n,)
        Its state vector; finite.

    Raises
    ------
    SceneError
        If a number is none that a run of this scene could have left.
    """
    _check_numbers(state, STATE, "")
    _check_run(m, state)
    if m.scene.follow.balance:
        _check_energy(m, state, y)
    if m.scene.kind == GEARS:
        _check_mesh(m, state, float(y[PHASE]))


def check_histories(m: Model, state: Record, y: Floats) -> None:
    """Check the histories of a state that `check_state` has accepted; parameters and errors as there."""
    history, count = state.history, int(m.scene.histories)
    used = (history["pair"] != EMPTY) & (np.arange(history.size) < count)
    # empty histories are compared bytewise, in one operation
    texts = np.frombuffer(history.tobytes(), np.uint8).reshape(history.size, -1)
    filled = ~used & (texts != np.frombuffer(empty_history().tobytes(), np.uint8)).any(axis=1)
    require(not filled.any(), f"history {int(filled.argmax())}", "empty")
    for k in np.flatnonzero(used).tolist():
        h, coast = history[k], int(k // m.scene.slots)
        require(state.near[coast] != 0, "near", "1 where a pair is remembered")
        _check_pair(m, h, k, coast, y)
        _check_flags(h)
        _check_adhered(m, h)
        if _within_reach(m, h, coast, y):
            _check_current(m, state, h, coast, y)


def current_pairs(m: Model, state: Record, y: Floats) -> NDArray[np.bool_]:
    """Histories of pairs that were within reach at the last accepted time, shape (histories,)."""
    found = np.zeros(int(m.scene.histories), bool)
    for k in np.flatnonzero(state.history["pair"][: found.size] != EMPTY):
        found[k] = _within_reach(m, state.history[k], int(k // m.scene.slots), y)
    return found


def _within_reach(m: Model, h: Record, coast: int, y: Floats) -> bool:
    """Whether a pair is on the path of contact or so near that there is a force: its history is that of the state."""
    if m.scene.kind != GEARS:
        return True
    along = m.scene.coast_phase + h.pair - y[PHASE] if coast else y[PHASE] - h.pair
    on_path = 0.0 <= along <= m.scene.contact_ratio
    return bool(on_path or gap_and_rate(m, coast, int(h.pair), y)[0] < m.scene.cutoff)


# -- the run ---------------------------------------------------------------------------------------------------------


def _check_numbers(record: Record, dtype: np.dtype[Any], prefix: str) -> None:
    """Let every real number be finite, and none so large that its square is not."""
    for name in dtype.names or ():
        value, kind = record[name], dtype[name].base
        if kind.names:
            if np.ndim(value) > 0:
                _check_columns(value, kind, f"{prefix}{name}.")
            else:
                _check_numbers(value, kind, f"{prefix}{name}.")
        elif kind.kind == "f":
            require(bool((np.abs(value) < _LARGEST).all()), f"{prefix}{name}", "finite")


def _check_columns(records: Record, dtype: np.dtype[Any], prefix: str) -> None:
    """Check the real numbers of an array of records, a field of all at once."""
    for name in dtype.names or ():
        if dtype[name].base.kind == "f":
            require(bool((np.abs(records[name]) < _LARGEST).all()), f"{prefix}{name}", "finite")


def _check_run(m: Model, s: Record) -> None:
    """Check time, schedules, roots, flags, extremes and counters."""
    scene = m.scene
    slack = 1e-12 * scene.start  # of a start that has been through other units
    require(scene.start - slack <= s.time <= scene.end, "time", "within the run")
    knots = m.tables[scene.knots_at : scene.knots_at + scene.knot_count]
    require(_between(s.next_knot, knots, s.time), "next_knot", "the coming one")
    for which in range(SCHEDULES):
        times = segment_ends(scene.schedule[which], m.tables)
        require(_between(s.segment[which], times, s.time), "segment", "that of the time")
    require(s.slip in (-1.0, 0.0, 1.0) and (scene.dry != 0 or s.slip == 1.0), "slip", "a direction")
    require(s.slipping in _FLAGS and s.bound_exceeded in _FLAGS, "flags", "0 or 1")
    require(s.stop_armed in _FLAGS, "stop_armed", "0 or 1")
    counts = (s.asperity_detachments, s.asperity_onsets, s.cycle_events, _WHOLE_HIGH)
    require(min(counts) >= 0 and max(counts) == _WHOLE_HIGH, "counts of asperities", "positive")
    require(-1 <= s.deep_exits <= s.extremes.mesh_exits, "deep_exits", "mesh exits")
    may_return = scene.nodes > 0 and scene.light_gap < math.inf
    require(
        s.light == 0 or (s.light == 1 and may_return),
        "light",
        "0, or 1 where a run may return to rigid bodies",
    )
    require(set(s.near.tolist()) <= _FLAGS, "near", "0 or 1")
    require(s.last_flank in (-1, 0, 1), "last_flank", "a flank")
    require(0 <= s.roots <= scene.root_limit and s.last_root <= s.time, "roots", "before the time")
    _check_extremes(s.extremes, float(s.time))
    p = s.progress
    require(all(0 <= p[name] <= _WHOLE_HIGH for name in p.dtype.names), "counters", "positive")
    require(p.next_sample <= scene.samples, "next_sample", "of the run")
    if scene.samples > 1:
        spacing = (scene.end - scene.start) / (scene.samples - 1)
        due = (s.time - scene.start) / spacing
        require(abs(p.next_sample - due) <= 2.0 + 1e-9 * s.time / spacing, "next_sample", "that of the time")


def _between(index: int, times: Floats, time: float) -> bool:
    """Whether an index counts the times that have been passed; one at this very time may wait."""
    return bool((times < time).sum() <= index <= (times <= time).sum())


def _check_extremes(e: Record, time: float) -> None:
    """Check that extremes are in order, and times of the past."""
    require(e.begun in _FLAGS and e.is_stuck in _FLAGS, "flags of the extremes", "0 or 1")
    require(e.lowest_speed <= e.highest_speed and e.smallest_force <= e.largest_force, "extremes", "in order")
    counts = (e.reversals, e.mesh_exits, e.stuck_exits, e.turn_backs)
    require(
        min(counts) >= 0 and max(counts) <= _WHOLE_HIGH and e.stuck_exits <= e.mesh_exits,
        "counts of the extremes",
        "positive",
    )
    times = (
        *(e.largest_force_time, e.smallest_force_time, e.stuck_time, e.turn_back_time, e.adhering),
        *e.part["time"],
    )
    require(all(0.0 <= one <= time for one in times), "times of the extremes", "in the past")
    for part in e.part:
        require(part.begun in _FLAGS and part.lowest <= part.highest, "parts of the extremes", "in order")
    require(e.fall >= 0.0 and e.rise >= 0.0 and e.bottom <= e.top, "extremes since start-up", "in order")


def _check_energy(m: Model, s: Record, y: Floats) -> None:
    """Check the sums of the energy balance against each other and against the present motion."""
    e = s.energy
    sums = ("throughput", "quadrature_error", "loss_error", "peak_kinetic", "start_kinetic")
    require(all(e[name] >= 0.0 for name in sums), "energy", "positive sums")
    # factors of 2 are above what is lost to quadrature and rounding
    require(
        kinetic_energy(m, y) <= 2.0 * e.peak_kinetic + _SLACK, "peak_kinetic", "no less than the present one"
    )
    require(e.start_kinetic <= 2.0 * e.peak_kinetic, "start_kinetic", "no more than the largest")
    require(e.peak_kinetic <= 2.0 * e.throughput + _SLACK, "peak_kinetic", "part of what has been exchanged")
    most = _ENERGY_SHARE * (1.0 + e.throughput + abs(e.start_stored) + abs(e.model_change))
    for name in _WORKS:
        require(abs(e[name]) <= most, name, "of the order of what has been exchanged")


def _check_mesh(m: Model, s: Record, phase: float) -> None:
    """Check the phase, its marks and the whole pitches taken out of it."""
    require(abs(phase) <= _PHASE_HIGH, "phase", "within the pitches that are kept")
    whole = abs(s.turns) < _WHOLE_HIGH and s.turns % m.scene.slots == 0.0
    require(bool(whole), "turns", "whole rounds of the histories")
    slack = _SLACK + _SLACK_TOLERANCES * m.scene.rtol
    low, high = s.mark_low, s.mark_high
    require(phase - 1.0 - slack <= low <= phase + slack, "mark_low", "that before the phase")
    require(phase - slack <= high <= phase + 1.0 + slack, "mark_high", "that behind the phase")
    for mark in (low, high):
        apart = [mark - first_mark(m, kind) for kind in range(MARKS)]
        off = min(abs(one - round(one)) for one in apart)
        require(off <= _SLACK, "marks", "mesh entries or exits")


# -- histories -------------------------------------------------------------------------------------------------------


def _check_pair(m: Model, h: Record, k: int, coast: int, y: Floats) -> None:
    """Check that a history is about a pair that has this place."""
    if m.scene.kind != GEARS:
        require(h.pair == 0, f"pair {h.pair}", "the roller")
        return
    slots = int(m.scene.slots)
    near = abs(h.pair - y[PHASE]) <= _PHASE_HIGH + 4 * slots
    require(near and k == coast * slots + (int(h.pair) & (slots - 1)), f"pair {h.pair}", "in its slot")


def _check_flags(h: Record) -> None:
    """Check the flags of a history, and that nothing lags while nothing joins."""
    require(h.direction in (-1.0, 0.0, 1.0), "direction", "a direction")
    flags = [h.in_contact, h.loaded, h.stretched, *h.fully_stretched.tolist()]
    require(set(flags) <= _FLAGS, "flags of a history", "0 or 1")
    require(not any(h.fully_stretched) or h.direction > 0.0, "fully_stretched", "0 unless the pair opens")
    require(h.direction < 0.0 or h.lag == h.lag_power == h.lag_rate == 0.0, "lag", "0 unless the pair closes")
    require(0.0 <= h.length <= _LARGEST, "length", "positive")
    require(bool((np.abs(h.joined) <= _JOINED_HIGH).all()), "joined", "within reach")


def _check_adhered(m: Model, h: Record) -> None:
    """Check the energy of what is joined against the joined height; that of an elastic contact is read by nothing."""
    for material in range(MATERIALS):
        own = m.scene.material[material]
        number = 0.0
        if own.stretch_limit > 0.0:
            number = loading_value(m.tables, own.number_at, h.joined[material] + own.gap_offset)[0]
        expected, found = -float(own.joining_energy) * number, float(h.adhered_energy[material])
        if m.scene.nodes > 0:
            fits = -_LOSSES_HIGH * own.joining_energy <= found <= 0.0
        else:
            # where it first came within reach, nothing was adhered yet
            fits = math.isclose(found, expected, rel_tol=1e-9)
            fits |= found == 0.0 and h.joined[material] >= m.scene.cutoff
        require(bool(fits), "adhered_energy", "that of the joined height")


def _check_current(m: Model, s: Record, h: Record, coast: int, y: Floats) -> None:
    """Check the history of a pair within reach against its gap, which the state vector has."""
    gap, rate = (float(one) for one in gap_and_rate(m, coast, int(h.pair), y))
    slack = (_SLACK + _SLACK_TOLERANCES * m.scene.rtol) * (1.0 + abs(gap))
    require(abs(gap - h.gap) <= slack, "gap of a history", "that of its pair")
    kinetic = max(float(s.energy.peak_kinetic), float(kinetic_energy(m, y)))
    fastest = math.sqrt(2.0 * kinetic * _inverse_mass(m))
    slack_rate = (_SLACK_RATE + _SLACK_TOLERANCES * m.scene.rtol) * (1.0 + abs(rate) + fastest)
    require(abs(rate - h.gap_rate) <= slack_rate, "gap_rate", "that of its pair")
    if gap >= m.scene.cutoff or m.scene.population.flanks != 0:
        return
    require(rate * h.direction >= -slack_rate, "direction", "that of the gap's rate")
    # the elastic model has contact begin where deflected bodies do, and takes flags over from a model without
    other = slack + (_TAKEN_OVER if m.scene.nodes > 0 else 0.0)
    touching = gap - m.scene.contact_gap
    require(touching <= other if h.in_contact else touching >= -other, "in_contact", "that of the gap")
    if m.scene.nodes == 0:
        _check_joined(m, h, gap, slack)


def _inverse_mass(m: Model) -> float:
    """Inverse of the smallest mass of those that move."""
    return float(max(m.scene.pinion_inverse_mass, m.scene.gear_inverse_mass))


def _check_joined(m: Model, h: Record, gap: float, slack: float) -> None:
    """Check joined heights of the asperity model: those of the play operator, with the flag of full stretch."""
    for material in range(MATERIALS):
        limit, joined = float(m.scene.material[material].stretch_limit), float(h.joined[material])
        if limit == 0.0:
            continue
        require(h.direction <= 0.0 or joined <= gap + slack, "joined", "below the gap of a pair that opens")
        require(
            h.direction >= 0.0 or joined >= gap - limit - slack,
            "joined",
            "within reach of a pair that closes",
        )
        stretched = gap - joined - limit
        if h.direction > 0.0:
            fits = stretched >= -slack if h.fully_stretched[material] else stretched <= slack
            require(fits, "fully_stretched", "1 where the gap is beyond the stretch limit")
