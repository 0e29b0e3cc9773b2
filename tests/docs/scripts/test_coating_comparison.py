"""The comparison of the paper's answers under different assumptions of coating, asperities and radius force."""

from __future__ import annotations

import math

import pytest

import gearidae as gd
from gearidae_pages.coating_assumptions import (
    ALL_ASSUMPTIONS,
    FRACTIONS,
    Assumption,
    HighSpeed,
    Impact,
    LowSpeed,
    low_speed,
)
from gearidae_pages.coating_comparison import high_speed_table, impact_table, low_speed_table, with_tables
from gearidae_pages.coating_pictures import draw_limits

THICK = Assumption("jkr", "patches", 2.5e-9, radius_force=True)


def test_a_thickness_lets_worn_gears_turn():
    """Coarse brackets: half covered patches of 2.5 nm are far from their limit, and the bare gears stick."""
    base = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "0.1 s"})
    (outcome,) = low_speed([THICK], base, resolution=0.5, fractions=(1.0,))
    assert (outcome.sticks, outcome.turns) == (0.0, 0.45)
    assert outcome.speed > 1.45
    assert outcome.frequencies[0] == pytest.approx(1274, abs=30)  # 1.23 to 1.30 kHz, by its own uncertainty


def test_assumptions_change_what_a_scene_has():
    gears = THICK.of(gd.preset("teodorescu2009_low_speed"), coating__sam_fraction=0.5)
    assert (gears.coating.thickness, gears.coating.sam_fraction, gears.mesh.radius_force) == (
        2.5e-9,
        0.5,
        True,
    )
    roller = Assumption("maugis").of(gd.preset("roller_slow"), coating__sam_fraction=1.0)
    assert (roller.contact.asperity, roller.coating.sam_fraction) == ("maugis", 1.0)
    assert len(set(ALL_ASSUMPTIONS)) == 16


def test_tables_have_a_row_for_each():
    low = low_speed_table([LowSpeed(THICK, math.nan, 0.26, 1.25, (1274.0, math.nan, 2e3, 3e3))])
    assert "| patches, 2.5 nm | JKR + radius force | - | 0.260 | 1.2500 | 1.27 | - | 2.00 | 3.00 |" in low
    assert low.count("\n") == 3
    high = high_speed_table([HighSpeed(Assumption("maugis"), 2893.5, 2891.25)])
    assert "| Maugis | 2893.50 | 2891.25 | 2.250 |" in high
    force = impact_table([Impact("jkr", 0.01, (1.67e-5, 1.55e-5), (1.26e-6, 1e-12))])
    assert "| 0.01 m/s | JKR | 16.7 | 15.5 | 1.26 | 0 |" in force


def test_tables_go_to_their_places_on_the_page():
    page = "# Title\n<!-- a -->\nold\n<!-- end -->\nwords\n<!-- b -->\n<!-- end -->\n"
    once = with_tables(page, {"a": "new\n", "b": "other\n"})
    assert "old" not in once
    assert "new" in once
    assert "words" in once
    assert with_tables(once, {"a": "new\n", "b": "other\n"}) == once
    with pytest.raises(ValueError, match="no place for the table c"):
        with_tables(page, {"c": "x"})


def test_limits_are_drawn_by_coating_and_contact():
    limits = [LowSpeed(assumption, 0.4, 0.41, 1.0, (1e3,) * len(FRACTIONS)) for assumption in ALL_ASSUMPTIONS]
    (ax,) = draw_limits(limits).axes
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        "patches, 0 nm",
        "patches, 2.5 nm",
        "independent, 0 nm",
        "independent, 2.5 nm",
    ]
    assert len(ax.lines) == 16
