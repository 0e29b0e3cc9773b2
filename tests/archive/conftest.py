"""Solutions with made-up numbers, for tests of how they are labelled and stored."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearidae.records import (
    GEAR_COLUMNS,
    ROLLER_COLUMNS,
    EventKind,
    Events,
    Flank,
    Passages,
    Solution,
    Statistics,
)
from gearidae.records.passages import PASSAGE
from gearidae.scene import Scene
from gearidae.scene.sampled import rows_of

MakeSolution = Callable[..., Solution]


def made_up_passages(count: int) -> Passages:
    """Passages with numbers that tell columns and rows apart, on both flanks in turn."""
    columns = len(Passages.columns)
    table = np.arange(1.0, 1.0 + count * columns).reshape(count, columns)
    table[:, PASSAGE.flank] = np.arange(count) % 2
    return Passages.of_table(table)


@pytest.fixture(scope="session")
def make_solution() -> MakeSolution:
    """Make what the engine would hand up for a scene, with numbers that tell columns and runs apart."""

    def make(scene: Scene, *, reached: float = 1.0, status: str = "finished", impacts: int = 3) -> Solution:
        whole = np.linspace(0.0, scene.run.duration, scene.run.samples)
        time = whole[: max(1, round(reached * len(whole)))]
        names = GEAR_COLUMNS if scene.roller is None else ROLLER_COLUMNS
        phase = 40.0 * time / scene.run.duration
        samples = {
            name: number + scene.coating.sam_fraction + 0.01 * np.sin(phase)
            for number, name in enumerate(names, start=1)
        }
        kinds = [EventKind.ONSET, EventKind.SEPARATION] * impacts
        size = len(kinds)
        return Solution(
            time=time,
            samples=samples,
            events=Events(
                time=np.linspace(0.0, time[-1], size),
                kind=np.array(kinds, dtype=np.int8),
                pair=np.arange(size, dtype=np.int64),
                flank=np.full(size, Flank.DRIVE, dtype=np.int8),
                gap_rate=np.full(size, -1e-6),
            ),
            passages=made_up_passages(impacts) if Passages in rows_of(scene) else Passages.none(),
            statistics=Statistics(
                steps=100,
                residual_evaluations=200,
                jacobian_evaluations=30,
                error_test_failures=4,
                convergence_failures=5,
                restarts=6,
                guard_evaluations=700,
                wall_time=0.25,
                backend="native",
                skipped={"coast_flank": 1},
            ),
            status=status,
            message="" if status == "finished" else f"it ended: {status}",
        )

    return make
