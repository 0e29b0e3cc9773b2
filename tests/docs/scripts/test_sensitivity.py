"""The search for the sticking limit."""

from __future__ import annotations

import math

import pytest

import gearidae as gd
from gearidae_pages.sensitivity import Limit, sensitivities, sensitivity_table, sticking_limit

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 3001})


def test_the_bracket_holds_the_limit():
    """At 0.49 the preset sticks within 0.3 s and at 0.50 it turns, as an independent program found too."""
    sticks, turns = sticking_limit(LOW, lowest=0.47, highest=0.51, resolution=0.01)
    assert 0.0 < turns - sticks <= 0.01 * (1 + 1e-9)
    assert sticks < 0.5
    assert turns > 0.49


def test_ends_that_are_no_bracket_are_told():
    assert all(math.isnan(end) for end in sticking_limit(LOW, lowest=0.8, highest=0.9))


@pytest.mark.by_hand  # scripts of pages change hardly ever
def test_the_table_has_a_row_for_every_change():
    first, other = sensitivities({"surface.energy": (0.8,)})
    assert other.key == "surface.energy"
    assert other.value == pytest.approx(1.2)
    assert other.middle < first.middle - 0.05  # less sticky silicon may be worn further
    table = sensitivity_table([first, other])
    assert table.count("\n") == 4
    assert "-20 %" in table


def test_the_middle_of_a_bracket():
    assert Limit("x", 1.0, 1.1, 0.4, 0.5).middle == pytest.approx(0.45)
