"""Steps longer than the tip relief takes to part a pair must not pass over its adhesion."""

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.events.mesh_marks import RELIEF_PER_STEP, outruns_relief, relief_step
from gearidae.engine.model.state import PHASE, W
from gearidae.engine.pairs.tooth_pairs import pair_gap
from gearidae.engine.setup.build import make_problem

# A drive that holds its speed damps the motion within tens of milliseconds; at a mesh exit the worn gear then sticks.
HELD = gd.preset("teodorescu2009_low_speed").replace(
    {
        "coating.sam_fraction": 0.3,
        "drive.harmonic": None,
        "drive.speed": 6.0,
        "drive.speed_gain": 1e-16,
        "run.duration": 0.1,
        "run.samples": 3,
    }
)


@pytest.fixture(scope="module")
def accurate():
    return solve(HELD.replace({"run.rtol": 1e-7}))


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("rtol", [1e-3, 3e-4, 1e-4, 3e-5, 1e-5])
def test_a_pair_that_parts_in_a_smooth_motion_turns_the_gear_back(rtol, method, accurate):
    """The time of sticking moves by no more than the tolerance's share of it, and the energy balance closes."""
    scene = HELD.replace({"run.rtol": rtol, "run.method": method})
    run = solve(scene)
    assert run.extremes.stick_time == pytest.approx(accurate.extremes.stick_time, rel=rtol)
    assert_balanced(run.balance, scene)


def test_a_pair_that_parts_in_a_smooth_motion_portable():
    scene = HELD.replace({"run.rtol": 3e-5, "run.duration": 0.025})
    run = solve(scene, backend="sksundae")
    assert_balanced(run.balance, scene)


def test_the_step_allowed_opens_a_gap_by_its_share_of_the_roughness():
    problem = make_problem(HELD)
    m, y = problem.model, problem.start.copy()
    y[PHASE] = m.scene.contact_ratio  # pair 0 is about to leave
    step = relief_step(m, y)
    before, _, _, _ = pair_gap(m, 0, 0, y[0], 0.0, y[PHASE], y[W])
    after, _, _, _ = pair_gap(m, 0, 0, y[0], 0.0, y[PHASE] + m.scene.phase_rate * y[W] * step, y[W])
    np.testing.assert_allclose(after - before, RELIEF_PER_STEP, rtol=1e-9)
    assert not outruns_relief(m, y, (0.5 * step, 0.9 * step))
    assert outruns_relief(m, y, (0.5 * step, 1.1 * step))  # the present step is already longer
    assert outruns_relief(m, y, (1.1 * step, 0.0))  # and here the one before
    y[W] = 0.0
    assert not outruns_relief(m, y, (1e9, 1e9))  # nothing opens
