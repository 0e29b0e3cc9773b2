"""How the command line runs a study: it is announced, computed and kept, and its answer is shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from gearidae.cli.case import check_dask, default_output, read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.machine import print_json, product_facts
from gearidae.cli.output import is_quiet, print_error, print_line, show_rows
from gearidae.cli.simulation import announce
from gearidae.cli.tables import name_failures
from gearidae.runs.executors import check_jobs
from gearidae.studies.products import answer, kind_of

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.cli.study_commands import Request
    from gearidae.studies.study import Study


def run_study(
    study: Study,
    function: Callable[..., xr.Dataset],
    case: str,
    request: Request,
    arguments: Mapping[str, Any],
) -> int:
    """Run a study of a case, keep it, show its answer.

    Parameters
    ----------
    case : str
        Path of a case file, or name of a preset.
    function : callable
        Of the study.
    arguments : mapping of str to object
        Of the function, from the command line.

    Returns
    -------
    int
        Exit code.
    """
    suffix = study.suffix or study.title.lower().replace(" ", "_")
    target = request.output or default_output(case, f"_{suffix}.nc")
    check_dask(request.dask, request.jobs)
    workers = check_jobs(request.jobs)
    scene = read_scene(case, request.settings or ())
    words = ""
    if study.announcement is not None and not request.as_json:
        words = study.announcement(scene, workers if request.dask is None else None, **arguments)
    keys, members = ((), 0) if study.members is None else study.members(**arguments)
    announce(study.title, scene, words, target, resume=request.resume, overwrite=request.overwrite)
    with request.executor(keys, members) as executor:
        ds = function(
            scene,
            **arguments,
            executor=executor,
            jobs=workers,
            progress=not is_quiet(),
            archive=target,
            overwrite=request.overwrite,
            resume=request.resume,
        )
    if request.as_json:
        print_json(product_facts(target, ds, kind_of(ds)))
        return _code(ds)
    result = answer(ds, kind_of(ds))
    show_rows(result.rows)
    print_line(f"{study.title}: {target}")
    code = _code(ds)
    print_line(result.sentence)
    return code


def _code(ds: xr.Dataset) -> int:
    """Name what could not be finished."""
    if "status" not in ds:
        return DONE
    if ds["status"].dims == ("member",):
        return UNFINISHED if name_failures(ds) else DONE
    failed = int((ds["status"].values != "finished").sum())
    if failed:
        print_error(f"{failed} runs could not be finished: their status and message are in the file")
    return UNFINISHED if failed else DONE
