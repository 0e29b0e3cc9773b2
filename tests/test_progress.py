"""Progress where it can be seen: in a notebook's kernel, on a terminal, nowhere else."""

from __future__ import annotations

import io
import re
import sys
import time
from types import SimpleNamespace

import pytest

from gearidae import progress


class Handle:
    def __init__(self, shown):
        self.shown = shown

    def update(self, what, raw):
        assert raw
        self.shown.append(what)


@pytest.fixture
def kernel(monkeypatch):
    """What a notebook shows, one state after the other."""
    shown = []

    def display(what, raw, display_id):
        assert raw
        assert display_id
        shown.append(what)
        return Handle(shown)

    shell = SimpleNamespace(kernel=object())
    module = SimpleNamespace(get_ipython=lambda: shell)
    monkeypatch.setitem(sys.modules, "IPython", module)
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=display))
    monkeypatch.setattr(progress, "_REDRAWN", 0.0)
    return shown


def test_a_run_shows_its_progress_in_a_notebook(kernel):
    with progress.run_progress(True, 0.3) as report:
        report(0.15, 12)
        report(0.3, 40)
    assert 'max="300" value="150"' in kernel[1]["text/html"]
    assert "150 of 300 ms, 12 events" in kernel[1]["text/plain"]
    assert "300 of 300 ms, 40 events" in kernel[-1]["text/html"]


def test_a_sweep_shows_its_progress_in_a_notebook(kernel):
    with progress.sweep_progress(True, 4) as report:
        report(1.5, 4)
    assert "1.5 of 4 runs" in kernel[-1]["text/html"]


def test_the_last_state_is_shown_when_a_run_is_interrupted(kernel, monkeypatch):
    monkeypatch.setattr(progress, "_REDRAWN", 1e9)

    def interrupted():
        with progress.run_progress(True, 2.0) as report:
            report(1.0, 3)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert "1 of 2 s, 3 events" in kernel[-1]["text/plain"]


def test_ipython_on_a_terminal_is_no_notebook(monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=SimpleNamespace))
    assert progress._notebook() is None


def test_nothing_is_shown_where_nobody_looks(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.run_progress(True, 1.0) as report:
        report(0.5, 1)
    assert sys.stderr.getvalue() == ""
    with progress.sweep_progress(True, 3) as update:
        update(1.0, 3)
    assert sys.stderr.getvalue() == ""


def test_a_bar_is_drawn_on_a_terminal(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "150")
    with progress.run_progress(True, 0.3) as report:
        report(0.3, 7)
    assert "300 of 300 ms, 7 events" in sys.stderr.getvalue()


@pytest.mark.parametrize(("columns", "shown"), [(40, "0:00:"), (80, "events"), (150, "ms per second")])
def test_narrow_terminals_show_the_time_that_remains(columns, shown, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(columns))
    with progress.run_progress(True, 123.456e-3) as report:
        for step in range(1, 4):
            report(step * 12.3456e-3, 123_456)
            time.sleep(0.01)
    last = (
        re.sub("\x1b\\[[0-9;?]*[a-zA-Z]", "", sys.stderr.getvalue()).strip().splitlines()[-1].split("\r")[-1]
    )
    assert re.search(r"\d+:\d\d:\d\d \S+:\S\S:\S\S$", last.strip())  # elapsed, and remaining
    assert len(last) <= columns
    assert shown in last


def test_a_function_is_told():
    calls = []
    with progress.run_progress(lambda *what: calls.append(what), 1.0) as report:
        report(0.5, 2)
    assert calls == [(0.5, 2)]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0079, "0.0079 s"),
        (119.0, "1.2e+02 s"),
        (600.0, "10 min"),
        (288e3, "3.3 days"),
        (1.3e8, "4.1 years"),
    ],
)
def test_times_are_said_as_people_say_them(seconds, words):
    assert progress.in_words(seconds) == words


@pytest.mark.parametrize(
    ("reached", "said"),
    [
        # 0.2994 s at 0.225 ms a second; the first 1.33 s do not count
        ([0.0, 0.0, 1e-12, 3e-4, 3e-4, 6e-4], ["at this rate the run takes another 22 min"]),
        # resumed: what was there took no time
        ([0.1, 0.1, 0.1, 0.1, 0.1002, 0.1003], ["at this rate the run takes another 22 min"]),
        ([0.0, 1e-12, 1e-12, 1e-3, 2e-3, 3e-3], []),  # 200 s; functions were loaded for 1.33 s
        ([0.0, 1e-12, 1e-12], []),
        ([0.0], []),
    ],
)
def test_a_long_run_is_announced_once_by_the_rate_after_its_first_second(reached, said, monkeypatch, caplog):
    clock = iter([5.0 + 0.66667 * number for number in range(len(reached))])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    calls = []
    with progress.run_progress(lambda *what: calls.append(what), 0.3) as report:
        for time_reached in reached:
            report(time_reached, 0)
    assert [record.getMessage() for record in caplog.records] == said
    assert len(calls) == len(reached)


def test_a_run_without_progress_announces_it_too(monkeypatch, caplog):
    clock = iter([0.0, 2.0, 4.0])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    with progress.run_progress(False, 1.0) as report:
        for number in range(3):
            report(1e-4 * number, 0)
    assert [record.getMessage() for record in caplog.records] == ["at this rate the run takes another 5.6 h"]


def test_a_program_without_standard_error_sees_no_bar(monkeypatch):
    """As pythonw and services have none."""
    monkeypatch.setattr(sys, "stderr", None)
    with progress.run_progress(True, 0.3) as report:
        report(0.3, 7)


@pytest.mark.parametrize("columns", [1, 100_000_000])
def test_a_bar_on_a_terminal_of_an_impossible_width(columns, monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(columns))
    with progress.run_progress(True, 0.3) as report:
        report(0.3, 7)
    assert 0 < len(sys.stderr.getvalue()) < 10_000


def test_the_rate_is_that_of_the_last_half_minute(kernel, monkeypatch):
    """A run that begins to adhere slows down, and the rate says so."""
    clock = iter([0.0, *(float(second) for second in range(200))])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    pace = progress._Pace(1.0, "the run takes", 600.0, 30.0)
    times = [1e-3 * second for second in range(100)]
    times += [times[-1] + 1e-5 * second for second in range(1, 60)]
    rates = [pace.rate(time) for time in times]
    assert rates[50] == pytest.approx(1e-3, rel=1e-9)
    assert rates[-1] == pytest.approx(1e-5, rel=1e-9)


def test_a_notebook_shows_what_the_gear_does_and_the_time_left(kernel, monkeypatch):
    clock = iter([0.0, 0.0, *(100.0 * number for number in range(20))])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    with progress.run_progress(True, 0.3) as report:
        report(0.1, 12)
        report.doing = "held by adhesion since 150 ms"
        report(0.2, 40)
    assert "simulating: held by adhesion since 150 ms; 200 of 300 ms, 40 events" in kernel[-1]["text/plain"]
    assert re.search(r"about [.\d]+ min left", kernel[-1]["text/plain"])


def test_a_sweep_says_how_long_it_will_take_by_the_rate_of_all_its_cores(kernel, monkeypatch):
    """Expected until something is measured; then 2 of 20 runs in 60 s leave 9 min."""
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    with progress.sweep_progress(True, 20, lambda: "some 3 min with 2 at a time") as report:
        assert "20 runs, some 3 min with 2 at a time" in kernel[-1]["text/plain"]
        report(0.0, 20)
        assert "0 of 20 runs, some 3 min with 2 at a time" in kernel[-1]["text/plain"]
        now[0] = 60.0
        report(2.0, 20)
    assert "2 of 20 runs, about 9 min left" in kernel[-1]["text/plain"]


@pytest.mark.parametrize(
    ("wanted", "every", "said"),
    [
        (True, 20.0, ["at this rate the 20 runs take another 6 min"]),
        (True, 2.0, []),  # 38 s
        (False, 20.0, []),
    ],
)
def test_a_long_sweep_is_announced_once_where_no_bar_is_seen(wanted, every, said, monkeypatch, caplog):
    clock = iter([every * number for number in range(4)])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.sweep_progress(wanted, 20, pytest.fail) as report:
        for done in range(4):
            report(float(done), 20)
    assert [record.getMessage() for record in caplog.records] == said


def test_nothing_is_foretold_where_there_may_be_far_fewer_runs(kernel, monkeypatch, caplog):
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    with progress.sweep_progress(True, 1000, at_most=True) as report:
        for now[0] in (0.0, 60.0):
            report(now[0] / 60.0 + 1.0, 1000)
    assert "2 of 1000 runs" in kernel[-1]["text/plain"]
    assert "left" not in kernel[-1]["text/plain"]
    monkeypatch.setattr(progress, "_notebook", lambda: None)
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.sweep_progress(True, 1000, at_most=True) as report:
        for now[0] in (0.0, 60.0):
            report(now[0] / 60.0 + 1.0, 1000)
    assert not caplog.records
