"""Motion of trains: every number of an independent prototype with its own laws and integrator (DOP853, RK4).

Its speeds are known to 1e-6 rad/s and its forces to 2e-8 of themselves; at a tolerance of 1e-9 runs have speeds to 1e-9
and forces to 1e-7, as runs of a pair have. The digits given are the bound: 1e-7 of speeds, 1e-5 of forces.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from tests.mesh.test_slow_train import MICROENGINE, back, idle, offset
from tests.reference.slow_train import SlowTrain
from tests.reference.trains import chain, compound, split

from gearidae.engine.train import solve_train
from gearidae.engine.train.build import make_train
from gearidae.engine.train.solve import follow_train
from gearidae.records import EventKind
from gearidae.scene import Scene

SPEED, FORCE = 1e-7, 1e-5
MICRO = 1e-6


def rubbing(**changed):
    """A chain whose hubs rub."""
    return chain(hubs=0.3, **changed)


def wavy():
    """A chain with a static error of its second mesh."""
    tables = chain()
    tables["meshes"]["second"]["static_error"] = [{"order": 1, "amplitude": "15 nm", "phase": 0.5}]
    return tables


def driven_by_a_pin():
    return chain(hubs=0.1, drive={"torque": 0.0, **MICROENGINE})


def adhering():
    """A compound reduction of 48:1 whose middle mesh lacks a part of its coating."""
    coating = {"sam_fraction": 1.0, "energy": "0.02 J/m^2", "thickness": 0.0}
    tables = compound(
        (0.0, 0.0, 0.0),
        contact={"bodies": "rigid", "asperity": "jkr"},
        load={"torque": 4.5e-10, "drag": 8e-15},
        coating=coating,
        initial={"gear_speed": 940.0 / 12.0, "gap": "36 nm"},
    )
    for name, phase in (("m1", 0.3), ("m2", 0.55), ("m3", 0.8)):
        tables["meshes"][name]["phase"] = phase
    tables["meshes"]["m2"]["coating"] = {"sam_fraction": 0.6}
    return tables


def stopping():
    """A chain that is driven too weakly."""
    initial = {"gear_speed": 400.0, "gap": "36 nm", "mesh_phase": 0.3}
    return rubbing(drive={"torque": 2e-12}, initial=initial)


@cache
def solved(make, end, samples, rtol=1e-9, backend="auto"):
    return solve_train(Scene.from_dict(make()), t_end=end, samples=samples, rtol=rtol, backend=backend)


T1 = (
    chain,
    150e-6,
    16,
    {
        20: (
            (4090.983133, 2030.039927, 976.550652),
            (2.818255e-7, 1.735490e-7),
            (229.920501, 228.607382),
            (2.786070e-7, 3.430413e-7, 1.575235e-7),
        ),
        50: (
            (4161.282544, 2080.366133, 1042.259530),
            (3.193079e-7, 2.174674e-7),
            (231.127936, 229.013861),
            (3.192505e-7, 4.168902e-7, 2.183324e-7),
        ),
        150: (
            (4786.762196, 2395.132833, 1200.337647),
            (3.535126e-7, 3.787776e-7),
            (230.383855, 229.944348),
            (3.538775e-7, 5.623802e-7, 3.799321e-7),
        ),
    },
)
T1S = (
    lambda: chain("0 deg"),
    150e-6,
    2,
    {
        150: (
            (4765.529339, 2387.495616, 1201.089747),
            (3.450783e-7, 3.471961e-7),
            (230.350303, 230.773842),
            (None, 6.543267e-7, None),
        )
    },
)
T1H = (
    rubbing,
    150e-6,
    4,
    {
        50: (
            (4015.933091, 2011.210885, 1015.084236),
            (3.176108e-7, 2.633059e-7),
            (231.126063, 229.306454),
            (3.182865e-7, 4.497483e-7, 2.672545e-7),
        ),
        150: (
            (4530.490142, 2264.200614, 1128.926403),
            (3.313306e-7, 3.047051e-7),
            (230.326139, 230.528842),
            (3.311131e-7, 4.863789e-7, 3.033829e-7),
        ),
    },
)
T1E = (
    wavy,
    150e-6,
    2,
    {
        150: (
            (4785.751799, 2394.601911, 1200.188786),
            (3.536242e-7, 3.791244e-7),
            (230.384521, 229.945611),
            None,
        )
    },
)
T3 = (
    split,
    150e-6,
    4,
    {
        50: (
            (4155.333055, 2075.200974, 2077.706209, 1029.232352),
            (1.804104e-7, 1.576389e-7, 1.416632e-7, 1.577624e-7),
            (230.256043, 229.149275, 228.381130, 229.487899),
            (2.099620e-7, 3.037804e-7, 1.678202e-7, 2.685931e-7),
        ),
        150: (
            (4714.637047, 2355.813410, 2358.149733, 1177.356503),
            (1.761888e-7, 1.749446e-7, 1.936455e-7, 1.944893e-7),
            None,
            (2.175723e-7, 3.524379e-7, 1.993847e-7, 3.561433e-7),
        ),
    },
)
T3B = (
    offset,
    150e-6,
    4,
    {
        50: (
            (4125.602850, 2061.807619, 2066.516208, 1031.338538),
            (2.579289e-7, 8.733144e-8, 2.530263e-7, 9.072880e-8),
            (230.799930, 228.322754, 229.243808, 228.720984),
            None,
        ),
        150: (
            (4712.996026, 2355.325528, 2361.741027, 1177.174311),
            (2.641111e-7, 8.038859e-8, 2.519601e-7, 1.047514e-7),
            None,
            (None, None, None, 3.316663e-7),
        ),
    },
)
T7 = (
    idle,
    50e-6,
    2,
    {50: ((3241.187837, 1620.649379, 940.0), (3.457531e-7, 0.0), (231.286994, -773.110329), None)},
)
T10 = (
    back,
    90e-6,
    4,
    {
        60: (
            (-1888.720378, -940.200039, -446.545279),
            (-2.419784e-7, -1.424346e-7),
            (-229.933325, -228.345510),
            (2.411119e-7, 3.737341e-7, 1.326222e-7),
        ),
        90: (
            (-2663.349420, -1329.019469, -660.018597),
            (-2.880588e-7, -2.949731e-7),
            None,
            (2.875058e-7, 5.806080e-7, 2.931022e-7),
        ),
    },
)
T9 = (
    driven_by_a_pin,
    80e-6,
    3,
    {
        40: (
            (4201.626281, 2098.808480, 1048.687568),
            (4.679560e-7, 6.440387e-7),
            None,
            (1.0282047e-5, 8.5879017e-7, 6.4374015e-7),
        ),
        80: (
            (4758.924364, 2382.076331, 1195.977886),
            (4.656451e-7, 4.516535e-7),
            None,
            (1.0333134e-5, 7.0473062e-7, 4.5371133e-7),
        ),
    },
)
ROWS = {
    "T1": T1,
    "T1s": T1S,
    "T1h": T1H,
    "T1e": T1E,
    "T3": T3,
    "T3b": T3B,
    "T7": T7,
    "T10": T10,
    "T9": T9,
}


def assert_rows(solution, rows, speed=SPEED, force=FORCE, error=2e-8):
    for time, (speeds, forces, errors, hubs) in rows.items():
        (i,) = np.flatnonzero(np.isclose(solution.time, time * MICRO, rtol=1e-12, atol=0.0))
        samples = solution.samples
        np.testing.assert_allclose(samples["shaft_speed"][:, i], speeds, rtol=speed)
        np.testing.assert_allclose(samples["mesh_force"][:, i], forces, rtol=force, atol=1e-20)
        if errors is not None:  # given to a millionth of a nanometre
            np.testing.assert_allclose(samples["transmission_error"][:, i] * 1e9, errors, rtol=error)
        if hubs is not None:
            for have, want in zip(samples["hub_load"][:, i], hubs, strict=True):
                assert want is None or have == pytest.approx(want, rel=force, abs=0.0)


@pytest.mark.parametrize("name", ROWS)
def test_motion_is_that_of_the_prototype(name):
    make, end, samples, rows = ROWS[name]
    solution = solved(make, end, samples)
    assert solution.status == "finished"
    assert_rows(solution, rows)


def test_torque_of_the_pin_is_that_of_the_prototype():
    solution = solved(*T9[:3])
    np.testing.assert_allclose(
        solution.samples["drive_torque"][1:], [1.7887295e-11, 2.0617855e-11], rtol=5e-8
    )
    np.testing.assert_allclose(solution.samples["pin_load"], 1e-5, rtol=1e-12)


def test_meshes_with_their_own_adhesion():
    """Three stages that ring hard and pull: at 1e-11 the digits given, to two of the last."""
    solution = solved(adhering, 200e-6, 5, 1e-11)
    rows = {
        50: (
            (4329.43934, 1082.36223, 344.648127, 74.533010),
            (3.345477e-7, 6.00992e-8, 7.40205e-9),
            (231.096068, 228.800881, 224.423077),
            None,
        ),
        100: (
            (3403.11608, 854.780335, 305.476291, 90.306347),
            (2.964398e-7, 6.74087e-8, 6.928111e-7),
            (229.884995, 229.335273, 232.251740),
            None,
        ),
        150: (
            (4071.03343, 1017.30976, 342.552344, 85.001003),
            (3.321695e-7, 4.31661e-8, 2.66043e-10),
            (230.357782, 228.030423, 215.422675),
            None,
        ),
        200: (
            (4733.02273, 1183.72472, 351.608128, 79.651858),
            (3.371808e-7, 7.80364e-7, 2.838951e-6),
            (231.209319, 231.809746, 233.914915),
            None,
        ),
    }
    assert_rows(solution, rows)
    np.testing.assert_allclose(
        solution.mesh_totals["largest_mesh_force"][1:], [2.963847e-5, 5.432905e-5], rtol=3e-6
    )  # with damping, of which the prototype's are without


def test_the_largest_force_of_the_first_impact_has_its_damping():
    """At 1.08 us; 3.2388e-6 N of the prototype are the contacts alone, 2.7e-4 less. Nothing has parted until then."""
    largest = solved(adhering, 200e-6, 5, 1e-11).mesh_totals["largest_mesh_force"][0]
    twin = SlowTrain(Scene.from_dict(adhering()))
    times = np.linspace(1.06e-6, 1.1e-6, 41)
    looks = twin.run(times, rtol=1e-11)
    whole = np.array([look["force"][0] for look in looks])
    contacts = whole - twin.train.meshes[0].mesh.damping * np.array(
        [twin.arms[0] @ look["speed"] for look in looks]
    )
    assert largest == pytest.approx(top(times, whole), rel=1e-8, abs=0.0)
    assert top(times, contacts) == pytest.approx(3.2388e-6, rel=3e-6, abs=0.0)


def top(times, values):
    """Largest value of a smooth function: of the parabola through the largest sample and those beside it."""
    k = int(values.argmax())
    before, at, after = values[k - 1 : k + 2]
    return at + (after - before) ** 2 / (8.0 * (2.0 * at - before - after))


def test_a_loop_with_a_residual():
    """The prototype counts the places of the closing mesh by its driver, 4.9 nm beside those by its driven gear.

    By the driven gear, as places are counted everywhere else, forces differ by up to 8.5e-3 and speeds by 8e-6.
    """
    theta = 0.9022
    scene = Scene.from_dict(split((theta, math.asin(57 * math.sin(theta) / 114))))
    scene = scene.replace({"run.duration": 50e-6, "run.samples": 2, "run.rtol": 1e-9})
    problem = make_train(scene)
    problem.model.meshes[3]["phase"] -= scene.train.meshes[3].residual
    rows = {
        50: (
            (4131.789958, 2063.889358, 2073.399151, 1030.623053),
            (2.851399e-7, 5.783867e-8, 2.741107e-7, 4.415263e-8),
            None,
            None,
        )
    }
    assert_rows(follow_train(problem, "native"), rows)


# -- events ----------------------------------------------------------------------------------------------------------


def times_of(solution, kind, **places):
    """Times of events of a kind [us]."""
    events = solution.events
    there = events["kind"] == int(kind)
    for name, value in places.items():
        there &= events[name] == value
    return events["time"][there] / MICRO


def test_events_say_which_mesh():
    solution = solved(*T1[:3])
    for mesh, times in enumerate(((27.510296, 104.773289), (57.871869, 131.785250))):
        found = times_of(solution, EventKind.MESH_EXIT, mesh=mesh, flank=0)
        np.testing.assert_allclose(found, times, rtol=2e-8)
    assert set(solution.events["shaft"]) == {-1}


@pytest.mark.parametrize(("backend", "rtol", "near"), [("native", 1e-9, 2e-8), ("sksundae", 1e-8, 1e-7)])
def test_shafts_rest_one_by_one(backend, rtol, near):
    """Each shaft turns back, is held and is let go by itself, at the prototype's times."""
    solution = solved(stopping, 110e-6, 12, rtol, backend)
    shafts = {
        0: ((86.082323, 89.045892), (92.259258, 95.152805), (92.898196,)),
        1: ((86.121095, 89.223658, 92.421873), (95.602162,), ()),
        2: ((), (86.247604,), ()),
    }
    kinds = EventKind.SLIDING_REVERSAL, EventKind.STICK, EventKind.SLIP
    for shaft, expected in shafts.items():
        for kind, times in zip(kinds, expected, strict=True):
            found = times_of(solution, kind, shaft=shaft)
            np.testing.assert_allclose(found, times, rtol=near)
    np.testing.assert_allclose(solution.samples["mesh_force"][:, -1], [5.814296e-8, 5.807540e-8], rtol=1e-6)
    np.testing.assert_array_equal(solution.samples["shaft_speed"][:, -1], 0.0)
    rests = solution.rests
    np.testing.assert_array_equal(rests["shaft"], [0, 0, 1, 2])
    np.testing.assert_allclose(rests["end"] / MICRO, [92.898196, 110.0, 110.0, 110.0], rtol=near)
    total = [(rests["end"] - rests["begin"])[rests["shaft"] == shaft].sum() for shaft in range(3)]
    np.testing.assert_allclose(solution.shaft_totals["rest_time"], total, rtol=1e-12)


# -- energies --------------------------------------------------------------------------------------------------------


def test_energies_are_those_of_the_prototype():
    solution = solved(*T1H[:3])
    energy, shafts, meshes = solution.energy, solution.shaft_totals, solution.mesh_totals
    assert energy["drive_work"] == pytest.approx(7.515919998e-12, rel=1e-9, abs=0.0)
    assert energy["load_work"] == pytest.approx(4.690351846e-12 + 1.370138714e-12, rel=1e-9, abs=0.0)
    assert energy["kinetic_change"] == pytest.approx(9.737795861e-13, rel=2e-9, abs=0.0)
    np.testing.assert_allclose(
        shafts["hub_loss"], [1.88843066e-13, 1.92256651e-13, 9.02875074e-14], rtol=5e-9
    )
    np.testing.assert_allclose(
        shafts["hub_sliding"], [6.29476886e-13, 6.40855504e-13, 3.00958358e-13], rtol=5e-9
    )
    np.testing.assert_allclose(meshes["damping_loss"], [6.52914e-15, 3.21368e-15], rtol=2e-6)
    np.testing.assert_allclose(meshes["work_in"], [7.296415776e-12, 6.975160733e-12], rtol=1e-9)
    np.testing.assert_allclose(meshes["work_out"], [7.289698684e-12, 6.971615197e-12], rtol=1e-9)
    loop = solved(*T3B[:3]).mesh_totals["work_in"]
    expected = [5.481408732e-12, 2.178355188e-12, 5.323527739e-12, 2.017962547e-12]
    np.testing.assert_allclose(loop, expected, rtol=1e-8)


@pytest.mark.parametrize("name", ROWS)
def test_balance_closes(name):
    make, end, samples, _ = ROWS[name]
    energy = solved(make, end, samples).energy
    assert abs(energy["residual"]) < energy["residual_bound"] < 1e-5 * energy["throughput"]


def test_balance_of_meshes_that_adhere_closes():
    solution = solved(adhering, 200e-6, 5, 1e-11)
    assert abs(solution.energy["residual"]) < solution.energy["residual_bound"]
    assert (solution.mesh_totals["adhesion_loss"] > 0.0).all()
    meshes = solution.mesh_totals
    lost = meshes["damping_loss"] + meshes["film_loss"] + meshes["adhesion_loss"]
    # what a mesh keeps is in its contacts, beside which the radius of curvature has done its work
    kept = meshes["work_in"] - meshes["work_out"] - lost
    expected = solution.energy["stored_change"] - solution.energy["radius_work"]
    assert kept.sum() == pytest.approx(expected, rel=1e-6, abs=0.0)


# -- steady motion and starting -------------------------------------------------------------------------------------


def test_steady_motion_and_where_its_work_goes():
    """Means over 300 us of the run, which the closed form has to 1e-4."""
    tables = rubbing(initial={"gear_speed": 1368.1, "gap": "36 nm", "mesh_phase": 0.3})
    first, whole = (solve_train(Scene.from_dict(tables), t_end=end, samples=601) for end in (300e-6, 600e-6))
    assert whole.samples["shaft_speed"][2, 300:].mean() == pytest.approx(1368.0636, rel=2e-6)
    drive = whole.energy["drive_work"] - first.energy["drive_work"]
    load = whole.energy["load_work"] - first.energy["load_work"]
    assert load / drive == pytest.approx(0.936925, rel=1e-5)
    hubs = (whole.shaft_totals["hub_loss"] - first.shaft_totals["hub_loss"]) / drive
    np.testing.assert_allclose(hubs, [0.025270, 0.025475, 0.012305], rtol=1e-3)


@pytest.mark.parametrize(
    ("torque", "speed", "pitches"),
    [(7.9e-12, 0.0, 0.0184), (8.2e-12, 119.6117, 0.857)],
    ids=["rests", "turns"],
)
def test_a_chain_starts_above_its_starting_torque(torque, speed, pitches):
    """Beside 8.0529e-12 N m, of the closed form for all three hubs and a load of 3e-11 N m."""
    initial = {"gear_speed": 0.0, "gap": "36 nm", "mesh_phase": 0.3}
    tables = chain("0 deg", hubs=0.3, drive={"torque": torque}, initial=initial)
    solution = solve_train(Scene.from_dict(tables), t_end=1e-3, samples=101, rtol=1e-9)
    assert solution.samples["shaft_speed"][2, -1] == pytest.approx(speed, rel=1e-6)
    turned = solution.samples["shaft_angle"][2, -1] * 76 / (2.0 * math.pi)
    assert turned == pytest.approx(pitches, abs=6e-4)
    assert (solution.shaft_totals["rest_time"] > 0.0).all() == (speed == 0.0)


# -- properties ------------------------------------------------------------------------------------------------------


def test_the_order_of_the_tables_does_not_matter():
    """At 1e-11, to 1e-9."""
    tables = split()
    other = {**tables, "meshes": {name: tables["meshes"][name] for name in ("three", "one", "four", "two")}}
    other["shafts"] = {name: tables["shafts"][name] for name in ("output", "lower", "upper", "input")}
    other["drive"] = tables["drive"] | {"shaft": "input"}
    other["load"] = tables["load"] | {"shaft": "output"}
    ends = []
    for one in (tables, other):
        scene = Scene.from_dict(one)
        solution = solve_train(scene, t_end=30e-6, samples=2, rtol=1e-11)
        speeds = dict(zip(solution.shafts, solution.samples["shaft_speed"][:, -1], strict=True))
        forces = dict(zip(solution.meshes, solution.samples["mesh_force"][:, -1], strict=True))
        ends.append((speeds, forces))
    for first, second in zip(*ends, strict=True):
        for name, value in first.items():
            assert second[name] == pytest.approx(value, rel=1e-9, abs=0.0)


def test_an_idler_without_mass_hands_its_force_on():
    """Of 1.5e-23 kg m^2: both forces are one, and speeds are nearly those of the pair 19:76."""
    tables = chain()
    tables["shafts"]["idler"]["inertia"] = 1.5e-23
    solution = solve_train(Scene.from_dict(tables), t_end=50e-6, samples=2, rtol=1e-9)
    first, second = solution.samples["mesh_force"][:, -1]
    assert first == pytest.approx(second, rel=1e-5, abs=0.0)
    speeds = solution.samples["shaft_speed"][[0, 2], -1]
    np.testing.assert_allclose(speeds, [4218.382, 1055.008], rtol=2.5e-7)


def test_an_offset_in_a_tree_opens_its_mesh_and_moves_no_shaft():
    tables = chain()
    tables["meshes"]["second"]["offset"] = "3 nm"
    plain, shifted = (
        solve_train(Scene.from_dict(t), t_end=1e-9, samples=2).samples for t in (chain(), tables)
    )
    for name, change in (("drive_gap", 3e-9), ("coast_gap", -3e-9), ("transmission_error", -3e-9)):
        found = shifted[name][:, 0] - plain[name][:, 0]
        np.testing.assert_allclose(found, [0.0, change], rtol=1e-9, atol=1e-20)
    np.testing.assert_allclose(shifted["shaft_angle"][:, 0], 0.0, atol=1e-18)


def test_both_drivers_give_the_same():
    """The other driver's formulas are IDA's own; at 1e-8 they agree to 4e-8 of speeds while the chain rings hardest."""
    native, portable = (solved(rubbing, 12e-6, 3, 1e-8, backend) for backend in ("native", "sksundae"))
    for name, near in (("shaft_speed", 1e-7), ("mesh_force", 1e-6), ("hub_load", 1e-6)):
        np.testing.assert_allclose(portable.samples[name], native.samples[name], rtol=near)
    np.testing.assert_allclose(portable.shaft_totals["hub_loss"], native.shaft_totals["hub_loss"], rtol=1e-6)
    assert portable.energy["drive_work"] == pytest.approx(native.energy["drive_work"], rel=1e-8, abs=0.0)
    assert abs(portable.energy["residual"]) < portable.energy["residual_bound"]
    np.testing.assert_array_equal(portable.events["kind"], native.events["kind"])
    np.testing.assert_allclose(portable.events["time"], native.events["time"], rtol=1e-6)
