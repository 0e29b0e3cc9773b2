"""Sticking threshold: where a gear begins to stick, and how that depends on how long one waits.

Every mesh exit is a tooth that adhesion may hold back, so that a verdict holds for the exits that were waited for. One
run that sticks after k exits answers for all numbers of exits: it passes up to k of them and no more.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.judge import is_scheduled
from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError
from gearidae.progress import SweepProgress, sweep_progress
from gearidae.runs.estimates import steady_speed
from gearidae.runs.execution import Execution, origin_of, run_kept, solutions
from gearidae.runs.kept_runs import KeptRuns
from gearidae.runs.running import prepare
from gearidae.scene.keys import find_key
from gearidae.studies.products import open_product
from gearidae.studies.requirements import require_gears
from gearidae.studies.threshold_run import ThresholdRun, run_until, value_of

if TYPE_CHECKING:
    from gearidae.scene import Scene

_PARTS = 4
"""Parts into which a bracket is divided at a time, however many runs go side by side: results do not depend on that."""
_WIDTH = 1.0 / 256.0
"""Usual width of a bracket over that of `between`."""
_PATIENCE = 1.5
"""Time that a run gets, over that of the exits at the steady speed."""
_USUAL = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


def sticking_threshold(
    scene: Scene,
    over: str = "coating.sam_fraction",
    between: tuple[Any, Any] = (1.0, 0.4),
    exits: int = 100,
    *,
    width: float | None = None,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Value of a key at which the gear begins to stick, against the number of mesh exits waited for.

    Parameters
    ----------
    scene : Scene
        With gears. Torques that follow a schedule are run for ``run.duration``, in which a gear must stick or pass all
        exits; constant ones for as long as it takes.
    over : str, optional
        Key of a number.
    between : tuple of two values, optional
        Of that key, in SI units or with a unit: at one the gear sticks within `exits`, at the other it does not.
    exits : int, optional
        Mesh exits to wait for.
    width : float, optional
        Width at which a bracket is narrow enough, in the key's SI unit; by default 1/256 of that of `between`.
    executor, jobs, backend, progress, overwrite, resume
        As for `sweep`. With `archive`, finished runs are kept beside it until it is written.
    archive : path, optional
        netCDF file to write.

    Returns
    -------
    Dataset
        Along ``exits`` (1, 2, 5, 10 ... up to `exits`), in the key's unit: ``limit``, the middle of the bracket whose
        ends are ``sticks``, where a run sticks within so many exits, and ``passes``, where it passes them, as at
        all values tried beyond. NaN where no run has stuck so early. Along ``run`` all runs: ``value``,
        ``exits_passed`` until it stuck or its time was over, ``stick_time`` (NaN if it has not stuck) and
        ``simulated_time``.

    Raises
    ------
    SceneError
        If the scene has no gears; a setting is not allowed; the gear does alike at both ends; or in the time of a
        schedule it neither sticks nor passes the exits.
    Interrupted
        On Ctrl-C, with the brackets so far as its ``dataset``.

    Notes
    -----
    Near the limit the outcome is not monotone in the key: a bracket is one place where it changes, the one nearest to
    the end that does not stick among the values tried.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> found = gd.studies.sticking_threshold(scene, between=(0.4, 0.7), exits=5)  # doctest: +SKIP
    >>> float(found.limit.sel(exits=5))  # doctest: +SKIP
    """
    base = prepare(scene, rtol=None, t_end=None, samples="off", backend=backend)
    ends = _ends(base, over, between)
    width = abs(ends[1] - ends[0]) * _WIDTH if width is None else width
    _check(base, exits, width)
    if not is_scheduled(base.to_dict()):  # a schedule has a time of its own
        base = base.replace({"run.duration": _window(base, exits)})
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, base.run.method)
    waits = [*(number for number in _USUAL if number < exits), exits]
    rounds = 1 + math.ceil(math.log(abs(ends[1] - ends[0]) / width, _PARTS))
    most = 2 + (_PARTS - 1) * rounds * len(waits)
    runs: list[ThresholdRun] = []

    def so_far() -> xr.Dataset:
        return _dataset(scene, over, runs, waits, ends, width)

    def work(kept: KeptRuns | None) -> xr.Dataset:
        with sweep_progress(progress, most) as report, how.computing(most) as computing:
            pool = _Pool(base, over, exits, how.backend, computing, kept, partial(_tell, report, most), runs)
            _search(pool, ends, waits, width)
        return so_far()

    return run_kept(
        how,
        lambda target: KeptRuns(target, base, how.driver),
        work,
        {**origin_of(scene), "settings": json.dumps([over, *ends, exits, width])},
        read=lambda path: open_product(path, "sticking_threshold")[0],
        so_far=so_far,
    )


def _tell(report: SweepProgress, most: int, done: int) -> None:
    report(float(done), most)


@dataclass
class _Pool:
    """The runs so far, and where more of them are computed."""

    scene: Scene
    over: str
    exits: int
    backend: str
    executor: Executor | None
    kept: KeptRuns | None
    report: Callable[[int], None]
    runs: list[ThresholdRun]

    def run(self, values: Sequence[float]) -> None:
        """Run the values that have not been run."""
        done = {each.value for each in self.runs}
        todo = sorted({value for value in values if value not in done})
        scenes = [self.scene.replace({self.over: value}) for value in todo]
        found = solutions(self.kept, self.executor, run_until, scenes, self.exits, self.backend)
        for value, (solution, _) in zip(todo, found, strict=True):
            run = ThresholdRun.of(value, solution)
            _refuse_short(self.scene, run, self.exits)
            self.runs.append(run)
            self.report(len(self.runs))


def _refuse_short(scene: Scene, run: ThresholdRun, exits: int) -> None:
    """Refuse a schedule in whose time a gear neither sticks nor passes all exits: one run then gives no answer."""
    if math.isnan(run.stick_time) and run.passed < exits and is_scheduled(scene.to_dict()):
        allowed = (
            f"must be at most {run.passed}, or run.duration longer: at {run.value:g} the gear does not stick in the "
            f"{run.window:g} s of its schedule and passes no more"
        )
        raise SceneError("exits", exits, allowed)


def _search(pool: _Pool, ends: tuple[float, float], waits: Sequence[int], width: float) -> None:
    """Narrow the brackets of all numbers of exits."""
    pool.run(ends)
    _check_ends(pool, ends)
    while True:
        wanted: list[float] = []
        for exits in waits:
            sticks, passes = _bracket(pool.runs, exits)
            if abs(passes - sticks) > width:  # never so of NaN
                inner = np.linspace(sticks, passes, _PARTS + 1)[1:-1]
                wanted += inner.tolist()
        if not wanted:
            return
        pool.run(wanted)


def _bracket(runs: Sequence[ThresholdRun], exits: int) -> tuple[float, float]:
    """Value nearest to the passing end at which a run sticks within so many exits, and the next beyond it."""
    ordered = sorted(runs, key=lambda run: run.value)
    if ordered[0].passed > ordered[-1].passed:  # go from the end that sticks to the other
        ordered.reverse()
    bracket = (math.nan, math.nan)
    for one, high in pairwise(ordered):
        if one.passed < exits <= high.passed:
            bracket = (one.value, high.value)
    return bracket


def _check_ends(pool: _Pool, ends: tuple[float, float]) -> None:
    """Require that one end sticks and the other does not."""
    first, second = (next(run for run in pool.runs if run.value == end) for end in ends)
    if (first.passed < pool.exits) == (second.passed < pool.exits):
        what = "sticks" if first.passed < pool.exits else "passes them"
        passed = f"{first.passed} and {second.passed} mesh exits"
        allowed = f"must have one end at which the gear sticks within {pool.exits} exits: at both it {what} ({passed})"
        raise SceneError("between", list(ends), allowed)


def _dataset(
    scene: Scene,
    over: str,
    runs: Sequence[ThresholdRun],
    waits: Sequence[int],
    ends: tuple[float, float],
    width: float,
) -> xr.Dataset:
    """Make the dataset of brackets and runs."""
    brackets = (
        np.array([_bracket(runs, exits) for exits in waits]) if runs else np.full((len(waits), 2), np.nan)
    )
    ordered = sorted(runs, key=lambda run: run.value)
    unit = find_key(type(scene), over).unit or "1"
    return xr.Dataset(
        {
            "limit": (
                "exits",
                brackets.mean(axis=1),
                {"units": unit, "long_name": f"sticking limit of {over}"},
            ),
            "sticks": (
                "exits",
                brackets[:, 0],
                {"units": unit, "long_name": f"{over} at which the gear sticks"},
            ),
            "passes": ("exits", brackets[:, 1], {"units": unit, "long_name": f"{over} at which it does not"}),
            "value": ("run", np.array([run.value for run in ordered]), {"units": unit, "long_name": over}),
            "exits_passed": (
                "run",
                np.array([run.passed for run in ordered], dtype=np.int64),
                {"units": "1", "long_name": "mesh exits until the gear stuck, or the run was over"},
            ),
            "stick_time": (
                "run",
                np.array([run.stick_time for run in ordered]),
                {"units": "s", "long_name": "when the gear stuck"},
            ),
            "simulated_time": (
                "run",
                np.array([run.window for run in ordered]),
                {"units": "s", "long_name": "simulated time"},
            ),
        },
        coords={"exits": ("exits", np.array(waits), {"units": "1", "long_name": "mesh exits waited for"})},
        attrs={
            **provenance(scene, "searched the sticking threshold", swept=(over,)),
            "title": f"{scene.name}: sticking threshold",
            "summary": f"Limit of {over} at which the gear begins to stick, against mesh exits waited for.",
            "between": list(ends),
            "width": width,
        },
    )


def _ends(scene: Scene, over: str, between: tuple[Any, Any]) -> tuple[float, float]:
    """Both ends in SI units."""
    if len(between) != 2:
        raise SceneError("between", list(between), "must be two values")
    low, high = (value_of(scene.replace({over: end}), over) for end in between)
    if low == high:
        raise SceneError("between", list(between), "must be two different values")
    return low, high


def _check(scene: Scene, exits: int, width: float) -> None:
    require_gears(scene)
    if not isinstance(exits, int) or isinstance(exits, bool) or exits < 1:
        raise SceneError("exits", exits, "must be a whole number, 1 or more")
    if not 0.0 < width < math.inf:
        raise SceneError("width", width, "must be positive")


def _window(scene: Scene, exits: int) -> float:
    """Simulated time that a run gets [s]."""
    assert scene.gears is not None
    assert scene.initial is not None
    speed = steady_speed(scene)
    if not 0.0 < speed < math.inf:
        speed = scene.initial.gear_speed
    if speed <= 0.0:
        allowed = "must turn the gear, or initial.gear_speed be positive"
        raise SceneError("drive.torque", scene.drive.torque if scene.drive else 0.0, allowed)
    return _PATIENCE * (exits + 1) * 2.0 * math.pi / (scene.gears.gear_teeth * speed)
