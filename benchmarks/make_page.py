"""Measure everything and renew the benchmark's page: ``python benchmarks/make_page.py [--quick | --tables]``.

Runs the whole benchmark (some ten minutes), writes ``benchmarks/results/``, replaces the tables between the markers of
``docs/benchmarks.md`` and the pictures ``docs/images/work_precision_*.png``. ``--quick`` measures little, to see
that it works; ``--tables`` only writes the page again from the last results.
"""

from __future__ import annotations

import sys
from pathlib import Path

from gearidae.bench import Result, Settings, find_scenes, run_benchmark
from gearidae.bench.files import write_result

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "benchmarks.md"
RESULTS = ROOT / "benchmarks" / "results"
BEGIN, END = "<!-- begin measured -->\n", "<!-- end measured -->\n"


def main(arguments: list[str]) -> None:
    """Measure (or load) a result and write it into the page."""
    if "--tables" in arguments:
        result = Result.load(RESULTS / "benchmark.json")
    else:
        quick = "--quick" in arguments
        settings = Settings(rounds=2, longest=0.5, share=0.5, every=3) if quick else Settings()
        result = run_benchmark(
            find_scenes(()), settings, beyond=not quick, report=lambda words: sys.stderr.write(f"{words}\n")
        )
    write_result(result, RESULTS, PAGE.parent / "images")
    text = PAGE.read_text()
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    PAGE.write_text(before + BEGIN + "\n" + (RESULTS / "benchmark.md").read_text() + "\n" + END + after)


if __name__ == "__main__":
    main(sys.argv[1:])
