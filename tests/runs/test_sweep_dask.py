"""Sweeps on a Dask cluster: a real one, of two processes on this machine."""

from __future__ import annotations

import sys

import pytest
import xarray as xr
from tests.reference.trains import chain

import gearidae as gd
from gearidae.cli import main
from gearidae.runs import batch
from gearidae.runs.executors import dask_executor
from gearidae.runs.run_result import solve_group
from gearidae.scene import Scene
from sweeps import without_times

distributed = pytest.importorskip("distributed")

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 101})
KEY = "coating.sam_fraction"
FRACTIONS = [1.0, 0.5, 0.47, 0.45]


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
    ) as running:
        yield running


@pytest.fixture(scope="module")
def expected():
    return without_times(gd.sweep(LOW, {KEY: FRACTIONS}, jobs=1))


def test_a_cluster_changes_nothing(cluster, expected):
    with distributed.Client(cluster, set_as_default=False) as client:
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, client.get_executor())
        with pytest.raises(gd.SceneError, match="get_executor"):
            gd.sweep(LOW, {KEY: FRACTIONS}, client)
    xr.testing.assert_identical(without_times(ds), expected)


def test_a_cluster_changes_nothing_of_trains(cluster):
    """Two keys of single shafts and meshes, and shafts that dry friction holds: equal to the last bit."""
    train = Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": 2e-5, "run.samples": 101})
    over = {"meshes.second.coating.sam_fraction": [1.0, 0.5], "shafts.idler.hub_friction": [0.3, 0.5]}
    here = without_times(gd.sweep(train, over, jobs=1))
    with distributed.Client(cluster, set_as_default=False) as client:
        there = gd.sweep(train, over, client.get_executor())
    xr.testing.assert_identical(without_times(there), here)
    assert here["shaft_speed"].dims[-2:] == ("shaft", "time")


def test_one_lost_run_is_a_label_there_too(cluster, monkeypatch, expected):
    """The error comes back from another process, to which a function inside another one is sent as it is."""

    def deed(scenes, backend, keep):
        if any(scene.coating.sam_fraction < 0.5 for scene in scenes):
            raise MemoryError("too large")
        return solve_group(scenes, backend, keep)

    monkeypatch.setattr(batch, "solve_group", deed)
    with dask_executor(cluster.scheduler_address) as executor:
        ds = gd.sweep(LOW, {KEY: FRACTIONS}, executor)
    assert ds.status.values.tolist() == ["finished", "finished", "crashed", "crashed"]
    assert ds.message.values[2] == "MemoryError: too large"
    xr.testing.assert_equal(ds.gear_speed[:2], expected.gear_speed[:2])


def test_from_the_command_line(cluster, tmp_path, monkeypatch, expected, capsys):
    monkeypatch.chdir(tmp_path)
    over = f"{KEY}={','.join(map(str, FRACTIONS))}"
    command = [
        "sweep",
        "teodorescu2009_low_speed",
        "--over",
        over,
        "--set",
        "run.duration=2 ms",
        "run.samples=101",
    ]
    assert main([*command, "--dask", cluster.scheduler_address, "-o", "sweep.nc"]) == 0
    assert capsys.readouterr().err == ""
    xr.testing.assert_identical(without_times(gd.open_archive("sweep.nc")), expected)
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.nc"]

    assert main([*command, "--dask", cluster.scheduler_address, "--jobs", "2", "-o", "other.nc"]) == 2
    assert "--jobs = 2" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["nonsense:nonsense", "127.0.0.1:1", "http://127.0.0.1:1", ""])
def test_an_address_where_no_scheduler_is(monkeypatch, address):
    monkeypatch.setattr("gearidae.runs.executors._PATIENCE", 0.5)
    with pytest.raises(gd.SceneError, match="no Dask scheduler answers there"), dask_executor(address):
        pass


def test_workers_with_another_version(cluster, monkeypatch):
    monkeypatch.setattr("gearidae.runs.executors.__version__", "99.0")
    with (
        pytest.raises(gd.SceneError, match=rf"needs gearidae 99\.0, and has: {gd.__version__}"),
        dask_executor(cluster.scheduler_address),
    ):
        pass


def test_workers_without_gearidae(cluster):
    """Each forgets it and where it is, and receives it again."""

    def forget():
        import sys

        sys.remembered = {
            name: sys.modules.pop(name) for name in list(sys.modules) if name.startswith("gearidae")
        }
        sys.modules["gearidae"] = None

    def remember():
        import sys

        sys.modules.update(sys.remembered)

    with distributed.Client(cluster, set_as_default=False) as client:
        client.run(forget)
        try:
            with (
                pytest.raises(gd.SceneError, match="ModuleNotFoundError"),
                dask_executor(cluster.scheduler_address),
            ):
                pass
        finally:
            client.run(remember)


def test_without_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(gd.SceneError, match=r"gearidae\[dask\]"), dask_executor("127.0.0.1:8786"):
        pass
