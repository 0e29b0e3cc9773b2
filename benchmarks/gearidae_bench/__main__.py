"""``python -m gearidae_bench``: the benchmark and the stress, accuracy and long runs, from a source tree."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from gearidae.cli.codes import BAD_INPUT, INTERRUPTED
from gearidae.errors import GearidaeError, SceneError
from gearidae_bench.attack import PATIENCE
from gearidae_bench.attack_command import bench_attack, bench_forge, bench_kills
from gearidae_bench.commands import bench_accuracy, bench_long, bench_scenes, bench_stress

app = App(
    name="gearidae_bench",
    help="Measure run time against error, or search for faults.",
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
    stress: Annotated[
        bool, Parameter(help="Run random scenes over wide ranges instead, and name the ending of each.")
    ] = False,
    runs: Annotated[int, Parameter(help="Random scenes to run, or kills.")] = 2000,
    seed: Annotated[int, Parameter(help="Seed of the random scenes.")] = 1,
    accuracy: Annotated[
        bool, Parameter(help="Compare the error of every shipped case with the requested tolerance instead.")
    ] = False,
    jobs: Annotated[
        int | None, Parameter(help="Scenes at a time, with --stress or --accuracy; by default one per core.")
    ] = None,
    long: Annotated[
        bool, Parameter(help="Run very many tooth passages instead, and check for drift and memory growth.")
    ] = False,
    passages: Annotated[int, Parameter(help="Tooth passages of the long run.")] = 1_000_000,
    attack: Annotated[
        bool, Parameter(help="Run extreme but valid scenes instead, each in a monitored process.")
    ] = False,
    population: Annotated[bool, Parameter(help="Give the scenes of --attack real asperities.")] = False,
    friction: Annotated[bool, Parameter(help="Give the scenes of --attack friction.")] = False,
    patience: Annotated[
        float,
        Parameter(help="Time without progress after which a scene of --attack counts as hung, in seconds."),
    ] = PATIENCE,
    forge: Annotated[
        bool,
        Parameter(
            help="Read forged checkpoints and damaged archives instead; every fifth run is a forged one."
        ),
    ] = False,
    kills: Annotated[
        bool, Parameter(help="Kill runs, sweeps and maps at random moments instead, resume them and compare.")
    ] = False,
) -> int:
    """Measure run time against error on this machine, and compare it with other integrators."""
    if stress + accuracy + long + attack + forge + kills > 1:
        raise SceneError(
            "bench", "--stress, --accuracy, --long, --attack, --forge, --kills", "say one of them"
        )
    if attack:
        return bench_attack(
            runs, seed, jobs, output, patience, kind="friction" if friction else "population" * population
        )
    if forge:
        return bench_forge(runs, seed, jobs)
    if kills:
        return bench_kills(runs, seed)
    if long:
        return bench_long(passages, output)
    if stress:
        return bench_stress(runs, seed, jobs, output)
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
