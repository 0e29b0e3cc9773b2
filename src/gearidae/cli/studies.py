"""The commands that conduct a study: it is run, kept, and what it has found is shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Final

import gearidae as gd
from gearidae.archive import check_target
from gearidae.cli.case import check_dask, default_output, read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import complain, is_quiet, say, show_rows
from gearidae.cli.request import Request
from gearidae.cli.tables import name_failures
from gearidae.errors import SceneError
from gearidae.runs.executors import check_jobs
from gearidae.runs.kept_runs import folder_beside
from gearidae.scene.pairs import sweep_values
from gearidae.studies.answers import answer
from gearidae.studies.products import kind_of
from gearidae.studies.study import Call

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene
    from gearidae.studies.study import Study

_FRACTION: Final = "coating.sam_fraction"
_TORQUE: Final = "drive.torque"


def run_study(study: Study, case: str, request: Request, call: Call) -> int:
    """Run a study of a case, keep it, show its answer.

    Parameters
    ----------
    case : str
        Path of a case file, or name of a preset.
    call : Call
        From the command of the study.

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
    function = getattr(gd.studies, study.run) if isinstance(study.run, str) else study.run
    words = call.announcement
    if not isinstance(words, str):
        words = words(scene, workers if request.dask is None else None)
    announce(study.title, scene, words, target, resume=request.resume, overwrite=request.overwrite)
    with request.executor(call.keys, call.members) as executor:
        ds = function(
            scene,
            *call.arguments,
            **call.options,
            executor=executor,
            jobs=workers,
            progress=not is_quiet(),
            archive=target,
            overwrite=request.overwrite,
            resume=request.resume,
        )
    found = answer(ds, kind_of(ds))
    show_rows(found.rows)
    say(f"{study.title}: {target}")
    code = _code(ds)
    say(found.sentence)
    return code


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
    if not resume and not folder_beside(target).exists():
        check_target(target, overwrite=overwrite)
    if words:
        say(f"{title} of {scene.name}: {words}")


def conduct(
    case: str,
    request: Request,
    title: str,
    study: Callable[..., xr.Dataset],
    *arguments: Any,
    keys: Mapping[str, Any] | Sequence[str] = (),
    members: int = 0,
    outset: str | Callable[[Scene, int | None], str] = "",
    **options: Any,
) -> int:
    """Run a study that has no declaration yet."""
    made: Any = SimpleNamespace(run=study, title=title, suffix="")
    return run_study(made, case, request, Call(arguments, options, outset, keys, members))


def _code(ds: xr.Dataset) -> int:
    """Name what could not be finished."""
    if "status" not in ds:
        return DONE
    if ds["status"].dims == ("member",):
        return UNFINISHED if name_failures(ds) else DONE
    failed = int((ds["status"].values != "finished").sum())
    if failed:
        complain(f"{failed} runs could not be finished: their status and message are in the file")
    return UNFINISHED if failed else DONE


def search_starting_torque(case: str, request: Request, over: str | None, **options: Any) -> int:
    """Search the starting torque of a case at its own coating, or at fractions, ``coating.sam_fraction=1:0.4:-0.1``."""
    fractions: Any = "own"
    if over is not None:
        ((key, fractions),) = sweep_values([over]).items()
        if key != _FRACTION:
            raise SceneError("--over", over, f"must be {_FRACTION} and its values; set other keys by --set")

    def outset(scene: Scene, _: int | None) -> str:
        from gearidae.studies._starting_seeds import SEEDS

        coatings = "own coating" if fractions == "own" else f"{len(fractions)} fractions of the coating"
        if scene.contact.model != "population":
            return f"{coatings}; one torque is tried after the other"
        gears = options["seeds"] or SEEDS
        return f"{gears} gears, {coatings}; each is run several times, with a torque that rises slowly"

    return conduct(
        case, request, "Starting torque", gd.studies.starting_torque, fractions, outset=outset, **options
    )
