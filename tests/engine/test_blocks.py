"""Cutting a run into blocks changes nothing; resuming from a checkpoint neither."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import drivers, native, portable, solve, step
from gearidae.engine.backend import run_blocks
from gearidae.engine.events.record import EVENTS_AT_ONCE
from gearidae.engine.integrate import driver, start
from gearidae.engine.model.state import PHASE
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics
from same import assert_same

SCENE = gd.preset("teodorescu2009_low_speed").replace(
    {"coating.sam_fraction": 0.5, "run.duration": 5e-3, "run.samples": 301}
)
FAST = gd.preset("teodorescu2009").replace({"contact.bodies": "rigid"})


def collect(blocks):
    parts = list(blocks)
    return np.concatenate([b.rows for b in parts]), np.concatenate([b.events for b in parts]), parts


@pytest.fixture(params=["native", "sksundae"])
def backend(request):
    return request.param


@pytest.mark.parametrize("room", [driver.BLOCK_EVENTS, EVENTS_AT_ONCE + 1])
def test_small_blocks_hold_the_same_run(backend, room, monkeypatch):
    """Full of samples, or of events: the second has room for two, and for what may come at once."""
    whole = collect(run_blocks(make_problem(SCENE), 1e-6, 301, backend, Statistics()))
    monkeypatch.setattr(driver, "BLOCK_ROWS", 7)
    monkeypatch.setattr(driver, "BLOCK_EVENTS", room)
    if backend == "native":
        monkeypatch.setattr(native, "BLOCK_STEPS", 13)
        monkeypatch.setattr(native, "FIRST_STEPS", 13)
    pieces = collect(run_blocks(make_problem(SCENE), 1e-6, 301, backend, Statistics()))
    assert len(pieces[2]) > 40
    assert max(len(block.rows) for block in pieces[2]) <= 7
    assert max(len(block.events) for block in pieces[2]) < len(whole[1])
    np.testing.assert_array_equal(pieces[0], whole[0])
    np.testing.assert_array_equal(pieces[1], whole[1])


def test_runs_that_take_turns_have_rooms_of_their_own_which_later_ones_use(monkeypatch):
    """What one writes into its room is not seen in another's blocks; a third takes the room of one that has ended."""
    monkeypatch.setattr(driver, "_rooms", {})
    monkeypatch.setattr(native, "FIRST_STEPS", 13)
    monkeypatch.setattr(native, "BLOCK_STEPS", 13)
    scenes = (SCENE, SCENE.replace({"drive.torque": 5e-18}))

    def begin(scene):
        return run_blocks(make_problem(scene), 1e-6, 301, "native", Statistics())

    turns = list(itertools.zip_longest(*map(begin, scenes)))
    assert len(turns) > 10
    for parts, scene in zip(zip(*turns, strict=True), scenes, strict=True):
        alone = collect(begin(scene))
        np.testing.assert_array_equal(np.concatenate([block.rows for block in parts if block]), alone[0])
    assert [len(rooms) for rooms in driver._rooms.values()] == [2]


def test_a_block_of_slow_steps_ends_after_a_few(monkeypatch):
    """Blocks seem to take a second: all have one step, as the first of costly scenes, and the tiny run few blocks."""
    monkeypatch.setattr(native, "FIRST_STEPS", 1)
    clock = itertools.count()
    monkeypatch.setattr(native, "time", SimpleNamespace(monotonic=lambda: float(next(clock))))
    statistics = Statistics()
    blocks = run_blocks(make_problem(SCENE), 1e-6, 301, "native", statistics)
    steps = [statistics.steps for _ in itertools.islice(blocks, 20)]
    assert np.diff([0, *steps]).max() == 1  # a step that ends at an event may be another's end
    blocks.close()
    monkeypatch.setattr(drivers, "_ready", set())
    began = next(clock)
    drivers.ready_driver("native", make_problem(SCENE))
    assert (next(clock) - began - 1) / 2 <= drivers.COMPILING_BLOCKS


COUNTS = ("steps", "residual_evaluations", "jacobian_evaluations", "guard_evaluations", "error_test_failures")


def test_a_block_knows_the_steps_of_the_run_so_far(backend, monkeypatch):
    """A run may be stopped after any block, and says then what it has done; nothing is counted twice."""
    whole = Statistics()
    collect(run_blocks(make_problem(SCENE), 1e-6, 301, backend, whole))
    monkeypatch.setattr(native, "BLOCK_STEPS", 13)
    monkeypatch.setattr(native, "FIRST_STEPS", 13)
    monkeypatch.setattr(portable, "BLOCK_SECONDS", 0.0)  # a block for each step
    cut = Statistics()
    blocks = run_blocks(make_problem(SCENE), 1e-6, 301, backend, cut)
    seen = [[getattr(cut, name) for name in COUNTS] for _ in blocks]
    assert len(seen) > 40
    gained = np.diff([[0] * len(COUNTS), *seen], axis=0)
    assert (gained >= 0).all()
    assert gained[:, 0].max() <= 13
    assert gained[0, :4].min() > 0
    assert seen[-1] == [getattr(whole, name) for name in COUNTS]
    assert cut.convergence_failures == whole.convergence_failures


@pytest.mark.parametrize("steps", [7, 100])
@pytest.mark.parametrize("by_place", [False, True])
def test_sums_do_not_depend_on_where_they_are_looked_at(steps, by_place, monkeypatch):
    """How many steps a block has depends on how long they take."""
    scene = FAST.replace({"coating.sam_fraction": 0.6, "run.exposures": 3, "run.duration": 2e-5})
    if by_place:
        scene = scene.replace({"coating.pinion_table": np.full((19, 4), 0.6)})
    whole = solve(scene, samples="off")
    monkeypatch.setattr(native, "BLOCK_STEPS", steps)
    monkeypatch.setattr(native, "FIRST_STEPS", steps)
    looks = []
    cut = solve(scene, samples="off", backend="native", on_block=looks.append)
    assert len(looks) > 10
    assert_same(cut.balance, whole.balance)
    assert_same(cut.extremes, whole.extremes)


def test_a_resumed_run_is_the_same_run(monkeypatch):
    """Through scikit-sundae, where the distance of checkpoints is not compiled in; one is taken every 150 steps."""
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", 150)
    statistics = Statistics()
    rows, events, blocks = collect(run_blocks(make_problem(SCENE), 1e-6, 301, "sksundae", statistics))
    stops = [i for i, b in enumerate(blocks) if b.checkpoint is not None][:-1]
    assert len(stops) >= 3
    for stop in stops:
        again = Statistics()
        rest = collect(run_blocks(make_problem(SCENE), 1e-6, 301, "sksundae", again, blocks[stop].checkpoint))
        before = blocks[: stop + 1]
        np.testing.assert_array_equal(np.concatenate([*(b.rows for b in before), rest[0]]), rows)
        np.testing.assert_array_equal(np.concatenate([*(b.events for b in before), rest[1]]), events)
        assert again == statistics


def test_a_native_run_resumes_exactly():
    scene = FAST.replace({"coating.sam_fraction": 0.3, "run.duration": 4e-3, "run.samples": 2001})
    statistics = Statistics()
    rows, events, blocks = collect(run_blocks(make_problem(scene), 1e-6, 2001, "native", statistics))
    (stop, *_) = [i for i, b in enumerate(blocks) if b.checkpoint is not None]
    assert stop < len(blocks) - 1
    again = Statistics()
    rest = collect(run_blocks(make_problem(scene), 1e-6, 2001, "native", again, blocks[stop].checkpoint))
    before = blocks[: stop + 1]
    np.testing.assert_array_equal(np.concatenate([*(b.rows for b in before), rest[0]]), rows)
    np.testing.assert_array_equal(np.concatenate([*(b.events for b in before), rest[1]]), events)
    assert again == statistics


def test_a_foreign_checkpoint_is_refused():
    with pytest.raises(gd.SceneError, match="checkpoint"):
        list(run_blocks(make_problem(SCENE), 1e-6, 301, "native", Statistics(), np.zeros(5)))


def test_phase_is_taken_back_without_a_trace(monkeypatch):
    """Whole pitches move out of the phase now and then; angle, pairs and motion go on as if nothing had been."""
    plain = solve(FAST, rtol=1e-7, t_end=1.6e-4, samples=401, backend="sksundae")
    finish = portable.finish_step_at
    monkeypatch.setattr(
        portable,
        "finish_step_at",
        lambda place, t, y, *rest: finish(place, t, y, *rest) or abs(y[PHASE]) > 5.0,
    )
    monkeypatch.setattr(portable, "prepare_restart", step.prepare_restart.py_func)
    monkeypatch.setattr(step, "rebase", _rebase_now)
    shifted = solve(FAST, rtol=1e-7, t_end=1.6e-4, samples=401, backend="sksundae")
    assert shifted.statistics.restarts > 0
    # each restart changes the steps, and with them the error: some hundred times the tolerance of 1e-7 per step
    for name in ("gear_speed", "gear_angle", "transmission_error"):
        swing = np.ptp(plain.samples[name])
        np.testing.assert_allclose(shifted.samples[name], plain.samples[name], atol=5e-5 * swing)
    passages = [r.events.pair[np.isin(r.events.kind, (4, 5))] for r in (plain, shifted)]
    np.testing.assert_array_equal(*passages)


def _rebase_now(m, y):
    kept, m.scene.phase_high = float(m.scene.phase_high), 5.0
    start.rebase.py_func(m, y)
    m.scene.phase_high = kept
