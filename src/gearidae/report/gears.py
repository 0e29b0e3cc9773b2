"""Outlines of the gears of a scene for the scripts of a page, ``mesh.js``."""

from __future__ import annotations

import math
from typing import Any

from gearidae.plot.tooth_shape import ToothedWheel, tooth_outline
from gearidae.scene import Scene


def pack_gears(scene: Scene, *, gaps: float = 1.0, most_play: float = math.inf) -> dict[str, Any]:
    """Pack what a page needs to draw the gears of a scene.

    Parameters
    ----------
    scene : Scene
        With gears.
    gaps, most_play : float, optional
        As for `gearidae.plot.tooth_outline`.

    Returns
    -------
    dict
        ``module``, ``approach``, ``path``, ``pitch``, ``halfBacklash`` and ``play`` [m], ``angle`` [rad], ``gaps``,
        and of ``pinion`` and ``gear``: ``tooth``, ``centre`` and ``rim`` in modules, ``base`` [m], ``teeth``,
        ``turning``, and ``errors``: the angles by which teeth are drawn back [rad], none where all are alike.
    """
    picture, module = tooth_outline(scene, gaps=gaps, most_play=most_play), scene.geometry.module
    return {
        "module": module,
        "approach": picture.geometry.approach,
        "path": picture.geometry.path_length,
        "angle": picture.geometry.pressure_angle,
        "pitch": picture.geometry.base_pitch,
        "halfBacklash": picture.half_backlash,
        "play": picture.play,
        "gaps": picture.gaps,
        "pinion": _wheel(picture.pinion, module),
        "gear": _wheel(picture.gear, module),
    }


def _wheel(wheel: ToothedWheel, module: float) -> dict[str, Any]:
    return {
        "tooth": [round(float(number), 4) for number in (wheel.tooth / module).ravel()],
        "teeth": wheel.teeth,
        "centre": wheel.centre / module,
        "base": wheel.base_radius,
        "rim": wheel.rim_radius / module,
        "turning": wheel.turning,
        "errors": [float(f"{error:.4g}") for error in wheel.errors / wheel.base_radius]
        if wheel.errors.any()
        else [],
    }
