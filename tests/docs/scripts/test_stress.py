"""The page of random scenes counts endings and lists what is far off."""

from datetime import date

import pytest

from gearidae_pages.stress import balance_quantiles, counts, page, quantiles, worst
from reference.random_runs import Outcome


def test_the_page_counts_and_lists():
    outcomes = [
        Outcome(0, "finished", rtol=1e-6, error=1e-5, imbalance=3e-6, steps=10, reached=1.0),
        Outcome(1, "budget", rtol=1e-6, error=1e-3),
        Outcome(2, "finished", complaint="force is off", rtol=1e-6),
        Outcome(3, "refused", "surface.roughness = 0: must be above 0"),
    ]
    assert counts(outcomes) == {"finished": 2, "budget": 1, "refused": 1}
    assert quantiles(outcomes)[1.0] == pytest.approx(1000.0)
    assert balance_quantiles(outcomes)[1.0] == pytest.approx(3.0)
    assert [o.number for o in worst(outcomes)] == [2, 1, 0]
    text = page(outcomes, 7, date(2026, 1, 2))
    assert "Failed checks: 1" in text
    assert "2026-01-02" in text
    assert "--runs 4 --seed 7" in text
    assert "force is off" in text
    assert "| refused | 1: 3 |" in text
    many = page([Outcome(k, "finished", rtol=1e-6) for k in range(8)], 7, date(2026, 1, 2))
    assert "| finished | 8 |" in many
