"""The comparison of sticking limits under different assumptions of the coating."""

from __future__ import annotations

import math

import gearidae as gd
from gearidae_bench.coating_comparison import Compared, comparison, comparison_table


def test_a_thickness_lets_worn_gears_turn():
    """Coarse brackets: half covered patches of 2.5 nm are far from their limit, and the bare gears stick."""
    base = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 301})
    (one,) = comparison(base, ["jkr"], ["patches"], [2.5e-9], resolution=0.5)
    assert (one.sticks, one.turns) == (0.0, 0.45)
    assert one.speed > 1.45


def test_the_table_has_a_row_for_each():
    rows = [
        Compared("jkr", "patches", 2.5e-9, 0.25, 0.26, 1.25),
        Compared("jkr", "x", 0.0, math.nan, math.nan, 1.0),
    ]
    table = comparison_table(rows)
    assert table.count("\n") == 4
    assert "| `jkr` | patches | 2.5 nm | 0.250 | 0.260 | 1.2500 rad/s |" in table
    assert "| - | - |" in table
