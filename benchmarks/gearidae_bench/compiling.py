"""Compilation for the benchmark, with a cache of its own: its sources go into the name of the folder too.

An edited benchmark is compiled anew, and leaves the engine's compiled code alone.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from gearidae import compiled as own

__all__ = ["SOURCES", "compiled", "compiled_callback"]

SOURCES = (Path(__file__).parent,)
"""What is compiled here besides the engine."""

compiled = partial(own.compiled, sources=SOURCES)
compiled_callback = partial(own.compiled_callback, sources=SOURCES)
