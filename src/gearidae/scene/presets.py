"""Ready-made scenes: the experiments of Teodorescu, Theodossiades and Rahnejat (2009), and run-up and braking.

Tribology International 42 (2009) 197-205, doi:10.1016/j.triboint.2008.05.019. Values are those of the paper's
Table 1 and text; what it does not print was inferred and is marked so. The asperity radius is the one fitted
number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.scene import Scene

_Tables = Mapping[str, Mapping[str, Any]]

_SILICON: Final[_Tables] = {
    "surface": {
        "youngs_modulus": 161e9,
        "poisson_ratio": 0.23,
        "energy": 1.5,
        "asperity_density": 1.69e14,  # printed as 169.0, taken per square micrometre
        "asperity_radius": 450e-9,  # fitted: Fig. 2's adhesive dip, Fig. 7's sticking between 50 and 47 %
        "roughness": 6e-9,
    },
}

_PAIR: Final[_Tables] = {
    **_SILICON,
    "gears": {
        "pinion_inertia": 1.5263e-20,
        "gear_inertia": 6.1052e-20,
        "pinion_base_radius": 34.715e-6,
        "pinion_teeth": 19,
        "gear_teeth": 76,
        "pressure_angle": math.radians(20),  # inferred
        "face_width": 2e-6,
    },
    "mesh": {
        "backlash": 0.2e-6,
        "tip_relief_radius": 10e-6,  # inferred
        "radius_force": False,  # Eq. 1 has no such force
    },
    "coating": {"sam_fraction": 1.0, "energy": 0.1},
}

_HIGH_SPEED: Final[_Tables] = {
    **_PAIR,
    "drive": {"torque": 2.43e-11, "harmonic": {"amplitude": 0.3e-11, "frequency": 10e3}},
    "load": {"torque": 3e-11, "drag": 8e-18},
    # Steady: M10 = (R1/R2) (M20 + alpha w^2).
    "initial": {"gear_speed": 2898.0, "gap": "6 sigma", "mesh_phase": 0.3},
    "run": {"duration": 1e-3, "samples": 20_001, "rtol": 1e-6},
}

_LOW_SPEED: Final[_Tables] = {
    **_PAIR,
    "drive": {"torque": 4.5e-18},  # inferred: (R1/R2) alpha (1.5 rad/s)^2
    "load": {"drag": 8e-18},
    "initial": {"gear_speed": 1.5, "gap": "6 sigma", "mesh_phase": 0.3},  # inferred
    "run": {"duration": 0.3, "samples": 30_001, "rtol": 1e-6},
}


def _roller(speed: float, duration: float) -> _Tables:
    """Return the roller of Figs. 2 and 3 at one approach speed, on bare silicon."""
    return {
        **_SILICON,
        "coating": {"sam_fraction": 0.0, "energy": 0.1},
        "roller": {"radius": 5e-6, "mass": 6e-10, "width": 2e-6, "speed": speed, "height": 40e-9},
        "run": {"duration": duration, "samples": 4001, "rtol": 1e-6},
    }


_WORN: Final[_Tables] = {**_PAIR, "coating": {"sam_fraction": 0.6, "energy": 0.1}}
_DRY: Final[Mapping[str, float]] = {"torque": 3e-11, "drag": 8e-18}
_FULL: Final = 2.43e-11  # the drive torque that holds 2898 rad/s against this load
_MORE: Final = 1.63e-11  # what it has beyond a third

_START_UP: Final[_Tables] = {
    **_WORN,
    "drive": {"schedule": [[0.0, 0.0], [0.01, _FULL]]},
    "load": _DRY,
    "initial": {"gear_speed": 0.0, "gap": 0.1e-6, "mesh_phase": 0.3},
    "run": {"duration": 0.05, "samples": 50_001, "rtol": 1e-6},
}

_BRAKING: Final[_Tables] = {
    **_WORN,
    "drive": {"schedule": [[0.0, _FULL], [0.01, _FULL], [0.03, 0.0]]},
    "load": _DRY,
    "initial": {"gear_speed": 2898.0, "gap": "6 sigma", "mesh_phase": 0.3},
    "run": {"duration": 0.05, "samples": 50_001, "rtol": 1e-6},
}

_KNOTS: Final = [
    [0.0, _MORE],
    [0.02, _MORE],
    [0.021, 0.0],
    [0.04, 0.0],
    [0.041, _MORE],
    [0.06, _MORE],
    [0.061, 0.0],
    [0.08, 0.0],
    [0.081, _MORE],
]
_ALTERNATING: Final[_Tables] = {
    **_WORN,
    "drive": {"torque": 0.8e-11, "schedule": _KNOTS},
    "load": _DRY,
    "initial": {"gear_speed": 0.0, "gap": 0.1e-6, "mesh_phase": 0.3},
    "run": {"duration": 0.1, "samples": 100_001, "rtol": 1e-6},
}

PRESETS: Final[Mapping[str, _Tables]] = {
    "teodorescu2009": _HIGH_SPEED,
    "teodorescu2009_low_speed": _LOW_SPEED,
    "roller_slow": _roller(speed=0.01, duration=12e-6),
    "roller_fast": _roller(speed=0.1, duration=2e-6),
    "start_up": _START_UP,
    "braking": _BRAKING,
    "alternating": _ALTERNATING,
}


def preset(name: str) -> Scene:
    """Make one of the ready-made scenes.

    Parameters
    ----------
    name : str
        ``teodorescu2009`` (Figs. 4-6, high speed), ``teodorescu2009_low_speed`` (Figs. 7-10), ``roller_slow``
        or ``roller_fast`` (Figs. 2 and 3); ``start_up``, ``braking`` or ``alternating``: a worn pair whose drive
        torque follows a schedule.

    Returns
    -------
    Scene

    Raises
    ------
    SceneError
        If there is no preset of that name.
    """
    if not isinstance(name, str) or name not in PRESETS:
        question = did_you_mean(name, PRESETS) if isinstance(name, str) else ""
        raise SceneError(
            "preset", shorten(name), f"no such preset; {question} known are {', '.join(PRESETS)}"
        )
    return Scene.from_dict({"name": name, **PRESETS[name]})
