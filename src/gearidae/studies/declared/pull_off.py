"""Part single pairs of teeth with drawn asperities: the distribution of their pull-off force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError
from gearidae.mesh.involute import flank_arc
from gearidae.populations.flanks import first_flanks
from gearidae.progress import sweep_progress
from gearidae.runs.execution import Execution, RunOptions
from gearidae.runs.executors import side_by_side
from gearidae.scene import GearScene, Scene, TrainScene, require_gears
from gearidae.scene.pairs import quantity
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.runs.run_cache import RunCache
    from gearidae.studies.drawn_contact import PullOff

_MOST: Final = 1_000_000
_PIECE: Final = 50
"""Pairs that are parted at a time."""


def pull_off(
    scene: Scene,
    seeds: int | Sequence[int] = 100,
    *,
    load: float | None = None,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Largest tension of one drawn pair of teeth, for many surfaces of one design.

    A pair at the pitch point (or the roller) has discrete asperities, as with ``contact.roughness = "discrete"``. It is
    pressed along the normal until it first carries the load and then parted, gaps prescribed, bodies rigid. The law of
    the mean over many surfaces says nothing of a single contact where few asperities hold.

    Parameters
    ----------
    scene : Scene
        A pair of gears or a roller, of which only radius, width and surfaces count. Asperities are drawn with
        every ``contact.roughness``.
    seeds : int or sequence of int, optional
        Number of drawn surfaces, from ``contact.seed`` on, or the seeds themselves. A seed draws the drive flank of the
        pinion's first tooth, as in `gearidae.population`.
    load : float, optional
        Force that presses the pair [N]; by default that of the mean torque of the drive. A roller needs one.
    **options
        ``executor``, ``jobs``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`; nothing is
        kept beside the archive, as a thousand pairs take some seconds.

    Returns
    -------
    Dataset, dims (seed)
        ``pull_off`` [N], 0 where a pair never pulls; ``asperities_joined`` under the load, ``asperities_holding`` at
        the largest tension (0 where the attraction across the gap alone is larger); ``gap`` [m] under the load. The
        load is the attribute ``load`` [N].

    Raises
    ------
    SceneError
        If the scene is a train of several meshes, seeds or load are not allowed, or the archive cannot be written.

    Examples
    --------
    >>> import gearidae as gd
    >>> ds = gd.studies.pull_off(gd.preset("teodorescu2009"), seeds=20)
    >>> ds.pull_off.sizes["seed"]
    20
    """
    if isinstance(scene, TrainScene):
        scene = require_gears(scene)
    numbers, force = _seeds(scene, seeds), _load(scene, load)
    execution = Execution(**options)
    pieces = [numbers[first : first + _PIECE] for first in range(0, len(numbers), _PIECE)]

    def work(_: RunCache | None) -> xr.Dataset:
        results: list[PullOff] = []
        with (
            sweep_progress(execution.progress, len(numbers)) as report,
            execution.computing(len(pieces)) as computing,
        ):
            count = len(pieces)
            for part in side_by_side(computing, _part, [scene] * count, pieces, [force] * count):
                results += part
                report(float(len(results)), len(numbers))
        return _dataset(scene, numbers, force, results)

    return STUDY.compute(execution, scene, work, [numbers, force])


def _part(scene: Scene, seeds: Sequence[int], load: float) -> list[PullOff]:
    """Part the pairs of some seeds."""
    from gearidae.mesh.pair_contact import pair_contact
    from gearidae.studies.drawn_contact import DrawnContact

    contact, arc = pair_contact(scene), 0.0
    if scene.gears is not None:
        arc = float(flank_arc(scene.geometry, scene.geometry.approach))
    return [DrawnContact(scene, flank, contact, arc).pull_off(load) for flank in first_flanks(scene, seeds)]


def _dataset(scene: Scene, seeds: Sequence[int], load: float, results: Sequence[PullOff]) -> xr.Dataset:
    columns = zip(
        ("pull_off", "asperities_joined", "asperities_holding", "gap"),
        zip(*results, strict=True),
        strict=True,
    )
    values = {name: np.array(column, dtype=np.float64) for name, column in columns}
    attributes = {
        **provenance(scene, "parted drawn pairs"),
        "title": f"{scene.name}: pull-off of drawn pairs",
        "summary": "Largest tension of one pair of teeth with drawn asperities, one for each seed.",
        "load": load,
    }
    return STUDY.dataset({"seed": np.array(seeds), **values}, attributes)


def _seeds(scene: Scene, asked: int | Sequence[int]) -> list[int]:
    """Numbers of the surfaces."""
    first = scene.contact.seed
    try:
        numbers: Sequence[int] = asked  # type: ignore[assignment]
        if isinstance(asked, int | np.integer) and not isinstance(asked, bool):
            numbers = range(first, first + int(asked))
        seeds = [int(number) for number in numbers if float(number).is_integer()]
        right = len(seeds) == len(numbers) and min(seeds) >= 0 and len(seeds) <= _MOST
    except (TypeError, ValueError):
        right = False
    if not right:
        raise SceneError(
            "seeds", str(asked)[:60], f"must be a number from 1 to {_MOST}, or whole numbers of 0 or more"
        )
    return seeds


def _load(scene: Scene, load: float | None) -> float:
    if load is None and isinstance(scene, GearScene):
        from gearidae.runs.estimates import mean_force

        load = mean_force(scene)
    if load is None or not 0.0 < load < np.inf:
        raise SceneError(
            "load", load, "must be a positive force in N: the scene has no mean torque that presses a pair"
        )
    return float(load)


def _written(
    *,
    load: Annotated[
        str | None, Option("Force that presses the pair, 1 uN. Default: of the drive's mean torque.")
    ] = None,
) -> dict[str, Any]:
    return {"load": None if load is None else quantity("--load", load, "N")}


def _sentence(ds: xr.Dataset) -> str:
    low, middle, high = _quantiles(ds["pull_off"])
    return f"A drawn pair parts at {middle} (median of {ds.sizes['seed']}; 80 % between {low} and {high})."


def _quantiles(values: xr.DataArray) -> list[str]:
    quantiles = np.quantile(values.values, (0.1, 0.5, 0.9))
    unit = str(values.attrs["units"])
    return [f"{value:.3g}" if unit == "1" else with_prefix(float(value), unit, 3) for value in quantiles]


def _rows(ds: xr.Dataset) -> Rows:
    """Quantiles of the forces and of the numbers of asperities."""
    yield f"Pressed with {with_prefix(float(ds.attrs['load']), 'N', 3)} and parted", "median", "10 and 90 %"
    for name, words in (
        ("pull_off", "pull-off"),
        ("asperities_joined", "asperities joined under the load"),
        ("asperities_holding", "asperities that hold"),
    ):
        low, middle, high = _quantiles(ds[name])
        yield words, middle, f"{low} and {high}"
    never = int((ds["pull_off"] == 0.0).sum())
    yield "pairs that never pull", str(never), f"of {ds.sizes['seed']}"


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of drawn pairs that part below a force.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.pull_off`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes

    Raises
    ------
    SceneError
        If the dataset is none of pull-off forces.
    """
    from gearidae.drawing.style import line_colour, new_axes, scale_for, tidy

    forces = np.sort(STUDY.require(ds)["pull_off"].values)
    scale = scale_for(float(forces[-1]), "N")
    ax = new_axes(ax, height=3.2)
    shares = np.arange(1, forces.size + 1) / forces.size
    ax.step(np.append(0.0, forces) * scale.factor, np.append(0.0, shares), where="post", color=line_colour(0))
    ax.set_xlabel(f"pull-off ({scale.unit})")
    ax.set_ylabel("share of the pairs that part")
    ax.set_ylim(0.0, 1.0)
    tidy(ax)
    return ax


STUDY = Study(
    kind="pull_off",
    words="study of pull-off forces",
    maker="pull-off",
    title="Pull-off",
    command=_written,
    options=("seeds",),
    announcement=lambda _, __, seeds, **___: f"{seeds} drawn pairs",
    examples=('gearidae pull-off mine.toml --seeds 1000 --load "1 uN"',),
    columns={
        "seed": Column(("seed",), "1", "seed of the asperities"),
        "pull_off": Column(("seed",), "N", "largest tension of one drawn pair"),
        "asperities_joined": Column(("seed",), "1", "asperities joined under the load"),
        "asperities_holding": Column(("seed",), "1", "asperities that hold at the largest tension"),
        "gap": Column(("seed",), "m", "gap of the mean planes under the load"),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("pull_off", "Share of drawn pairs that part below a force", draw=picture),),
)
