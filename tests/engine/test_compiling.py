"""That something is compiled is said when it is, and never when it is not."""

import io
import sys

import numba
import pytest

from gearidae.engine.compiling import compiling


@pytest.fixture
def fresh():
    """Make functions that have to be compiled."""

    def make():
        return numba.njit(lambda x: x + 1.0)

    return make


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_line_before_and_one_after(fresh, caplog):
    with compiling("the toy", "no time"):
        assert caplog.text == ""
        assert fresh()(1.0) == 2.0
        assert caplog.messages == ["compiling the toy for this machine: once, no time"]
        fresh()(1.0)
    assert len(caplog.messages) == 2
    assert caplog.messages[1].startswith("the toy: 2 functions compiled in ")


def test_nothing_is_said_where_nothing_is_compiled(fresh, caplog):
    ready = fresh()
    ready(1.0)
    with compiling("the toy", "no time"):
        ready(1.0)
    fresh()(1.0)  # and nothing of what comes later
    assert caplog.messages == []


def test_the_outermost_says_it_once(fresh, caplog):
    with compiling("the engine", "a while"):
        with compiling("a part", "no time"):
            fresh()(1.0)
        fresh()(1.0)
    assert [message.split(":")[0] for message in caplog.messages] == [
        "compiling the engine for this machine",
        "the engine",
    ]
    caplog.clear()
    with compiling("a part", "no time"):
        fresh()(1.0)
    assert "a part" in caplog.text


def test_an_error_ends_it(fresh, caplog):

    @compiling("the toy", "no time")
    def fail():
        return fresh()(1.0) / 0.0

    with pytest.raises(ZeroDivisionError):
        fail()
    assert len(caplog.messages) == 2
    caplog.clear()
    fresh()(1.0)
    assert caplog.messages == []


def test_functions_are_counted_on_a_terminal(fresh, caplog, monkeypatch):
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    with compiling("the toy", "no time"):
        for _ in range(3):
            fresh()(1.0)
    assert "compiling the toy for this machine: once, no time: 3 functions" in shown.getvalue()
    assert [message.split(" in ")[0] for message in caplog.messages] == ["the toy: 3 functions compiled"]


def test_how_far_it_is_is_said_at_each_quarter_without_a_terminal(fresh, caplog):
    with compiling("the toy", "no time", 8):
        for _ in range(9):
            fresh()(1.0)
    assert [message.split(" functions")[0] for message in caplog.messages[1:]] == [
        "the toy: 2 of about 8",
        "the toy: 4 of about 8",
        "the toy: 6 of about 8",
        "the toy: 9",
    ]


def test_functions_are_counted_against_all_of_them_on_a_terminal(fresh, monkeypatch):
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    with compiling("the toy", "no time", 4):
        for _ in range(3):
            fresh()(1.0)
    assert "3 of about 4 functions" in shown.getvalue()
