"""The package as others meet it: cheap to import, typed, complete."""

from __future__ import annotations

import subprocess
import sys
from importlib.resources import files

import pytest

import gearidae as gd

SCRIPT = """
from pathlib import Path

import gearidae as gd
import xarray as xr


def slowest(scene: gd.Scene, fractions: list[float], folder: Path) -> float:
    ds: xr.Dataset = gd.sweep(scene, {"coating.sam_fraction": fractions}, archive=folder / "x.nc")
    return float(ds["gear_speed"].min())


def attempt(path: str) -> str:
    scene = gd.load_case(path).replace({"coating.sam_fraction": 0.5})
    try:
        reveal_type(gd.simulate(scene, t_end=1e-3))
    except gd.SceneError as error:
        return error.key
    except gd.SolverError as error:
        return f"{error.time}"
    return scene.name


slowest("not a scene", [1.0], Path())
"""


def test_import_loads_nothing_heavy():
    heavy = ("dask", "matplotlib", "netCDF4", "numba", "pint", "pydantic", "rich", "scipy", "xarray")
    code = f"import sys, gearidae; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_types_reach_the_user(tmp_path):
    api = pytest.importorskip("mypy.api")
    script = tmp_path / "user.py"
    script.write_text(SCRIPT)
    out, _, code = api.run(
        ["--strict", "--config-file=", f"--cache-dir={tmp_path}", "--no-error-summary", str(script)]
    )
    # One wrong call, found; one revealed type, the right one; and nothing else to complain about.
    complaints = [line for line in out.splitlines() if ": note:" not in line]
    assert code == 1
    assert len(complaints) == 1
    assert 'expected "Scene"' in complaints[0]
    assert "Revealed type is" in out
    assert "xarray.core.dataset.Dataset" in out


def test_what_the_report_needs_is_in_the_package():
    for package, name in (
        ("gearidae", "py.typed"),
        ("gearidae.report", "page.css"),
        ("gearidae.report", "viewer.js"),
    ):
        assert (files(package) / name).is_file()


def test_every_public_name_can_be_had():
    for name in gd.__all__:
        assert getattr(gd, name) is not None
    assert set(gd.__all__) <= set(dir(gd))
