"""Where a model of this process lies: compiled functions that are called from Python or from C take its place."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array
from numba.np.numpy_support import from_dtype
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.model.state import SCENE, STATE, WORK, Model

_WORD: Final = ir.IntType(64)
_ARRAY: Any = types.Array(types.float64, 1, "C")
_RECORDS: Final = tuple(from_dtype(dtype) for dtype in (SCENE, STATE, WORK))


def _array_at(context: Any, builder: Any, data: Any, size: Any) -> Any:
    """Code of an array of numbers that lie somewhere."""
    made, stride = context.make_array(_ARRAY)(context, builder), ir.Constant(_WORD, 8)
    populate_array(made, data, [size], [stride], stride, None)  # type: ignore[no-untyped-call]
    return made._getvalue()


def _model(typing: Any, address: Any) -> Any:
    """Type and code of a model, from where `note_addresses` has written.

    Written down here because compiled functions can be given records but cannot return them.
    """
    kind: Any = types.NamedTuple((*_RECORDS, _ARRAY, _ARRAY), Model)  # type: ignore[no-untyped-call]

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        base = builder.inttoptr(values[0], _WORD.as_pointer())

        def load(index: int) -> Any:
            return builder.load(builder.gep(base, [ir.Constant(_WORD, index)]))

        def array(index: int) -> Any:
            data = builder.inttoptr(load(index), ir.DoubleType().as_pointer())
            return _array_at(context, builder, data, load(index + 1))

        records = [
            builder.inttoptr(load(k), context.get_value_type(record)) for k, record in enumerate(_RECORDS)
        ]
        return context.make_tuple(builder, signature.return_type, [*records, array(3), array(5)])

    return kind(types.int64), generate


def _address(typing: Any, record: Any) -> Any:
    """Type and code of a record's address."""

    def ask(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.ptrtoint(values[0], ir.IntType(64))

    return types.int64(record), ask


_address_of: Any = intrinsic(_address)
model_at: Any = intrinsic(_model)
"""A model of this process, from where `note_addresses` has written."""


def _numbers(typing: Any, record: Any) -> Any:
    """Type and code of the numbers of a record of real numbers only."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = builder.bitcast(values[0], ir.DoubleType().as_pointer())
        return _array_at(context, builder, data, ir.Constant(_WORD, record.size // 8))

    return _ARRAY(record), generate


numbers_of: Any = intrinsic(_numbers)
"""The numbers of a record that has real numbers only, as an array that looks at them, in compiled code."""

POINTERS: Final = 7
"""Words that locate a model in memory: addresses of its records, address and length of its arrays."""


@compiled
def note_addresses(m: Model, out: NDArray[np.int64]) -> None:
    """Write down where a model of this process lies; it must live as long as `out` is used."""
    out[0], out[1], out[2] = _address_of(m.scene), _address_of(m.state), _address_of(m.work)
    out[3], out[4] = m.tables.ctypes.data, m.tables.size
    out[5], out[6] = m.rows.ctypes.data, m.rows.size


class Addresses:
    """Where a model of this process lies; keeps it alive.

    Attributes
    ----------
    base : int
        What `model_at` takes.
    """

    def __init__(self, m: Model) -> None:
        self._model = m
        self._pointers: NDArray[np.int64] = np.zeros(POINTERS, np.int64)
        note_addresses(m, self._pointers)
        self.base = int(self._pointers.ctypes.data)
