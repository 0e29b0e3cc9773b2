"""A drive that holds a speed, viscous drag and cubic schedules, against closed forms."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.integrate.correction import correct
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.setup.build import make_problem
from gearidae.laws.law import DRIVE
from gearidae.records import EventKind

R1, R2 = 34.715e-6, 4 * 34.715e-6
I1, I2 = 1.5263e-20, 6.1052e-20
W0 = 1.5
RATE = 400.0  # per second: relaxation of the pinion, and of the gear's run-down
DRIVERS = ("native", "sksundae")


# a hundred times the tolerance of 1e-9 per step
CLOSE = {"rtol": 1e-7, "atol": 0}


@pytest.mark.parametrize("backend", DRIVERS)
def test_the_torque_speed_line_is_approached_exponentially(flight, backend):
    """I1 w' = g (w_t - w)."""
    target = 4.4 * W0
    scene = flight.replace({"drive.speed": target, "drive.speed_gain": RATE * I1})
    run = solve(scene, backend=backend)
    speed = target - 0.4 * W0 * np.exp(-RATE * run.time)
    np.testing.assert_allclose(run.samples["pinion_speed"], speed, **CLOSE)
    np.testing.assert_allclose(run.samples["gear_speed"], W0, **CLOSE)
    gained = 0.5 * I1 * (speed[-1] ** 2 - speed[0] ** 2)
    assert run.balance.drive_work == pytest.approx(gained, rel=1e-6, abs=0)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_ramp_of_the_held_speed_is_followed_with_its_lag(flight, interpolation):
    """Of w_t = w0 + a t the solution lags by a/k (1 - exp(-k t)); a cubic through points of a line is the line."""
    slope = 50.0
    knots = [(t, 4 * W0 + slope * t) for t in (0.0, 0.003, 0.009, 0.01)]
    held = {"knots": knots, "interpolation": interpolation}
    scene = flight.replace({"drive.speed": held, "drive.speed_gain": RATE * I1})
    run = solve(scene)
    lag = slope / RATE * -np.expm1(-RATE * run.time)
    np.testing.assert_allclose(run.samples["pinion_speed"], 4 * W0 + slope * run.time - lag, **CLOSE)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("backend", DRIVERS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_viscous_drag_runs_down_exponentially(flight, sign, backend):
    """I2 w' = -c w, either way; what it takes is in the loss to drag."""
    scene = flight.replace({"load.viscous": RATE * I2, "initial.gear_speed": sign * W0})
    run = solve(scene, backend=backend)
    speed = sign * W0 * np.exp(-RATE * run.time)
    np.testing.assert_allclose(run.samples["gear_speed"], speed, **CLOSE)
    lost = 0.5 * I2 * (speed[0] ** 2 - speed[-1] ** 2)
    assert run.balance.drag_loss == pytest.approx(lost, rel=1e-7, abs=0)
    assert_balanced(run.balance, scene)


def test_both_drags_together(flight):
    """Of I2 w' = -c w - a w^2, with k = c/I2 and b = a/I2: w = k w0 e / (k + b w0 (1 - e)), e = exp(-k t)."""
    drag = 8e-18
    scene = flight.replace({"load.viscous": RATE * I2, "load.drag": drag})
    run = solve(scene)
    left, b = np.exp(-RATE * run.time), drag / I2
    speed = RATE * W0 * left / (RATE + b * W0 * (1 - left))
    np.testing.assert_allclose(run.samples["gear_speed"], speed, **CLOSE)
    assert_balanced(run.balance, scene)


def test_a_large_gain_prescribes_the_speed():
    """60 rpm at the pinion, within load over gain, through contacts with their hysteresis; the balance closes."""
    gain, target = 1e-16, 2 * math.pi
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "drive.torque": 0.0,
            "drive.speed": "60 rpm",
            "drive.speed_gain": gain,
            "load.viscous": 1e-18,
            "run.duration": 0.02,
            "run.samples": 401,
        }
    )
    run = solve(scene)
    speed = run.samples["pinion_speed"][200:]
    torque = (8e-18 * (target / 4) ** 2 + 1e-18 * target / 4) / 4
    assert speed.mean() == pytest.approx(target - torque / gain, rel=1e-3)  # what is left of the ringing
    assert run.balance.drag_loss > 0
    assert_balanced(run.balance, scene)


@pytest.fixture
def touching():
    """State of gears in contact, all terms in use, and a problem of it."""
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "initial.gap": 28e-9,
            "drive.speed": [[0.0, 5.0], [1.0, 9.0]],
            "drive.speed_gain": 3e-18,
            "load.viscous": 2e-17,
            "mesh.damping": 1e-12,
            "contact.bodies": "rigid",
            "contact.asperity": "hertz",  # without hysteresis, whose force has a corner at the start
        }
    )
    return make_problem(scene)


def test_the_jacobian_knows_the_gain_and_the_viscous_drag(touching):
    """Columns of the transmission error and both speeds; that of the phase leaves the length of the contact out."""
    m, y = touching.prepare(1e-6, 0), touching.start.copy()
    yp, cj = np.array([0.1, 0.2, 0.3, 0.4]), 2.5
    out, low, high = np.empty(16), np.empty(4), np.empty(4)
    jacobian(m, 0.0, cj, y, out)
    for j in (0, 1, 3):
        step = 1e-4 * max(abs(y[j]), 1.0)  # forces are some thousands: far above their rounding
        for sign, f in ((1, high), (-1, low)):
            moved, rates = y.copy(), yp.copy()
            moved[j] += sign * step
            rates[j] += sign * cj * step
            residual(m, 0.0, moved, rates, f)
        slopes = (high - low) / (2 * step)
        scale = np.abs(out[4 * j : 4 * j + 4]).max()
        np.testing.assert_allclose(out[4 * j : 4 * j + 4], slopes, atol=1e-5 * scale, rtol=0)


def test_newtons_correction_solves_the_linear_equations(touching):
    """The elimination by hand is the full matrix's solution."""
    m, y = touching.prepare(1e-6, 0), touching.start.copy()
    yp, cj, delta = np.array([0.1, 0.2, 0.3, 0.4]), 2.5, np.empty(4)
    matrix, rest = np.empty(16), np.empty(4)
    jacobian(m, 0.0, cj, y, matrix)
    residual(m, 0.0, y, yp, rest)
    omega_sq = correct(m, 0.0, cj, y, yp, delta)
    np.testing.assert_allclose(delta, np.linalg.solve(matrix.reshape(4, 4).T, -rest), rtol=1e-9)
    gain = m.scene.pinion_inverse_mass * m.scene.torque[DRIVE].speed_gain
    assert omega_sq >= (2 * gain) ** 2 > 0


def cubic_of(schedule):
    times, values = np.array(schedule).T
    inner = PchipInterpolator(times, values)
    return lambda t: float(inner(np.clip(t, times[0], times[-1])))


@pytest.mark.parametrize("backend", DRIVERS)
def test_a_cubic_schedule_in_flight(flight, backend):
    """The pinion's speed is the integral of scipy's own interpolant; only its ends are stops."""
    rng = np.random.default_rng(5)
    times = np.sort(rng.uniform(5e-4, 7.5e-3, 40))
    knots = np.column_stack([times, 4e-18 * rng.standard_normal(40)])
    scene = flight.replace({"drive.schedule": {"knots": knots, "interpolation": "cubic"}})
    run = solve(scene, backend=backend)
    integral = PchipInterpolator(*knots.T).antiderivative()
    impulse = integral(np.clip(run.time, times[0], times[-1])) - integral(times[0])
    impulse += knots[0, 1] * np.minimum(run.time, times[0])
    impulse += knots[-1, 1] * np.maximum(run.time - times[-1], 0)
    # corners of the curvature cost a step some accuracy: a thousand tolerances on the scale of the speed
    np.testing.assert_allclose(run.samples["pinion_speed"], 4 * W0 + impulse / I1, rtol=1e-6)
    stops = run.events.time[run.events.kind == EventKind.SCHEDULE_KNOT]
    np.testing.assert_allclose(stops, times[[0, -1]], rtol=1e-12)
    assert_balanced(run.balance, scene)


def test_two_knots_of_a_cubic_are_a_line(flight):
    knots = [(0.001, 0.0), (0.005, 3e-18)]
    cubic = flight.replace({"drive.schedule": {"knots": knots, "interpolation": "cubic"}})
    line = flight.replace({"drive.schedule": knots})
    np.testing.assert_array_equal(solve(cubic).samples["pinion_speed"], solve(line).samples["pinion_speed"])


def test_a_narrow_pulse_of_a_cubic_schedule_is_not_stepped_over(flight):
    """A pulse of 1/400 of the run, in long flight: its impulse arrives whole."""
    knots = [(0.0, 0.0), (0.00399, 0.0), (0.004, 1e-16), (0.00401, 0.0), (0.008, 0.0)]
    scene = flight.replace({"drive.schedule": {"knots": knots, "interpolation": "cubic"}})
    run = solve(scene)
    impulse = PchipInterpolator(*np.array(knots).T).integrate(0.0, 0.008)
    assert run.samples["pinion_speed"][-1] - 4 * W0 == pytest.approx(impulse / I1, rel=1e-5)


def test_the_slow_twin_agrees_in_flight_with_all_terms(flight):
    """Held speed, cubic torque and both drags at once, by another integrator."""
    knots = [(0.0, 0.0), (0.002, 2e-18), (0.003, -1e-18), (0.008, 1e-18)]
    speeds = [(0.0, 6.0), (0.004, 6.3), (0.008, 5.9)]
    scene = flight.replace(
        {
            "drive.schedule": {"knots": knots, "interpolation": "cubic"},
            "drive.speed": {"knots": speeds, "interpolation": "cubic"},
            "drive.speed_gain": RATE * I1,
            "load.viscous": 0.3 * RATE * I2,
            "load.drag": 8e-18,
        }
    )
    torque, held = cubic_of(knots), cubic_of(speeds)

    def rates(t, w):
        pinion = (torque(t) + RATE * I1 * (held(t) - w[0])) / I1
        return [pinion, -(0.3 * RATE * w[1] + 8e-18 / I2 * w[1] * abs(w[1]))]

    run = solve(scene)
    slow = solve_ivp(
        rates, (0, 0.008), [4 * W0, W0], "DOP853", run.time, rtol=1e-12, atol=1e-12, max_step=1e-4
    )
    np.testing.assert_allclose(run.samples["pinion_speed"], slow.y[0], rtol=1e-6)
    np.testing.assert_allclose(run.samples["gear_speed"], slow.y[1], rtol=1e-6)
    assert_balanced(run.balance, scene)
