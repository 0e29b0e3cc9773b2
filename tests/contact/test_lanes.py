"""Polynomials side by side, and sums over eight numbers, against numpy's one by one."""

import numba
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearidae.contact.kernels.lanes import (
    add_lanes,
    eight_powers,
    product_of_lanes,
    sum_rows,
)


@numba.njit
def evaluate(table, start, u):
    return eight_powers(table, np.uintp(start), u)


TINY = 1e-300
"""Products of numbers below this lose their digits."""


@given(arrays(float, 70, elements=st.floats(-1e3, 1e3)), st.integers(0, 6), st.floats(0.0, 1.0))
def test_each_lane_is_a_polynomial_of_degree_seven(table, start, u):
    block = table[start : start + 64].reshape(8, 8)
    expected = np.polynomial.polynomial.polyval(u, block)
    np.testing.assert_allclose(
        evaluate(table, start, u), expected, rtol=0, atol=1e-12 * np.abs(block).sum() + TINY
    )


@numba.njit
def add(out, place, numbers, start, factor):
    add_lanes(out, np.uintp(place), numbers, np.uintp(start), factor)


@numba.njit
def product(left, place, right, start):
    return product_of_lanes(left, np.uintp(place), right, np.uintp(start))


@numba.njit
def rows(out, place, matrix, start, stride, factors, count):
    sum_rows(out, np.uintp(place), matrix, np.uintp(start), np.uintp(stride), factors, np.uintp(count))


numbers = arrays(float, 40, elements=st.floats(-1e3, 1e3))


@given(numbers, numbers, st.integers(0, 32), st.integers(0, 32), st.floats(-1e3, 1e3))
def test_eight_numbers_are_added_and_multiplied(left, right, place, start, factor):
    here, there = slice(place, place + 8), slice(start, start + 8)
    # the order in which eight numbers are added
    expected = left[here] @ right[there]
    np.testing.assert_allclose(product(left, place, right, start), expected, rtol=0, atol=1e-8)
    expected = left.copy()
    expected[here] += factor * right[there]
    add(left, place, right, start, factor)
    np.testing.assert_array_equal(left, expected)  # and nothing beside them is touched


@given(numbers, st.integers(0, 32), st.integers(0, 4), st.integers(8, 9), st.integers(0, 4))
def test_rows_are_summed(matrix, place, start, stride, count):
    out, factors = np.full(40, 7.0), matrix[::-1].copy()
    expected = out.copy()
    lines = [matrix[start + k * stride : start + k * stride + 8] for k in range(count)]
    count = sum(line.size == 8 for line in lines)
    expected[place : place + 8] = sum((factors[k] * lines[k] for k in range(count)), np.zeros(8))
    rows(out, place, matrix, start, stride, factors, count)
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-8)
