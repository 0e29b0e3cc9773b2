"""Checkpoints: taken back unchanged, refused where they are damaged, and harmless where damage goes unseen."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import run_blocks
from gearidae.engine.integrate import portable
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.build import make_problem
from gearidae.engine.model.checkpoint import HEADER, pack
from gearidae.engine.model.state import STATE, U, V
from gearidae.records import Statistics
from reference.damaged import BUDGET, SCENES

WORDS = STATE.itemsize // 8
WORST = (
    np.nan,
    np.inf,
    -np.inf,
    -1.0,
    0.0,
    1e300,
    np.int64(2**62).view(np.float64),
    np.int64(-(2**62)).view(np.float64),
    np.int64(2**31).view(np.float64),
)
STEPS = (-1, 1, 2, 8)
"""Small changes of what may be an integer."""


@pytest.fixture(scope="module")
def sound():
    """A checkpoint in the middle of each scene's run, with contacts in touch."""
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(portable, "CHECKPOINT_STEPS", 60)
        for name, scene in SCENES.items():
            run = run_blocks(
                make_problem(scene), scene.run.rtol, scene.run.sample_count, "sksundae", Statistics()
            )
            taken = [block.checkpoint for block in run if block.checkpoint is not None]
            found[name] = next(c for c in taken[1:] if restored(name, c)[0].state.near.any())
    return found


def restored(name, checkpoint):
    """Model and state vector of a checkpoint, and the problem that it belongs to."""
    scene = SCENES[name]
    problem = make_problem(scene).of_checkpoint(checkpoint)
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


def damage(name, checkpoint):
    """Copies with one word changed: of the header, of the state but for most empty histories, and of what follows."""
    m, y, _ = restored(name, checkpoint)
    first = HEADER + STATE.fields["history"][1] // 8
    length = STATE["history"].base.itemsize // 8
    used = [k for k in range(m.scene.histories) if m.state.history[k].pair == 0]
    empty = int(m.scene.histories)  # one that this scene does not use
    behind = HEADER + WORDS
    words = [
        *range(first),
        *(first + length * k + j for k in [*used[:2], empty] for j in range(length)),
        *range(behind, behind + min(y.size, 8)),
        *np.linspace(behind + y.size, checkpoint.size - 1, 24, dtype=int).tolist() * int(m.scene.nodes > 0),
    ]
    for word in words:
        values = [*WORST, *((bits(checkpoint)[word : word + 1] + step).view(np.float64)[0] for step in STEPS)]
        values += [checkpoint[word] * (1.0 + 1e-3)] if np.isfinite(checkpoint[word]) else []
        for value in values:
            copy = checkpoint.copy()
            copy[word] = value
            if bits(copy)[word] != bits(checkpoint)[word]:
                yield word, copy


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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dry gears", "roller"])
def test_damage_is_refused_or_harmless(name, sound, tmp_path):
    """What is let through is run by the native driver in another process, whose death would be seen."""
    let_through, count = [], 0
    for word, copy in damage(name, sound[name]):
        count += 1
        if refused(name, copy):
            continue
        assert np.isfinite(copy[HEADER + WORDS :]).all()
        let_through.append((word, copy))
    assert count >= 500
    assert count > 2 * len(let_through)
    path = tmp_path / "let_through.npy"
    np.save(path, np.array([copy for _, copy in let_through]))
    program = Path(__file__).parents[1] / "reference" / "damaged.py"
    run = subprocess.run(
        [sys.executable, str(program), name, str(path)], capture_output=True, text=True, check=False
    )
    lines = run.stdout.split()
    assert run.returncode == 0, (let_through[min(len(lines), len(let_through) - 1)][0], run.stderr[-2000:])
    assert run.stderr == ""
    assert len(lines) == len(let_through)
    # at this share of a run nothing else may come of it; most of what is let through is a counter or a sum
    assert set(lines) <= {ending.status for ending in Ending} | {f"{BUDGET}_blocks"}
    assert lines.count("finished") > 0.5 * len(lines)


@pytest.mark.parametrize("name", SCENES)
def test_a_state_that_is_no_number_is_refused(name, sound):
    for place in (U, V):
        for value in (np.nan, np.inf):
            copy = sound[name].copy()
            copy[HEADER + WORDS + place] = value
            assert refused(name, copy)
