"""What the defaults of a run cost: ratios to runs of the same round, and observers that move nothing."""

import pytest

from gearidae.scene import preset
from gearidae_bench import default_cost
from gearidae_bench.default_cost import CHOICES, default_scenes, default_table, measure_defaults


def test_a_ratio_is_that_of_the_times_of_one_round(monkeypatch):
    """Rounds on a machine that becomes slower and slower: the ratio of each is that of the choice."""
    factor = {(): 1.0, **{kept: 1.0 + 0.1 * len(kept) for kept in CHOICES.values()}}
    made = []

    def run(problem, rtol):
        kept = tuple(
            name for name in ("balance", "extremes", "passages", "gear") if problem.model.scene.follow[name]
        )
        made.append(kept)
        slow = 1 + (len(made) - 1) // (1 + len(CHOICES))
        return default_cost._Run(slow * factor[kept], 1000, 0.5, 0.25)

    monkeypatch.setattr(default_cost, "_run", run)
    (cost,) = measure_defaults({"some": preset("teodorescu2009")}, 4)
    assert cost.ratios == pytest.approx({choice: factor[kept] for choice, kept in CHOICES.items()})
    assert made.count(CHOICES["all"]) == 5
    row = default_table([cost]).splitlines()[-1]
    assert row.startswith("| some | 1000 |")
    assert row.endswith("| 1.10 | 1.20 | 1.10 | 1.40 | 0.0e+00 | 0.25 |")


def test_observers_leave_motion_and_steps_alone():
    scene = preset("teodorescu2009").replace({"run.duration": 2e-5, "run.samples": 2})
    runs = [
        default_cost._run(default_cost.alone(default_cost.make_problem(scene), *kept), 1e-6)
        for kept in ((), *CHOICES.values())
    ]
    assert len({(run.steps, run.angle) for run in runs}) == 1
    assert runs[-1].residual < 1.0


def test_rows_have_starts_stops_and_the_gears_of_the_benchmark():
    names = " ".join(default_scenes())
    assert all(word in names for word in ("start_up", "braking", "low speed", "high speed"))
