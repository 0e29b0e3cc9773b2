"""Newton's correction by elimination against the residual and the dense Jacobian."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.engine.integrate.correction import correct
from gearidae.engine.model.state import LOAD, U, V, W
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.setup.build import make_problem

SMALL = st.floats(-1.0, 1.0)


def problem_of(name, damping):
    scene = gd.preset(name).replace({"coating.sam_fraction": 0.5, "contact.bodies": "rigid"})
    if scene.mesh is not None and damping:
        scene = scene.replace({"mesh.damping": 1e-9, "initial.mesh_phase": 0.02})  # a pair on its tip relief
    return make_problem(scene)


PROBLEMS = {
    (name, damping): problem_of(name, damping)
    for name in ("teodorescu2009", "teodorescu2009_low_speed", "roller_slow")
    for damping in (False, True)
}


@pytest.mark.parametrize("case", PROBLEMS, ids=str)
@pytest.mark.parametrize("at_rest", [False, True])
@given(depth=st.floats(-1.0, 7.0), moves=st.lists(SMALL, min_size=8, max_size=8), cj=st.floats(0.5, 1e4))
def test_it_solves_the_linear_equations(case, at_rest, depth, moves, cj):
    """Elimination loses a few digits where cj is not large against the slopes: bounded by the condition number."""
    problem = PROBLEMS[case]
    m, n = problem.shortened(1.0).model, problem.start.size  # a copy
    if at_rest:
        m.scene.torque[LOAD].resists, m.state.slip = 1, 0.0
    y = problem.start + 0.1 * np.array(moves[:n])
    y[U] = m.scene.clearance[0] - depth
    yp = np.array(moves[4 : 4 + n])
    delta, right, dense = np.empty(n), np.empty(n), np.empty(n * n)
    frequency = correct(m, 0.3, cj, y, yp, delta)
    residual(m, 0.3, y, yp, right)
    jacobian(m, 0.3, cj, y, dense)
    matrix = dense.reshape(n, n).T
    condition = np.linalg.cond(matrix)
    assume(condition <= 1e10)  # beyond, the dense solution is no reference
    expected = np.linalg.solve(matrix, -right)
    np.testing.assert_allclose(
        delta, expected, rtol=0, atol=100 * 2.3e-16 * condition * np.abs(expected).max()
    )
    # the frequencies of the motion are the roots of the Jacobian in cj
    masses = np.eye(n)  # dF/dy' of a motion
    masses[V, W] = 1.0
    roots = np.linalg.eigvals(np.linalg.solve(masses, cj * masses - matrix))
    assert np.abs(roots).max() ** 2 <= 1.5 * frequency + 1e-9
