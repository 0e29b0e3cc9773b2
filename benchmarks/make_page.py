"""Measure everything and renew the benchmark's page: ``python benchmarks/make_page.py [--quick | --tables | PART]``.

Runs the whole benchmark (some fifty minutes), writes ``benchmarks/results/``, replaces the tables between the markers
of ``docs/benchmarks.md`` and the pictures ``docs/images/work_precision_*.png``. ``--quick`` measures little, to see
that it works; ``--tables`` only writes the page again from the last results. A part alone: ``--long`` lets a million
teeth pass (some minutes), ``--start-stop`` measures start-ups and brakings (half an hour), ``--trains`` trains of
several meshes (a minute), ``--defaults`` what each default of a run costs (a minute).
"""

from __future__ import annotations

import sys
from pathlib import Path

from gearidae_bench import Result, Settings, find_scenes, run_benchmark
from gearidae_bench.default_cost import default_scenes, default_table, measure_defaults
from gearidae_bench.files import write_result
from gearidae_bench.long import long_page, measure_long
from gearidae_bench.start_stop import StartStop, measure_start_stop, start_stop_scenes
from gearidae_bench.start_stop_table import start_stop_page
from gearidae_bench.train_cost import cost_table, measure_trains

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "benchmarks.md"
RESULTS = ROOT / "benchmarks" / "results"
ROUNDS, TRAIN_ROUNDS = 7, 21
"""Of the costs of defaults, and of trains and a pair, in turn."""


def main(arguments: list[str]) -> None:
    """Measure (or load) a result and write it into the page."""
    if "--long" in arguments:
        parts = measure_long(report=lambda passed: sys.stderr.write(f"\r{passed} passages"))
        (RESULTS / "long.md").write_text(long_page(parts))
        _insert("long", RESULTS / "long.md")
        return
    if "--trains" in arguments:
        _trains()
        return
    if "--defaults" in arguments:
        (RESULTS / "defaults.md").write_text(default_table(measure_defaults(default_scenes(), ROUNDS)))
        _insert("defaults", RESULTS / "defaults.md")
        return
    if "--start-stop" in arguments:
        _start_stop(measure_start_stop(start_stop_scenes(), report=_say))
        return
    if "--tables" in arguments:
        _start_stop(StartStop.load(RESULTS / "start_stop.json"))
        result = Result.load(RESULTS / "benchmark.json")
    else:
        quick = "--quick" in arguments
        settings = Settings(rounds=2, longest=0.5, share=0.5, every=3) if quick else Settings()
        result = run_benchmark(find_scenes(()), settings, beyond=not quick, report=_say)
        if not quick:
            _start_stop(measure_start_stop(start_stop_scenes(), report=_say))
            _trains()
    write_result(result, RESULTS, PAGE.parent / "images")
    _insert("measured", RESULTS / "benchmark.md")


def _say(words: str) -> None:
    sys.stderr.write(f"{words}\n")


def _trains() -> None:
    """Measure what trains cost over a pair, and renew their table."""
    (RESULTS / "trains.md").write_text(cost_table(measure_trains(TRAIN_ROUNDS)))
    _insert("trains", RESULTS / "trains.md")


def _start_stop(result: StartStop) -> None:
    """Keep what was measured of start-ups and brakings, and renew their tables."""
    result.save(RESULTS / "start_stop.json")
    (RESULTS / "start_stop.md").write_text(start_stop_page(result))
    _insert("start and stop", RESULTS / "start_stop.md")


def _insert(name: str, source: Path) -> None:
    """Replace what stands between two markers of the page."""
    begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->\n"
    before, rest = PAGE.read_text().split(begin)
    _, after = rest.split(end)
    PAGE.write_text(before + begin + "\n" + source.read_text() + "\n" + end + after)


if __name__ == "__main__":
    main(sys.argv[1:])
