"""Operations on short vectors, called as SUNDIALS calls them."""

import ctypes

import numpy as np
import pytest

from gearidae.engine.sundials import names as sundials

if reason := sundials.unavailable():
    pytest.skip(reason, allow_module_level=True)

from gearidae.engine.sundials.vectors import vector_operations

REAL, WORD = ctypes.c_double, ctypes.c_int64


@pytest.fixture
def vectors():
    """Make vectors of SUNDIALS over arrays."""
    context, made = WORD(), []
    sundials._call("SUNContext_Create", ctypes.c_int(0), ctypes.byref(context))

    def make(numbers):
        length, address = ctypes.c_int32(numbers.size), WORD(numbers.ctypes.data)
        made.append(sundials._call("N_VMake_Serial", length, address, context))
        return made[-1]

    yield make
    for vector in made:
        sundials._call("N_VDestroy", WORD(vector))
    sundials._call("SUNContext_Free", ctypes.byref(context))


def operation(n, name, result, *arguments):
    k = sundials.OF_VECTORS.index(name)
    return ctypes.CFUNCTYPE(result, *arguments)(vector_operations(n)[k].address)


@pytest.fixture(params=[2, 4])
def numbers(request):
    """Five vectors."""
    return np.random.default_rng(request.param).normal(size=(5, request.param))


def test_the_norm(numbers, vectors):
    norm = operation(numbers.shape[1], "N_VWrmsNorm_Serial", REAL, WORD, WORD)
    x, w = numbers[:2]
    # a few roundings
    assert norm(vectors(x), vectors(w)) == pytest.approx(np.sqrt(np.mean((x * w) ** 2)), rel=1e-15, abs=0)


def test_a_sum_of_two(numbers, vectors):
    add = operation(numbers.shape[1], "N_VLinearSum_Serial", None, REAL, WORD, REAL, WORD, WORD)
    x, y, z = numbers[:3]
    wanted = 0.3 * x - 1.7 * y
    add(0.3, vectors(x), -1.7, vectors(y), vectors(z))
    np.testing.assert_allclose(z, wanted, rtol=1e-14, atol=1e-15)
    wanted = x + y
    add(1.0, vectors(x), 1.0, vectors(y), vectors(y))  # in place
    np.testing.assert_array_equal(y, wanted)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_sum_of_many(count, numbers, vectors):
    combine = operation(
        numbers.shape[1], "N_VLinearCombination_Serial", ctypes.c_int, ctypes.c_int, WORD, WORD, WORD
    )
    factors = np.array([0.5, -2.0, 3.0, 0.1])
    wanted = factors[:count] @ numbers[:count]
    several = np.array([vectors(x) for x in numbers[:count]])
    assert combine(count, factors.ctypes.data, several.ctypes.data, vectors(numbers[4])) == 0
    np.testing.assert_allclose(numbers[4], wanted, rtol=1e-14, atol=1e-15)


def test_many_sums_of_two(numbers, vectors):
    add = operation(
        numbers.shape[1],
        "N_VLinearSumVectorArray_Serial",
        ctypes.c_int,
        ctypes.c_int,
        REAL,
        WORD,
        REAL,
        WORD,
        WORD,
    )
    wanted = numbers[:2] + numbers[2:4]
    first = np.array([vectors(x) for x in numbers[:2]])
    second = np.array([vectors(x) for x in numbers[2:4]])
    # in place, as IDA does
    assert add(2, 1.0, first.ctypes.data, 1.0, second.ctypes.data, first.ctypes.data) == 0
    np.testing.assert_array_equal(numbers[:2], wanted)


def test_an_unknown_layout_is_refused(monkeypatch):
    monkeypatch.setattr(sundials, "OF_VECTORS", ("N_VDestroy",))
    sundials.vector_places.cache_clear()
    try:
        with pytest.raises(RuntimeError, match="vectors in an unknown way"):
            sundials.vector_places()
    finally:
        sundials.vector_places.cache_clear()
