"""Teeth whose bodies give way: the deflections as unknowns of the integration."""

import math
from itertools import islice

import numpy as np
import pytest

import gearidae as gd
from gearidae.contact import asperity_of
from gearidae.contact.elastic import ElasticFoldError, elastic_line_curve, elastic_line_force
from gearidae.engine import backend, native, portable, solve
from gearidae.engine.backend import run_blocks
from gearidae.engine.changeover import change_over
from gearidae.engine.elastic import layout as elastic
from gearidae.engine.elastic.node_rows import JOINED, row_of
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.state import PHASE, V
from gearidae.engine.motion.block_jacobian import (
    assemble,
    dense_jacobian,
    factorise,
    solve_blocks,
    store_size,
)
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.motion.residual import residual
from gearidae.engine.motion.static_solve import settle_nodes
from gearidae.engine.pairs.tooth_pairs import history_of
from gearidae.engine.setup import build_contact
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind, Statistics
from reference.random_scenes import random_scene


def roller(name, fraction=0.0, **changes):
    keys = {"contact.bodies": "elastic", "coating.sam_fraction": fraction, "run.samples": 20001}
    return gd.preset(name).replace(keys | changes)


@pytest.fixture(scope="module")
def impacts():
    cases = [(name, f) for name in ("roller_slow", "roller_fast") for f in (0.0, 1.0)]
    return {(name, f): solve(roller(name, f)).samples for name, f in cases}


@pytest.mark.parametrize(
    ("name", "fraction", "peak"),
    [
        ("roller_slow", 0.0, 16.6e-6),
        ("roller_slow", 1.0, 15.4e-6),
        ("roller_fast", 0.0, 559e-6),
        ("roller_fast", 1.0, 551e-6),
    ],
)
def test_peaks_of_figures_2_and_3(impacts, name, fraction, peak):
    assert impacts[name, fraction]["force"].max() == pytest.approx(peak, rel=0.02, abs=0)


def test_approach_and_pull_off_of_figure_2(impacts):
    assert impacts["roller_slow", 0.0]["height"].min() == pytest.approx(10.8e-9, rel=0.02, abs=0)
    assert impacts["roller_slow", 1.0]["height"].min() == pytest.approx(12.3e-9, rel=0.02, abs=0)
    assert impacts["roller_slow", 0.0]["force"].min() == pytest.approx(-1.26e-6, rel=0.02, abs=0)
    assert impacts["roller_slow", 1.0]["force"].min() > -1e-3 * 1.26e-6


def test_rigid_bodies_would_double_the_force():
    run = solve(roller("roller_fast", **{"contact.bodies": "rigid"}))
    assert run.samples["force"].max() == pytest.approx(1.1e-3, rel=0.05, abs=0)


@pytest.mark.parametrize("name", ["roller_slow", "roller_fast"])
@pytest.mark.parametrize("fraction", [0.0, 0.5])
def test_force_is_that_of_the_static_contact(name, fraction):
    """Inertia belongs to the roller alone: at every height the contact is the static one, histories and all."""
    scene = roller(name, fraction, **{"run.rtol": 1e-9})
    run = solve(scene)
    height, force = run.samples["height"], run.samples["force"]
    some = np.unique(np.linspace(0, height.size - 1, 60).astype(int))
    path = np.insert(height[some], np.searchsorted(some, height.argmin()), height.min())
    static = elastic_line_force(
        path,
        5e-6,
        2e-6,
        scene.surface,
        coated_surface=scene.coated_surface,
        sam_fraction=fraction,
        nodes=32,
    )
    keep = np.delete(static, np.searchsorted(some, height.argmin()))
    # the static curve's 32 nodes where asperities let go: 1e-5 of the largest force
    np.testing.assert_allclose(force[some], keep, rtol=0, atol=2e-5 * force.max())


def test_an_impact_loses_the_adhesion_energy():
    """0.93550 Pc dc for every asperity that has joined, counted under the deflected gap at the lowest point."""
    scene = roller("roller_slow", **{"run.rtol": 1e-9, "run.duration": 3e-5})
    run = solve(scene)
    height, speed = run.samples["height"], run.samples["speed"]
    assert height[-1] > 15 * scene.surface.roughness
    lost = 0.5 * scene.roller.mass * (speed[0] ** 2 - speed[-1] ** 2)
    curve = elastic_line_curve([height.min()], 5e-6, 2e-6, scene.surface, nodes=40)
    depth = np.interp(x := np.linspace(0, curve.x[-1], 4001), curve.x, curve.node_gap[0] - curve.x**2 / 1e-5)
    above = 0.5 * np.vectorize(math.erfc)((depth + x**2 / 1e-5) / scene.surface.roughness / math.sqrt(2))
    joined = scene.surface.asperity_density * 2e-6 * 2.0 * np.trapezoid(above, x)
    tip = asperity_of(scene.surface)
    # what lies between the nodes of the curve is interpolated: 1e-4
    assert lost == pytest.approx(0.93550 * tip.pull_off * tip.stretch_limit * joined, rel=1e-3, abs=0)


def test_nodes_have_converged(monkeypatch):
    """12 nodes: loading to 1e-7, and where asperities let go, between node and node, to 1e-5 of the largest force."""
    changes = {"run.rtol": 1e-9, "run.samples": 4001}
    coarse = solve(roller("roller_fast", **changes)).samples
    assert make_problem(roller("roller_fast")).model.scene.nodes == 12
    fine_grid = elastic.node_grid
    monkeypatch.setattr(build_contact, "node_grid", lambda *arguments: fine_grid(*arguments[:4], 40))
    fine = solve(roller("roller_fast", **changes)).samples
    assert coarse["force"].max() == pytest.approx(fine["force"].max(), rel=1e-6, abs=0)
    assert coarse["force"].min() == pytest.approx(fine["force"].min(), rel=1e-6, abs=0)
    assert coarse["speed"][-1] == pytest.approx(fine["speed"][-1], rel=1e-6, abs=0)
    closing = slice(0, int(coarse["height"].argmin()))
    loading = coarse["force"][closing] - fine["force"][closing]
    assert np.abs(loading).max() < 1e-7 * fine["force"].max()
    np.testing.assert_allclose(coarse["force"], fine["force"], rtol=0, atol=1e-5 * fine["force"].max())


@pytest.mark.parametrize(("name", "rounding"), [("roller_slow", 1e-9), ("roller_fast", 1e-10)])
def test_the_force_has_a_potential(name, rounding):
    """At a tight tolerance energies add up to what tables are good for, however few nodes there are."""
    scene = roller(name, **{"run.rtol": 1e-12, "run.samples": "off"})
    balance = solve(scene).balance
    # rounding of some thousand steps, up to 3e-10 of the slow one by the processor; coefficients of nodes as they are,
    # not symmetric, leave 1e-9 of the fast one
    assert abs(balance.residual) < rounding * balance.throughput


# -- gears ---------------------------------------------------------------------------------------------------------


def meshing(gap=1.0, phase=0.3, fraction=0.5):
    """Gears with two pairs in contact: one in the middle of the path, one held off by the tip relief."""
    scene = gd.preset("teodorescu2009").replace(
        {
            "contact.bodies": "elastic",
            "coating.sam_fraction": fraction,
            "initial.gap": gap * 6e-9,
            "initial.mesh_phase": phase,
        }
    )
    return scene, make_problem(scene)


@pytest.mark.parametrize("phase", [0.02, 0.3, 0.6])
def test_force_of_a_pair_of_teeth_is_that_of_its_radius(phase):
    """The influence coefficients follow the radius along the path of contact."""
    scene, gears = meshing(phase=phase)
    m, y = gears.model, gears.start
    geometry = scene.geometry
    total = 0.0
    inside = [(phase + k) for k in (-1, 0, 1) if 0.0 <= phase + k <= geometry.contact_ratio]
    for place in inside:
        pinion = geometry.tangent_pinion - geometry.approach + place * geometry.base_pitch
        both = geometry.tangent_pinion + geometry.tangent_gear
        radius = pinion * (both - pinion) / both
        total += elastic_line_force(
            [6e-9],
            radius,
            2e-6,
            scene.surface,
            coated_surface=scene.coated_surface,
            sam_fraction=0.5,
            nodes=32,
        )[0]
    force = mesh_forces(m, 0.0, y, False)[0] * m.scene.force_unit
    # six powers of length for the coefficients; pairs outside the path are held off by the tip relief
    assert force == pytest.approx(total, rel=5e-6, abs=0)


@pytest.fixture
def contact():
    """A state with stretched and loading nodes, away from consistency, as Newton's iteration sees it."""
    _, gears = meshing(gap=2.0, phase=0.05)
    m, y = gears.model, gears.start
    for pair in (0, -1):  # pull asperities along at some nodes
        k = history_of(m, 0, pair)
        assert m.state.history[k].pair == pair
        for material in range(2):
            row_of(m, k, JOINED + material)[:] -= np.linspace(0.01, 0.05, m.scene.points)
        m.state.history[k].direction = 1.0
    y[4:] += 1e-3 * np.sin(np.arange(y.size - 4))
    y[V] = 0.1
    return m, y


def test_influence_coefficients_are_symmetric():
    """Of weighed pressures, at all lengths of a contact: each power of the fit is."""
    _, problem = meshing()
    m = problem.model
    n, orders = int(m.scene.nodes), int(m.scene.orders)
    kappa = m.tables[int(m.scene.influence_at) :][: orders * n * n].reshape(orders, n, n)
    weights = m.tables[int(m.scene.weights_at) :][:n]
    work = weights * kappa  # kappa lies column by column
    assert orders > 1
    np.testing.assert_allclose(work, work.swapaxes(1, 2), rtol=0, atol=1e-14 * np.abs(work).max())


def test_jacobian_is_the_slope_of_the_residual(contact):
    m, y = contact
    size, cj, t = y.size, 3.0, m.state.time
    exact = np.empty((size, size))
    dense_jacobian(m, t, cj, y, np.empty(store_size(m)), exact)
    yp = np.zeros(size)
    step = 1e-6

    def slope(k):
        out = np.empty((2, size))
        for side in (0, 1):
            state, rate = y.copy(), yp.copy()
            state[k] += (1 - 2 * side) * step
            residual(m, t, state, rate, out[side])
        return (out[0] - out[1]) / (2 * step)

    by_state = np.column_stack([slope(k) for k in range(size)])
    by_rate = np.zeros((size, size))
    base = np.empty(size)
    residual(m, t, y, yp, base)
    for k in range(4):
        unit = np.zeros(size)
        unit[k] = 1.0
        residual(m, t, y, unit, by_rate[k])
        by_rate[k] -= base
    differences = by_state + cj * by_rate.T
    # the radius' own change with the phase is left out of the Jacobian on purpose
    keep = np.ones(size, bool)
    keep[PHASE] = False
    scale = np.abs(exact).max(axis=1, keepdims=True)
    # central differences over 1e-6: their rounding
    assert np.max((np.abs(differences - exact) / scale)[:, keep]) < 1e-5


def test_blocks_solve_what_the_whole_matrix_does(contact):
    m, y = contact
    store, size = np.empty(store_size(m)), y.size
    whole = np.empty((size, size))
    dense_jacobian(m, 0.0, 3.0, y, store, whole)
    assemble(m, 0.0, 3.0, y, store)
    assert factorise(store) == 0
    b = np.random.default_rng(5).normal(size=size)
    x = np.empty(size)
    solve_blocks(store, b, x)
    np.testing.assert_allclose(x, np.linalg.solve(whole, b), rtol=1e-9, atol=1e-9)


def test_settled_nodes_satisfy_their_equations():
    _, gears = meshing()
    out = np.empty(gears.start.size)
    residual(gears.model, 0.0, gears.start, np.zeros_like(gears.start), out)
    assert np.abs(out[4:]).max() < 1e-11
    assert np.abs(gears.start[4:]).max() > 0.01  # and do deflect
    assert settle_nodes(gears.model, 0.0, gears.start.copy())


def test_gears_in_light_contact_hardly_notice():
    changes = {"coating.sam_fraction": 0.5, "run.duration": 0.02, "run.samples": 501}
    scene = gd.preset("teodorescu2009_low_speed").replace(changes)
    rigid = solve(scene.replace({"contact.bodies": "rigid"}))
    elastic = solve(scene.replace({"contact.bodies": "elastic"}))
    # loads of 1e-12 N deflect teeth by 1e-8 roughnesses; forces in the tail change by ten times as much
    for name in ("gear_speed", "transmission_error"):
        swing = np.ptp(rigid.samples[name])
        np.testing.assert_allclose(elastic.samples[name], rigid.samples[name], atol=2e-3 * swing)
    turning = [np.count_nonzero(r.events.kind == EventKind.TURNING_POINT) for r in (rigid, elastic)]
    assert turning[0] == turning[1] > 3


def test_both_backends_agree():
    scene = roller("roller_slow")
    native, portable = (solve(scene, samples=301, backend=b) for b in ("native", "sksundae"))
    assert native.status == portable.status == "finished"
    np.testing.assert_array_equal(native.events.kind, portable.events.kind)
    duration = native.time[-1]
    # behind the impact the portable driver is out by 1.7e-5 of the duration at 1e-6, the native one by 1e-6
    np.testing.assert_allclose(native.events.time, portable.events.time, atol=4e-5 * duration)
    for name, values in native.samples.items():
        if name != "pairs_in_contact":
            # the error at a tolerance of 1e-6, and the portable driver's own interpolation
            np.testing.assert_allclose(portable.samples[name], values, atol=1e-3 * np.ptp(values))


# -- automatic choice ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "fraction", "needs_bodies"),
    [
        ("teodorescu2009", 1.0, False),
        ("teodorescu2009", 0.0, False),
        ("teodorescu2009_low_speed", 0.5, False),
        ("roller_slow", 0.0, True),
        ("roller_fast", 0.0, True),
    ],
)
def test_automatic_choice(name, fraction, needs_bodies):
    chosen = make_problem(gd.preset(name).replace({"coating.sam_fraction": fraction}))
    assert chosen.skipped["elastic_deflection"] == int(not needs_bodies)


def test_bound_of_the_asperity_model():
    """Where it is left, the static force is some 5 % below that of rigid bodies, as stated."""
    scene = gd.preset("teodorescu2009").replace({"coating.sam_fraction": 1.0})
    lowest = float(make_problem(scene).model.scene.lowest_gap)
    gears = make_problem(scene.replace({"contact.bodies": "elastic", "initial.gap": lowest * 6e-9}))
    deflected = gears.start[4:].max()
    assert 0.5 * elastic.RIGID_DEFLECTION < deflected < elastic.RIGID_DEFLECTION


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_run_changes_over_to_the_elastic_model(monkeypatch, backend):
    limit = elastic.rigid_limit
    monkeypatch.setattr(build_contact, "rigid_limit", lambda *a: (limit(*a)[0], True))
    auto = roller("roller_fast", **{"contact.bodies": "auto", "run.samples": 1001})
    chosen = make_problem(auto)
    blocks = list(run_blocks(chosen, 1e-6, 1001, backend, Statistics()))
    assert chosen.skipped["elastic_deflection"] == 0
    rows = np.concatenate([block.rows for block in blocks])
    samples = solve(roller("roller_fast", **{"run.samples": 1001})).samples
    # up to the change-over the rigid teeth have pushed a few per cent too hard
    assert rows.shape[0] == 1001
    assert rows[:, 2].max() == pytest.approx(samples["force"].max(), rel=1e-3, abs=0)
    assert rows[-1, 1] == pytest.approx(samples["speed"][-1], rel=5e-3, abs=0)


def test_run_resumes_from_before_and_after_the_change(monkeypatch):
    limit = elastic.rigid_limit
    monkeypatch.setattr(build_contact, "rigid_limit", lambda *a: (limit(*a)[0], True))
    auto = roller("roller_fast", **{"contact.bodies": "auto", "run.samples": 501})
    blocks = list(run_blocks(make_problem(auto), 1e-6, 501, "native", Statistics()))
    rows = np.concatenate([block.rows for block in blocks])
    (stop, last) = [k for k, block in enumerate(blocks) if block.checkpoint is not None]
    assert last == len(blocks) - 1
    rest = list(run_blocks(make_problem(auto), 1e-6, 501, "native", Statistics(), blocks[last].checkpoint))
    assert sum(len(block.rows) for block in rest) == 0  # it was over
    again = list(run_blocks(make_problem(auto), 1e-6, 501, "native", Statistics(), blocks[stop].checkpoint))
    before = sum(len(block.rows) for block in blocks[: stop + 1])
    np.testing.assert_array_equal(np.concatenate([block.rows for block in again]), rows[before:])


# -- folds -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_fold_ends_the_run_by_name(backend):
    """Half a nanometre of roughness: the static contact jumps, and the run stops where that does."""
    scene = roller("roller_slow", **{"surface.roughness": 5e-10, "roller.height": 4e-9, "run.samples": 4001})
    run = solve(scene, backend=backend)
    assert run.status == "fold"
    assert "at a gap of" in run.message
    with pytest.raises(ElasticFoldError) as caught:
        elastic_line_force([4e-9, 0.0], 5e-6, 2e-6, scene.surface)
    # the last sample before: one of 4001
    pace = np.abs(np.diff(run.samples["height"])).max()
    assert run.samples["height"][-1] == pytest.approx(caught.value.gap, abs=2 * pace)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_nodes_are_laid_out_anew_when_pressed_too_deep(monkeypatch, backend):
    solution = solve(roller("roller_fast", **{"run.samples": 1001, "run.rtol": 1e-8}))
    monkeypatch.setattr(build_contact, "deepest_gap", lambda *arguments: 2.0)
    run = solve(roller("roller_fast", **{"run.samples": 1001, "run.rtol": 1e-8}), backend=backend)
    assert run.status == "finished"
    # up to the new layout the nodes at the edge carry 1e-5 of the force
    force = solution.samples["force"]
    np.testing.assert_allclose(run.samples["force"], force, rtol=0, atol=3e-5 * force.max())


def test_a_change_of_model_begins_in_equilibrium():
    """With asperities stretched, which goes with the gaps along the contact, and these with the pressures."""
    scene = random_scene(1, 1283)
    rigid, statistics = make_problem(scene), Statistics()
    resume = [block.checkpoint for block in native.run(rigid, scene.run.rtol, 0, statistics)][-1]
    assert statistics.ending is Ending.DEFLECTION
    bodies = rigid.elastic()
    y = np.empty(bodies.start.size)
    resume = change_over(rigid, bodies, resume)
    time = bodies.restore(resume, y)
    m, out = bodies.model, np.empty(y.size)
    assert any(m.state.history[k].stretched for k in range(m.scene.histories))
    residual(m, time, y, np.zeros(y.size), out)
    assert np.abs(out[4:]).max() < 1e-11
    # and that is a start from which steps can be made
    blocks = native.run(bodies, scene.run.rtol, 0, statistics, resume)
    reached = [block.time for block in islice(blocks, 4)][-1]  # a first block has one step
    assert reached > 1.001 * time * bodies.time_unit
    blocks.close()


def test_a_start_beyond_a_fold_is_one():
    """Teeth set down at no gap whose bodies would have jumped together from some roughnesses away."""
    run = solve(random_scene(1, 468))
    assert (run.status, run.statistics.steps) == ("fold", 0)
    assert "at a gap of 0 m" in run.message


def test_a_run_whose_nodes_are_laid_out_anew_can_be_resumed_before_and_after_that(monkeypatch):
    monkeypatch.setattr(build_contact, "deepest_gap", lambda *arguments: 2.0)
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", 40)
    extend_nodes, deepened = backend.extend_nodes, []
    monkeypatch.setattr(backend, "extend_nodes", lambda *call: deepened.append(1) or extend_nodes(*call))
    scene = roller("roller_fast", **{"run.samples": 201})

    def blocks(resume=None):
        return list(run_blocks(make_problem(scene), 1e-6, 201, "sksundae", Statistics(), resume))

    whole = blocks()
    rows = np.concatenate([block.rows for block in whole])
    layouts = set()
    for k, block in enumerate(whole[:-1]):
        if block.checkpoint is not None:
            deepened.clear()
            rest = [block.rows for block in blocks(block.checkpoint)]
            layouts.add(len(deepened))  # still to come
            np.testing.assert_array_equal(np.concatenate([b.rows for b in whole[: k + 1]] + rest), rows)
    assert layouts >= {0, 1}


def test_too_deep_for_the_tables_is_named():
    run = solve(roller("roller_fast", **{"surface.roughness": 2e-9, "roller.speed": 1.0}))
    assert run.status == "too_deep"
    assert "39 roughnesses" in run.message
    assert run.samples["height"][-1] < -38.0 * 2e-9
