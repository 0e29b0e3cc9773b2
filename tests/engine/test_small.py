"""The linear equations of a motion, solved for a fixed size."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gearidae.engine.small import factorise, solve

ENTRIES = st.floats(-1e3, 1e3)


def solution(matrix, right):
    n = right.size
    store = np.concatenate([matrix.T.ravel(), np.zeros(n)])  # column by column, then room for the pivots
    assert factorise(n, store) == 0
    x = np.empty(n)
    solve(n, store, right, x)
    return x


@pytest.mark.parametrize("n", [2, 4])
@given(data=st.data())
def test_the_solution_satisfies_the_equations(n, data):
    """Partial pivoting is backward stable: what is left over is rounding, some epsilons of the terms' size.

    Below the smallest normal number rounding is no longer relative.
    """
    matrix = data.draw(arrays(float, (n, n), elements=ENTRIES))
    matrix[np.diag_indices(n)] += np.copysign(1.0, np.diag(matrix))
    if np.linalg.cond(matrix) > 1e12:
        return
    right = data.draw(arrays(float, n, elements=ENTRIES))
    x = solution(matrix, right)
    size = np.abs(matrix).max() * np.abs(x).max() + np.abs(right).max()
    np.testing.assert_allclose(
        matrix @ x, right, rtol=0, atol=64 * n * (np.finfo(float).eps * size + np.finfo(float).tiny)
    )


def test_rows_are_exchanged_where_a_pivot_vanishes():
    matrix = np.array(
        [[0.0, 2.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 4.0], [0.0, 0.0, 8.0, 0.0]]
    )
    np.testing.assert_array_equal(solution(matrix, np.array([2.0, 1.0, 4.0, 8.0])), np.ones(4))


def test_a_singular_matrix_names_its_column():
    store = np.concatenate([np.array([[1.0, 2.0], [2.0, 4.0]]).ravel(), np.zeros(2)])
    assert factorise(2, store) == 2


def test_the_right_side_may_become_the_solution():
    x = np.array([3.0, 5.0])
    store = np.array([2.0, 1.0, 0.0, 1.0, 0.0, 0.0])
    assert factorise(2, store) == 0
    solve(2, store, x, x)
    np.testing.assert_array_equal(x, [1.5, 3.5])
