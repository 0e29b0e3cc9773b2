"""Cycle jump against brute force: a life in which the coverage changes in every mesh cycle.

    python -m gearidae_pages.life_check [--cycles 2000] [--resolved place] [--pairing independent]

The loss law is made so fast that the gear sticks after some thousand mesh cycles, which are all simulated: each goes
on from the one before, with the coverage that its predecessor's exposures leave. The study jumps over the same life.

Coverages are compared at the steps of the life, after as many passages, and after the same share of either life: the
curve falls so steeply before the gear sticks that a part of a mesh cycle there is more than a percent of the flank.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import dataclass

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.scene import require_gears
from gearidae.wear.lives.coverage import coverage_of
from gearidae.wear.lives.window import Cycles, gained, window_scene, with_exposures

__all__ = ["BruteForce", "Comparison", "brute_force", "compared", "fast_life"]

PLACES = 8
START = 0.8
LIFE = 1.06e11
"""Passages to sticking from `START` at a low speed, for each J/m^2 of the law."""
PATIENCE = 20.0
"""Time that a cycle gets, over that of a window."""


@dataclass(frozen=True)
class BruteForce:
    """A life all of whose mesh cycles were simulated.

    Attributes
    ----------
    passages : ndarray, shape (n,)
        Of each tooth of the pinion.
    states : ndarray, shape (n, size)
        Covered shares, as `gearidae.wear.lives.coverage` has them.
    sticks : bool
    """

    passages: np.ndarray
    states: np.ndarray
    sticks: bool


@dataclass(frozen=True)
class Comparison:
    """A life by cycle jump and by brute force.

    Attributes
    ----------
    table : ndarray, shape (steps, 4)
        Passages, mean coverage by cycle jump and by brute force, largest difference of a place or side.
    mean, place : float
        Largest difference of the mean coverage, and of that of a place or side, until `before` passages before the end
        [of the coverage there].
    mean_by_share, place_by_share : float
        The same over the whole life, compared after the same share of it.
    sticking : tuple of float
        Passages to sticking by cycle jump and by brute force.
    """

    table: np.ndarray
    mean: float
    place: float
    mean_by_share: float
    place_by_share: float
    sticking: tuple[float, float]

    @property
    def ratio(self) -> float:
        """Passages to sticking by cycle jump over those by brute force, less 1."""
        return self.sticking[0] / self.sticking[1] - 1.0


def brute_force(scene: gd.Scene, law: gd.wear.LossLaw, most: int, resolved: str) -> BruteForce:
    """Simulate every mesh cycle.

    Parameters
    ----------
    scene : Scene
    law : LossLaw
    most : int
        Mesh cycles at most.
    resolved : str
        As for `gearidae.studies.life`.

    Returns
    -------
    BruteForce
    """
    scene = require_gears(scene)
    teeth = scene.gears.pinion_teeth
    coverage = coverage_of(scene, resolved, PLACES)
    window = window_scene(scene, Cycles(0, 1), PLACES)
    state, kept = coverage.start.copy(), [coverage.start]
    start = engine.Start()
    before = None
    for _ in range(most):
        covered = window.replace({**coverage.changes(state), "run.duration": PATIENCE * window.run.duration})
        solution = engine.solve(covered, start=start)
        if solution.extremes is None or not math.isnan(solution.extremes.stick_time):
            return BruteForce(np.arange(len(kept)) / teeth, np.array(kept), True)
        # exposures go on where the coating is the same as in the cycle before
        exposures = gained(
            solution, before if start.scene and start.scene.coating == covered.coating else None, covered
        )
        seen = coverage.exposure(covered, with_exposures(solution, exposures), 1, state)
        state = np.clip(state + law.rate(state, seen) / teeth, 0.0, 1.0)
        kept.append(state)
        before = solution
        assert solution.checkpoint is not None
        start = engine.end_of(covered, solution.checkpoint, start.time)
    return BruteForce(np.arange(len(kept)) / teeth, np.array(kept), False)


def fast_life(cycles: int, pairing: str = "patches") -> tuple[gd.Scene, gd.wear.LossLaw]:
    """Make gears whose coating lasts some mesh cycles.

    Parameters
    ----------
    cycles : int
        How many, about.
    pairing : str
        As ``coating.pairing``.

    Returns
    -------
    scene : Scene
    law : LossLaw
    """
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {"coating.sam_fraction": START, "coating.pairing": pairing, "run.samples": "off"}
    )
    assert scene.gears is not None
    return scene, gd.wear.loss_law("adhesion_work", energy=cycles / scene.gears.pinion_teeth / LIFE)


def compared(
    scene: gd.Scene, resolved: str, life: xr.Dataset, brute: BruteForce, *, before: float = 1.0
) -> Comparison:
    """Compare a life with brute force.

    Parameters
    ----------
    scene : Scene
        That both began with.
    resolved : str
    found : Dataset
        From `gearidae.studies.life`.
    brute : BruteForce
    before : float
        Passages before the end of either from which on coverages after as many passages are not compared.

    Returns
    -------
    Comparison
    """
    coverage = coverage_of(require_gears(scene), resolved, PLACES)
    uniform = resolved == "uniform"
    ours = life.coverage.values[:, :, None, None] if uniform else life.coverage_by_place.values
    sticking = (float(life.attrs.get("passages_to_sticking", math.nan)), float(brute.passages[-1]))

    def at(passages: np.ndarray) -> np.ndarray:
        columns = [np.interp(passages, brute.passages, column) for column in brute.states.T]
        return np.array([coverage.table(state) for state in np.array(columns).T])

    passages = life.passages.values
    scale = sticking[1] / sticking[0] if brute.sticks else 1.0
    theirs, by_share = at(passages), at(passages * scale)
    early = passages <= min(sticking[1], passages[-1]) - before if brute.sticks else passages >= 0.0
    table = np.array([passages, _means(ours), _means(theirs), np.abs(ours - theirs).max(axis=(1, 2, 3))])
    return Comparison(
        table.T,
        _relative(_means(ours), _means(theirs), early),
        _relative(ours, theirs, early),
        _relative(_means(ours), _means(by_share)),
        _relative(ours, by_share),
        sticking,
    )


def _means(tables: np.ndarray) -> np.ndarray:
    return np.asarray(tables.mean(axis=(1, 2, 3)))


def _relative(ours: np.ndarray, theirs: np.ndarray, chosen: np.ndarray | slice = slice(None)) -> float:
    """Largest difference over the share that is there by brute force; all of it where none is left."""
    wide = np.abs(ours - theirs)
    share = np.divide(wide, theirs, out=np.where(wide > 0.0, 1.0, 0.0), where=theirs > 0.0)
    return float(share[chosen].max())


def main() -> None:
    """Compare both, and print what differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=2000)
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--resolved", default="uniform")
    parser.add_argument("--pairing", default="patches")
    arguments = parser.parse_args()
    scene, law = fast_life(arguments.cycles, arguments.pairing)
    began = time.process_time()
    brute = brute_force(scene, law, 4 * arguments.cycles, arguments.resolved)
    middle = time.process_time()
    life = gd.studies.life(
        scene,
        law,
        tolerance=arguments.tolerance,
        places=PLACES,
        resolved=arguments.resolved,
        frequency=False,
        passages=1e12 if brute.sticks else float(brute.passages[-1]),
    )
    end = time.process_time()
    seen = compared(scene, arguments.resolved, life, brute)
    simulated, direct = (life.attrs[f"mesh_cycles_{name}"] for name in ("simulated", "direct"))
    lines = [
        f"brute force: {len(brute.passages) - 1} mesh cycles, {middle - began:.0f} s, sticks: {brute.sticks}",
        f"cycle jump: {simulated} mesh cycles, {direct} of them one by one, {end - middle:.0f} s",
        f"passages to sticking: {seen.sticking[1]:.2f} and {seen.sticking[0]:.2f}, {100.0 * seen.ratio:.2f} %",
        "largest difference of the coverage [% of it], mean and that of a place or side:",
        f"  after as many passages, but in the last: {100.0 * seen.mean:.2f} {100.0 * seen.place:.2f}",
        f"  after the same share of the life: {100.0 * seen.mean_by_share:.2f} {100.0 * seen.place_by_share:.2f}",
        "passages, mean coverage by cycle jump and by brute force, largest difference of a place or side:",
        *(f"{n:9.3f} {a:.4f} {b:.4f} {c:.4f}" for n, a, b, c in seen.table),
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
