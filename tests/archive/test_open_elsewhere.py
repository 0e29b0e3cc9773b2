"""A file of a study that is open in xarray is read once more: netCDF's library ends the program at some texts."""

import subprocess
import sys

import gearidae as gd

READ_TWICE = """
import sys
import xarray as xr
import gearidae as gd

first = xr.open_dataset(sys.argv[1])
second = gd.open(sys.argv[1])
print(list(second["verdict"].values))
"""


def test_a_study_that_is_open_in_xarray_is_read(tmp_path):
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": "off"})
    found = gd.studies.convergence(scene)
    path = gd.save(found, tmp_path / "convergence.nc")
    assert gd.open(path).identical(found)
    done = subprocess.run(
        [sys.executable, "-c", READ_TWICE, str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-500:]
    assert str(found["verdict"].values[0]) in done.stdout
