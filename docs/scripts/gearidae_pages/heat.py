"""Slow gears in heat: a damper between the teeth at a temperature shakes them, and worn ones stick earlier.

The model of a run (rigid bodies, joined heights of each pair, drive flank alone) in an integrator of its own, since the
engine has no noise: velocity Verlet with the exact step of damper and noise in its middle (Leimkuhler and Matthews,
doi:10.1093/amrx/abs010). Prints what a sentence of `docs/limits.md` says::

    python -m gearidae_pages.heat
"""

from __future__ import annotations

import math
import sys
from functools import cache
from typing import Final, NamedTuple

import numba
import numpy as np
import numpy.typing as npt

import gearidae as gd
from gearidae.asperities.tip import asperity_of
from gearidae.contact.line import line_force
from gearidae.scene import Scene, Surface, require_gears

__all__ = ["KELVIN", "Motion", "shaken", "sticks"]

KELVIN: Final = 300.0
DAMPINGS: Final = (1e-10, 1e-9, 1e-8)
"""Of the teeth [N s/m]."""
STEP: Final = 0.5e-6
"""Of the integration [s]: a fiftieth of a period of the fastest ringing."""
_BOLTZMANN: Final = 1.380649e-23
_GAPS: Final = np.arange(-4.0, 10.0, 0.02)
"""Of the tabulated force, in roughnesses."""
_STRETCHES: Final = 41
_PAIRS: Final = 12
"""Pairs that pass in 0.36 s, and those beside them."""


class Motion(NamedTuple):
    """A gear, over time.

    Attributes
    ----------
    time, turned, speed : ndarray, shape (n,)
        Time [s], pitches that the gear has turned and its angular speed [rad/s].
    """

    time: npt.NDArray[np.float64]
    turned: npt.NDArray[np.float64]
    speed: npt.NDArray[np.float64]


@numba.njit(cache=True)
def _force(table, limit, sigma, gap, joined):  # type: ignore[no-untyped-def]
    """Force over the root of the radius, of a material at a gap [m] whose asperities are joined up to a height."""
    x = (gap / sigma + 4.0) / 0.02
    if x >= table.shape[0] - 1.0:
        return 0.0
    y = (gap - joined) / limit * (table.shape[1] - 1.0)
    i, j = max(int(x), 0), min(max(int(y), 0), table.shape[1] - 2)
    u, v = x - i, y - j
    first = table[i, j] * (1.0 - v) + table[i, j + 1] * v
    return first * (1.0 - u) + (table[i + 1, j] * (1.0 - v) + table[i + 1, j + 1] * v) * u


@numba.njit(cache=True)
def _run(tables, limits, shares, sizes, torques, state, noise, rng, steps, every):  # type: ignore[no-untyped-def]
    """Follow the gears; `sizes` are those of `shaken`, `noise` has the damping and k T."""
    sigma, half, pitch, length, rho, first_radius, total, r1, r2, i1, i2 = sizes
    damping, energy = noise
    dt, (u, v, angle, speed) = STEP, state
    mass = 1.0 / (r1 * r1 / i1 + r2 * r2 / i2)
    kept = math.exp(-damping * dt / mass)
    kick = math.sqrt(energy / mass * (1.0 - kept * kept))
    joined, out = np.full((_PAIRS, 2), np.inf), np.empty((steps // every + 1, 3))
    relative = gear = 0.0
    for n in range(-1, steps):
        if n >= 0:
            v += 0.5 * dt * relative
            speed += 0.5 * dt * gear
            u += 0.5 * dt * v
            angle += 0.5 * dt * speed
            change = (kept - 1.0) * v + kick * rng.standard_normal()
            v += change
            speed -= change * mass * r2 / i2
            u += 0.5 * dt * v
            angle += 0.5 * dt * speed
        force = slip = 0.0
        for k in range(_PAIRS):
            place = r2 * angle - (k - 2) * pitch
            outside = place - min(max(place, 0.0), length)
            gap = half - u + 0.5 * outside * outside / rho
            pinion = first_radius + min(max(place, 0.0), length)
            root = math.sqrt(pinion * (total - pinion) / total)
            for m in range(2):
                joined[k, m] = min(max(joined[k, m], gap - limits[m]), gap)
                if shares[m] > 0.0 and gap < 9.0 * sigma:
                    part = shares[m] * root * _force(tables[m], limits[m], sigma, gap, joined[k, m])
                    force += part
                    slip += part * outside / rho
        gear = (r2 * (force + slip) - torques[1] * speed * abs(speed)) / i2
        relative = r1 * (torques[0] - r1 * force) / i1 - r2 * gear
        if n >= 0:
            v += 0.5 * dt * relative
            speed += 0.5 * dt * gear
        if (n + 1) % every == 0:
            out[(n + 1) // every] = (n + 1) * dt, angle * r2 / pitch, speed
    return out


@cache  # a quadrature for each of 28,700 states, which takes some seconds: many runs share it
def _table(surface: Surface, width: float) -> npt.NDArray[np.float64]:
    """Force over the root of the radius of a material, at `_GAPS` and `_STRETCHES`, shape (700, 41)."""
    sigma, limit = surface.roughness, asperity_of(surface).stretch_limit
    gaps, stretches = np.meshgrid(_GAPS * sigma, np.linspace(0.0, 1.0, _STRETCHES), indexing="ij")
    return line_force(gaps, stretches * limit, 1.0, width, surface)


def shaken(scene: Scene, damping: float, seed: int, kelvin: float = KELVIN, duration: float = 0.36) -> Motion:
    """Follow the slow gears of a scene that heat shakes.

    Parameters
    ----------
    scene : Scene
        The low-speed preset, with a uniform coating.
    damping : float
        Of the damper between the teeth [N s/m].
    seed : int
        Of the noise.
    kelvin : float, optional
        Temperature; 0 for none.
    duration : float, optional
        [s].

    Returns
    -------
    Motion
        A sample each 50 us.
    """
    scene = require_gears(scene)
    gears, g, sigma = scene.gears, scene.geometry, scene.surface.roughness
    materials = {part.name: part for part in scene.materials()}
    parts = [materials["bare"], materials["coated"]]
    limits = np.array([asperity_of(part.surface).stretch_limit for part in parts])
    tables = np.array([_table(part.surface, gears.face_width) for part in parts])
    half, phase = 0.5 * scene.mesh.backlash, scene.initial.mesh_phase
    sizes = (
        sigma,
        half,
        g.base_pitch,
        g.path_length,
        scene.mesh.tip_relief_radius,
        g.tangent_pinion - g.approach,
        g.tangent_pinion + g.tangent_gear,
        g.base_radius_pinion,
        g.base_radius_gear,
        gears.pinion_inertia,
        gears.gear_inertia,
    )
    start = (
        half - scene.initial.gap,
        0.0,
        phase * g.base_pitch / g.base_radius_gear,
        scene.initial.gear_speed,
    )
    rows = _run(
        tables,
        limits,
        np.array([part.share for part in parts]),
        sizes,
        (scene.drive.torque, scene.load.drag),
        start,
        (damping, _BOLTZMANN * kelvin),
        np.random.default_rng(seed),
        round(duration / STEP),
        100,
    )
    return Motion(rows[:, 0], rows[:, 1] - rows[0, 1], rows[:, 2])


def sticks(motion: Motion) -> bool:
    """Whether the gear has stuck within 0.3 s: after that it turns by less than a tenth of a pitch."""
    late = motion.turned[motion.time >= 0.3]
    return bool(late.max() - late[0] < 0.1)


def main() -> None:
    """Print how many of six gears stick, at two coverages and three dampings."""
    for fraction in (0.5, 0.55):
        scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": fraction})
        cold = shaken(scene, 0.0, 0, kelvin=0.0)
        sys.stdout.write(
            f"{fraction:g}, cold: at least {cold.speed[cold.time < 0.3].min():.3g} rad/s within 0.3 s, "
            f"{'sticks' if sticks(cold) else 'turns'}\n"
        )
        for damping in DAMPINGS:
            stuck = sum(sticks(shaken(scene, damping, seed)) for seed in range(6))
            quiet = sticks(shaken(scene, damping, 0, kelvin=0.0))
            sys.stdout.write(
                f"{fraction:g}, {damping:g} N s/m: {stuck} of 6 stick at {KELVIN:g} K, "
                f"without heat it {'sticks' if quiet else 'turns'}\n"
            )


if __name__ == "__main__":
    main()
