"""Coating maps: what a run that fails leaves out, and which archives of other maps are kept from being resumed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gearidae as gd
from gearidae import engine
from gearidae.analysis import coating_map
from gearidae.monitor.declared.coating_map import STUDY

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


def test_a_map_over_seeds_is_the_mean_of_its_gears_and_has_what_each_rings():
    teeth = LOW.replace({"mesh.pitch_error_rms": "3 nm", "mesh.pitch_error_seed": 3})
    chart = coating_map(teeth, FRACTIONS[1:], seeds=5)
    assert chart.attrs["seeds"] == 5
    assert chart.gear_frequency.dims == ("sam_fraction", "impact", "gear")
    alone = coating_map(teeth.replace({"mesh.pitch_error_seed": 5}), FRACTIONS[1:])
    np.testing.assert_array_equal(chart.gear_frequency.isel(gear=2), alone.impact_frequency)
    mean = np.exp(np.log(chart.gear_frequency.values).mean(axis=-1))
    rings = np.isfinite(mean)
    np.testing.assert_allclose(chart.impact_frequency.values[rings], mean[rings], rtol=1e-12)
    assert "between gears" in str(list(STUDY.rows(chart)))
    assert "One of 5 gears" in STUDY.sentence(chart)
    # a further gear of the design: the statement says what the interval includes
    record = gd.simulate(teeth.replace({"mesh.pitch_error_seed": 99, "coating.sam_fraction": 0.85}))
    assessment = gd.analysis.assess(record, chart)
    assert "off the mean of the map's 5, which the interval includes" in assessment.explanation
    assert assessment.low < 0.85 < assessment.high
    one = gd.analysis.assess(record, alone)
    assert "one drawing (mesh.pitch_error_seed)" in one.explanation or not one.conclusive


@pytest.mark.parametrize(
    ("scene", "seeds", "words"),
    [
        (LOW, 20, r"needs contact.roughness .*mesh\.pitch_error_rms"),
        (LOW.replace({"mesh.pitch_error_rms": 3e-9}), 4, "must be 5 or more"),
        (LOW.replace({"mesh.pitch_error_rms": 3e-9}), 0, "seeds = 0"),
    ],
)
def test_seeds_that_make_no_map_are_refused(scene, seeds, words):
    with pytest.raises(gd.SceneError, match=words):
        coating_map(scene, FRACTIONS, seeds=seeds)
