"""Ranges in gap and stretch of the tabulated force law, and the check that asperities stay within.

They are separate from the code that compiles the law, so that a scene can be checked without numba.
"""

from __future__ import annotations

from typing import Final

from gearidae.asperities import AsperityLaw
from gearidae.errors import SceneError

GAP_LOW: Final = -40.0
"""Deepest tabulated gap, in roughnesses; the last piece is continued below it."""
GAP_HIGH: Final = 13.0
"""Widest tabulated gap or joined height, in roughnesses; forces beyond (1e-37 of their scale) are taken as zero."""

STRETCH_HIGH: Final = 128.0
"""Largest stretch limit a law is made for, in roughnesses."""

JOIN_HIGH: Final = 4.0
"""Largest distance of joining, in roughnesses: what joins at the widest gap of the tables has 1e-18 of their scale."""


def check_reach(law: AsperityLaw, roughness: float) -> None:
    """Refuse a surface whose asperities reach farther than tables are made for.

    Parameters
    ----------
    law : AsperityLaw
        In units of the roughness.
    roughness : float
        Its roughness, which the message names [m].

    Raises
    ------
    SceneError
        If asperities join beyond `JOIN_HIGH` or detach beyond `STRETCH_HIGH` roughnesses.
    """
    for what, reach, limit in (("stretch", law.detach, STRETCH_HIGH), ("join over", law.join, JOIN_HIGH)):
        if not reach <= limit:  # also if a law returns NaN
            raise SceneError(
                "surface.roughness",
                roughness,
                f"asperities {what} {reach:.3g} roughnesses, beyond the model's {limit:g}",
            )
