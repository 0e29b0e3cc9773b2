"""Runs that cannot go on end with a name, and with what they had."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import problem, solve
from gearidae.engine.run import Ending, ending_of_flag


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_chatter_ends_with_its_name_and_a_partial_result(backend, monkeypatch):
    monkeypatch.setattr(problem, "EVENTS_PER_TAU", 12)
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.45, "run.samples": 3001})
    run = solve(scene, backend=backend)
    assert run.status == "chatter"
    assert run.message
    assert 2 < len(run.time) < 3001
    assert all(len(values) == len(run.time) for values in run.samples.values())
    assert all(np.isfinite(values).all() for values in run.samples.values())
    assert run.events.time[-1] >= run.time[-1]


def test_every_flag_has_a_name():
    assert ending_of_flag(0) is Ending.FINISHED
    assert ending_of_flag(-3) is Ending.STEP_UNDERFLOW
    assert ending_of_flag(-4) is Ending.NO_CONVERGENCE
    assert ending_of_flag(-8) is Ending.SOLVER_FAILURE
    assert len({ending.status for ending in Ending}) == len(Ending)


def test_simulate_raises_with_the_partial_dataset(monkeypatch, tmp_path):
    monkeypatch.setattr(problem, "EVENTS_PER_TAU", 12)
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.45, "run.samples": 3001})
    target = tmp_path / "part.nc"
    with pytest.raises(gd.SolverError) as caught:
        gd.simulate(scene, archive=target)
    error = caught.value
    assert 0 < error.time < scene.run.duration
    assert "gear_speed" in error.state
    assert error.dataset.sizes["time"] > 2
    assert gd.open_archive(target).attrs["status"] == "chatter"
