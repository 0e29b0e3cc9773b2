"""The long run, kept short: nothing is miscounted, and what would be is seen."""

from __future__ import annotations

import dataclasses

import pytest

from gearidae.runs.estimates import steady_speed
from gearidae_bench.long import PARTS, long_page, long_rows, long_scene, measure_long, sound


@pytest.fixture(scope="module")
def parts():
    return measure_long(2000)


def test_nothing_is_lost_on_the_way(parts):
    assert sound(parts)
    # One passage at either end is a matter of where in the pitch the run begins and ends.
    assert abs(parts[-1].passages - 2000) <= 1
    passages = [part.passages for part in parts]
    assert 1 < len(parts) <= PARTS
    assert passages == sorted(set(passages))


def test_passages_are_alike_once_the_start_is_over(parts):
    """Scatter of a passage's time comes from the solver's tolerance, 1e-5: the start's alone is a millionth."""
    speed = steady_speed(long_scene(2000))
    for part in parts[1:]:
        assert part.scatter < 1e-6 * 28.5e-6
        # A part begins and ends anywhere in a passage, within which the speed varies by some 1e-4, and has 200 of them.
        assert part.speed == pytest.approx(parts[1].speed, rel=1e-5, abs=0)
        # What the balance of torques leaves out, adhesion and the work of the radii, is this small.
        assert part.speed == pytest.approx(speed, rel=1e-4, abs=0)
        assert part.integral == pytest.approx(
            part.speed * (part.time - _before(parts, part)), rel=1e-5, abs=0
        )


def _before(parts, part):
    return parts[parts.index(part) - 1].time


def test_what_is_lost_is_seen(parts):
    assert not sound([*parts, dataclasses.replace(parts[-1], miscounted=1)])
    assert not sound([*parts, dataclasses.replace(parts[-1], high=parts[-1].high + 0.5)])


def test_the_page_has_a_row_for_each_part(parts):
    heading, *rows = long_rows(parts)
    assert len(rows) == len(parts)
    assert all(len(row) == len(heading) for row in rows)
    page = long_page(parts)
    assert page.count("\n| ") == len(parts) + 2
    assert "Pairs out of sequence: 0." in page
