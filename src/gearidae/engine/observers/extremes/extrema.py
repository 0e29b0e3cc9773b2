"""The extremes of a run: followed from a start, over accepted times and events."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.contact.history import extreme_gap
from gearidae.engine.model.checkpoint_record import WINDOWS
from gearidae.engine.model.state import LOAD, PHASE, Floats, Model, Record, U, V, W
from gearidae.engine.motion.observe import separation
from gearidae.engine.observers.extremes.forces import first_force, follow_force, force_of_motion, note_corner
from gearidae.engine.observers.extremes.speeds import (
    come_to_stand,
    follow_speed,
    is_pulled_back,
    next_part,
    note_hold,
    note_speed,
)
from gearidae.engine.observers.standing import tracking as standing
from gearidae.engine.pairs.tooth_pairs import rigid_separation
from gearidae.laws.frictions import resists


@compiled(inline=True)
def step(
    m: Model, t: float, y: Floats, yp: Floats, event: bool, between: tuple[Floats, Floats], force: float
) -> None:
    """Follow the extremes to an accepted time, before its events are handled.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State and rates there.
    event : bool
        Whether something happens there: the force may have a corner, over which no polynomial is laid.
    between : tuple of two ndarrays, shape (n,)
        Work space.
    force : float
        Along the line of action there, if friction has asked for it; else NaN.
    """
    k = m.work.track
    if t > k.time:
        here = k.last + 1 if k.last < 2 else 0
        _set_point(m, here, t, y, yp, force)
        last, now = k.point[k.last], k.point[here]
        if m.scene.follow.gear != 0:
            follow_speed(m, last, now, y)
            standing.step(m, here, y)
        _follow_separation(m, last, now, y)
        if k.smooth > 1:
            follow_force(m, k.point[k.last - 1 if k.last > 0 else 2], last, now, between)
        k.time, k.last = t, here
        k.smooth += 1
    if event:
        k.smooth = 1
        note_corner(m, k.point[k.last], y)
        note_present(m, y)


@compiled(inline=True)
def _set_point(m: Model, i: int, t: float, y: Floats, yp: Floats, force: float) -> None:
    p = m.work.track.point[i]
    p.time, p.force = t, force_of_motion(m, t, y, yp, force)
    p.travel, p.travel_rate, p.travel_acceleration = y[U], y[V], yp[V]
    p.speed, p.speed_rate, p.position = y[W], yp[W], y[PHASE] + m.state.whole_pitches


@compiled
def note_present(m: Model, y: Floats) -> None:
    """Note a state as it is: until an extremum is passed it may be one."""
    if m.state.extremes.begun == 0:
        return
    note_speed(m, y[W])
    _note_separation(m, separation(m, y))


@compiled
def resume(m: Model, t: float, y: Floats) -> None:
    """Note that the gear has been brought to rest at once, and that a law of its shaft holds it."""
    p = m.work.track.point[m.work.track.last]
    if m.scene.follow.gear != 0:
        standing.resume(m, t, y)
    if y[W] <= 0.0 < p.speed:
        come_to_stand(m, t, y[PHASE] + m.state.whole_pitches, is_pulled_back(m, t, y))
    p.speed = y[W]
    if resists(m, LOAD) and m.state.slip == 0.0:
        note_hold(m, t)


@compiled
def begin(m: Model, t: float, y: Floats, yp: Floats, force: float) -> None:
    """Go on from a start, where forces and accelerations may have jumped; `force` as for `step`."""
    e, k = m.state.extremes, m.work.track
    if e.begun != 0:
        resume(m, t, y)  # what a knot or a creeping gear has changed, which no root has found
    else:
        e.lowest_speed = e.highest_speed = y[W]
        e.separation = separation(m, y)
        e.window_length = m.scene.end / WINDOWS
    k.time, k.last, k.smooth, k.next_part = t, 0, 1, next_part(m)
    _set_point(m, 0, t, y, yp, force)
    if m.scene.follow.gear != 0:
        standing.begin(m, t, y)
    first_force(m, t, k.point[0].force)
    e.begun = 1
    note_present(m, y)


@compiled(inline=True)
def _follow_separation(m: Model, last: Record, now: Record, y: Floats) -> None:
    """Follow the separation to an accepted time, given as ``POINT`` beside the one before.

    Elastic contacts turn round at events, which are accepted times.
    """
    if (
        m.scene.nodes > 0 or m.scene.pitch_errors != 0 or m.scene.orbit != 0.0
    ):  # a tooth that stands out comes near as it enters the path, and the coast flank with the centre of the pinion
        _note_separation(m, separation(m, y))
    if (
        m.scene.nodes == 0
        and now.travel_rate * last.travel_rate <= 0.0
        and now.travel_rate != last.travel_rate
    ):
        h = now.time - last.time
        extreme = extreme_gap(h, last.travel, last.travel_rate, now.travel, now.travel_rate)
        _note_separation(m, rigid_separation(m, extreme, y[PHASE]))


@compiled
def _note_separation(m: Model, distance: float) -> None:
    """Note a distance."""
    m.state.extremes.separation = min(m.state.extremes.separation, distance)
