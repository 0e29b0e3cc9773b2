"""An archive on a system that lacks what Linux has: simulated by taking it away before anything is imported."""

from __future__ import annotations

import subprocess
import sys

import xarray as xr

import gearidae as gd

WINDOWS = ("O_DIRECTORY", "O_CLOEXEC", "sched_getaffinity", "fork")

PROGRAM = """
import os, sys, warnings

lacking, modules, path = sys.argv[1].split(","), sys.argv[2].split(","), sys.argv[3]
warnings.filterwarnings("ignore", message="only soft file lock is available")  # that is the point
for module in filter(None, modules):
    sys.modules[module] = None  # importing it is an ImportError
import tempfile, subprocess, pathlib  # of the standard library, which knows what this system has
for name in lacking:
    delattr(os, name)
if "sched_getaffinity" in lacking and hasattr(os, "process_cpu_count"):  # of Python 3.13, which calls the first
    os.process_cpu_count = os.cpu_count

import gearidae as gd
from gearidae.archive import unfinished

unfinished.CHECKPOINT_SECONDS = unfinished.CHECKPOINT_SHARE = 0.0
scene = gd.preset("roller_slow").replace({"run.samples": 101})
ds = gd.simulate(scene, archive=path, backend="sksundae")
assert ds.attrs["status"] == "finished"
"""


def test_an_archive_is_written_and_read_without_what_linux_alone_has(tmp_path):
    """Without what Windows lacks, to which belongs what macOS lacks."""
    path = tmp_path / "run.nc"
    done = subprocess.run(
        [
            sys.executable,
            "-W",
            "error::UserWarning",
            "-c",
            PROGRAM,
            ",".join(WINDOWS),
            "fcntl,resource",
            str(path),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.nc"]
    here = gd.simulate(gd.preset("roller_slow").replace({"run.samples": 101}), backend="sksundae")
    xr.testing.assert_identical(gd.open_archive(path).force, here.force)
