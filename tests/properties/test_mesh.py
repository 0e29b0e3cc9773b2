"""Symmetries of the mesh, and that its forces do the work that its gaps say."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gearidae as gd
from gearidae.engine.events.histories import begin
from gearidae.engine.laws.statistical import pair_force, set_joined
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.pairs.coverage import WHOLE
from gearidae.engine.pairs.tooth_pairs import (
    all_pairs,
    history_of,
    pair_at,
    pair_gap,
)
from gearidae.engine.setup.build import make_problem

# backlash below the range of adhesion: both flanks carry force at once
PROBLEM = make_problem(
    gd.preset("teodorescu2009").replace(
        {"mesh.backlash": 4e-8, "initial.gap": 2e-8, "coating.sam_fraction": 0.5, "mesh.damping": 1e-6}
    )
)
SMOOTH = make_problem(
    gd.preset("teodorescu2009").replace(
        {"mesh.backlash": 4e-8, "initial.gap": 2e-8, "contact.asperity": "hertz", "mesh.damping": 1e-6}
    )
)
IMPACT = make_problem(gd.preset("roller_slow").replace({"contact.bodies": "rigid"}))
PATH = float(PROBLEM.model.scene.contact_ratio)
COAST = float(PROBLEM.model.scene.coast_phase)

us = st.floats(-6.0, 6.0)
rates = st.floats(-5.0, 5.0)
phases = st.floats(-0.3, PATH + 0.3)
flanks = st.sampled_from([0, 1])


def forces(u, v, phase, w):
    """Forces of a start from there, all contacts fresh."""
    problem = PROBLEM.shortened(1.0)  # a copy
    m, y = problem.model, np.array([u, v, phase, w])
    begin(problem.addresses.base, 0.0, y)
    return np.array(mesh_forces(m, 0.0, y, False)[:2])


@given(flank=flanks, u=us, v=rates, phase=phases, w=rates, pitches=st.integers(-50, 50))
def test_a_pair_on_is_a_pitch_later(flank, u, v, phase, w, pitches):
    here = pair_gap(PROBLEM.model, flank, 0, u, v, phase, w)
    there = pair_gap(PROBLEM.model, flank, pitches, u, v, phase + pitches, w)
    # what adding up to fifty pitches rounds off, times the steepness of tip relief
    np.testing.assert_allclose(there, here, rtol=1e-10, atol=1e-10)


@given(u=us, v=rates, phase=phases, w=rates, pitches=st.integers(-20, 20))
def test_forces_repeat_every_pitch(u, v, phase, w, pitches):
    np.testing.assert_allclose(
        forces(u, v, phase + pitches, w),
        forces(u, v, phase, w),
        rtol=1e-9,
        atol=1e-9 * np.abs(forces(u, v, phase, w)).sum(),
    )


@given(u=us, v=rates, phase=phases, w=rates, pair=st.integers(-2, 2))
def test_the_coast_flank_is_the_drive_flank_in_a_mirror(u, v, phase, w, pair):
    drive = pair_gap(PROBLEM.model, 0, -pair, -u, -v, COAST - phase, -w)
    coast = pair_gap(PROBLEM.model, 1, pair, u, v, phase, w)
    np.testing.assert_allclose(coast, drive, rtol=1e-12, atol=1e-12)


@given(u=us, v=rates, phase=phases, w=rates)
def test_the_mirrored_mesh_pushes_the_other_way(u, v, phase, w):
    force, mirrored = forces(u, v, phase, w), forces(-u, -v, COAST - phase, -w)
    np.testing.assert_allclose(mirrored, -force, rtol=1e-9, atol=1e-9 * np.abs(force).max())


@given(flank=flanks, u=us, phase=phases, v=rates, w=rates, pair=st.integers(-1, 1))
def test_gap_rate_is_how_fast_the_gap_moves(flank, u, phase, v, w, pair):
    m, dt = PROBLEM.model, 1e-4
    move = m.scene.phase_rate * w * dt
    ahead, behind = (
        pair_gap(m, flank, pair, u + side * v * dt, v, phase + side * move, w)[0] for side in (1.0, -1.0)
    )
    rate = pair_gap(m, flank, pair, u, v, phase, w)[1]
    # tip relief is a parabola with a bend of d''/2 at the ends of the path, over a way of `move`
    assert (ahead - behind) / (2 * dt) == pytest.approx(
        rate, rel=1e-7, abs=1e-7 + m.scene.relief_curvature * move**2 / dt
    )


@given(flank=flanks, u=us, phase=phases, pair=st.integers(-1, 1))
def test_the_force_on_the_gear_does_virtual_work(flank, u, phase, pair):
    """dg/dphi2 at a held pinion is R2 (1 + s') on the drive flank and the opposite on the coast flank."""
    m = PROBLEM.model
    radius, sigma, pitch = m.scene.gear_radius, m.scene.length_unit, m.scene.base_pitch
    turn = 1e-10  # [rad]: some 1e-6 roughnesses
    ahead, behind = (
        pair_gap(
            m, flank, pair, u - side * radius * turn / sigma, 0.0, phase + side * radius * turn / pitch, 0.0
        )[0]
        for side in (1.0, -1.0)
    )
    slope = pair_gap(m, flank, pair, u, 0.0, phase, 0.0)[2]
    sign = -1.0 if flank else 1.0
    # rounding of the gap (up to 1e3 roughnesses) over a way of 1e-6 of them
    assert (ahead - behind) * sigma / (2 * turn * radius) == pytest.approx(
        sign * (1 + slope), rel=1e-5, abs=0
    )


@given(u=us, phase=phases)
def test_all_pairs_that_can_touch_are_looked_at(u, phase):
    m = PROBLEM.model
    reach = all_pairs(m, np.array([u, 0.0, phase, 0.0]))
    walk = [pair_at(reach, i) for i in range(reach.total)]
    for flank in (0, 1):
        seen = [pair for coast, pair in walk if coast == flank]
        assert len(seen) == len({history_of(m, flank, pair) for pair in seen}) <= m.scene.slots
        for pair in range(-12, 13):
            gap = pair_gap(m, flank, pair, u, 0.0, phase, 0.0)[0]
            assert pair in seen or gap >= m.scene.cutoff


@given(
    gap=st.floats(-4.0, 7.0),
    toward=st.floats(0.05, 3.0),
    away=st.floats(0.05, 3.0),
    span=st.floats(0.01, 0.2),
)
def test_in_a_step_that_turns_round_the_contact_has_been_at_the_turning_point(gap, toward, away, span):
    """The last accepted time lies before the turning point; the force behind it knows of it all the same."""
    turning = gap - 0.5 * toward**2 * span / (toward + away)
    there = gap + 0.5 * span * (away - toward)
    k = history_of(IMPACT.model, 0, 0)
    forces = []
    for joined, way, rate in ((20.0, -1.0, away), (turning, 1.0, away), (20.0, -1.0, -away)):
        m = IMPACT.shortened(1.0).model  # a copy
        set_joined(m, k, 0, joined)
        h = m.state.history[k]
        h.pair, h.direction, h.gap, h.gap_rate = 0, way, gap, -toward
        m.state.time = 0.0
        forces.append(pair_force(m, k, True, span, there, rate, 0.0, WHOLE)[0])
    within, after, never = forces
    # a rate that is linear in time leaves only the rounding of the turning point and the stored branch's 1e-9;
    # what is stretched takes 8e-5 and more of the force away
    size = max(map(abs, forces))
    assert within == pytest.approx(after, rel=0, abs=1e-7 * size)
    if there - turning > 0.02:
        assert within < never - 2e-5 * size


@settings(max_examples=60)
@given(u=us, v=rates, phase=phases, w=rates, cj=st.floats(0.1, 100.0))
def test_jacobian_is_the_residuals_derivative(u, v, phase, w, cj):
    """Without adhesion, whose branches part at a start; both flanks carry force."""
    problem = SMOOTH.shortened(1.0)  # a copy
    m = problem.model
    y, yp, size = np.array([u, v, phase, w]), np.zeros(4), np.zeros(4)
    begin(problem.addresses.base, 0.0, y)
    exact = np.empty(16)
    jacobian(m, 0.0, cj, y, exact)
    exact = exact.reshape(4, 4).T
    for column, step in enumerate((1e-5, 1e-5, 1e-7, 1e-5)):
        out = np.empty((2, 4))
        for row, side in zip(out, (1.0, -1.0), strict=True):
            move = side * step * (np.arange(4) == column)
            residual(m, 0.0, y + move, yp + cj * move, row)
            size = np.maximum(size, np.abs(row))
        # a central difference; the load on a pair at the path's end bends there with the tip relief, and the Jacobian
        # leaves out that the radii of curvature change along the path
        slack = 3.0 * (size + np.abs(exact[:, 0]).max()) * (column == 2)
        slack += (
            1e-4 * np.abs(exact[:, column]).max()
            + 1e-9 * size / step
            + m.scene.relief_curvature * 1e-7 * size
        )
        assert np.all(np.abs((out[0] - out[1]) / (2 * step) - exact[:, column]) < slack)
