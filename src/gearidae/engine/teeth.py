"""What pairs of teeth did at samples of a run, read from its model while the scene runs again.

A sample lies inside a step. Gaps follow from the state there, and joined heights from the histories as they were in the
step, by the play operator, through the turning point if the step has one: as for the force of a pair. Whatever is
looked at is restored, so that the run goes on as it would without.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.engine.backend import follow
from gearidae.engine.elastic.node_rows import GAP_SHARE, JOINED, first_unknown, row_of
from gearidae.engine.entry_points import observe_at
from gearidae.engine.model.state import PHASE, Model, U, V, W, assign, copied
from gearidae.engine.motion.pair_forces import force_of_one
from gearidae.engine.pairs.orbit import orbit_anew
from gearidae.engine.pairs.tooth_pairs import all_pairs, history_of, pair_at, pair_gap
from gearidae.engine.population.contact_point import spot_at, state_of_pair
from gearidae.engine.population.layout import (
    ARC,
    HEIGHT,
    INDEX,
    K_MATERIAL,
    KIND,
    flank_of,
    joined_candidates,
)
from gearidae.engine.setup.problem import Problem
from gearidae.engine.setup.start import AT_ONCE, Start
from gearidae.laws.pair_law import in_reach
from gearidae.mesh.involute import curvature_radii
from gearidae.records import Flank, sample_times
from gearidae.records.tooth_states import ContactState, MeshState, ToothContact
from gearidae.scene import MATERIAL_NAMES, Scene

_JUST: Final = 1e-6  # of the stretch limit: nearer to either end of the stretch is at that end


def states_at(
    scene: Scene,
    samples: Iterable[int],
    *,
    backend: str,
    start: Start = AT_ONCE,
    on_progress: Callable[[float, int], None] | None = None,
) -> list[MeshState]:
    """Run a scene of gears and return the states of its teeth at some of its samples.

    Parameters
    ----------
    samples : iterable of int
        Numbers of samples, rising; the run ends with the last of them.
    backend, start, on_progress
        As for `gearidae.engine.follow`.

    Returns
    -------
    list of MeshState
        As many as the run has reached.

    Raises
    ------
    SceneError
        If the scene cannot be run so.
    KeyboardInterrupt
        On Ctrl-C.
    """
    reader = _Reader(scene, start.time, samples)
    ended = follow(
        scene,
        lambda *_: None,
        backend=backend,
        on_progress=on_progress,
        start=start,
        on_block=lambda _: reader.sample < 0,
        reader=reader,
    )
    if ended.status == "interrupted":
        raise KeyboardInterrupt
    return reader.states


class _Reader:
    """Reads the states of the teeth at some samples, see `gearidae.engine.integrate.driver.SampleReader`."""

    def __init__(self, scene: Scene, begin: float, samples: Iterable[int]) -> None:
        self._scene, self._begin, self._samples = scene, begin, deque(samples)
        self._materials = [
            MATERIAL_NAMES.index(material.name) for material in scene.materials() if material.share > 0.0
        ]
        self.states: list[MeshState] = []

    @property
    def sample(self) -> int:
        return self._samples[0] if self._samples else -1

    def read(self, problem: Problem, t: float, state: Callable[[], Floats]) -> None:
        m = problem.model
        # the rows of a population are many, and only read
        before = copied(m.state), copied(m.work), None if m.scene.population.flanks else m.rows.copy()
        y, row = state(), np.empty(len(problem.columns))
        observe_at(problem.addresses.base, t, y, row)
        seen = dict(zip(problem.columns, row.tolist(), strict=True))
        self.states.append(
            MeshState(
                time=self._time(self._samples.popleft()),
                travel=float(y[PHASE] + m.state.whole_pitches) * self._scene.geometry.base_pitch,
                transmission_error=seen["transmission_error"],
                gear_speed=seen["gear_speed"],
                mesh_force=seen["mesh_force"],
                contacts=tuple(self._contacts(m, t, y)),
            )
        )
        assign(m.state, before[0])
        assign(m.work, before[1])
        if before[2] is not None:
            m.rows[:] = before[2]
        if m.scene.orbit != 0.0:
            orbit_anew(m)

    def _time(self, sample: int) -> float:
        run = self._scene.run
        return float(sample_times(self._begin, run.duration, run.sample_count, range(sample, sample + 1))[0])

    def _contacts(self, m: Model, t: float, y: Floats) -> Iterator[ToothContact]:
        """Go through the pairs that are on their path, or near enough for a force."""
        geometry, length = self._scene.geometry, float(m.scene.length_unit)
        reach = all_pairs(m, y)
        for i in range(reach.total):
            flank, number = pair_at(reach, i)
            along = float(m.scene.coast_phase + number - y[PHASE] if flank else y[PHASE] - number)
            gap, rate = pair_gap(m, flank, number, y[U], y[V], y[PHASE], y[W])[:2]
            if not 0.0 <= along <= m.scene.contact_ratio and not in_reach(m, gap):
                continue
            asperities: tuple[int, ...] | None = None
            joined: dict[str, float] = {}
            if self._scene.contact.is_discrete:
                asperities, states = _joined_asperities(m, flank, number, y)
            else:
                heights = _joined_heights(m, (flank, number), t, y, (gap, rate))
                states = {MATERIAL_NAMES[n]: _state(m, n, gap, heights[n]) for n in self._materials}
                joined = {MATERIAL_NAMES[n]: heights[n][1] * length for n in self._materials}
                if m.scene.nodes > 0:
                    joined = dict.fromkeys(joined, np.nan)
            position = along * geometry.base_pitch
            yield ToothContact(
                pair=number + int(m.state.whole_pitches),
                flank=Flank(flank),
                place=position,
                radius=float(curvature_radii(geometry, position)[2]),
                gap=gap * length,
                force=force_of_one(m, t, y, flank, number) * float(m.scene.force_unit),
                joined=joined,
                states=states,
                asperities=asperities,
            )


def _joined_heights(
    m: Model, pair: tuple[int, int], t: float, y: Floats, there: tuple[float, float]
) -> list[tuple[float, float]]:
    """Gap and joined height of each material in the middle of a contact, scaled, from the pair's gap and gap rate."""
    k, (gap, rate) = history_of(m, *pair), there
    history, elastic = m.state.history[k], m.scene.nodes > 0
    if history.pair != pair[1]:
        return [(gap, gap)] * len(MATERIAL_NAMES)
    middle = turning = float(gap + y[first_unknown(m, k)]) if elastic else gap
    if history.direction * rate < 0.0:
        back = extreme_gap(t - float(m.state.time), float(history.gap), float(history.gap_rate), gap, rate)
        turning += (back - gap) * float(row_of(m, k, GAP_SHARE)[0] if elastic else 1.0)
    heights = []
    for number, material in enumerate(m.scene.material):
        limit = float(material.stretch_limit)
        joined = float(row_of(m, k, JOINED + number)[0] if elastic else history.joined[number])
        for passed in (turning, middle):
            joined = joined_height(joined, passed, limit)
        heights.append((middle, joined))
    return heights


def _state(m: Model, material: int, gap: float, height: tuple[float, float]) -> ContactState:
    """State of a material in a contact, from the pair's gap, and gap and joined height in its middle."""
    limit, stretch = float(m.scene.material[material].stretch_limit), height[0] - height[1]
    if gap >= m.scene.contact_gap:
        return ContactState.OPEN
    if stretch <= _JUST * limit:
        return ContactState.LOADING
    return ContactState.PARTLY_STRETCHED if stretch < (1.0 - _JUST) * limit else ContactState.FULLY_STRETCHED


def _joined_asperities(
    m: Model, flank: int, number: int, y: Floats
) -> tuple[tuple[int, ...], dict[str, ContactState]]:
    """Joined asperities of a pair, by their numbers on its flank, and the states of their materials."""
    k = history_of(m, flank, number)
    if m.state.history[k].pair != number:
        return (), {"bare": ContactState.OPEN}
    columns, pair = joined_candidates(m, k), state_of_pair(m, flank, number, y)
    at = spot_at(m, pair.position, pair.moves)
    x = columns[ARC] - at.arc
    overlaps = columns[HEIGHT] - pair.gap - 0.5 * float(m.scene.population.steepness) / at.radius * x * x
    materials = m.tables[columns[KIND].astype(np.int64) + K_MATERIAL].astype(np.int64)
    states = {}
    for material in np.unique(materials).tolist():
        stretched = bool((overlaps[materials == material] < 0.0).any())
        states[MATERIAL_NAMES[material]] = (
            ContactState.PARTLY_STRETCHED if stretched else ContactState.LOADING
        )
    first = m.tables[int(m.scene.population.starts_at) + flank_of(m, flank, number)]
    asperities = tuple((columns[INDEX] - first).astype(np.int64).tolist())
    return asperities, states or {"bare": ContactState.OPEN}
