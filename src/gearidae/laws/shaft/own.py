"""Torque laws of a user by their names (`gearidae.torques`): compiled when first used, and called at an address.

A law may stand in any file, or in none that could be read again, so that its compiled code is not kept on disk:
compiling a few lines takes a fraction of a second. Its address belongs to this process and lies in the work space,
which no file can set.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.compiled import compiled
from gearidae.compiled.address import call_at
from gearidae.errors import SceneError
from gearidae.laws.law import INT, REAL, ShaftLaw
from gearidae.torques import TorqueLaw, torque_law

if TYPE_CHECKING:
    from gearidae.engine.model.state import Model

DIFFERENCE_STEP: Final = 1e-4
"""Over tau, by which a law's rate looks to either side: contacts vibrate with about a radian a tau."""
LOOKS: Final = 65
"""Times in a run at which the size of a law's torque is looked at,"""
ANGLES: Final = 24
"""and angles of the shaft at each of them."""
JUMP_LOOKS: Final = 100_000
"""Times in a run, and angles in a turn, at which a law that says nothing is looked at for jumps."""
HALVINGS: Final = 100
"""Of the time between two looks, at most: a jump is then known to rounding."""
SPEED_HALVINGS: Final = 8
"""Of a range of speeds: a slope has then a 256th of its change."""
LEAST_JUMP: Final = 1e-6
"""Change between two looks, over the range of the law, below which it is no jump but rounding."""
SHIFT: Final = 8.0 * float(np.finfo(float).eps)
"""Of a knot's time: by so much both sides of it are off, as its time over tau is rounded."""
MISFIT: Final = 0.3
"""Fourth difference of five values of a law in a step, over their range, above which it jumps or has a kink there.

A jump between any two of them has 1 or more; a harmonic that turns by a radian in the step has 0.03."""

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


def switch_address(name: str) -> int:
    """Address of the compiled function that changes its sign where a law switches; 0 if it has none.

    Raises
    ------
    SceneError
        If numba cannot compile it to a function that returns a number.
    """
    switch = torque_law(name).switch
    if switch is None:
        return 0
    with _refusing(name, "the switch of this law"):
        return int(_compile(switch, True, False).address)


def law_knots(name: str, parameters: Sequence[float], begin: float, end: float) -> list[float]:
    """Times [s] at which a law jumps, as it says itself, or as they are found where it says nothing.

    Parameters
    ----------
    name : str
        Of a registered law.
    parameters : sequence of float
    begin, end : float
        Of the run [s].

    Raises
    ------
    SceneError
        If what the law says is no list of finite times.
    """
    law = torque_law(name)
    if law.knots is None:
        if law.switch is not None:
            return []
        found = _found_jumps(law, tuple(parameters), (begin, end), False, ((0.0, 0.0), (0.0, 1.0)))
        return sorted({t for times in found for t in times})
    try:
        times = np.array(law.knots(np.array(parameters, dtype=np.float64), end), dtype=np.float64).ravel()
    except (TypeError, ValueError, IndexError, ArithmeticError) as error:
        raise SceneError("law.name", name, f"its knots are no list of times: {error}") from error
    if not np.isfinite(times).all():
        raise SceneError("law.name", name, "its knots must be finite times")
    return [float(t) for t in times]


def found_angles(
    name: str, parameters: Sequence[float], begin: float, end: float
) -> tuple[tuple[float, ...], ...]:
    """Angles [rad] of a turn just behind the jumps of a law that says nothing, at two times of a run.

    Parameters
    ----------
    name : str
        Of a registered law.
    parameters : sequence of float
    begin, end : float
        Of the run [s].

    Returns
    -------
    tuple of tuple of float
        At the beginning at rest, and in the middle at 1 rad/s; empty for a law that does not know the angle or says
        where it jumps.
    """
    law = torque_law(name)
    if law.is_declared or not law.takes_angle:
        return ()
    looks = ((begin, 0.0), (0.5 * (begin + end), 1.0))
    return _found_jumps(law, tuple(parameters), (0.0, 2.0 * math.pi), True, looks)


def shortest_sector(name: str, parameters: Sequence[float], begin: float, end: float) -> float:
    """Least angle [rad] between two jumps of a law, of those that `found_angles` finds; 0 if it finds none.

    No less than the distance of two looks: what is shorter is an end of the turn, on both sides of which jumps are
    found.
    """
    turn = 2.0 * math.pi
    found = [angles for angles in found_angles(name, parameters, begin, end) if angles]
    least = min((float(np.diff([*angles, angles[0] + turn]).min()) for angles in found), default=0.0)
    return max(least, turn / JUMP_LOOKS) if found else 0.0


@lru_cache(maxsize=64)
def _found_jumps(
    law: TorqueLaw,
    parameters: tuple[float, ...],
    way: tuple[float, float],
    by_angle: bool,
    looks: tuple[tuple[float, float], ...],
) -> tuple[tuple[float, ...], ...]:
    """Points just behind the jumps of a law along a way, in angle [rad] or in time [s], for each look.

    A look along the angle is a time and a speed; along the time its second number is both angle and speed. Results are
    kept: a run, its warnings and the members of a study ask for the same, and a search takes 2 ms.
    """
    numbers, points = np.array(parameters, dtype=np.float64), np.linspace(*way, JUMP_LOOKS + 1)
    with _refusing(law.name, "this torque law"):
        search = _jump_search(law.function, law.takes_angle, law.has_force)
        return tuple(tuple(map(float, search(points, by_angle, t, at, numbers))) for t, at in looks)


@cache
def _jump_search(function: Callable[..., Any], takes_angle: bool, has_force: bool) -> Any:
    """Compile the search for jumps of a law, along the time or along the angle."""
    from gearidae.compiled.cache import numba

    law: Any = numba.njit(error_model="numpy")(getattr(function, "py_func", function))

    @numba.njit(error_model="numpy")
    def torque(x: float, by_angle: bool, t: float, at: float, p: Any) -> Any:
        then, angle = (t, x) if by_angle else (x, at)
        number = law(then, angle, at, p) if takes_angle else law(then, at, p)
        return number[0] if has_force else number

    @numba.njit(error_model="numpy")
    def search(way: Any, by_angle: bool, t: float, at: float, p: Any) -> Any:
        values = np.empty(way.size)
        for i in range(way.size):
            values[i] = torque(way[i], by_angle, t, at, p)
        enough, found = LEAST_JUMP * (values.max() - values.min()), []
        for i in range(way.size - 1):
            change = abs(values[i + 1] - values[i])
            if not change > enough:
                continue
            a, b, low, high = way[i], way[i + 1], values[i], values[i + 1]
            for _ in range(HALVINGS):
                middle = 0.5 * (a + b)
                # of what is smooth, the change in the half shrinks with it
                if not a < middle < b or abs(high - low) < 0.5 * change:
                    break
                value = torque(middle, by_angle, t, at, p)
                if abs(value - low) > abs(high - value):
                    b, high = middle, value
                else:
                    a, low = middle, value
            if abs(high - low) >= 0.5 * change and b - a <= 1e-15 * abs(b):
                found.append(b)
        return np.array([*found, np.inf])[:-1]  # numba does not know the type of an empty list

    return search


def _callback(name: str) -> Any:
    with _refusing(name, "this torque law"):
        law = torque_law(name)
        return _compile(law.function, law.takes_angle, law.has_force)


@contextmanager
def _refusing(name: str, what: str) -> Iterator[None]:
    """Refuse what numba cannot compile, by the key of the law."""
    from gearidae.compiled.cache import numba

    try:
        yield
    except numba.core.errors.NumbaError as error:
        reason = str(error).strip().partition("\n")[0]
        raise SceneError("law.name", name, f"numba cannot compile {what}: {reason}") from error


@cache
def _compile(function: Callable[..., Any], takes_angle: bool, has_force: bool) -> Any:
    """Compile a law; what has been compiled stays, as its address may be in use."""
    from gearidae.compiled.cache import numba

    types: Any = numba.types
    carray: Any = numba.carray  # type: ignore[attr-defined]
    numbers = types.CPointer(types.float64)
    signature = types.float64(types.float64, types.float64, types.float64, numbers, types.int64, types.int64)
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

    return numba.cfunc(signature)(torque_or_force if has_force else torque)


@compiled
def _number(m: Model, shaft: int, which: int, t: float, angle: float, speed: float) -> float:
    """Number of a shaft's law in SI units, at a scaled time and speed and an angle [rad].

    Between two knots the law is that of this time, on both of them, too, as the segments of schedules are.
    """
    if m.work.law_until > 0.0:
        t = min(max(t, m.work.law_from), m.work.law_until)
    return _of_law(m, m.work.torque_law[shaft], shaft, which, t, angle, speed)


@compiled
def switch_value(m: Model, shaft: int, t: float, angle: float, speed: float) -> float:
    """Function that changes its sign where a shaft's law switches, of a law that has one."""
    return _of_law(m, m.work.torque_switch[shaft], shaft, _TORQUE, t, angle, speed)


@compiled
def _of_law(m: Model, address: int, shaft: int, which: int, t: float, angle: float, speed: float) -> float:
    """Number of a compiled function of a shaft's law."""
    torque = m.scene.torque[shaft]
    return call_at(
        address,
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
    """Rate of change of `law_value` along the motion, by a central difference; one-sided where the law begins or jumps.

    Of a law that says nothing of its jumps, slopes to both sides that differ by more than half of the steeper show one.
    """
    low, high = _around(m, shaft, t, angle, speed, acceleration)
    if high == low:
        return 0.0
    before = law_value(m, shaft, low, *_moved(m, shaft, low - t, angle, speed, acceleration))
    after = law_value(m, shaft, high, *_moved(m, shaft, high - t, angle, speed, acceleration))
    rate = (after - before) / (high - low)
    if m.scene.torque[shaft].law_unknown != 0 and low < t < high:
        here = law_value(m, shaft, t, angle, speed)
        back, ahead = (here - before) / (t - low), (after - here) / (high - t)
        if abs(ahead - back) > 0.5 * max(abs(ahead), abs(back)):
            rate = back if abs(back) < abs(ahead) else ahead
    return rate


@compiled
def _around(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float
) -> tuple[float, float]:
    """Times to either side of a time, in the run, between two knots and on one side of a switch, for a difference."""
    low, high = max(t - DIFFERENCE_STEP, 0.0), t + DIFFERENCE_STEP
    if m.work.law_until > 0.0:  # beyond, the law stays as it is there, and the difference would be too small
        low, high = max(low, m.work.law_from), min(high, m.work.law_until)
    if m.work.torque_switch[shaft] != 0:
        if not on_its_side(m, shaft, low, *_moved(m, shaft, low - t, angle, speed, acceleration)):
            low = t
        if not on_its_side(m, shaft, high, *_moved(m, shaft, high - t, angle, speed, acceleration)):
            high = t
    return low, high


@compiled
def on_its_side(m: Model, shaft: int, t: float, angle: float, speed: float) -> bool:
    """Whether a shaft's law has not yet switched since the beginning of the step."""
    side = m.work.law_side[shaft]
    return bool(side == 0.0 or side * switch_value(m, shaft, t, angle, speed) >= 0.0)


@compiled
def last_on_its_side(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float
) -> tuple[float, float, float]:
    """Time, angle and speed of a shaft at a time, or just before where its law has switched at that time.

    A root lies just behind a zero of the law's function; what a step has done until there it has done before.
    """
    if m.work.torque_switch[shaft] == 0 or on_its_side(m, shaft, t, angle, speed):
        return t, angle, speed
    return t - DIFFERENCE_STEP, *_moved(m, shaft, -DIFFERENCE_STEP, angle, speed, acceleration)


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
    low, high = _around(m, shaft, t, angle, speed, acceleration)
    if high == low:
        return 0.0, 0.0
    before = law_force(m, shaft, low, *_moved(m, shaft, low - t, angle, speed, acceleration))
    after = law_force(m, shaft, high, *_moved(m, shaft, high - t, angle, speed, acceleration))
    return (after[0] - before[0]) / (high - low), (after[1] - before[1]) / (high - low)


@compiled
def law_jump(
    m: Model, shaft: int, t: float, h: float, first: tuple[float, float], last: tuple[float, float]
) -> float:
    """Range of a shaft's law (as `law_value`) on a straight way on which it has a jump or a kink; 0 where it has none.

    Parameters
    ----------
    m : Model
    shaft : int
    t, h : float
        Beginning and length of the way, over tau.
    first, last : tuple of two floats
        Angle [rad] and scaled speed of the shaft at both ends.
    """
    low, high, jumps, parts = math.inf, -math.inf, False, 1
    sector = m.scene.torque[shaft].law_sector
    if sector > 0.0:  # five values of a longer way may lie in sectors that are alike
        parts = math.ceil(max(abs(last[0] - first[0]) / sector, 1.0))
    for part in range(parts):
        fourth, least, most, sign = 0.0, math.inf, -math.inf, 1.0
        for i in range(5):
            share = (part + 0.25 * i) / parts
            value = law_value(
                m,
                shaft,
                t + share * h,
                first[0] + share * (last[0] - first[0]),
                first[1] + share * (last[1] - first[1]),
            )
            least, most = min(least, value), max(most, value)
            fourth += sign * (1.0 if i in (0, 4) else 6.0 if i == 2 else 4.0) * value
            sign = -sign
        jumps |= abs(fourth) > MISFIT * (most - least)
        low, high = min(low, least), max(high, most)
    return high - low if jumps else 0.0


@compiled
def jumps_with_speed(m: Model, shaft: int, t: float, angle: float, between: tuple[float, float]) -> bool:
    """Whether a shaft's law jumps between two scaled speeds, as a function of the speed alone.

    Bisection towards the larger change: of a jump it stays what it is, of a slope or a kink it shrinks with the way.
    """
    low, high = between
    below, above = law_value(m, shaft, t, angle, low), law_value(m, shaft, t, angle, high)
    change = abs(above - below)
    for _ in range(SPEED_HALVINGS):
        middle = 0.5 * (low + high)
        value = law_value(m, shaft, t, angle, middle)
        if abs(value - below) > abs(above - value):
            high, above = middle, value
        else:
            low, below = middle, value
    return bool(abs(above - below) > 0.5 * change)


# -- its verbs -------------------------------------------------------------------------------------------------------


@compiled(inline=True)
def _force(m: Model, shaft: int, t: float, angle: float, speed: float, value: float) -> float:
    if m.work.torque_law[shaft] != 0:
        value += law_value(m, shaft, t, angle, speed)
    return value


@compiled
def _rate(
    m: Model, shaft: int, t: float, angle: float, speed: float, acceleration: float, value: float
) -> float:
    if m.work.torque_law[shaft] != 0:
        value += law_rate(m, shaft, t, angle, speed, acceleration)
    return value


@compiled
def _is_constant(m: Model, shaft: int, value: bool) -> bool:
    return bool(value and m.work.torque_law[shaft] == 0)


@compiled
def _is_steady(m: Model, shaft: int, t: float, value: bool) -> bool:
    return bool(value and m.work.torque_law[shaft] == 0)


OWN = ShaftLaw(
    "law",
    drives=True,
    fields=(
        ("law_count", INT),  # parameters of the law, whose address is in `WORK` [1]
        ("law_at", INT),  # the parameters among the tables [index]
        ("law_unknown", INT),  # 1 if the law says nothing of where it jumps
        ("law_sector", REAL),  # least angle between two jumps found of it, 0 without any [rad]
        ("law_torque", REAL),  # unit of the law's torque [N m]
        ("law_speed", REAL),  # unit of the shaft's speed [rad/s]
    ),
    force=_force,
    rate=_rate,
    is_constant=_is_constant,
    is_steady=_is_steady,
)
