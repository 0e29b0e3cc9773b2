"""The engine: one residual, its guards and histories, and two drivers that integrate it with SUNDIALS IDA."""

from gearidae.engine.backend import choose_backend, follow, kept_at, outlook, solve
from gearidae.engine.continuing import end_of, refuse_other_bodies
from gearidae.engine.run_ends import Ended, OnBlock
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.engine.teeth import states_at

__all__ = [
    "AT_ONCE",
    "Ended",
    "OnBlock",
    "Start",
    "choose_backend",
    "end_of",
    "follow",
    "kept_at",
    "outlook",
    "refuse_other_bodies",
    "solve",
    "states_at",
]
