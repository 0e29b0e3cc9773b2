"""IDA's state and rates at a time within its last step.

IDA interpolates both at once in a function that it keeps to itself (``IDAGetSolution``); its root search uses that, and
the events of both drivers agree to the last bit because this one does too. Libraries for Windows export what is
documented and nothing else: there state and rates come from ``IDAGetDky``, the same polynomial evaluated in another
order.
"""

from __future__ import annotations

from gearidae.compiled import compiled
from gearidae.engine.sundials import names as sun


@compiled(inline=True)
def solution_as_ida(ida: int, t: float, y: int, yp: int) -> int:
    """Set state and rates as IDA does it for itself; its flag.

    Parameters
    ----------
    ida : int
        Address of the solver.
    t : float
        Time within the last step.
    y, yp : int
        Addresses of the vectors to set.
    """
    return sun.IDAGetSolution(ida, t, y, yp)


@compiled(inline=True)
def solution_as_documented(ida: int, t: float, y: int, yp: int) -> int:
    """Set state and rates like `solution_as_ida`, by functions that every library exports."""
    flag = sun.IDAGetDky(ida, t, 0, y)
    return sun.IDAGetDky(ida, t, 1, yp) if flag == 0 else flag


solution_at = solution_as_ida if sun.exports("IDAGetSolution") else solution_as_documented
"""Set state and rates in the way that is possible here."""
