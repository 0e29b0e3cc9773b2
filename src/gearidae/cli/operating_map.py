"""``gearidae operating-map``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import gearidae as gd
from gearidae.analysis.verdict.codes import Outcome
from gearidae.cli.case import check_dask, read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import complain, is_quiet, say
from gearidae.cli.tables import show_rows
from gearidae.cli.values import default_output, sweep_values
from gearidae.runs.executors import check_jobs, dask_executor

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["map_outcomes"]

_SIGNS = {Outcome.TURNS: ".", Outcome.CROSSES_BACKLASH: "x", Outcome.STICKS: "#", Outcome.UNFINISHED: "?"}
_WIDEST = 80
"""Values of the second key that are printed in a line."""


def map_outcomes(
    case: str,
    over: Sequence[str],
    output: Path | None,
    settings: Sequence[str],
    jobs: int | None,
    dask: str | None,
    *,
    resume: bool,
    overwrite: bool,
) -> int:
    """Run an operating map of a case, keep it, print it.

    Parameters
    ----------
    case : str
        Case file or preset.
    over : sequence of str
        Two pairs ``key=values``.
    output : Path or None
        File to write; None for the case's name with ``_operating_map.nc``.
    settings : sequence of str
        ``key=value`` pairs.
    jobs : int or None
        Runs at a time; None for one per core.
    dask : str or None
        Address of a Dask scheduler.
    resume, overwrite : bool
        As for a sweep.

    Returns
    -------
    int
        Exit code; `UNFINISHED` if any run did not reach its end.
    """
    target = output or default_output(case, "_operating_map.nc")
    values = sweep_values(over)
    check_dask(dask, jobs)
    workers = check_jobs(jobs)
    scene = read_scene(case, settings)
    with dask_executor(dask) as executor:
        chart = gd.studies.operating_map(
            scene,
            values,
            executor=executor,
            jobs=workers,
            progress=not is_quiet(),
            archive=target,
            overwrite=overwrite,
            resume=resume,
        )
    show_rows(_rows(chart))
    say(f"Operating map: {target}")
    failed = int((chart["status"].values != "finished").sum())
    if failed:
        complain(f"{failed} runs could not be finished: their status and message are in the map")
    return UNFINISHED if failed else DONE


def _rows(chart: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """A line for each value of the first key, a sign for each of the second."""
    down, across = map(str, chart["outcome"].dims)
    yield str(chart.attrs["title"]), "", ""
    ends = [_value(value) for value in chart[across].values[[0, -1]]]
    yield f"{down}, downwards", f"{across}, from {ends[0]} to {ends[1]}", ""
    for row in range(chart.sizes[down]):
        codes = chart["outcome"].values[row, :_WIDEST].tolist()
        signs = "".join(_SIGNS[Outcome(code)] for code in codes)
        yield _value(chart[down].values[row]), signs + ("..." if chart.sizes[across] > _WIDEST else ""), ""
    counts = [(code, int((chart["outcome"].values == code).sum())) for code in _SIGNS]
    legend = [
        f"{_SIGNS[code]} {code.name.lower().replace('_', ' ')}: {count}" for code, count in counts if count
    ]
    yield ", ".join(legend), "", ""


def _value(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float | int | np.number) else str(value)
