"""Roots of the guard between the ends of a step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.engine import native
from gearidae.engine.integrate.roots import _inverse
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics
from gearidae_bench.scenes import SCENES

RTOL = 1e-6


@given(
    place=st.floats(-10.0, 10.0),
    slope=st.floats(0.1, 10.0),
    bend=st.floats(-1.0, 1.0),
    values=st.tuples(st.floats(-1.0, -0.01), st.floats(0.01, 1.0), st.floats(1.1, 2.0)),
)
def test_inverse_interpolation_is_exact_for_its_parabola(place, slope, bend, values):
    at = [place + slope * v + bend * v * v for v in values]
    root = _inverse(at[0], values[0], at[1], values[1], at[2], values[2])
    # rounding, over the least distance of two values
    assert root == pytest.approx(place, abs=1e-10)


def run(name, sharpness, monkeypatch):
    """Events and statistics of a benchmark scene, its first tenth."""
    monkeypatch.setattr(native, "SHARPNESS", sharpness)
    problem = make_problem(SCENES[name].scene)
    problem.model.scene.end *= 0.1
    statistics = Statistics()
    events = np.concatenate([block.events for block in native.run(problem, RTOL, 2, statistics)])
    return events, statistics


@pytest.mark.parametrize("name", ["low_worn", "high_sam", "high_bare"])
def test_roots_are_as_sharp_as_the_states(name, monkeypatch):
    """The same events come as with roots down to rounding, at the same times as far as the tolerance goes."""
    events, statistics = run(name, native.SHARPNESS, monkeypatch)
    sharp, _ = run(name, 0.0, monkeypatch)
    assert len(events) > 50
    # a hundredth of a step's tolerance, before two runs part as any two do that differ
    unit = make_problem(SCENES[name].scene).time_unit
    np.testing.assert_array_equal(events[:20, 1:4], sharp[:20, 1:4])
    np.testing.assert_allclose(events[:20, 0], sharp[:20, 0], rtol=0, atol=0.01 * RTOL * unit)
    assert np.any(events[:20, 0] != sharp[:20, 0])
    # two to find it, one to go on from it, one at the step's end
    assert (statistics.guard_evaluations - statistics.steps) / len(events) < 4.5
