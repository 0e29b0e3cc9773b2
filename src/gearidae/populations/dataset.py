"""The asperities of a scene as a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearidae.errors import SceneError
from gearidae.populations.flanks import flanks_digest, flanks_of
from gearidae.populations.materials import covered_sides
from gearidae.scene import Scene, require_gears

if TYPE_CHECKING:
    import xarray as xr


def population(scene: Scene) -> xr.Dataset:
    """Return the asperities of a scene with ``contact.roughness = "discrete"``.

    Parameters
    ----------
    scene : Scene
        With a pair of gears, as ``scene.pair(NAME)`` of a train is, or a roller.

    Returns
    -------
    xarray.Dataset
        Along ``asperity``, flank by flank and in the order of positions: ``tooth`` and ``flank`` (0 drive, 1 coast) of
        the pinion, ``arc`` from the base circle (of a roller ``x`` from its middle), ``height`` and ``radius`` [m],
        coverage number ``q`` (with independent sides ``q2`` of the gear's), and ``coated`` (``gear_coated``): whether
        the monolayer covers it. Where the gear's coverage goes by its teeth, ``gear_coated`` is that of the first tooth
        met. The attribute ``asperities_sha256`` is that of a run.

    Raises
    ------
    SceneError
        If the scene has another contact model, or several meshes.

    Notes
    -----
    Heights are Gaussian with the surface's roughness and positions uniform, ``asperity_density`` in the mean. Numbers
    follow from ``contact.seed``, tooth and flank: coverage and torques may be varied on one surface.
    """
    import xarray as xr

    if not scene.contact.is_discrete:
        raise SceneError(
            "contact.roughness",
            scene.contact.roughness,
            "must be discrete: statistical ones are no asperities of their own",
        )
    if scene.roller is None:
        scene = require_gears(scene)
    flanks = flanks_of(scene)
    counts = [flank.arc.size for flank in flanks]
    along = "arc" if scene.gears is not None else "x"
    sides = [covered_sides(scene, flank, flank.tooth + flank.flank) for flank in flanks]
    columns = {
        "tooth": (np.repeat([flank.tooth for flank in flanks], counts), "1", "tooth of the pinion"),
        "flank": (
            np.repeat([flank.flank for flank in flanks], counts),
            "1",
            "0 for the drive flank, 1 for the coast flank",
        ),
        along: (_joined([flank.arc for flank in flanks]), "m", "place along the flank"),
        "height": (_joined([flank.height for flank in flanks]), "m", "height above the mean plane"),
        "radius": (_joined([flank.radius for flank in flanks]), "m", "radius of the tip"),
        "q": (_joined([flank.q for flank in flanks]), "1", "coverage number"),
        "coated": (_joined([side[0] for side in sides]), "1", "1 where the monolayer covers it"),
    }
    if scene.coating.pairing == "independent":
        columns["q2"] = (_joined([flank.q2 for flank in flanks]), "1", "coverage number of the gear's side")
        columns["gear_coated"] = (
            _joined([side[1] for side in sides]),
            "1",
            "1 where the monolayer covers the gear's side",
        )
    return xr.Dataset(
        {
            name: ("asperity", values, {"units": units, "long_name": long_name})
            for name, (values, units, long_name) in columns.items()
        },
        attrs={"asperities_sha256": flanks_digest(flanks), "title": f"asperities of {scene.name}"},
    )


def _joined(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(parts)
