"""Where a run goes on from: another run's dataset or archive, looked at before anything is computed."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gearidae import engine
from gearidae.errors import SceneError
from gearidae.scene import Scene, is_long_train

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

    if isinstance(start, str | os.PathLike):
        ds = open_archive(start)
    elif hasattr(start, "attrs") and hasattr(start, "variables"):
        ds = start
    else:
        raise SceneError("start", type(start).__name__, "must be a dataset of a run, or its archive")
    if "scene" not in ds.attrs:
        raise SceneError("start", "(a dataset)", "is no run of gearidae: it has no scene")
    begin = _end_of(ds.attrs)
    assert begin.scene is not None
    engine.refuse_other_bodies(begin.scene, scene)
    return begin


def _end_of(attributes: Mapping[Any, Any]) -> engine.Start:
    """Start of a run that goes on from the one with these attributes."""
    from gearidae.archive.end_state import end_state_of, end_verdict_of

    words, began = end_state_of(attributes)
    try:
        theirs = Scene.from_dict(json.loads(attributes["scene"]))
    except (TypeError, ValueError) as error:
        raise SceneError("start", "scene", f"is not readable ({error})") from None
    if is_long_train(theirs):
        from gearidae.engine.train import end_of_train  # which few runs need

        return replace(end_of_train(theirs, words, began), verdict=end_verdict_of(attributes))
    return engine.end_of(theirs, words, began)


def started_attributes(start: engine.Start) -> dict[str, str]:
    """Attributes of a run's dataset: a name of the state it went on from, and that state with its scene.

    None of a run by itself.
    """
    if start.words is None or start.scene is None:
        return {}
    from gearidae.archive.end_state import end_state_attributes, fingerprint

    parent = {
        "scene": json.dumps(start.scene.to_dict(), allow_nan=False),
        **end_state_attributes(start.began, start.words, start.verdict),
    }
    return {"started_from": fingerprint(start.words), "parent": json.dumps(parent)}


def start_again(attributes: Mapping[Any, Any]) -> engine.Start:
    """Where the run of a dataset has begun, to run it again.

    Parameters
    ----------
    attributes : mapping
        Of the dataset of a run, or a link of a chain.

    Raises
    ------
    SceneError
        If it went on from a run that the dataset does not hold.
    """
    if "parent" not in attributes:
        if "started_from" in attributes:
            allowed = (
                "holds neither scene nor end of the run that it goes on from: archives of version 0.2 do not"
            )
            raise SceneError("dataset", "a continued run", allowed)
        return engine.Start()
    try:
        parent = json.loads(attributes["parent"])
        if not isinstance(parent, dict):
            raise TypeError
    except (TypeError, ValueError):
        raise SceneError("dataset", "parent", "is damaged: the run that this one went on from") from None
    return _end_of(parent)
