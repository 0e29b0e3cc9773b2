"""Where the paper's answers move with what is assumed of coating, asperities and radius force.

Runs the presets under every combination and writes the tables and pictures of `docs/coating_compared.md`::

    python -m gearidae_pages.coating_comparison docs
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from gearidae_pages.coating_assumptions import (
    FRACTIONS,
    LAWS,
    HighSpeed,
    Impact,
    LowSpeed,
    high_speed,
    impacts,
    low_speed,
)
from gearidae_pages.coating_pictures import draw_all

__all__ = ["high_speed_table", "impact_table", "low_speed_table", "with_tables", "write_page"]


def low_speed_table(outcomes: Sequence[LowSpeed]) -> str:
    """Write what the low-speed gears do as a table in Markdown."""
    heads = [f"{100 * f:g} %" for f in FRACTIONS]
    rows = []
    for outcome in outcomes:
        ends = [_number(end, ".3f") for end in (outcome.sticks, outcome.turns)]
        frequencies = [_number(1e-3 * value, ".2f") for value in outcome.frequencies]
        rows.append(
            [
                outcome.assumption.coating,
                outcome.assumption.contact,
                *ends,
                f"{outcome.speed:.4f}",
                *frequencies,
            ]
        )
    head = ["coating", "asperities", "sticks at", "turns at", "smallest speed at 50 % (rad/s)"]
    return _table([*head, *(f"frequency at {value} (kHz)" for value in heads)], 2, rows)


def high_speed_table(outcomes: Sequence[HighSpeed]) -> str:
    """Write mean speeds of the high-speed gears as a table in Markdown."""
    rows = [
        [
            outcome.assumption.contact,
            f"{outcome.whole:.2f}",
            f"{outcome.bare:.2f}",
            f"{outcome.whole - outcome.bare:.3f}",
        ]
        for outcome in outcomes
    ]
    return _table(["asperities", "SAM (rad/s)", "bare (rad/s)", "SAM less bare (rad/s)"], 1, rows)


def impact_table(outcomes: Sequence[Impact]) -> str:
    """Write peak forces and tensions of the rollers as a table in Markdown."""
    rows = [
        [
            f"{outcome.speed:g} m/s",
            LAWS[outcome.law],
            *(_micro(value) for value in (*outcome.peaks, *outcome.tensions)),
        ]
        for outcome in outcomes
    ]
    heads = ["peak, bare (uN)", "peak, SAM (uN)", "largest tension, bare (uN)", "largest tension, SAM (uN)"]
    return _table(["speed", "asperities", *heads], 2, rows)


def _micro(force: float) -> str:
    """Force in uN with three digits; what is below a thousandth of it is none."""
    return f"{1e6 * force:.3g}" if force >= 1e-9 else "0"


def _number(value: float, form: str) -> str:
    return "-" if math.isnan(value) else format(value, form)


def _table(heads: Iterable[str], words: int, rows: Sequence[Sequence[str]]) -> str:
    """Put a table together whose first columns are words and the others numbers."""
    heads = list(heads)
    rule = "|" + "---|" * words + "---:|" * (len(heads) - words)
    return "\n".join([f"| {' | '.join(heads)} |", rule, *(f"| {' | '.join(row)} |" for row in rows)]) + "\n"


def with_tables(page: str, tables: Mapping[str, str]) -> str:
    """Return a page with its tables renewed, each between ``<!-- NAME -->`` and ``<!-- end -->``.

    Raises
    ------
    ValueError
        If the page has no place for one of them.
    """
    for name, table in tables.items():
        before, begin, rest = page.partition(f"<!-- {name} -->\n")
        _, end, after = rest.partition("<!-- end -->")
        if not end:
            raise ValueError(f"the page has no place for the table {name}")
        page = f"{before}{begin}\n{table}\n{end}{after}"
    return page


def write_page(docs: Path) -> None:
    """Run everything, and renew tables and pictures of the page in a folder of documentation."""
    page = docs / "coating_compared.md"
    low = list(low_speed())
    tables = {
        "impacts": impact_table(list(impacts())),
        "high speed": high_speed_table(list(high_speed())),
        "low speed": low_speed_table(low),
    }
    page.write_text(with_tables(page.read_text(), tables))
    draw_all(low, docs / "images")


if __name__ == "__main__":
    write_page(Path(sys.argv[1]))
