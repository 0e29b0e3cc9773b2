"""Checkpoints: taken back unchanged, refused where they are damaged, and harmless where damage goes unseen."""

import itertools
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import run_blocks
from gearidae.engine.elastic.rows import JOINED, row_of
from gearidae.engine.integrate import portable
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.state import EMPTY, MATERIALS, STATE, U, V
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.checkpoint import HEADER, pack
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

COMPILING = re.compile(r"compiling .* for this machine: once, .*|.*: \d+ functions? compiled in \d+ s")
"""What the first run on a machine says."""


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
@pytest.mark.parametrize("name", SCENES)
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
    assert [line for line in run.stderr.splitlines() if not COMPILING.fullmatch(line)] == []
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


# -- numbers that follow from others ---------------------------------------------------------------------------------


def state_of(checkpoint):
    """State of a checkpoint, a view of it."""
    return checkpoint[HEADER : HEADER + WORDS].view(STATE).view(np.recarray)[0]


def held(name, checkpoint):
    """Indices of the histories that are about a pair in contact."""
    found = [k for k, h in enumerate(state_of(checkpoint).history) if h.pair != EMPTY and h.gap < 5.0]
    assert found, name
    return found


FORGED = {
    "no contact below the contact gap": lambda h: setattr(h, "in_contact", 1 - h.in_contact),
    "a gap beyond the cut-off": lambda h: setattr(h, "gap", 500.0),
    "a gap aside": lambda h: setattr(h, "gap", h.gap + 0.01),
    "a rate aside": lambda h: setattr(h, "gap_rate", h.gap_rate + 10.0),
    "the other direction": lambda h: setattr(h, "direction", -h.direction),
    "adhered energy without asperities": lambda h: h.adhered_energy.__setitem__(slice(None), -1e30),
    "a lag at no turning point": lambda h: setattr(h, "lag_rate", 1e300),
    "an absurd joined height": lambda h: h.joined.__setitem__(slice(None), -1e9),
}


@pytest.mark.parametrize("forgery", FORGED)
@pytest.mark.parametrize("name", SCENES)
def test_a_history_is_that_of_its_gap(name, forgery, sound):
    for k in held(name, sound[name]):
        copy = sound[name].copy()
        before = state_of(copy).history[k].gap_rate
        FORGED[forgery](state_of(copy).history[k])
        if forgery == "no contact below the contact gap" and abs(touching(name, copy, k)) < 1.5:
            continue  # so near that either may be
        if forgery == "the other direction" and abs(before) < 0.1:
            continue  # at a turning point
        assert refused(name, copy), (forgery, k)


def touching(name, checkpoint, k):
    """Distance of a pair's gap from that of contact onset."""
    problem = make_problem(SCENES[name]).of_checkpoint(checkpoint)
    return state_of(checkpoint).history[k].gap - problem.model.scene.contact_gap


@pytest.mark.parametrize("name", SCENES)
def test_adhered_energy_goes_with_the_joined_height(name, sound):
    for k in held(name, sound[name]):
        copy = sound[name].copy()
        h = state_of(copy).history[k]
        if "elastic" in name or not h.adhered_energy.any():
            continue  # an elastic contact keeps that of its points
        h.adhered_energy *= 1.001
        assert refused(name, copy), k


@pytest.mark.parametrize(
    "forgery",
    [
        {"drive_work": 1e30},
        {"adhesion_loss": -1e30},
        {"throughput": 1e300, "peak_kinetic": 1e300},
        {"peak_kinetic": 0.0},
        {"start_kinetic": 1e30},
    ],
    ids=str,
)
@pytest.mark.parametrize("name", SCENES)
def test_energies_are_of_the_order_of_what_has_flowed(name, forgery, sound):
    copy = sound[name].copy()
    for key, value in forgery.items():
        state_of(copy).energy[key] = value
    assert refused(name, copy)


def test_marks_are_those_next_to_the_phase(sound):
    for key, by in itertools.product(("mark_low", "mark_high"), (-2.0, -0.1, 0.1, 2.0)):
        copy = sound["dry gears"].copy()
        setattr(state_of(copy), key, state_of(copy)[key] + by)
        assert refused("dry gears", copy), (key, by)


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


@pytest.mark.parametrize("node", [0, 3, -1])
def test_rows_of_nodes_are_those_of_the_state(nodes, node):
    checkpoint, n, points, first = nodes
    place = range(n)[node]
    wrong = {
        "gap": (first + place, checkpoint[first + place] + 0.5),
        "deflection": (HEADER + WORDS + 2 + place, checkpoint[HEADER + WORDS + 2 + place] + 0.5),
        "share": (first + n + place, -0.1),
        "large share": (first + n + place, 4.1),
        "joined": (first + 2 * n + range(points)[node], 1e3),
        "joined below": (first + 2 * n + range(points)[node], -1e3),
    }
    for what, (word, value) in wrong.items():
        copy = checkpoint.copy()
        copy[word] = value
        assert refused("elastic roller", copy), what


def test_nodes_of_no_pair_are_empty(sound):
    """Before contact there is nothing to remember: no number may stand there."""
    name = "elastic roller"
    problem = make_problem(SCENES[name])
    m = problem.prepare(SCENES[name].run.rtol, SCENES[name].run.sample_count)
    m.state.history[0].pair = EMPTY
    m.state.near[:] = 0
    start = pack(m, problem.digest, problem.depth, problem.start)
    assert not refused(name, start)
    for word in (start.size - 1, HEADER + WORDS + problem.start.size):
        copy = start.copy()
        copy[word] = 1e-3
        assert refused(name, copy)


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
        own = problem.of_checkpoint(sound[name])
        own.prepare(scene.run.rtol, scene.run.sample_count)
        own.model.work.search.as_ida, own.model.work.search.sharpness = 0, 0.0  # which a driver sets
        own.restore(sound[name], np.empty(own.start.size))
        models.append(own.model)
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
