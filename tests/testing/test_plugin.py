"""The fixture that keeps a reference archive, in a test run of its own."""

from __future__ import annotations

import re
import subprocess
import sys

TEST = """
from pathlib import Path
import gearidae as gd

def test_run(gearidae_reference):
    speed = float(Path("speed.txt").read_text())
    scene = gd.preset("teodorescu2009_low_speed").replace({"initial.gear_speed": speed, "run.samples": 11})
    gearidae_reference(gd.simulate(scene, t_end=2e-3), "start", rtol=1e-6)
"""


RUNS = """
from pathlib import Path
import pytest

for speed, options in ((1.5, []), (1.5, ["--gearidae-update"]), (1.5, []), (1.6, [])):
    Path("speed.txt").write_text(str(speed))
    print("run of tests", flush=True)
    code = pytest.main(["-q", "-p", "gearidae.testing.plugin", "-p", "no:cacheprovider", *options])
    print("exit code", int(code), "archive", Path("gearidae_references/start.nc").exists(), flush=True)
"""
"""One process for all runs: most of the time goes into imports."""


def test_a_reference_is_asked_for_made_and_compared_with(tmp_path):
    (tmp_path / "test_mine.py").write_text(TEST)
    done = subprocess.run(
        [sys.executable, "-c", RUNS], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    first, update, same, other = done.stdout.split("run of tests\n")[1:]
    ends = [
        re.search(r"^exit code (\d) archive (\w+)$", out, re.MULTILINE)
        for out in (first, update, same, other)
    ]
    assert [end.groups() for end in ends] == [("1", "False"), ("0", "True"), ("0", "True"), ("1", "True")]
    assert "make it with pytest --gearidae-update" in first
    assert "their scenes differ in initial.gear_speed" in other
