"""The fixture that keeps a reference archive, in a test run of its own."""

from __future__ import annotations

import subprocess
import sys

TEST = """
import gearidae as gd

SPEED = 1.5

def test_run(gearidae_reference):
    scene = gd.preset("teodorescu2009_low_speed").replace({"initial.gear_speed": SPEED, "run.samples": 11})
    gearidae_reference(gd.simulate(scene, t_end=2e-3), "start", rtol=1e-6)
"""


def pytest_in(folder, *options):
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "gearidae.testing.plugin",
        "-p",
        "no:cacheprovider",
        *options,
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_a_reference_is_asked_for_made_and_compared_with(tmp_path):
    file = tmp_path / "test_mine.py"
    file.write_text(TEST)
    code, out = pytest_in(tmp_path)
    assert code == 1
    assert "make it with pytest --gearidae-update" in out
    code, out = pytest_in(tmp_path, "--gearidae-update")
    assert code == 0, out
    assert (tmp_path / "gearidae_references" / "start.nc").exists()
    code, out = pytest_in(tmp_path)
    assert code == 0, out
    file.write_text(TEST.replace("1.5", "1.6"))
    code, out = pytest_in(tmp_path)
    assert code == 1
    assert "their scenes differ in initial.gear_speed" in out
