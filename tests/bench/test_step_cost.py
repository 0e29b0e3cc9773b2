"""What a step costs, by part: the readings' own time is taken off, and every part has what no part within it has."""

import pytest

from gearidae_bench.step_cost import PARTS, _costs, cost_table


def test_parts_are_found_from_what_was_read():
    """Known times; of the 15 cycles of both readings 3 lie between them."""
    part_times = {part.label: 10.0 * (k + 1) for k, part in enumerate(PARTS)}
    calls = {part.label: k + 1 for k, part in enumerate(PARTS)}
    steps, between, reading, left, per_ns = 4, 3.0, 15.0, 1000.0, 2.5
    gross: dict[str, float] = {}
    for part in reversed(PARTS):  # those within come first
        inside = [other.label for other in PARTS if other.inside == part.label]
        within = sum(gross[name] + calls[name] * (reading - between) for name in inside)
        gross[part.label] = part_times[part.label] + calls[part.label] * between + within
    outer = [part.label for part in PARTS if not part.inside]
    cycles = left + sum(gross[name] + calls[name] * (reading - between) for name in outer)
    timing = {
        "steps": steps,
        "cycles": cycles,
        "between": between,
        "reading": reading,
        "spent": [gross[part.label] for part in PARTS],
        "calls": [calls[part.label] for part in PARTS],
    }
    whole = (sum(part_times.values()) + left) / per_ns / steps
    costs = _costs(timing, whole)
    assert [cost.nanoseconds for cost in costs[:-1]] == pytest.approx(
        [part_times[part.label] / per_ns / steps for part in PARTS]
    )
    assert costs[-1].nanoseconds == pytest.approx(left / per_ns / steps)
    assert costs[3].calls == calls[PARTS[3].label] / steps
    lines = cost_table(costs, whole).splitlines()
    assert len(lines) == len(PARTS) + 5
    residual = part_times["residual and slopes"] / per_ns / calls["residual and slopes"]
    assert f"| 1 | {residual:.0f} |" in lines[-1]
