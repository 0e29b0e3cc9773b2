"""Ranges in gap and stretch of the tabulated force law.

They stand apart from the code that compiles the law, so that a scene can be checked without it.
"""

from __future__ import annotations

from typing import Final

__all__ = ["GAP_HIGH", "GAP_LOW", "JOIN_HIGH", "STRETCH_HIGH"]

GAP_LOW: Final = -40.0
"""Deepest tabulated gap, in roughnesses; the last piece is continued below it."""
GAP_HIGH: Final = 13.0
"""Widest tabulated gap or joined height, in roughnesses; forces beyond (1e-37 of their scale) are taken as zero."""

STRETCH_HIGH: Final = 128.0
"""Largest stretch limit a law is made for, in roughnesses."""

JOIN_HIGH: Final = 1.0
"""Largest distance of joining, in roughnesses, for which the tables keep their stated error."""
