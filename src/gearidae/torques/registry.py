"""The torque laws by their names: the values of ``drive.law.name`` and ``load.law.name``.

Every file of this folder that registers a law is found automatically. Each process that uses a law from elsewhere has
to register it before it makes scenes that name it.
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
"""Largest number of parameters of a law."""


@dataclass(frozen=True, slots=True)
class TorqueLaw:
    """A registered law.

    Attributes
    ----------
    name : str
        Its name in ``drive.law.name`` and ``load.law.name``.
    function : callable
        ``function(t, speed, p)``: torque [N m] of time [s], angular speed of the shaft [rad/s] and parameters.
    parameters : int
        Number of its parameters.
    """

    name: str
    function: Callable[..., Any]
    parameters: int


_LAWS: Final = Registry[TorqueLaw]("gearidae.torques", "law.name", "torque law")


def register_torque(name: str, *, parameters: int = 0) -> Callable[[Law], Law]:
    """Register a torque law by a name; a decorator of its function.

    The function is ``torque(t, speed, p)`` with the time [s], the angular speed of the shaft [rad/s] and the array of
    parameters, shape (parameters,); it returns the torque [N m]. Numba compiles it when a scene first uses it. It may
    use floats, `math`, the array and other compiled functions, and must not raise. The torque is added to
    the other torques of the shaft. The torque of a drive turns the pinion forward. The torque of a load resists the
    motion of the gear in both directions (a negative sum counts as zero), so that a viscous load is ``c abs(speed)``.

    It must be continuous in time and speed and finite at rest. The engine also calls it a ten-thousandth of the scene's
    natural time unit before and after a time, at the current speed. Use ``harmonic`` for a torque that varies much
    faster than gears and contacts, and ``schedule`` for one that jumps: the steps resolve their frequencies and knots.
    Newton's iteration leaves out the slope of the law in the speed, which is allowed if a shaft needs many steps to
    follow the law.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    parameters : int, optional
        Number of parameters; a scene has to give all of them.

    Returns
    -------
    callable
        The decorator; it returns the function unchanged.

    Raises
    ------
    SceneError
        If the name is not an identifier, or that of another law, or the number of parameters is out of range.

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
    """Remove a law.

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
    """Return the names of all torque laws in alphabetical order."""
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
