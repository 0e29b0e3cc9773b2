"""Where a run begins: by itself, where another run ended, or at a checkpoint of its own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from gearidae.engine.model.state import Floats
from gearidae.records import Statistics
from gearidae.scene import Scene


@dataclass(frozen=True, slots=True)
class Start:
    """Where a run begins, and from where it is resumed if it has been interrupted.

    Attributes
    ----------
    time : float
        When the run begins [s].
    position : float, optional
        How far the gear has turned by then, in pitches; None where the scene says it.
    scene : Scene, optional
        Of the run that this one goes on from.
    words : ndarray of 8-byte words, optional
        State in which that run ended, see `gearidae.engine.setup.checkpoint`.
    began : float
        When that run itself began [s].
    verdict : ndarray, optional
        What the verdict of that run has to know of its chain; of trains alone, the engine's state has it of pairs.
    checkpoint : ndarray, optional
        Newest checkpoint of this run, from a `Block` of the same backend, to resume from.
    reached, wall_time : float
        Simulated time and wall time up to there [s].
    events : int
        Events up to there.
    statistics : Statistics
        The solver's counters there.
    """

    time: float = 0.0
    position: float | None = None
    scene: Scene | None = None
    words: Floats | None = None
    began: float = 0.0
    verdict: Floats | None = None
    checkpoint: Floats | None = None
    reached: float = 0.0
    wall_time: float = 0.0
    events: int = 0
    statistics: Statistics = field(default_factory=Statistics)


AT_ONCE: Final = Start()
"""Start of a run by itself."""
