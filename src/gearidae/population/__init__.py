"""Real asperities on each flank: drawn from a seed or taken from a list, with the materials that meet at them.

Reads scenes; needs neither the compiled contact laws nor the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.population.dataset import population
    from gearidae.population.flanks import FlankAsperities, flanks_of

__all__ = ["FlankAsperities", "flanks_of", "population"]

_HOME = {"FlankAsperities": "flanks", "flanks_of": "flanks", "population": "dataset"}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
