"""Run a scene with keys drawn from distributions: how often it sticks, and what that depends on.

Finished runs are kept beside the archive, in OUT.nc.journal, until the archive is written.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.output_selection import read_keep
from gearidae.archive.select import what_of
from gearidae.archive.specimen import SEED_KEYS, has_seeds
from gearidae.archive.train import judged_view
from gearidae.archive.train.variables import MESH_TOTALS, OF_JUDGED
from gearidae.archive.variables import EXTREMES, extreme_names
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweeping import run_study
from gearidae.scene import is_long_train
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.pairs import texts as read_texts
from gearidae.scene.prefixes import with_prefix
from gearidae.studies._sticking_probability import sticking_probability
from gearidae.studies.announcement import draw_words
from gearidae.studies.design import NO_INDEX, Design, check_design, pick_freeze_design, plain_design
from gearidae.studies.indices import FEWEST, indices_of
from gearidae.studies.members import along_members, count_rows, draw_members
from gearidae.studies.options import VARY_EXAMPLE, Vary
from gearidae.studies.study import Column, Picture, Rows, Study

if TYPE_CHECKING:
    from gearidae.scene import Scene
    from gearidae.studies.distributions import Distribution

log = logging.getLogger(__name__)

_FIGURES: Final = (
    "min_gear_speed",
    "max_gear_speed",
    "largest_mesh_force",
    "smallest_mesh_force",
    "stick_time",
)
OF_TRAIN: Final = (*OF_JUDGED, *(name for name in MESH_TOTALS if name in EXTREMES))
"""Extremes of a run of a train, those of the meshes for the one that drives the judged shaft."""
_OF_GEARS: Final = ("settled_gear_speed", *_FIGURES, "asperity_onsets")
"""Figures whose means over the seeds are given."""


def ensemble(
    scene: Scene,
    vary: Mapping[str, Any],
    size: int,
    design: Literal["sobol", "random"] = "sobol",
    *,
    seed: int = 0,
    of: str | None = None,
    **options: Unpack[RunOptions],
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
        gives each member of a population a surface of its own, ``{"mesh.pitch_error_seed": "seeds"}`` teeth with errors
        of their own: the seeds are numbered from the scene's own on.
    size : int
        Number of members; with `of` the number N of rows, a power of 2, and the ensemble has N times (keys + 2)
        members.
    design : {"sobol", "random"}, optional
        Scrambled Sobol' points, which cover the distributions more evenly, or pseudo-random ones.
    seed : int, optional
        Seed of the design; the same one draws the same members.
    of : str, optional
        Figure whose Sobol' indices are wanted: ``sticks`` (0 or 1), ``impacts``, or one of the extremes, such as
        ``min_gear_speed`` or ``largest_mesh_force``; of a train of the judged shaft, and of the mesh that drives it.
        Seeds have no index: they are no continuous input. What the
        indices of the keys leave over of the variance is the scatter between the gears of one design.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`. Threads work side by side where the runs share their surface; if keys of the surface
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
    base, execution = prepared(scene, options, samples="off", trains=True)
    check_design(size, design, seed, indices=of is not None)
    _check_figure(base, of)

    def draw(distributions: Sequence[Distribution]) -> Design:
        if of is None:
            return plain_design(distributions, int(size), design, int(seed))
        if not distributions:
            raise SceneError("of", of, "needs keys beside seeds, which have no index")
        return pick_freeze_design(distributions, int(size), design, int(seed))

    drawn = draw_members(base, vary, draw)
    words = drawn.words
    about = {"design": design, "seed": int(seed), "size": int(size), "of": of, "distributions": words}

    def finish(ds: xr.Dataset) -> xr.Dataset:
        ds = _with_design(along_members(ds, tuple(words)), drawn.design, drawn.keys, of, int(seed))
        if drawn.have_seeds and of is not None:
            ds = ds.assign_attrs(index_comment=NO_INDEX)
        return ds.assign_attrs(_titles(base, words, len(drawn.plan.scenes)))

    selection = read_keep(("extremes", "energy_balance") if drawn.have_seeds else ("extremes",), base)
    return run_study(drawn.plan, execution, {"ensemble": json.dumps(about)}, finish, selection=selection)


def figure_names(scene: Scene) -> tuple[str, ...]:
    """List the figures of a run that indices can be asked of.

    Returns
    -------
    tuple of str
    """
    return ("sticks", "impacts", *(OF_TRAIN if is_long_train(scene) else extreme_names(scene)))


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
    figures = judged_view(ds)[of].values.astype(np.float64)
    indices = indices_of(figures, len(keys), seed=seed)
    if none := int(np.isnan(figures).sum()):
        log.warning(
            "%d of %d members have no %s: the indices rest on %d rows in which all members have one%s",
            none, figures.size, of, indices.rows, f", of {FEWEST} that they need" if indices.rows < FEWEST else "",
        )  # fmt: skip
    values = {name: getattr(indices, name) for name in indices._fields if name in STUDY.columns}
    values |= {"matrix": drawn.matrix, "row": drawn.row, "parameter": np.array(keys)}
    ds = ds.merge(STUDY.dataset(values, {}, of=of)).set_coords(["matrix", "row"])
    return ds.assign_attrs(index_of=of, index_rows=indices.rows)


def _titles(scene: Scene, texts: Mapping[str, str], members: int) -> dict[str, str]:
    drawn = ", ".join(
        f"{key} numbered" if key in SEED_KEYS else f"{key} from {text}" for key, text in texts.items()
    )
    return {
        "title": f"{scene.name}: ensemble of {members} runs",
        "summary": (
            f"Verdicts and figures of {members} runs with {drawn}. The attribute 'scene' holds what they have in "
            "common, in SI units."
        ),
    }


def _check(ds: xr.Dataset) -> None:
    """Refuse what is no ensemble of runs."""
    if "ensemble" not in ds.attrs or "verdict_code" not in ds or ds["verdict_code"].dims != ("member",):
        raise SceneError("dataset", type(ds).__name__, "is no ensemble of runs; make one with ensemble")


def _written(*, vary: Vary) -> dict[str, Any]:
    return {"vary": read_texts(vary, "--vary", VARY_EXAMPLE)}


def _announced(
    scene: Scene,
    workers: int | None,
    *,
    vary: Mapping[str, str],
    size: int,
    of: str | None,
    design: str,
    seed: int,
) -> str:
    check_design(size, design, seed, indices=of is not None)
    drawn_keys = [key for key in vary if key not in SEED_KEYS]
    runs = size if of is None else size * (len(drawn_keys) + 2)  # the matrices of the Sobol' indices
    return draw_words(scene, vary, runs, workers)


def _sentence(ds: xr.Dataset) -> str:
    if not np.isfinite(ds["sticks"]).any():
        return f"None of {ds.sizes['member']} members has been finished."
    estimate = sticking_probability(ds)
    stuck, members = int(estimate["stuck"]), int(estimate["members"])
    unfinished = int(np.isnan(ds["sticks"].values).sum())
    rest = f"; {unfinished} of {ds.sizes['member']} are unfinished and do not count" if unfinished else ""
    return f"{stuck} of {members} members stick: probability of sticking {_probability(estimate)}{rest}."


def _probability(estimate: xr.Dataset) -> str:
    low, high = float(estimate["low"]), float(estimate["high"])
    return f"{float(estimate['probability']):.3g}, 95 % between {low:.3g} and {high:.3g}"


def _rows(ds: xr.Dataset) -> Rows:
    """Probability of sticking, indices, verdicts, figures with their spread."""
    yield str(ds.attrs["title"]), "", ""
    if np.isfinite(ds["sticks"]).any():
        value, band = _probability(sticking_probability(ds)).split(", ")
        yield "probability of sticking", value, band
    if "total_order" in ds:
        yield (
            f"Sobol indices of {ds.attrs['index_of']}",
            "total",
            f"first order, {ds.attrs['index_rows']} rows",
        )
        for key in ds["parameter"].values:
            indices = ds.sel(parameter=key)
            yield str(key), _uncertain(indices, "total_order"), _uncertain(indices, "first_order")
    yield from count_rows(ds["verdict"])
    if "held_by" in ds and (ds["held_by"] != "").any():
        yield "What holds those that stand", "", "at the end of the run"
        yield from count_rows(ds["held_by"].where(ds["held_by"] != "", drop=True))
    ds = judged_view(ds)
    if has_seeds(ds):
        yield from _mean_rows(ds)
        return
    for name in _FIGURES:
        if name in ds and np.isfinite(ds[name]).any():
            low, middle, high = np.nanquantile(ds[name].values, (0.05, 0.5, 0.95))
            low, middle, high = (
                _in_words(value, str(ds[name].attrs["units"])) for value in (low, middle, high)
            )
            yield (
                name.replace("_", " "),
                middle,
                f"90 % between {low} and {high}{_of_members(ds[name].values)}",
            )


def _of_members(values: Floats) -> str:
    """Say how many members have a figure, if not all of them."""
    count = int(np.isfinite(values).sum())
    return "" if count == values.size else f", of the {count} members that have one"


def _in_words(value: float, unit: str) -> str:
    return f"{value:.4g} rad/s" if unit == "rad s-1" else with_prefix(value, unit, 4)


def _uncertain(indices: xr.Dataset, name: str) -> str:
    value = float(indices[name])
    return "none" if math.isnan(value) else f"{value:.3f} +- {float(indices[f'{name}_uncertainty']):.3f}"


def _mean_rows(ds: xr.Dataset) -> Rows:
    """Means over the gears with their standard errors, and how far one gear is from them."""
    if "index_comment" in ds.attrs:
        left = 1.0 - float(ds["first_order"].sum())
        yield (
            ", ".join(key for key in json.loads(ds.attrs["swept"]) if key in SEED_KEYS),
            "no index",
            f"{left:.3f} is no first order of a key: scatter between seeds, and interactions",
        )
    yield "Means over the seeds", "", f"one {what_of(ds)} is one specimen of the design"
    figures = {
        name.replace("_", " "): (ds[name].values, str(ds[name].attrs["units"]).replace("rad s-1", "rad/s"))
        for name in _OF_GEARS
        if name in ds
    }
    if {"adhesion_loss", "drive_work"} <= set(map(str, ds.data_vars)):
        with np.errstate(divide="ignore", invalid="ignore"):
            figures["adhesion loss over drive work"] = (
                ds["adhesion_loss"].values / ds["drive_work"].values,
                "1",
            )
    for name, (values, unit) in figures.items():
        finite = values[np.isfinite(values)]
        if finite.size > 1:
            spread = float(np.std(finite, ddof=1))
            low, high = np.quantile(finite, (0.05, 0.95))
            rest = _of_members(values)
            yield (
                name,
                _with_error(float(finite.mean()), spread / math.sqrt(finite.size), unit),
                f"standard deviation of one gear {spread:.2g}, 90 % between {low:.4g} and {high:.4g}" + rest,
            )


def _with_error(mean: float, error: float, unit: str) -> str:
    """Write a mean to the second digit of its standard error."""
    if not error > 0.0:
        return f"{mean:.6g}" + ("" if unit == "1" else f" {unit}")
    last = math.floor(math.log10(error))
    digits = max(2, math.floor(math.log10(abs(mean))) - last + 2) if mean else 2
    return f"{mean:.{digits}g} +- {error:.2g}" + ("" if unit == "1" else f" {unit}")


def _index_columns() -> dict[str, Column]:
    """Sobol' indices and their uncertainties."""
    columns = {}
    for name, words in (("first_order", " alone"), ("total_order", ", interactions included")):
        columns[name] = Column(
            ("parameter",), "1", f"share of the variance of {{of}} that the key makes{words}"
        )
        columns[f"{name}_uncertainty"] = Column(("parameter",), "1", f"standard uncertainty of {name}")
    return columns


STUDY = Study(
    kind="ensemble",
    words="ensemble of runs",
    maker="ensemble",
    title="Ensemble",
    command=_written,
    options=("size", "of", "design", "seed"),
    announcement=_announced,
    members=lambda vary, size, **_: (vary, size),
    examples=(
        'gearidae ensemble mine.toml --vary "surface.asperity_radius=normal(450 nm, 20 nm)" --size 256',
        'gearidae ensemble mine.toml --vary "coating.sam_fraction=uniform(0.4, 0.8)" --size 256 --of min_gear_speed',
    ),
    columns={
        "verdict_code": Column(("member",), "1", "verdict as a number"),
        "sticks": Column(("member",), "1", "whether the gear sticks"),
        "matrix": Column(("member",), "1", "matrix of the design"),
        "row": Column(("member",), "1", "row of the matrix"),
        "parameter": Column(("parameter",), "1", "key that was drawn"),
        **_index_columns(),
    },
    check=_check,
    sentence=_sentence,
    rows=_rows,
    pictures=(
        Picture("sobol_indices", "What the figure depends on", lambda ds: "total_order" in ds),
        Picture("specimens", "Mean speeds of gears of one design", has_seeds),
        Picture("sticking_probability", "Probability of sticking against one of the keys"),
    ),
)
