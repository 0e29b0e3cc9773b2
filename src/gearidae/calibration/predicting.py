"""What the model predicts of observations, for many values of some keys at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.analysis.ringing import characteristic_frequency
from gearidae.analysis.verdict.codes import sticking, verdict_codes
from gearidae.archive.output_selection import read_keep
from gearidae.archive.select import runs
from gearidae.arrays import Floats
from gearidae.calibration.observations import RING, STICKS, Observation
from gearidae.errors import SceneError
from gearidae.runs.execution import Execution
from gearidae.runs.run_cache import RunCache
from gearidae.runs.sweep_plan import SweepPlan
from gearidae.runs.sweeping import run_plan
from gearidae.scene.keys import scene_value

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.progress import SweepProgress
    from gearidae.scene import Scene

_SAMPLED: Final = ("extremes", "gear_speed", "events")
_ONE_TIME_AXIS: Final = ("run.duration", "run.samples")
_AT_A_TIME: Final = 64
"""Runs with samples that are in memory at a time."""


class Predictor:
    """Predictions of observations.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    keys : tuple of str
        Whose values are computed.
    observations : tuple of Observation
    execution : Execution
        Where the runs are computed; with an archive, they are kept beside it.
    """

    def __init__(
        self, base: Scene, keys: tuple[str, ...], observations: tuple[Observation, ...], execution: Execution
    ) -> None:
        self._sampled = any(observation.of == RING for observation in observations)
        self._varied = tuple(
            dict.fromkeys([*keys, *(key for observation in observations for key in observation.conditions)])
        )
        fixed = [key for key in self._varied if key in _ONE_TIME_AXIS]
        if self._sampled and fixed:
            raise SceneError("conditions", fixed[0], f"cannot differ beside {RING}: runs share one time axis")
        self._base = base if self._sampled else base.replace({"run.samples": "off"})
        self._keys, self._observations, self._execution = keys, observations, execution
        self._selection = read_keep(_SAMPLED if self._sampled else ("extremes",), self._base)
        self.kept: RunCache | None = None
        """Where finished runs are."""

    def store(self, archive: Path) -> RunCache:
        """Make the folder of finished runs beside an archive."""
        return RunCache(archive, self._base, self._execution.driver, self._selection)

    def figures(self, values: Floats, progress: bool | SweepProgress = False) -> Floats:
        """Predict all observations.

        Parameters
        ----------
        values : ndarray, shape (n, keys)
            In SI units.
        progress : bool or callable, optional
            As for `gearidae.sweep`.

        Returns
        -------
        ndarray, shape (n, observations)
            NaN where the model has no answer.

        Raises
        ------
        SceneError
            If a value is not allowed.
        Interrupted
            On Ctrl-C.
        """
        predicted = np.full((len(values), len(self._observations)), math.nan)
        scenes: list[Scene] = []
        index: dict[Scene, int] = {}
        wanted: list[tuple[int, int, int]] = []
        for row, point in enumerate(values.tolist()):
            changed = self._base.replace(dict(zip(self._keys, point, strict=True)))
            for column, observation in enumerate(self._observations):
                scene = changed.replace(dict(observation.conditions)) if observation.conditions else changed
                if not isinstance(observation.of, str):
                    predicted[row, column] = float(observation.of(scene))
                    continue
                if scene not in index:
                    index[scene] = len(scenes)
                    scenes.append(scene)
                wanted.append((row, column, index[scene]))
        figures = self._run(scenes, progress) if scenes else []
        for row, column, number in wanted:
            predicted[row, column] = figures[number][str(self._observations[column].of)]
        return predicted

    def _run(self, scenes: Sequence[Scene], progress: bool | SweepProgress) -> list[dict[str, float]]:
        """Run scenes and read the figures of each."""
        size = _AT_A_TIME if self._sampled else len(scenes)
        read: list[dict[str, float]] = []
        for first in range(0, len(scenes), size):
            part = list(scenes[first : first + size])
            axis: dict[str, list[Any]] = {"name": [f"run {first + number}" for number in range(len(part))]}
            axis |= {key: [scene_value(scene, key) for scene in part] for key in self._varied}
            execution = replace(self._execution, progress=progress)
            read += self._read(
                run_plan(SweepPlan(self._base, (axis,), part), execution, self.kept, self._selection)
            )
        return read

    def _read(self, ds: xr.Dataset) -> list[dict[str, float]]:
        """Figures of each run of a dataset."""
        columns = {STICKS: sticking(verdict_codes(ds["verdict"].values))}
        for observation in self._observations:
            if isinstance(observation.of, str) and observation.of not in (STICKS, RING):
                columns[observation.of] = ds[observation.of].values.astype(np.float64)
        if self._sampled:
            columns[RING] = np.array([_ring(run) for _, run in runs(ds)])
        return [
            {name: float(column[number]) for name, column in columns.items()}
            for number in range(ds.sizes["name"])
        ]


def _ring(run: xr.Dataset) -> float:
    """Frequency of the first impact response [Hz]; NaN of a run without."""
    try:
        return float(characteristic_frequency(run))
    except SceneError:
        return math.nan
