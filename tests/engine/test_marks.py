"""Mesh entries and exits along the phase: whatever rounding does, the phase lies between the two nearest."""

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from gearidae.engine.events.mesh_marks import cross_mark, crossed_mark, set_marks
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.engine.integrate.start import rebase
from gearidae.engine.model.state import PHASE
from gearidae.engine.setup.build import make_problem
from gearidae_bench.scenes import SCENES

PROBLEM = make_problem(SCENES["high_sam"].scene)


@given(
    path=st.floats(1.01, 2.5),
    coast=st.floats(-2.0, 2.0),
    start=st.floats(-20.0, 20.0),
    way=st.sampled_from([1.0, -1.0]),
)
@example(path=2.0, coast=0.0, start=-1.1e-171, way=-1.0)  # less a mark, this is a whole number
@example(path=1.01, coast=0.0, start=2.01, way=1.0)  # on a mark; its distance from the one before is rounded
def test_a_phase_that_has_crossed_a_mark_is_on_its_far_side(path, coast, start, way):
    """By one rounding error: else the guard would stay below zero and no further mark be seen."""
    m, y, events = PROBLEM.shortened(1.0).model, PROBLEM.start.copy(), np.empty((64, EVENT_NUMBERS))
    m.scene.contact_ratio, m.scene.coast_phase, m.scene.phase_high = path, coast, 16.0
    set_marks(m, start)
    y[PHASE] = start
    assert m.state.mesh_mark_below <= start < m.state.mesh_mark_above
    for _ in range(90):
        phase = np.nextafter(m.state.mesh_mark_above if way > 0 else m.state.mesh_mark_below, way * np.inf)
        assert way * (phase - y[PHASE]) >= 0.0
        y[PHASE] = phase
        assert crossed_mark(m, y)
        assert cross_mark(m, 0.0, y, events, 0) >= 1
        rebase(m, y)
        assert m.state.mesh_mark_below < y[PHASE] < m.state.mesh_mark_above
    assert way * (y[PHASE] + m.state.whole_pitches - start) > 20.0  # four marks a pitch, at most
