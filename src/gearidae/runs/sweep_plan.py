"""What a sweep varies: the scenes of its runs, and the dimensions and labels of the result."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.archive.stack import Axis, swept_values, zipped_keys
from gearidae.errors import SceneError
from gearidae.scene.keys import scene_value
from gearidae.scene.units import refuse_bare

if TYPE_CHECKING:
    from gearidae.scene import Scene

MOST_RUNS: Final = 1_000_000
"""Runs of one sweep: their scenes take some gigabytes."""
_TOO_MANY: Final = f"a sweep has {MOST_RUNS} runs at most"
_ONE_TIME_AXIS = ("run.duration", "run.samples")


@dataclass(frozen=True, slots=True)
class SweepPlan:
    """Every run of a sweep.

    Attributes
    ----------
    base : Scene
        What the runs have in common.
    axes : tuple of dict
        For each dimension, the values of its keys in SI units; several keys where they are zipped.
    scenes : list of Scene
        One for each run; the last axis changes fastest.
    """

    base: Scene
    axes: tuple[Axis, ...]
    scenes: list[Scene]

    @property
    def swept(self) -> str:
        """Values of every key, as the attribute ``swept`` of the result holds them."""
        return swept_values(self.axes)

    @property
    def zipped(self) -> str:
        """Keys that are walked together, as the attribute ``zipped`` of the result; empty without any."""
        return zipped_keys(self.axes)


def plan_sweep(
    base: Scene, over: Mapping[str, Iterable[Any]], *, zipped: bool | Collection[str] = False
) -> SweepPlan:
    """Derive all scenes of a sweep, before anything is run.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    over : mapping of str to iterable
        Values of each swept key.
    zipped : bool or collection of str, optional
        As for `gearidae.sweep`.

    Raises
    ------
    SceneError
        If a key or a value is not allowed, stands twice, or zipped keys differ in the number of values.
    """
    listed = _listed(over)
    groups = _groups(listed, zipped)
    steps = [list(zip(*group.values(), strict=True)) for group in groups]
    if (runs := math.prod(map(len, steps))) > MOST_RUNS:
        raise SceneError("over", f"({runs} runs)", _TOO_MANY)
    scenes = [
        base.replace(dict(zip(listed, itertools.chain(*values), strict=True)))
        for values in itertools.product(*steps)
    ]
    if base.run.samples == "ringing":
        from gearidae.runs.ringing_samples import counted

        samples = {"run.samples": counted(scenes)}  # of the run that rings fastest: all share one time axis
        base, scenes = base.replace(samples), [scene.replace(samples) for scene in scenes]
    axes: list[Axis] = []
    stride = len(scenes)
    for group, length in zip(groups, map(len, steps), strict=True):
        stride //= length
        along = [scenes[index * stride] for index in range(length)]
        axis = {key: [scene_value(scene, key) for scene in along] for key in group}
        leader = next(iter(axis))
        seen = set()
        for index, value in enumerate(axis[leader]):
            mark = json.dumps(value) if isinstance(value, list | dict) else value
            if mark in seen:
                alone = "" if len(axis) == 1 else _LEADER
                raise SceneError(leader, group[leader][index], f"stands twice in the list of values{alone}")
            seen.add(mark)
        axes.append(axis)
    return SweepPlan(base, tuple(axes), scenes)


_LEADER = (
    ", and the first of the zipped keys labels the runs: put one first whose values all differ "
    '("name" gives the runs names of their own)'
)


def _listed(over: Mapping[str, Iterable[Any]]) -> dict[str, list[Any]]:
    """Values of each swept key as a list that is not empty."""
    if not isinstance(over, Mapping) or not over:
        raise SceneError(
            "over", over, 'must be a table of keys and their values, {"coating.sam_fraction": [1, 0.5]}'
        )
    for key, values in over.items():
        if key in _ONE_TIME_AXIS:
            raise SceneError(key, values, "cannot be swept, because all runs share one time axis")
    return {key: values_of(key, values) for key, values in over.items()}


def values_of(key: str, values: object) -> list[Any]:
    """Return the values of a key as a list that is not empty; the scene reads them.

    Raises
    ------
    SceneError
        If they are no list, none or too many, or numbers with a unit stand beside others without one.
    """
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Iterable):
        raise SceneError(key, values, "must be a list of values to sweep over")
    taken = list(itertools.islice(values, MOST_RUNS + 1))
    if not taken:
        raise SceneError(key, "[]", "must be a list of at least one value")
    if len(taken) > MOST_RUNS:
        raise SceneError(key, f"(more than {MOST_RUNS} values)", _TOO_MANY)
    if any(isinstance(value, str) for value in taken):
        try:
            refuse_bare(taken)
        except ValueError as error:
            raise SceneError(key, values, str(error)) from None
    # numpy's texts and flags become plain ones; numbers are read with their units, in the scene
    return [
        value.item() if isinstance(value, np.generic) and value.dtype.kind != "m" else value
        for value in taken
    ]


def _groups(listed: dict[str, list[Any]], zipped: bool | Collection[str]) -> list[Axis]:
    """Keys that share a dimension, with their values; `listed` is put into the same order."""
    if isinstance(zipped, bool):
        together = list(listed) if zipped else []
    elif not isinstance(zipped, Collection):
        raise SceneError("zipped", zipped, "must be True, False or keys that are walked together")
    else:
        named = [zipped] if isinstance(zipped, str) else list(zipped)
        for key in named:
            if not isinstance(key, str) or key not in listed:
                raise SceneError("zipped", key, f"must be among the swept keys {', '.join(map(str, listed))}")
        together = [key for key in listed if key in named]
    groups: list[Axis] = []
    for key, values in listed.items():
        if key not in together:
            groups.append({key: values})
        elif key == together[0]:
            groups.append({name: listed[name] for name in together})
        elif len(values) != len(listed[together[0]]):
            raise SceneError(
                key,
                f"{len(values)} values",
                f"must be as many as {together[0]} has, {len(listed[together[0]])}: they are zipped",
            )
    for key in [key for group in groups for key in group]:
        listed[key] = listed.pop(key)
    return groups
