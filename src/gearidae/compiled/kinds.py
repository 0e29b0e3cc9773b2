"""Numba's types of what functions take: short names of records' types, and signatures from annotations."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any, Final, get_args, get_origin, get_type_hints

import numpy as np

from gearidae.compiled.cache import numba

types: Any = numba.types

_KINDS: Final[dict[Any, Any]] = {
    bool: types.boolean,
    int: types.int64,
    float: types.float64,
    type(None): types.none,
}
"""Numba's type of each that an annotation may name, besides arrays and tuples."""

_named: set[Any] = set()
"""Types that have been given a name, which numba keeps for as long as somebody else does."""
_names: Final[dict[str, type]] = {}
"""What annotations may name without importing it: a law stands below the records that it is handed."""


def name_type(value: Any, name: str) -> None:
    """Give numba's type of a value a short name, and have annotations with the value's type mean it.

    The name of a tuple of records lists all fields of all of them, and is part of the symbol of every function that
    takes such a tuple: twelve thousand letters, of which nine tenths of all compiled code would consist.

    Parameters
    ----------
    value : object
        Of the type that is meant.
    name : str
        A digest of numba's own name is added: types that differ are never called the same.
    """
    kind: Any = numba.typeof(value)  # type: ignore[no-untyped-call]
    if kind not in _named:
        _named.add(kind)
        kind.name = f"{name}_{hashlib.sha256(kind.name.encode()).hexdigest()[:12]}"
    _KINDS[type(value)] = kind
    _names[type(value).__name__] = type(value)


def signature_of(function: Callable[..., Any]) -> Any:
    """Return the signature that a function's annotations say.

    They may name numbers, truth values, what `name_type` knows, tuples of these, and as arguments
    arrays: contiguous ones of real numbers in one dimension, which can be changed.

    Raises
    ------
    TypeError
        If they name anything else.
    """
    hints = get_type_hints(function, localns=_names)
    answer = hints.pop("return")
    if _is_array(answer):
        raise TypeError(f"{function.__qualname__}: what it returns must not be an array")
    return _kind(function, answer)(*(_kind(function, hint) for hint in hints.values()))


def _without_alias(annotation: Any) -> Any:
    """Return the type that an alias stands for: `NDArray` is a class of numpy's up to 2.4, and an alias from 2.5 on."""
    alias = get_origin(annotation) or annotation
    if not hasattr(alias, "__value__"):
        return annotation
    arguments = get_args(annotation)
    return _without_alias(alias.__value__[arguments] if arguments else alias.__value__)


def _is_array(annotation: Any) -> bool:
    annotation = _without_alias(annotation)
    origin, inside = get_origin(annotation), get_args(annotation)
    return origin is np.ndarray or (origin is tuple and any(map(_is_array, inside)))


def _kind(function: Callable[..., Any], annotation: Any) -> Any:
    annotation = _without_alias(annotation)
    if annotation in _KINDS:
        return _KINDS[annotation]
    if get_origin(annotation) is np.ndarray:
        return types.float64[::1]
    if get_origin(annotation) is tuple:
        return types.Tuple([_kind(function, part) for part in get_args(annotation)])
    raise TypeError(f"{function.__qualname__}: {annotation} in its annotations has no type of numba's")
