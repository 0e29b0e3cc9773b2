"""Mesh entries and exits along the phase: whatever rounding does, the phase lies between the two nearest."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gearidae.engine.events.events import _cross_mark, _set_marks
from gearidae.engine.integrate.start import rebase
from gearidae.engine.model import layout as at
from gearidae.engine.model.problem import make_problem
from gearidae_bench.scenes import SCENES

PROBLEM = make_problem(SCENES["high_sam"].scene)


@given(
    path=st.floats(1.01, 2.5),
    coast=st.floats(-2.0, 2.0),
    start=st.floats(-20.0, 20.0),
    way=st.sampled_from([1.0, -1.0]),
)
def test_a_phase_that_has_crossed_a_mark_is_on_its_far_side(path, coast, start, way):
    """By one rounding error: else the guard would stay below zero and no further mark be seen."""
    d, y, events = PROBLEM.data.copy(), PROBLEM.start.copy(), np.empty((64, 5))
    d[at.PATH], d[at.COAST_PHASE] = path, coast
    _set_marks(d, start)
    y[at.PHASE] = start
    for _ in range(90):
        phase = np.nextafter(d[at.MARK_HIGH] if way > 0 else d[at.MARK_LOW], way * np.inf)
        assert way * (phase - y[at.PHASE]) >= 0.0
        y[at.PHASE] = phase
        assert _cross_mark(d, 0.0, y, way > 0, events, 0) >= 1
        rebase(d, y)
        assert d[at.MARK_LOW] < y[at.PHASE] < d[at.MARK_HIGH]
    assert way * (y[at.PHASE] + d[at.TURNS] - start) > 20.0  # four marks a pitch, at most
