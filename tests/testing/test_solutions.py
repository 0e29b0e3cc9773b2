"""Reference solutions agree with runs, and with independent quadratures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearidae as gd
from gearidae.testing import solutions

LOW = gd.preset("teodorescu2009_low_speed")
FREE = {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "run.samples": 9, "run.rtol": 1e-9}


def free_gear(**changes):
    """A gear that no tooth reaches within the run."""
    return LOW.replace({**FREE, "drive.torque": 0.0, **changes})


@pytest.mark.parametrize(("viscous", "drag"), [(0.0, 8e-18), (3e-17, 0.0), (3e-17, 8e-18), (0.0, 0.0)])
def test_run_down_of_a_gear_in_free_flight(viscous, drag):
    changes = {"load.viscous": viscous, "load.drag": drag, "run.duration": 2e-4, "initial.gear_speed": 3.0}
    scene = free_gear(**changes)
    ds = gd.simulate(scene)
    assert not np.isin(ds.event_kind, 0).any()  # no onset
    speed, angle = solutions.run_down(
        ds.time.values, 3.0, scene.gears.gear_inertia, viscous=viscous, drag=drag
    )
    # a hundred times the tolerance of a step
    np.testing.assert_allclose(ds.gear_speed, speed, rtol=1e-7)
    np.testing.assert_allclose(ds.gear_angle - ds.gear_angle[0], angle, rtol=1e-7, atol=1e-13)


@pytest.mark.parametrize("drag", [0.0, 8e-18])
def test_dry_stop_of_a_gear_in_free_flight(drag):
    resistance = 3e-17
    scene = free_gear(
        **{"load.torque": resistance, "load.drag": drag, "run.duration": 8e-3, "initial.gear_speed": 2.0}
    )
    stop = solutions.dry_stop(2.0, scene.gears.gear_inertia, resistance, drag=drag)
    assert stop.time < 8e-3
    events = gd.simulate(scene).gearidae.events()
    sticks = events.loc[events["kind"] == "stick", "time"]
    assert sticks.iloc[0] == pytest.approx(stop.time, rel=1e-7, abs=0)


def test_dry_stop_without_drag_is_the_limit_of_little_drag():
    np.testing.assert_allclose(
        solutions.dry_stop(2.0, 6e-20, 3e-17), solutions.dry_stop(2.0, 6e-20, 3e-17, drag=1e-24), rtol=1e-6
    )


def test_run_down_solves_its_equation():
    inertia, c, k = 6.1e-20, 2e-17, 8e-18
    solution = solve_ivp(
        lambda t, y: [-(c * y[0] + k * y[0] ** 2) / inertia, y[0]],
        (0, 1e-2),
        [2.0, 0.0],
        rtol=1e-11,
        atol=1e-14,
    )
    speed, angle = solutions.run_down(1e-2, 2.0, inertia, viscous=c, drag=k)
    np.testing.assert_allclose([speed, angle], solution.y[:, -1], rtol=1e-9)


def test_static_mesh_force_of_a_held_train():
    scene = LOW.replace(
        {
            "load.torque": 1e-16,
            "initial.gear_speed": 0.0,
            "mesh.damping": 1e-7,
            "run.duration": 0.05,
            "run.samples": 3,
        }
    )
    ds = gd.simulate(scene)
    # the ringing after the first touch has died down to this
    assert float(ds.mesh_force[-1]) == pytest.approx(solutions.static_mesh_force(scene), rel=1e-4, abs=0)


@pytest.mark.parametrize("fraction", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("law", ["jkr", "maugis", "hertz"])
def test_speed_after_an_impact(fraction, law):
    scene = gd.preset("roller_slow").replace(
        {
            "coating.sam_fraction": fraction,
            "contact.bodies": "rigid",
            "contact.asperity": law,
            "run.duration": 4e-5,
            "run.samples": 3,
            "run.rtol": 1e-9,
        }
    )
    ds = gd.simulate(scene)
    assert float(ds.height[-1]) > 15 * scene.surface.roughness  # it has come free
    expected = solutions.speed_after_impact(scene, float(ds.smallest_separation))
    # the gap of the turning point enters squared; the tables of force and energy are good to 1e-10
    assert abs(float(ds.speed[-1])) == pytest.approx(expected, rel=1e-7, abs=0)


def test_jkr_curve_has_its_fold_and_its_pull_off():
    displacement, load = solutions.jkr_curve(np.cbrt([1 / 18, 0.5, 8 / 9]))
    np.testing.assert_allclose(displacement, [-1.0, -0.48075, 0.0], atol=1e-5)
    np.testing.assert_allclose(load, [-5 / 9, -1.0, -8 / 9], rtol=1e-14)
    a = np.linspace(0.5, 3.0, 50)
    displacement, load = solutions.jkr_curve(a)
    np.testing.assert_allclose(gd.contact.jkr_load(displacement), load, rtol=1e-10, atol=1e-12)


def test_train_inertia():
    gears = LOW.gears
    assert solutions.train_inertia(LOW) == pytest.approx(
        gears.gear_inertia + 16 * gears.pinion_inertia, rel=1e-15, abs=0
    )


@pytest.mark.parametrize("solution", [solutions.train_inertia, solutions.static_mesh_force])
def test_a_roller_has_no_gears(solution):
    with pytest.raises(gd.SceneError, match="gears"):
        solution(gd.preset("roller_slow"))


def test_gears_are_no_roller():
    with pytest.raises(gd.SceneError, match="roller"):
        solutions.impact_loss(LOW, 1e-8)


def test_a_roller_that_loses_more_than_it_has_stays():
    scene = gd.preset("roller_slow").replace(
        {"roller.speed": 1e-6, "coating.sam_fraction": 0.0, "contact.bodies": "rigid"}
    )
    assert math.isnan(solutions.speed_after_impact(scene, 5e-9))
