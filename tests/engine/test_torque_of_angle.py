"""Torques that depend on the shaft's angle, against scipy's DOP853 and a synchronous motor's closed form."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.records import EventKind
from gearidae.torques import Parameter

I1 = 1.5263e-20
RATIO = 4.0
W2 = 2898.0  # rad/s, of the gear at the start
TURNING = 1e-3  # s: 1.8 turns of the pinion

# a hundred times the tolerance of 1e-9 per step
CLOSE = {"rtol": 1e-7, "atol": 0}


def leaning(t, angle, speed, p):
    """Of all four: a motor whose poles are felt, and whose voltage swings."""
    return p[0] * math.cos(2.0 * angle + p[1]) * (1.0 + 0.3 * math.sin(p[2] * t)) - p[3] * speed


@pytest.fixture(autouse=True)
def _registered():
    names = ("torque", "offset", Parameter("rate", "rad/s", 3e4), "friction")
    gd.register_torque("leaning", parameters=names)(leaning)
    yield
    gd.unregister_torque("leaning")


@pytest.fixture
def free(flight):
    """A pinion and a gear at speed that never touch."""
    return flight.replace(
        {
            "initial.gear_speed": W2,
            "mesh.backlash": "2 um",
            "initial.gap": "1 um",
            "run.duration": TURNING,
            "run.rtol": 1e-9,
        }
    )


def microengine(t, angle, *, radius, force, kx, ky, phase, psi):
    """Torque of the two forces on the pin, written as two components."""
    pin = radius * np.array([math.cos(angle), math.sin(angle)])
    pull = force * np.array([-math.sin(psi(t) + phase), math.cos(psi(t) + phase)])
    x, y = pull - np.array([kx, ky]) * pin
    return float(pin[0] * y - pin[1] * x)


def reference(torque, times):
    """Angle and speed of the pinion alone."""
    solution = solve_ivp(
        lambda t, y: [y[1], torque(t, y[0], y[1]) / I1],
        (0.0, times[-1]),
        [0.0, RATIO * W2],
        "DOP853",
        times,
        rtol=1e-12,
        atol=1e-12,
    )
    return solution.y


def ramp(start, end, seconds):
    """Integral in radians of a frequency that rises or falls in a straight line, and is constant from then on."""

    def psi(t):
        s = min(t, seconds)
        return 2 * math.pi * (start * s + 0.5 * (end - start) * s**2 / seconds + end * (t - s))

    return psi


SYNCHRONOUS = RATIO * W2 / (2 * math.pi)  # Hz
ENGINE = {"radius": 3e-6, "force": 7e-10, "stiffness_x": 1e-3, "stiffness_y": 2e-3, "phase": 0.0}
CASES = {
    "order": (
        {"drive.harmonic": [{"amplitude": 3e-14, "order": 3}]},
        lambda t, angle, speed: 3e-14 * math.cos(3 * angle),
    ),
    "microengine": (
        {
            "drive.law": {
                "name": "microengine",
                **ENGINE,
                "frequency": [[0.0, 1.5 * SYNCHRONOUS], [6e-4, 2 * SYNCHRONOUS]],
            }
        },
        lambda t, angle, speed: microengine(
            t,
            angle,
            radius=3e-6,
            force=7e-10,
            kx=1e-3,
            ky=2e-3,
            phase=0.0,
            psi=ramp(1.5 * SYNCHRONOUS, 2 * SYNCHRONOUS, 6e-4),
        ),
    ),
    "law": (
        {"drive.law": {"name": "leaning", "torque": 1e-14, "offset": 0.1, "friction": 1e-20}},
        lambda t, angle, speed: leaning(t, angle, speed, (1e-14, 0.1, 3e4, 1e-20)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_free_rotor(free, name):
    changes, torque = CASES[name]
    scene = free.replace(changes)
    run = solve(scene)
    assert not (run.events.kind == EventKind.ONSET).any()
    angle, speed = reference(torque, run.time)
    np.testing.assert_allclose(run.samples["pinion_speed"], speed, **CLOSE)
    np.testing.assert_allclose(run.samples["pinion_angle"], angle, rtol=1e-7, atol=1e-12)
    wanted = [torque(*at) for at in zip(run.time, angle, speed, strict=True)]
    np.testing.assert_allclose(run.samples["drive_torque"], wanted, rtol=0, atol=1e-6 * np.ptp(wanted))
    gained = 0.5 * I1 * (speed[-1] ** 2 - speed[0] ** 2)
    turned = np.ptp(speed**2) * I1  # of what goes to and fro
    assert run.balance.drive_work == pytest.approx(gained, rel=0, abs=1e-6 * turned)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("name", CASES)
def test_the_portable_driver_agrees(free, name):
    scene = free.replace({**CASES[name][0], "run.duration": 1e-4})
    native, portable = solve(scene), solve(scene, backend="sksundae")
    for column in ("pinion_speed", "pinion_angle"):
        np.testing.assert_allclose(portable.samples[column], native.samples[column], rtol=1e-7, atol=1e-12)


def test_an_order_of_the_gear(flight):
    """As a load it resists: a torque of the gear's angle that is never cut off, in flight."""
    amplitude = 2e-15
    load = [{"amplitude": amplitude, "order": 5, "phase": 0.3}]
    scene = flight.replace(
        {
            "initial.gear_speed": W2,
            "mesh.backlash": "2 um",
            "initial.gap": "1 um",
            "load.torque": amplitude,
            "load.harmonic": load,
            "run.duration": 5e-4,
        }
    )
    run = solve(scene)
    inertia = scene.gears.gear_inertia
    expected = solve_ivp(
        lambda t, y: [y[1], -amplitude * (1 + math.cos(5 * y[0] + 0.3)) / inertia],
        (0.0, run.time[-1]),
        [0.0, W2],
        "DOP853",
        run.time,
        rtol=1e-12,
        atol=1e-12,
    )
    assert not (run.events.kind == EventKind.ONSET).any()
    np.testing.assert_allclose(run.samples["gear_speed"], expected.y[1], **CLOSE)
    wanted = amplitude * (1 + np.cos(5 * expected.y[0] + 0.3))
    np.testing.assert_allclose(run.samples["load_torque"], wanted, rtol=0, atol=1e-6 * amplitude)


@pytest.mark.parametrize("name", CASES)
def test_a_run_that_is_cut_goes_on_with_the_angle(free, name):
    """Also where the scene that goes on says another start, which then means nothing."""
    scene = free.replace({**CASES[name][0], "run.samples": 11})
    whole = gd.simulate(scene)
    first = gd.simulate(scene.replace({"run.duration": 0.3 * TURNING}))
    rest = scene.replace({"run.duration": 0.7 * TURNING, "initial.mesh_phase": 0.1, "run.samples": 8})
    second = gd.simulate(rest, start=first)
    for column in ("pinion_speed", "pinion_angle", "drive_torque"):
        here, there = second[column][-1].item(), whole[column][-1].item()
        assert here == pytest.approx(there, rel=1e-7, abs=1e-7 * float(abs(whole[column]).max()))


def test_the_angle_counts_from_the_start(free):
    """Whatever the phase, the gap and the static error at the start are; at rates of a constant transmission."""
    scene = free.replace(
        {
            "initial.mesh_phase": 0.7,
            "initial.gap": "0.6 um",
            "mesh.static_error": [{"order": 3, "amplitude": "20 nm", "phase": 0.4}],
        }
    )
    run = solve(scene)
    for name in ("pinion_angle", "gear_angle"):
        assert run.samples[name][0] == pytest.approx(0.0, abs=1e-15)
    speed = run.samples["pinion_speed"]
    np.testing.assert_allclose(run.samples["pinion_angle"], speed[0] * run.time, rtol=1e-7, atol=1e-9)


def test_a_synchronous_motor_lags_by_its_load():
    """``sin(lag) = M / (r F0)``: without springs, where the vibrations of the teeth have died."""
    radius, force, frequency = 5e-6, 1e-6, 600.0
    speed = 2 * math.pi * frequency
    viscous, dry = 3e-15, 2e-12
    torque = (dry + viscous * speed / RATIO) / RATIO  # of the load, at the pinion
    lag = math.asin(torque / (radius * force))
    scene = gd.preset("teodorescu2009").replace(
        {
            "drive": {
                "law": {
                    "name": "microengine",
                    "radius": radius,
                    "force": force,
                    "frequency": frequency,
                    "phase": lag - 0.5 * math.pi,
                }
            },
            "load": {"torque": dry, "viscous": viscous},
            "mesh.damping": 7e-6,
            "contact.asperity": "hertz",
            "initial.gear_speed": speed / RATIO,
            "run.duration": 3e-3,
            "run.samples": 3001,
        }
    )
    run = solve(scene)
    last = run.time > 2e-3
    psi = lag - 0.5 * math.pi + speed * run.time
    # the angle leads the force's direction by a right angle less the lag
    lags = psi + 0.5 * math.pi - run.samples["pinion_angle"]
    assert np.sin(lags[last]).mean() == pytest.approx(torque / (radius * force), rel=1e-4, abs=0)
    assert run.samples["pinion_speed"][last].mean() == pytest.approx(speed, rel=1e-4, abs=0)
    power = run.samples["drive_torque"] * run.samples["pinion_speed"]
    resisted = run.samples["load_torque"] * run.samples["gear_speed"]
    assert power[last].mean() == pytest.approx(resisted[last].mean(), rel=1e-3, abs=0)
