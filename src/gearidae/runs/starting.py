"""Where a run goes on from: another run's dataset or archive, looked at before anything is computed."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING

from gearidae import engine
from gearidae.errors import SceneError
from gearidae.scene import Scene

if TYPE_CHECKING:
    import xarray as xr


def started_from(start: xr.Dataset | str | os.PathLike[str] | None, scene: Scene) -> engine.Start:
    """Read where a run is to go on from, and make sure that a scene can.

    Parameters
    ----------
    start : xarray.Dataset, path-like or None
        A single run, in memory or on disk; of an unfinished one, its newest checkpoint counts.
    scene : Scene
        That is to go on.

    Returns
    -------
    Start
        That of a run by itself without one.

    Raises
    ------
    SceneError
        If it is no single run, carries no state or one that is not its own, or is of other gears.
    """
    if start is None:
        return engine.Start()
    from gearidae.archive import open_archive
    from gearidae.archive.end_state import end_state_of

    if isinstance(start, str | os.PathLike):
        ds = open_archive(start)
    elif hasattr(start, "attrs") and hasattr(start, "variables"):
        ds = start
    else:
        raise SceneError("start", type(start).__name__, "must be a dataset of a run, or its archive")
    if "scene" not in ds.attrs:
        raise SceneError("start", "(a dataset)", "is no run of gearidae: it has no scene")
    words, began = end_state_of(ds)
    try:
        theirs = Scene.from_dict(json.loads(ds.attrs["scene"]))
    except (TypeError, ValueError) as error:
        raise SceneError("start", "scene", f"is not readable ({error})") from None
    found = engine.end_of(theirs, words, began)
    engine.refuse_other_bodies(theirs, scene)
    return found


def started_attributes(start: engine.Start) -> dict[str, str]:
    """Attributes of a run's dataset that name the state it went on from; none of a run by itself."""
    from gearidae.archive.end_state import fingerprint

    return {} if start.words is None else {"started_from": fingerprint(start.words)}
