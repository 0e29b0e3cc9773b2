"""Trains that come to rest: shafts that flanks alone hold, shafts that creep, loops; let go again; both drivers."""

from __future__ import annotations

import numpy as np
import pytest
from tests.engine.train.test_train_features import assert_closes
from tests.mesh.test_slow_train import idle
from tests.reference.trains import chain, split

from gearidae.engine.train import solve_train
from gearidae.mesh import curvature_radii
from gearidae.records import EventKind
from gearidae.scene import Scene

SLOW = {"gear_speed": 400.0, "gap": "36 nm", "mesh_phase": 0.3}
WEAK = {"torque": 2e-12}
"""A drive that the dry load of 3e-11 N m holds."""
DRIVERS = ("native", "sksundae")


def rubbing(tables, coefficient=0.3, **changes):
    return Scene.from_dict(tables).replace({"contact.friction": coefficient, "run.rtol": 1e-8, **changes})


def rests(solution):
    """Begins and ends of all rests, by the names of their shafts."""
    found = {name: [] for name in solution.shafts}
    for shaft, *when in zip(*(solution.rests[name] for name in ("shaft", "begin", "end")), strict=True):
        found[solution.shafts[int(shaft)]].append(tuple(map(float, when)))
    return found


def shaft_events(solution, kind):
    """Times at which shafts stick or slip, by their names."""
    events = solution.events
    mine = np.flatnonzero(events["kind"] == kind)
    return {solution.shafts[int(events["shaft"][k])]: float(events["time"][k]) for k in mine}


@pytest.fixture(scope="module")
def stopped():
    """A chain without hubs in both drivers: the dry load holds the output, flanks the two other shafts."""
    scene = rubbing(chain(drive=WEAK, initial=SLOW))
    return {driver: solve_train(scene, t_end=100e-6, samples=101, backend=driver) for driver in DRIVERS}


@pytest.mark.parametrize("driver", DRIVERS)
def test_a_shaft_that_flanks_alone_hold_has_its_rest(driver, stopped):
    solution = stopped[driver]
    found, sticks = rests(solution), shaft_events(solution, EventKind.STICK)
    for i, name in enumerate(solution.shafts):
        ((begin, end),) = found[name]
        assert (begin, end) == (sticks[name], solution.reached)
        assert solution.shaft_totals["rest_time"][i] == pytest.approx(end - begin, rel=1e-12)
        np.testing.assert_array_equal(solution.samples["shaft_speed"][i, solution.time > begin], 0.0)
    # two pairs that roll keep both of their shafts
    rolls = solution.events["time"][solution.events["kind"] == EventKind.FLANK_STICK]
    assert found["input"][0][0] == found["idler"][0][0] == rolls[-1] > found["output"][0][0]
    assert solution.flanks_held == (0, 1)
    assert_closes(solution)


def test_both_drivers_come_to_rest_at_the_same_place(stopped):
    native, portable = (stopped[driver] for driver in DRIVERS)
    for name, ((begin, _),) in rests(native).items():
        assert rests(portable)[name][0][0] == pytest.approx(begin, rel=1e-6)
    np.testing.assert_allclose(
        portable.samples["mesh_force"][:, -1], native.samples["mesh_force"][:, -1], rtol=1e-5
    )


def test_the_forces_at_rest_are_within_what_friction_holds(stopped):
    """Torques of the drive at the input: the mesh force's, and no more than all friction of the flanks beside it."""
    solution = stopped["native"]
    geometry = Scene.from_dict(chain()).train.meshes[0].geometry
    force = solution.samples["mesh_force"][0, -1]
    arm = geometry.tangent_pinion - geometry.approach + geometry.path_length
    missing = WEAK["torque"] - geometry.base_radius_pinion * force
    assert 0.0 < abs(missing) <= 0.3 * force * arm


@pytest.mark.parametrize("driver", DRIVERS)
def test_shafts_that_creep_come_to_rest(driver):
    """Damped far beyond a vibration the input creeps up to where friction of both pairs, at its limit, holds it.

    There ``M = F (R1 + mu sum s_i r1_i)`` with the shares of the mean law. What creeps behind that is below the
    tolerance, and stands.
    """
    tables = idle()
    tables["initial"] = {"gear_speed": 0.0, "gap": "24 nm", "mesh_phase": 0.3}
    tables["load"] = {"torque": 3e-11, "shaft": "idler"}
    scene = rubbing(tables, **{"drive.torque": 7e-12, "meshes.first.damping": 3e-4})
    solution = solve_train(scene, t_end=150e-6, samples=31, backend=driver)
    ((begin, end),) = rests(solution)["input"]
    assert begin < 120e-6 < end == solution.reached
    assert (solution.samples["shaft_speed"][0, solution.time > begin] == 0.0).all()
    geometry = scene.train.meshes[0].geometry
    places = np.array([0.3, 1.3]) * geometry.base_pitch
    first, _, radii = curvature_radii(geometry, places)
    shares = np.sqrt(radii) / np.sqrt(radii).sum()
    force = 7e-12 / (geometry.base_radius_pinion + 0.3 * shares @ first)
    # of the drive's torque friction is a tenth; the tolerance of the gap is 1e-8 of a roughness
    assert solution.samples["mesh_force"][0, -1] == pytest.approx(force, rel=1e-6)
    assert_closes(solution)


@pytest.mark.parametrize("coefficient", [0.0, 0.3])
def test_a_loop_stands_and_is_let_go(coefficient):
    """Flanks keep both wheels and the input of a split path at rest; without them they rock on the held output."""
    knots = [[0.0, 0.0], [120e-6, 0.0], [150e-6, 1e-11]]
    tables = split(drive=WEAK | {"schedule": knots}, initial=SLOW)
    solution = solve_train(rubbing(tables, coefficient), t_end=220e-6, samples=221)
    found = rests(solution)
    standing = (solution.time > 105e-6) & (solution.time < 120e-6)
    speeds = solution.samples["shaft_speed"]
    np.testing.assert_array_equal(speeds[-1, standing], 0.0)
    assert 120e-6 < found["output"][-1][1] < 160e-6
    if coefficient:
        np.testing.assert_array_equal(speeds[:, standing], 0.0)
        assert all(found[name] for name in solution.shafts)
    else:
        assert (np.abs(speeds[:3, standing]).max(axis=1) > 1e-3).all()
        assert not any(found[name] for name in solution.shafts[:-1])
    assert (speeds[:, -1] > 50.0).all()
    assert_closes(solution)


def test_a_ramp_lets_flanks_go():
    """Rests of shafts that flanks alone hold end with slips, the light shafts first."""
    knots = [[0.0, 0.0], [100e-6, 0.0], [200e-6, 1e-11]]
    scene = rubbing(chain(drive=WEAK | {"schedule": knots}, initial=SLOW))
    solution = solve_train(scene, t_end=200e-6, samples=21)
    found, slips = rests(solution), shaft_events(solution, EventKind.SLIP)
    ends = {name: found[name][-1][1] for name in solution.shafts}
    assert ends == slips
    assert 100e-6 < ends["input"] <= ends["idler"] <= ends["output"] < 200e-6
    assert (solution.samples["shaft_speed"][:, -1] > 10.0).all()
    assert_closes(solution)
