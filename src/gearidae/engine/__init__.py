"""The engine: one residual, its guards and histories, and two drivers that integrate it with SUNDIALS IDA."""

from gearidae.engine.backend import choose_backend, solve

__all__ = ["choose_backend", "solve"]
