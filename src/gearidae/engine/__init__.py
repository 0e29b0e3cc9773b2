"""The engine: one residual, its guards and histories, and two drivers that integrate it with SUNDIALS IDA."""

from gearidae.engine.backend import Ended, Start, choose_backend, follow, kept_at, outlook, solve

__all__ = ["Ended", "Start", "choose_backend", "follow", "kept_at", "outlook", "solve"]
