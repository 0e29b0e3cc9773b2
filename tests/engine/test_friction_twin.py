"""Friction of the readable twin (`reference.rubbing`): against quadratic programming, numbers, and the engine."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize

from gearidae.engine.backend import solve
from gearidae.engine.observers.exposures.bins import ROWS
from gearidae.records import EventKind
from gearidae.records.energy import LOSSES
from gearidae.scene import preset
from reference.population import NUMBERS
from reference.rubbing import RubbingGears, constraint, least_constraint
from reference.rubbing_contacts import ListedAsperities, MeanLaw, jkr

HIGH = preset("teodorescu2009")
TEN = np.array(NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]).T * [[1e-6], [1e-9], [1e-9]]
LISTED = dict(zip(("arc", "height", "radius"), TEN.tolist(), strict=True))
MEAN = HIGH.replace({"contact.bodies": "rigid", "contact.asperity": "dmt", "mesh.radius_force": False})
"""Smooth forces without memory, which pull as well as push."""


def friction_loss(balance):
    """Losses by friction of flanks and hubs [J]."""
    return sum(balance[name] for name, term in LOSSES.items() if term.group == "friction")


# -- rest ------------------------------------------------------------------------------------------------------------


def elements(seed, drift):
    """Inertias, torques, rows, drifts and limits of two to four elements at rest: pairs, the gear, the pinion."""
    rng = np.random.default_rng(seed)
    pairs = rng.integers(1, 4)
    first = rng.uniform(0.1, 1.0, pairs)
    rows = np.vstack([np.column_stack([first, first - 1.8]), [[0.0, 1.0]], [[1.0, 0.0]]])
    rows = rows[: rng.integers(2, len(rows) + 1)]
    limits = rng.uniform(0.0, 1.0, len(rows)) * rng.integers(0, 2, len(rows)) + rng.uniform(0.01, 0.1)
    along = rng.normal(size=len(rows)) * drift
    return rng.uniform(0.2, 4.0, 2), rng.normal(size=2) * rng.choice([0.1, 1.0]), rows, along, limits


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.0, 0.3]))
def test_least_constraint_is_the_quadratic_programme(seed, drift):
    """The same minimum with slack variables for the moduli; the solver's tolerance is 1e-12 of an objective of 1."""
    inertia, force, rows, along, limits = elements(seed, drift)
    free, n = force / inertia, len(rows)
    a, stuck = least_constraint(inertia, force, rows, along, limits)
    optimum = minimize(
        lambda x: 0.5 * inertia @ (x[:2] - free) ** 2 + limits @ x[2:],
        np.concatenate([free, np.abs(rows @ free + along) + 0.1]),
        jac=lambda x: np.concatenate([inertia * (x[:2] - free), limits]),
        constraints=[
            {
                "type": "ineq",
                "fun": lambda x, s=s: x[2:] - s * (rows @ x[:2] + along),
                "jac": lambda x, s=s: np.hstack([-s * rows, np.eye(n)]),
            }
            for s in (-1.0, 1.0)
        ],
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 400},
    )
    least = constraint(inertia, free, rows, along, limits, a)
    assert least <= constraint(inertia, free, rows, along, limits, optimum.x[:2]) + 1e-12
    # strictly convex: the distance of two points is bounded by the difference of their values
    np.testing.assert_allclose(a, optimum.x[:2], rtol=0, atol=1e-5)
    np.testing.assert_allclose((rows @ a + along)[list(stuck)], 0.0, atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32))
def test_what_holds_both_gears_is_a_zonotope(seed):
    """No acceleration if and only if some frictions within their limits balance the torques (a linear programme)."""
    inertia, force, rows, _, limits = elements(seed, 0.0)
    across = np.column_stack([-rows[:, 1], rows[:, 0]])
    margin = (np.abs(across @ rows.T) @ limits - np.abs(across @ force)).min()
    balanced = linprog(
        np.zeros(len(rows)),
        A_eq=rows.T,
        b_eq=force,
        bounds=list(zip(-limits, limits, strict=True)),
        method="highs",
    )
    a, stuck = least_constraint(inertia, force, rows, np.zeros(len(rows)), limits)
    if abs(margin) > 1e-6:  # neither method decides on its edge
        assert (balanced.status == 0) == (margin > 0.0)
        assert (np.abs(a).max() < 1e-12 and len(stuck) == 2) == (margin > 0.0)


def test_jkr_of_the_twin():
    """Fold, pull-off, zero displacement and Hertz's limit, in closed form."""
    pull_off = -(12 ** (1 / 3)) * 0.5 ** (2 / 3) / 3.0
    cubes = jkr([-1.0 + 1e-12, pull_off, 0.0, 1e6])
    assert cubes[0] == pytest.approx(1 / 18, rel=1e-5)  # by a square root of 1e-12
    np.testing.assert_allclose(cubes[1:3], [1 / 2, 8 / 9], rtol=1e-12)
    assert cubes[3] == pytest.approx((1e6 / 12 ** (1 / 3)) ** 1.5, rel=2e-4)


# -- the engine ------------------------------------------------------------------------------------------------------


def drawn(seed):
    """Scene and hubs of a short run: friction, play, speeds, torques, damping and coverage over orders of magnitude."""
    r = np.random.default_rng(seed)
    choices = {
        "initial.gap": r.uniform(1.6e-8, 3e-8),
        "contact.friction": r.choice([0.05, 0.3, 0.8, 1.3]),
        "coating.friction": r.choice([0.1, 0.5]),
        "coating.sam_fraction": r.choice([1.0, 0.5, 0.0]),
        "mesh.backlash": r.choice([5e-8, 8e-8, 2e-7]),
        "initial.mesh_phase": r.uniform(0.0, 1.0),
        "initial.gear_speed": r.choice([0.0, 1.0, 30.0, -30.0, 2898.0]),
        "drive.torque": r.choice([-1, 1, 1]) * 10 ** r.uniform(-13, -10.5),
        "drive.harmonic.amplitude": r.choice([0.0, 1e-12, 2e-11]),
        "drive.harmonic.frequency": 10 ** r.uniform(4.0, 5.5),
        "load.torque": r.choice([0.0, 1e-13, 1e-11]),
        "mesh.damping": r.choice([0.0, 2e-6, 2e-5]),
    }
    hubs = {"hub": 0.0, "pinion_hub": 0.0, "gear_hub": 0.0}
    if r.random() < 0.4:
        hubs = {"hub": r.choice([0.1, 0.5]), "pinion_hub": r.choice([0.0, 6e-6]), "gear_hub": 2e-5}
    keys = {
        "gears.hub_friction": hubs["hub"],
        "gears.pinion_hub_radius": hubs["pinion_hub"],
        "gears.gear_hub_radius": hubs["gear_hub"],
    }
    return MEAN.replace({key: float(value) for key, value in (choices | keys).items()}), hubs


@pytest.mark.parametrize(
    ("seed", "what"),
    [
        (54, "comes to rest on three pairs of both flanks"),
        (4, "comes to rest"),
        (9, "rings"),
        (16, "the gear rests, and the pinion rings on under it"),
        (35, "rolls on a pair"),
        (41, "hubs"),
        (46, "reverses 36 times"),
        (53, "sticks from rest"),
        (73, "comes to rest on both flanks"),
    ],
)
def test_the_engine_moves_as_the_twin(seed, what):
    """10 us. Both integrate with 1e-9 or better, and errors grow up to a hundredfold."""
    scene, hubs = drawn(seed)
    times = np.linspace(2.5e-6, 1e-5, 4)
    twin = RubbingGears(scene, MeanLaw(scene), hubs)
    wanted = twin.run(times, 1e-9)
    solution = solve(scene.replace({"run.duration": 1e-5, "run.samples": 5, "run.rtol": 1e-10}))
    speed, u = (solution.samples[name][1:] for name in ("gear_speed", "transmission_error"))
    np.testing.assert_allclose(speed, wanted[3], rtol=0.0, atol=1e-12 + 1e-6 * np.abs(wanted[3]).max())
    np.testing.assert_allclose(u, wanted[0], rtol=0.0, atol=1e-6 * scene.surface.roughness)
    rests = (
        np.abs(wanted[3]) < 1e-12
    )  # a gear that is held keeps rounding errors in the twin, and none in the engine
    assert (speed == 0.0).tolist() == rests.tolist(), what
    balance = solution.balance
    # the engine adds powers up at its steps, the twin integrates them along
    assert friction_loss(balance) + balance.dry_loss == pytest.approx(wanted[4, -1], rel=1e-5, abs=0.0)
    assert balance.drive_work == pytest.approx(wanted[5, -1], rel=1e-6, abs=1e-22)


def test_listed_asperities_rub_as_in_the_twin():
    """Bare flanks with little play: each asperity that joins makes the limit jump."""
    changes = {
        "contact.friction": 0.5,
        "coating.sam_fraction": 0.0,
        "mesh.backlash": 6e-8,
        "initial.gap": 2.4e-8,
    }
    scene = HIGH.replace({"contact.roughness": "discrete", "contact.asperities": LISTED} | changes)
    twin = RubbingGears(scene, ListedAsperities(scene, TEN, 0.5, surface=scene.surface))
    wanted = twin.run([1.2e-6], 1e-10)[:, 0]
    solution = solve(scene.replace({"run.duration": 1.2e-6, "run.samples": 2, "run.rtol": 1e-11}))
    assert solution.samples["gear_speed"][-1] == pytest.approx(wanted[3], rel=1e-6)
    assert solution.samples["transmission_error"][-1] == pytest.approx(wanted[0], rel=1e-6, abs=0.0)
    balance = solution.balance
    assert friction_loss(balance) + balance.dry_loss == pytest.approx(wanted[4], rel=1e-5, abs=0.0)
    assert (solution.events.kind == EventKind.ASPERITY_ONSET).sum() == 2


def test_the_work_of_friction_is_the_coefficient_times_the_sliding_work():
    """Sliding work leaves the normal vibration out of the sliding speed, which turns round: 2e-4 of it is left."""
    scene = HIGH.replace({"contact.friction": 0.3, "contact.bodies": "rigid"})
    solution = solve(scene.replace({"run.exposures": 8, "run.duration": 3e-4, "run.samples": "off"}))
    table = np.array(solution.extremes.exposures).reshape(2, 19, ROWS.per_tooth(rubs=True), 8)
    work = 0.3 * table[:, :, ROWS.sliding].sum(axis=(1, 2))
    assert work[0] == pytest.approx(solution.balance.drive_friction_loss, rel=1e-3, abs=0.0)
    assert work[1] == solution.balance.coast_friction_loss == 0.0
