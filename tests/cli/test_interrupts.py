"""An interrupt that Python drops is raised again."""

import os
import signal
import sys
import time
import warnings
from types import SimpleNamespace

import pytest

from gearidae.cli import command_line, main
from gearidae.cli.interrupts import interrupts_kept


class Dropped:
    """Raises where nothing can be raised."""

    def __init__(self, error):
        self.error = error

    def __del__(self):
        raise self.error


def drop_one_and_wait():
    dropped = Dropped(KeyboardInterrupt())
    del dropped
    for _ in range(500):
        time.sleep(0.01)


def test_an_interrupt_in_a_destructor_is_not_lost():
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        drop_one_and_wait()


def test_other_errors_go_where_they_went(monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "unraisablehook", lambda unraisable: seen.append(type(unraisable.exc_value)))
    with interrupts_kept():
        dropped = Dropped(ValueError())
        del dropped
    assert seen == [ValueError]


@pytest.mark.parametrize(
    ("number", "word", "code"),
    [(signal.SIGTERM, "terminated", 143), (signal.SIGHUP, "the terminal has gone", 129)],
)
def test_a_signal_to_end_is_named_and_what_is_done_is_kept(number, word, code, monkeypatch, capsys):
    def stopped(*_, **__):
        os.kill(os.getpid(), number)
        time.sleep(1.0)

    monkeypatch.setattr(command_line, "app", SimpleNamespace(meta=stopped))
    before = signal.signal(number, signal.SIG_DFL)  # under nohup this process ignores it
    try:
        assert main(["keys"]) == code
        assert capsys.readouterr().err == f"gearidae: {word}\n"
        assert signal.getsignal(number) is signal.SIG_DFL
    finally:
        signal.signal(number, before)


@pytest.mark.parametrize("columns", ["1", "10", "100000000"])
def test_an_impossible_width_of_the_terminal_is_bounded(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    assert main(["--version"]) == 0
    assert 40 <= int(os.environ["COLUMNS"]) <= 1000


@pytest.mark.skipif(sys.platform == "win32", reason="has no such limit")
@pytest.mark.parametrize("command", [["run"], ["sweep", "--over", "coating.sam_fraction=1,0.9"]])
def test_a_limit_below_what_the_solver_takes_is_a_line(command, monkeypatch, capsys, tmp_path):
    """LLVM ends the process where it gets no memory."""
    import resource

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(resource, "getrlimit", lambda which: (10**9, 10**9))
    assert main([command[0], "low_speed", *command[1:]]) == 3
    assert capsys.readouterr().err == "gearidae: there is not enough memory for this (ulimit -v limits it)\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "error", [MemoryError(), ImportError("_libs.so: failed to map segment from shared object")]
)
def test_too_little_memory_is_a_line(error, monkeypatch, capsys):
    def starved(*_, **__):
        raise error

    monkeypatch.setattr(command_line, "app", SimpleNamespace(meta=starved))
    assert main(["keys"]) == 3
    assert capsys.readouterr().err == "gearidae: there is not enough memory for this (ulimit -v limits it)\n"


def test_a_warning_with_a_traceback_is_a_line(monkeypatch, capsys):
    """As numba warns of NUMBA_NUM_THREADS=abc."""

    def warns(*_, **__):
        warnings.warn(
            "could not be parsed with exception:\nTraceback (most recent call last):\n  File", stacklevel=1
        )

    monkeypatch.setattr(command_line, "app", SimpleNamespace(meta=warns))
    assert main(["keys"]) == 0
    assert capsys.readouterr().err == "gearidae: could not be parsed with exception\n"
