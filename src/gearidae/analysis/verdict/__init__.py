"""Verdicts: what runs did, in one word each, from the extremes that the engine kept.

`judge` holds the rules, `outcome` reads datasets, `table` makes tables of runs, `codes` has verdicts as numbers.
Names are loaded on first use: a sweep judges its runs without xarray.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.analysis.verdict.judge import IRREGULAR_ABOVE as IRREGULAR_ABOVE
    from gearidae.analysis.verdict.outcome import START_UP as START_UP
    from gearidae.analysis.verdict.outcome import GearOutcome as GearOutcome
    from gearidae.analysis.verdict.outcome import RollerOutcome as RollerOutcome
    from gearidae.analysis.verdict.outcome import outcomes as outcomes

__getattr__, __dir__, __all__ = lazy_names(__name__)
