"""Pull-off of drawn contacts: the force that parts one pair of teeth, and how it differs from pair to pair."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Final

import numpy as np
import xarray as xr

from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError
from gearidae.mesh.involute import flank_arc
from gearidae.populations.flanks import first_flanks
from gearidae.progress import sweep_progress
from gearidae.runs.estimates import mean_force
from gearidae.runs.execution import Execution, origin_of, run_kept
from gearidae.runs.executors import side_by_side
from gearidae.runs.kept_runs import KeptRuns
from gearidae.runs.pair_contact import pair_contact
from gearidae.scene import Scene
from gearidae.studies.drawn_contact import DrawnContact, PullOff
from gearidae.studies.products import open_product

if TYPE_CHECKING:
    from gearidae.progress import SweepProgress

_MOST: Final = 1_000_000
_PIECE: Final = 50
"""Pairs that are parted at a time."""
_COLUMNS: Final = {
    "pull_off": ("N", "largest tension of one drawn pair"),
    "asperities_joined": ("1", "asperities joined under the load"),
    "asperities_holding": ("1", "asperities that hold at the largest tension"),
    "gap": ("m", "gap of the mean planes under the load"),
}


def pull_off(
    scene: Scene,
    seeds: int | Sequence[int] = 100,
    *,
    load: float | None = None,
    executor: Executor | None = None,
    jobs: int | None = None,
    progress: bool | SweepProgress = False,
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    resume: bool = False,
) -> xr.Dataset:
    """Largest tension of one drawn pair of teeth, for many surfaces of one design.

    A pair at the pitch point (or the roller) has real asperities, as with ``contact.model = "population"``. It is
    pressed along the normal until it first carries the load and then parted, gaps prescribed, bodies rigid. The law of
    the mean over many surfaces says nothing of a single contact where few asperities hold.

    Parameters
    ----------
    scene : Scene
        Gears or a roller, of which only radius, width and surfaces count. Asperities are drawn with
        every ``contact.model``.
    seeds : int or sequence of int, optional
        In place of ``contact.seed``: numbers, or how many from ``contact.seed`` on. A number is the drive flank of the
        pinion's first tooth, as `gearidae.population` draws it.
    load : float, optional
        Force that presses the pair [N]; by default that of the mean torque of the drive. A roller needs one.
    executor, jobs, progress, archive, overwrite, resume
        As for `sweep`; nothing is kept beside the archive, as a thousand pairs take some seconds.

    Returns
    -------
    Dataset, dims (seed)
        ``pull_off`` [N], 0 where a pair never pulls; ``asperities_joined`` under the load, ``asperities_holding`` at
        the largest tension (0 where the attraction across the gap alone is larger); ``gap`` [m] under the load. The
        load is the attribute ``load`` [N].

    Raises
    ------
    SceneError
        If seeds or load are not allowed, or the archive cannot be written.

    Examples
    --------
    >>> import gearidae as gd
    >>> ds = gd.studies.pull_off(gd.preset("teodorescu2009"), seeds=20)
    >>> ds.pull_off.sizes["seed"]
    20
    """
    numbers, force = _seeds(scene, seeds), _load(scene, load)
    how = Execution(executor, jobs, "auto", progress, archive, overwrite, resume)
    pieces = [numbers[first : first + _PIECE] for first in range(0, len(numbers), _PIECE)]

    def work(_: KeptRuns | None) -> xr.Dataset:
        found: list[PullOff] = []
        with sweep_progress(progress, len(numbers)) as report, how.computing(len(pieces)) as computing:
            count = len(pieces)
            for part in side_by_side(computing, _part, [scene] * count, pieces, [force] * count):
                found += part
                report(float(len(found)), len(numbers))
        return _dataset(scene, numbers, force, found)

    return run_kept(
        how,
        lambda target: KeptRuns(target, scene, how.driver),
        work,
        {**origin_of(scene), "settings": json.dumps([numbers, force])},
        read=lambda path: open_product(path, "pull_off")[0],
    )


def _part(scene: Scene, seeds: Sequence[int], load: float) -> list[PullOff]:
    """Part the pairs of some seeds."""
    contact, arc = pair_contact(scene), 0.0
    if scene.gears is not None:
        arc = float(flank_arc(scene.geometry, scene.geometry.approach))
    return [DrawnContact(scene, one, contact, arc).pull_off(load) for one in first_flanks(scene, seeds)]


def _dataset(scene: Scene, seeds: Sequence[int], load: float, found: Sequence[PullOff]) -> xr.Dataset:
    columns = zip(_COLUMNS.items(), zip(*found, strict=True), strict=True)
    return xr.Dataset(
        {
            name: ("seed", np.array(values, dtype=np.float64), {"units": unit, "long_name": text})
            for (name, (unit, text)), values in columns
        },
        coords={"seed": ("seed", np.array(seeds), {"long_name": "seed of the asperities", "units": "1"})},
        attrs={
            **provenance(scene, "parted drawn pairs"),
            "title": f"{scene.name}: pull-off of drawn pairs",
            "summary": "Largest tension of one pair of teeth with drawn asperities, one for each seed.",
            "load": load,
        },
    )


def _seeds(scene: Scene, given: int | Sequence[int]) -> list[int]:
    """Numbers of the surfaces."""
    first = scene.contact.seed
    try:
        numbers: Sequence[int] = given  # type: ignore[assignment]
        if isinstance(given, int | np.integer) and not isinstance(given, bool):
            numbers = range(first, first + int(given))
        seeds = [int(number) for number in numbers if float(number).is_integer()]
        right = len(seeds) == len(numbers) and min(seeds) >= 0 and len(seeds) <= _MOST
    except (TypeError, ValueError):
        right = False
    if not right:
        raise SceneError(
            "seeds", str(given)[:60], f"must be a number from 1 to {_MOST}, or whole numbers of 0 or more"
        )
    return seeds


def _load(scene: Scene, given: float | None) -> float:
    if given is None and scene.gears is not None:
        given = mean_force(scene)
    if given is None or not 0.0 < given < np.inf:
        raise SceneError(
            "load", given, "must be a positive force in N: the scene has no mean torque that presses a pair"
        )
    return float(given)
