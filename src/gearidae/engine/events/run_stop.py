"""The end of a run before its time (``run.stop``): the gear sticks, or has made its turns.

Both are roots of a guard, so that the run ends where the condition is met, whatever its steps, blocks and samples are.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, STOPS, Floats, Model

_STICKS: Final = STOPS.index("sticks")


@compiled
def stop_guard(m: Model, t: float, y: Floats) -> float:
    """Time until a gear that stays within half a pitch has stuck, or the pitches that its turns still lack."""
    if m.scene.stop == _STICKS:
        return m.work.track.stop_time - t if m.work.track.stop_time > 0.0 else math.inf
    return m.scene.stop_pitches - abs(y[PHASE] + m.state.turns - m.scene.stop_from)
