"""Equality of results that may hold nan, which the dataclasses of Python 3.13 call different from itself."""

from __future__ import annotations

from dataclasses import asdict, is_dataclass
from typing import Any

import numpy as np


def assert_same(actual: Any, wanted: Any) -> None:
    """Compare dataclasses, or lists of them, to the last bit; nan equals nan."""
    np.testing.assert_equal(_plain(actual), _plain(wanted))


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {"": type(value).__name__, **asdict(value)}
    return [_plain(item) for item in value] if isinstance(value, (list, tuple)) else value
