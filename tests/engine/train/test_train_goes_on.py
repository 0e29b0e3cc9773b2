"""Trains that go on: where they were interrupted, to the last bit, and where another run has ended."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from tests.engine.train.test_train_motion import adhering, rubbing, stopping, wavy
from tests.reference.trains import chain, split

import gearidae as gd
from gearidae.archive import open_archive
from gearidae.archive.journal import journal_of
from gearidae.archive.train import journal as train_journal
from gearidae.engine.train import end_of_train, solve_train
from gearidae.engine.train import solve as solving
from gearidae.errors import Interrupted, SceneError
from gearidae.records import EventKind
from gearidae.scene import Scene

BACKENDS = ("native", "sksundae")
MOMENTARY = ("history", "date_created", "wall_time", "source")
FLANKS = rubbing(contact={"bodies": "rigid", "asperity": "hertz", "friction": 0.3})
"""Hubs and flanks with friction."""


def scene_of(tables, end, samples=61, **changes):
    """A train that runs to a time."""
    return Scene.from_dict(tables).replace({"run.duration": end, "run.samples": samples, **changes})


@pytest.fixture
def small_blocks(monkeypatch):
    """Blocks of few steps, of which a short run has several."""
    monkeypatch.setattr(solving, "STEPS", 100)
    monkeypatch.setattr(solving, "PORTABLE_STEPS", 400)


def numbers(solution):
    """All numbers of a solution, by names."""
    tables = (solution.samples, solution.events, solution.shaft_totals, solution.mesh_totals, solution.rests)
    named = {name: values for table in tables for name, values in table.items()}
    return {**named, **solution.energy, "reached": solution.reached, "shared_time": solution.time}


def differing(one, other):
    """Names of the numbers in which two solutions differ."""
    mine, theirs = numbers(one), numbers(other)
    assert mine.keys() == theirs.keys()
    return [name for name in mine if not np.array_equal(mine[name], theirs[name], equal_nan=True)]


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "tables",
    [rubbing(), adhering(), split(), wavy(), FLANKS],
    ids=["hubs", "adhesion", "loop", "error", "flanks"],
)
def test_a_resumed_run_is_the_whole_run_to_the_last_bit(tables, backend):
    blocks = []
    scene = scene_of(tables, 60e-6 if backend == "native" else 8e-6)
    whole = solve_train(scene, backend=backend, on_block=blocks.append)
    assert whole.status == "finished"
    assert len(blocks) > 2
    for number in (1, len(blocks) // 2, len(blocks) - 1):
        assert not differing(whole, solve_train(scene, backend=backend, blocks=blocks[:number]))
    assert not differing(whole, solve_train(scene, backend=backend))  # who looks on changes nothing


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("tables", "half"),
    [(rubbing(), 40e-6), (adhering(), 60e-6), (split(), 30e-6), (stopping(), 92.5e-6), (FLANKS, 30e-6)],
    ids=["hubs", "adhesion", "loop", "held", "flanks"],
)
def test_a_continued_run_is_the_whole_run(tables, half, backend):
    """Times, angles, works and extremes go on; the steps are others, which costs a tolerance each."""
    if backend == "sksundae":
        half *= 0.2
    rtol = 1e-9
    whole = solve_train(scene_of(tables, 2.0 * half, 201, **{"run.rtol": rtol}), backend=backend)
    scene = scene_of(tables, half, 101, **{"run.rtol": rtol})
    first = solve_train(scene, backend=backend)
    second = solve_train(scene, backend=backend, start=end_of_train(scene, first.checkpoint, 0.0))
    # a run ends at its duration, which the grid of samples may have in another last digit
    np.testing.assert_allclose(np.concatenate([first.time, second.time[1:]]), whole.time, rtol=1e-15)
    # vibrations of the contacts grow errors by some hundred tolerances within a run
    close = 1e3 * rtol
    for name in ("shaft_speed", "shaft_angle", "hub_load"):
        joined = np.concatenate([first.samples[name], second.samples[name][:, 1:]], axis=1)
        scale = np.abs(whole.samples[name]).max()
        np.testing.assert_allclose(joined, whole.samples[name], rtol=close, atol=close * scale)
    np.testing.assert_array_equal(
        np.concatenate([first.events["kind"], second.events["kind"]]), whole.events["kind"]
    )
    for table in ("shaft_totals", "mesh_totals"):
        for name, values in getattr(whole, table).items():
            scale = np.abs(values).max()
            np.testing.assert_allclose(
                getattr(second, table)[name], values, rtol=1e3 * close, atol=1e3 * close * scale, err_msg=name
            )
    assert abs(second.energy["residual"]) <= second.energy["residual_bound"]
    assert second.energy["drive_work"] == pytest.approx(whole.energy["drive_work"], rel=close, abs=0.0)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("tables", "half"),
    [
        (rubbing(), 2.0**-15),
        (adhering(), 2.0**-14),
        (split(), 2.0**-15),
        (stopping(), 2.0**-13),
        (FLANKS, 2.0**-15),
    ],
    ids=["hubs", "adhesion", "loop", "held", "flanks"],
)
def test_a_run_cut_at_a_checkpoint_is_the_whole_run_to_the_last_bit(tables, half, backend):
    if backend == "sksundae":
        half *= 0.25
    kept = {"run.checkpoints": [0.5 * half, half]}
    blocks = []
    whole = solve_train(scene_of(tables, 2.0 * half, 129, **kept), backend=backend, on_block=blocks.append)
    assert {0.5 * half, half} <= {block.time for block in blocks}
    scene = scene_of(tables, half, 65, **kept)
    first = solve_train(scene, backend=backend)
    second = solve_train(scene, backend=backend, start=end_of_train(scene, first.checkpoint, 0.0))
    for name, values in whole.samples.items():
        joined = np.concatenate([first.samples[name], second.samples[name][..., 1:]], axis=-1)
        np.testing.assert_array_equal(joined, values, err_msg=name)
    for name, values in whole.events.items():
        joined = np.concatenate([first.events[name], second.events[name]])
        np.testing.assert_array_equal(joined, values, err_msg=name)
    for table in ("shaft_totals", "mesh_totals"):
        for name, values in getattr(whole, table).items():
            np.testing.assert_array_equal(getattr(second, table)[name], values, err_msg=name)
    assert second.energy == whole.energy
    assert second.reached == whole.reached


CHANGES = {
    "torque": {"drive.torque": 6e-12},
    "dry load": {"load.torque": 1e-11},
    "no dry load": {"load.torque": 0.0},
    "schedule": {"drive.schedule": [[0.0, 0.0], [1e-4, 5e-12]]},
    "coating": {"meshes.m2.coating.sam_fraction": 0.8, "coating.energy": 0.03},
    "no balance": {"run.balance": False},
    "tolerance": {"run.rtol": 1e-8},
    "slots": {"meshes.m2.coating.thickness": 2e-9},
}


@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_other_torques_and_coatings_go_on_from_the_same_motion(changes):
    scene = scene_of(adhering(), 40e-6, 41)
    first = solve_train(scene)
    other = scene.replace(changes)
    second = solve_train(other, start=end_of_train(scene, first.checkpoint, 0.0))
    assert second.status == "finished"
    assert second.start == 40e-6
    for name in ("shaft_speed", "shaft_angle", "transmission_error"):
        np.testing.assert_array_equal(second.samples[name][:, 0], first.samples[name][:, -1])
    if other.run.balance:
        assert abs(second.energy["residual"]) <= second.energy["residual_bound"]
        assert second.energy["drive_work"] != first.energy["drive_work"]
    else:
        assert math.isnan(second.energy["residual"])


@pytest.mark.parametrize("end", [21e-6, 33e-6, 40e-6, 52e-6])
def test_a_balance_that_begins_later_closes(end):
    """Contacts close at some of these times: what they have lost by then is not of this balance."""
    scene = scene_of(adhering(), end, 41)
    first = solve_train(scene.replace({"run.balance": False}))
    start = end_of_train(scene.replace({"run.balance": False}), first.checkpoint, 0.0)
    second = solve_train(scene, start=start)
    assert abs(second.energy["residual"]) <= second.energy["residual_bound"]


def test_a_held_shaft_is_let_go_by_a_larger_torque():
    scene = scene_of(stopping(), 120e-6, 61)
    first = solve_train(scene)
    assert first.rests["end"][-1] == 120e-6  # some shaft is held at the end
    start = end_of_train(scene, first.checkpoint, 0.0)
    held = solve_train(scene, start=start)
    driven = solve_train(scene.replace({"drive.torque": 2e-11}), start=start)
    assert np.ptp(held.samples["shaft_angle"][2]) < 1e-9
    assert driven.samples["shaft_speed"][2, -1] > 1.0
    # since when a shaft has been at rest goes on
    number = held.rests["shaft"].tolist().index(2)
    assert held.rests["begin"][number] == first.rests["begin"][first.rests["shaft"].tolist().index(2)]
    assert held.shaft_totals["rest_time"][2] == pytest.approx(first.shaft_totals["rest_time"][2] + 120e-6)


def test_a_run_ends_after_so_many_turns_of_its_own():
    scene = scene_of(chain(), 1e-3, 11, **{"run.stop": "turns 0.01"})
    first = solve_train(scene)
    second = solve_train(scene, start=end_of_train(scene, first.checkpoint, 0.0))
    turn = 0.01 * 2.0 * math.pi
    for solution in (first, second):
        speeds = solution.samples["shaft_speed"][2]
        ways = solution.reached - solution.start
        assert turn / speeds.max() < ways * 1.2
        assert solution.reached < solution.start + 1e-3


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [
        ("shafts.idler.inertia", 1e-19, "shafts.idler.inertia"),
        ("meshes.second.angle", 0.5, "meshes.second.angle"),
        ("meshes.first.phase", 0.4, "meshes.first.phase"),
        ("mesh.backlash", 0.6e-6, "mesh.backlash"),
    ],
)
def test_other_gears_do_not_go_on(key, value, named):
    scene = scene_of(chain(), 1e-6, 2)
    start = end_of_train(scene, solve_train(scene).checkpoint, 0.0)
    with pytest.raises(SceneError, match="as in the run to go on from") as error:
        solve_train(scene.replace({key: value}), start=start)
    assert error.value.key == named


def test_shafts_in_another_order_do_not_go_on():
    tables = chain()
    scene = scene_of(tables, 1e-6, 2)
    start = end_of_train(scene, solve_train(scene).checkpoint, 0.0)
    tables["meshes"] = dict(reversed(tables["meshes"].items()))
    with pytest.raises(SceneError, match="must be first, second") as error:
        solve_train(scene_of(tables, 1e-6, 2), start=start)
    assert error.value.key == "meshes"


def test_altered_words_are_refused():
    scene = scene_of(adhering(), 1e-6, 2)
    words = solve_train(scene).checkpoint
    for place, value in ((0, 1.0), (1, 1.0), (5, math.nan), (13, 0.5), (words.size - 1, math.inf)):
        other = words.copy()
        other[place] = value
        with pytest.raises(SceneError):
            end_of_train(scene, other, 0.0)
    for cut in (words[:3], words[:50], words[:-1], np.append(words, 0.0)):
        with pytest.raises(SceneError):
            end_of_train(scene, cut, 0.0)
    assert end_of_train(scene, words, 0.0).time == 1e-6


# -- datasets and archives -------------------------------------------------------------------------------------------


def assert_same(one, other):
    """Two datasets are of one run."""
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=str(name))
    differing = {
        key for key in {*one.attrs, *other.attrs} - {*MOMENTARY} if one.attrs.get(key) != other.attrs.get(key)
    }
    assert not differing


def test_a_chain_of_runs_is_one_run(tmp_path):
    scene = scene_of(adhering(), 30e-6, 31)
    first = gd.simulate(scene, archive=tmp_path / "first.nc")
    second = gd.simulate(scene, start=tmp_path / "first.nc", archive=tmp_path / "second.nc")
    assert float(second["time"][0]) == 30e-6
    assert second.attrs["start_time"] == 30e-6
    again = gd.simulate(scene, start=first)
    assert_same(again, second)
    joined = gd.concat([first, second], dim="time")
    whole = gd.simulate(scene.replace({"run.duration": 60e-6, "run.samples": 61}))
    assert joined.sizes["time"] == 61
    # a turning point at which the gap hardly turns may be three, by rounding
    for kind in (EventKind.ONSET, EventKind.SEPARATION, EventKind.MESH_ENTRY, EventKind.MESH_EXIT):
        assert (joined["event_kind"] == kind).sum() == (whole["event_kind"] == kind).sum()
    for name in ("shaft_speed", "gear_angle", "mesh_force"):
        scale = float(np.abs(whole[name]).max())
        np.testing.assert_allclose(joined[name], whole[name], atol=1e-3 * scale)
    assert float(joined["drive_work"]) == pytest.approx(float(whole["drive_work"]), rel=1e-5, abs=0.0)


def test_a_rest_beyond_a_seam_is_one():
    scene = scene_of(stopping(), 120e-6, 61)
    first = gd.simulate(scene)
    second = gd.simulate(scene, start=first)
    rests = json.loads(str(gd.concat([first, second], dim="time")["rest_list"].item()))
    (output,) = [row for row in rests if row[0] == "output"]
    assert output[2] == 240e-6
    assert output[1] < 120e-6


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("backend", BACKENDS)
def test_an_interrupted_run_is_resumed_from_its_journal(tmp_path, monkeypatch, backend):
    monkeypatch.setattr(train_journal, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(train_journal, "CHECKPOINT_SHARE", 0.0)
    scene = scene_of(rubbing(), 60e-6 if backend == "native" else 8e-6)
    whole, path = gd.simulate(scene, backend=backend), tmp_path / "run.nc"
    seen = []

    def interrupt(block):
        seen.append(block.time)
        with open_archive(path) as running:  # which is written meanwhile
            assert running.attrs["status"] == "running"
            assert float(running["reached"]) == block.time
            count = running.sizes["time"]
            np.testing.assert_array_equal(running["shaft_speed"], whole["shaft_speed"][:, :count])
        if len(seen) == 2:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        gd.simulate(scene, backend=backend, archive=path, on_block=interrupt)
    assert stopped.value.dataset.attrs["status"] == "interrupted"
    assert journal_of(path).exists()
    with open_archive(path) as left:
        assert left.attrs["status"] == "interrupted"
        assert "resume" in left.attrs["message"]
    with pytest.raises(SceneError, match=r"run\.rtol differs"):
        gd.simulate(scene.replace({"run.rtol": 1e-7}), backend=backend, archive=path, resume=True)
    resumed = gd.simulate(scene, archive=path, resume=True)
    assert_same(whole, resumed)
    assert not journal_of(path).exists()
    assert_same(whole, gd.simulate(scene, archive=path, resume=True))  # which is finished


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("stop", ["time", "turns 1e-4"])
def test_a_run_that_is_interrupted_behind_its_last_block_is_whole(tmp_path, monkeypatch, backend, stop):
    monkeypatch.setattr(train_journal, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(train_journal, "CHECKPOINT_SHARE", 0.0)
    scene, path = scene_of(chain(), 1e-6, **{"run.stop": stop}), tmp_path / "run.nc"
    whole = gd.simulate(scene, backend=backend)
    end = float(whole["reached"])
    assert (end < 1e-6) == (stop != "time")

    def interrupt(block):
        if block.time == end:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        gd.simulate(scene, backend=backend, archive=path, on_block=interrupt)
    assert_same(whole, gd.simulate(scene, archive=path, resume=True))


@pytest.mark.usefixtures("small_blocks")
def test_a_journal_that_is_cut_or_altered_goes_on_or_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(train_journal, "CHECKPOINT_SECONDS", 0.0)
    monkeypatch.setattr(train_journal, "CHECKPOINT_SHARE", 0.0)
    scene, path = scene_of(rubbing(), 60e-6), tmp_path / "run.nc"
    whole = gd.simulate(scene)

    def interrupt(block):
        if block.time > 50e-6:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        gd.simulate(scene, archive=path, on_block=interrupt)
    journal = journal_of(path)
    content, drawn = journal.read_bytes(), np.random.default_rng(1)
    for number in range(12):
        size = int(drawn.integers(1, len(content)))
        if number % 2:
            journal.write_bytes(content[:size])
        else:
            altered = bytearray(content)
            altered[size] ^= 16
            journal.write_bytes(altered)
        path.unlink(missing_ok=True)
        try:
            resumed = gd.simulate(scene, archive=path, resume=True)
        except SceneError as error:
            assert "cannot be resumed" in str(error)  # noqa: PT017
            continue
        assert_same(whole, resumed)
