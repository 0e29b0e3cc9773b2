"""Ensembles: keys that are known as distributions, the distribution of what the runs do, and what it depends on."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Mapping
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.keep import read_keep
from gearidae.archive.specimen import SEED
from gearidae.archive.variables import extreme_names
from gearidae.errors import SceneError
from gearidae.runs.execution import Execution
from gearidae.runs.running import prepare
from gearidae.runs.sweeping import run_study
from gearidae.scene.group import did_you_mean, shorten
from gearidae.studies.design import Design, check_design, pick_freeze_design, plain_design
from gearidae.studies.distributions import read_distributions
from gearidae.studies.indices import FEWEST, Indices, indices_of
from gearidae.studies.members import along_members, member_plan, names_of
from gearidae.studies.seeds import NO_INDEX, SEEDS, seed_numbers, without_seeds

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress
    from gearidae.scene import Scene

log = logging.getLogger(__name__)


def ensemble(
    scene: Scene,
    vary: Mapping[str, Any],
    size: int,
    design: str = "sobol",
    *,
    seed: int = 0,
    of: str | None = None,
    executor: Executor | None = None,
    jobs: int | None = None,
    backend: str = "auto",
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Run a scene with keys drawn from distributions.

    Parameters
    ----------
    scene : Scene
        What the runs have in common.
    vary : mapping of str to object
        Key of a number to its distribution: a frozen one of scipy.stats in SI units, or a text with units,
        ``normal(mean, standard deviation)``, ``truncnormal(mean, standard deviation, lowest, highest)``,
        ``uniform(lowest, highest)`` or ``lognormal(median, geometric standard deviation)`` with the latter a pure
        number above 1. The keys are independent of each other. ``{"contact.seed": "seeds"}``, alone or beside others,
        gives each member of a population a surface of its own: its seeds are numbered from the scene's own on.
    size : int
        Number of members; with `of` the number N of rows, a power of 2, and the ensemble has N times (keys + 2)
        members.
    design : {"sobol", "random"}, optional
        Scrambled Sobol' points, which cover the distributions more evenly, or pseudo-random ones.
    seed : int, optional
        Of the design; the same seed draws the same members.
    of : str, optional
        Figure whose Sobol' indices are wanted: ``sticks`` (0 or 1), ``impacts``, or one of the extremes, such as
        ``min_gear_speed`` or ``largest_mesh_force``. Seeds have no index: they are no continuous input. What the
        indices of the keys leave over of the variance is the scatter between the gears of one design.
    executor, jobs, backend, progress, archive, overwrite, resume
        As for `gearidae.sweep`. Threads work side by side where the runs share their surface; if keys of the surface
        vary, much of the time goes into tables of the force law, and processes are faster.

    Returns
    -------
    Dataset
        Along ``member``: the keys' values as coordinates (SI), ``verdict`` and ``verdict_code``, ``sticks``, and what
        the solver keeps of each run (``min_gear_speed``, ``stick_time``, ``mesh_exits``, ``largest_mesh_force``, ...),
        with seeds also its energies (``drive_work``, ``adhesion_loss``, ...).
        Members that could not be finished are there with their ``status`` and ``message``. With `of` the coordinates
        ``matrix`` and ``row``, and along ``parameter`` the indices ``first_order`` and ``total_order``, each with its
        standard ``..._uncertainty``; the attribute ``index_rows`` says how many rows they rest on.

    Raises
    ------
    SceneError
        If a key, a distribution or a setting is not allowed, or a value that was drawn is outside the key's range;
        nothing has been run then.
    Interrupted
        On Ctrl-C, with the runs so far as its ``dataset``.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> vary = {"coating.sam_fraction": "uniform(0.4, 0.8)", "drive.torque": "normal(4.5e-18, 2e-19)"}
    >>> ds = gd.studies.ensemble(scene, vary, 128, of="min_gear_speed")  # doctest: +SKIP
    >>> ds.total_order.sel(parameter="drive.torque")  # doctest: +SKIP
    """
    base = prepare(scene, rtol=None, t_end=None, samples="off", backend=backend)
    check_design(size, design, seed, indices=of is not None)
    _check_figure(base, of)
    own = without_seeds(base, vary)
    seeded = own is not vary
    if seeded and of is not None and not own:
        raise SceneError("of", of, f"needs keys beside {SEED}, which has no index")
    distributions = read_distributions(base, own) if own or not seeded else ()
    how = Execution(executor, jobs, backend, progress, archive, overwrite, resume, base.run.method)
    drawn = (plain_design if of is None else pick_freeze_design)(distributions, int(size), design, int(seed))
    texts = names_of(distributions)
    values: dict[str, Any] = {each.key: drawn.values[:, number] for number, each in enumerate(distributions)}
    if seeded:
        values[SEED] = seed_numbers(base, drawn)
    words = {**texts, **({SEED: SEEDS} if seeded else {})}
    plan = member_plan(base, values, words)
    about = {"design": design, "seed": int(seed), "size": int(size), "of": of, "distributions": words}

    def finish(ds: xr.Dataset) -> xr.Dataset:
        ds = _with_design(along_members(ds, tuple(words)), drawn, tuple(texts), of, int(seed))
        if seeded and of is not None:
            ds = ds.assign_attrs(index_comment=NO_INDEX)
        return ds.assign_attrs(_titles(base, words, len(plan.scenes)))

    keep = read_keep(("extremes", "energy_balance") if seeded else ("extremes",), base)
    return run_study(plan, how, {"ensemble": json.dumps(about)}, finish, keep=keep)


def figure_names(scene: Scene) -> tuple[str, ...]:
    """List the figures of a run that indices can be asked of.

    Returns
    -------
    tuple of str
    """
    return ("sticks", "impacts", *extreme_names(scene.roller is not None, scene.contact.model))


def _check_figure(scene: Scene, of: str | None) -> None:
    known = figure_names(scene)
    if of is not None and of not in known:
        meant = did_you_mean(str(of), known)
        raise SceneError(
            "of", shorten(of), f"must be one of {', '.join(known)}{'; ' if meant else ''}{meant}"
        )


def _with_design(
    ds: xr.Dataset, drawn: Design, keys: tuple[str, ...], of: str | None, seed: int
) -> xr.Dataset:
    """Say where in the design each member stands, and what the indices are."""
    if of is None:
        return ds
    figures = ds[of].values.astype(np.float64)
    found = indices_of(figures, len(keys), seed=seed)
    if none := int(np.isnan(figures).sum()):
        log.warning(
            "%d of %d members have no %s: the indices rest on %d rows in which all members have one%s",
            none, figures.size, of, found.rows, f", of {FEWEST} that they need" if found.rows < FEWEST else "",
        )  # fmt: skip
    ds = ds.assign_coords(
        matrix=("member", drawn.matrix, {"long_name": "matrix of the design", "units": "1"}),
        row=("member", drawn.row, {"long_name": "row of the matrix", "units": "1"}),
        parameter=("parameter", np.array(keys), {"long_name": "key that was drawn", "units": "1"}),
    )
    return ds.assign(_index_variables(found, of)).assign_attrs(index_of=of, index_rows=found.rows)


def _index_variables(found: Indices, of: str) -> dict[str, Any]:
    words = {
        "first_order": f"share of the variance of {of} that the key makes alone",
        "total_order": f"share of the variance of {of} that the key makes, interactions included",
    }
    made: dict[str, Any] = {}
    for name, long_name in words.items():
        made[name] = ("parameter", getattr(found, name), {"long_name": long_name, "units": "1"})
        about = {"long_name": f"standard uncertainty of {name}", "units": "1"}
        made[f"{name}_uncertainty"] = ("parameter", getattr(found, f"{name}_uncertainty"), about)
    return made


def _titles(scene: Scene, texts: Mapping[str, str], members: int) -> dict[str, str]:
    drawn = ", ".join(
        f"{key} numbered" if key == SEED else f"{key} from {text}" for key, text in texts.items()
    )
    return {
        "title": f"{scene.name}: ensemble of {members} runs",
        "summary": (
            f"Verdicts and figures of {members} runs with {drawn}. The attribute 'scene' holds what they have in "
            "common, in SI units."
        ),
    }
