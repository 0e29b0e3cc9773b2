"""Eight polynomials side by side against numpy's one by one."""

import numba
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearidae.contact.kernels.lanes import eight_powers


@numba.njit
def evaluate(table, start, u):
    return eight_powers(table, np.uintp(start), u)


@given(arrays(float, 70, elements=st.floats(-1e3, 1e3)), st.integers(0, 6), st.floats(0.0, 1.0))
def test_each_lane_is_a_polynomial_of_degree_seven(table, start, u):
    block = table[start : start + 64].reshape(8, 8)
    expected = np.polynomial.polynomial.polyval(u, block)
    np.testing.assert_allclose(evaluate(table, start, u), expected, rtol=0, atol=1e-12 * np.abs(block).sum())
