"""IDA's state within a step, from what it exports everywhere and from what it keeps to itself on some systems."""

from __future__ import annotations

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import native
from gearidae.engine.callbacks import callbacks
from gearidae.engine.integrate.driver import CONVERGENCE_FAILURES_HIGH
from gearidae.engine.setup.build import make_problem
from gearidae.engine.step import advance
from gearidae.engine.sundials import interpolation
from gearidae.engine.sundials import names as sun
from gearidae.engine.sundials.ida_memory import IDA, YP, FunctionOffsets, Y, close_solver, open_solver

SHARES = (0.0, 0.1, 0.5, 0.9, 1.0)
STEPS = 40


@pytest.fixture
def stepped():
    """A run of the fast gears with IDA's own formulas, and the beginning of its last step."""
    problem = make_problem(gd.preset("teodorescu2009"))
    s = native.make_arrays(problem, problem.prepare(1e-6, 0), True)
    places = FunctionOffsets(sun.linear_solver_offsets(), sun.newton_offsets())
    functions, place = callbacks(s.y.size, False, True), problem.addresses.base
    out = native.Output.empty(len(problem.columns))
    try:
        vectors = (s.y, s.yp, s.dky)
        assert open_solver(s.handles, place, functions, places, vectors, CONVERGENCE_FAILURES_HIGH) == 0
        advance(place, s, out, STEPS)
        begin = float(s.clock[0])
        advance(place, s, out, 1)
        yield s, begin
    finally:
        close_solver(s.handles)


@pytest.mark.parametrize("share", SHARES)
def test_both_ways_give_the_same_state_and_rates(share, stepped):
    """One polynomial evaluated in two orders: sums of a few terms, which differ by their rounding alone."""
    s, begin = stepped
    end = float(s.clock[0])
    assert end > begin
    assert sun.exports("IDAGetSolution")  # or there would be nothing to compare
    states = []
    for way in (interpolation.solution_as_ida, interpolation.solution_as_documented):
        s.y[:] = s.yp[:] = np.nan
        assert way(s.handles[IDA], begin + share * (end - begin), s.handles[Y], s.handles[YP]) == 0
        states.append((s.y.copy(), s.yp.copy()))
    for ida, documented in zip(*states, strict=True):
        np.testing.assert_allclose(documented, ida, rtol=0.0, atol=1e-12 * abs(ida).max())


def test_a_time_before_the_last_step_is_refused(stepped):
    """By the documented function; the other one trusts its caller."""
    s, begin = stepped
    assert interpolation.solution_as_documented(s.handles[IDA], begin - 1e3, s.handles[Y], s.handles[YP]) != 0


def test_a_function_that_is_not_exported_is_known_to_be_missing():
    assert not sun.exports("IDAGetNothing")
