"""What ``python -m gearidae_bench`` does with ``--attack``, ``--forge`` and ``--kills``."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console

from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import say, show_rows
from gearidae.errors import SceneError
from gearidae.runs.executors import check_jobs
from gearidae_bench.attack import Outcome, run_attack
from gearidae_bench.attack_report import balance_rows, ending_rows, page
from gearidae_bench.attack_worker import attack_friction, attack_one, attack_population
from gearidae_bench.forge import is_forged, run_forge
from gearidae_bench.kills import run_kills

__all__ = ["ATTACK_BUDGET", "bench_attack", "bench_forge", "bench_kills"]

_TARGETS = {"": attack_one, "population": attack_population, "friction": attack_friction}
ATTACK_BUDGET = 20_000
"""Steps after which a scene of the attack is left alone."""


def bench_attack(
    runs: int, seed: int, jobs: int | None, output: Path | None, patience: float, *, kind: str = ""
) -> int:
    """Run extreme scenes, print how they ended, and write the page about them if asked.

    What is done when Ctrl-C comes is printed and written all the same.

    Parameters
    ----------
    runs, seed : int
        How many scenes, and which.
    jobs : int or None
        Processes to share them; by default one per core.
    output : Path or None
        Folder for ``attack.md``.
    patience : float
        Seconds without a report after which a scene is taken to hang.
    kind : {"", "population", "friction"}, optional
        Whether the scenes have real asperities, or friction.

    Returns
    -------
    int
        Exit code: `UNFINISHED` if there is a fault.
    """
    _check_runs(runs, seed)
    if not patience > 0.0:
        raise SceneError("--patience", patience, "must be above 0 s")
    outcomes: list[Outcome] = []
    interrupted = False
    with Console(stderr=True).status("") as status:

        def note(outcome: Outcome) -> None:
            outcomes.append(outcome)
            faults = sum(not one.sound for one in outcomes)
            status.update(f"{len(outcomes)} of {runs}, {faults} faults ...")

        try:
            run_attack(
                runs,
                seed,
                check_jobs(jobs),
                budget=ATTACK_BUDGET,
                patience=patience,
                report=note,
                target=_TARGETS[kind],
            )
        except KeyboardInterrupt:
            interrupted = True
    if not outcomes:
        raise KeyboardInterrupt
    outcomes.sort(key=lambda outcome: outcome.number)
    show_rows([(ending, str(count), "") for ending, count, _ in ending_rows(outcomes)])
    show_rows([(f"residual / bound, {share}", ratio, "at most") for share, ratio in balance_rows(outcomes)])
    faults = [outcome for outcome in outcomes if not outcome.sound]
    for outcome in faults:
        say(f"scene {outcome.number}: {outcome.status} {outcome.message}")
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        (output / "attack.md").write_text(page(outcomes, seed, datetime.now(UTC).date(), runs, kind=kind))
        say(f"Report: {output / 'attack.md'}")
    if interrupted:
        raise KeyboardInterrupt(f"{len(outcomes)} of {runs} scenes done")
    return UNFINISHED if faults else DONE


def bench_forge(runs: int, seed: int, jobs: int | None) -> int:
    """Forge checkpoints and damage archives, let commands read them, and print what did not end in one line.

    Parameters
    ----------
    runs, seed : int
        How many files (every fifth a forged checkpoint), and which changes.
    jobs : int or None
        Processes to share them; by default one per core.

    Returns
    -------
    int
        Exit code: `UNFINISHED` if there is a fault.
    """
    _check_runs(runs, seed)
    done: list[Outcome] = []
    interrupted = False
    with Console(stderr=True).status("") as status:

        def note(outcome: Outcome) -> None:
            done.append(outcome)
            status.update(f"{len(done)} of {runs}, {sum(not one.sound for one in done)} faults ...")

        try:
            run_forge(runs, seed, check_jobs(jobs), note)
        except KeyboardInterrupt:
            interrupted = True
    faults = sorted((one for one in done if not one.sound), key=lambda one: one.number)
    for kind, forged in (("forged checkpoints", True), ("damaged archives", False)):
        count, bad = (sum(is_forged(one.number) is forged for one in some) for some in (done, faults))
        show_rows([(kind, f"{count}", f"{bad} faults")])
    for one in faults:
        say(f"file {one.number}: {one.status} {one.message}")
    if interrupted:
        raise KeyboardInterrupt(f"{len(done)} of {runs} files done")
    return UNFINISHED if faults else DONE


def _check_runs(runs: int, seed: int) -> None:
    if runs < 1 or seed < 0:
        raise SceneError("--runs, --seed", f"{runs}, {seed}", "must be at least 1, and at least 0")


def bench_kills(kills: int, seed: int) -> int:
    """Kill runs, sweeps and maps at random moments, resume them, and compare with undisturbed ones.

    Parameters
    ----------
    kills, seed : int
        How many, and which moments.

    Returns
    -------
    int
        Exit code: `UNFINISHED` if anything differs.
    """
    _check_runs(kills, seed)
    with Console(stderr=True).status("") as status:
        done = run_kills(kills, seed, lambda number: status.update(f"{number} of {kills} kills ..."))
    show_rows(
        [(f"{one.command}, killed and resumed", f"{one.kills}", one.complaint or "equal") for one in done]
    )
    return UNFINISHED if any(one.complaint for one in done) else DONE
