"""Observers at the end of a run, before a restart, and for a look in between, after which the model is restored."""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.observers import balance
from gearidae.engine.observers.exposures import accumulation as exposures
from gearidae.engine.observers.extremes import extrema as extremes
from gearidae.engine.pairs.orbit import follow_orbit


@compiled
def finish_account(m: Model, t: float, y: Floats, yp: Floats) -> None:
    """Bring all sums up to an accepted time."""
    if m.scene.follow.balance != 0:
        balance.finish(m, t, y, yp)
    if m.scene.follow.exposures != 0:
        exposures.finish(m, t, y, yp)


@compiled
def finish_for_look(address: int, t: float, y: Floats, yp: Floats) -> None:
    """Finish as for the end of a run, of which the last state may be an extreme.

    Parameters
    ----------
    address : int
        Of the model, from `gearidae.engine.model.addresses.Addresses`.
    t : float
        Time over tau.
    y, yp : ndarray, shape (n,)
        State there, and its rate.
    """
    m = model_at(address)
    follow_orbit(m, t)
    finish_account(m, t, y, yp)
    if m.scene.follow.extremes != 0:
        extremes.note_present(m, y)
    if m.scene.follow.balance != 0:
        balance.note_present(m, t, y)
