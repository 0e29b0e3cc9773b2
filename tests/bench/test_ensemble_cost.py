"""The measurement of what an ensemble costs counts what it says."""

from __future__ import annotations

import pytest

import gearidae as gd
from gearidae import engine
from gearidae_bench.ensemble_cost import cost_row, ensemble_cost, same_runs, wall_apart
from gearidae_bench.ensemble_on_dask import dask_cost

SHORT = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3})


def test_parts_add_up_and_the_archive_is_written(tmp_path):
    solve = engine.solve
    cost, ds = ensemble_cost(SHORT, 6, 2, tmp_path / "out.nc")
    assert engine.solve is solve
    assert cost.members == gd.open_archive(tmp_path / "out.nc").sizes["member"] == ds.sizes["member"] == 6
    assert 0.0 < cost.solving < cost.processor
    assert 0.0 < cost.beside < cost.processor
    assert cost.over_solver == pytest.approx(1.0 + 6 * cost.beside / cost.solving)
    assert cost.cores <= 2.5  # threads of the linear algebra may help
    assert f"{cost.peak:.0f}" in cost_row("short", cost)


@pytest.mark.by_hand  # imports in new processes
def test_processes_that_share_nothing_write_their_parts(tmp_path):
    assert wall_apart(SHORT, 4, 2, tmp_path) > 0.0
    assert [gd.open_archive(tmp_path / f"part_{k}.nc").sizes["member"] for k in range(2)] == [2, 2]


@pytest.mark.by_hand
def test_a_cluster_counts_the_solver_of_its_workers(tmp_path):
    pytest.importorskip("distributed")
    _, local = ensemble_cost(SHORT, 6, 1)
    there = dask_cost(SHORT, 6, 1, tmp_path / "out.nc")
    assert same_runs(local, there.runs)
    assert not same_runs(local, there.runs.isel(member=slice(None, None, -1)))
    assert 0.0 < there.cost.solving < there.cost.processor
    assert 0.0 < there.idle < 1.0
    assert there.beside == pytest.approx(there.cost.beside - there.idle * there.cost.wall / 6)
