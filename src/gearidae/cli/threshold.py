"""``gearidae threshold``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import gearidae as gd
from gearidae.archive import check_target
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.output import is_quiet, say
from gearidae.cli.tables import show_rows
from gearidae.cli.values import default_output, sweep_values
from gearidae.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["search_threshold"]


def search_threshold(
    case: str,
    over: str,
    exits: int,
    output: Path | None,
    settings: Sequence[str],
    jobs: int | None,
    *,
    overwrite: bool,
    resume: bool,
) -> int:
    """Search the sticking threshold of a case, keep it, show it.

    Parameters
    ----------
    case : str
        Case file or preset.
    over : str
        ``key=a,b``.
    exits : int
        Mesh exits to wait for.
    output : Path or None
        File to write; None for the case's name with ``_threshold.nc``.
    settings : sequence of str
        ``key=value`` pairs.
    jobs : int or None
        Runs at a time; None for one per core.
    overwrite, resume : bool
        As for a sweep.

    Returns
    -------
    int
        Exit code.
    """
    target = output or default_output(case, "_threshold.nc")
    ((key, ends),) = sweep_values([over]).items()
    if len(ends) != 2:
        raise SceneError("--over", over, f"needs two values, at one of which the gear sticks: {key}=0.4,0.7")
    check_target(target, overwrite=overwrite or resume)
    found = gd.studies.sticking_threshold(
        read_scene(case, settings),
        key,
        (ends[0], ends[1]),
        exits,
        jobs=jobs,
        progress=not is_quiet(),
        archive=target,
        overwrite=overwrite,
        resume=resume,
    )
    show_rows(_rows(found, key))
    say(f"Threshold: {target}")
    return DONE


def _rows(found: xr.Dataset, key: str) -> Iterator[tuple[str, str, str]]:
    """Limit and bracket for each number of exits."""
    unit = "" if found["limit"].attrs["units"] == "1" else f" {found['limit'].attrs['units']}"
    yield f"Sticking limit of {key}", "", ""
    for exits in found["exits"].values:
        one = found.sel(exits=exits)
        waited = f"within {exits} mesh exit{'s' if exits > 1 else ''}"
        if np.isnan(one["limit"]):
            yield waited, "-", "no run has stuck so early"
            continue
        limit, sticks, passes = _apart(*(float(one[name]) for name in ("limit", "sticks", "passes")))
        yield waited, f"{limit}{unit}", f"sticks at {sticks}{unit}, passes at {passes}{unit}"
    yield "runs", str(found.sizes["run"]), ""


def _apart(limit: float, sticks: float, passes: float) -> Iterator[str]:
    """Write a limit and the ends of its bracket with as many digits as tell the ends apart, four at least."""
    digits = next((n for n in range(4, 17) if f"{sticks:.{n}g}" != f"{passes:.{n}g}"), 17)
    return (f"{value:.{digits}g}" for value in (limit, sticks, passes))
