"""The measurement of what an ensemble costs counts what it says."""

from __future__ import annotations

import gearidae as gd
from gearidae_bench.ensemble_cost import cost_table, ensemble_cost


def test_parts_add_up_and_the_archive_is_written(tmp_path):
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3})
    cost = ensemble_cost(scene, 6, 2, tmp_path / "out.nc")
    assert cost.members == gd.open_archive(tmp_path / "out.nc").sizes["member"] == 6
    assert 0.0 < cost.solving < cost.processor
    assert 0.0 < cost.beside < cost.processor
    assert cost.cores <= 2.5  # threads of the linear algebra may help
    assert f"{cost.peak:.0f}" in cost_table({"short": cost})
