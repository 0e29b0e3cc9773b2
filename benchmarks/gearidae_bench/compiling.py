"""Compilation for the benchmark, with a cache of its own: its sources go into the name of the folder too.

An edited benchmark is compiled anew, and leaves the engine's compiled code alone.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import gearidae.compiled

__all__ = ["SOURCES", "compiled", "compiled_callback"]

F = TypeVar("F", bound=Callable[..., Any])

SOURCES = (Path(__file__).parent,)
"""What is compiled here besides the engine."""


def compiled(*, makes_arrays: bool = False) -> Callable[[F], F]:
    """Compile a function as `gearidae.compiled.compiled` does, into the benchmark's cache."""
    return gearidae.compiled.compiled(makes_arrays=makes_arrays, sources=SOURCES)


def compiled_callback(signature: Any) -> Callable[[F], Any]:
    """Compile a C callback as `gearidae.compiled.compiled_callback` does, into the benchmark's cache."""
    return gearidae.compiled.compiled_callback(signature, sources=SOURCES)
