"""Runs that cannot go on end with a name, and with what they had."""

from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.integrate.driver import ending_of_flag
from gearidae.engine.setup import build_torques
from gearidae.records import Ending

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_chatter_ends_with_its_name_and_a_partial_result(backend, monkeypatch):
    monkeypatch.setattr(build_torques, "ROOT_SPACING", 1e-2)
    monkeypatch.setattr(build_torques, "ROOT_LIMIT", 12)
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
    monkeypatch.setattr(build_torques, "ROOT_SPACING", 1e-2)
    monkeypatch.setattr(build_torques, "ROOT_LIMIT", 12)
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.45, "run.samples": 3001})
    target = tmp_path / "part.nc"
    with pytest.raises(gd.SolverError) as caught:
        gd.simulate(scene, archive=target)
    error = caught.value
    assert 0 < error.time < scene.run.duration
    assert "gear_speed" in error.state
    assert error.dataset.sizes["time"] > 2
    assert gd.open_archive(target).attrs["status"] == "chatter"


def test_marks_crossed_in_flight_are_no_chatter():
    """Gears that touch nothing pass thousands of mesh marks within one step."""
    scene = gd.preset("teodorescu2009").replace(
        {
            "mesh.backlash": 1e-6,
            "initial.gap": 5e-7,
            "drive.torque": 1e-19,
            "drive.harmonic": [],
            "load.torque": 0.0,
            "load.drag": 0.0,
            "run.duration": 0.1,
        }
    )
    run = solve(scene)
    assert run.status == "finished"
    assert len(run.events) > 10_000
    assert len(run.events) > 2 * run.statistics.steps


def test_a_contact_beyond_the_force_laws_tables_says_so():
    scene = gd.preset("roller_fast").replace({"contact.bodies": "rigid", "roller.speed": 60.0})
    run = solve(scene)
    assert run.status == "deflection"
    assert "elastic" in run.message
    assert run.samples["height"].min() > -45 * scene.surface.roughness


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_run_may_end_at_an_event(backend):
    """At the time of an event as it was found in a longer run, and a rounding error before and after it."""
    scene = gd.preset("teodorescu2009").replace({"run.duration": 2e-5, "run.samples": 3, "run.rtol": 1e-5})
    for time in np.unique(solve(scene, backend=backend).events.time)[:12]:
        for end in (np.nextafter(time, 0.0), time, np.nextafter(time, 1.0)):
            run = solve(scene.replace({"run.duration": float(end)}), backend=backend)
            assert run.status == "finished"
            assert run.time[-1] == end


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_events_at_checkpoints_are_found(backend):
    """A stop at the time of each event, as it was found without the stops before it."""
    scene = gd.preset("teodorescu2009").replace({"run.duration": 2e-5, "run.samples": 3, "run.rtol": 1e-5})
    without = solve(scene, backend=backend).events
    times = np.unique(without.time)
    stopped = solve(scene.replace({"run.checkpoints": times.tolist()}), backend=backend)
    assert stopped.status == "finished"
    assert stopped.events.kind[:12].tolist() == without.kind[:12].tolist()


def test_the_shipped_case_at_high_speed_ends_at_every_tolerance():
    """At 1e-5 a flank turns round at the end itself."""
    scene = gd.load_case(CASES / "high_speed.toml").replace({"run.samples": 2})
    for rtol in (1e-4, 1e-5, 1e-6):
        assert solve(scene.replace({"run.rtol": rtol})).status == "finished"


@pytest.mark.parametrize(("backend", "method"), [("native", "auto"), ("native", "bdf"), ("sksundae", "auto")])
def test_the_smallest_tolerance_runs_on_for_many_pitches(backend, method):
    """The phase is then held to 1e-15 pitches: it is kept so small that rounding does not reach that."""
    flight = {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "drive.torque": 0.0, "drive.harmonic": []}
    flight |= {"load.torque": 0.0, "load.drag": 0.0, "run.duration": 5e-4, "run.samples": 3}
    scene = gd.preset("teodorescu2009").replace(flight | {"run.rtol": 1e-12, "run.method": method})
    run = solve(scene, backend=backend)
    assert run.status == "finished"
    assert run.extremes.mesh_exits > 16
    turned = run.samples["gear_angle"][-1] - run.samples["gear_angle"][0]
    assert turned == pytest.approx(2898.0 * 5e-4, rel=1e-11, abs=0)
