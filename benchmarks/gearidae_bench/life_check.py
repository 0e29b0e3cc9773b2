"""Cycle jump against brute force: a life in which the coverage changes in every mesh cycle.

    python -m gearidae_bench.life_check [--cycles 2000] [--resolved place] [--pairing independent]

The loss law is made so fast that the gear sticks after some thousand mesh cycles, which are all simulated: each goes
on from the one before, with the coverage that its predecessor's exposures leave. The study jumps over the same life.
"""

from __future__ import annotations

import argparse
import math
import sys
import time

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.studies.life_coverage import coverage_of
from gearidae.studies.life_window import Cycles, window_scene

__all__ = ["brute_force", "main"]

PLACES = 8
START = 0.8
LIFE = 1.06e11
"""Passages to sticking from `START` at a low speed, for each J/m^2 of the law."""


def brute_force(
    scene: gd.Scene, law: gd.wear.LossLaw, most: int, resolved: str
) -> tuple[np.ndarray, np.ndarray, bool]:
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
    passages : ndarray, shape (n,)
        Of each tooth.
    states : ndarray, shape (n, size)
        Covered shares, as `gearidae.studies.life_coverage` has them.
    sticks : bool
    """
    assert scene.gears is not None
    teeth = scene.gears.pinion_teeth
    coverage = coverage_of(scene, resolved, PLACES)
    window = window_scene(scene, Cycles(0, 1), PLACES)
    state, origin, kept = coverage.start.copy(), None, [coverage.start]
    patience = 20.0
    for _ in range(most):
        own = window.replace({**coverage.changes(state), "run.duration": patience * window.run.duration})
        solution = engine.solve(own, origin=origin)
        if solution.extremes is None or not math.isnan(solution.extremes.stick_time):
            return np.arange(len(kept)) / teeth, np.array(kept), True
        seen = coverage.exposure(own, solution, 1, state)
        state = np.clip(state + law.rate(state, seen) / teeth, 0.0, 1.0)
        kept.append(state)
        began = 0.0 if origin is None else origin.time
        assert solution.checkpoint is not None
        origin = engine.end_of(own, solution.checkpoint, began)
    return np.arange(len(kept)) / teeth, np.array(kept), False


def _compared(
    scene: gd.Scene, resolved: str, found: xr.Dataset, passages: np.ndarray, states: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Coverage by side, tooth and place at the steps of a life, of the life and of the states simulated."""
    coverage = coverage_of(scene, resolved, PLACES)
    between = np.array([np.interp(found.passages, passages, column) for column in states.T]).T
    theirs = np.array([coverage.table(state) for state in between])
    if resolved == "uniform":
        return found.coverage.values[:, :, None, None], theirs
    return found.coverage_by_place.values, theirs


def main() -> None:
    """Compare both, and print what differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=2000)
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--resolved", default="uniform")
    parser.add_argument("--pairing", default="patches")
    given = parser.parse_args()
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {"coating.sam_fraction": START, "coating.pairing": given.pairing, "run.samples": "off"}
    )
    law = gd.wear.loss_law("adhesion_work", energy=given.cycles / 19 / LIFE)
    began = time.perf_counter()
    passages, states, sticks = brute_force(scene, law, 3 * given.cycles, given.resolved)
    middle = time.perf_counter()
    found = gd.studies.life(
        scene, law, tolerance=given.tolerance, places=PLACES, resolved=given.resolved, frequency=False
    )
    end = time.perf_counter()
    ours, theirs = _compared(scene, given.resolved, found, passages, states)
    ending = found.attrs.get("passages_to_sticking", math.nan)
    lines = [
        f"brute force: {len(passages) - 1} mesh cycles in {middle - began:.0f} s, sticks: {sticks}",
        f"cycle jump: {found.attrs['windows']} windows in {end - middle:.0f} s",
        f"passages to sticking: {passages[-1]:.2f} and {ending:.2f}",
        "passages, mean coverage by cycle jump and by brute force, largest difference of a place:",
        *(
            f"{n:9.3f} {a.mean():.4f} {b.mean():.4f} {np.abs(a - b).max():.4f}"
            for n, a, b in zip(found.passages.values, ours, theirs, strict=True)
        ),
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
