"""What a command of many runs is going to do, and for how long, said before it begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.archive import check_target
from gearidae.cli.output import is_quiet, say
from gearidae.progress import in_words

if TYPE_CHECKING:
    from gearidae.scene import Scene

_TRIED: Final = 8
"""Runs whose time is estimated."""


def check_new(target: Path, *, resume: bool, overwrite: bool) -> None:
    """Refuse a file that is in the way; where runs of an unfinished study are kept, the study says more.

    Raises
    ------
    SceneError
        If `target` cannot be written.
    """
    if not resume and not Path(f"{target}.runs").exists():
        check_target(target, overwrite=overwrite)


def announce(title: str, scene: Scene, words: str) -> None:
    """Say what will be run."""
    say(f"{title} of {scene.name}: {words}")


def announce_grid(
    title: str, scene: Scene, over: Mapping[str, Sequence[Any]], workers: int | None, *, zipped: bool = False
) -> None:
    """Say how many runs there are over which values, and how long they take by the estimate of ``gearidae check``.

    Parameters
    ----------
    title : str
        What is made.
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
    _announce_runs(title, ranges, scenes[:: -(-len(scenes) // _TRIED)], len(scenes), workers)


def announce_draws(title: str, scene: Scene, keys: Mapping[str, str], runs: int, workers: int | None) -> None:
    """Say how many runs there are of which distributions, and how long they take.

    Parameters
    ----------
    title, scene, workers
        As for `announce_grid`.
    keys : mapping of str to str
        Distribution of each key.
    runs : int
        How many there are.

    Raises
    ------
    SceneError
        If a key or a distribution is not allowed.
    """
    from gearidae.studies.distributions import read_distributions

    drawn = read_distributions(scene, keys)
    quantiles = (np.arange(_TRIED) + 0.5) / _TRIED
    columns = {each.key: each.quantiles(quantiles).tolist() for each in drawn}
    scenes = [
        scene.replace(dict(zip(columns, row, strict=True))) for row in zip(*columns.values(), strict=True)
    ]
    _announce_runs(title, " and ".join(f"{key} {text}" for key, text in keys.items()), scenes, runs, workers)


def _announce_runs(title: str, over: str, tried: Sequence[Scene], runs: int, workers: int | None) -> None:
    if is_quiet():
        return
    from gearidae.runs.run_time import run_time

    at_a_time = min(workers or 1, runs)
    seconds = runs / at_a_time * sum(run_time(scene).seconds for scene in tried) / len(tried)
    many, long = f"{runs} run{'s' if runs > 1 else ''}", "less than a second"
    if seconds >= 1.0:
        side_by_side = f" with {at_a_time} at a time" if at_a_time > 1 else ""
        long = f"some {in_words(seconds)}{side_by_side}, within a factor of about three"
    announce(title, tried[0], f"{many}, {over}; {long}")


def _range(values: Sequence[Any]) -> str:
    """Write values as a range if there are many: ``from 1 to 0.4``."""
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in values]
    if len(values) > 3 and not isinstance(values[0], list):
        return f"from {shown[0]} to {shown[-1]}"
    return f"= {', '.join(shown)}"
