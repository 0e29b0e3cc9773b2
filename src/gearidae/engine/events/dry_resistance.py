"""Stick and slip: dry resistance at the gear is set-valued, so that its beginning and end are events."""

from __future__ import annotations

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import SOLVER
from gearidae.engine.events.record import record
from gearidae.engine.model.state import Floats, Model, W
from gearidae.engine.motion.dry_limit import NO_FORCE, dry_limit, push_on_gear
from gearidae.records import EventKind, Flank

_STICK, _SLIP, _NO_FLANK = float(EventKind.STICK), float(EventKind.SLIP), float(Flank.NONE)


@compiled(inline=True)
def dry_guard(m: Model, t: float, y: Floats) -> float:
    """Slip speed, or what is left of the dry resistance of a gear held at rest."""
    if m.state.slip == 0.0:
        return _hold_guard(m, t, y)
    # a slip slower than `rest_speed` may reverse a little before it counts as one
    return y[W] * m.state.slip + (0.0 if m.state.slipping != 0 else 2.0 * m.scene.rest_speed)


@compiled_once(SOLVER)
def _hold_guard(m: Model, t: float, y: Floats) -> float:
    """What is left of the dry resistance of a gear held at rest."""
    return dry_limit(m, t, y) + 2.0 * NO_FORCE - abs(push_on_gear(m, t, y))


@compiled(inline=True)
def note_slip(m: Model, y: Floats) -> None:
    """Note at an accepted time that a slip has become faster than `rest_speed`."""
    if m.scene.dry != 0 and y[W] * m.state.slip > m.scene.rest_speed:
        m.state.slipping = 1


@compiled
def stick_or_slip(m: Model, t: float, y: Floats, events: Floats, count: int) -> int:
    """Set-valued dry resistance: it holds the gear up to its limit, and slips in the direction of the load."""
    y[W] = 0.0
    m.state.slipping = 0
    push = push_on_gear(m, t, y)
    slipping = m.state.slip != 0.0
    if slipping and abs(push) <= dry_limit(m, t, y) + NO_FORCE:
        m.state.slip = 0.0
        return record(m, events, count, t, _STICK, 0, _NO_FLANK, 0.0)
    m.state.slip = 1.0 if push > 0.0 else -1.0
    return count if slipping else record(m, events, count, t, _SLIP, 0, _NO_FLANK, 0.0)
