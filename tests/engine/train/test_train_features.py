"""What meshes and shafts of a train may have: each against the pair of its own, and against the energy balance.

The load is on the idler, and the second mesh never touches: the first mesh and its shafts must move as the pair does by
the engine of pairs, which has another formula, other states and another balance.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from tests.mesh.test_slow_train import idle, offset
from tests.reference.trains import chain, split

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.train import solve as solving
from gearidae.engine.train import solve_train
from gearidae.engine.train.build import make_train
from gearidae.engine.train.motion import torque_slopes
from gearidae.engine.train.solve import follow_train
from gearidae.records import EventKind
from gearidae.records.train_results import ENERGIES, WORKS_OF_MESHES, WORKS_OF_SHAFTS
from gearidae.scene import Scene

SPEED, FORCE = 1e-7, 1e-5
ADHERING = {"coating.thickness": 0.0, "coating.sam_fraction": 0.6}
TABLE = [[0.9, 0.7, 0.4, 0.6], [0.5, 0.8, 0.6, 1.0]] * 9 + [[0.3, 0.9, 0.5, 0.7]]
"""Coverage of the 19 teeth of the driver at four places."""


def half_in_sectors(t, angle, speed, p):
    """Torque that is halved within sectors of the driver's angle."""
    return p[0] if math.cos(200.0 * angle) > 0.3 else 0.5 * p[0]


def sector_ends(t, angle, speed, p):
    return math.cos(200.0 * angle) - 0.3


def back_and_forth(t, angle, speed, p):
    return p[0] if speed < p[1] else -p[0]


def wanted_speed(t, angle, speed, p):
    return speed - p[1]


@pytest.fixture(scope="module", autouse=True)
def _registered():
    gd.register_torque("sectors_of_a_train", parameters=1, switch=sector_ends)(half_in_sectors)
    gd.register_torque("held_by_jumps", parameters=2, switch=wanted_speed)(back_and_forth)
    yield
    gd.unregister_torque("sectors_of_a_train")
    gd.unregister_torque("held_by_jumps")


LAW = {"name": "sectors_of_a_train", "parameters": [1.4e-11]}
FEATURES = {
    "friction": {"contact.friction": 0.3},
    "friction and adhesion": {
        "contact.asperity": "jkr",
        **ADHERING,
        "contact.friction": 0.3,
        "coating.friction": 0.2,
    },
    "shear strength": {"contact.friction_law": "shear", "contact.shear_strength": 5e8},
    "film": {"mesh.film_damping": 2e-4, "mesh.film_gap": 2e-8},
    "jkr": {"contact.asperity": "jkr", **ADHERING},
    "dmt": {"contact.asperity": "dmt", **ADHERING},
    "maugis": {"contact.asperity": "maugis", **ADHERING},
    "humid air": {
        **ADHERING,
        "contact.asperity": "meniscus",
        "surface.humidity": 0.8,
        "surface.bridged": 0.5,
        "surface.temperature": "320 K",
    },
    "humid air in one mesh": {
        **ADHERING,
        "contact.asperity": "meniscus",
        "surface.humidity": 0.5,
        "meshes.first.surface.humidity": 0.9,
        "meshes.first.surface.bridged": 0.7,
    },
    "attraction": {"surface.hamaker": 1e-19},
    "independent coatings": {"contact.asperity": "jkr", **ADHERING, "coating.pairing": "independent"},
    "coating by place": {"contact.asperity": "jkr", **ADHERING, "meshes.first.coating.pinion_table": TABLE},
    "radius force": {"mesh.radius_force": True},
    "static error": {"mesh.static_error": [{"order": 3, "amplitude": "5 nm", "phase": 0.5}]},
    "runout": {
        "mesh.pinion_runout": {"amplitude": "20 nm", "phase": 0.4},
        "mesh.gear_runout": {"amplitude": "30 nm", "phase": 1.4},
    },
    "pitch errors": {"mesh.pitch_error_rms": "1 nm", "mesh.pitch_error_seed": 3},
    "held speed": {"drive.torque": 0.0, "drive.speed": 3500.0, "drive.speed_gain": 2e-14},
    "schedule": {"drive.schedule": [[0.0, 0.0], [1e-5, 2e-12], [3e-5, -2e-12]]},
    "harmonics": {"drive.harmonic": [{"amplitude": 2e-12, "frequency": "60 kHz"}]},
    "schedules of both": {
        "drive.schedule": [[0.0, 0.0], [1e-5, 2e-12], [3e-5, -2e-12]],
        "load.schedule": [[0.0, 0.0], [1e-5, 3e-12], [2e-5, 0.0]],
    },
    "own law": {"drive.torque": 0.0, "drive.law": LAW},
    "own law of the load": {"load.law": {**LAW, "parameters": [3e-12]}},
}


def changed(tables, feature):
    return Scene.from_dict(tables).replace({"run.rtol": 1e-9, **FEATURES[feature]})


@cache
def first_alone(feature):
    return solve_train(changed(idle(), feature), t_end=50e-6, samples=6)


@cache
def as_pair(feature):
    """The first mesh with its drive and load, run as a pair."""
    scene = changed(idle(), feature)
    drive, load = ({**scene.to_dict().get(table, {})} for table in ("drive", "load"))
    load.pop("shaft")
    return solve(scene.pair("first").replace({"drive": drive, "load": load}), t_end=50e-6, samples=6)


def assert_closes(solution):
    energy = solution.energy
    assert solution.status == "finished"
    assert abs(energy["residual"]) < energy["residual_bound"] < 1e-4 * energy["throughput"]


@pytest.mark.parametrize("feature", FEATURES)
def test_a_mesh_moves_as_the_pair_does(feature):
    train, pair = first_alone(feature), as_pair(feature)
    for i, name in enumerate(("pinion_speed", "gear_speed")):
        np.testing.assert_allclose(train.samples["shaft_speed"][i], pair.samples[name], rtol=SPEED)
    largest = np.abs(pair.samples["mesh_force"]).max()
    np.testing.assert_allclose(
        train.samples["mesh_force"][0], pair.samples["mesh_force"], rtol=FORCE, atol=FORCE * largest
    )
    np.testing.assert_allclose(
        train.samples["transmission_error"][0], pair.samples["transmission_error"], rtol=1e-7
    )
    last = train.samples["shaft_speed"][2]
    np.testing.assert_array_equal(last, last[0])
    assert_closes(train)


@pytest.mark.parametrize("feature", FEATURES)
def test_a_mesh_has_the_energies_and_extremes_of_the_pair(feature):
    """Those of the pair come from a quadrature of its own, of fourth order, most visible in the radius' work."""
    train, pair = first_alone(feature), as_pair(feature)
    own, balance, energy = train.mesh_totals, pair.balance, train.energy
    for name in ("adhesion_loss", "damping_loss", "film_loss"):
        assert own[name][0] == pytest.approx(balance[name], rel=1e-6, abs=0.0), name
        assert own[name][1] == 0.0
    rubbed = balance.drive_friction_loss + balance.coast_friction_loss
    assert own["friction_loss"][0] == pytest.approx(rubbed, rel=1e-6, abs=0.0)
    assert own["friction_loss"][1] == 0.0
    expected = {
        "drive_work": balance.drive_work,
        "load_work": balance.drag_loss + balance.dry_loss,
        "kinetic_change": balance.kinetic_change,
        "stored_change": balance.stored_change,
    }
    for name, value in expected.items():
        assert energy[name] == pytest.approx(value, rel=2e-7, abs=0.0), name
    assert energy["radius_work"] == pytest.approx(balance.radius_work, rel=1e-4, abs=0.0)
    for name in ("largest_mesh_force", "smallest_mesh_force", "smallest_separation"):
        assert own[name][0] == pytest.approx(pair.extremes[name], rel=FORCE, abs=0.0), name
    assert own["mesh_exits"][0] == pair.extremes.mesh_exits


@pytest.mark.parametrize("feature", FEATURES)
def test_balance_of_both_meshes_closes(feature):
    assert_closes(solve_train(changed(chain(hubs=0.1), feature), t_end=60e-6, samples=2))


def test_bound_of_the_balance_knows_torques_that_depend_on_the_speed():
    """Errors of the speed, held by a gain, are work: over the run, the gain times their unit times the top speed."""
    bounds, slopes = [], []
    for gain in (1e-15, 1e-12):
        scene = changed(chain(), "held speed").replace({"drive.speed_gain": gain, "run.duration": 1e-5})
        problem = make_train(scene.replace({"run.samples": 2}))
        bounds.append(follow_train(problem, "native").energy["residual_bound"])
        slopes.append(torque_slopes(problem.model, 1e-5, problem.model.y))
    assert slopes == [pytest.approx((1e-15, 0.0), rel=1e-6), pytest.approx((1e-12, 0.0), rel=1e-6)]
    train = problem.model.train[0]
    unit = 1.0 / (problem.model.weights[len(problem.model.shafts) + train.drive] * 1e-9)
    inertia, ratio = problem.model.shafts["inertia"], problem.model.shafts["ratio"]
    top = 4.0 * math.sqrt(2.0 * train.peak_kinetic / (inertia * ratio**2).sum())
    work = 0.1 * 1e-9 * 1e-12 * unit * top * 1e-5
    assert bounds[1] > work > 0.1 * bounds[1]


@pytest.mark.parametrize("feature", ["maugis", "held speed", "own law"])
def test_the_other_driver_gives_the_same(feature):
    scene = changed(chain(hubs=0.1), feature).replace({"run.rtol": 1e-8})
    native, portable = (solve_train(scene, t_end=2e-6, samples=3, backend=b) for b in ("native", "sksundae"))
    np.testing.assert_allclose(portable.samples["shaft_speed"], native.samples["shaft_speed"], rtol=1e-7)
    np.testing.assert_allclose(portable.samples["mesh_force"], native.samples["mesh_force"], rtol=1e-6)
    assert_closes(portable)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_law_that_chatters_ends_the_run(backend):
    """A torque that jumps at a speed holds it by jumps without end: the run says so after 300 of them."""
    law = {"name": "held_by_jumps", "parameters": [1.4e-11, 3700.0]}
    scene = Scene.from_dict(chain(drive={"law": law}))
    solution = solve_train(scene, t_end=50e-6, samples=2, backend=backend)
    assert solution.status == "law_chatter"
    assert solution.reached < 50e-6
    assert solution.statistics.steps < 20_000


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_jumps_of_a_law_count_beyond_the_end_of_a_block(backend, monkeypatch):
    """A block of 100 steps has not the 300 jumps by which a law is known to chatter."""
    monkeypatch.setattr(solving, "STEPS", 100)
    monkeypatch.setattr(solving, "PORTABLE_STEPS", 100)
    law = {"name": "held_by_jumps", "parameters": [1.4e-11, 3700.0]}
    scene = Scene.from_dict(chain(drive={"law": law}))
    assert solve_train(scene, t_end=50e-6, samples=2, backend=backend).status == "law_chatter"


# -- long runs -------------------------------------------------------------------------------------------------------


def fast(**changes):
    """A chain whose last gear turns by a tooth in some 4 us."""
    tables = chain(load={"torque": 3e-11}, initial={"gear_speed": 2e4, "gap": "36 nm", "mesh_phase": 0.3})
    return Scene.from_dict(tables).replace(changes)


def test_a_long_run_keeps_its_counts():
    """Whole pitches are taken out of the angle some twenty times: counts, ratios and energies stay."""
    scene = fast()
    solution = solve_train(scene, t_end=1.2e-3, samples=13)
    assert_closes(solution)
    samples, angle = solution.samples, solution.samples["shaft_angle"]
    for k, mesh in enumerate(scene.train.meshes):
        geometry = mesh.geometry
        pitches = angle[mesh.b] * geometry.gear_teeth / (2.0 * math.pi)
        assert pitches[-1] > 300.0
        # a pair leaves at the end of the path of contact, in pitches behind its entry
        left = mesh.phase - geometry.contact_ratio
        expected = math.floor(left + pitches[-1]) - math.floor(left)
        assert solution.mesh_totals["mesh_exits"][k] == expected
        exits = solution.events["kind"] == int(EventKind.MESH_EXIT)
        exits &= (solution.events["mesh"] == k) & (solution.events["flank"] == 0)
        assert exits.sum() == expected
        np.testing.assert_array_equal(np.diff(solution.events["pair"][exits]), 1)
        # the angles of both shafts differ by the transmission error alone, from which they are known to 1e-16
        u = geometry.base_radius_pinion * angle[mesh.a] - geometry.base_radius_gear * angle[mesh.b]
        change = samples["transmission_error"][k] - samples["transmission_error"][k][0]
        np.testing.assert_allclose(u, change, rtol=0.0, atol=1e-16)


def test_teeth_are_the_same_where_pitches_are_taken_out():
    """Errors of single teeth, runout, coverage by place and histories, against a run that takes none out."""
    scene = fast(
        **FEATURES["coating by place"],
        **FEATURES["runout"],
        **FEATURES["pitch errors"],
        **{"run.rtol": 1e-10},
    ).replace({"run.duration": 1.5e-4, "run.samples": 4})
    ends = []
    for taken in (True, False):
        problem = make_train(scene)
        period = float(problem.model.train[0].period)
        if not taken:
            problem.model.train[0].period = 1e9
        ends.append(follow_train(problem, "native"))
        pitches = ends[-1].samples["shaft_angle"][2, -1] * 76 / (2.0 * math.pi)
        assert pitches > 2.0 * period
    for name in ("shaft_speed", "shaft_angle", "transmission_error"):
        np.testing.assert_allclose(ends[0].samples[name], ends[1].samples[name], rtol=1e-7, atol=1e-12)
    np.testing.assert_array_equal(ends[0].events["kind"], ends[1].events["kind"])
    np.testing.assert_array_equal(ends[0].events["pair"], ends[1].events["pair"])
    for solution in ends:
        assert_closes(solution)


# -- properties ------------------------------------------------------------------------------------------------------


def rhombus(standing_back, phase):
    """Input and output alike and equal idlers, at an angle by which the pairs of both are half a pitch apart."""
    theta = 33.0 * math.pi / 120.0
    tables = split((theta, theta))
    for name, teeth in (("input", 20), ("upper", 40), ("lower", 40), ("output", 20)):
        tables["shafts"][name] = {"teeth": teeth, "inertia": 1.2e-20 if teeth == 20 else 1.9e-19}
    tables["meshes"]["one"]["phase"] = phase
    tables["meshes"][standing_back]["offset"] = "3 nm"
    return tables


def test_a_wheel_that_stands_back_on_the_other_side_swaps_the_idlers():
    """At 1e-10, to 1e-7 of the speeds; phases that are swapped with the idlers make the mirror image exact."""
    first, second = (
        solve_train(Scene.from_dict(rhombus(*way)), t_end=60e-6, samples=7, rtol=1e-10).samples
        for way in (("two", 0.3), ("one", 0.8))
    )
    for name, order in (("shaft_speed", [0, 2, 1, 3]), ("mesh_force", [1, 0, 3, 2])):
        largest = np.abs(first[name]).max()
        np.testing.assert_allclose(first[name], second[name][order], rtol=0.0, atol=1e-7 * largest)
    one, two = first["mesh_force"][:2].mean(axis=1)
    assert one > 2.0 * two


def test_a_wheel_that_stands_back_in_a_reduction_does_so_but_for_the_phase():
    """Mean shares over four pitches of the load's gear differ by 7e-4, by 4e-5 at rest."""
    other = split()
    other["meshes"]["one"]["offset"] = "3 nm"
    shares = []
    for tables in (offset(), other):
        samples = solve_train(Scene.from_dict(tables), t_end=500e-6, samples=5001).samples
        turned = samples["shaft_angle"][3] * 76 / (2.0 * math.pi)
        forces = samples["mesh_force"][:, (turned >= 2.0) & (turned < 6.0)].mean(axis=1)
        shares.append(forces / forces[:2].sum())
    np.testing.assert_allclose(shares[0], shares[1][[1, 0, 3, 2]], rtol=0.0, atol=2e-3)
    assert shares[0][0] > 0.7


# -- keys of the run -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("run.method", "bdf"),
        ("run.samples", "ringing"),
        ("run.stop", "sticks"),
        ("run.impacts", True),
    ],
)
def test_what_a_train_does_not_do_is_refused(key, value):
    with pytest.raises(gd.SceneError, match=f"{key}.*several meshes") as caught:
        solve_train(Scene.from_dict(chain()).replace({key: value}))
    assert caught.value.key == key


def test_other_keys_of_a_run_are_followed():
    turn = 0.4 * 2.0 * math.pi / 76
    keys = {"run.stop": f"turns {0.4 / 76!r}", "run.samples": "off", "run.balance": False}
    solution = solve_train(Scene.from_dict(chain()).replace(keys))
    assert solution.time.size == solution.samples["drive_torque"].size == 0
    assert solution.status == "finished"
    until = solve_train(Scene.from_dict(chain()), t_end=solution.reached, samples=2)
    assert until.samples["shaft_angle"][2, -1] == pytest.approx(turn, rel=1e-9, abs=0.0)
    assert np.isnan([solution.energy[name] for name in ENERGIES]).all()
    assert np.isnan([solution.shaft_totals[name] for name in WORKS_OF_SHAFTS]).all()
    assert np.isnan([solution.mesh_totals[name] for name in WORKS_OF_MESHES]).all()
    short = solve_train(Scene.from_dict(chain()).replace({"run.largest_step": 2e-9}), t_end=1e-6, samples=2)
    assert short.statistics.steps >= 500
