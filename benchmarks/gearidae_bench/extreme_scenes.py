"""Extreme but valid scenes: log-uniform over what each key allows, corner values, both drivers.

The stress run's scenes (`random_scenes`) are of gears that somebody might build. These are not: they ask whether
anything that the scene models admit can kill a process, or keep it silent. Limits are read from the models themselves,
so that a limit that is narrowed there is narrowed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearidae.asperities import has_area
from gearidae.errors import SceneError
from gearidae.mesh.involute import GeometryError, mesh_geometry
from gearidae.scene import Coating, Gears, Initial, Mesh, Roller, Run, Scene, Surface
from gearidae.scene.coating import THICKEST
from gearidae.scene.coating_table import MOST_PLACES
from gearidae.scene.group import Group
from gearidae.scene.quantity import Count, Quantity
from gearidae.scene.strip import MOST, flank_strip

__all__ = ["CORNER", "Extreme", "extreme_friction", "extreme_population", "extreme_scene"]

CORNER = 0.2
"""Probability of a corner value where a key is free: a limit of its range, the number next to it, or zero."""

FREE = (0.05, 0.2, 0.5, 1.0)
"""Shares of keys that are free, one of them for each scene. The other keys stay within half a decade of a preset's
values: otherwise hardly any scene would reach its second step."""

_DECADES = 12.0  # over which a key is drawn to a side where its range has no end, or ends at zero
_LEAST, _MOST = 1e-300, 1e300
_ROLLERS = 0.15
_SILICON = 2330.0  # [kg/m^3]
_TRIES, _TRIES_EACH = 4000, 500  # with one share of free keys
_MANY_KNOTS = 20_000
_APART = 1_000_000
"""Between the numbers of scenes that are tried until one is of gears."""


@dataclass(frozen=True, slots=True)
class Extreme:
    """One scene of the attack.

    Attributes
    ----------
    scene : Scene
    backend : str
        The driver that is to run it.
    """

    scene: Scene
    backend: str


def extreme_scene(seed: int, number: int, alive: Callable[[], None] | None = None) -> Extreme:
    """Draw one scene and its driver; the same numbers give the same scene as long as the models' limits stay.

    Parameters
    ----------
    seed, number : int
        Of the run, and of the scene in it.
    alive : callable, optional
        Called before every try: thousands with 20,000 knots each take a minute on a busy machine.

    Returns
    -------
    Extreme

    Raises
    ------
    SceneError
        If no try gave a valid scene: then the limits leave next to nothing of the ranges.
    """
    rng = np.random.default_rng([seed, number, 17])
    backend = "native" if rng.random() < 0.6 else "sksundae"
    rolls = bool(rng.random() < _ROLLERS)  # once: gears are refused more often than rollers
    refused: SceneError | None = None
    for attempt in range(_TRIES):
        if alive is not None:
            alive()
        if attempt % _TRIES_EACH == 0:
            draw = _Draw(rng, float(rng.choice(FREE)))
        try:
            return Extreme(
                Scene.from_dict({"name": f"extreme {seed}-{number}", **_tables(draw, rolls)}), backend
            )
        except SceneError as error:
            refused = error
        except (
            GeometryError,
            ArithmeticError,
        ):  # while drawing: what the gears' own limits leave does not fit together
            continue
    raise refused or SceneError("gears", "(drawn)", "no pair that can mesh was found")


def extreme_population(seed: int, number: int, alive: Callable[[], None] | None = None) -> Extreme:
    """Draw one scene of `extreme_scene`, and give it real asperities: drawn, or a list of 1 to 300.

    There are fewer on each area where they would be more than a population may have, and often fewer still: 100 to
    the most, log-uniformly.

    Parameters
    ----------
    seed, number, alive
        As for `extreme_scene`.

    Raises
    ------
    SceneError
        As `extreme_scene` does.
    """
    extreme, rng = extreme_scene(seed, number, alive), np.random.default_rng([seed, number, 18])
    scene, sigma = extreme.scene, extreme.scene.surface.roughness
    changes: dict[str, Any] = {
        "contact.bodies": "rigid",
        "contact.roughness": "discrete",
        "contact.seed": int(rng.integers(0, 2**32)),
        "run.asperity_events": bool(rng.random() < 0.7),
    }
    if rng.random() < 0.3:
        count, (low, high) = int(rng.choice([1, 10, 300])), flank_strip(scene)
        changes["contact.asperities"] = {
            "x" if scene.roller is not None else "arc": rng.uniform(low, high, count).tolist(),
            "height": np.clip(sigma * rng.uniform(-1.0, 9.0, count), -0.1, 0.1).tolist(),
            "radius": np.clip(
                scene.surface.asperity_radius * 10.0 ** rng.uniform(-2.0, 1.0, count), 1e-10, 0.1
            ).tolist(),
        }
    elif rng.random() < 0.3:
        changes["contact.radius_spread"] = float(rng.choice([1e-3, 0.3, 10.0]))
    density, most = (
        scene.surface.asperity_density,
        math.exp(rng.uniform(math.log(100.0), math.log(0.99 * MOST))),
    )
    low, high = flank_strip(scene)
    flanks = (scene.roller.width, 1) if scene.roller else (0.0, 0)
    if scene.gears is not None:
        flanks = scene.gears.face_width, 2 * scene.gears.pinion_teeth
    mean = density * flanks[0] * (high - low) * flanks[1]
    changes["surface.asperity_density"] = density * min(most / mean, 1.0)
    return Extreme(scene.replace(changes), extreme.backend)


def extreme_friction(seed: int, number: int, alive: Callable[[], None] | None = None) -> Extreme:
    """Draw gears of `extreme_scene`, every second with real asperities, and give flanks and hubs friction.

    Gears that would lock themselves are drawn again.

    Parameters
    ----------
    seed, number, alive
        As for `extreme_scene`.

    Raises
    ------
    SceneError
        As `extreme_scene` does.
    """
    draw = extreme_population if number % 2 else extreme_scene
    rng = np.random.default_rng([seed, number, 19])
    extreme = next(
        one for k in range(_TRIES) if (one := draw(seed, number + k * _APART, alive)).scene.gears is not None
    )
    model = {"contact.bodies": "rigid", "contact.roughness": "discrete" if number % 2 else "statistical"}
    for _ in range(_TRIES):
        try:
            return Extreme(extreme.scene.replace(model | _friction(rng, extreme.scene)), extreme.backend)
        except SceneError as error:  # gears that lock themselves
            refused = error
    raise refused


def _friction(rng: np.random.Generator, scene: Scene) -> dict[str, Any]:
    """Draw friction of flanks, and of hubs in every second scene."""
    assert scene.gears is not None
    if has_area(scene.contact.asperity) and rng.random() < 0.3:
        drawn: dict[str, Any] = {
            "contact.friction_law": "shear",
            "contact.shear_strength": 10.0 ** rng.uniform(3.0, 10.0),
        }
    else:
        drawn = {
            "contact.friction": 10.0 ** rng.uniform(-4.0, 0.0),
            "coating.friction": float(rng.choice([0.0, 0.1, 0.9])),
        }
    if rng.random() < 0.5:
        radius = scene.gears.pinion_base_radius * 10.0 ** rng.uniform(-3.0, 0.0)
        drawn |= {
            "gears.hub_friction": 10.0 ** rng.uniform(-4.0, 0.0),
            "gears.pinion_hub_radius": float(rng.choice([0.0, radius])),
            "gears.gear_hub_radius": radius,
        }
    return drawn


class _Draw:
    """Draws the values of one scene's keys."""

    def __init__(self, rng: np.random.Generator, free: float) -> None:
        self.rng, self._free = rng, free

    def often(self, share: float) -> bool:
        """Whether something happens that does in this share of scenes."""
        return bool(self.rng.random() < share)

    def free(self) -> bool:
        """Whether the next key is free."""
        return self.often(self._free)

    def value(self, model: type[Group], name: str, usual: float) -> float:
        """Draw a key of a table: if it is free, over the range that its model states, else about its usual value.

        Parameters
        ----------
        model : type of Group
        name : str
            A key that holds a `Quantity` or a `Count`.
        usual : float
            Value about which it stays otherwise; its sign is kept.
        """
        limits = next(one for one in model.model_fields[name].metadata if isinstance(one, (Quantity, Count)))
        whole = isinstance(limits, Count)
        if not self.free():
            near = usual * 10.0 ** self.rng.uniform(-0.5, 0.5)
            value = near if limits.admits(near) else usual
        elif self.often(CORNER):
            value = float(self.rng.choice(_corners(limits, usual)))
        else:
            value = _over(self.rng, limits, usual)
        return float(round(value)) if whole else value

    def between(self, low: float, high: float) -> float:
        """Draw a positive number log-uniformly; corners are its ends."""
        low, high = max(min(low, high), _LEAST), min(max(low, high), _MOST)
        if self.often(CORNER):
            return float(self.rng.choice([low, high]))
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def phase(self) -> float:
        """Draw an angle [rad], now and then far outside a turn."""
        return float(self.rng.choice([0.0, self.rng.uniform(-4.0, 4.0), 1e6], p=[0.3, 0.6, 0.1]))


def _corners(limits: Quantity | Count, usual: float) -> list[float]:
    """Ends of a range, the numbers next to open ends, zero where it is allowed."""
    above = [math.nextafter(limits.above, math.inf), 1e-300] if limits.above is not None else []
    below = [math.nextafter(limits.below, -math.inf)] if limits.below is not None else []
    ends = [one for one in (limits.at_least, limits.at_most) if one is not None]
    least = [limits.least, -limits.least] if limits.least is not None else []
    found = [one for one in (*above, *below, *ends, *least, 0.0) if limits.admits(one)]
    return found or [usual]


def _over(rng: np.random.Generator, limits: Quantity | Count, usual: float) -> float:
    """Draw log-uniformly over a range, about its usual value where it has no end."""
    size = max(abs(usual), _LEAST)
    low = max(size * 10.0**-_DECADES, limits.least or _LEAST)
    high = min(size * 10.0**_DECADES, _MOST)
    for bound in (limits.at_least, limits.above):
        low = max(low, bound) if bound is not None and bound > 0.0 else low
    for bound in (limits.at_most, limits.below):
        high = min(high, bound) if bound is not None else high
    if limits.at_least is not None and limits.at_least > 0.0:
        low = limits.at_least
    low = min(low, high)
    value = min(max(math.exp(rng.uniform(math.log(low), math.log(high))), low), math.nextafter(high, 0.0))
    negative = limits.at_least is None and limits.above is None
    return -value if (usual < 0.0 or (negative and rng.random() < 0.2)) else value


def _tables(draw: _Draw, rolls: bool) -> dict[str, Any]:
    surface = {
        "youngs_modulus": draw.value(Surface, "youngs_modulus", 161e9),
        "poisson_ratio": float(draw.rng.choice([0.23, -0.9999, 0.4999, 0.0], p=[0.85, 0.05, 0.05, 0.05])),
        "energy": draw.value(Surface, "energy", 1.5),
        "asperity_density": draw.value(Surface, "asperity_density", 1.69e14),
        "asperity_radius": draw.value(Surface, "asperity_radius", 450e-9),
        "roughness": draw.value(Surface, "roughness", 6e-9),
    }
    tables: dict[str, Any] = {
        "surface": surface,
        "coating": {
            "sam_fraction": float(draw.rng.choice([0.0, 1.0, draw.rng.random()], p=[0.2, 0.2, 0.6])),
            "energy": draw.value(Coating, "energy", 0.1),
        },
        "contact": {
            "bodies": str(draw.rng.choice(["auto", "rigid", "elastic"])),
            "asperity": str(draw.rng.choice(["jkr", "dmt", "hertz"], p=[0.6, 0.2, 0.2])),
        },
    }
    moved, unit = _roller(draw, surface) if rolls else _gears(draw, surface["roughness"])
    duration = draw.value(Run, "duration", unit * 10.0 ** draw.rng.uniform(0.0, 3.5))
    tables["run"] = {
        "duration": duration,
        "samples": _samples(draw, duration),
        "rtol": float(10.0 ** draw.rng.uniform(-12.0, -1.0))
        if not draw.often(CORNER)
        else float(draw.rng.choice([1e-12, 0.1, 1e-3])),
    }
    for shaft in ("drive", "load"):
        if shaft in moved:
            moved[shaft] |= _variations(draw, moved[shaft]["torque"], duration, unit)
    tables |= moved
    _add_coating(draw, tables)
    if not rolls:
        _add_gear_keys(draw, tables)
    return tables


def _add_coating(draw: _Draw, tables: dict[str, Any]) -> None:
    """Draw asperities whose forces have a range, and coatings with two sides, a thickness and worn places."""
    coating, surface = tables["coating"], tables["surface"]
    if draw.often(0.2):
        tables["contact"]["asperity"] = "maugis"
        surface["interaction_range"] = draw.value(Surface, "interaction_range", 0.165e-9)
    if draw.often(0.3):
        coating["thickness"] = min(draw.value(Coating, "thickness", 2.5e-9), THICKEST * surface["roughness"])
    if draw.often(0.3):
        coating["pairing"] = "independent"
        coating["pinion_fraction"], coating["gear_fraction"] = draw.rng.choice([0.0, 0.3, 1.0], 2).tolist()
    if "gears" in tables and draw.often(0.15):
        coating.pop("pinion_fraction", None)
        teeth = tables["gears"]["pinion_teeth"] if draw.often(0.5) else 1
        places = int(draw.rng.choice([1, 2, 7, MOST_PLACES]))
        coating["pinion_table"] = draw.rng.choice([0.0, 0.5, 1.0], (teeth, places)).tolist()


def _add_gear_keys(draw: _Draw, tables: dict[str, Any]) -> None:
    """Draw the force of the changing radius, exposures, viscous drag and a drive that holds a speed."""
    tables["mesh"]["radius_force"] = draw.often(0.5)
    if draw.often(0.2):
        tables["run"]["exposures"] = int(draw.value(Run, "exposures", 8.0))
    if draw.often(0.2):
        tables["load"]["viscous"] = draw.between(1e-30, 1e-9)
    if draw.often(0.2):
        tables["drive"] |= {"speed": draw.between(1e-3, 1e5), "speed_gain": draw.between(1e-24, 1e-9)}


def _samples(draw: _Draw, duration: float) -> int | str:
    """Draw how often to sample: a number, a rate or off."""
    kind = draw.rng.random()
    if kind < 0.1:
        return "off"
    if kind < 0.2:
        return f"{draw.between(2.0, 1e6) / duration!r} Hz"
    if not draw.free():
        return int(draw.rng.integers(2, 2000))
    return int(draw.between(2.0, 1e8))


def _roller(draw: _Draw, surface: dict[str, float]) -> tuple[dict[str, Any], float]:
    roller = {
        "radius": draw.value(Roller, "radius", 5e-6),
        "mass": draw.value(Roller, "mass", 6e-10),
        "width": draw.value(Roller, "width", 2e-6),
        "speed": draw.value(Roller, "speed", 0.03),
        "height": draw.value(Roller, "height", 6.0 * surface["roughness"]),
    }
    speed = roller["speed"] or 1e-3
    return {"roller": roller}, max(roller["height"] / speed, 1e-300)


def _gears(draw: _Draw, sigma: float) -> tuple[dict[str, Any], float]:
    """Draw a gear pair with its torques and its start; and the order of its own unit of time [s]."""
    r1, width = (
        draw.value(Gears, "pinion_base_radius", 34.715e-6),
        draw.value(Gears, "face_width", 2e-6),
    )
    teeth = [int(draw.value(Gears, key, usual)) for key, usual in (("pinion_teeth", 19), ("gear_teeth", 76))]
    angle = 0.349 if not draw.free() else float(draw.rng.uniform(0.05, 0.7))
    pitch = mesh_geometry(r1, teeth[0], teeth[1], angle).base_pitch
    radii = (r1, r1 * teeth[1] / teeth[0])
    discs = [min(0.5 * math.pi * _SILICON * width * r**4, 1.0) for r in radii]
    inertias = [
        draw.value(Gears, key, max(disc, 1e-300))
        for key, disc in zip(("pinion_inertia", "gear_inertia"), discs, strict=True)
    ]
    backlash = float(draw.rng.choice([0.0, 0.499 * pitch, min(0.2e-6, 0.1 * pitch)], p=[0.1, 0.1, 0.8]))
    if draw.free():
        backlash = draw.between(1e-16, max(0.49 * pitch, 1e-15))
    torque = 2.43e-11 * 10.0 ** (
        draw.rng.uniform(-12.0, 12.0) if draw.free() else draw.rng.uniform(-6.0, 0.0)
    )
    torque = float(draw.rng.choice([torque, -torque, 0.0], p=[0.8, 0.1, 0.1]))
    speed = float(
        draw.rng.choice([0.0, draw.between(1e-3, 1e4), -draw.between(1e-3, 1e4)], p=[0.2, 0.6, 0.2])
    )
    if draw.free():
        speed = draw.value(Initial, "gear_speed", 1.5)
    mass = 1.0 / (r1**2 / inertias[0] + radii[1] ** 2 / inertias[1])
    force = max(abs(torque) / r1, mass * (speed * radii[1]) ** 2 / pitch, 1e-280)
    moved = {
        "gears": {
            "pinion_inertia": inertias[0],
            "gear_inertia": inertias[1],
            "pinion_base_radius": r1,
            "pinion_teeth": teeth[0],
            "gear_teeth": teeth[1],
            "pressure_angle": angle,
            "face_width": width,
        },
        "mesh": {
            "backlash": backlash,
            "tip_relief_radius": draw.value(Mesh, "tip_relief_radius", 10e-6),
            "damping": draw.value(Mesh, "damping", math.sqrt(mass * force / sigma))
            if draw.often(0.3)
            else 0.0,
            "static_error": _static_error(draw, r1, sigma),
        },
        "drive": {"torque": torque},
        "load": {"torque": abs(torque) * radii[1] / r1 * draw.between(1e-3, 10.0) if draw.often(0.5) else 0.0}
        | ({"drag": draw.between(1e-24, 1e-6)} if draw.often(0.3) else {}),
        "initial": {
            "gear_speed": speed,
            "gap": _gap(draw, backlash, sigma),
            "mesh_phase": float(draw.rng.choice([0.0, draw.rng.random(), 1.0 - 2.0**-53], p=[0.1, 0.8, 0.1])),
        },
    }
    return moved, math.sqrt(mass * sigma / force)


def _gap(draw: _Draw, backlash: float, sigma: float) -> float:
    """Draw a gap at the start, from the deepest overlap that is allowed on one flank to that on the other."""
    ends = [-8.0 * sigma, backlash + 8.0 * sigma, 0.0, backlash]
    inside = [draw.rng.uniform(-1.0, 8.0) * sigma, backlash * draw.rng.random(), draw.between(1e-18, sigma)]
    return float(draw.rng.choice(ends if draw.free() and draw.often(CORNER) else inside))


def _static_error(draw: _Draw, r1: float, sigma: float) -> list[dict[str, float]]:
    count = int(draw.rng.choice([0, 1, 2, 8], p=[0.6, 0.2, 0.1, 0.1]))
    harmonics = []
    for _ in range(count):
        order = int(draw.between(1.0, 1e5)) if draw.free() else int(draw.rng.integers(1, 60))
        largest = 0.99 * r1 / (order * count)
        amplitude = draw.between(1e-15, max(largest, 1e-15)) if draw.free() else min(sigma, largest)
        harmonics.append({"order": order, "amplitude": amplitude, "phase": draw.phase()})
    return harmonics


def _variations(draw: _Draw, torque: float, duration: float, unit: float) -> dict[str, Any]:
    """Harmonics and a schedule of a torque."""
    size = abs(torque) or 1e-13
    found: dict[str, Any] = {}
    if draw.often(0.3):
        found["harmonic"] = [
            {
                "amplitude": size * draw.between(1e-6, 1e6 if draw.free() else 1.0),
                "frequency": draw.between(1e-3, 1e3) / (unit if draw.often(0.5) else duration),
                "phase": draw.phase(),
            }
            for _ in range(int(draw.rng.choice([1, 2, 8])))
        ]
    if draw.often(0.25):
        times = _KNOTS[int(draw.rng.integers(len(_KNOTS)))](draw.rng, duration)
        values = size * draw.rng.uniform(-1.0, 2.0, times.size)
        found["schedule"] = [[float(t), float(value)] for t, value in zip(times, values, strict=True)]
    return found


def _some(rng: np.random.Generator, duration: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.unique(duration * rng.uniform(0.0, 1.2, int(rng.integers(1, 6))))


def _jumps(rng: np.random.Generator, duration: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Pairs of knots next to each other: the torque is discontinuous there."""
    at = _some(rng, duration)
    apart = float(rng.choice([0.0, 1e-12, 1e-9])) * duration
    return np.unique(np.concatenate([at, np.maximum(np.nextafter(at, np.inf), at + apart)]))


def _many(rng: np.random.Generator, duration: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.unique(duration * rng.uniform(0.0, 1.0, int(rng.choice([300, 3000, _MANY_KNOTS]))))


_KNOTS: tuple[Callable[[np.random.Generator, float], np.ndarray[Any, np.dtype[np.float64]]], ...] = (
    _some,
    _jumps,
    _many,
)
