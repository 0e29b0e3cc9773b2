"""Progress of a run or a sweep: a bar on a terminal or in a notebook, or calls of the caller's own function."""

from __future__ import annotations

import html
import logging
import math
import shutil
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from time import monotonic
from typing import Any, Final

from gearidae.errors import SceneError

log = logging.getLogger(__name__)

RunProgress = Callable[[float, int], None]
"""Called with the simulated time [s] and the number of events so far."""
_LONG: Final = 600.0
"""Wall time above which a run is announced as long [s]."""
_RECENT: Final = 30.0
"""Wall time over which the rate of a run is taken [s]."""
_UNSEEN: Final = 60.0
"""Wall time above which runs are announced where no bar is seen [s]."""
_MANY_RECENT: Final = 600.0
"""Wall time over which the rate of a sweep is taken [s]: its runs differ from each other."""
_REDRAWN: Final = 0.1
"""Least time between two states of a bar in a notebook [s]."""
SweepProgress = Callable[[float, int], None]
"""Called with the number of finished runs (with fractions for those under way) and the number of all runs."""


def _check(wanted: object) -> None:
    if not isinstance(wanted, bool):
        raise SceneError("progress", str(wanted)[:60], "must be true, false or a function")


@contextmanager
def run_progress(wanted: bool | RunProgress, duration: float) -> Iterator[RunReport]:
    """Show how far a run is, and say how long it will take if that is long.

    Parameters
    ----------
    wanted : bool or callable
        True for a bar (drawn only if standard error is a terminal, or in a notebook), False for nothing, or a function
        to call.
    duration : float
        Simulated time of the whole run [s].

    Yields
    ------
    RunReport
        What the engine shall call. It also logs, once, how long the run will take at the rate of its second second, if
        that is more than ten minutes.
    """
    if callable(wanted):
        yield RunReport(duration, wanted, None)
        return
    _check(wanted)
    scale = 1e3 if duration < 1.0 else 1.0
    with _bar("simulating", duration * scale) if wanted else nullcontext() as advance:
        yield RunReport(duration, None, advance)


class RunReport:
    """Takes reports of a run and shows them.

    Parameters
    ----------
    duration : float
        Simulated time of the whole run [s].
    call : callable, optional
        Function of the caller.
    advance : callable, optional
        Of a bar.

    Attributes
    ----------
    doing : str
        What the gear does, if there is something to say; to be set as it becomes known.
    """

    def __init__(self, duration: float, call: RunProgress | None, advance: Advance | None) -> None:
        self._duration, self._call, self._advance = duration, call, advance
        self._pace = _Pace(duration, "the run takes", _LONG, _RECENT)
        self.doing = ""

    def __call__(self, time: float, events: int) -> None:
        """Take over the simulated time [s] and the number of events so far."""
        prefix, scale = ("ms", 1e3) if self._duration < 1.0 else ("s", 1.0)
        rate = self._pace.rate(time)
        if self._call is not None:
            self._call(time, events)
        elif self._advance is not None:
            doing = f"{self.doing}; " if self.doing else ""
            self._advance(
                time * scale,
                f"{doing}{time * scale:.4g} of {self._duration * scale:.4g} {prefix}, {events} events, "
                f"{rate * scale:.3g} {prefix} per second",
                (self._duration - time) / rate if rate > 0.0 else math.nan,
            )


class _Pace:
    """Rate of a run or of a sweep of late, from its first report on.

    What was resumed is back then. Compiled functions are loaded when they are first called, which may take a second in
    which nothing is done: what is announced is the rate of the second that follows. Runs change their pace where they
    begin to adhere. All cores that compute a sweep count, as the rate is one of all its runs.

    Parameters
    ----------
    end : float
        What is reported at the end: simulated time [s], number of runs.
    what : str
        What is announced, with its verb.
    long : float
        Wall time above which it is announced [s].
    recent : float
        Wall time over which the rate is taken [s].
    """

    def __init__(self, end: float, what: str, long: float, recent: float) -> None:
        self._end, self._what, self._long, self._recent = end, what, long, recent
        self._reports: deque[tuple[float, float]] = deque()
        self._loaded: tuple[float, float] | None = None
        self._judged = False

    def rate(self, time: float) -> float:
        """Return what is done in each second of wall time, once so much is done."""
        now = monotonic()
        self._reports.append((now, time))
        while now - self._reports[0][0] > self._recent and len(self._reports) > 2:
            self._reports.popleft()
        began, start = self._reports[0]
        elapsed = now - began
        rate = (time - start) / elapsed if elapsed > 0.0 else 0.0
        if not self._judged and elapsed >= 1.0:
            self._judge(now, time)
        return rate

    def _judge(self, now: float, time: float) -> None:
        """Announce how long it takes, once, by what has been done since the first second."""
        if self._loaded is None:
            self._loaded = now, time
            return
        began, start = self._loaded
        if now - began < 1.0 or time <= start:
            return
        self._judged = True
        if (remaining := (self._end - time) * (now - began) / (time - start)) > self._long:
            log.warning("at this rate %s another %s", self._what, in_words(remaining))


def in_words(seconds: float) -> str:
    """Write a wall time as people say it: ``"80 h"``."""
    for unit, length in (("years", 3.156e7), ("days", 86_400.0), ("h", 3600.0), ("min", 60.0)):
        number = seconds / length
        if number >= 2.0:
            return f"{number:.2g} {unit}" if number < 100.0 else f"{number:.3g} {unit}"
    return f"{seconds:.2g} s"


@contextmanager
def sweep_progress(
    wanted: bool | SweepProgress, runs: int, expected: Callable[[], str] = str, *, at_most: bool = False
) -> Iterator[SweepProgress]:
    """Show how far a sweep is, and how long it will go on at the rate of all its cores.

    Where a bar is wanted and none can be seen, the log says once how long it will take, if that is more than a minute.

    Parameters
    ----------
    wanted : bool or callable
        As for `run_progress`.
    runs : int
        Number of runs.
    expected : callable, optional
        How long they will take, in words, asked for only if a bar is seen: shown until their rate is known.
    at_most : bool, optional
        Whether there may be far fewer: then nobody knows how long they will take.

    Yields
    ------
    callable
        What the sweep shall call.
    """
    if callable(wanted):
        yield wanted
        return
    _check(wanted)
    with _bar("sweeping", float(runs)) if wanted else nullcontext() as advance:
        long = _UNSEEN if wanted and advance is None and not at_most else math.inf
        pace = _Pace(float(runs), f"the {runs} runs take", long, _MANY_RECENT)
        busy = threading.Lock()
        hint = ""
        if advance is not None and (hint := expected()):
            advance(0.0, f"{runs} runs, {hint}", math.nan)

        def update(done: float, total: int) -> None:
            with busy:  # runs report from several threads
                rate = pace.rate(done)
            if advance is not None:
                words = f"{done:.4g} of {runs} runs"
                if rate > 0.0 and not at_most:
                    advance(done, words, max(runs - done, 0.0) / rate)
                else:
                    advance(done, f"{words}, {hint}" if hint else words, math.nan)

        yield update


Advance = Callable[[float, str, float], None]
"""Called with the finished part, in the unit of the whole, the same in words, and the wall time left [s] or NaN."""


@contextmanager
def _bar(title: str, total: float) -> Iterator[Advance | None]:
    """Provide a bar where one can be seen: in a notebook, or on a terminal."""
    if (display := _notebook()) is not None:
        with _notebook_bar(display, title, total) as advance:
            yield advance
    elif sys.stderr is not None and sys.stderr.isatty():  # a program without a console has none
        with _terminal_bar(title, total) as advance:
            yield advance
    else:
        yield None


def _notebook() -> Any:
    """Return what shows things in a notebook, None outside one."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if getattr(shell, "kernel", None) is None:  # IPython on a terminal has none
        return None
    from IPython.display import display

    return display


@contextmanager
def _terminal_bar(title: str, total: float) -> Iterator[Advance]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.table import Column

    # COLUMNS says anything, and a bar of a hundred million columns takes as long
    console = Console(stderr=True, width=min(max(shutil.get_terminal_size().columns, 40), 1000))
    # where room is scarce, words are cut off, and never the time that remains
    bar_width = min(max(console.width - 80, 8), 40)
    room = max(console.width - len(title) - bar_width - 2 * len("0:00:00") - 4, 8)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width),
        TextColumn(
            "{task.fields[words]}", table_column=Column(no_wrap=True, overflow="ellipsis", max_width=room)
        ),
        TimeElapsedColumn(table_column=Column(no_wrap=True)),
        TimeRemainingColumn(table_column=Column(no_wrap=True)),
    )
    with Progress(*columns, console=console) as bar:
        task = bar.add_task(title, total=total, words="")
        yield lambda done, words, _: bar.update(task, completed=done, words=words)
        bar.update(task, refresh=True)


@contextmanager
def _notebook_bar(display: Any, title: str, total: float) -> Iterator[Advance]:
    """Draw a bar by HTML's own element, which every front end knows; rich's needs widgets in the kernel."""
    state: list[Any] = [0.0, ""]
    began, drawn = monotonic(), [0.0]
    busy = threading.Lock()

    def bundle() -> dict[str, str]:
        done, words = state[0], f"{title}: {state[1]}, {monotonic() - began:.3g} s"
        element = f'<progress max="{total:g}" value="{done:g}" style="vertical-align: middle"></progress>'
        return {"text/plain": words, "text/html": f"<div>{element} {html.escape(words)}</div>"}

    handle = display(bundle(), raw=True, display_id=True)

    def advance(done: float, words: str, left: float) -> None:
        with busy:  # runs of a sweep report from several threads
            state[:] = [done, words if math.isnan(left) else f"{words}, about {in_words(left)} left"]
            if monotonic() - drawn[0] >= _REDRAWN:
                drawn[0] = monotonic()
                handle.update(bundle(), raw=True)

    try:
        yield advance
    finally:
        handle.update(bundle(), raw=True)
