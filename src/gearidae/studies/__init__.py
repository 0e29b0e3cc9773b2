"""Studies: simulations, or the static contact, used to answer a question (coating map, starting torque, validity).

Their public names are reached through `gearidae.studies` and, for the older ones, `gearidae.analysis`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.runs.validity import validity

__all__ = ["validity"]

_HOME: dict[str, str | None] = {"validity": "gearidae.runs.validity"}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
