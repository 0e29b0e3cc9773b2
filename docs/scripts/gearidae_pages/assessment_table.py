"""How often a clear assessment is wrong: ``python -m gearidae_pages.assessment_table [--trials N] [--only TEXT]``.

Simulated speeds of known SAM fraction are spoilt as rigs spoil them and assessed against two maps, one at the preset's
torque and one over torque. Renews the table of ``docs/assess.md`` (a few minutes).
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae.arrays import Floats
from gearidae_pages.assessment_signals import (
    CONDITIONS,
    FRACTIONS,
    Condition,
    Key,
    clean_speeds,
    cutoff,
    record,
)

__all__ = ["RATES", "Row", "make_maps", "make_rows", "markdown"]

RATES = (100e3, 25e3, 10e3)
"""Sampling rates [Hz]."""
_PAGE = Path(__file__).parents[3] / "docs" / "assess.md"
_MARKS = ("<!-- begin table -->\n", "<!-- end table -->\n")


@dataclass
class Row:
    """Verdicts of one condition against one map.

    Attributes
    ----------
    records : int
        Assessed.
    clear : int
        Verdicts that were clear.
    wrong : list of str
        Clear verdicts whose interval does not hold the true fraction, in words.
    widths : list of float
        Widths of the clear intervals [1].
    """

    records: int = 0
    clear: int = 0
    wrong: list[str] = field(default_factory=list)
    widths: list[float] = field(default_factory=list)

    @property
    def share_wrong(self) -> float:
        """Part of the clear verdicts that is wrong."""
        return len(self.wrong) / self.clear if self.clear else 0.0


def make_maps(spacing: float = 0.02) -> dict[str, xr.Dataset]:
    """Maps of the preset at low speed: at one torque, and over torque.

    Parameters
    ----------
    spacing : float, optional
        Between the fractions, from 1 to 0.5.
    """
    scene = gd.preset("teodorescu2009_low_speed")
    fractions = np.round(np.arange(1.0, 0.5 - 0.5 * spacing, -spacing), 4)
    over = gd.analysis.coating_map(scene, fractions, over="drive.torque")
    middle = float(over["torque"].values[over.sizes["torque"] // 2])
    return {"one torque": over.sel(torque=middle, drop=True), "over torque": over}


def make_rows(
    maps: Mapping[str, xr.Dataset],
    conditions: Mapping[str, Condition],
    fractions: Iterable[float] = FRACTIONS,
    rates: Iterable[float] = RATES,
    trials: int = 2,
    seed: int = 2009,
) -> dict[str, dict[str, Row]]:
    """Assess all records of some conditions.

    Parameters
    ----------
    maps : mapping of str to Dataset
    conditions : mapping of str to Condition
    fractions, rates : iterable of float, optional
    trials : int, optional
        Noises for each fraction and rate.
    seed : int, optional

    Returns
    -------
    dict of str to dict of str to Row
        For each condition, the row of each map.
    """
    fractions, rates = tuple(fractions), tuple(rates)
    keys: set[Key] = {(c.driver, c.torque, f) for c in conditions.values() for f in fractions}
    speeds = clean_speeds(keys)
    rows: dict[str, dict[str, Row]] = {}
    for number, (name, condition) in enumerate(conditions.items()):
        rows[name] = {title: Row() for title in maps}
        for fraction in fractions:
            speed = speeds[condition.driver, condition.torque, fraction]
            for rate in rates:
                rng = np.random.default_rng([seed, number, round(1e4 * fraction), round(rate)])
                for _ in range(trials):
                    _assess(rows[name], maps, speed, fraction, condition, rate, rng)
    return rows


def _assess(
    rows: Mapping[str, Row],
    maps: Mapping[str, xr.Dataset],
    speed: Floats,
    fraction: float,
    condition: Condition,
    rate: float,
    rng: np.random.Generator,
) -> None:
    """Count one record, assessed against every map."""
    signal = record(speed, condition, rate, rng)
    known = cutoff(condition, rate) if condition.filtered else None
    for title, chart in maps.items():
        assessment = gd.analysis.assess(
            signal, chart, anti_alias_filter=known, calibration=condition.calibration
        )
        row = rows[title]
        row.records += 1
        if assessment.conclusive:
            row.clear += 1
            row.widths.append(assessment.high - assessment.low)
            if not assessment.low <= fraction <= assessment.high:
                row.wrong.append(f"{fraction:g} at {rate:g} Hz: {assessment}")


def markdown(rows: Mapping[str, Mapping[str, Row]]) -> str:
    """Table of all rows, a line for each condition."""
    titles = list(next(iter(rows.values())))
    lines = [
        "| condition | records | " + " | ".join(f"map {t}: clear | wrong | width" for t in titles) + " |",
        "|---|---:|" + "---:|---:|---:|" * len(titles),
    ]
    for name, columns in rows.items():
        cells = [
            f"{row.clear} | {len(row.wrong)} | {np.median(row.widths):.3f}" if row.clear else "0 | 0 | -"
            for row in columns.values()
        ]
        lines.append(f"| {name} | {columns[titles[0]].records} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> int:
    """Make the table, print what was wrong, and renew the page unless only a part was asked for.

    Returns
    -------
    int
        1 if more than 5 % of the clear verdicts of any row are wrong.
    """
    options = dict(zip(arguments[::2], arguments[1::2], strict=True))
    only = options.get("--only", "")
    chosen = {name: condition for name, condition in CONDITIONS.items() if only in name}
    rows = make_rows(make_maps(), chosen, trials=int(options.get("--trials", "2")))
    table = markdown(rows)
    sys.stdout.write(table)
    for name, columns in rows.items():
        for title, row in columns.items():
            sys.stdout.writelines(f"wrong, {name}, map {title}: {words}\n" for words in row.wrong)
    if not only:
        before, rest = _PAGE.read_text(encoding="utf-8").split(_MARKS[0])
        after = rest.split(_MARKS[1])[1]
        _PAGE.write_text(f"{before}{_MARKS[0]}\n{table}\n{_MARKS[1]}{after}", encoding="utf-8")
    return int(any(row.share_wrong > 0.05 for columns in rows.values() for row in columns.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
