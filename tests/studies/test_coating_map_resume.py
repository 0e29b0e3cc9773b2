"""Coating maps that are cut off are resumed from their finished runs, and end as if nothing had happened."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.analysis import coating_map, open_map
from gearidae.cli import main
from gearidae.errors import Interrupted
from gearidae.studies.declared.coating_map import STUDY
from sweeps import without_times

CASE = "teodorescu2009_low_speed"
LOW = gd.preset(CASE).replace({"run.samples": 4001})
FRACTIONS = [1.0, 0.9, 0.8]
TORQUES = {"drive.torque": [4e-18, 5e-18]}
RUNS = len(FRACTIONS) * 2
SHOT = """
import os, pathlib, signal, sys
import gearidae as gd

low = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 4001})

def shoot(done, total):
    if len(list(pathlib.Path(sys.argv[1] + ".runs").glob("*.npz"))) >= 4:
        os.kill(os.getpid(), signal.SIGKILL)

gd.analysis.coating_map(low, [1.0, 0.9, 0.8], over={"drive.torque": [4e-18, 5e-18]}, jobs=1,
                        archive=sys.argv[1], progress=shoot)
"""


@pytest.fixture
def computed(monkeypatch):
    """Fraction and torque of the runs that the engine is asked for."""
    runs = []
    solve = engine.solve

    def note(scene, **options):
        runs.append((scene.coating.sam_fraction, scene.drive.torque))
        return solve(scene, **options)

    monkeypatch.setattr(engine, "solve", note)
    return runs


@pytest.fixture(scope="module")
def expected():
    return without_times(coating_map(LOW, FRACTIONS, over=TORQUES, jobs=1))


@pytest.fixture
def cut_off(tmp_path):
    """Path of a map that was cut off after four of its six runs."""
    archive = tmp_path / "map.nc"
    shot = subprocess.run([sys.executable, "-c", SHOT, archive], capture_output=True, check=False)
    assert shot.returncode == -signal.SIGKILL, shot.stderr
    assert not archive.exists()
    assert len(kept_files(archive)) == 4
    return archive


def kept_files(archive):
    return sorted(archive.with_name(f"{archive.name}.runs").iterdir())


def test_a_killed_map_is_resumed_and_equals_one_that_was_not(cut_off, computed, expected):
    chart = coating_map(LOW, FRACTIONS, over=TORQUES, jobs=1, archive=cut_off, resume=True)
    assert computed == [(0.9, 5e-18), (0.8, 5e-18)]
    assert np.isfinite(chart.characteristic_frequency).all()
    xr.testing.assert_identical(without_times(chart), expected)
    xr.testing.assert_identical(without_times(open_map(cut_off)), expected)
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_an_unfinished_map_is_not_lost_by_mistake(cut_off, computed, expected):
    with pytest.raises(gd.SceneError, match=r"4 of its runs are in map\.nc\.runs.*--resume.*--overwrite"):
        coating_map(LOW, FRACTIONS, over=TORQUES, archive=cut_off)
    assert len(kept_files(cut_off)) == 4
    assert computed == []
    chart = coating_map(LOW, FRACTIONS, over=TORQUES, jobs=1, archive=cut_off, overwrite=True)
    assert len(computed) == RUNS
    xr.testing.assert_identical(without_times(chart), expected)


def test_a_run_that_fails_is_kept_out_of_the_map_and_named(monkeypatch, expected):
    """It has got half its way: nothing of that stands for the whole run."""
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


def test_ctrl_c_keeps_runs_to_go_on_from(tmp_path, expected):
    archive = tmp_path / "map.nc"

    def interrupt(done, total):
        if done > 1.0:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(Interrupted, match="--resume") as caught:
        coating_map(LOW, FRACTIONS, over=TORQUES, jobs=1, archive=archive, progress=interrupt)
    assert caught.value.dataset.status.values.tolist() == ["finished", "interrupted", "interrupted"]
    assert not archive.exists()
    assert len(kept_files(archive)) == 1
    chart = coating_map(LOW, FRACTIONS, over=TORQUES, archive=archive, resume=True)
    xr.testing.assert_identical(without_times(chart), expected)


def test_a_whole_map_is_not_computed_again_and_no_other_is_replaced(tmp_path, computed):
    archive = tmp_path / "map.nc"
    chart = coating_map(LOW, FRACTIONS, archive=archive)
    computed.clear()
    again = coating_map(LOW, FRACTIONS, archive=archive, resume=True)
    assert computed == []
    xr.testing.assert_identical(again, chart)
    for changes in ({"sam_fraction": FRACTIONS[:2]}, {"width": 0.5}, {"over": TORQUES}):
        with pytest.raises(gd.SceneError, match="of another sweep or study"):
            coating_map(LOW, **{"sam_fraction": FRACTIONS, **changes}, archive=archive, resume=True)
    with pytest.raises(gd.SceneError, match="of another sweep or study"):
        coating_map(LOW.replace({"run.rtol": 1e-5}), FRACTIONS, archive=archive, resume=True)
    assert computed == []


def test_resume_needs_an_archive(computed):
    with pytest.raises(gd.SceneError, match="needs an archive"):
        coating_map(LOW, FRACTIONS, resume=True)
    assert computed == []


def test_the_command_resumes(cut_off, computed, capfd):
    arguments = [
        "coating-map", CASE, "-o", str(cut_off), "--jobs", "1",
        "--over", "coating.sam_fraction=1,0.9,0.8", "drive.torque=4e-18,5e-18",
        "--set", "run.samples=4001",
    ]  # fmt: skip
    assert main(arguments) == 2
    assert "4 of its runs" in capfd.readouterr().err
    assert main([*arguments, "--resume"]) == 0
    assert len(computed) == RUNS - 4
    np.testing.assert_array_equal(open_map(cut_off).torque.values, TORQUES["drive.torque"])
