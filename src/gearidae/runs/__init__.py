"""Running scenes: one run, a sweep, runs that stream into an archive, executors and progress.

The public API: what `gearidae.simulate` and `gearidae.sweep` are, and executors for them; loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.runs.executors import dask_executor as dask_executor
    from gearidae.runs.simulation import simulate as simulate
    from gearidae.runs.sweeping import sweep as sweep

__getattr__, __dir__, __all__ = lazy_names(__name__)
