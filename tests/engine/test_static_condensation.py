"""Deflections solved for in each evaluation of the force: against the equations, differences and the other solver."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.elastic import newton_step as newton
from gearidae.engine.elastic.newton_step import (
    DEFLECTION_SLOPE,
    NEWTON_STEP,
    equation_space,
    influence_space,
    newton_step,
)
from gearidae.engine.elastic.node_rows import JOINED, PRESSURE, first_unknown, row_of
from gearidae.engine.elastic.nodes import influence, node_force, stiffness_matrix
from gearidae.engine.elastic.static_condensation import begin_deflections, condense_pair, predict
from gearidae.engine.model.state import U, V
from gearidae.engine.motion.pair_forces import finish_deflections, mesh_forces, set_deflections
from gearidae.engine.motion.static_solve import settle_nodes
from gearidae.engine.pairs.tooth_pairs import contact_length, history_of
from gearidae.engine.setup.build import make_problem

RTOL = 1e-6


def problem(gap=1.0, softness=1.0, opening=True):
    """Gears with two pairs in contact, some asperities stretched; bodies so many times as soft as silicon."""
    keys = {
        "contact.bodies": "elastic",
        "coating.sam_fraction": 0.5,
        "initial.gap": gap * 6e-9,
        "initial.mesh_phase": 0.05,
    }
    gears = make_problem(gd.preset("teodorescu2009").replace(keys))
    m = gears.prepare(RTOL, 0)
    powers = slice(int(m.scene.influence_at), int(m.scene.influence_at + m.scene.orders * m.scene.nodes**2))
    m.tables[powers] *= softness
    if opening:
        for pair in (0, -1):
            k = history_of(m, 0, pair)
            assert m.state.history[k].pair == pair
            for material in range(2):
                row_of(m, k, JOINED + material)[:] -= np.linspace(0.01, 0.05, m.scene.points)
            m.state.history[k].direction = 1.0
    gears.start[V] = -0.1  # the gaps open
    assert settle_nodes(m, 0.0, gears.start)
    return gears


@pytest.mark.parametrize("softness", [1.0, 200.0])
def test_deflections_satisfy_their_equations(softness):
    """Those found by Newton's method with differences for slopes; by the series, and where it does not do."""
    gears = problem(softness=softness)
    m, known = gears.model, gears.start
    assert known[4:].max() > 1e-3
    y = known.copy()
    y[4:] = 0.0
    set_deflections(m, 0.0, y, False)
    assert m.work.not_converged == 0
    # what the last step leaves is of second order in its length, sqrt(0.01 rtol), times the curvature of the pressure
    np.testing.assert_allclose(y[4:], known[4:], rtol=0, atol=10 * 0.01 * RTOL)


@pytest.mark.parametrize("softness", [1.0, 200.0])
def test_slopes_are_those_along_which_the_bodies_follow(softness):
    gears = problem(softness=softness)
    m, nudge = gears.model, 1e-4

    def force(place, moved):
        y = gears.start.copy()
        y[place] += moved
        assert settle_nodes(m, 0.0, y)
        return mesh_forces(m, 0.0, y, False)[0]

    answer = mesh_forces(m, 0.0, gears.start[:4].copy(), True)  # a state without deflections
    assert answer[0] == pytest.approx(force(U, 0.0), rel=1e-6, abs=0)
    by_u = (force(U, nudge) - force(U, -nudge)) / (2 * nudge)
    # differences: the square of the nudge over that of a roughness
    assert answer[2] == pytest.approx(by_u, rel=1e-5, abs=0)
    at_rest = mesh_forces(m, 0.0, gears.start, False)[2]
    assert abs(at_rest - by_u) > 1e-3 * abs(by_u)  # bodies that do not follow are stiffer


def length_of(m):
    """Contact length of pair 0 of the drive flank at the start."""
    return float(contact_length(m, 0.05))


def linear(m, k, y, gap):
    """Equations of a pair's nodes as full matrices, at given deflections."""
    n, length = int(m.scene.nodes), length_of(m)
    slopes, kappa = np.empty((n, n)), np.empty((n, n))
    node_force(m, k, True, 0.0, y, gap, 0.1, length)
    stiffness_matrix(m, k, slopes)
    influence(m, length, kappa)
    first = int(first_unknown(m, k))
    left = y[first : first + n] - row_of(m, k, PRESSURE) @ kappa
    product = kappa.T @ slopes
    return np.eye(n) - product, left, product.sum(axis=1)


@pytest.mark.parametrize(("softness", "mild"), [(1.0, True), (1.0, False), (200.0, False)])
def test_a_step_solves_newtons_equations(monkeypatch, softness, mild):
    gears = problem(softness=softness)
    m, y = gears.model, gears.start.copy()
    k = int(history_of(m, 0, 0))
    gap = float(m.state.history[k].gap)
    y[4:] += 1e-3 * np.sin(np.arange(y.size - 4))
    matrix, left, follow = linear(m, k, y, gap)
    assert mild or softness == 1.0 or np.abs(follow).max() > newton.MILD  # the series is not tried
    influence(m, length_of(m), influence_space(m))
    if mild:
        assert newton_step(m, k, y)
    else:
        first, second = left.copy(), follow.copy()
        assert newton_step(m, k, y)  # which leaves the loads' slopes where they are
        slopes, kappa = (equation_space(m, place) for place in (5, 7))
        pad = [
            np.concatenate([x, np.zeros(equation_space(m, NEWTON_STEP).size - x.size)])
            for x in (first, second)
        ]
        assert newton._eliminate(m, slopes, kappa, *pad)
        equation_space(m, NEWTON_STEP)[:], equation_space(m, DEFLECTION_SLOPE)[:] = pad
    n = left.size
    exact = np.linalg.solve(matrix, np.column_stack([left, follow]))
    # the series ends at 1e-7 of its sum
    for place, column in ((NEWTON_STEP, 0), (DEFLECTION_SLOPE, 1)):
        result = equation_space(m, place)[:n]
        np.testing.assert_allclose(
            result, exact[:, column], rtol=0, atol=3e-7 * np.abs(exact[:, column]).max()
        )


def test_where_the_determinant_is_not_positive_nothing_is_stable():
    """Bodies of negative stiffness, in place of an adhesion that outgrows theirs."""
    gears = problem()
    m, y = gears.model, gears.start
    k = int(history_of(m, 0, 0))
    gap, first, n = float(m.state.history[k].gap), int(first_unknown(m, k)), int(m.scene.nodes)
    matrix, _, _ = linear(m, k, y, gap)
    lowest = np.linalg.eigvals(np.eye(n) - matrix).real.min()
    assert lowest < 0.0  # asperities push: 1 - B is far from singular
    powers = slice(int(m.scene.influence_at), int(m.scene.influence_at + m.scene.orders * n * n))
    m.tables[powers] *= 1.5 / lowest
    y[first : first + n] = 0.0
    m.work.not_converged = 0
    condense_pair(m, k, True, 0.0, y, gap, 0.1, length_of(m))
    assert m.work.not_converged == 1


def test_prediction_is_of_fourth_order():
    """Ends of two steps with slopes: a cubic in time, and what the gap does besides is taken into account."""
    gears = problem()
    gears.model.scene.rtol = 1e-14  # to solve for deflections to rounding
    m, k = gears.model, int(history_of(gears.model, 0, 0))
    n, first = int(m.scene.nodes), int(first_unknown(gears.model, k))
    errors = []
    for h in (0.04, 0.02):
        m.work.settling[k]["evaluated"] = 0
        states = []
        for step in range(3):
            t = step * h
            y = gears.start.copy()
            moved = 0.3 * np.sin(1.0 + t) - 0.3 * np.sin(1.0)
            y[U] -= moved
            y[V] = -0.3 * np.cos(1.0 + t)
            gap, rate = float(m.state.history[k].gap) + moved, -y[V]
            if step == 2:
                predict(m, k, True, t, y, gap, rate)
                states.append(y[first : first + n].copy())
            set_deflections(m, t, y, False)
            states.append(y[first : first + n].copy())
            if step < 2:
                finish_deflections(m, t, y)
        errors.append(np.abs(states[2] - states[3]).max())
    assert errors[0] > 1e-10
    assert errors[1] < errors[0] / 10.0  # a sixteenth, but for higher orders


def test_a_start_knows_its_deflections():
    gears = problem()
    m, y = gears.model, gears.start.copy()
    begin_deflections(m, 0.0, gears.start)
    set_deflections(m, 0.0, y, True)
    np.testing.assert_array_equal(y, gears.start)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("teodorescu2009", {"run.duration": 3e-6, "coating.sam_fraction": 0.5}),
        ("teodorescu2009", {"run.duration": 3e-6, "coating.sam_fraction": 0.0, "mesh.radius_force": True}),
        ("roller_slow", {}),
        ("roller_fast", {"coating.sam_fraction": 1.0}),
    ],
)
def test_both_formulations_agree(name, changes):
    """Deflections as unknowns beside the motion by IDA's formulas, and eliminated by those of Adams."""
    scene = gd.preset(name).replace({"contact.bodies": "elastic", "run.samples": 301, **changes})
    exact = solve(scene.replace({"run.method": "bdf", "run.rtol": 1e-10}))
    run = solve(scene.replace({"run.rtol": 1e-8}))
    assert (exact.statistics.method, run.statistics.method) == ("bdf", "adams")
    np.testing.assert_array_equal(run.events.kind, exact.events.kind)
    for column, values in exact.samples.items():
        if column != "pairs_in_contact":
            # errors of some tens of tolerances in the states, and of some hundreds in the steep forces
            span = np.ptp(values[np.isfinite(values)])
            np.testing.assert_allclose(run.samples[column], values, rtol=0, atol=1e-5 * span, err_msg=column)


def test_elimination_needs_as_many_steps_as_rigid_bodies():
    """Teeth that hardly deflect move as rigid ones do, and so do the steps: their error counts in the same way."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.02, "run.samples": 2})
    rigid, bodies = (solve(scene.replace({"contact.model": model})) for model in ("asperity", "elastic"))
    assert bodies.statistics.steps == pytest.approx(rigid.statistics.steps, rel=0.05, abs=0)
