"""What options cost: runs of one motion are compared, by the time of a step."""

import numpy as np
import pytest

from gearidae_bench import option_cost
from gearidae_bench.option_cost import COMPARISONS, Comparison, cost_table, measure_option


def test_a_ratio_is_that_of_the_times_of_steps(monkeypatch):
    """Known times, of which the slow ones come in pairs: half as many steps in the same time are twice the cost."""
    comparison = COMPARISONS[0]
    slow = iter(np.repeat([1.0, 1.0, 3.0, 3.0, 1.0, 1.0, 5.0, 5.0, 1.0, 1.0], 2))

    def run(scene):
        return 1e-3 * next(slow), 1000 if scene is comparison.plain else 500

    monkeypatch.setattr(option_cost, "_run", run)
    cost = measure_option(comparison, 9)
    assert (cost.steps, cost.other_steps) == (1000, 500)
    assert cost.ratio == pytest.approx(2.0)
    assert (cost.low, cost.high) == pytest.approx((2.0, 2.0))
    assert cost.nanoseconds == pytest.approx(1000.0)
    assert "| 1000, 500 | 1000 | 2.000 |" in cost_table([cost])


def test_exposures_leave_the_steps_alone():
    comparison = next(
        comparison for comparison in COMPARISONS if comparison.title == "exposures, low speed, 30%"
    )
    short = [scene.replace({"run.duration": 1e-3}) for scene in (comparison.plain, comparison.other)]
    cost = measure_option(Comparison(comparison.title, *short), 1)
    assert cost.steps == cost.other_steps > 100


def test_tables_are_of_the_uniform_fraction():
    for comparison in COMPARISONS:
        coating, plain = comparison.other.coating, comparison.plain.coating
        assert coating.fractions == pytest.approx(plain.fractions, abs=1e-15)
        assert coating.by_place == comparison.title.startswith("table")
