"""A motor whose torque falls linearly with its speed, for example a DC motor at constant voltage."""

from __future__ import annotations

from gearidae.torques.registry import Parameters, register_torque


@register_torque("motor", parameters=2, knots=lambda p, t_end: ())
def motor(t: float, speed: float, p: Parameters) -> float:
    """Torque [N m] of a motor, ``M0 (1 - speed / w0)``.

    Parameters
    ----------
    t : float
        Time [s]; without influence.
    speed : float
        Angular speed of the shaft [rad/s].
    p : ndarray, shape (2,)
        Stall torque M0 [N m] and no-load speed w0 [rad/s].
    """
    return float(p[0] * (1.0 - speed / p[1]))
