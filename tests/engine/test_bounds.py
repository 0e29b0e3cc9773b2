"""No index of compiled code lies outside its array: the engine compiled once more, with every index checked."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from reference.small_scenes import SCENES

PROGRAM = Path(__file__).parents[1] / "reference" / "small_scenes.py"
COMPILING = re.compile(r"compiling .* for this machine: once, .*|.*: \d+ functions compiled in \d+ s")
"""What is said before and after compilation."""


def run(folder, check):
    environment = os.environ | {"NUMBA_BOUNDSCHECK": check, "NUMBA_CACHE_DIR": str(folder)}
    return subprocess.run(
        [sys.executable, str(PROGRAM)], env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_no_index_is_out_of_bounds(tmp_path):
    """Python code sees an IndexError; those of C callbacks are ignored, but for a message on stderr."""
    done = run(tmp_path, "1")
    said = [line for line in done.stderr.splitlines() if not COMPILING.fullmatch(line)]
    assert said == []
    assert done.returncode == 0
    first, *lines = done.stdout.splitlines()
    assert first == "checked True"
    assert lines == [f"{name}, {backend}: finished" for name in SCENES for backend in ("sksundae", "native")]
