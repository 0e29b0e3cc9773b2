"""What trains cost: ratios of runs and of evaluations, of scenes in which the second mesh carries or does not touch."""

import numpy as np
import pytest

import gearidae as gd
from gearidae_bench import train_cost
from gearidae_bench.train_cost import TRAINS, cost_table, measure_trains


def test_ratios_are_those_of_runs_and_of_evaluations(monkeypatch):
    """A train that takes three times as long for six times the evaluations has half the cost of each."""
    known = {"pair": (1e-3, 100, 1000), "train": (3e-3, 50, 6000)}
    monkeypatch.setattr(train_cost, "_run", known.get)
    first, second = measure_trains(5, {"pair": "pair", "train": "train"})
    assert (first.run, first.evaluation) == (1.0, 1.0)
    assert (second.run, second.evaluation) == pytest.approx((3.0, 0.5))
    assert (second.low, second.high) == pytest.approx((3.0, 3.0))
    assert "| train | 50 | 6000 | 3 | 500 | 3.00 | 3.00 to 3.00 | 0.50 |" in cost_table([second])


def test_an_idle_mesh_leaves_the_pair_alone():
    """The same motion as that of the pair which it is compared with; the chain's second mesh carries."""
    titles = [*TRAINS]
    pair, idle, chain = (
        gd.simulate(TRAINS[titles[k]].replace({"run.samples": 3, "run.rtol": 1e-8}), t_end=2e-5)
        for k in (2, 3, 1)
    )
    np.testing.assert_allclose(idle["shaft_speed"][1], pair["gear_speed"], rtol=1e-6)
    assert float(idle["largest_mesh_force"][1]) == 0.0
    assert float(chain["largest_mesh_force"][1]) > 1e-7


def test_the_largest_train_is_measured_whole():
    scene = TRAINS[[*TRAINS][-1]]
    assert (len(scene.shafts), len(scene.meshes)) == (16, 15)
    seconds, steps, evaluations = train_cost._run(scene.replace({"run.duration": 1e-6}))
    assert seconds > 0.0
    assert evaluations > steps > 0
