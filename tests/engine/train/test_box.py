"""The quadratic programme of what is at rest against SciPy's least squares with bounds, and against its conditions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from gearidae.engine.train.box import (
    BOX_ROWS,
    FREE_ACCELERATION,
    FRICTION,
    LEFT,
    LIMIT,
    UNIT,
    solve_box,
    solve_held,
)


def programme(seed, shafts, elements):
    """Inertias over decades, pairs of neighbouring shafts and shafts alone, torques, limits of which some are zero."""
    rng = np.random.default_rng(seed)
    inertia = 10.0 ** rng.uniform(-2.0, 2.0, shafts)
    levers = np.zeros((elements, shafts))
    for row in levers:
        a, b = rng.choice(shafts, 2, replace=False)
        if rng.uniform() < 0.6:
            row[a], row[b] = rng.uniform(0.1, 2.0), -rng.uniform(0.1, 2.0)
        else:
            row[a] = 1.0
    torque = rng.normal(size=shafts)
    limit = rng.uniform(0.0, 1.5, elements) * (rng.uniform(size=elements) < 0.85)
    return inertia, levers, torque, limit


def solved(inertia, levers, torque, limit):
    """Frictions, and accelerations of the shafts."""
    count = len(limit)
    gram, box = levers @ (levers / inertia).T, np.zeros((BOX_ROWS, count))
    box[FREE_ACCELERATION], box[LIMIT], box[UNIT] = levers @ (torque / inertia), limit, 1e-12
    assert solve_box(count, gram, np.zeros((count, count + 1)), box)
    return box, (torque - levers.T @ box[FRICTION]) / inertia


@pytest.mark.parametrize("elements", [1, 2, 4, 7, 12])
def test_accelerations_are_those_of_least_squares_with_bounds(elements):
    """Elements that outnumber the shafts have no unique frictions: the accelerations are unique."""
    for seed in range(40):
        inertia, levers, torque, limit = programme(seed, 3, elements)
        _, mine = solved(inertia, levers, torque, limit)
        root = np.sqrt(inertia)
        wide = np.maximum(limit, 1e-30)  # SciPy wants bounds apart
        # its method "bvls" ends above the least cost where elements depend on others
        twin = lsq_linear((levers / root).T, torque / root, (-wide, wide), method="trf", tol=1e-14)
        expected = (torque - levers.T @ twin.x) / inertia
        # a cost within 1e-14 of the least is one of accelerations within the root of that
        np.testing.assert_allclose(mine * root, expected * root, rtol=0.0, atol=1e-6)
        cost, least = (0.5 * float(inertia @ rates**2) for rates in (mine, expected))
        assert cost <= least + 1e-12


@pytest.mark.parametrize("elements", [2, 5, 9])
def test_what_is_within_its_limit_is_held_and_the_rest_is_slowed(elements):
    for seed in range(100, 150):
        inertia, levers, torque, limit = programme(seed, 4, elements)
        box, rates = solved(inertia, levers, torque, limit)
        relative, friction = levers @ rates, box[FRICTION]
        np.testing.assert_allclose(box[LEFT], relative, atol=1e-9)
        assert (np.abs(friction) <= limit).all()
        moving = np.abs(relative) > 1e-8
        np.testing.assert_array_equal(np.abs(friction[moving]), limit[moving])
        assert (friction[moving] * relative[moving] >= 0.0).all()


def test_equal_elements_share_what_one_alone_cannot_hold():
    """A shaft three times: its torque of 1 is held by limits of 0.4, not by those of 0.3."""
    for limit, left in ((0.4, 0.0), (0.3, 0.1)):
        _, rates = solved(np.ones(1), np.ones((3, 1)), np.ones(1), np.full(3, limit))
        assert rates[0] == pytest.approx(left, abs=1e-15)


def test_frictions_that_hold_all_have_the_rank_of_the_levers():
    for seed in range(30):
        inertia, levers, torque, limit = programme(seed, 3, 6)
        count, gram, box = len(limit), levers @ (levers / inertia).T, np.zeros((BOX_ROWS, len(limit)))
        box[FREE_ACCELERATION] = levers @ (torque / inertia)
        rank = solve_held(count, gram, np.zeros((count, count + 1)), box)
        assert rank == np.linalg.matrix_rank(levers)
        left = levers @ ((torque - levers.T @ box[FRICTION]) / inertia)
        scale = math.sqrt(float(np.max(np.diag(gram)) * (torque**2 / inertia).sum()))
        np.testing.assert_allclose(left, 0.0, atol=1e-11 * scale)
