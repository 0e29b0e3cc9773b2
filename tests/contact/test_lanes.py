"""Polynomials side by side against numpy's one by one."""

import numba
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearidae.contact.kernels.lanes import BESIDE, eight_powers, sum_and_slope, three_slopes


@numba.njit
def evaluate(table, start, u):
    return eight_powers(table, np.uintp(start), u)


@numba.njit
def three(table, start, u):
    return three_slopes(table, np.uintp(start), u)


@numba.njit
def shared(table, start, u, shares):
    return sum_and_slope(table, np.uintp(start), u, shares)


SHARE = st.floats(0.0, 1.0)


@given(
    arrays(float, 40, elements=st.floats(-1e3, 1e3)),
    st.integers(0, 8),
    st.floats(0.0, 1.0),
    st.tuples(SHARE, SHARE, SHARE),
)
def test_three_lanes_have_slopes_and_sums(table, start, u, shares):
    """The fourth lane is padding, whatever it holds."""
    block = table[start : start + 8 * BESIDE].reshape(8, BESIDE)[:, :3]
    values = np.polynomial.polynomial.polyval(u, block)
    slopes = np.polynomial.polynomial.polyval(u, np.polynomial.polynomial.polyder(block))
    atol = 1e-12 * np.abs(block).sum()
    np.testing.assert_allclose(three(table, start, u), [*values, *slopes], rtol=0, atol=atol)
    np.testing.assert_allclose(
        shared(table, start, u, shares), [values @ shares, slopes @ shares], rtol=0, atol=atol
    )


@given(arrays(float, 70, elements=st.floats(-1e3, 1e3)), st.integers(0, 6), st.floats(0.0, 1.0))
def test_each_lane_is_a_polynomial_of_degree_seven(table, start, u):
    block = table[start : start + 64].reshape(8, 8)
    expected = np.polynomial.polynomial.polyval(u, block)
    np.testing.assert_allclose(evaluate(table, start, u), expected, rtol=0, atol=1e-12 * np.abs(block).sum())
