"""The package as others meet it: cheap to import, typed, complete."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.resources import files
from pathlib import Path

import pytest

import gearidae as gd

ROOT = Path(__file__).parents[1]

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


SKIPPED = """
[mypy]
[mypy-numpy.*,pandas.*,matplotlib.*,dask.*,scipy.*]
follow_imports = skip
follow_imports_for_stubs = True
"""
"""Libraries whose types no public signature of the script has: most of the time would go into them."""


def test_import_loads_nothing_heavy():
    heavy = ("dask", "matplotlib", "netCDF4", "numba", "pint", "pydantic", "rich", "scipy", "xarray")
    code = f"import sys, gearidae; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_types_reach_the_user(tmp_path):
    api = pytest.importorskip("mypy.api")
    script, settings = tmp_path / "user.py", tmp_path / "mypy.ini"
    script.write_text(SCRIPT)
    settings.write_text(SKIPPED)
    out, _, code = api.run(
        [
            "--strict",
            f"--config-file={settings}",
            f"--cache-dir={tmp_path}",
            "--no-error-summary",
            str(script),
        ]
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
        ("gearidae.report", "save.js"),
        ("gearidae.report", "box.js"),
        ("gearidae.report", "explorer.js"),
        ("gearidae.report", "map.js"),
        ("gearidae.report", "mesh.js"),
        ("gearidae.report", "pair.js"),
        ("gearidae.report", "player.js"),
        ("gearidae.report", "train.js"),
    ):
        assert (files(package) / name).is_file()


TWICE = """
import sys
import pytest

usual = ["-q", "-p", "no:cacheprovider"]
sys.exit(pytest.main([*usual, "--gearidae-update", "-k", "changed"]) or pytest.main(usual))
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A wheel built of this very tree."""
    builder = pytest.importorskip("hatchling.builders.wheel").WheelBuilder
    (path,) = builder(str(ROOT)).build(directory=str(tmp_path_factory.mktemp("wheel")), versions=["standard"])
    return path


@pytest.fixture(scope="module")
def built(wheel, tmp_path_factory):
    """Names of the files in a wheel and in a source distribution, both built of this very tree."""
    sdist_builder = pytest.importorskip("hatchling.builders.sdist").SdistBuilder
    folder = tmp_path_factory.mktemp("dist")
    (sdist,) = sdist_builder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    with zipfile.ZipFile(wheel) as file:
        in_wheel = set(file.namelist())
    with tarfile.open(sdist) as archive:
        in_sdist = {name.partition("/")[2] for name in archive.getnames()}
    return in_wheel, in_sdist


def shipped(folder):
    """Files below a folder that are to be shipped, by their place in the tree."""
    return {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / folder).rglob("*")
        if path.is_file()
        and not {"__pycache__", "_build", "gallery", "generated"}.intersection(path.parts)
        and not any(part.startswith(".") for part in path.relative_to(ROOT).parts)
    }


def test_wheel_has_the_whole_package_and_nothing_else(built):
    in_wheel, _ = built
    package = {name for name in in_wheel if ".dist-info/" not in name}
    assert package == {name.removeprefix("src/") for name in shipped("src")} | {
        f"gearidae/{name}" for name in shipped("cases")
    }
    assert any(name.endswith("entry_points.txt") for name in in_wheel)


def test_the_test_file_of_the_docs_runs_against_an_installed_wheel(wheel, tmp_path):
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as file:
        file.extractall(site)
    page = (ROOT / "docs" / "howto_testing.md").read_text()
    block = re.search(r"```python\n(# test_my_gears\.py\n.*?)```", page, flags=re.DOTALL)
    (tmp_path / "test_my_gears.py").write_text(block[1])
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["gearidae.testing.plugin"]\n')
    command = [sys.executable, "-P", "-c", TWICE]
    environment = {**os.environ, "PYTHONPATH": str(site)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.findall(r"\b\d passed", done.stdout) == ["1 passed", "4 passed"]
    assert (tmp_path / "gearidae_references" / "low_speed.nc").exists()


def test_source_distribution_has_what_tests_and_docs_need(built):
    _, in_sdist = built
    for folder in ("src", "tests", "docs", "cases", "examples", "benchmarks"):
        assert shipped(folder) <= in_sdist
    assert {
        "pyproject.toml",
        "README.md",
        "LICENSE",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "Makefile",
        "hatch_build.py",
    } <= in_sdist


def test_the_readme_on_a_package_index_has_no_link_into_the_tree(wheel):
    with zipfile.ZipFile(wheel) as file:
        (name,) = [name for name in file.namelist() if name.endswith(".dist-info/METADATA")]
        shown = file.read(name).decode()
    assert "Description-Content-Type: text/markdown" in shown
    assert "share of the flanks that the monolayer" in shown
    links = re.findall(r"\]\(([^)]+)\)", shown)
    assert "https://docs.xarray.dev" in links
    assert all(link.startswith("https://") for link in links)


def test_every_supported_python_is_named():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = [line.rpartition(" ")[2] for line in project["classifiers"] if ":: Python :: 3." in line]
    assert project["requires-python"] == f">={named[0]}"
    assert f"{sys.version_info.major}.{sys.version_info.minor}" in named


def test_the_lowest_versions_promised_are_those_tested():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    promised = dict(line.split(">=") for line in project["dependencies"])
    lines = (ROOT / "tests" / "lowest.txt").read_text().splitlines()
    tested = dict(line.split("==") for line in lines if "==" in line)
    assert set(tested) == set(promised)
    for name, version in promised.items():
        assert tested[name] in (version, f"{version}.0")


def test_every_public_name_can_be_had():
    for name in gd.__all__:
        assert getattr(gd, name) is not None
    assert set(gd.__all__) <= set(dir(gd))
