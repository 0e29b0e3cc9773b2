"""``python -m gearidae_bench``: the benchmark and the accuracy and long runs, from a source tree."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from gearidae.cli.codes import BAD_INPUT, INTERRUPTED
from gearidae.errors import GearidaeError, SceneError
from gearidae_bench.commands import bench_accuracy, bench_long, bench_scenes

app = App(
    name="gearidae_bench",
    help="Measure run time against error.",
    suppress_keyboard_interrupt=False,
)


@app.default
def bench(
    *,
    scenes: Annotated[
        list[str] | None,
        Parameter(help="Benchmark scenes to measure; by default all.", consume_multiple=True),
    ] = None,
    output: Annotated[
        Path | None, Parameter(name=["--output", "-o"], help="Folder for tables, all points and pictures.")
    ] = None,
    quick: Annotated[bool, Parameter(help="Fewer scenes, tolerances and rounds.")] = False,
    accuracy: Annotated[
        bool, Parameter(help="Compare the error of every shipped case with the requested tolerance instead.")
    ] = False,
    jobs: Annotated[
        int | None, Parameter(help="Scenes at a time, with --accuracy; by default one per core.")
    ] = None,
    long: Annotated[
        bool, Parameter(help="Run very many tooth passages instead, and check for drift and memory growth.")
    ] = False,
    passages: Annotated[int, Parameter(help="Tooth passages of the long run.")] = 1_000_000,
) -> int:
    """Measure run time against error on this machine, and compare it with other integrators."""
    if accuracy and long:
        raise SceneError("bench", "--accuracy, --long", "say one of them")
    if long:
        return bench_long(passages, output)
    if accuracy:
        return bench_accuracy(jobs, output)
    return bench_scenes(scenes or [], output, quick=quick)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line, and return its exit code."""
    try:
        return int(app(arguments, result_action="return_value") or 0)
    except GearidaeError as error:
        sys.stderr.write(f"{error}\n")
        return BAD_INPUT
    except KeyboardInterrupt as interrupt:
        sys.stderr.write(f"interrupted: {interrupt}\n")
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
