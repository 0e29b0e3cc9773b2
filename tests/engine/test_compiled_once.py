"""Functions that are compiled once, and called at their address: what they take and return, and when they are ready."""

import importlib
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typing_extensions import TypeAliasType

from gearidae.compiled import compiled, compiled_once, is_ready, make_ready, ready
from gearidae.compiled.kinds import signature_of
from gearidae.engine.model.state import Floats
from reference.compilations import COUNTING


@compiled_once("tests")
def weigh(
    flag: bool, count: int, size: float, numbers: Floats, pair: tuple[float, int]
) -> tuple[float, int, bool]:
    numbers[0] += size
    return pair[0] * numbers[1] + size, count + pair[1], not flag


@compiled
def weigh_from_compiled(flag, count, size, numbers, pair):
    return weigh(flag, count, size, numbers, pair)


WHOLE = st.integers(-(2**30), 2**30)
REAL = st.floats(-1e100, 1e100)


@given(st.booleans(), WHOLE, REAL, st.lists(REAL, min_size=2, max_size=5), st.tuples(REAL, WHOLE))
def test_a_call_hands_everything_over(flag, count, size, numbers, pair):
    """The same to the last bit from Python, from compiled code and in Python."""
    make_ready("tests")
    answers = []
    for function in (weigh.py_func, weigh, weigh_from_compiled):
        array = np.array(numbers)
        answers.append((function(flag, count, size, array, pair), array.tolist()))
    assert answers[0] == answers[1] == answers[2]


@compiled_once("tests")
def add_to_all(numbers: Floats, more: float) -> None:
    numbers += more


@compiled
def add_two(numbers):
    add_to_all(numbers, 2)


def test_numbers_that_are_written_out_become_what_the_annotations_say():
    numbers = np.arange(3.0)
    make_ready("tests")
    add_two(numbers)
    assert numbers.tolist() == [2.0, 3.0, 4.0]


def test_what_must_not_be_changed_is_not_handed_over():
    @compiled
    def change(numbers):
        add_to_all(numbers, 1.0)

    fixed = np.arange(3.0)
    fixed.flags.writeable = False
    with pytest.raises(Exception, match="readonly array"):
        change(fixed)


class Named(NamedTuple):
    number: float


def _untyped(value: Any) -> float: ...


def _unnamed(value: Named) -> float: ...


def _bare(value: float) -> Floats: ...


def _inside(value: float) -> tuple[float, Floats]: ...


Scalar = TypeVar("Scalar", bound=np.generic)
Array = TypeAliasType("Array", np.ndarray[Any, np.dtype[Scalar]], type_params=(Scalar,))
Numbers = TypeAliasType("Numbers", Array[np.float64])
Pair = TypeAliasType("Pair", tuple[float, int])


def _array_behind_an_alias(value: float) -> Numbers: ...


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (_untyped, "typing.Any in its annotations"),
        (_unnamed, "Named'> in its annotations"),
        (_bare, "must not be an array"),
        (_inside, "must not be an array"),
        (_array_behind_an_alias, "must not be an array"),
    ],
)
def test_annotations_that_are_no_signature_are_refused(function, message):
    with pytest.raises(TypeError, match=message) as refused:
        signature_of(function)
    assert function.__name__ in str(refused.value)


def _with_aliases(first: Numbers, second: Array[np.float64]) -> Pair: ...


def _with_types(
    first: np.ndarray[Any, np.dtype[np.float64]], second: np.ndarray[Any, np.dtype[np.float64]]
) -> tuple[float, int]: ...


def test_aliases_of_types_are_what_they_stand_for():
    """NDArray of numpy 2.5 is an alias that takes a parameter; here on every version of Python and numpy."""
    assert signature_of(_with_aliases) == signature_of(_with_types)


@compiled_once("a part of this test")
def late(number: float) -> float:
    return 2.0 * number


@compiled
def call_late(number):
    return late(number)


def test_a_part_that_is_not_ready_raises_and_does_not_crash():
    assert not is_ready("a part of this test")
    with pytest.raises(RuntimeError, match=r"test_compiled_once\.late has not been made ready"):
        call_late(1.0)
    make_ready("a part of this test")
    assert is_ready("a part of this test")
    assert call_late(1.0) == 2.0


class Interrupted:
    """A function whose compilation is interrupted at first."""

    tries = 0

    def make_ready(self):
        self.tries += 1
        if self.tries == 1:
            raise KeyboardInterrupt


def test_what_has_been_interrupted_still_waits():
    interrupted = Interrupted()
    ready.wait("interrupted", interrupted)
    with pytest.raises(KeyboardInterrupt):
        make_ready("interrupted")
    for _ in range(2):
        make_ready("interrupted")
    assert interrupted.tries == 2


class Slow:
    """A function that is being compiled while others ask for it."""

    def __init__(self):
        self.begun, self.go_on, self.calls = threading.Event(), threading.Event(), 0

    def make_ready(self):
        self.calls += 1
        self.begun.set()
        assert self.go_on.wait(60.0)


def test_a_second_thread_waits_for_the_first():
    """And what is declared meanwhile is not forgotten."""
    slow, other = Slow(), Interrupted()
    other.tries = 1
    ready.wait("threads", slow)
    done = []
    threads = [
        threading.Thread(target=lambda: (make_ready("threads"), done.append(other.tries))) for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    assert slow.begun.wait(60.0)
    ready.wait("threads", other)
    assert done == []
    slow.go_on.set()
    for thread in threads:
        thread.join(60.0)
    assert slow.calls == 1
    assert done == [2, 2]


KEPT = """
from gearidae.compiled import compiled, compiled_once, make_ready
@compiled_once("kept")
def twice(number: float) -> float:
    return 2.0 * number
@compiled
def four_times(number: float) -> float:
    return twice(twice(number))
@compiled
def eight_times(number: float) -> float:
    return four_times(twice(number))
"""
USED = """
import kept
kept.make_ready("kept")
print(kept.eight_times(1.5), count.n, kept.eight_times.cache_path)
"""


def test_kept_callers_find_what_they_call_in_another_process(tmp_path):
    """Each function is compiled once, in the first process; the second has it at another address."""
    (tmp_path / "kept.py").write_text(KEPT)
    program = f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{COUNTING}{USED}"
    lines = [
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    first, second = (line.rstrip("\n").split(maxsplit=2) for line in lines)
    assert first[0] == second[0] == "12.0"
    assert int(first[1]) > 0
    assert second[1] == "0"
    names = {path.name.split("-")[0] for path in Path(second[2]).glob("*.nbi")}
    assert names == {"kept.twice", "kept.four_times", "kept.eight_times"}


PROBLEM_FIRST = """
import gearidae as gd
from gearidae.engine.setup.build import make_problem
problem = make_problem(gd.preset("teodorescu2009"))
from gearidae.engine.drivers import ready_driver
ready_driver("{}", problem)
"""


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_driver_is_ready_that_is_loaded_after_the_problem_has_been_made(backend):
    """What only drivers call is declared when they are imported."""
    program = PROBLEM_FIRST.format(backend)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_numba_that_compiles_nothing_calls_the_function_itself(monkeypatch):
    monkeypatch.setattr(numba.config, "DISABLE_JIT", True)
    once = importlib.import_module("gearidae.compiled.once")
    asked = once.compiled_once("never made ready")(lambda number: (number, numba.config.DISABLE_JIT))
    assert asked(3.0) == (3.0, True)
    assert not is_ready("never made ready")
