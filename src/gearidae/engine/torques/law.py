"""Torque laws by their names (`gearidae.torques`): compiled when a scene first uses them, and called at an address.

A law may stand in any file, or in none that could be read again, so that its compiled code is not kept on disk:
compiling a few lines takes a fraction of a second. Its address belongs to this process and lies in the work space,
which no file can set.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, Final

import numba
import numpy as np
from llvmlite import ir
from numba import carray, types  # type: ignore[attr-defined]
from numba.core.errors import NumbaError, TypingError
from numba.extending import intrinsic

from gearidae.compiled import compiled
from gearidae.engine.model.state import Model
from gearidae.errors import SceneError
from gearidae.torques import torque_law

STEP: Final = 1e-4
"""Over tau, by which a law's rate looks to either side: contacts vibrate with about a radian a tau."""
LOOKS: Final = 65
"""Times in a run at which the size of a law's torque is looked at,"""
ANGLES: Final = 24
"""and angles of the shaft at each of them."""

_SIGNATURE = types.float64(
    types.float64,
    types.float64,
    types.float64,
    types.CPointer(types.float64),  # type: ignore[no-untyped-call]
    types.int64,
    types.int64,
)
_TORQUE: Final = 0
_FORCE: Final = (1, 2)
"""Which number of a law is asked for: its torque, or a component of its force."""


def law_address(name: str) -> int:
    """Address of a law's compiled code in this process.

    Parameters
    ----------
    name : str
        Of a registered law.

    Raises
    ------
    SceneError
        If numba cannot compile it to a function that returns a number.
    """
    return int(_callback(name).address)


def largest_torque(name: str, parameters: Sequence[float], speed: float, duration: float) -> float:
    """Largest size of a law's torque [N m] in a run, at rest and at a speed, at angles all around.

    Values that are not finite do not count.

    Parameters
    ----------
    name : str
        Of a registered law.
    speed : float
        [rad/s].
    duration : float
        Of the run [s].
    """
    numbers = np.array(parameters, dtype=np.float64)
    handed = numbers.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
    law = _callback(name).ctypes
    times = np.linspace(0.0, duration, LOOKS)
    angles = (
        np.linspace(0.0, 2.0 * math.pi, ANGLES, endpoint=False) if torque_law(name).takes_angle else (0.0,)
    )
    values = [
        abs(law(float(t), float(a), w, handed, numbers.size, _TORQUE))
        for t in times
        for a in angles
        for w in (0.0, speed)
    ]
    return max((value for value in values if math.isfinite(value)), default=0.0)


def _callback(name: str) -> Any:
    try:
        law = torque_law(name)
        return _compile(law.function, law.takes_angle, law.has_force)
    except NumbaError as error:
        reason = str(error).strip().partition("\n")[0]
        raise SceneError("law.name", name, f"numba cannot compile this torque law: {reason}") from error


@cache
def _compile(function: Callable[..., Any], takes_angle: bool, has_force: bool) -> Any:
    """Compile a law; what has been compiled stays, as its address may be in use."""
    law: Any = numba.njit(error_model="numpy")(getattr(function, "py_func", function))

    @numba.njit(error_model="numpy")
    def value(t: float, angle: float, speed: float, parameters: Any) -> Any:
        return law(t, angle, speed, parameters) if takes_angle else law(t, speed, parameters)

    def torque(t: float, angle: float, speed: float, parameters: Any, count: int, _: int) -> float:
        return value(t, angle, speed, carray(parameters, (count,)))

    def torque_or_force(
        t: float, angle: float, speed: float, parameters: Any, count: int, which: int
    ) -> float:
        torque, x, y = value(t, angle, speed, carray(parameters, (count,)))
        return torque if which == 0 else x if which == 1 else y

    return numba.cfunc(_SIGNATURE)(torque_or_force if has_force else torque)


def _typed(  # the arguments of the law, where its parameters are, and which number of it is asked for
    typing: Any, address: Any, t: Any, angle: Any, speed: Any, numbers: Any, at: Any, count: Any, which: Any
) -> Any:
    """Type of a call of the law at an address, and the code that makes it."""
    if numbers.layout != "C":
        raise TypingError(f"the array must be contiguous, and {numbers} may not be")

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, t, angle, speed, numbers, at, count, which = values
        array = context.make_array(signature.args[4])(context, builder, numbers)
        handed = [t, angle, speed, builder.gep(array.data, [at]), count, which]
        kind = ir.FunctionType(ir.DoubleType(), [value.type for value in handed])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), handed)

    real, whole = types.float64, types.int64
    return real(whole, real, real, real, numbers, whole, whole, whole), call


_call: Any = intrinsic(_typed)


@compiled
def _number(m: Model, shaft: int, which: int, t: float, angle: float, speed: float) -> float:
    """Number of a shaft's law in SI units, at a scaled time and speed and an angle [rad]."""
    torque = m.scene.torque[shaft]
    return _call(
        m.work.torque_law[shaft],
        t * m.scene.time_unit,
        angle,
        speed * torque.law_speed,
        m.tables,
        torque.law_at,
        torque.law_count,
        which,
    )


@compiled
def law_value(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Torque of a shaft's law over base radius and reference load, at a scaled time and speed and an angle [rad]."""
    return _number(m, shaft, _TORQUE, t, angle, speed) / m.scene.torque[shaft].law_torque


@compiled
def law_rate(m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float) -> float:
    """Rate of change of `law_value` along the motion, by a central difference; one-sided where the run begins."""
    low, high = max(t - STEP, 0.0), t + STEP
    before = law_value(m, shaft, low, *_moved(m, shaft, low - t, angle, speed, acceleration))
    after = law_value(m, shaft, high, *_moved(m, shaft, high - t, angle, speed, acceleration))
    return (after - before) / (high - low)


@compiled(inline=True)
def _moved(
    m: Model, shaft: int, ahead: float, angle: float, speed: float, acceleration: float
) -> tuple[float, float]:
    """Angle and speed of a shaft a short time ahead."""
    return angle + ahead * (speed * m.scene.torque[shaft].angle_unit), speed + ahead * acceleration


@compiled
def law_force(m: Model, shaft: int, t: float, angle: float, speed: float) -> tuple[float, float]:
    """Components of the force of a shaft's law [N], of a law that has one."""
    first, second = _FORCE
    return _number(m, shaft, first, t, angle, speed), _number(m, shaft, second, t, angle, speed)


@compiled
def law_force_rate(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float
) -> tuple[float, float]:
    """Rates of `law_force` along the motion [N/tau], as `law_rate`."""
    low, high = max(t - STEP, 0.0), t + STEP
    before = law_force(m, shaft, low, *_moved(m, shaft, low - t, angle, speed, acceleration))
    after = law_force(m, shaft, high, *_moved(m, shaft, high - t, angle, speed, acceleration))
    return (after[0] - before[0]) / (high - low), (after[1] - before[1]) / (high - low)
