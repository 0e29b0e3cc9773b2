"""No index of compiled code lies outside its array: `make test-lowest` compiles with a check of every index.

Python code sees an IndexError; those of C callbacks are ignored, but for a message on stderr.
"""

import re

import numba
import numpy as np
import pytest

from gearidae.engine import solve
from reference.small_scenes import SCENES

pytestmark = pytest.mark.skipif(
    not numba.config.BOUNDSCHECK,
    reason="compiled without a check of every index: NUMBA_BOUNDSCHECK=1 asks for it",
)
COMPILING = re.compile(r"compiling .* for this machine: once, .*|.*: \d+ functions? compiled in \d+ s")
"""What is said before and after compilation."""


@numba.njit
def _pick(numbers, k):
    return numbers[k]


def test_an_index_beyond_an_array_is_an_error_here():
    with pytest.raises(IndexError):
        _pick(np.zeros(3), 5)


@pytest.mark.parametrize("backend", ["sksundae", "native"])
@pytest.mark.parametrize("name", SCENES)
def test_no_index_is_out_of_bounds(name, backend, capfd):
    assert solve(SCENES[name], backend=backend).status == "finished"
    said = capfd.readouterr().err.splitlines()
    assert [line for line in said if not COMPILING.fullmatch(line)] == []
