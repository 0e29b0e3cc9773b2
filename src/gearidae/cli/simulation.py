"""``gearidae run`` and ``gearidae sweep``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import gearidae as gd
from gearidae.archive.select import run_value, runs
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import complain, say
from gearidae.cli.tables import label_text, show_outcomes
from gearidae.cli.values import default_output, sweep_values
from gearidae.errors import SolverError
from gearidae.executors import check_jobs

__all__ = ["run_case", "sweep_case"]


def run_case(
    case: str, output: Path | None, settings: Sequence[str], rtol: float | None, *, overwrite: bool
) -> int:
    """Run one scene, keep its archive, say what it did.

    Parameters
    ----------
    case : str
        Case file or preset.
    output : Path or None
        Archive to write; None for the case's name.
    settings : sequence of str
        ``key=value`` pairs.
    rtol : float or None
        Relative tolerance in place of the scene's.
    overwrite : bool
        Whether the archive may replace a file.

    Returns
    -------
    int
        Exit code.
    """
    target = output or default_output(case, ".nc")
    scene = read_scene(case, settings)
    try:
        ds = gd.simulate(scene, rtol=rtol, progress=True, archive=target, overwrite=overwrite)
    except SolverError as error:
        if error.dataset is not None:
            show_outcomes(error.dataset)
            say(f"Archive of the run up to there: {target}")
        complain(str(error))
        return UNFINISHED
    show_outcomes(ds)
    say(f"Archive: {target}")
    return DONE


def sweep_case(
    case: str,
    over: Sequence[str],
    output: Path | None,
    settings: Sequence[str],
    rtol: float | None,
    jobs: int | None,
    *,
    overwrite: bool,
) -> int:
    """Run a sweep, keep its archive, say what each run did.

    Parameters
    ----------
    case, output, settings, rtol, overwrite
        As for `run_case`.
    over : sequence of str
        ``key=values`` pairs.
    jobs : int or None
        Runs at a time; None for one per core.

    Returns
    -------
    int
        Exit code; `UNFINISHED` if any run did not reach its end.
    """
    target = output or default_output(case, ".nc")
    values = sweep_values(over)
    workers = check_jobs(jobs)
    scene = read_scene(case, settings)
    ds = gd.sweep(scene, values, rtol=rtol, progress=True, archive=target, overwrite=overwrite, jobs=workers)
    show_outcomes(ds)
    say(f"Archive: {target}")
    failed = [(label, run) for label, run in runs(ds) if run_value(run, "status") != "finished"]
    for label, run in failed:
        complain(f"{label_text(label)}: {run_value(run, 'message') or run_value(run, 'status')}")
    return UNFINISHED if failed else DONE
