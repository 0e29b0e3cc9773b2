"""The observers of a run in their order, each called only if the scene wants it.

An observer accumulates totals and extremes and never changes the solution. It is a module with `begin` at a start of
the integration, `step` at every accepted time, `event` before a pair's history takes what has happened at a root,
`asperity_switches` where asperities have joined or detached, `resume` behind all events of a root, and `finish` before
a restart, at the end and for a look in between. It leaves out what it does not need. Exposures use what adhesion loss
and balance have left at the same time, and extremes the force that losses by friction have.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.events.pair_events import PairEvent
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import Floats, Model, W
from gearidae.engine.observers import adhesion_loss, balance, friction_losses
from gearidae.engine.observers.exposures import follow as exposures
from gearidae.engine.observers.exposures.contacts import add_asperity_switches
from gearidae.engine.observers.extremes import follow as extremes


@compiled
def begin(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Begin at a start of the integration, with its state and rates."""
    if m.scene.follow.balance != 0:
        adhesion_loss.begin(m, t)
        balance.begin(m, t, y, yp)
    if m.scene.follow.friction != 0:
        friction_losses.note_friction(m, t, y)
    if m.scene.follow.extremes != 0:
        extremes.begin(m, t, y, yp)
    if m.scene.follow.exposures != 0:
        exposures.begin(m, t, y, yp)


@compiled(inline=True)
def step(
    m: Model, t: float, y: Floats, yp: Floats, at: tuple[bool, bool], between: tuple[Floats, Floats]
) -> None:
    """Go on to an accepted time, with histories and mesh marks as they were in the step.

    Parameters
    ----------
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there and its rate.
    at : tuple of bool
        Whether a stop or a root of the guard is there, and whether it is a root.
    between : tuple of two ndarrays, shape (n,)
        Work space.
    """
    if m.scene.follow.balance != 0:
        adhesion_loss.step(m, t, y, yp[W])
    if m.scene.follow.friction != 0:
        friction_losses.accumulate_friction(m, t, y, at[1], between[0], between[1])
    if m.scene.follow.extremes != 0:
        extremes.step(m, t, y, yp, at[0], between)
    if m.scene.follow.balance != 0:
        balance.step(m, t, y, yp, at, between)
    if m.scene.follow.exposures != 0:
        exposures.step(m, t, y, yp, at[1])


@compiled(inline=True)
def event(m: Model, t: float, y: Floats, yp: Floats, event: PairEvent) -> None:
    """Take note of what has happened to a pair, before its history does."""
    if m.scene.follow.balance != 0 and event.turns:
        adhesion_loss.event(m, y, event.coast, event.pair, event.k, event.gap)
    if m.scene.follow.exposures != 0:
        exposures.event(m, t, y, yp, event)


@compiled
def asperity_switches(m: Model, y: Floats) -> None:
    """Take note of asperities that have joined or detached, before they are recorded."""
    if m.scene.follow.exposures != 0:
        add_asperity_switches(m, y)


@compiled
def resume(m: Model, t: float, y: Floats, crossed: bool, joined: bool) -> None:
    """Go on behind all events of a root.

    Parameters
    ----------
    t : float
        Time over tau.
    y : ndarray, shape (n,)
        State, which a gear that comes to rest has changed.
    crossed, joined : bool
        Whether the phase has crossed a mark of the mesh, and whether a closing contact has turned round.
    """
    if m.scene.follow.balance != 0:
        if crossed:
            adhesion_loss.resume(m, y)
        balance.resume(m, t, y, crossed, joined)
    if m.scene.follow.friction != 0:
        friction_losses.note_friction(m, t, y)
    if m.scene.follow.extremes != 0:
        extremes.resume(m, t, y)


@compiled
def finish(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Bring all sums up to an accepted time."""
    if m.scene.follow.balance != 0:
        balance.finish(m, t, y, yp)
    if m.scene.follow.exposures != 0:
        exposures.finish(m, t, y, yp)


@compiled
def look_at(place: int, t: float, y: Floats, yp: Floats) -> None:
    """Finish as for the end of a run, of which the last state may be an extreme.

    Parameters
    ----------
    place : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there, and its rate.
    """
    m = model_at(place)
    finish(m, t, y, yp)
    if m.scene.follow.extremes != 0:
        extremes.note_present(m, y)
    if m.scene.follow.balance != 0:
        balance.look(m, t, y)
