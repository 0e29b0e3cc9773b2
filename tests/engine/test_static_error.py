"""The static transmission error at a pinion's angle, which is found by Newton's method."""

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.pairs.mesh_error import mesh_error
from gearidae.engine.setup.build import make_problem

LOW = gd.preset("teodorescu2009_low_speed")
SMOOTH = [{"order": 19, "amplitude": 2e-9, "phase": 0.3}]
RIPPLE = [{"order": order, "amplitude": 13e-9} for order in (10, 24, 41, 50)] + [
    {"order": 100_000, "amplitude": 4e-11, "phase": -2.0}
]
"""A ripple whose length is a small share of what the other harmonics turn the pinion by."""


@pytest.mark.parametrize("harmonics", [SMOOTH, RIPPLE])
@pytest.mark.parametrize("phase", [0.1, 0.53, 0.9])
def test_the_angle_solves_its_equation(harmonics, phase):
    scene = LOW.replace({"mesh.static_error": harmonics})
    m = make_problem(scene).model
    radius, u = m.scene.pinion_radius / m.scene.length_unit, 3.0
    angle, error, slope, *_ = mesh_error(m, u, phase)
    terms = [(h.order, h.amplitude / m.scene.length_unit, h.phase) for h in scene.mesh.static_error]
    expected = sum(a * np.cos(n * angle + shift) for n, a, shift in terms)
    steepness = sum(-n * a * np.sin(n * angle + shift) for n, a, shift in terms) / radius
    rigid = 2.0 * np.pi * phase / m.scene.pinion_teeth + u / radius
    assert angle == pytest.approx(rigid + expected / radius, abs=1e-15)
    # to the phase of 1e-9 that the angle is settled to
    assert error == pytest.approx(expected, abs=1e-9)
    assert slope == pytest.approx(steepness, abs=1e-9)


def test_energy_is_kept_on_a_ripple():
    """Four steps of Newton's method left the slope of the ripple wrong by 2e-3, and as much of the energy lost."""
    scene = LOW.replace(
        {
            "mesh.static_error": RIPPLE,
            "initial.gear_speed": 200.0,
            "run.duration": 1e-5,
            "run.samples": "off",
            "run.rtol": 1e-8,
        }
    )
    balance = solve(scene).balance
    assert_balanced(balance, scene)
