"""Whether runs are gears with surfaces of their own, and the sentence that says so."""

from __future__ import annotations

import json
from typing import Final

import xarray as xr

from gearidae.archive.select import scene_of, what_of

SEED_KEYS: Final = ("contact.seed", "mesh.pitch_error_seed")
"""Keys that number what is drawn: discrete asperities, and errors of single teeth."""
_OF_ONE_MESH: Final = (".contact.seed", ".pitch_error_seed")
"""Ends of those keys of one mesh of a train."""
_MEANS: Final = "gearidae ensemble CASE --vary contact.seed=seeds --size 20 gives means and standard errors"


def has_seeds(ds: xr.Dataset) -> bool:
    """Whether the runs of a dataset differ in their seeds."""
    try:
        swept = json.loads(ds.attrs.get("swept", "{}"))
        return any(key in SEED_KEYS or key.endswith(_OF_ONE_MESH) for key in swept)
    except (TypeError, ValueError):
        return False


def specimen_note(ds: xr.Dataset) -> str:
    """Say in a sentence that a run with discrete asperities is one specimen of its design; else empty.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    if scene_of(ds).get("contact", {}).get("roughness") != "discrete":
        return ""
    if has_seeds(ds):
        return f"Runs of different seeds are specimens of one design: {_MEANS}."
    return (
        f"This is one specimen: another contact.seed is another {what_of(ds)} of the same design. {_MEANS}."
    )


def specimen_label(ds: xr.Dataset) -> str:
    """Name the specimen of a run in few words, such as ``one specimen, seed 0``; empty where there is none."""
    if not specimen_note(ds) or has_seeds(ds):
        return ""
    scene = scene_of(ds)
    own = [mesh.get("contact") or {} for mesh in (scene.get("meshes") or {}).values()]
    if any("seed" in contact or "asperities" in contact for contact in own):
        return "one specimen"  # meshes have seeds or lists of their own
    return f"one specimen, seed {scene['contact'].get('seed', 0)}"
