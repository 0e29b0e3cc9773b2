"""The life of a coating from its first passage to sticking, as a speed sensor sees it: the picture of its page.

Follows the low-speed gears from full coverage, reads the coverage of each state from its noisy speed signal, draws both
into ``life.png`` and prints what the page says of them, the time it took included::

    python -m gearidae_pages.life_picture docs/images
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Final

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import gearidae as gd

__all__ = ["ENERGY", "FRACTIONS", "NOISE", "follow", "shown"]

ENERGY: Final = "0.5 mJ/m^2"
NOISE: Final = 0.005
"""Of the sensor [rad/s]."""
FRACTIONS: Final = np.linspace(0.4, 1.0, 51)
"""Of the coating map."""


def follow(scene: gd.Scene, fractions: np.ndarray = FRACTIONS, fraction: float = 0.0) -> xr.Dataset:
    """Follow a life and assess the signal of each of its states.

    Parameters
    ----------
    scene : Scene
        With the coverage that the life begins with.
    fractions : ndarray
        Of the coating map.
    fraction : float
        Mean coverage at which the life ends, if the gear does not stick before.

    Returns
    -------
    Dataset
        From `gearidae.studies.assess_life`.
    """
    law = gd.wear.loss_law("adhesion_work", energy=ENERGY)
    life = gd.studies.life(scene, law, fraction=fraction)
    return gd.studies.assess_life(life, gd.studies.coating_map(scene, fractions), noise=NOISE)


def shown(seen: xr.Dataset) -> str:
    """What the page says: how long it lasts, what was simulated, and whether assessments hold the coverage."""
    true = seen["coverage"].mean("side")
    clear = seen["assessed_verdict"] == "clear"
    held = (seen["assessed_low"] <= true) & (true <= seen["assessed_high"])
    missed = [f"{value:.4f}" for value in true[clear & ~held].values]
    return (
        f"ends: {seen.attrs['ending']}, after {float(seen['passages'][-1]):.4g} passages\n"
        f"mesh cycles simulated: {seen.attrs['mesh_cycles_simulated']}\n"
        f"assessments: {seen.sizes['passages']}, clear: {int(clear.sum())}, of these holding the coverage: "
        f"{int((clear & held).sum())}{'; missed at ' + ', '.join(missed) if missed else ''}\n"
        f"coverages without a clear assessment: {np.round(true[~clear].values, 4).tolist()}\n"
    )


def main() -> None:
    """Draw and print."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path()
    plt.switch_backend("agg")
    began, processor = time.perf_counter(), time.process_time()
    seen = follow(gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 1.0}))
    sys.stdout.write(shown(seen))
    wall, processor = time.perf_counter() - began, time.process_time() - processor
    sys.stdout.write(f"{wall:.0f} s, {processor:.0f} s of the processor, map and assessments included\n")
    figure, ax = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
    gd.plot.life(seen, ax)
    figure.savefig(folder / "life.png", dpi=110)


if __name__ == "__main__":
    main()
