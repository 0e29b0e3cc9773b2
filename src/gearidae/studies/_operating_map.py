"""Operating maps: what a gear does over two keys, and where it sticks, turns or crosses the backlash."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.codes import CODE_ATTRIBUTES, Outcome, sticking, verdict_codes
from gearidae.errors import SceneError
from gearidae.runs.execution import Execution
from gearidae.runs.running import prepare
from gearidae.runs.sweep_plan import plan_sweep
from gearidae.runs.sweeping import run_study
from gearidae.studies.members import STICKS
from gearidae.studies.requirements import require_gears

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.scene import Scene

_OUTCOME = {
    "long_name": "what the gear does",
    "units": "1",
    "flag_values": np.array(list(Outcome), dtype=np.int8),
    "flag_meanings": " ".join(each.name.lower() for each in Outcome),
    "comment": "a gear that sticks may have crossed the backlash before: flank_changes says how often",
}


def operating_map(
    scene: Scene,
    over: Mapping[str, Iterable[Any]],
    *,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """What the gears do over two keys.

    Parameters
    ----------
    scene : Scene
        With gears.
    over : mapping of str to iterable
        Two keys, such as ``drive.torque`` and ``coating.sam_fraction``, and their values, as for `gearidae.sweep`.
    executor, jobs, backend, progress, archive, overwrite, resume
        As for `gearidae.sweep`.

    Returns
    -------
    Dataset
        Along both keys: ``outcome`` (an `Outcome` as a number: the gear sticks; else the contact has gone over to the
        other flank, so that the teeth have crossed the backlash; else it turns), ``flank_changes``, ``verdict``,
        ``verdict_code``, ``sticks``, and what the solver keeps of each run. Runs that could not be finished say so in
        their ``status``.

    Raises
    ------
    SceneError
        If the scene is a roller, there are not two keys, or a key, a value or a setting is not allowed.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> over = {"drive.torque": [4e-18, 4.5e-18, 5e-18], "coating.sam_fraction": [0.4, 0.6, 0.8]}
    >>> chart = gd.studies.operating_map(scene, over)  # doctest: +SKIP
    >>> ax = gd.plot.outcome_map(chart)  # doctest: +SKIP
    """
    base = prepare(scene, rtol=None, t_end=None, samples="off", backend=backend)
    require_gears(base)
    if not isinstance(over, Mapping) or len(over) != 2:
        allowed = 'must be two keys and their values, {"drive.torque": [...], "coating.sam_fraction": [...]}'
        raise SceneError(
            "over", over if not isinstance(over, Mapping) else ", ".join(map(str, over)), allowed
        )
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, base.run.method)
    plan = plan_sweep(base, over)

    def finish(ds: xr.Dataset) -> xr.Dataset:
        return _judged(ds).assign_attrs(
            title=f"{base.name}: operating map over {' and '.join(over)}",
            summary=f"What the gears do over {' and '.join(over)}: turn, cross the backlash, or stick.",
        )

    return run_study(plan, how, {"study": "operating_map"}, finish)


def _judged(ds: xr.Dataset) -> xr.Dataset:
    """Add verdicts as numbers, and the outcome."""
    dims = ds["status"].dims
    codes = verdict_codes(ds["verdict"].values)
    stuck = sticking(codes)
    outcome = np.where(ds["flank_changes"].values > 0, Outcome.CROSSES_BACKLASH, Outcome.TURNS)
    outcome[stuck == 1.0] = Outcome.STICKS
    outcome[np.isnan(stuck)] = Outcome.UNFINISHED
    return ds.assign(
        verdict_code=(dims, codes, CODE_ATTRIBUTES),
        sticks=(dims, stuck, STICKS),
        outcome=(dims, outcome.astype(np.int8), _OUTCOME),
    )
