"""The force of a pair on both gears: one projection for all laws, and a residual that changes nothing."""

import numpy as np
import pytest

from gearidae.engine.model.state import PHASE, U, V, W
from gearidae.engine.motion.block_jacobian import assemble, store_size
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.pairs.pair_force import NO_MESH_FORCES, add_pair
from gearidae.engine.pairs.tooth_pairs import pair_state
from gearidae.engine.setup.build import make_problem
from gearidae.laws.pair_law import PairForce
from gearidae.scene import preset

HIGH = preset("teodorescu2009").replace({"contact.bodies": "rigid", "coating.sam_fraction": 0.5})
DAMPING = 0.3


def energy_slopes(gap, place):
    """Slopes of a made-up energy that depends on gap and place: one in each, then the second ones."""
    by_gap, by_place = -np.exp(-gap) * (1.0 + place**2), 2.0 * place * np.exp(-gap)
    return by_gap, by_place, -by_gap, -by_place, 2.0 * np.exp(-gap)


@pytest.mark.parametrize("coast", [0, 1])
@pytest.mark.parametrize("beyond", [False, True])  # the path of contact, where tip relief opens the gap
def test_slopes_of_any_law_are_those_of_its_projection(coast, beyond):
    """A law of gap, gap rate and place; central differences over 1e-5 leave some 1e-9 of the largest slope."""
    m = make_problem(HIGH).model
    number, along = 0, m.scene.contact_ratio + 0.03 if beyond else 0.4
    phase = m.scene.coast_phase - along if coast else along
    start = np.array([(m.scene.clearance[0] - 2.0) * (1 - 2 * coast), 0.3, phase, 10.0])

    def mesh(y):
        pair = pair_state(m, coast, number, y)
        place = m.scene.coast_phase + number - y[PHASE] if coast else y[PHASE] - number
        g, p, gg, gp, pp = energy_slopes(pair.gap, place)
        force = PairForce(-g - DAMPING * pair.rate, -gg, -DAMPING, -gp, 0, 0, -p, -gp, -pp, 0, 0, 0)
        return add_pair(m, NO_MESH_FORCES, pair, PairForce(*map(float, force)))

    def slope(place, step):
        there = [mesh(start + sign * step * np.eye(4)[place]) for sign in (1.0, -1.0)]
        return (np.array(there[0][:2]) - np.array(there[1][:2])) / (2.0 * step)

    ours = mesh(start)
    assert (pair_state(m, coast, number, start).slope != 0.0) == beyond
    pairs = {
        U: (ours.force_u, ours.relief_u),
        V: (ours.force_v, ours.relief_v),
        W: (ours.force_w, ours.relief_w),
    }
    largest = max(abs(value) for pair in pairs.values() for value in pair)
    for place, exact in pairs.items():
        np.testing.assert_allclose(slope(place, 1e-5), exact, rtol=0, atol=1e-8 * largest)
    exact = np.array([ours.force_phase, ours.relief_phase])
    # the rate of the gap has a slope in the phase as well, which only steers Newton's iteration and is left out
    if beyond:
        relief = pair_state(m, coast, number, start).slope
        exact -= (1 - 2 * coast) * DAMPING * start[W] * m.scene.relief_slope * np.array([1.0, relief])
    np.testing.assert_allclose(slope(PHASE, 1e-6), exact, rtol=0, atol=1e-6 * np.abs(exact).max())


MODELS = {
    "mean law": {},
    "curvature": {"mesh.radius_force": True},
    "attraction": {"surface.hamaker": 5e-20},
    "friction": {"contact.friction": 0.1, "gears.hub_friction": 0.3, "gears.pinion_hub_radius": 3e-6},
    "nodes": {"contact.bodies": "elastic"},
    "asperities": {"contact.roughness": "discrete", "initial.gap": 10e-9},
}


@pytest.mark.parametrize("name", MODELS)
def test_evaluating_the_residual_changes_no_state(name):
    """Neither at the start nor where a trial step may lead: turned round, and with pairs that have no history yet."""
    problem = make_problem(HIGH.replace({"initial.gap": 6e-9, "coating.sam_fraction": 0.0} | MODELS[name]))
    m, n = problem.model, problem.start.size
    before = m.state.tobytes()
    for move in ([0.0, 0.0, 0.0, 0.0], [0.4, 0.7, 0.1, -3.0], [-2.0, -0.7, 1.0, 3.0]):
        y, out = problem.start.copy(), np.empty(n)
        y[:4] += move
        residual(m, 0.01, y, np.zeros(n), out)
        if m.scene.nodes > 0:
            assemble(m, 0.01, 2.0, y, np.empty(store_size(m)))
        else:
            jacobian(m, 0.01, 2.0, y, np.empty(n * n))
        assert np.isfinite(out).all()
    assert m.state.tobytes() == before
