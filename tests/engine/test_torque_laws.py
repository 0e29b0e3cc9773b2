"""Torque laws by their names, against motions that have a formula and against the energy balance."""

import math

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.errors import SceneError
from gearidae.records import EventKind

I1, I2 = 1.5263e-20, 6.1052e-20
R1, R2 = 34.715e-6, 4 * 34.715e-6
DECAY = 100.0  # 1/s
W0 = 1.5  # rad/s, of the gear at the start; the pinion turns four times as fast


def ramp(t, speed, p):
    return p[0] * t


def viscous(t, speed, p):
    return -p[0] * speed


def rubbing(t, speed, p):
    return p[0] * abs(speed)


def wave(t, speed, p):
    return p[0] * math.cos(2.0 * math.pi * p[1] * t + p[2])


def swinging(t, speed, p):
    """Of time and speed: a motor whose voltage swings."""
    return p[0] * (1.0 + 0.3 * math.sin(p[2] * t) - speed / p[1])


LAWS = {ramp: 1, viscous: 1, rubbing: 1, wave: 3, swinging: 3}


@pytest.fixture(autouse=True)
def _registered():
    for law, parameters in LAWS.items():
        gd.register_torque(law.__name__, parameters=parameters)(law)
    yield
    for law in LAWS:
        gd.unregister_torque(law.__name__)


def law(name, *parameters):
    return {"name": name, "parameters": parameters}


# a hundred times the tolerance of 1e-9 per step
CLOSE = {"rtol": 1e-7, "atol": 0}


def test_a_law_of_time_in_flight(flight):
    """I1 w' = k t."""
    slope = 5.6e-16
    scene = flight.replace({"drive.law": law("ramp", slope)})
    run = solve(scene)
    speed = 4 * W0 + slope * run.time**2 / (2 * I1)
    np.testing.assert_allclose(run.samples["pinion_speed"], speed, **CLOSE)
    np.testing.assert_allclose(run.samples["gear_speed"], W0, **CLOSE)
    gained = 0.5 * I1 * (speed[-1] ** 2 - speed[0] ** 2)
    assert run.balance.drive_work == pytest.approx(gained, rel=1e-7, abs=0)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_law_of_speed_in_flight(flight, backend):
    """I1 w' = -c w decays exponentially."""
    scene = flight.replace({"drive.law": law("viscous", DECAY * I1)})
    run = solve(scene, backend=backend)
    speed = 4 * W0 * np.exp(-DECAY * run.time)
    np.testing.assert_allclose(run.samples["pinion_speed"], speed, **CLOSE)
    lost = 0.5 * I1 * (speed[0] ** 2 - speed[-1] ** 2)
    assert run.balance.drive_work == pytest.approx(-lost, rel=1e-7, abs=0)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_law_of_the_load_resists_either_way(flight, sign):
    scene = flight.replace({"load.law": law("rubbing", DECAY * I2), "initial.gear_speed": sign * W0})
    run = solve(scene)
    speed = sign * W0 * np.exp(-DECAY * run.time)
    np.testing.assert_allclose(run.samples["gear_speed"], speed, **CLOSE)
    lost = 0.5 * I2 * (speed[0] ** 2 - speed[-1] ** 2)
    assert run.balance.dry_loss == pytest.approx(lost, rel=1e-7, abs=0)
    assert_balanced(run.balance, scene)


def test_the_speed_is_that_of_the_pinion_with_its_static_error(flight):
    error = {"order": 3, "amplitude": 0.02 * R1, "phase": 0.4}
    scene = flight.replace({"drive.law": law("viscous", DECAY * I1), "mesh.static_error": [error]})
    run = solve(scene)
    start = run.samples["pinion_speed"][0]
    np.testing.assert_allclose(run.samples["pinion_speed"], start * np.exp(-DECAY * run.time), **CLOSE)


@pytest.mark.parametrize("shaft", ["drive", "load"])
def test_a_law_does_what_the_same_harmonic_does(shaft):
    """In contact, against the terms that the engine has of its own."""
    low = gd.preset("teodorescu2009_low_speed").replace(
        {"run.duration": 0.01, "run.samples": 101, "run.rtol": 1e-8, "load.torque": 1e-18}
    )
    amplitude, frequency, phase = 8e-19, 700.0, 0.6
    harmonic = {"amplitude": amplitude, "frequency": frequency, "phase": phase}
    harmonics = solve(low.replace({f"{shaft}.harmonic": harmonic}))
    scene = low.replace({f"{shaft}.law": law("wave", amplitude, frequency, phase)})
    named = solve(scene)
    for name in ("gear_speed", "pinion_speed"):
        # the two units of force differ by a harmonic's part, so that steps do; thirty times their errors
        np.testing.assert_allclose(named.samples[name], harmonics.samples[name], rtol=1e-4, atol=0)
    assert named.balance.drive_work == pytest.approx(harmonics.balance.drive_work, rel=1e-5, abs=0)
    assert named.balance.dry_loss == pytest.approx(harmonics.balance.dry_loss, rel=1e-5, abs=0)
    assert np.count_nonzero(named.events.kind == EventKind.TURNING_POINT) > 3
    assert_balanced(named.balance, scene)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize(
    "drive", [("motor", 9e-18, 12.0), ("swinging", 9e-18, 12.0, 2000.0)], ids=lambda d: d[0]
)
def test_energy_balances_with_laws_of_time_and_speed(drive, rtol):
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "run.duration": 0.03,
            "run.samples": 31,
            "run.rtol": rtol,
            "coating.sam_fraction": 0.6,
            "drive.torque": 0.0,
            "drive.law": law(*drive),
            "load.law": law("rubbing", 1e-18),
        }
    )
    run = solve(scene)
    assert np.count_nonzero(run.events.kind == EventKind.TURNING_POINT) > 3
    assert_balanced(run.balance, scene)


def test_a_motor_settles_where_its_torque_balances_the_drag():
    """M0 (1 - 4 w / w0) = alpha w^2 / 4, for a gear four times the pinion."""
    stall, free, drag = 9e-18, 12.0, 8e-18
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "run.duration": 0.06,
            "run.samples": 6001,
            "drive.torque": 0.0,
            "drive.law": law("motor", stall, free),
        }
    )
    run = solve(scene)
    speed = np.roots([drag / 4, 4 * stall / free, -stall]).max()
    assert run.samples["gear_speed"][3000:].mean() == pytest.approx(speed, rel=1e-3, abs=0)  # what rings on


def test_a_scene_without_a_law_has_no_address(flight):
    work = make_problem(flight).model.work
    assert not work.torque_law.any()
    work = make_problem(flight.replace({"load.law": law("rubbing", 1e-18)})).model.work
    assert (work.torque_law != 0).tolist() == [False, True]


def test_a_law_that_cannot_be_compiled_is_named(flight):
    gd.register_torque("wordy")(lambda t, speed, p: "much")
    try:
        with pytest.raises(SceneError, match=r"law\.name = wordy: numba cannot compile"):
            solve(flight.replace({"drive.law": law("wordy")}))
    finally:
        gd.unregister_torque("wordy")


def test_a_name_can_be_given_anew(flight):
    """The law that counts is the one that is registered when the run begins."""
    scene = flight.replace({"drive.law": law("ramp", 5.6e-16)})
    before = solve(scene).samples["pinion_speed"][-1]
    gd.unregister_torque("ramp")
    gd.register_torque("ramp", parameters=1)(lambda t, speed, p: 2.0 * p[0] * t)
    after = solve(scene).samples["pinion_speed"][-1]
    assert after - 4 * W0 == pytest.approx(2 * (before - 4 * W0), rel=1e-6, abs=0)
