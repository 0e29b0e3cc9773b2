"""Mesh entries and exits: the phase crosses a mark of the mesh."""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.events.record import record
from gearidae.engine.model.state import COAST, DRIVE, PHASE, Floats, Model, W
from gearidae.engine.pairs.tooth_pairs import gap_and_rate
from gearidae.records import EventKind

_MESH_ENTRY, _MESH_EXIT = float(EventKind.MESH_ENTRY), float(EventKind.MESH_EXIT)
MARKS: Final = 4
"""Kinds of marks in each pitch."""
NO_MARK: Final = 2.0**40
"""Phase of a mark where the mesh has none."""
RELIEF_PER_STEP: Final = 0.25
"""How far the tip relief may open a gap in one step after a mesh mark, over the roughness: asperities part over one to
three of it."""
_LEAST_DIVISOR: Final = 1e-300


@compiled(inline=True)
def mark_guard(m: Model, y: Floats) -> float:
    """Distance of the phase from the nearest mark."""
    return min(y[PHASE] - m.state.mesh_mark_below, m.state.mesh_mark_above - y[PHASE])


@compiled(inline=True)
def crossed_mark(m: Model, y: Floats) -> bool:
    """Whether the phase has crossed one of its marks."""
    return bool(not m.state.mesh_mark_below <= y[PHASE] < m.state.mesh_mark_above)


@compiled
def first_mark(m: Model, k: int) -> float:
    """Phase of the first mark of each kind: drive entry and exit, coast exit and entry (it runs the other way)."""
    if k == 0:
        return 0.0
    if k == 1:
        return m.scene.contact_ratio
    if k == 2:
        return m.scene.coast_phase
    return m.scene.coast_phase - m.scene.contact_ratio


@compiled
def set_marks(m: Model, phase: float) -> None:
    """Bracket the phase by the nearest mesh entries and exits of either flank.

    Where the mesh has no marks both are far away, and so that no pair is on a path of contact between them.
    """
    low, high = -NO_MARK - 1.0, NO_MARK
    for k in range(m.scene.marks):
        mark = first_mark(m, k)
        whole = math.floor(phase - mark)
        if whole + mark > phase:  # the difference was rounded up to a whole number
            whole -= 1
        elif whole + 1 + mark <= phase:  # down from one
            whole += 1
        low, high = max(low, whole + mark), min(high, whole + 1 + mark)
    m.state.mesh_mark_below, m.state.mesh_mark_above = low, high


@compiled
def cross_mark(m: Model, t: float, y: Floats, events: Floats, count: int) -> int:
    """Mesh entry or exit at the mark just crossed; then bracket the phase anew from the far side."""
    forward = y[PHASE] >= m.state.mesh_mark_above
    crossed = m.state.mesh_mark_above if forward else m.state.mesh_mark_below
    low, high = -math.inf, math.inf
    for k in range(MARKS):
        mark = first_mark(m, k)
        whole = math.floor(crossed - mark + 0.5)
        here = mark + whole
        if abs(crossed - here) < 1e-9:
            flank = COAST if k >= 2 else DRIVE
            begins = (k == 0 or k == 3) == forward
            if k < 2 and not begins:
                m.state.extremes.mesh_exits += 1
            _, rate = gap_and_rate(m, flank, whole, y)
            count = record(m, events, count, t, _MESH_ENTRY if begins else _MESH_EXIT, whole, flank, rate)
        else:
            here = mark + math.floor(crossed - mark)
            if not forward:
                here += 1.0
        # a mark comes out a rounding error before or behind what has been crossed: the phase is on its far side
        if forward:
            low, high = max(low, min(here, crossed)), min(high, here + 1.0)
        else:
            low, high = max(low, here - 1.0), min(high, max(here, crossed))
    m.state.mesh_mark_below, m.state.mesh_mark_above = low, high
    return count


@compiled
def relief_step(m: Model, y: Floats) -> float:
    """Step in which the tip relief opens a gap by `RELIEF_PER_STEP`, from a mesh mark on, at the present speed."""
    along = math.sqrt(2.0 * RELIEF_PER_STEP / m.scene.relief_curvature)
    return along / max(m.scene.phase_rate * abs(y[W]), _LEAST_DIVISOR)


@compiled
def outruns_relief(m: Model, y: Floats, steps: tuple[float, float]) -> bool:
    """Whether a pair may part between both ends of the present step, which the error test sees nothing of.

    A motion may be so smooth that the solver's steps are longer than the tip relief takes to part a pair. The present
    step is at least as long as it has been so far, and about as long as the one before: `steps` are the one before and
    the present one so far.
    """
    return bool(max(steps[0], steps[1]) > relief_step(m, y))
