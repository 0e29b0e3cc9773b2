import csv
import math

import numpy as np
import pytest

from gearidae.cli import main
from gearidae.errors import SceneError
from gearidae_bench import SCENES, Result, Settings, find_scenes, run_benchmark
from gearidae_bench.contender import BROKEN, Contender, explicit_contenders
from gearidae_bench.files import write_result
from gearidae_bench.scenes import BenchScene
from gearidae_bench.tables import broken_off, equal_error_rows, ratio_range

WORDS: list[str] = []
"""What is said while it is measured."""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("references")
    short = SCENES["roller_slow_bare"].scene.replace({"run.duration": 8e-6, "run.samples": 41})
    scene = BenchScene("short", "a short impact", short)
    absent = Contender(
        "absent", "absent", lambda *_: pytest.fail("must not run"), "compiled", unavailable=lambda: "gone"
    )
    broken = Contender("broken", "gives up", lambda *_: BROKEN, "compiled")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GEARIDAE_REFERENCES", str(folder))
        measured = run_benchmark(
            [scene],
            Settings(rounds=2, longest=0.5, share=0.5, every=3),
            contenders=[*explicit_contenders(), broken, absent],
            beyond=False,
            report=WORDS.append,
        )
        assert (folder / "short.npz").is_file()
    return measured


def test_every_contender_that_can_run_has_points(result):
    assert {p.contender for p in result.points} == {"dop853", "rk4", "broken"}
    assert result.skipped == {"absent": "gone"}
    assert all(p.fastest <= p.time <= p.slowest and p.repeats == 2 for p in result.points)


def test_tighter_tolerances_err_less(result):
    for key in ("dop853", "rk4"):
        errors = [p.error for p in result.points if p.contender == key]
        assert errors[-1] < 1e-2 * errors[0]


def test_rows_compare_at_equal_error(result):
    rows = {label: times for label, times, _ in equal_error_rows(result, "short")}
    assert set(rows) == {"DOP853, compiled", "RK4 of fixed step, compiled", "gives up"}
    assert np.isnan(rows["gives up"]).all()
    # nothing to compare with: the native driver was not measured
    assert all(math.isnan(x) for x in ratio_range(result, "short", ["rk4"]))


def test_runs_that_broke_off_are_named(result):
    tried = sum(p.contender == "broken" for p in result.points)
    assert tried > 1
    assert broken_off(result, "short") == [f"gives up ({tried} of {tried} runs)"]
    assert sum("gives up broke off" in words for words in WORDS) == tried


def test_files_hold_the_result(result, tmp_path):
    write_result(result, tmp_path)
    assert Result.load(tmp_path / "benchmark.json").points == result.points
    with (tmp_path / "points.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["error"]) for row in rows] == [p.error for p in result.points]
    page = (tmp_path / "benchmark.md").read_text()
    assert "### A short impact" in page
    assert "absent: not measured (gone)" in page
    assert "Broke off, without a result: gives up" in page
    assert (tmp_path / "images" / "work_precision_short.png").stat().st_size > 10_000


def test_an_unknown_scene_is_named():
    with pytest.raises(SceneError, match=r"scenes = .*nowhere.*low_sam"):
        find_scenes(("nowhere",))
    assert main(["bench", "--scenes", "nowhere"]) == 2
