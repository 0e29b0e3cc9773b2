"""A run whose contacts have become light returns from elastic bodies to the asperity model."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import backend, outlook, solve
from gearidae.engine.backend import run_blocks
from gearidae.engine.changeover import to_rigid
from gearidae.engine.elastic.node_rows import first_unknown
from gearidae.engine.model.state import EMPTY, STATE, V
from gearidae.engine.pairs.tooth_pairs import nearest_gap
from gearidae.engine.setup import build
from gearidae.engine.setup.build import make_problem
from gearidae.records import Ending, EventKind, Flank, Statistics
from same import assert_same

HIGH = gd.preset("teodorescu2009")
SCENE = HIGH.replace(  # the first impact is deep, and no other
    {
        "coating.sam_fraction": 0.94,
        "initial.mesh_phase": 0.8,
        "run.duration": "0.2 ms",
        "run.samples": 401,
    }
)
NOT_CARRIED = {"rigid_again", "energy", "history"}


@pytest.fixture
def changes(monkeypatch):
    """Times at which a run changes its contact model, in the order of the changes."""
    switches = []

    def note(name):
        change = getattr(backend, name)

        def noted(old, new, checkpoint):
            switches.append((name, old.restore(checkpoint, np.empty(old.start.size)) * old.time_unit))
            return change(old, new, checkpoint)

        monkeypatch.setattr(backend, name, noted)

    note("change_over")
    note("to_rigid")
    return switches


def run(scene, driver, resume=None):
    samples = scene.run.sample_count
    statistics = Statistics()
    blocks = []
    for block in run_blocks(make_problem(scene), scene.run.rtol, samples, driver, statistics, resume):
        assert statistics.ending not in (
            Ending.DEFLECTION,
            Ending.LIGHT,
        )  # a change of the contact model is no ending
        blocks.append(block)
    return blocks


def rows_of(blocks):
    return np.concatenate([block.rows for block in blocks])


def test_auto_decides_with_friction_too(changes):
    """Bodies become elastic in a deep impact, and what was computed is in the dataset."""
    hubs = {"gears.hub_friction": 0.2, "gears.pinion_hub_radius": "3 um", "gears.gear_hub_radius": "6 um"}
    deep = {"initial.gap": "70 nm", "run.duration": "0.05 ms"}
    scene = SCENE.replace({"contact.friction": 0.3, "coating.friction": 0.1, **hubs, **deep})
    ds = gd.simulate(scene)
    assert "change_over" in [name for name, _ in changes]
    assert ds.attrs["contact_bodies"] == "elastic"
    assert ds.attrs["contact_bodies_reason"].startswith("auto: ")
    balance = ds.gearidae.energy_balance
    assert abs(balance["residual"]) < balance["residual_bound"]
    assert balance["drive_friction_loss"] > 0.0
    rigid = gd.simulate(scene.replace({"contact.bodies": "rigid", "run.duration": 1e-6}))
    assert rigid.attrs["contact_bodies"] == "rigid"
    assert rigid.attrs["contact_bodies_reason"] == ""
    stays = gd.simulate(scene.replace({"contact.roughness": "discrete", "run.duration": 1e-6}))
    assert stays.attrs["contact_bodies"] == "rigid"
    assert stays.attrs["contact_roughness"] == "discrete"
    assert stays.attrs["contact_bodies_reason"].startswith("auto stays rigid: discrete asperities")


@pytest.mark.parametrize("driver", ["native", "sksundae"])
def test_a_run_with_one_deep_impact_is_elastic_for_as_long_as_it_matters(changes, driver, monkeypatch):
    solution = solve(SCENE, backend=driver)
    assert [name for name, _ in changes] == ["change_over", "to_rigid"]
    of_drive = (solution.events.kind == EventKind.MESH_EXIT) & (solution.events.flank == Flank.DRIVE)
    exits = solution.events.time[of_drive]
    deep, light = (time for _, time in changes)
    assert light == pytest.approx(exits[exits > deep][3], rel=1e-12, abs=0)  # the fourth exit since
    assert solution.statistics.skipped["elastic_deflection"] == 0
    monkeypatch.setattr(build, "LIGHTER", np.inf)
    stays = solve(SCENE, backend=driver)
    assert len(changes) == 3  # it has changed to elastic bodies once more, and not returned
    speed, other = (run.samples["gear_speed"] for run in (solution, stays))
    np.testing.assert_array_equal(speed[solution.time < light], other[solution.time < light])
    # from then on contacts differ by what deflections below a fiftieth of the roughness do to them
    np.testing.assert_allclose(speed, other, rtol=0, atol=1e-3 * np.ptp(other))
    assert abs(solution.balance.residual) < solution.balance.bound(SCENE.run.rtol, roller=False)
    assert 0.0 < abs(solution.balance.model_change) < 1e-4 * solution.balance.throughput


def test_four_exits_are_counted_from_the_last_deep_contact(changes):
    torque = 10.0 * SCENE.drive.torque  # for a microsecond, after the second exit
    knots = [[60e-6, 0.0], [60.1e-6, torque], [61e-6, torque], [61.1e-6, 0.0]]
    solution = solve(SCENE.replace({"drive.schedule": knots, "run.samples": "off"}))
    of_drive = (solution.events.kind == EventKind.MESH_EXIT) & (solution.events.flank == Flank.DRIVE)
    exits = solution.events.time[of_drive]
    assert exits[1] < knots[0][0] < exits[2]
    assert [name for name, _ in changes] == ["change_over", "to_rigid"]
    assert changes[1][1] == pytest.approx(exits[5], rel=1e-12, abs=0)


@pytest.mark.parametrize("driver", ["native", pytest.param("sksundae", marks=pytest.mark.by_hand)])
def test_a_run_can_be_resumed_before_between_and_after_the_changes(changes, driver):
    whole = run(SCENE, driver)
    rows, seen = rows_of(whole), set()
    for k, block in enumerate(whole):
        if block.checkpoint is None:
            continue
        changes.clear()
        rest = run(SCENE, driver, block.checkpoint)
        made = tuple(name for name, _ in changes)
        seen.add(made)
        parts = [piece.rows for piece in (*whole[: k + 1], *rest)]
        np.testing.assert_array_equal(np.concatenate(parts), rows)
        assert_same((rest[-1] if rest else whole[-1]).extremes, whole[-1].extremes)
        assert outlook(SCENE, driver, block.checkpoint)[0]["elastic_deflection"] == made.count("change_over")
    assert seen == {("change_over", "to_rigid"), ("to_rigid",), ()}


def test_a_run_that_goes_on_is_equal_to_one_without_a_break():
    """Also where the break is in the elastic part: what has been deep is known to the run that goes on."""
    scene = SCENE.replace({"run.samples": "off"})
    whole = solve(scene)
    for share in (0.2, 0.8):
        first = scene.replace({"run.duration": share * scene.run.duration})
        second = scene.replace({"run.duration": (1.0 - share) * scene.run.duration})
        begun = solve(first)
        start = gd.engine.end_of(first, begun.checkpoint, 0.0)
        continued = solve(second, start=start)
        # a break restarts the solver: equal within what its tolerance does
        assert continued.extremes.final_speed == pytest.approx(whole.extremes.final_speed, rel=1e-5, abs=0)
        assert continued.statistics.skipped["elastic_deflection"] == int(share > 0.5)


FREE = {
    "drive.torque": 1e-18,
    "drive.harmonic": [],
    "load.torque": 0.0,
    "load.drag": 0.0,
    "initial.gap": "100 nm",
}


@pytest.mark.parametrize("flight", [{}, FREE])
def test_elastic_bodies_that_were_asked_for_stay(changes, flight):
    """Also where nothing touches at all."""
    asked = solve(SCENE.replace({"contact.bodies": "elastic", "run.duration": "0.15 ms", **flight}))
    assert asked.status == "finished"
    assert asked.extremes.mesh_exits > 4
    assert (asked.statistics.skipped["flight_steps"] > 0) == bool(flight)
    assert changes == []


@pytest.fixture(scope="module")
def returned():
    """Elastic problem where its contacts have been light for long, the asperity problem that goes on, and its state."""
    problem = make_problem(SCENE)
    resume = None
    for block in run_blocks(problem, SCENE.run.rtol, 401, "native", Statistics()):
        if block.checkpoint is not None and make_problem(SCENE).of_checkpoint(block.checkpoint).depth > 0:
            resume = block.checkpoint
    problem = make_problem(SCENE)
    bodies = problem.of_checkpoint(resume)
    for prepared in (problem, bodies):
        prepared.prepare(SCENE.run.rtol, 401)
    assert bodies.rigid_again(resume)
    went_on = to_rigid(bodies, problem, resume)
    state, y = np.empty(bodies.start.size), np.empty(problem.start.size)
    bodies.restore(resume, state)
    problem.restore(went_on, y)
    return bodies, state, problem, y


def test_motion_and_state_are_kept(returned):
    bodies, state, problem, y = returned
    np.testing.assert_array_equal(y, state[: y.size])
    old, new = bodies.model.state, problem.model.state
    for name in set(STATE.names) - NOT_CARRIED:
        np.testing.assert_array_equal(new[name], old[name], err_msg=name)
    assert (old.rigid_again, new.rigid_again) == (1, 0)


def test_stretch_in_the_middle_is_kept(returned):
    bodies, state, problem, _ = returned
    m, rigid = bodies.model, problem.model
    pairs = 0
    for k in range(int(m.scene.histories)):
        h = m.state.history[k]
        if h.pair == EMPTY:
            continue
        pairs += 1
        coast = k // int(m.scene.slots)
        slots = int(rigid.scene.slots)
        other = rigid.state.history[coast * slots + (int(h.pair) & (slots - 1))]
        assert (other.pair, other.gap, other.direction) == (h.pair, h.gap, h.direction)
        middle = float(h.gap) + float(state[first_unknown(m, k)])
        for material in range(2):
            limit = float(rigid.scene.material[material].stretch_limit)
            stretch = np.clip(
                middle - float(h.joined[material]), 0.0 if h.direction > 0.0 else -np.inf, limit
            )
            assert float(other.gap - other.joined[material]) == pytest.approx(stretch, rel=0, abs=1e-12)
    assert pairs > 0
    assert np.isfinite(state[V])


def test_a_contact_that_is_light_is_above_the_bound(returned):
    bodies, _, problem, y = returned
    assert nearest_gap(problem.model, 0, y) > float(problem.model.scene.lowest_gap)
    assert float(bodies.model.scene.light_gap) == float(problem.model.scene.lowest_gap) + 0.25
