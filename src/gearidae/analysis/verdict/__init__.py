"""Verdicts: what runs did, in one word each, from the extremes that the engine kept.

`judge` holds the rules, `outcome` reads datasets, `table` shows outcomes in notebooks, `codes` are verdicts as numbers.
Names are loaded on first use: a sweep judges its runs without xarray.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.analysis.verdict.judge import IRREGULAR_ABOVE
    from gearidae.analysis.verdict.outcome import START_UP, GearOutcome, RollerOutcome, outcomes

__all__ = ["IRREGULAR_ABOVE", "START_UP", "GearOutcome", "RollerOutcome", "outcomes"]

_HOME = {name: "judge" if name == "IRREGULAR_ABOVE" else "outcome" for name in __all__}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
