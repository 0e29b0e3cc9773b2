"""``gearidae run`` and ``gearidae sweep``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import gearidae as gd
from gearidae.analysis.verdict.headline import headline
from gearidae.archive import check_target
from gearidae.archive.journal import journal_of
from gearidae.archive.select import run_value, runs
from gearidae.cli.case import check_dask, default_output, read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.machine import archive_facts, print_json
from gearidae.cli.output import is_quiet, print_error, print_line
from gearidae.cli.tables import label_text, show_outcomes, show_summary
from gearidae.errors import SceneError, SolverError
from gearidae.runs.executors import check_jobs, dask_executor
from gearidae.scene.pairs import sweep_values
from gearidae.studies.announcement import grid_words

if TYPE_CHECKING:
    from gearidae.scene import Scene


def run_case(
    case: str,
    output: Path | None,
    settings: Sequence[str],
    rtol: float | None,
    *,
    overwrite: bool,
    resume: bool,
    start: Path | None = None,
    as_json: bool = False,
) -> int:
    """Run one scene, write its archive, print its outcome.

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
    resume : bool
        Whether to resume the run in the archive.
    start : Path, optional
        Archive of another run to go on from.
    as_json : bool, optional
        Whether to print one JSON object in place of tables.

    Returns
    -------
    int
        Exit code.
    """
    _check_resume(resume=resume, overwrite=overwrite)
    target = output or default_output(case, ".nc")
    scene = read_scene(case, settings)
    was_finished = resume and target.exists() and gd.open_archive(target).attrs["status"] == "finished"
    try:
        ds = gd.simulate(
            scene,
            rtol=rtol,
            progress=not is_quiet(),
            archive=target,
            overwrite=overwrite,
            resume=resume,
            start=start,
        )
    except SolverError as error:
        if error.dataset is not None and as_json:
            print_json(archive_facts(target, error.dataset))
        elif error.dataset is not None:
            show_outcomes(error.dataset)
            show_summary(error.dataset)
            print_line(f"Archive of the run up to the failure: {target}")
        print_error(str(error))
        return UNFINISHED
    if as_json:
        print_json(archive_facts(target, ds))
        return DONE
    show_outcomes(ds)
    show_summary(ds)
    if was_finished:
        print_line("The run in this archive was already finished; nothing was computed.")
    print_line(f"Archive: {target}")
    return DONE


def sweep_case(
    case: str,
    over: Sequence[str],
    output: Path | None,
    settings: Sequence[str],
    rtol: float | None,
    jobs: int | None,
    dask: str | None,
    *,
    zipped: bool,
    resume: bool,
    overwrite: bool,
    keep: Sequence[str] | None = None,
    as_json: bool = False,
) -> int:
    """Run a sweep, write its archive, print the outcome of each run.

    Parameters
    ----------
    case, output, settings, rtol, overwrite
        As for `run_case`.
    over : sequence of str
        ``key=values`` pairs.
    jobs : int or None
        Number of simultaneous runs; None for one per core.
    dask : str or None
        Address of the scheduler of a Dask cluster that computes the runs; None for this machine.
    zipped : bool
        Whether the values of all keys are combined in pairs instead of in all combinations.
    resume : bool
        Whether to resume an interrupted sweep.
    keep : sequence of str or None
        What each run leaves behind; None for everything.
    as_json : bool, optional
        Whether to print one JSON object in place of tables.

    Returns
    -------
    int
        Exit code; `UNFINISHED` if any run did not reach its end.
    """
    target = output or default_output(case, ".nc")
    values = sweep_values(over)
    _check_resume(resume=resume, overwrite=overwrite)
    check_dask(dask, jobs)
    workers = check_jobs(jobs)
    scene = read_scene(case, settings)
    words = "" if as_json else grid_words(scene, values, workers if dask is None else None, zipped=zipped)
    announce("Sweep", scene, words, target, resume=resume, overwrite=overwrite)
    with dask_executor(dask) as executor:
        ds = gd.sweep(
            scene,
            values,
            executor,
            rtol=rtol,
            progress=not is_quiet(),
            archive=target,
            overwrite=overwrite,
            jobs=workers,
            zipped=zipped,
            resume=resume,
            keep=keep,
        )
    if as_json:
        print_json({**archive_facts(target, ds), "headline": headline(ds)})
    else:
        show_outcomes(ds)
        print_line(f"Archive: {target}")
    unfinished = () if (ds["status"] == "finished").all() else runs(ds)
    failed = [(label, run) for label, run in unfinished if run_value(run, "status") != "finished"]
    for label, run in failed:
        print_error(f"{label_text(ds, label)}: {run_value(run, 'message') or run_value(run, 'status')}")
    if not as_json:
        print_line(headline(ds))
    return UNFINISHED if failed else DONE


def announce(
    title: str, scene: Scene, words: str, target: Path, *, resume: bool = False, overwrite: bool = False
) -> None:
    """Say what will be run, unless a file is in the way.

    Where runs of an unfinished study are kept, the study itself says what to do with its file.

    Parameters
    ----------
    title, words : str
        What is made, and of which runs.
    target : Path
        File to be written.

    Raises
    ------
    SceneError
        If `target` cannot be written.
    """
    if not resume and not journal_of(target).exists():
        check_target(target, overwrite=overwrite)
    if words:
        print_line(f"{title} of {scene.name}: {words}")


def _check_resume(*, resume: bool, overwrite: bool) -> None:
    if overwrite and resume:
        raise SceneError(
            "--resume", "(given)", "keeps the present file and --overwrite replaces it: choose one"
        )
