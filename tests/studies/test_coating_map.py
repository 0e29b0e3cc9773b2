"""Coating maps: what a run that fails leaves out, and which archives of other maps are kept from being resumed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearidae as gd
from gearidae import engine
from gearidae.analysis import coating_map
from gearidae.studies.declared.coating_map import STUDY

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 4001})
FRACTIONS = [1.0, 0.9, 0.8]
TORQUES = {"drive.torque": [4e-18, 5e-18]}


def test_a_run_that_fails_is_kept_out_of_the_map_and_named(monkeypatch):
    """It has got half its way: nothing of that stands for the whole run."""
    expected = coating_map(LOW, FRACTIONS, over=TORQUES)
    solve = engine.solve

    def failing(scene, **options):
        solution = solve(scene, **options)
        if (scene.coating.sam_fraction, scene.drive.torque) != (0.9, 5e-18):
            return solution
        half = len(solution.time) // 2
        cut = {name: column[:half] for name, column in solution.samples.items()}
        return replace(
            solution, time=solution.time[:half], samples=cut, status="chatter", message="of a test"
        )

    monkeypatch.setattr(engine, "solve", failing)
    chart = coating_map(LOW, FRACTIONS, over=TORQUES, jobs=1)
    failed = chart.status == "chatter"
    assert failed.sum() == 1
    assert chart.message.where(failed, drop=True).item() == "of a test"
    for name in ("characteristic_frequency", "uncertainty", "median_gear_speed", "min_gear_speed"):
        np.testing.assert_array_equal(chart[name], expected[name].where(~failed))
    words = [row[2] for row in STUDY.rows(chart)]
    assert words.count("its run could not be finished") == 1


def test_no_other_map_is_replaced(tmp_path):
    archive = tmp_path / "map.nc"
    coating_map(LOW, FRACTIONS, archive=archive)
    before = archive.read_bytes()
    for changes in ({"sam_fraction": FRACTIONS[:2]}, {"width": 0.5}, {"over": TORQUES}):
        with pytest.raises(gd.SceneError, match="of another sweep or study"):
            coating_map(LOW, **{"sam_fraction": FRACTIONS, **changes}, archive=archive, resume=True)
    with pytest.raises(gd.SceneError, match="of another sweep or study"):
        coating_map(LOW.replace({"run.rtol": 1e-5}), FRACTIONS, archive=archive, resume=True)
    assert archive.read_bytes() == before
    with pytest.raises(gd.SceneError, match="needs an archive"):
        coating_map(LOW, FRACTIONS, resume=True)
