"""Progress of a run or a sweep: a bar on a terminal, or whatever the caller wants to be told."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["RunProgress", "SweepProgress", "run_progress", "sweep_progress"]

RunProgress = Callable[[float, int], None]
"""Told the simulated time reached [s] and the number of events so far."""
SweepProgress = Callable[[float, int], None]
"""Told how many runs are done (with fractions for those under way) and how many there are."""


@contextmanager
def run_progress(wanted: bool | RunProgress, duration: float) -> Iterator[RunProgress | None]:
    """Show how far a run is.

    Parameters
    ----------
    wanted : bool or callable
        True for a bar (drawn only if standard error is a terminal), False for nothing, or a function to call.
    duration : float
        Simulated time of the whole run [s].

    Yields
    ------
    callable or None
        What the engine shall call.
    """
    if callable(wanted):
        yield wanted
    elif not wanted or not sys.stderr.isatty():
        yield None
    else:
        from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

        prefix, scale = ("ms", 1e3) if duration < 1.0 else ("s", 1.0)
        with Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn(
                f"{{task.completed:.4g}} of {duration * scale:.4g} {prefix}, {{task.fields[events]}} events, "
                f"{{task.fields[rate]:.3g}} {prefix} per second"
            ),
            TimeRemainingColumn(),
            console=_console(),
        ) as bar:
            task = bar.add_task("simulating", total=duration * scale, events=0, rate=0.0)
            begun: list[tuple[float, float]] = []

            def update(time: float, events: int) -> None:
                now = monotonic()
                if (
                    not begun
                ):  # the rate counts from the first report: compiling is over, and a resumed run is back
                    begun.append((now, time))
                elapsed = now - begun[0][0]
                rate = (time - begun[0][1]) / elapsed * scale if elapsed > 0.0 else 0.0
                bar.update(task, completed=time * scale, events=events, rate=rate)

            yield update
            bar.update(task, refresh=True)


@contextmanager
def sweep_progress(wanted: bool | SweepProgress, runs: int) -> Iterator[SweepProgress]:
    """Show how far a sweep is.

    Parameters
    ----------
    wanted : bool or callable
        As for `run_progress`.
    runs : int
        Number of runs.

    Yields
    ------
    callable
        What the sweep shall call.
    """
    if callable(wanted):
        yield wanted
    elif not wanted or not sys.stderr.isatty():
        yield lambda done, total: None
    else:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        with Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn(f"{{task.percentage:3.0f}} % of {runs} runs"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=_console(),
        ) as bar:
            task = bar.add_task("sweeping", total=runs)
            yield lambda done, total: bar.update(task, completed=done)


def _console() -> Console:
    from rich.console import Console

    return Console(stderr=True)
