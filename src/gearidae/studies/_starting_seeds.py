"""Starting torques of a population: their distribution over the gears of one design."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import Execution, SideBySide
from gearidae.runs.run_cache import RunCache
from gearidae.runs.running import failure_of
from gearidae.scene.joints import ages
from gearidae.studies.declared.starting_torque import SEEDS, SLOW_ENOUGH, coordinate
from gearidae.studies.specimens import POPULATION, gears_of, gears_text, seeds_that_draw
from gearidae.studies.starting_parts import PARTS, parts_of
from gearidae.studies.starting_ramp import (
    RESTS,
    constant,
    least_damping,
    nothing_followed,
    phase_of_seed,
    pitch_of,
    probe,
    ramp,
    ramp_end,
    ramp_rate,
    ramp_time,
    run_from_rest,
    seated,
)

if TYPE_CHECKING:
    from gearidae.scene import GearScene
    from gearidae.studies.study import Study

log = logging.getLogger(__name__)

QUANTILES: Final = (0.1, 0.5, 0.9)
_HALVINGS: Final = 4
"""Times that the rate is halved at most."""
_STAGES: Final = 4
"""Runs of each gear, where the first two rates agree."""


_SUMMARY: Final = (
    "Torques on the pinion at which gears with real asperities start from rest: the torque rises linearly, and that of "
    "the last moment of rest before one pitch counts."
)


@dataclass
class _Design:
    """Gears of one coverage on their way.

    Attributes
    ----------
    scene : Scene
        With the coverage.
    seated : list of Scene
        One for each seed.
    scale : float
        Median starting torque beyond the dry resistance, by the pilots [N m].
    halvings : int
        Times that the rate has been halved.
    torques : ndarray, shape (seeds,)
        Starting torques at the slowest rate so far [N m]; infinite where the gear has not started.
    change : float
        Relative change of their median by the last halving.
    starts : ndarray, shape (seeds,)
        Whether the gear starts at the drive's own torque, 0 or 1; NaN if the drive has none.
    messages : list of str
        Of the runs of `torques` that have failed; empty texts of the others.
    """

    scene: GearScene
    seated: list[GearScene]
    scale: float = math.nan
    halvings: int = 0
    torques: Floats = field(default_factory=lambda: np.empty(0))
    change: float = math.nan
    starts: Floats = field(default_factory=lambda: np.empty(0))
    messages: list[str] = field(default_factory=list)

    @property
    def is_settled(self) -> bool:
        """Whether the rate is slow enough, or has been halved as often as is allowed."""
        return self.change < SLOW_ENOUGH or self.halvings == _HALVINGS

    def learn(self, torques: Floats, messages: Sequence[str]) -> None:
        """Take in the starting torques at the next rate, and what is said of runs that have failed."""
        if self.torques.size:
            self.halvings += 1
            before, now = (quantiles(row)[1] - pitch_of(self.scene).dry for row in (self.torques, torques))
            # medians that no gear reaches are the same
            self.change = (
                0.0 if before == now else abs(now / before - 1.0) if math.isfinite(before) else math.inf
            )
        self.torques, self.messages = torques, list(messages)


@dataclass
class _Runs:
    """Runs side by side, and the messages of the latest, empty texts of those that have not failed."""

    compute: SideBySide
    messages: list[str] = field(default_factory=list)

    def torques(self, scenes: Sequence[GearScene]) -> Floats:
        """Torques of runs from rest [N m]; infinite where the gear has not turned, NaN where its run has failed."""
        values = []
        self.messages = []
        for _, word in self.compute(run_from_rest, scenes):
            failure = failure_of(word)
            self.messages.append(failure)
            if failure:
                log.warning("one gear is left out: %s", failure)
            values.append(math.nan if failure else math.inf if word == RESTS else float(word))
        return np.array(values)


def starting_torques(
    base: GearScene,
    study: Study,
    points: Sequence[float],
    scenes: Sequence[GearScene],
    seeds: int | None,
    execution: Execution,
) -> xr.Dataset:
    """Distribution of the starting torques over seeds, for `starting_torque`.

    Parameters
    ----------
    base : Scene
        With a population.
    study : Study
        Over the coverage or over the time at rest.
    points, scenes
        Coverages or times, and the scene with each of them.
    seeds : int or None
        Number of gears, whose seeds of asperities, and of errors of teeth where they are drawn, count from the scene's
        own on; None for `SEEDS`.
    execution : Execution

    Raises
    ------
    SceneError
        If a setting is not allowed.
    """
    gears = gears_of(base, SEEDS if seeds is None else seeds)

    def work(kept: RunCache | None) -> xr.Dataset:
        designs = [_Design(scene, [seated(scene, gear) for gear in gears]) for scene in scenes]
        usual = _STAGES * len(gears) * len(designs)
        with execution.side_by_side(kept, usual) as compute:
            _find_all(designs, _Runs(compute))
        return _dataset(base, study, points, [gear[POPULATION] for gear in gears], designs)

    return study.compute(execution, base, work, [study.kind, list(points), len(gears)])


def _find_all(designs: Sequence[_Design], runs: _Runs) -> None:
    """Find the scale of each design, the torques at rates that are halved until they agree, and who starts at once."""
    probes = runs.torques([probe(at) for design in designs for at in design.seated])
    for design, torques in _in_parts(designs, probes):
        dry = pitch_of(design.scene).dry
        started = torques[np.isfinite(torques)] - dry
        if np.isnan(torques).all():
            raise nothing_followed("gear", next(filter(None, reversed(runs.messages))))
        if not started.size:
            raise SceneError("scene", design.scene.name, "has no gear that any torque starts")
        design.scale = float(np.median(started))
    waiting = list(designs)
    while waiting:
        halvings = [design.halvings + (design.torques.size > 0) for design in waiting]
        slow = [
            ramp(at, design.scale, n)
            for design, n in zip(waiting, halvings, strict=True)
            for at in design.seated
        ]
        for number, (design, torques) in enumerate(_in_parts(waiting, runs.torques(slow))):
            part = slice(number * len(design.seated), (number + 1) * len(design.seated))
            design.learn(torques, runs.messages[part])
        waiting = [design for design in waiting if not design.is_settled]
    for design in designs:
        torque, dry = design.scene.drive.torque, pitch_of(design.scene).dry
        design.starts = np.full(len(design.seated), 0.0 if torque > 0.0 else math.nan)
        if torque > dry:
            turned = runs.torques([constant(at, design.scale, torque) for at in design.seated])
            design.starts = np.where(np.isnan(turned), np.nan, np.isfinite(turned))


def _in_parts(designs: Sequence[_Design], values: Floats) -> list[tuple[_Design, Floats]]:
    return list(zip(designs, np.split(values, len(designs)), strict=True))


def quantiles(torques: Floats) -> Floats:
    """Quantiles of torques that are known, interpolated between the ordered ones; infinite from the first that is."""
    ordered = np.sort(torques[~np.isnan(torques)])
    rank = np.array(QUANTILES) * (ordered.size - 1)
    low, high = ordered[np.floor(rank).astype(int)], ordered[np.ceil(rank).astype(int)]
    with np.errstate(invalid="ignore"):
        between = low + (rank % 1.0) * (high - low)
    return np.where(np.isfinite(high), between, np.inf)


def _parts(design: _Design, torques: Floats, ages_at_start: Floats) -> Floats:
    """Parts of the torques of the gears; joints that age have grown older while the torque rose."""
    if not ages(design.scene):
        return parts_of(design.scene, torques)
    aged = (design.scene.replace({"initial.rest_time": float(age)}) for age in ages_at_start)
    return np.stack([parts_of(scene, torque) for scene, torque in zip(aged, torques, strict=True)])


def _mean(values: Floats) -> float:
    return float(values.mean()) if values.size else math.nan


def _dataset(
    base: GearScene,
    study: Study,
    points: Sequence[float],
    numbers: Sequence[int],
    designs: Sequence[_Design],
) -> xr.Dataset:
    phases = [phase_of_seed(base, number) for number in numbers]
    axes = {"place": np.array(phases), "seed": np.array(numbers), "quantile": np.array(QUANTILES)}
    axes["part"] = np.array(PARTS)
    values = {name: np.asarray(column) for name, column in _columns(designs).items()}
    attributes = {
        **provenance(base, "found starting torques of a population", swept=seeds_that_draw(base)),
        "title": f"{base.name}: starting torque of {gears_text(len(numbers))}",
        "summary": _SUMMARY,
        "drive_torque": base.drive.torque,
    }
    return study.dataset(axes | values, attributes).assign_coords(coordinate(study, points))


def _columns(designs: Sequence[_Design]) -> dict[str, Any]:
    """Values of the variables, design by design."""
    torques = np.stack([design.torques for design in designs])
    starts = np.stack([design.starts for design in designs])
    finite = np.where(np.isfinite(torques), torques, np.nan)
    below = np.stack([quantiles(values) for values in torques])
    pitches = [pitch_of(design.scene) for design in designs]
    ages_at_start = [
        design.scene.initial.rest_time + ramp_time(pitch, design.scale, design.halvings, design.torques)
        for pitch, design in zip(pitches, designs, strict=True)
    ]
    return {
        "starting_torque": finite,
        "starts": starts,
        "quantiles": np.where(np.isfinite(below), below, np.nan),
        "parts": [_parts(design, *row) for design, *row in zip(designs, finite, ages_at_start, strict=True)],
        "age": np.where(np.isfinite(torques), ages_at_start, np.nan),
        "failed": np.isnan(torques),
        "message": [design.messages for design in designs],
        "not_started": np.isinf(torques).sum(axis=1) / (~np.isnan(torques)).sum(axis=1),
        "chance": [_mean(values[~np.isnan(values)]) for values in starts],
        "rate": [
            ramp_rate(pitch, design.scale, design.halvings)
            for pitch, design in zip(pitches, designs, strict=True)
        ],
        "ramp_end": [ramp_end(pitch, design.scale) for pitch, design in zip(pitches, designs, strict=True)],
        "median_change": [design.change for design in designs],
        "damping": [least_damping(design.scene) for design in designs],
    }
