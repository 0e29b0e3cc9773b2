"""A roller is a gear pair whose gear is held: only the pinion moves, and it meets one flank at one place."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.drivers import ready_driver
from gearidae.engine.model.state import COAST, DRIVE, PHASE, U, V, W
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.pairs.tooth_pairs import all_pairs, contact_length, nearest_gap, pair_at, pairs_on_path
from gearidae.engine.setup.build import make_problem
from gearidae.errors import SceneError
from gearidae.records import Statistics

SLOW = gd.preset("roller_slow").replace({"contact.bodies": "rigid", "run.samples": 11})
MODELS = {
    "rigid": {},
    "elastic": {"contact.bodies": "elastic"},
    "discrete": {"contact.roughness": "discrete"},
    "attraction": {"surface.hamaker": 1e-19},
}


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("model", MODELS)
def test_the_gear_stays_where_it_is_to_the_last_bit(model, method, backend):
    problem = make_problem(SLOW.replace({"run.method": method, **MODELS[model]}))
    m, rtol = problem.model, 1e-6
    words = [block.checkpoint for block in ready_driver(backend, problem)(problem, rtol, 11, Statistics())]
    _, y = problem.restored(words[-1])
    assert y[PHASE] == y[W] == m.state.whole_pitches == 0.0
    assert m.state.flank_in_reach[COAST] == 0
    assert m.state.extremes.mesh_exits == 0
    assert y[V] < 0.0  # it has rebounded


def test_it_meets_one_flank_at_one_place():
    problem = make_problem(SLOW)
    m, y = problem.model, problem.start.copy()
    assert [pair_at(all_pairs(m, y), k) for k in range(all_pairs(m, y).total)] == [(DRIVE, 0)]
    assert nearest_gap(m, DRIVE, y) * m.scene.length_unit == SLOW.roller.height
    assert nearest_gap(m, COAST, y) == np.inf
    assert contact_length(m, 0.0) == 1.0
    for coast in (DRIVE, COAST):  # nothing changes along a path
        first, last = pairs_on_path(m, coast)
        assert last < first


def test_the_equations_of_the_gear_are_those_of_rest():
    m, y = make_problem(SLOW).model, np.array([-1.0, 0.3, 0.0, 0.0])
    rates, out, matrix = np.array([0.1, 0.2, 0.3, 0.4]), np.empty(4), np.empty(16)
    residual(m, 0.0, y, rates, out)
    assert tuple(out[[PHASE, W]]) == (0.3, 0.4)
    assert out[U] == rates[U] - y[V]
    jacobian(m, 0.0, 2.0, y, matrix)
    rows = matrix.reshape(4, 4).T[[PHASE, W]]
    np.testing.assert_array_equal(rows, [[0.0, 0.0, 2.0, -m.scene.phase_rate], [0.0, 0.0, 0.0, 2.0]])


def test_a_checkpoint_of_two_states_is_refused_in_one_message():
    """Of a version that had the height and its rate as states of a roller."""
    problem = make_problem(SLOW)
    words = problem.checkpoint(0.0, problem.start)
    assert problem.of_checkpoint(words) is problem
    words[0] += 1.0  # the layout, which knows the number of states
    with pytest.raises(SceneError, match="of another version of gearidae; run the scene again"):
        problem.of_checkpoint(words)
