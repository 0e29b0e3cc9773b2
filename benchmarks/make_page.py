"""Measure everything and renew the benchmark's page: ``python benchmarks/make_page.py [--quick | --tables | --long]``.

Runs the whole benchmark (some twenty minutes), writes ``benchmarks/results/``, replaces the tables between the markers
of ``docs/benchmarks.md`` and the pictures ``docs/images/work_precision_*.png``. ``--quick`` measures little, to see
that it works; ``--tables`` only writes the page again from the last results; ``--long`` only lets a million teeth pass
(some minutes) and renews the table about that.
"""

from __future__ import annotations

import sys
from pathlib import Path

from gearidae_bench import Result, Settings, find_scenes, run_benchmark
from gearidae_bench.files import write_result
from gearidae_bench.long import long_page, measure_long

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "benchmarks.md"
RESULTS = ROOT / "benchmarks" / "results"


def main(arguments: list[str]) -> None:
    """Measure (or load) a result and write it into the page."""
    if "--long" in arguments:
        parts = measure_long(report=lambda passed: sys.stderr.write(f"\r{passed} passages"))
        (RESULTS / "long.md").write_text(long_page(parts))
        _insert("long", RESULTS / "long.md")
        return
    if "--tables" in arguments:
        result = Result.load(RESULTS / "benchmark.json")
    else:
        quick = "--quick" in arguments
        settings = Settings(rounds=2, longest=0.5, share=0.5, every=3) if quick else Settings()
        result = run_benchmark(
            find_scenes(()), settings, beyond=not quick, report=lambda words: sys.stderr.write(f"{words}\n")
        )
    write_result(result, RESULTS, PAGE.parent / "images")
    _insert("measured", RESULTS / "benchmark.md")


def _insert(name: str, source: Path) -> None:
    """Replace what stands between two markers of the page."""
    begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->\n"
    before, rest = PAGE.read_text().split(begin)
    _, after = rest.split(end)
    PAGE.write_text(before + begin + "\n" + source.read_text() + "\n" + end + after)


if __name__ == "__main__":
    main(sys.argv[1:])
