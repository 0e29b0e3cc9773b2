"""Packages whose names are loaded on first use are still packages: they can be sent to other processes by name."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

import pytest

import gearidae as gd
from gearidae import studies

SENT = """
import cloudpickle, pickle
import gearidae as gd

def radius():
    return gd.preset("teodorescu2009").gears.pinion_base_radius

assert pickle.loads(cloudpickle.dumps(radius))() == radius()
"""


@pytest.mark.parametrize("package", [gd, studies, gd.plot], ids=lambda package: package.__name__)
def test_a_package_goes_by_its_name(package):
    assert pickle.loads(pickle.dumps(package)) is package
    assert copy.deepcopy(package) is package


def test_a_script_s_function_that_uses_it_can_be_sent():
    """As Dask and joblib send what is defined in a script or a notebook: with all that it names."""
    pytest.importorskip("cloudpickle")
    done = subprocess.run([sys.executable, "-c", SENT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
