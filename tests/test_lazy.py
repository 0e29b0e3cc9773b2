"""Packages whose names are loaded on first use are still packages: they can be sent to other processes by name."""

from __future__ import annotations

import subprocess
import sys

import pytest

EVERY_MODULE = """
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
import gearidae as gd

for package in (gd.analysis, gd.contact, gd.plot, import_module("gearidae.populations"), gd.studies, gd.surfaces):
    for module in iter_modules(package.__path__):
        import_module(f"{package.__name__}.{module.name}")
    hidden = [name for name in package.__all__ if isinstance(getattr(package, name), ModuleType)]
    assert package.__all__ and not hidden, (package, hidden)
"""
SENT = """
import cloudpickle, pickle
import gearidae as gd

def radius():
    return gd.preset("teodorescu2009").gears.pinion_base_radius

assert pickle.loads(cloudpickle.dumps(radius))() == radius()
"""


def test_no_module_hides_a_function_of_its_name():
    """Python sets a package's attribute when it imports a module: a public function must have another name."""
    done = subprocess.run([sys.executable, "-c", EVERY_MODULE], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_script_s_function_that_uses_it_can_be_sent():
    """As Dask and joblib send what is defined in a script or a notebook: with all that it names."""
    pytest.importorskip("cloudpickle")
    done = subprocess.run([sys.executable, "-c", SENT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
