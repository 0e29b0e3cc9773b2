"""Backlash dynamics of the published kind: x'' + 2 zeta x' + B(x) = F(t) with a dead zone, and its jumps of amplitude.

Kahraman and Singh 1990 (doi:10.1016/0022-460X(90)90582-K): a gear pair under mean load with a harmonic torque answers
near resonance in two ways at one frequency, with its teeth always touching, or with teeth that part and hit again. The
dead zone softens it: swept upwards the amplitude jumps up below the linear resonance's peak.
"""

from functools import cache

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.mesh import curvature_radii
from gearidae.records import EventKind
from reference.hertz_gears import HertzGears

MEAN = 3e-11  # N m, at the pinion
ZETA = 0.03


def oscillator(frequency, swing, cycles, gap=None, **changes):
    """A gear pair that hardly turns: one pair of teeth, constant stiffness, dead zone of the backlash."""
    scene = gd.preset("teodorescu2009").replace(
        {
            "contact.asperity": "hertz",
            "contact.bodies": "rigid",
            "mesh.backlash": 2e-6,
            "gears.gear_inertia": 1e-14,  # does not move
            "initial.gear_speed": 1e-3,
            "initial.mesh_phase": 0.8,
            "initial.gap": 2e-8,
            "load.torque": 0.0,
            "load.drag": 0.0,
            "drive.torque": MEAN,
            "drive.harmonic": [{"amplitude": swing * MEAN, "frequency": 1e5, "phase": 0.0}],
            "run.rtol": 1e-9,
            **changes,
        }
    )
    rest, linear, mass = at_rest(scene)
    period = 1.0 / (frequency * linear)
    return scene.replace(
        {
            "initial.gap": rest if gap is None else gap,
            "mesh.damping": 2 * ZETA * mass * 2 * np.pi * linear,
            "drive.harmonic": [{"amplitude": swing * MEAN, "frequency": frequency * linear, "phase": 0.0}],
            "run.duration": cycles * period,
            "run.samples": 40 * cycles + 1,
        }
    )


def at_rest(scene):
    """Gap under the mean load, natural frequency there [Hz], and moving mass, from the readable force alone."""
    slow = HertzGears(scene)
    r1 = slow.geometry.base_radius_pinion
    radius = float(_radius(scene))
    load = MEAN / r1
    gaps = np.linspace(-20, 11, 20001) * scene.surface.roughness
    force = np.sqrt(radius) * np.exp(slow.log_force(gaps))
    rest = float(np.interp(-load, -force, gaps))
    step = 1e-4 * scene.surface.roughness
    stiffness = (
        np.sqrt(radius)
        * (np.exp(slow.log_force(rest - step)) - np.exp(slow.log_force(rest + step)))
        / (2 * step)
    )
    mass = scene.gears.pinion_inertia / r1**2
    return rest, float(np.sqrt(stiffness / mass) / (2 * np.pi)), mass


def _radius(scene):
    geometry = scene.geometry
    return curvature_radii(geometry, scene.initial.mesh_phase * geometry.base_pitch)[2]


def amplitude(u):
    """Half the swing over the last ten cycles."""
    return 0.5 * np.ptp(u[-400:])


@pytest.mark.parametrize(("frequency", "gap"), [(0.7, None), (0.6, 5e-7)])
def test_the_engine_follows_the_oscillator(frequency, gap):
    scene = oscillator(frequency, 0.6, 6, gap)
    ours = solve(scene)
    assert ours.status == "finished"
    u, _, _ = HertzGears(scene).run(ours.time)
    # two integrators at some 1e-9 per step, thousands of steps, impacts that magnify by a few each
    np.testing.assert_allclose(ours.samples["transmission_error"], u, atol=1e-4 * np.ptp(u))


@cache
def settled(frequency, gap=None):
    """A run until its motion repeats itself."""
    return solve(oscillator(frequency, 0.6, 120, gap))


def test_two_answers_at_one_frequency():
    """Started at rest under load the teeth stay together; started apart they keep parting: the jump's two ends."""
    together, apart = settled(0.6), settled(0.6, 5e-7)
    late = together.time[-401]
    parting = [
        np.any((run.events.kind == EventKind.SEPARATION) & (run.events.time > late))
        for run in (together, apart)
    ]
    assert parting == [False, True]
    small, large = (amplitude(run.samples["transmission_error"]) for run in (together, apart))
    assert large > 5 * small


def test_the_amplitude_jumps_up_well_below_the_linear_resonance():
    """The same start at neighbouring frequencies: teeth that stay together, then parting teeth, then together again."""
    runs = [settled(frequency) for frequency in (0.6, 0.7, 1.1)]
    sizes = [amplitude(run.samples["transmission_error"]) for run in runs]
    assert sizes[1] > 4 * sizes[0]
    assert sizes[2] < 0.5 * sizes[1]
