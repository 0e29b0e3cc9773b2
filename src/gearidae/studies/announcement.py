"""What many runs are going to be, and how long they take, in words for a command that is about to begin them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from gearidae.scene import Scene

_TRIED: Final = 8
"""Quantiles of the distributions whose runs stand for all."""


def grid_words(
    scene: Scene, over: Mapping[str, Sequence[Any]], workers: int | None, *, zipped: bool = False
) -> str:
    """Say how many runs there are over which values, and how long they take by the estimate of ``gearidae check``.

    Parameters
    ----------
    scene : Scene
        What the runs have in common.
    over : mapping of str to sequence
        Values of each key.
    workers : int or None
        Number of simultaneous runs; None where a cluster decides it.
    zipped : bool, optional
        Whether the values of all keys are combined in pairs.

    Raises
    ------
    SceneError
        If a key or a value is not allowed.
    """
    from gearidae.runs.sweep_plan import plan_sweep

    scenes = plan_sweep(scene, over, zipped=zipped).scenes
    ranges = " and ".join(f"{key} {_range(values)}" for key, values in over.items())
    return _words(ranges, scenes, len(scenes), workers)


def draw_words(scene: Scene, keys: Mapping[str, str], runs: int, workers: int | None) -> str:
    """Say how many runs there are of which distributions, and how long they take.

    Parameters
    ----------
    scene, workers
        As for `grid_words`.
    keys : mapping of str to str
        Distribution of each key.
    runs : int
        How many there are.

    Raises
    ------
    SceneError
        If a key or a distribution is not allowed.
    """
    from gearidae.studies.design import drawn_distributions

    drawn = drawn_distributions(scene, keys)
    quantiles = (np.arange(_TRIED) + 0.5) / _TRIED
    columns = {distribution.key: distribution.quantiles(quantiles).tolist() for distribution in drawn}
    scenes = [
        scene.replace(dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True)
    ]
    return _words(
        " and ".join(f"{key} {text}" for key, text in keys.items()), scenes or [scene], runs, workers
    )


def _words(over: str, tried: Sequence[Scene], runs: int, workers: int | None) -> str:
    from gearidae.runs.run_time import time_in_words

    many = f"{runs} run{'s' if runs > 1 else ''}"
    time = time_in_words(tried, runs, workers)
    return f"{many}, {over}; {time}" if time else f"{many}, {over}"


def _range(values: Sequence[Any]) -> str:
    """Write values as a range if there are many: ``from 1 to 0.4``."""
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in values]
    if len(values) > 3 and not isinstance(values[0], list):
        return f"from {shown[0]} to {shown[-1]}"
    return f"= {', '.join(shown)}"
