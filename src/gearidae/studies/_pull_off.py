"""Pull-off of drawn contacts: the force that parts one pair of teeth, and how it differs from pair to pair."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Final

import numpy as np
import xarray as xr

from gearidae.archive.netcdf import save
from gearidae.archive.provenance import provenance
from gearidae.errors import SceneError
from gearidae.mesh.involute import flank_arc
from gearidae.populations.flanks import first_flanks
from gearidae.runs.estimates import mean_drive_torque
from gearidae.runs.pair_contact import pair_contact
from gearidae.scene import Scene
from gearidae.studies.drawn_contact import DrawnContact

_MOST: Final = 1_000_000
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
    archive: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
) -> xr.Dataset:
    """Largest tension of one drawn pair of teeth, for many surfaces of one design.

    A pair at the pitch point (or the roller) has real asperities, as with ``contact.model = "population"``. It is
    pressed along the normal until it first carries the load and then parted, gaps prescribed, bodies rigid. The law of
    the mean over many surfaces says nothing of a single contact where few asperities hold.

    Parameters
    ----------
    scene : Scene
        Gears or a roller, of which only radius, width and surfaces count. Asperities are drawn whatever
        ``contact.model`` is.
    seeds : int or sequence of int, optional
        In place of ``contact.seed``: numbers, or how many from ``contact.seed`` on. A number is the drive flank of the
        pinion's first tooth, as `gearidae.population` draws it.
    load : float, optional
        Force that presses the pair [N]; by default that of the mean torque of the drive. A roller needs one.
    archive : path-like, optional
        File to write.
    overwrite : bool, optional
        Whether it may replace a file.

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
    contact, arc = pair_contact(scene), 0.0
    if scene.gears is not None:
        arc = float(flank_arc(scene.geometry, scene.geometry.approach))
    found = [DrawnContact(scene, one, contact, arc).pull_off(force) for one in first_flanks(scene, numbers)]
    ds = xr.Dataset(
        {
            name: ("seed", np.array(values, dtype=np.float64), {"units": unit, "long_name": text})
            for (name, (unit, text)), values in zip(_COLUMNS.items(), zip(*found, strict=True), strict=True)
        },
        coords={"seed": ("seed", np.array(numbers), {"long_name": "seed of the asperities", "units": "1"})},
        attrs={
            **provenance(scene, "parted drawn pairs"),
            "title": f"{scene.name}: pull-off of drawn pairs",
            "summary": "Largest tension of one pair of teeth with drawn asperities, one for each seed.",
            "load": force,
        },
    )
    if archive is not None:
        save(ds, archive, overwrite=overwrite)
    return ds


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
        given = mean_drive_torque(scene) / scene.gears.pinion_base_radius
    if given is None or not 0.0 < given < np.inf:
        raise SceneError(
            "load", given, "must be a positive force in N: the scene has no mean torque that presses a pair"
        )
    return float(given)
