"""Adhesion of a hub: the force that parts a journal from its bore, by drawn asperities."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Unpack

import xarray as xr

from gearidae.runs.execution import RunOptions
from gearidae.scene import Scene
from gearidae.scene.quantity import Quantity
from gearidae.studies.declared.pull_off import pull_off

_SIZE, _LOAD = Quantity(unit="m", above=0, at_most=1), Quantity(unit="N", above=0, at_most=1)
_AT_REST: Final = {"mass": 1e-12, "speed": 1e-3, "height": 1e-6}
"""Of a roller whose contact is only parted, so that they do not count."""
_OF_ASPERITIES: Final = ("asperity", "seed")
"""Keys of the contact that a parted pair has."""


def hub_adhesion(
    scene: Scene,
    radius: float | str,
    clearance: float | str,
    width: float | str,
    load: float | str,
    seeds: int | Sequence[int] = 40,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    r"""Force that parts a journal from its bore, for many surfaces of one design.

    A journal of the radius r in a bore with the radial clearance c touches like a cylinder of the radius
    :math:`r (r + c)/c` on a plane. Asperities are drawn as by `pull_off`, with the surfaces and the law of the scene:
    the journal is pressed against the bore by the load and parted along the normal, bodies rigid.

    Parameters
    ----------
    scene : Scene
        Of which the surfaces count.
    radius, clearance, width : float or str
        Radius of the journal, radial clearance and length of the hub, in metres or with a unit ("3 um").
    load : float or str
        Force that presses the journal against the bore, in newtons or with a unit.
    seeds : int or sequence of int, optional
        As for `pull_off`.
    **options
        As for `pull_off`.

    Returns
    -------
    Dataset, dims (seed)
        As of `pull_off`: ``pull_off`` is the adhesion of the hub [N].

    Raises
    ------
    SceneError
        If a number is not positive, or is refused by `pull_off`.

    Examples
    --------
    >>> import gearidae as gd
    >>> ds = gd.contact.hub_adhesion(gd.preset("teodorescu2009"), "3 um", "0.5 um", "2 um", load="10 uN")
    >>> bool(ds.pull_off.median() > 0.0)
    True
    """
    sizes = (("radius", radius), ("clearance", clearance), ("width", width))
    r, c, length = (_SIZE.take(name, size) for name, size in sizes)
    force = _LOAD.take("load", load)
    tables = scene.to_dict()
    hub: dict[str, Any] = {name: tables[name] for name in ("surface", "coating") if name in tables}
    hub["contact"] = {key: value for key, value in tables.get("contact", {}).items() if key in _OF_ASPERITIES}
    hub["roller"] = {"radius": r * (r + c) / c, "width": length, **_AT_REST}
    hub |= {"name": f"hub of {scene.name}", "run": {"duration": 1e-6}}
    return pull_off(Scene.from_dict(hub), seeds, load=force, **options)
