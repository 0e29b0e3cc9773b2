"""Two involute gears in mesh: path of contact, radii of curvature, flank separation.

Standard full-depth spur gears at their nominal centre distance: the addendum is one module. Lengths along the
path of contact are counted by ``xi``, 0 where a pair of teeth comes into mesh (at the gear's tip) and
``path_length`` where it leaves (at the pinion's tip).

Teodorescu et al. 2009 (doi:10.1016/j.triboint.2008.05.019), Fig. 1 and Eqs. 4-6, with the standard geometry
of the involute where the paper prints none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats


class GeometryError(ValueError):
    """Two such gears cannot mesh.

    Parameters
    ----------
    parameter : str
        The argument of `mesh_geometry` to change: ``pinion_teeth``, ``gear_teeth`` or ``pressure_angle``.
    reason : str
        The reason, in words.
    """

    def __init__(self, parameter: str, reason: str) -> None:
        self.parameter = parameter
        self.reason = reason
        super().__init__(f"{parameter}: {reason}")

    def __reduce__(self) -> tuple[type[GeometryError], tuple[str, str]]:
        """Support pickling between processes, which rebuilds an exception from its arguments."""
        return type(self), (self.parameter, self.reason)


@dataclass(frozen=True, slots=True)
class Geometry:
    """Geometry of a gear pair; lengths in m, angle in rad.

    Attributes
    ----------
    pinion_teeth, gear_teeth : int
        Numbers of teeth.
    pressure_angle : float
        Pressure angle at the pitch circle [rad].
    base_radius_pinion, base_radius_gear : float
        Base circle radii R1 and R2 = R1 z2 / z1 [m].
    module : float
        Pitch diameter over number of teeth [m]; also the addendum.
    base_pitch : float
        Distance of neighbouring flanks along the path of contact [m].
    approach, recess : float
        Length of the path of contact before and after the pitch point [m].
    tangent_pinion, tangent_gear : float
        R1 tan(alpha) and R2 tan(alpha): distances from the pitch point to the points where the line of action
        touches the base circles, which are the radii of curvature of the flanks at the pitch point [m].
    """

    pinion_teeth: int
    gear_teeth: int
    pressure_angle: float
    base_radius_pinion: float
    base_radius_gear: float
    module: float
    base_pitch: float
    approach: float
    recess: float
    tangent_pinion: float
    tangent_gear: float

    @property
    def path_length(self) -> float:
        """Length of the path of contact [m]."""
        return self.approach + self.recess

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs in mesh: path of contact over base pitch."""
        return self.path_length / self.base_pitch


@lru_cache(maxsize=64)
def mesh_geometry(base_radius: float, pinion_teeth: int, gear_teeth: int, pressure_angle: float) -> Geometry:
    """Lay out a pair of standard involute gears and check that it can run.

    Parameters
    ----------
    base_radius : float
        Base radius of the pinion R1 [m]; that of the gear follows from the numbers of teeth.
    pinion_teeth, gear_teeth : int
        Numbers of teeth z1, z2.
    pressure_angle : float
        Pressure angle alpha [rad], 0 < alpha < pi/2.

    Raises
    ------
    GeometryError
        If such gears cannot run, see `check_geometry`.

    Notes
    -----
    With module ``m = 2 R1 / (z1 cos alpha)`` and tip radii ``Ra = R / cos alpha + m``::

        base pitch   2 pi R1 / z1
        approach     sqrt(Ra2^2 - R2^2) - R2 tan alpha
        recess       sqrt(Ra1^2 - R1^2) - R1 tan alpha

    Examples
    --------
    >>> round(mesh_geometry(34.715e-6, 19, 76, math.radians(20)).contact_ratio, 3)
    1.681
    """
    gear_radius = base_radius * gear_teeth / pinion_teeth
    cos_alpha, tan_alpha = math.cos(pressure_angle), math.tan(pressure_angle)
    module = 2 * base_radius / (pinion_teeth * cos_alpha)
    tangent_pinion, tangent_gear = base_radius * tan_alpha, gear_radius * tan_alpha
    geometry = Geometry(
        pinion_teeth=pinion_teeth,
        gear_teeth=gear_teeth,
        pressure_angle=pressure_angle,
        base_radius_pinion=base_radius,
        base_radius_gear=gear_radius,
        module=module,
        base_pitch=2 * math.pi * base_radius / pinion_teeth,
        approach=_beyond_pitch_point(gear_radius, module, cos_alpha, tangent_gear),
        recess=_beyond_pitch_point(base_radius, module, cos_alpha, tangent_pinion),
        tangent_pinion=tangent_pinion,
        tangent_gear=tangent_gear,
    )
    check_geometry(geometry)
    return geometry


def check_geometry(geometry: Geometry) -> None:
    """Refuse a pair that cannot run.

    Raises
    ------
    GeometryError
        If the tip of one gear would cut below the other's base circle (undercut), if the contact ratio is
        below 1, or if teeth come to a point before their full height.

    Notes
    -----
    The involute begins at the base circle, so contact must not pass the points where the line of action
    touches the base circles: ``approach < R1 tan alpha`` and ``recess < R2 tan alpha``.
    """
    for cut, other, too_far in (
        ("pinion", "gear", geometry.approach >= geometry.tangent_pinion),
        ("gear", "pinion", geometry.recess >= geometry.tangent_gear),
    ):
        if too_far:
            raise GeometryError(
                f"{cut}_teeth",
                f"the {other}'s tips would undercut the {cut}: needs more teeth or a larger pressure angle",
            )
    if geometry.contact_ratio < 1:
        raise GeometryError(
            "pressure_angle",
            f"contact ratio {geometry.contact_ratio:.3f} is below 1: needs a smaller pressure angle",
        )
    for teeth in (geometry.pinion_teeth, geometry.gear_teeth):
        if _tip_thickness(teeth, geometry.pressure_angle) <= 0:
            raise GeometryError(
                "pressure_angle", f"gears of {teeth} teeth come to a point: needs a smaller pressure angle"
            )


def curvature_radii(geometry: Geometry, xi: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Radii of curvature of both flanks where a pair touches.

    Parameters
    ----------
    xi : array_like, any shape
        Position along the path of contact [m]. Outside the path the contact stays at the tooth's end, and the
        radii keep their values there.

    Returns
    -------
    pinion, gear, reduced : ndarray, shape of `xi`
        ``r1 = R1 tan alpha - approach + xi``, ``r2 = (R1 + R2) tan alpha - r1``, ``r1 r2 / (r1 + r2)`` [m].
    """
    along = np.clip(np.asarray(xi, dtype=np.float64), 0.0, geometry.path_length)
    pinion = (geometry.tangent_pinion - geometry.approach) + along
    total = geometry.tangent_pinion + geometry.tangent_gear
    gear = total - pinion
    return pinion, gear, pinion * gear / total


def flank_arc(geometry: Geometry, xi: ArrayLike) -> Floats:
    """Arc of the pinion's involute from the base circle to where a pair touches.

    Parameters
    ----------
    xi : array_like, any shape
        Position along the path of contact [m]; outside the path the contact stays at the tooth's end.

    Returns
    -------
    ndarray, shape of `xi`
        ``r1^2 / (2 R1)`` [m], with the pinion's radius of curvature r1.
    """
    return np.asarray(curvature_radii(geometry, xi)[0] ** 2 / (2.0 * geometry.base_radius_pinion))


def position_of_arc(geometry: Geometry, arc: ArrayLike) -> Floats:
    """Position along the path of contact of a point on the pinion's flank: the inverse of `flank_arc`.

    Parameters
    ----------
    arc : array_like, any shape
        From the base circle along the involute [m]; less than zero counts as zero.

    Returns
    -------
    ndarray, shape of `arc`
        xi [m], outside 0 .. `Geometry.path_length` where the flank goes on beyond the path.
    """
    curvature = np.sqrt(2.0 * geometry.base_radius_pinion * np.maximum(arc, 0.0))
    return np.asarray(curvature - (geometry.tangent_pinion - geometry.approach))


def separation(geometry: Geometry, xi: ArrayLike, tip_relief_radius: float) -> tuple[Floats, Floats]:
    """Additional gap of a pair outside the path of contact because of the rounded tooth end.

    Parameters
    ----------
    xi : array_like, any shape
        Position along the path of contact [m].
    tip_relief_radius : float
        Radius rho of the tooth's end [m].

    Returns
    -------
    s, slope : ndarray, shape of `xi`
        ``s = d^2 / (2 rho)`` [m] and ``ds/dxi``, where d is the distance from `xi` to the path; both 0 on it.
    """
    at = np.asarray(xi, dtype=np.float64)
    outside = at - np.clip(at, 0.0, geometry.path_length)
    slope = outside / tip_relief_radius
    return 0.5 * outside * slope, slope


def _beyond_pitch_point(radius: float, module: float, cos_alpha: float, tangent: float) -> float:
    """Path of contact from the pitch point to where the tip circle over base circle `radius` cuts it [m]."""
    tip = radius / cos_alpha + module
    return math.sqrt(tip**2 - radius**2) - tangent


def _tip_thickness(teeth: int, pressure_angle: float) -> float:
    """Thickness of a tooth at its tip circle over the tip radius, for a tooth half a pitch thick [rad]."""
    tip_angle = math.acos(math.cos(pressure_angle) / (1 + 2 / teeth))
    return math.pi / teeth + 2 * (_involute(pressure_angle) - _involute(tip_angle))


def _involute(angle: float) -> float:
    return math.tan(angle) - angle
