"""Everything that a run may need is compiled ahead of it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from gearidae.runs.compile_ahead import scenes

CODE = """
import gearidae as gd
from gearidae.compiled import is_ready
from gearidae.engine import compiling

gd.compile()
names = ["SOLVER", "ELASTIC", "EXPOSURES", "POPULATION", "FRICTION", "IMPACTS", "TRAIN"]
parts = [getattr(compiling, name) for name in names]
print(all(is_ready(part) for part in parts))
"""


def test_no_part_of_the_engine_is_left_and_a_second_process_compiles_nothing():
    """What was compiled is found on disk: a run of each scene in a new process does not say that it compiles."""
    assert len(scenes()) > 4
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
        assert done.stdout == "True\n"
        if "compiling" not in done.stderr:  # the first found everything that another process had compiled
            return
    pytest.fail(done.stderr)
