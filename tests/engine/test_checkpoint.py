"""Checkpoints: taken back unchanged, refused where they are damaged, and harmless where damage goes unseen."""

import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import portable
from gearidae.engine.backend import run_blocks
from gearidae.engine.elastic.node_rows import JOINED, row_of
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.record_types import INT
from gearidae.engine.model.state import MATERIALS, STATE, STATE_FIELDS, U, V
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.checkpoint import HEADER, pack
from gearidae.records import Statistics
from reference.damaged import BUDGET, SCENES, UNREADY

WORDS = STATE.itemsize // 8
WORST = (np.nan, -1.0, 1e300, np.int64(2**62).view(np.float64))
COMPILING = re.compile(r"compiling .* for this machine: once, .*|.*: \d+ functions? compiled in \d+ s")
"""What the first run on a machine says."""


@pytest.fixture(scope="module")
def sound():
    """A checkpoint in the middle of each scene's run, with contacts in touch."""
    checkpoints = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(portable, "CHECKPOINT_STEPS", 60)
        for name, scene in SCENES.items():
            run = run_blocks(
                make_problem(scene), scene.run.rtol, scene.run.sample_count, "sksundae", Statistics()
            )
            taken = [block.checkpoint for block in run if block.checkpoint is not None]
            checkpoints[name] = next(c for c in taken[1:] if restored(name, c)[0].state.flank_in_reach.any())
    return checkpoints


PROBLEMS = {}
"""Made once for each header: restoring leaves nothing of what was before, and making them took most of the time."""


def problem_of(name, checkpoint):
    """The problem that a checkpoint belongs to."""
    header = name, checkpoint.shape, checkpoint[:HEADER].tobytes()
    if header not in PROBLEMS:
        PROBLEMS[header] = make_problem(SCENES[name]).of_checkpoint(checkpoint)
    return PROBLEMS[header]


def restored(name, checkpoint):
    """Model and state vector of a checkpoint, and the problem that it belongs to."""
    scene = SCENES[name]
    problem = problem_of(name, checkpoint)
    m, y = problem.prepare(scene.run.rtol, scene.run.sample_count), np.empty(problem.start.size)
    problem.restore(checkpoint, y)
    return m, y, problem


def refused(name, checkpoint):
    """Whether a checkpoint is refused, in one line that names it."""
    said = complaint(name, checkpoint)
    assert said is None or said.key == "checkpoint"
    assert said is None or "\n" not in str(said)
    return said is not None


def complaint(name, checkpoint):
    """What is said of a checkpoint; None if it is taken."""
    try:
        restored(name, checkpoint)
    except gd.SceneError as error:
        return error
    return None


def bits(checkpoint):
    """Words of a checkpoint, by which NaN equals itself."""
    return checkpoint.view(np.int64)


def whole_number(number):
    """The word that holds a whole number."""
    return np.int64(number).view(np.float64)


def histories(m):
    """Two histories that are of a pair, and one that this scene does not use."""
    used = [k for k in range(m.scene.histories) if m.state.history[k].pair == 0]
    return [*used[:2], int(m.scene.histories)]


def numbers_of(fields, record, chosen, first=0):
    """Word and declaration of each number of a record; of an array of records those of the chosen ones."""
    for field in fields:
        kind, offset = record.fields[field.name][:2]
        place, length = first + offset // 8, kind.base.itemsize // 8
        count = int(np.prod(field.shape, dtype=int))
        if isinstance(field.kind, tuple):
            for k in chosen.get(field.name, {0, count - 1}):
                yield from numbers_of(field.kind, kind.base, chosen, place + k * length)
        else:
            yield from ((place + k, field) for k in range(count))


def at_the_bounds(name, checkpoint):
    """Copies with one word of the state changed, and whether it stays within its bounds.

    What may decide an index, a count or a flag is put at its bounds and beyond each; other numbers, whose size decides
    nothing but the run, are large, negative or zero in turn.
    """
    m, y, _ = restored(name, checkpoint)
    for word, field in numbers_of(STATE_FIELDS, STATE, {"history": histories(m)}):
        high = field.high(m.scene) if callable(field.high) else field.high
        if field.kind == INT:
            low, high = int(field.low), int(high)
            for number in (low - 1, low, high, high + 1):
                yield HEADER + word, whole_number(number), low <= number <= high
        else:
            number = (0.999 * high, -1.0, 0.0)[word % 3]
            yield HEADER + word, number, True
    behind = HEADER + WORDS
    for word in (*range(behind, behind + min(y.size, 8)), checkpoint.size - 1):
        yield word, (1e5, -1.0, 0.0)[word % 3], True


def forged(checkpoint, word, value):
    """A copy in which one word is another."""
    copy = checkpoint.copy()
    copy[word] = value
    return copy


@pytest.mark.parametrize("name", SCENES)
def test_what_is_taken_back_is_packed_the_same(name, sound):
    m, y, problem = restored(name, sound[name])
    np.testing.assert_array_equal(bits(pack(m, problem.digest, problem.depth, y)), bits(sound[name]))
    assert float(m.state.time) > 0.0
    assert problem.depth == int("elastic" in name)


@pytest.mark.parametrize("name", SCENES)
def test_each_word_of_the_header_counts(name, sound):
    checkpoint = sound[name]
    for word in range(HEADER):
        for value in (*WORST, checkpoint[word] + 1.0, checkpoint[word] - 1.0):
            copy = checkpoint.copy()
            copy[word] = value
            if copy[word] == checkpoint[word] or (word == HEADER - 3 and of_another_layout(name, value)):
                continue
            assert refused(name, copy), (word, value)


def of_another_layout(name, depth):
    """Whether a scene has another contact model of this number, and of the same size: nothing else can tell them."""
    return "elastic" in name and depth == 2.0


@pytest.mark.parametrize("name", SCENES)
def test_another_length_is_refused(name, sound):
    checkpoint = sound[name]
    for size in (0, 1, HEADER, HEADER + WORDS - 1, HEADER + WORDS, checkpoint.size - 1):
        assert refused(name, checkpoint[:size]), size
    for more in (1, 8, WORDS):
        assert refused(name, np.concatenate([checkpoint, np.zeros(more)]))
        assert refused(name, np.concatenate([checkpoint, checkpoint[-more:]]))
    assert refused(name, checkpoint[:, None])


def test_a_checkpoint_of_another_scene_is_refused(sound):
    for name in SCENES:
        for other in SCENES:
            assert refused(name, sound[other]) == (name != other)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.by_hand)])
def test_words_at_their_bounds_end_without_a_signal(every, name, sound, tmp_path):
    """Bounds keep a checkpoint with a forged index, count or flag out, and what they let through harms nothing.

    One in three of these runs on, all of them by hand.
    """
    let_through, whole_numbers = [], 0
    for word, value, within in at_the_bounds(name, sound[name]):
        copy = forged(sound[name], word, value)
        if not within:
            whole_numbers += 1
            assert refused(name, copy), word
        elif not refused(name, copy):  # a second bound may be narrower
            let_through.append((word, copy))
    assert whole_numbers >= 100
    assert len(let_through) >= 200
    run_on(name, let_through[::every], tmp_path)


def run_on(name, let_through, tmp_path):
    """The native driver runs the copies on in another process, whose death would be seen."""
    path = tmp_path / "let_through.npy"
    np.save(path, np.array([copy for _, copy in let_through]))
    program = Path(__file__).parents[1] / "reference" / "damaged.py"
    run = subprocess.run(
        [sys.executable, str(program), name, str(path)], capture_output=True, text=True, check=False
    )
    lines = run.stdout.split()
    assert run.returncode == 0, (let_through[min(len(lines), len(let_through) - 1)][0], run.stderr[-2000:])
    assert [line for line in run.stderr.splitlines() if not COMPILING.fullmatch(line)] == []
    assert len(lines) == len(let_through)
    assert set(lines) <= {ending.status for ending in Ending} | {f"{BUDGET}_blocks", UNREADY}


@pytest.mark.parametrize("name", SCENES)
def test_a_state_that_is_no_number_is_refused(name, sound):
    for place in (U, V):
        for value in (np.nan, np.inf):
            copy = sound[name].copy()
            copy[HEADER + WORDS + place] = value
            assert refused(name, copy)


# -- nodes -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def nodes(sound):
    """The elastic roller's checkpoint, its nodes, its points, and where their rows begin in it."""
    checkpoint = sound["elastic roller"]
    m, y, _ = restored("elastic roller", checkpoint)
    return checkpoint, int(m.scene.nodes), int(m.scene.points), HEADER + WORDS + y.size


def test_only_what_is_state_is_kept_of_the_nodes(nodes):
    """Pressures, slopes, stiffness and adhered energy are worked out anew."""
    checkpoint, n, points, first = nodes
    assert checkpoint.size - first == 2 * n + MATERIALS * points
    m, *_ = restored("elastic roller", checkpoint)
    problem = make_problem(SCENES["elastic roller"])
    assert problem.model.rows.size > m.scene.node_rows_at + 2 * n + MATERIALS * points
    np.testing.assert_array_equal(row_of(m, 0, JOINED), checkpoint[first + 2 * n : first + 2 * n + points])


# -- what restoring leaves -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("name", SCENES)
def test_nothing_is_left_of_a_run_before(name, backend, sound):
    """A problem that has run to its end restores a checkpoint as a fresh one does, down to the work records."""
    scene = SCENES[name]
    used = make_problem(scene)
    for _ in run_blocks(used, scene.run.rtol, scene.run.sample_count, backend, Statistics()):
        pass
    models = []
    for problem in (used, make_problem(scene)):
        resumed = problem.of_checkpoint(sound[name])
        resumed.prepare(scene.run.rtol, scene.run.sample_count)
        resumed.model.work.search.as_ida, resumed.model.work.search.sharpness = 0, 0.0  # which a driver sets
        resumed.restore(sound[name], np.empty(resumed.start.size))
        models.append(resumed.model)
    assert models[0].work.tobytes() == models[1].work.tobytes()
    assert models[0].state.tobytes() == models[1].state.tobytes()


@pytest.mark.parametrize("name", SCENES)
def test_a_checkpoint_is_checked_in_milliseconds(name, sound):
    _, y, problem = restored(name, sound[name])
    spent = []
    for _ in range(20):
        began = time.process_time()
        problem.restore(sound[name], y)
        spent.append(time.process_time() - began)
    assert min(spent) < 0.02  # 2 ms on an idle machine
