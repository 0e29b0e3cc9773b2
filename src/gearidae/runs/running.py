"""What a single run and a sweep have in common: checking the request, solving it, naming an early end.

Ctrl-C reaches the main thread alone: a run in another thread ends from inside, once an event of its thread is set.
"""

from __future__ import annotations

import math
import sys
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np

from gearidae.errors import SceneError, SolverError
from gearidae.records import Block, Ending, EventKind, Events, Flank, Solution, Statistics
from gearidae.records.standing import Holding
from gearidae.records.train_results import AnySolution, TrainSolution
from gearidae.scene import Scene, TrainScene, is_long_train, require_gears
from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    import xarray as xr

    from gearidae import engine
    from gearidae.progress import RunReport


SomeScene = TypeVar("SomeScene", bound=Scene)

_NEAR_ROUNDING = 1e-11
"""Tolerance below which long runs of ringing contacts end, as errors of rounding are no smaller."""
_ADVICE = "try another rtol (run.rtol); the samples and events up to there are kept"
_LEAST_MEMORY = 1.25e9
"""Addresses [bytes] that the solver's libraries and threads take; in memory there is a fourth of it."""
FAILS: Final = "fails: "
"""Beginning of the word for a failed run of a study, before its message; such a run does not end a study of several."""
_LAW_CHATTER = Ending.LAW_CHATTER.status
_STATE = ("gear_speed", "pinion_speed", "transmission_error", "drive_gap", "height", "speed", "force")


def prepare(
    scene: SomeScene,
    *,
    rtol: float | None,
    t_end: float | None = None,
    samples: int | str | None,
    backend: str = "auto",
    trains: bool = False,
) -> SomeScene:
    """Put the settings of one call into the scene, so that the scene says exactly what was run.

    Parameters
    ----------
    scene : Scene
        The scene to run.
    rtol : float, optional
        Relative tolerance in place of ``run.rtol``.
    t_end : float, optional
        Simulated time [s] in place of ``run.duration``.
    samples : int or str, optional
        Number or rate of samples, or ``"off"``, in place of ``run.samples``.
    backend : str, optional
        As for `simulate`.
    trains : bool, optional
        Whether trains of several meshes are run.

    Raises
    ------
    SceneError
        If one of the settings is not allowed.
    MemoryError
        If the process may not use enough memory.
    """
    if not isinstance(scene, Scene):
        raise SceneError(
            "scene", type(scene).__name__, "must be a Scene (from load_case, preset or Scene.from_dict)"
        )
    if isinstance(scene, TrainScene) and not (trains and is_long_train(scene)):
        scene = require_gears(scene)  # type: ignore[assignment]  # one mesh: the same model as a pair
    _require_memory()
    from gearidae import engine  # what reads results does without it

    engine.choose_backend(backend, scene.run.method)  # refuses what is unknown or cannot work here
    settings = {"run.rtol": rtol, "run.duration": t_end, "run.samples": samples}
    changes = {key: value for key, value in settings.items() if value is not None}
    return scene.replace(changes) if changes else scene


def with_samples(scene: SomeScene) -> SomeScene:
    """Put the number of samples into a scene that asks for those of the ringing."""
    if scene.run.samples != "ringing":
        return scene
    from gearidae.runs.ringing_samples import counted  # which few runs need

    return scene.replace({"run.samples": counted([scene])})


def _require_memory() -> None:
    """Refuse a process that may use too little memory: compiled libraries end it where they get none."""
    if sys.platform == "win32":
        return
    try:
        import resource
    except ImportError:
        return
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY and limit < _LEAST_MEMORY:
        raise MemoryError(
            f"a simulation takes {_LEAST_MEMORY / 1e9:g} GB of addresses; ulimit -v allows fewer"
        )


def solve(
    scene: Scene,
    backend: str,
    on_progress: Callable[[float, int], None] | None = None,
    *,
    start: engine.Start | None = None,
    on_block: engine.OnBlock | None = None,
) -> Solution:
    """Run a scene; a solver that cannot even start leaves an empty solution that says why.

    Parameters
    ----------
    backend : str
        As for `simulate`.
    on_progress : callable, optional
        Called now and then with the simulated time reached [s] and the number of events so far.
    start : Start, optional
        Where the run begins, if it goes on from another.
    on_block : callable, optional
        Called with every block of output; ends the run by returning True.

    Returns
    -------
    Solution
        Of the status ``interrupted`` after Ctrl-C, also in a thread of `gearidae.runs.executors.own_executor`.
    """
    from gearidae import engine

    try:
        at = engine.AT_ONCE if start is None else start
        return engine.solve(
            scene, backend=backend, on_progress=_heeding(on_progress), start=at, on_block=on_block
        )
    except SolverError as error:
        return unsolved("failed", str(error))


def solve_any(
    scene: Scene,
    backend: str,
    on_progress: Callable[[float, int], None] | None = None,
    *,
    start: engine.Start | None = None,
) -> AnySolution:
    """Run a scene as `solve` does, or a train of several meshes."""
    if not is_long_train(scene):
        return solve(scene, backend, on_progress, start=start)
    from gearidae import engine
    from gearidae.runs.train_run import run_train  # which few runs need

    try:
        at = engine.AT_ONCE if start is None else start
        return run_train(scene, backend, _heeding(on_progress), start=at)
    except SolverError as error:
        return nothing_of(scene, "failed", str(error))


def watched(report: RunReport, on_block: engine.OnBlock | None) -> engine.OnBlock:
    """Return what looks at every block of a run, says to its report whether the gear stands, and calls `on_block`."""

    def report_block(block: Block) -> object:
        if block.extremes is not None and not math.isnan(since := block.extremes.stick_time):
            held = Holding(block.extremes.holding).words
            report.doing = f"{f'held by {held}' if held else 'standing'} since {with_prefix(since, 's')}"
        elif block.extremes is not None:
            report.doing = ""
        return None if on_block is None else on_block(block)

    return report_block


def solve_to_end(scene: Scene, backend: str, start: engine.Start | None = None) -> Solution:
    """Run a scene as `solve` does; a run that Ctrl-C has cut off is no result, and raises `KeyboardInterrupt`."""
    solution = solve(scene, backend, start=start)
    if solution.status == "interrupted":
        raise KeyboardInterrupt
    return solution


def solve_any_to_end(scene: Scene, backend: str, start: engine.Start | None = None) -> AnySolution:
    """Run a scene as `solve_to_end` does, or a train of several meshes."""
    solution = solve_any(scene, backend, start=start)
    if solution.status == "interrupted":
        raise KeyboardInterrupt
    return solution


def unfinished(solution: AnySolution, what: str) -> SolverError:
    """Error of a study whose run, named by `what`, has not come to its end."""
    return SolverError(
        f"{what} could not be finished: {solution.message or solution.status}",
        time=solution.reached or 0.0,
        state={},
        last_event="",
        advice="try another rtol (run.rtol)",
    )


def failure_of(word: str) -> str:
    """Return the message that the word for a failed run carries; empty for another word."""
    return word.removeprefix(FAILS) if word.startswith(FAILS) else ""


def unsolved(status: str, message: str) -> Solution:
    """Solution of a run that produced nothing.

    Parameters
    ----------
    status : str
        Named reason.
    message : str
        The reason in a sentence.

    Returns
    -------
    Solution
        Without samples or events.
    """
    events = Events(
        time=np.empty(0),
        kind=np.empty(0, np.int8),
        pair=np.empty(0, np.int64),
        flank=np.empty(0, np.int8),
        gap_rate=np.empty(0),
    )
    return Solution(np.empty(0), {}, events, Statistics(), status, message)


def early_end(ds: xr.Dataset, time: float, message: str = "", advice: str = _ADVICE) -> SolverError:
    """Say where and how a run ended before its time.

    Parameters
    ----------
    ds : xarray.Dataset
        The data of the run so far, with a status other than ``finished``.
    time : float
        Simulated time reached [s].
    message, advice : str, optional
        What happened and what to try; by default what the dataset says, and another tolerance.

    Returns
    -------
    SolverError
        To be raised; carries `ds`.
    """
    state: dict[str, float] = {}
    sampled = None
    if advice == _ADVICE and ds.attrs["status"] == _LAW_CHATTER:
        advice = _ADVICE.partition("; ")[2]  # another tolerance does not help, and the message says what does
    elif advice == _ADVICE and float(ds.attrs.get("rtol", 1.0)) < _NEAR_ROUNDING:
        advice = f"such a tolerance is near rounding: try run.rtol = {_NEAR_ROUNDING:g}; {_ADVICE.partition('; ')[2]}"
    if ds.sizes["time"]:
        last = ds.isel(time=-1)
        sampled = float(last["time"])
        state = {name: float(last[name]) for name in _STATE if name in ds}
    return SolverError(
        message or str(ds.attrs["message"] or ds.attrs["status"]),
        time=time,
        state=state,
        last_event=_last_event(ds),
        advice=advice,
        dataset=ds,
        state_time=sampled,
    )


def _last_event(ds: xr.Dataset) -> str:
    if not ds.sizes["event"]:
        return "none"
    last = ds.isel(event=-1)
    kind = EventKind(int(last["event_kind"])).name.lower().replace("_", " ")
    flank: Any = Flank(int(last["event_flank"]))
    where = "" if flank is Flank.NONE else f" of pair {int(last['event_pair'])} ({flank.name.lower()} flank)"
    return f"{kind}{where} at {float(last['event_time']):.9g} s"


def nothing_of(scene: Scene, status: str, message: str) -> AnySolution:
    """Solution of a run of a scene that produced nothing, see `unsolved`."""
    if is_long_train(scene):
        return TrainSolution.none([*scene.shafts], [*scene.meshes], status, message)
    return unsolved(status, message)


def _heeding(on_progress: Callable[[float, int], None] | None) -> Callable[[float, int], None]:
    """What a solver reports to: it ends the run where the runs of this thread are to end."""

    def report(time: float, events: int) -> None:
        if is_halted():
            raise KeyboardInterrupt
        if on_progress is not None:
            on_progress(time, events)

    return report


_of_this_thread = threading.local()


def heed(halted: threading.Event) -> None:
    """Let the runs of this thread end as soon as an event is set."""
    _of_this_thread.halted = halted


def is_halted() -> bool:
    """Whether the runs of this thread are to end."""
    halted = getattr(_of_this_thread, "halted", None)
    return halted is not None and halted.is_set()
