"""Real asperities on each flank: drawn from a seed or taken from a list, with the materials that meet at them.

Reads scenes; needs neither the compiled contact laws nor the solver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.populations.dataset import population as population
    from gearidae.populations.flanks import FlankAsperities as FlankAsperities
    from gearidae.populations.flanks import flanks_of as flanks_of

__getattr__, __dir__, __all__ = lazy_names(__name__)
