"""The torque laws by their names: what ``drive.law`` and ``load.law`` may say.

Every file of this folder that registers a law is found by itself. A law from elsewhere is registered in each process
that uses it, before scenes are made that name it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.registry import Registry

__all__ = [
    "MOST_PARAMETERS",
    "Parameters",
    "TorqueLaw",
    "register_torque",
    "torque_law",
    "torque_names",
    "unregister_torque",
]

Parameters: TypeAlias = NDArray[np.float64]
Law = TypeVar("Law", bound=Callable[..., Any])

MOST_PARAMETERS: Final = 10_000
"""Parameters of one law."""


@dataclass(frozen=True, slots=True)
class TorqueLaw:
    """A law that is known by a name.

    Attributes
    ----------
    name : str
        What ``drive.law.name`` and ``load.law.name`` call it.
    function : callable
        ``function(t, speed, p)``: torque [N m] of time [s], angular speed of the shaft [rad/s] and parameters.
    parameters : int
        How many parameters it takes.
    """

    name: str
    function: Callable[..., Any]
    parameters: int


_LAWS: Final = Registry[TorqueLaw]("gearidae.torques", "law.name", "torque law")


def register_torque(name: str, *, parameters: int = 0) -> Callable[[Law], Law]:
    """Make a torque law known by a name; a decorator of its function.

    The function is ``torque(t, speed, p)`` with the time [s], the angular speed of the shaft [rad/s] and the array of
    parameters, shape (parameters,); it returns the torque [N m]. It is compiled by numba when a scene first uses it,
    so it may use floats, `math`, the array and other compiled functions, and must not raise. The torque is added to
    the shaft's other torques: that of a drive turns the pinion forward, that of a load resists the gear's motion,
    whichever way it goes (a negative sum counts as none), so that a viscous load is ``c abs(speed)``.

    It must be continuous in time and speed and finite at rest; it is also called a ten-thousandth of the scene's
    natural time unit before and after a time, at the speed then. What varies much faster than gears and contacts do
    belongs in ``harmonic``, and what jumps in ``schedule``: steps follow those two by their frequencies and knots.
    Newton's iteration leaves the law's slope in the speed out, which it can do while a shaft needs many steps to
    follow the law.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    parameters : int, optional
        How many parameters the law takes, all of which a scene has to give.

    Returns
    -------
    callable
        The decorator; it returns the function as it is.

    Raises
    ------
    SceneError
        If the name is none, or that of another law, or the number of parameters is none.

    Examples
    --------
    >>> import gearidae as gd
    >>> @gd.register_torque("brake", parameters=1)
    ... def brake(t, speed, p):
    ...     return -p[0] * speed
    >>> gd.unregister_torque("brake")
    """
    if not isinstance(name, str) or not name.isidentifier():
        raise SceneError("law.name", name, "must be a word of letters, digits and underscores")
    if not isinstance(parameters, int) or not 0 <= parameters <= MOST_PARAMETERS:
        raise SceneError("parameters", parameters, f"must be a whole number in 0..{MOST_PARAMETERS}")

    def register(function: Law) -> Law:
        _LAWS.add(name, TorqueLaw(name, function, parameters))
        return function

    return register


def unregister_torque(name: str) -> None:
    """Take a law out again.

    Parameters
    ----------
    name : str

    Raises
    ------
    SceneError
        If there is no such law.
    """
    _LAWS.remove(name)


def torque_names() -> tuple[str, ...]:
    """Return the names of all torque laws, in the order of the alphabet."""
    return _LAWS.names()


def torque_law(name: str) -> TorqueLaw:
    """Look a law up.

    Parameters
    ----------
    name : str

    Returns
    -------
    TorqueLaw

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return _LAWS.find(name)
