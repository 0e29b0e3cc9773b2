"""Commands of ``python -m gearidae_bench``: benchmark, accuracy run and long run, with their pages."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import print_line, show, show_rows
from gearidae.errors import SceneError
from gearidae.runs.executors import check_jobs
from gearidae_bench import Result, Settings, find_scenes, run_benchmark
from gearidae_bench.accuracy import accuracy_scenes, measure_accuracy
from gearidae_bench.accuracy_report import PICTURE, draw_accuracy
from gearidae_bench.accuracy_report import page as accuracy_page
from gearidae_bench.accuracy_report import quantiles as accuracy_quantiles
from gearidae_bench.files import write_result
from gearidae_bench.long import FEWEST_PASSAGES, long_page, measure_long, sound
from gearidae_bench.tables import ERRORS, beyond_rows, equal_error_rows

__all__ = ["bench_accuracy", "bench_long", "bench_scenes"]

_QUICK_SCENES = ("low_sam", "high_sam", "roller_slow_bare")
_QUICK = Settings(rounds=3, longest=1.0, share=1.0, every=2)


def bench_scenes(scenes: Sequence[str], output: Path | None, *, quick: bool) -> int:
    """Measure, print a table for each scene, and write everything to a folder if requested.

    Parameters
    ----------
    scenes : sequence of str
        Names of benchmark scenes; none for all of them (or a few, if `quick`).
    output : Path or None
        Folder for ``benchmark.json``, ``points.csv``, ``benchmark.md`` and a picture of each scene.
    quick : bool
        Fewer scenes, tolerances and rounds.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If there is no benchmark scene of a name.
    """
    chosen = find_scenes(tuple(scenes) or (_QUICK_SCENES if quick else ()))
    settings = _QUICK if quick else Settings()
    with Console(stderr=True).status("") as status:
        result = run_benchmark(
            chosen, settings, beyond=not quick, report=lambda words: status.update(f"{words} ...")
        )
    _print(result)
    if output is not None:
        write_result(result, output)
        print_line(f"Results: {output}")
    return DONE


def bench_long(passages: int, output: Path | None) -> int:
    """Run very many tooth passages, print the changes from part to part, and write the page if requested.

    Parameters
    ----------
    passages : int
        How many.
    output : Path or None
        Folder for ``long.md``.

    Returns
    -------
    int
        Exit code: `UNFINISHED` if a passage was miscounted.
    """
    if passages < FEWEST_PASSAGES:
        raise SceneError("--passages", passages, f"must be at least {FEWEST_PASSAGES}")
    with Console(stderr=True).status("") as status:
        parts = measure_long(passages, lambda passed: status.update(f"{passed} of {passages} passages ..."))
    text = long_page(parts)
    print_line(text)
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        (output / "long.md").write_text(text)
        print_line(f"Report: {output / 'long.md'}")
    return DONE if sound(parts) else UNFINISHED


def bench_accuracy(jobs: int | None, output: Path | None) -> int:
    """Run the shipped cases at many tolerances, compare the error with the tolerance, and write the page if requested.

    Parameters
    ----------
    jobs : int or None
        Scenes at a time; by default one per core.
    output : Path or None
        Folder for ``accuracy.md`` and ``images/accuracy.png``.

    Returns
    -------
    int
        Exit code.
    """
    workers, scenes = check_jobs(jobs), accuracy_scenes()
    with Console(stderr=True).status("") as status:
        results = measure_accuracy(
            scenes, workers, lambda done: status.update(f"{done} of {len(scenes)} ...")
        )
    rows = [
        (f"error / rtol at {name}", f"{median:.2g}", f"median; at most {largest:.2g}")
        for name, (_, median, _, largest) in accuracy_quantiles(results).items()
    ]
    show_rows(rows)
    if output is not None:
        (output / "images").mkdir(parents=True, exist_ok=True)
        (output / "accuracy.md").write_text(accuracy_page(results, datetime.now(UTC).date()))
        draw_accuracy(results, output / "images" / PICTURE)
        print_line(f"Report: {output / 'accuracy.md'}")
    return DONE


def _print(result: Result) -> None:
    for scene, title in result.scenes.items():
        table = Table(
            box=box.SIMPLE,
            pad_edge=False,
            title=f"{title}: run time (ms) at error of scale",
            title_justify="left",
        )
        table.add_column("")
        for error in ERRORS:
            table.add_column(f"1e{round(math.log10(error))}", justify="right")
        for label, times, _ in equal_error_rows(result, scene):
            table.add_row(label, *("-" if math.isnan(t) else f"{1e3 * t:.3g}" for t in times))
        show(table)
    for key, reason in result.skipped.items():
        sys.stdout.write(f"{result.labels[key]}: not measured ({reason})\n")
    rows = [(name, value, "") for name, value in beyond_rows(result)]
    if rows:
        show_rows(rows)
