"""The bound of the energy balance's residual: what it is made of, and what it notices."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.formulas.quadrature import Ends, integral_of_cube, integral_of_square
from gearidae.records import (
    GEAR_BOUND,
    QUADRATURE_BOUND,
    ROLLER_BOUND,
    ROUNDING_BOUND,
    TABLE_BOUND,
    TORQUE_BOUND,
    EnergyBalance,
)
from gearidae.records.energy import ENERGY_NOW, ENERGY_SUMS

HIGH, LOW = gd.preset("teodorescu2009"), gd.preset("teodorescu2009_low_speed")
SCENES = {
    "sticking": LOW.replace({"run.duration": "30 ms", "coating.sam_fraction": 0.45}),
    "damped": HIGH.replace({"run.duration": "0.3 ms", "mesh.damping": 1e-6, "run.rtol": 1e-9}),
    "dry": HIGH.replace({"run.duration": "0.3 ms", "load.torque": 1e-12}),
    "roller": gd.preset("roller_slow"),
}


def replace(balance, **numbers):
    return EnergyBalance({**balance, **numbers})


def bound(scene, balance):
    return balance.bound(scene.run.rtol, roller=scene.roller is not None)


@pytest.fixture(scope="module")
def balances():
    return {name: solve(scene.replace({"run.samples": "off"})).balance for name, scene in SCENES.items()}


# -- what it notices -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
def test_a_sound_run_is_not_warned_of(balances, name):
    assert 0.0 < abs(balances[name].residual) <= bound(SCENES[name], balances[name])


@pytest.mark.parametrize(
    ("name", "booking"),
    [
        ("sticking", "adhesion_loss"),
        ("sticking", "drive_work"),
        ("sticking", "radius_work"),
        ("damped", "damping_loss"),
        ("damped", "drag_loss"),
        ("damped", "radius_work"),
        ("dry", "dry_loss"),
        ("roller", "adhesion_loss"),
    ],
)
def test_a_booking_that_is_a_hundredth_out_is_warned_of(balances, name, booking):
    balance = balances[name]
    for factor in (0.99, 1.01, 2.0):
        wrong = replace(balance, **{booking: factor * balance[booking]})
        assert abs(wrong.residual) > bound(SCENES[name], wrong)


# -- what it is made of ----------------------------------------------------------------------------------------------

NOTHING = {name: 0.0 for quantity in (*ENERGY_SUMS, *ENERGY_NOW) for name in quantity.names}


def test_the_bound_is_the_sum_of_its_parts():
    moved = EnergyBalance({**NOTHING, "throughput": 3.0, "largest": 2.0})
    assert moved.bound(1e-6, roller=False) == pytest.approx(
        5.0 * (GEAR_BOUND * 1e-6 + ROUNDING_BOUND), rel=1e-12
    )
    assert moved.bound(1e-6, roller=True) == pytest.approx(
        5.0 * (ROLLER_BOUND * 1e-6 + ROUNDING_BOUND), rel=1e-12
    )
    assert replace(moved, quadrature_error=7.0).bound(1e-6, roller=False) - moved.bound(
        1e-6, roller=False
    ) == pytest.approx(7.0 * QUADRATURE_BOUND, rel=1e-12)
    assert replace(moved, speed_work=4.0).bound(1e-6, roller=False) == pytest.approx(
        9.0 * (GEAR_BOUND * 1e-6 + ROUNDING_BOUND), rel=1e-12
    )
    assert replace(moved, torque_work=8.0).bound(1e-6, roller=False) - moved.bound(
        1e-6, roller=False
    ) == pytest.approx(8.0 * TORQUE_BOUND * 1e-6, rel=1e-9)
    # no tolerance makes the tables any better
    assert moved.bound(1e-12, roller=False) == moved.bound(TABLE_BOUND, roller=False)


def test_a_travel_that_is_rounded_is_not_warned_of():
    """A gear held at rest by a torque: a rounding of a pitch, times the torque, is all that moves."""
    at_rest = EnergyBalance({**NOTHING, "pitch_work": 1e-17, "drive_work": 1e-17 * np.finfo(float).eps})
    assert abs(at_rest.residual) <= at_rest.bound(1e-6, roller=False) < 1e-17 * 1e-13


def test_a_heavy_gear_is_known_no_better_than_its_speed():
    """A flywheel on the pinion's shaft: the tolerance of its speed is worth more energy than contacts have.

    The residual stays far below that: steps follow the harmonic of the drive, however slowly the gears turn.
    """
    scene = HIGH.replace(
        {
            "gears.pinion_inertia": 1e-10,
            "initial.gear_speed": 1e-2,
            "contact.bodies": "rigid",
            "run.rtol": 1e-8,
            "run.duration": "1 ms",
            "run.samples": "off",
        }
    )
    heavy = solve(scene).balance
    mass = scene.gears.pinion_inertia / scene.geometry.base_radius_pinion**2
    momentum = math.sqrt(2.0 * heavy.largest * mass)
    speed = heavy.speed_work / momentum  # the gear's share is next to nothing
    problem = make_problem(scene)
    unit = problem.model.scene.length_unit / problem.model.scene.time_unit
    assert speed == pytest.approx(unit, rel=1e-3)
    assert abs(heavy.residual) <= bound(scene, replace(heavy, speed_work=0.0)) < bound(scene, heavy)


@pytest.mark.parametrize(
    "drive",
    [
        {"drive.speed": 6.0, "drive.speed_gain": 1e-13},
        {"drive.law": {"name": "motor", "parameters": [6e-13, 6.0]}},  # the same slope
    ],
)
def test_a_stiff_drive_makes_work_of_errors_of_the_speed(drive):
    """Its slope, times the speed to which the tolerance refers, times how far the pinion has turned."""
    scene = LOW.replace({"drive.harmonic": None, "run.duration": "5 ms", "run.samples": "off", **drive})
    stiff = solve(scene).balance
    problem = make_problem(scene)
    unit = problem.model.scene.length_unit / problem.model.scene.time_unit
    radius = scene.geometry.base_radius_pinion
    work = 1e-13 / radius**2 * unit * 6.0 * radius * 0.005
    assert stiff.torque_work == pytest.approx(work, rel=0.1, abs=0.0)
    assert abs(stiff.residual) <= bound(scene, stiff)


def test_torques_that_know_no_speed_make_no_work_of_its_errors(balances):
    assert all(balance.torque_work == 0.0 for balance in balances.values())


def test_the_largest_energies_are_those_of_the_motion(balances):
    """A roller's kinetic energy is largest at its start or as it is pulled in; nothing is stored before."""
    scene = SCENES["roller"]
    run = solve(scene)
    fastest = 0.5 * scene.roller.mass * np.abs(run.samples["speed"]).max() ** 2
    # the peak is known at steps, the samples' at samples
    assert run.balance.largest == pytest.approx(fastest, rel=1e-2, abs=0)


# -- estimates of the quadratures' errors ----------------------------------------------------------------------------

STARTS = np.linspace(0.0, 2.0 * math.pi, 17)[:-1]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def mean_square(values):
    return math.sqrt(np.mean(np.square(values)))


@pytest.mark.parametrize("h", [0.05, 0.2, 0.8, 3.0])
def test_the_error_of_a_square_is_no_larger_than_estimated(h):
    """Of a vibration, over where in it the interval lies, up to half a period.

    Errors are of seventh order in the length, estimates of fifth.
    """
    errors, estimates = [], []
    for start in STARTS:
        a, b = start, start + h
        exact = 0.5 * h * WEIGHTS @ np.cos(start + 0.5 * h * (1.0 + NODES)) ** 2
        ends = Ends(math.cos(a), -math.sin(a), math.cos(b), -math.sin(b))
        value, estimate = integral_of_square(h, math.sin(b) - math.sin(a), ends)
        errors.append(value - exact)
        estimates.append(estimate)
    ratio = mean_square(estimates) / mean_square(errors)
    assert 1.0 < ratio < 30.0 / h**2


@pytest.mark.parametrize("last_rate", [-30.0, 30.0])
def test_drag_over_too_long_a_step_is_known_to_be_unknown(last_rate):
    """Rates say nothing of the speed between: corrections are many times the integral, and so is the doubt."""
    value, estimate = integral_of_cube(1.0, 0.75, Ends(1.0, -30.0, 0.5, last_rate))
    at_most, at_least = 1.0, 0.5**3  # of a speed between those at the ends
    assert estimate > max(value - at_least, at_most - value)


@pytest.mark.parametrize(("mean", "deviation"), [(3.0, 0.3), (3.0, 0.03), (1.0, 0.9), (0.3, 1.0)])
@pytest.mark.parametrize("h", [0.1, 0.4, 1.6])
def test_the_error_of_drag_is_as_estimated(mean, deviation, h):
    """The last speed turns round; the rule for that has a coarser estimate. Errors are of one order more in h^2."""
    errors, estimates = [], []
    for start in STARTS:
        ends = np.array([start, start + h])
        speeds, rates = mean + deviation * np.cos(ends), -deviation * np.sin(ends)
        travel = mean * h + deviation * np.diff(np.sin(ends))[0]
        inside = np.abs(mean + deviation * np.cos(start + 0.5 * h * (1.0 + NODES))) ** 3
        value, estimate = integral_of_cube(h, travel, Ends(speeds[0], rates[0], speeds[1], rates[1]))
        errors.append(value - 0.5 * h * WEIGHTS @ inside)
        estimates.append(estimate)
    assert 1.0 < mean_square(estimates) / mean_square(errors) < max(10.0, 150.0 / h**2)
