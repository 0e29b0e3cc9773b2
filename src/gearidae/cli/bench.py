"""``gearidae bench``: run time against error on this machine."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

from gearidae.bench import Result, Settings, find_scenes, run_benchmark
from gearidae.bench.files import write_result
from gearidae.bench.tables import ERRORS, beyond_rows, equal_error_rows
from gearidae.cli.codes import DONE
from gearidae.cli.output import say, show
from gearidae.cli.tables import show_rows

__all__ = ["bench_scenes"]

_QUICK_SCENES = ("low_sam", "high_sam", "roller_slow_bare")
_QUICK = Settings(rounds=3, longest=1.0, share=1.0, every=2)


def bench_scenes(scenes: Sequence[str], output: Path | None, *, quick: bool) -> int:
    """Measure, print a table for each scene, and write everything to a folder if asked.

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
        say(f"Results: {output}")
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
