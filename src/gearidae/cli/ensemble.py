"""``gearidae ensemble``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import gearidae as gd
from gearidae.cli.case import check_dask, read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.output import is_quiet, say
from gearidae.cli.tables import name_failures, show_rows
from gearidae.cli.values import default_output, texts
from gearidae.runs.executors import check_jobs, dask_executor, own_executor

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["executor_for", "run_ensemble", "show_ensemble"]

_SHOWN = ("min_gear_speed", "max_gear_speed", "largest_mesh_force", "smallest_mesh_force", "stick_time")
_WORTH_PROCESSES = 64
"""Members from which on it is worth while to start processes, which takes some seconds."""


def run_ensemble(
    case: str,
    vary: Sequence[str],
    drawn: Mapping[str, Any],
    output: Path | None,
    settings: Sequence[str],
    jobs: int | None,
    dask: str | None,
    *,
    resume: bool,
    overwrite: bool,
) -> int:
    """Run an ensemble of a case, keep it, show what came of it.

    Parameters
    ----------
    case : str
        Case file or preset.
    vary : sequence of str
        ``key=distribution`` pairs.
    drawn : mapping
        ``size``, ``design``, ``seed`` and ``of``, as for `gearidae.studies.ensemble`.
    output : Path or None
        File to write; None for the case's name with ``_ensemble.nc``.
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
    target = output or default_output(case, "_ensemble.nc")
    distributions = texts(vary, "--vary", "drive.torque=normal(4.5e-18, 2e-19)")
    check_dask(dask, jobs)
    workers = check_jobs(jobs)
    scene = read_scene(case, settings)
    with executor_for(distributions, drawn["size"], workers, dask) as executor:
        ds = gd.studies.ensemble(
            scene,
            distributions,
            **drawn,
            executor=executor,
            jobs=workers,
            progress=not is_quiet(),
            archive=target,
            overwrite=overwrite,
            resume=resume,
        )
    return show_ensemble(ds, "Ensemble", target)


def show_ensemble(ds: xr.Dataset, what: str, target: Path) -> int:
    """Show what came of an ensemble.

    Parameters
    ----------
    ds : Dataset
    what : str
        How to call it.
    target : Path
        Where it is.

    Returns
    -------
    int
        Exit code; `UNFINISHED` if any run did not reach its end.
    """
    show_rows(_rows(ds))
    say(f"{what}: {target}")
    return UNFINISHED if name_failures(ds) else DONE


@contextmanager
def executor_for(
    keys: Iterable[str], members: int, workers: int, dask: str | None
) -> Iterator[Executor | None]:
    """Provide the executor that suits an ensemble; None leaves the choice to the solver.

    Where members differ in their surface each makes tables of the force law, which takes as long as a short run, and
    which threads do side by side in part only.

    Parameters
    ----------
    keys : iterable of str
        That are drawn.
    members, workers : int
        Runs, and runs at a time.
    dask : str or None
        Address of a Dask scheduler.

    Yields
    ------
    Executor or None
    """
    own_tables = any(key.startswith("surface.") or key == "coating.energy" for key in keys)
    if dask is None and own_tables and members >= _WORTH_PROCESSES:
        chosen = own_executor(workers, members, releases_gil=False)
    else:
        chosen = dask_executor(dask)
    with chosen as executor:
        yield executor


def _rows(ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Probability of sticking, verdicts, figures with their spread, indices."""
    members = ds.sizes["member"]
    yield str(ds.attrs["title"]), "", ""
    if np.isfinite(ds["sticks"]).any():
        found = gd.studies.sticking_probability(ds)
        band = f"95 % between {float(found['low']):.3g} and {float(found['high']):.3g}"
        yield "probability of sticking", f"{float(found['probability']):.3g}", band
    for word, count in Counter(ds["verdict"].values.tolist()).most_common():
        yield str(word), str(count), f"{100.0 * count / members:.3g} % of the members"
    for name in _SHOWN:
        if name in ds and np.isfinite(ds[name]).any():
            low, middle, high = np.nanquantile(ds[name].values, (0.05, 0.5, 0.95))
            unit = str(ds[name].attrs["units"])
            yield name, f"{middle:.4g} {unit}", f"90 % between {low:.4g} and {high:.4g}"
    if "total_order" in ds:
        yield (
            f"Sobol indices of {ds.attrs['index_of']}",
            "total",
            f"first order, {ds.attrs['index_rows']} rows",
        )
        for key in ds["parameter"].values:
            one = ds.sel(parameter=key)
            yield str(key), _with_uncertainty(one, "total_order"), _with_uncertainty(one, "first_order")


def _with_uncertainty(one: xr.Dataset, name: str) -> str:
    return f"{float(one[name]):.3f} +- {float(one[f'{name}_uncertainty']):.3f}"
