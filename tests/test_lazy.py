"""Packages whose names are loaded on first use are still packages: they can be sent to other processes by name."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import pytest

SENT = """
import cloudpickle, pickle
import gearidae as gd

def radius():
    return gd.preset("teodorescu2009").gears.pinion_base_radius

assert pickle.loads(cloudpickle.dumps(radius))() == radius()
"""


@pytest.mark.parametrize("name", ["analysis", "contact", "plot", "populations", "studies", "surfaces"])
def test_no_module_hides_a_function_of_its_name(name):
    """Python sets a package's attribute when it imports a module: a public function must have another name."""
    package = import_module(f"gearidae.{name}")
    assert package.__all__
    for same in {module.name for module in iter_modules(package.__path__)} & set(package.__all__):
        import_module(f"gearidae.{name}.{same}")
        assert not isinstance(getattr(package, same), ModuleType), same


def test_a_script_s_function_that_uses_it_can_be_sent():
    """As Dask and joblib send what is defined in a script or a notebook: with all that it names."""
    pytest.importorskip("cloudpickle")
    done = subprocess.run([sys.executable, "-c", SENT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
