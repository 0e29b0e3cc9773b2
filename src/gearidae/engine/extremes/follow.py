"""What both drivers call: at every accepted time, and at every start."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.extremes.forces import first_force, follow_force
from gearidae.engine.extremes.separation import follow_separation, note_separation, separation
from gearidae.engine.extremes.speeds import follow_speed, next_part, note_speed, stand
from gearidae.engine.model.state import GEARS, PHASE, ROLLER, Floats, Model, U, V, W

__all__ = ["follow_extremes", "note_present", "note_rest", "restart_extremes"]


@compiled(inline=True)
def follow_extremes(m: Model, t: float, y: Floats, yp: Floats, event: bool) -> None:
    """Follow the extremes to an accepted time, before its events are handled.

    Parameters
    ----------
    m : Model
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State and rates there.
    event : bool
        Whether something happens there.
    """
    if t > m.work.track.time:
        if m.scene.kind == GEARS:
            follow_speed(m, t, y, yp)
        follow_separation(m, t, y)
        follow_force(m, t, y, yp, event)
        _note_state(m, t, y, yp)
    if event:
        note_present(m, y)


@compiled(inline=True)
def _note_state(m: Model, t: float, y: Floats, yp: Floats) -> None:
    k = m.work.track
    k.time, k.travel, k.travel_rate = t, y[U], y[V]
    if m.scene.kind == GEARS:
        k.speed, k.speed_rate, k.place = y[W], yp[W], y[PHASE] + m.state.turns


@compiled
def note_present(m: Model, y: Floats) -> None:
    """Note a state as it is: until an extremum is passed it may be one."""
    if m.scene.kind == GEARS:
        note_speed(m, y[W])
    else:
        note_speed(m, y[V])
    note_separation(m, separation(m, y))


@compiled
def note_rest(m: Model, t: float, y: Floats) -> None:
    """Note that an event has brought the gear to rest."""
    k = m.work.track
    if m.scene.kind == GEARS and y[W] <= 0.0 < k.speed:
        stand(m, t, y[PHASE] + m.state.turns)
        k.speed = y[W]


@compiled
def restart_extremes(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Go on from a start, where forces and accelerations may have jumped."""
    e = m.state.extremes
    if e.begun == 0:
        e.lowest_speed = e.highest_speed = y[V] if m.scene.kind == ROLLER else y[W]
        e.separation = separation(m, y)
    first_force(m, t, y, yp)
    e.begun = 1
    note_present(m, y)
    _note_state(m, t, y, yp)
    m.work.track.next_part = next_part(m)
