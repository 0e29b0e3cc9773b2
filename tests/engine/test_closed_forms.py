"""Motions that have a formula."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.contact import asperity_of
from gearidae.engine import solve
from gearidae.records import EventKind

R1, R2 = 34.715e-6, 4 * 34.715e-6
I1, I2 = 1.5263e-20, 6.1052e-20
M10, DRAG = 4.5e-18, 8e-18


def test_free_flight_under_torque_and_quadratic_drag():
    """Without contact the pinion gains speed evenly and the gear's decays as 1/(1 + alpha w t / I2)."""
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "mesh.backlash": 4e-6,
            "initial.gap": 2e-6,
            "run.duration": 0.008,
            "run.samples": 25,
            "run.rtol": 1e-9,
        }
    )
    run = solve(scene)
    t, w0 = run.time, 1.5
    torque = scene.drive.torque
    assert not np.isin(run.events.kind, [EventKind.ONSET, EventKind.TURNING_POINT]).any()
    gear = w0 / (1 + DRAG * w0 * t / I2)
    pinion = 4 * w0 + torque * t / I1
    angle = I2 / DRAG * np.log1p(DRAG * w0 * t / I2)
    u = R1 * (4 * w0 * t + torque * t**2 / (2 * I1)) - R2 * angle
    # a hundred times the tolerance of 1e-9 per step, on the scale of what each quantity changes by
    np.testing.assert_allclose(run.samples["gear_speed"], gear, rtol=1e-7)
    np.testing.assert_allclose(run.samples["pinion_speed"], pinion, rtol=1e-7)
    np.testing.assert_allclose(
        run.samples["gear_angle"] - run.samples["gear_angle"][0], angle, rtol=1e-7, atol=1e-12
    )
    np.testing.assert_allclose(run.samples["transmission_error"], u, atol=1e-7 * 2e-6)
    assert not run.samples["mesh_force"].any()


def test_steady_running_balances_drive_and_drag():
    """The mean speed settles where M10 = (R1/R2) alpha w^2, at 1.5 rad/s (Eq. 3 with its ratio set right)."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.06, "run.samples": 6001})
    run = solve(scene)
    late = run.samples["gear_speed"][3000:]
    assert late.mean() == pytest.approx(1.5, rel=1e-3, abs=0)  # what is left of the ringing
    torque = run.samples["gear_contact_torque"][3000:]
    assert torque.mean() == pytest.approx(DRAG * 1.5**2, rel=1e-2, abs=0)


def test_contact_exchanges_angular_momentum_along_the_line_of_action():
    """I1 phi1'/R1 + I2 phi2'/R2 grows with M1/R1 alone while every force lies on the path of contact."""
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "load.drag": 0.0,
            "initial.mesh_phase": 0.85,
            "initial.gap": 6.2 * 6e-9,
            "run.duration": 3e-3,
            "run.samples": 301,
            "run.rtol": 1e-9,
        }
    )
    run = solve(scene)
    assert np.count_nonzero(run.events.kind == EventKind.TURNING_POINT) >= 3
    momentum = I1 * run.samples["pinion_speed"] / R1 + I2 * run.samples["gear_speed"] / R2
    expected = momentum[0] + scene.drive.torque / R1 * run.time
    exchanged = I2 * np.ptp(run.samples["gear_speed"]) / R2
    np.testing.assert_allclose(momentum, expected, atol=1e-6 * exchanged)


def _area_above(scene, gap):
    """Area integral of P(z > h) over a rough parabola: L sqrt(2 R sigma) int Q(gap/sigma + s^2) ds."""
    s, step = np.linspace(-8, 8, 160001, retstep=True)
    tail = 0.5 * np.vectorize(math.erfc)((gap / scene.surface.roughness + s[::100] ** 2) / math.sqrt(2))
    width = scene.roller.width * math.sqrt(2 * scene.roller.radius * scene.surface.roughness)
    return width * tail.sum() * step * 100


@pytest.mark.parametrize("fraction", [0.0, 1.0, 0.5])
def test_an_impact_loses_the_adhesion_energy(fraction):
    """A full approach and parting costs 0.93550 Pc dc for every asperity that joined."""
    scene = gd.preset("roller_slow").replace(
        {
            "coating.sam_fraction": fraction,
            "contact.bodies": "rigid",
            "run.duration": 3e-5,
            "run.samples": 80001,
            "run.rtol": 1e-9,
        }
    )
    run = solve(scene)
    height, speed = run.samples["height"], run.samples["speed"]
    assert height[-1] > 15 * scene.surface.roughness  # it has come free
    lost = 0.5 * scene.roller.mass * (speed[0] ** 2 - speed[-1] ** 2)
    joined = scene.surface.asperity_density * _area_above(scene, height.min())
    shares = ((scene.surface, 1 - fraction), (scene.coated_surface, fraction))
    tips = [(asperity_of(surface), share) for surface, share in shares]
    cost = sum(share * 0.93550 * tip.pull_off * tip.stretch_limit for tip, share in tips)
    # the constant has five digits; height.min() is a sample's, near a turning point, so that its error enters squared
    assert lost == pytest.approx(cost * joined, rel=2e-5, abs=0)


def test_hertz_asperities_lose_nothing():
    scene = gd.preset("roller_slow").replace(
        {"contact.asperity": "hertz", "contact.bodies": "rigid", "run.rtol": 1e-10}
    )
    run = solve(scene)
    assert run.samples["speed"][-1] == pytest.approx(-run.samples["speed"][0], rel=1e-7, abs=0)


def test_roller_in_flight_keeps_its_speed():
    scene = gd.preset("roller_slow").replace({"roller.height": 1e-6, "run.duration": 2e-5})
    run = solve(scene)
    np.testing.assert_allclose(run.samples["height"], 1e-6 - 1e-2 * run.time, atol=1e-15)
    assert not run.samples["force"].any()
    assert not len(run.events)
