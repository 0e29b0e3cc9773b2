"""The torque laws by their names: the values of ``drive.law.name`` and ``load.law.name``.

Every file of this folder that registers a law is found automatically. Each process that uses a law from elsewhere has
to register it before it makes scenes that name it.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.registry import Registry

Parameters: TypeAlias = NDArray[np.float64]
Law = TypeVar("Law", bound=Callable[..., Any])

MOST_PARAMETERS: Final = 10_000
"""Largest number of parameters of a law."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter that a case file gives by its name.

    Attributes
    ----------
    name : str
        Letters, digits and underscores; not ``name`` and not ``parameters``.
    unit : str
        SI unit in pint's spelling, ``"1"`` for a pure number; if empty, texts with any unit are turned into SI.
    default : float, optional
        Its value where none is given; without one it is required.
    over_time : bool
        Whether it may be a linear schedule, which holds its end values outside its knots. Only the last parameter may
        be one. The law reads its knots (time, value), from its index to the end of the array; a number is one knot at
        time 0.
    description : str
        What it means.
    """

    name: str
    unit: str = ""
    default: float | None = None
    over_time: bool = False
    description: str = ""


@dataclass(frozen=True, slots=True)
class TorqueLaw:
    """A registered law.

    Attributes
    ----------
    name : str
        Its name in ``drive.law.name`` and ``load.law.name``.
    function : callable
        ``function(t, speed, p)`` or ``function(t, angle, speed, p)``: torque [N m] of time [s], angle [rad] and speed
        [rad/s] of the shaft and parameters.
    parameters : int
        Number of its parameters.
    named : tuple of Parameter
        The parameters, if they have names; empty for a list of numbers.
    takes_angle : bool
        Whether the function has four arguments.
    has_force : bool
        Whether it returns the force on the shaft, too.
    knots : callable, optional
        ``knots(p, t_end)``: times [s] at which it jumps or has a kink.
    switch : callable, optional
        ``switch(t, angle, speed, p)``: a function that changes its sign where it switches.
    """

    name: str
    function: Callable[..., Any]
    parameters: int
    named: tuple[Parameter, ...] = ()
    takes_angle: bool = False
    has_force: bool = False
    knots: Callable[..., Any] | None = None
    switch: Callable[..., Any] | None = None

    @property
    def is_declared(self) -> bool:
        """Whether it says where it jumps, if it does; else it is watched."""
        return self.knots is not None or self.switch is not None


_LAWS: Final = Registry[TorqueLaw]("gearidae.torques", "law.name", "torque law")


def register_torque(
    name: str,
    *,
    parameters: int | Iterable[str | Parameter] = 0,
    force: bool = False,
    knots: Callable[..., Any] | None = None,
    switch: Callable[..., Any] | None = None,
) -> Callable[[Law], Law]:
    """Register a torque law by a name; a decorator of its function.

    The function is ``torque(t, speed, p)`` or ``torque(t, angle, speed, p)`` with the time [s], angle [rad] and angular
    speed [rad/s] of the shaft, and the array of parameters in SI units; it returns the torque [N m]. The angle counts
    from the start of the first run of a chain, is not wrapped, and continues through continued and resumed runs. Numba
    compiles the function when a scene first uses it. It may use floats, `math`, the array and other compiled
    functions, and must not raise. The torque is added to the other torques of the shaft. The torque of a drive turns
    the pinion forward. The torque of a load resists the motion of the gear in both directions (a negative sum counts
    as zero), so that a viscous load is ``c abs(speed)``.

    It must be finite at rest. Where it jumps or has a kink, `knots` or `switch` say so: the solver stops there and
    begins anew, in motion and at rest. A law that says nothing is looked at 100,000 times in a run, at fixed angle and
    speed, and one of the angle as often in a turn: its jumps are found to rounding and named before a run, and shorter
    pulses or sectors may be missed. In motion each step compares it with its interpolation, at three times within the
    step or within each part that is as long as the shortest sector, and is made shorter until both agree.
    The engine also calls a law a ten-thousandth of the scene's natural time unit before and after a time, along the
    current motion. Use ``harmonic`` for a torque that varies much faster than gears and contacts, in time or with the
    angle. Newton's iteration leaves out the slopes of the law, which is allowed if a shaft needs many steps to follow
    the law.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    parameters : int or iterable of str or Parameter, optional
        Number of parameters, which a scene gives as a list of numbers ``parameters``; or their names, under which a
        scene gives numbers in SI units or texts with a unit. All are required but those with a default.
    force : bool, optional
        Whether the function returns ``(torque, fx, fy)``: the torque, and the force [N] by which a drive pushes the
        pinion's shaft, in axes fixed to the frame. The x axis goes from the centre of the pinion to that of the gear,
        turned by ``drive.orientation``; y is ahead of it as the pinion turns. Such a drive pushes with a pin: its force
        goes through the pinion's hub and the pin joint. Without it a drive is a couple. A load has no force.
    knots : callable, optional
        ``knots(p, t_end)`` of the parameters and the time of the end of the run [s]: the times at which a law of time
        jumps or has a kink. Times before the run's start and behind its end do not count.
    switch : callable, optional
        ``switch(t, angle, speed, p)``: changes its sign where the law jumps, and nowhere else. Its zeros are located
        like every event; two of them within one step are not seen (``run.largest_step``). Numba compiles it.

    Returns
    -------
    callable
        The decorator; it returns the function unchanged.

    Raises
    ------
    SceneError
        If the name is not an identifier, or that of another law, or the parameters are neither a number in range nor
        names, or the function takes neither three nor four arguments, `knots` not two, or `switch` not four.

    Examples
    --------
    >>> import gearidae as gd
    >>> @gd.register_torque("brake", parameters=("coefficient",))
    ... def brake(t, speed, p):
    ...     return -p[0] * speed
    >>> scene = gd.preset("teodorescu2009").replace(
    ...     {"drive.law": {"name": "brake", "coefficient": "1e-15 N m s/rad"}}
    ... )
    >>> gd.unregister_torque("brake")
    """
    if not isinstance(name, str) or not name.isidentifier():
        raise SceneError("law.name", name, "must be a word of letters, digits and underscores")
    named = () if isinstance(parameters, int) else _named(parameters)
    count = parameters if isinstance(parameters, int) else len(named)
    if not 0 <= count <= MOST_PARAMETERS:
        raise SceneError("parameters", count, f"must be a whole number in 0..{MOST_PARAMETERS}")

    for key, given, wanted in (("knots", knots, "p, t_end"), ("switch", switch, "t, angle, speed, p")):
        if given is not None and (
            not callable(given)
            or len(inspect.signature(getattr(given, "py_func", given)).parameters) != wanted.count(",") + 1
        ):
            raise SceneError(key, given, f"must be a function of {wanted}")

    def register(function: Law) -> Law:
        arguments = len(inspect.signature(getattr(function, "py_func", function)).parameters)
        if arguments not in (3, 4):
            raise SceneError(
                "law.name", name, f"takes {arguments} arguments; must take t, speed, p or t, angle, speed, p"
            )
        law = TorqueLaw(name, function, count, named, arguments == 4, force, knots, switch)
        _LAWS.add(name, law)
        return function

    return register


def _named(parameters: object) -> tuple[Parameter, ...]:
    """Read the declaration of named parameters."""
    if isinstance(parameters, str) or not isinstance(parameters, Iterable):
        raise SceneError(
            "parameters", parameters, f"must be a whole number in 0..{MOST_PARAMETERS} or a list of names"
        )
    named = tuple(
        parameter if isinstance(parameter, Parameter) else Parameter(parameter) for parameter in parameters
    )
    names = [parameter.name for parameter in named]
    for parameter in names:
        if (
            not isinstance(parameter, str)
            or not re.fullmatch(r"[^\W\d]\w*", parameter)
            or parameter in ("name", "parameters")
        ):
            raise SceneError(
                "parameters",
                parameter,
                "must be a word of letters, digits and underscores, not name and not parameters",
            )
    if len(set(names)) < len(names):
        raise SceneError("parameters", ", ".join(names), "must be names that differ")
    if any(parameter.over_time for parameter in named[:-1]):
        raise SceneError("parameters", ", ".join(names), "only the last one may be a schedule")
    return named


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

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return _LAWS.find(name)
