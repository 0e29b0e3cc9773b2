r"""Outlines of two gears in mesh, and the points at which their teeth meet.

The pitch point is the origin, the pinion lies above and turns counter-clockwise, the gear lies below and turns
clockwise. Contacts of the drive flank travel along the line of action
:math:`\mathbf n = (\cos\alpha, -\sin\alpha)`, which touches the pinion's base circle at :math:`-R_1
\tan\alpha\,\mathbf n` and the gear's at :math:`R_2 \tan\alpha\,\mathbf n`; those of the coast flank along its mirror
image. A flank is the end of a string that unwinds from the base circle. Beyond the path of contact the tooth ends are
rounded: the flank recedes by :math:`d^2 / 2\rho`, as in the model (`gearidae.mesh.separation`).

Both flanks of a gear's tooth are half a pitch apart; the whole backlash is taken from the pinion's teeth, so that a
pair's position along the line of action is where the gear's flank crosses it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.mesh.involute import Geometry
from gearidae.records import Flank
from gearidae.scene import Scene, require_gears
from gearidae.scene.pitch_errors import errors_of_teeth

_FLANK_POINTS = 40
_DEDENDUM = 1.25  # modules
_ROUNDED = 8.0
"""The rounded end of a tooth is drawn until it has receded by this many roughnesses."""
_TALLEST = 1.18
"""Modules above the pitch circle at most: below the other gear's root."""
_RIM = 1.6
"""Modules of the wheel's body shown below its roots."""


@dataclass(frozen=True, slots=True)
class ToothedWheel:
    """One gear in its own frame, centre at the origin.

    Attributes
    ----------
    tooth : ndarray, shape (n, 2)
        Outline of tooth 0 from the root of its drive flank to that of its coast flank, clockwise [m], where its drive
        flank crosses the pitch point.
    centre : float
        Height of the centre over the pitch point [m].
    base_radius, tip_radius, rim_radius : float
        Base circle, largest radius of the teeth, and depth to which the body is drawn [m].
    turning : int
        1 counter-clockwise, -1 clockwise.
    errors : ndarray, shape (teeth,)
        How far each tooth is drawn back from its drive flank [m].
    """

    tooth: Floats
    teeth: int
    centre: float
    base_radius: float
    tip_radius: float
    rim_radius: float
    turning: int
    errors: Floats

    def outline(self, turned: float = 0.0, count: int | None = None) -> Floats:
        """Outline of the wheel, or of the teeth nearest to the mesh, closed by the rim.

        Parameters
        ----------
        turned : float, optional
            Angle that tooth 0 has turned beyond the pitch point [rad], in the wheel's own sense.
        count : int, optional
            Teeth on either side of the one at the pitch point; by default all.

        Returns
        -------
        ndarray, shape (n, 2)
            Points [m], the pitch point at the origin.
        """
        pitch = 2.0 * math.pi / self.teeth
        if count is None:
            whole: Floats = self._teeth_at(turned, range(self.teeth), 0) + np.array([0.0, self.centre])
            return whole
        count = min(count, (self.teeth - 1) // 2)
        passed = round(turned / pitch)
        body = self._teeth_at(turned - passed * pitch, range(-count, count + 1), passed)
        first, last = (math.atan2(point[1], point[0]) for point in (body[0], body[-1]))
        back = np.linspace(last, last + (first - last) % (2.0 * math.pi), 40)
        rim = self.rim_radius * np.stack([np.cos(back), np.sin(back)], axis=1)
        outline: Floats = np.concatenate([body, rim]) + np.array([0.0, self.centre])
        return outline

    def _teeth_at(self, turned: float, numbers: Iterable[int], passed: int) -> Floats:
        """Outlines of teeth one after another, clockwise as the points of a tooth, after so many have passed."""
        pitch = 2.0 * math.pi / self.teeth
        outlines = []
        for k in numbers:
            # teeth that follow lag behind, in the wheel's own sense
            error = float(self.errors[(passed + self.turning * k) % self.teeth])
            # the pinion's drive flank leads and the gear's trails: both stand back clockwise
            outlines.append(
                _rotated(self.tooth, self.turning * turned - k * pitch - error / self.base_radius)
            )
        return np.concatenate(outlines)


@dataclass(frozen=True, slots=True)
class GearPicture:
    """Both gears and the line of action of a scene; lengths in m.

    Attributes
    ----------
    geometry : Geometry
    pinion, gear : ToothedWheel
    half_backlash : float
        Half of the backlash, times `gaps` [m].
    gaps : float
        How many times its size a gap is drawn.
    play : float
        Backlash as it is drawn [m].
    """

    geometry: Geometry
    pinion: ToothedWheel
    gear: ToothedWheel
    half_backlash: float
    gaps: float
    play: float

    def turned(
        self, travel: float, transmission_error: float, flank: Flank = Flank.DRIVE
    ) -> tuple[float, float]:
        """Angles that tooth 0 of pinion and gear have turned beyond the pitch point [rad].

        A static transmission error is drawn as a turn of the pinion, so that the drawn gap of the flank is true.
        """
        beyond = travel - self.geometry.approach
        ahead = self.gaps * transmission_error - self.half_backlash
        if flank == Flank.COAST:
            ahead += 2.0 * self.half_backlash - self.play
        pinion = (beyond + ahead) / self.geometry.base_radius_pinion
        return pinion, beyond / self.geometry.base_radius_gear

    def line(self, flank: Flank, position: float) -> Floats:
        """Point of a flank's line of action, by its position along the path of contact [m]."""
        beyond, angle = position - self.geometry.approach, self.geometry.pressure_angle
        across = math.cos(angle) if flank == Flank.DRIVE else -math.cos(angle)
        return np.array([beyond * across, -beyond * math.sin(angle)])


def tooth_outline(scene: Scene, *, gaps: float = 1.0, most_play: float = math.inf) -> GearPicture:
    r"""Lay out the gears of a scene: the outlines of their teeth, to scale, and where they stand to each other.

    Parameters
    ----------
    scene : Scene
        With gears.
    gaps : float, optional
        How many times their size the gaps between the teeth are drawn, on both flanks alike: the pinion's teeth are
        thinner by so many times the backlash. Gaps are nanometres beside micrometres of a module. Errors of single
        teeth are drawn as many times their size.
    most_play : float, optional
        Backlash that is drawn at most, in pitches along the path of contact. Where `gaps` times the scene's is more,
        the gap of one flank at a time is drawn so many times its size.

    Returns
    -------
    GearPicture
        ``pinion.tooth`` and ``gear.tooth``, shape (n, 2) [m]: one tooth in the frame of its gear;
        ``pinion.outline()`` and ``gear.outline()``: the whole gear, with the pitch point as origin;
        ``turned(travel, transmission_error)``: the angles of both at a sample of a run.

    Raises
    ------
    SceneError
        If the scene has no gears, or `gaps` is no positive number, or so large that it leaves no teeth.

    Notes
    -----
    Involutes of standard full-depth teeth between the root circle, 1.25 modules below the pitch circle, and the tips;
    tooth ends recede by :math:`d^2 / 2\rho` as in the model (Teodorescu et al. 2009,
    doi:10.1016/j.triboint.2008.05.019).
    """
    scene = require_gears(scene)
    sizes = scene.mesh.backlash, scene.mesh.tip_relief_radius, scene.surface.roughness
    return gear_picture(scene.geometry, sizes, errors_of_teeth(scene), gaps=gaps, most_play=most_play)


def gear_picture(
    geometry: Geometry,
    sizes: tuple[float, float, float],
    errors: tuple[Floats, Floats] | None = None,
    *,
    gaps: float = 1.0,
    most_play: float = math.inf,
    of_gear: float = 0.0,
) -> GearPicture:
    """Lay out two gears in mesh, as `tooth_outline` does.

    Parameters
    ----------
    sizes : tuple of float
        Backlash, radius of the tooth ends and roughness [m].
    errors : tuple of ndarray, optional
        Of the teeth of both gears [m].
    of_gear : float, optional
        Share of the backlash that is taken from the gear's teeth, the rest from the pinion's.
    """
    play, relief, roughness = sizes
    backlash = min(gaps * play, most_play * geometry.base_pitch)
    if not 0.0 <= backlash < 0.5 * geometry.base_pitch or not gaps > 0.0:
        most = 0.5 * geometry.base_pitch / play if play else math.inf
        raise SceneError(
            "gaps", gaps, f"must be positive and less than {most:.3g}, which leaves the pinion no teeth"
        )
    rounding = relief, _ROUNDED * roughness
    half_pitch = 0.5 * geometry.base_pitch
    alike = np.zeros(geometry.pinion_teeth), np.zeros(geometry.gear_teeth)
    pinion, gear = (gaps * error for error in errors or alike)
    return GearPicture(
        geometry=geometry,
        pinion=_wheel(
            geometry, pinion, geometry.recess, half_pitch - (1.0 - of_gear) * backlash, rounding, 1
        ),
        gear=_wheel(geometry, gear, geometry.approach, half_pitch - of_gear * backlash, rounding, -1),
        half_backlash=0.5 * gaps * play,
        gaps=gaps,
        play=backlash,
    )


def contact_points(picture: GearPicture, flank: Flank, position: float, gap: float) -> tuple[Floats, Floats]:
    """Where a pair's two flanks cross the line of action.

    Parameters
    ----------
    position : float
        Position xi along the path of contact [m].
    gap : float
        Gap of the pair [m].

    Returns
    -------
    pinion, gear : ndarray, shape (2,)
        Points [m], a gap apart. Relief of rounded ends is left to the pinion's.
    """
    return picture.line(flank, position - picture.gaps * gap), picture.line(flank, position)


def _wheel(
    geometry: Geometry,
    errors: Floats,
    beyond_pitch: float,
    thickness: float,
    rounding: tuple[float, float],
    turning: int,
) -> ToothedWheel:
    """Lay out one gear.

    Parameters
    ----------
    errors : ndarray, shape (teeth,)
        How far each tooth is drawn back [m].
    beyond_pitch : float
        How far beyond the pitch point its tips stay in contact, along the line of action [m].
    thickness : float
        Arc between the flanks of one tooth along the base circle's pitch, as seen at the pitch circle [m].
    rounding : tuple of float
        Radius of the tooth ends and how far they may recede [m].
    turning : int
        1 for the pinion, -1 for the gear.
    """
    module, alpha, teeth = geometry.module, geometry.pressure_angle, errors.size
    pitch_radius = 0.5 * teeth * module
    base = pitch_radius * math.cos(alpha)
    root = pitch_radius - _DEDENDUM * module
    tangent = base * math.tan(alpha)
    end = tangent + beyond_pitch
    radius, depth = rounding
    tallest = math.sqrt((pitch_radius + _TALLEST * module) ** 2 - base**2)
    longest = min(end + math.sqrt(2.0 * radius * depth), max(tallest, end))
    begin = math.sqrt(root**2 - base**2) if root > base else 0.0
    string = np.concatenate(
        [np.linspace(begin, end, _FLANK_POINTS), np.linspace(end, longest, 8)[1:] if longest > end else []]
    )
    length = string - np.maximum(string - end, 0.0) ** 2 / (2.0 * radius)
    # the pinion's frame: centre above the pitch point, string along n from the point where it touches the circle
    unwound = -(string - tangent) / base
    touch = np.array([-base * math.sin(alpha), -base * math.cos(alpha)])
    along = np.array([math.cos(alpha), -math.sin(alpha)])
    cos, sin = np.cos(unwound), np.sin(unwound)
    x, y = (touch[:, None] + along[:, None] * length).reshape(2, -1)
    flank = np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)
    if root < base:
        flank = np.concatenate([flank[:1] * (root / base), flank])
    other = _rotated(flank * np.array([-1.0, 1.0]), -thickness / base)
    low, high = (math.atan2(point[1], point[0]) for point in (other[-1], flank[-1]))
    land = np.linspace(low, high, 6)[1:-1]
    tip = float(np.hypot(*flank[-1]))
    top = tip * np.stack([np.cos(land), np.sin(land)], axis=1)
    # from the trailing flank over the tip to the drive flank; the gear is the pinion's picture turned upside down
    tooth = np.concatenate([flank, top[::-1], other[::-1]]) * turning
    return ToothedWheel(
        tooth, teeth, turning * pitch_radius, base, tip, root - _RIM * module, turning, errors
    )


def _rotated(points: Floats, angle: float) -> Floats:
    """Turn points counter-clockwise about the origin."""
    cos, sin = math.cos(angle), math.sin(angle)
    turned: Floats = points @ np.array([[cos, sin], [-sin, cos]])
    return turned
