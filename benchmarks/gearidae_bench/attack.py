"""The attack: extreme scenes, each in a process of its own under a watchdog.

A scene may end finished, with a named ending, refused by a `SceneError`, or with its budget of steps used up while
blocks of output and reports of progress came. A fault is a process killed by a signal, no report for a minute, or any
other exception. Scenes without a fault are run again at a hundredth of their tolerance, up to the third impact: does
the motion agree, and does the energy balance warn of it?
"""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from gearidae_bench.attack_worker import Outcome, attack_one, warm_up

__all__ = ["PATIENCE", "Outcome", "run_attack"]

PATIENCE = 60.0
"""Seconds without any report after which a scene is taken to hang."""

_LOOK = 0.5  # [s] between looks at the clocks
_STACK_TIME = 2.0  # [s] for a silent process to write where it is


@dataclass(slots=True)
class _Running:
    """One process and what is known of it."""

    number: int
    process: Any  # multiprocessing's type depends on the start method
    reports: Connection
    trace: Path
    heard: float
    longest: float = 0.0
    outcome: Outcome | None = None

    def hear(self) -> None:
        """Take the reports that have come."""
        now = time.monotonic()
        self.longest, self.heard = max(self.longest, now - self.heard), now
        try:
            while self.reports.poll():
                message = self.reports.recv()
                self.outcome = message if isinstance(message, Outcome) else self.outcome
        except (EOFError, OSError):  # it is at its end, however that was
            pass


def run_attack(
    runs: int | range,
    seed: int,
    jobs: int = 1,
    *,
    budget: int,
    patience: float = PATIENCE,
    report: Callable[[Outcome], None] | None = None,
    target: Callable[..., None] = attack_one,
) -> list[Outcome]:
    """Run so many extreme scenes.

    Parameters
    ----------
    runs : int or range
        How many, or which.
    seed : int
    jobs : int, optional
        Processes at a time.
    budget : int
        Steps after which a scene is left alone.
    patience : float, optional
        Seconds without a report after which a process is killed.
    report : callable, optional
        Told each outcome as it is there.
    target : callable, optional
        What runs in the process; another one tests the watchdog.

    Returns
    -------
    list of Outcome
        In the order of their numbers.
    """
    numbers = iter(range(runs) if isinstance(runs, int) else runs)
    outcomes: list[Outcome] = []
    with tempfile.TemporaryDirectory(prefix="attack") as folder:
        for outcome in _watched(numbers, seed, jobs, (budget, patience, Path(folder), target)):
            outcomes.append(outcome)
            if report is not None:
                report(outcome)
    return sorted(outcomes, key=lambda outcome: outcome.number)


def _watched(
    numbers: Iterator[int], seed: int, jobs: int, settings: tuple[int, float, Path, Callable[..., None]]
) -> Iterator[Outcome]:
    """Keep so many processes busy, and yield outcomes as they come."""
    budget, patience, folder, target = settings
    # the server is warm: each process is a copy of it, with everything imported and compiled
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([warm_up.__module__, "gearidae_bench.attack_server"])
    running: list[_Running] = []
    try:
        while True:
            while len(running) < jobs and (number := next(numbers, None)) is not None:
                running.append(_begin(context, target, (seed, number, budget), folder))
            if not running:
                return
            wait([one.reports for one in running] + [one.process.sentinel for one in running], timeout=_LOOK)
            for one in list(running):
                outcome = _look(one, patience)
                if outcome is not None:
                    running.remove(one)
                    yield outcome
    finally:
        for one in running:
            one.process.kill()


def _begin(
    context: Any, target: Callable[..., None], arguments: tuple[int, int, int], folder: Path
) -> _Running:
    ours, theirs = context.Pipe(duplex=False)
    trace = folder / f"{arguments[1]}.txt"
    process = context.Process(target=target, args=(*arguments, theirs, str(trace)), daemon=True)
    process.start()
    theirs.close()
    return _Running(arguments[1], process, ours, trace, time.monotonic())


def _look(one: _Running, patience: float) -> Outcome | None:
    """Hear a process; its outcome if it has ended, or has been silent for too long."""
    if one.reports.poll() or not one.process.is_alive():
        one.hear()
    silent = time.monotonic() - one.heard
    if one.process.is_alive():
        if silent < patience:
            return None
        _ask_where(one)
        one.process.kill()
        one.process.join()
        where = _where(one.trace)
        return Outcome(one.number, "silent", f"no report for {silent:.0f} s, in {where}", longest=silent)
    one.process.join()
    one.hear()
    code = one.process.exitcode
    if one.outcome is not None and code == 0:
        return replace(one.outcome, longest=max(one.longest, one.outcome.longest))
    name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
    return Outcome(one.number, "killed", f"{name}, in {_where(one.trace)}", longest=one.longest)


def _ask_where(one: _Running) -> None:
    """Let a silent process write where it is."""
    if hasattr(signal, "SIGUSR1"):
        os.kill(one.process.pid, signal.SIGUSR1)
        one.process.join(_STACK_TIME)


def _where(trace: Path) -> str:
    """Innermost places of the package in what faulthandler has written."""
    text = trace.read_text() if trace.exists() else ""
    found = re.findall(r'File ".*?([^/\\]+)", line (\d+) in (.*)', text)
    places = [f"{name}:{line} {function}" for name, line, function in found]
    return " < ".join(places[:6]) or "an unknown place"
