"""Windows of the gear's speed over a chain of runs: only the last run knows where the parts of the chain begin.

Start-up, second half and last twentieth are of the whole chain. A part that begins in an earlier run is put together
from the windows of that, from the nearest beginning of one.
"""

from __future__ import annotations

from gearidae.engine.model.checkpoint_record import WINDOWS
from gearidae.engine.model.state import Model, Record
from gearidae.records import RUN_PARTS


def begin_parts_before(m: Model, time: float) -> None:
    """Begin those parts of a chain that have begun before its last run, which starts at a time over tau."""
    e = m.state.extremes
    if e.windows == 0:  # nothing has been followed
        e.window_length = m.scene.end / WINDOWS
        return
    while e.window_length * WINDOWS < m.scene.end * (1.0 - 1e-9):
        _double(e)
    for i, share in enumerate(RUN_PARTS):
        first = round(float(share * m.scene.end / e.window_length))
        if share * m.scene.end >= time or first >= e.windows:
            continue
        whole = e.window[first].copy()
        for k in range(first + 1, e.windows):
            _append(whole, e.window[k])
        part = e.part[i]
        part.begun, part.lowest, part.highest = 1, whole.lowest, whole.highest
        part.time = part.whole_time = first * e.window_length
        part.position = part.whole_position = whole.position
        if i == 0:
            e.fall, e.rise, e.top, e.bottom = whole.fall, whole.rise, whole.highest, whole.lowest


def _double(e: Record) -> None:
    """Make two windows one, and all of them twice as long."""
    for k in range(e.windows):
        if k % 2 == 0:
            e.window[k // 2] = e.window[k]
        else:
            _append(e.window[k // 2], e.window[k])
    e.windows = (e.windows + 1) // 2
    e.window_length *= 2.0


def _append(window: Record, after: Record) -> None:
    """Add to a window the one behind it."""
    window.fall = max(window.fall, after.fall, window.highest - after.lowest)
    window.rise = max(window.rise, after.rise, after.highest - window.lowest)
    window.lowest, window.highest = min(window.lowest, after.lowest), max(window.highest, after.highest)
