"""Every contender solves the same problem: on an impact with history and on gears all agree with the reference."""

import numpy as np
import pytest

from gearidae.engine.setup.build import make_problem
from gearidae_bench import SCENES
from gearidae_bench.benchmark import all_contenders
from gearidae_bench.c_loop import c_contenders
from gearidae_bench.contender import engine_contenders, unused
from gearidae_bench.error import run_error
from gearidae_bench.loop import run_dop853, run_gauss, run_rk4
from gearidae_bench.reference import end_of, find_reference
from gearidae_bench.roots import FAILED


@pytest.fixture(scope="module", params=["roller_slow_bare", "low_sam"])
def case(request):
    """A scene of the benchmark, its problem and its sample times: an impact, and teeth that pass."""
    bench = SCENES[request.param]
    problem = make_problem(bench.scene)
    return bench, problem, np.linspace(0.0, end_of(problem), bench.scene.run.samples)


@pytest.mark.parametrize("contender", all_contenders(), ids=lambda c: c.key)
def test_contender_agrees_with_the_reference(case, contender):
    if reason := contender.unavailable():
        pytest.skip(reason)
    bench, problem, times = case
    outcome = contender.run(unused(problem), contender.ladder[5], times)
    reference = find_reference(bench)
    error = run_error(reference.speed, reference.position, outcome.speed, outcome.position, reference.length)
    # tolerances are local, per step: some hundred steps and the impact's amplification come on top. What this would
    # show is another problem solved (wrong history, samples or units), with errors of 1e-2 and more
    assert error < 1e-3
    assert outcome.steps > 0


@pytest.mark.parametrize("name", ["population_sam", "population_worn", "population_bare"])
def test_who_begins_anew_where_forces_jump_can_run_a_population(name):
    """At a tolerance of 1e-9; a dip of an asperity between two steps that is missed is an error of a third."""
    bench = SCENES[name]
    problem = make_problem(bench.scene)
    times = np.linspace(0.0, end_of(problem), bench.scene.run.samples)
    reference = find_reference(bench)
    for contender in all_contenders():
        if not contender.jumps or contender.key == "portable" or contender.unavailable():
            continue
        outcome = contender.run(unused(problem), 1e-9, times)
        error = run_error(
            reference.speed, reference.position, outcome.speed, outcome.position, reference.length
        )
        assert error < 1e-4


def test_the_c_loop_takes_the_native_steps(case):
    native, c_loop = engine_contenders()[0], c_contenders()[0]
    if reason := native.unavailable() or c_loop.unavailable():
        pytest.skip(reason)
    _, problem, times = case
    ours, theirs = (contender.run(unused(problem), 1e-6, times) for contender in (native, c_loop))
    assert (ours.steps, ours.evaluations) == (theirs.steps, theirs.evaluations)
    np.testing.assert_allclose(ours.speed, theirs.speed, rtol=1e-12)


def smooth_problem():
    """A roller whose asperities do not adhere: no stretch, hence no kinks."""
    changes = {"contact.asperity": "hertz", "run.samples": 11, "run.duration": 6e-6}
    return make_problem(SCENES["roller_slow_bare"].scene.replace(changes))


def end_state(run, *arguments):
    problem = smooth_problem()
    counts, y = np.zeros(4, np.int64), problem.start
    times = np.array([0.0, end_of(problem)])
    sums = () if run is run_gauss else (np.zeros(2),)
    run(problem.model, y, end_of(problem), times, np.zeros((2, y.size)), *arguments, counts, *sums)
    assert counts[FAILED] == 0
    return y


def test_rk4_is_of_order_four():
    exact = end_state(run_gauss, smooth_problem().tolerance_scale, 1e-13)
    errors = [np.abs(end_state(run_rk4, step) - exact).max() for step in (0.04, 0.02, 0.01)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(
        4.0, abs=0.35
    )  # the steps are not yet so small that only the leading term counts


def test_dop853_and_gauss_agree_on_a_smooth_problem():
    scale = smooth_problem().tolerance_scale
    exact = end_state(run_gauss, scale, 1e-13)
    for land in (False, True):
        other = end_state(run_dop853, 1e-12 * scale, land)
        assert np.abs(other - exact).max() < 1e-9  # a thousand times the local tolerance
