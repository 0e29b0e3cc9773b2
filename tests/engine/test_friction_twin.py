"""Friction of the readable twin (`reference.rubbing`): against quadratic programming, numbers, and the engine."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize

from gearidae.scene import preset
from reference.population import NUMBERS
from reference.rubbing import ListedAsperities, RubbingGears, constraint, jkr, least_constraint

HIGH = preset("teodorescu2009")
TEN = np.array(NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]).T * [[1e-6], [1e-9], [1e-9]]


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
    found = minimize(
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
    assert least <= constraint(inertia, free, rows, along, limits, found.x[:2]) + 1e-12
    # strictly convex: the distance of two points is bounded by the difference of their values
    np.testing.assert_allclose(a, found.x[:2], rtol=0, atol=1e-5)
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


def test_the_twin_gives_the_numbers_of_a_separate_program():
    """Ten listed asperities, coefficient 0.3; the other program is good to 1e-6 rad/s.

    Its first of five numbers: the twin gave 2978.889511, 2998.071011 and 3062.433161 rad/s at 8, 16 and 20 us, too,
    as that program, with 1e-12 in 13 s.
    """
    law = ListedAsperities(HIGH, TEN, 0.3, surface=HIGH.coated_surface)
    twin = RubbingGears(HIGH, law)
    assert twin.run([4e-6], 1e-12)[3, 0] == pytest.approx(2865.448535, abs=2e-6)
