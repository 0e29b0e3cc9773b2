"""The end of a run before its time (``run.stop``): the gear comes to stand, or has made its turns.

Both are roots of a guard, so that the run ends where the condition is met, whatever its steps, blocks and samples are.
"""

from __future__ import annotations

import math
from typing import Final

from gearidae.compiled import compiled
from gearidae.engine.model.state import PHASE, STOPS, Floats, Model, W

_STICKS: Final = STOPS.index("sticks")


@compiled
def stop_guard(m: Model, y: Floats) -> float:
    """Gear's speed once it has moved forward, or the pitches that its turns still lack."""
    if m.scene.stop == _STICKS:
        return y[W] if m.state.stop_armed != 0 else math.inf
    return m.scene.stop_pitches - abs(y[PHASE] + m.state.turns - m.scene.stop_from)


@compiled
def arm_stop(m: Model, y: Floats) -> None:
    """Note at an accepted time that the gear moves forward."""
    if y[W] > 0.0:
        m.state.stop_armed = 1
