"""Starting torque over the time at rest, of hubs whose friction ages: the picture of the page on friction.

Draws ``starting_rests.png``::

    python -m gearidae_pages.starting_rests docs/images
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import gearidae as gd

__all__ = ["AGEING", "TIMES", "torques"]

AGEING: Final = gd.preset("teodorescu2009").replace(
    {
        "drive.harmonic": None,
        "gears.hub_friction": 0.2,
        "gears.hub_friction_rise": 0.7,
        "gears.hub_ageing_time": "1 ms",
        "gears.hub_memory_length": "50 nm",
        "gears.pinion_hub_radius": "10 um",
        "gears.gear_hub_radius": "20 um",
        "gears.pinion_hub_adhesion": "1 uN",
    }
)
TIMES: Final = (0.0, *np.logspace(-5.0, 0.0, 16).tolist())
"""At rest [s]."""


def torques(times: tuple[float, ...] = TIMES, tolerance: float = 0.02) -> xr.Dataset:
    """Starting torques of the gears of the page.

    Parameters
    ----------
    times : tuple of float
        At rest [s].
    tolerance : float
        Of the search among simulated torques.

    Returns
    -------
    Dataset
        From `gearidae.studies.starting_torque`.
    """
    return gd.studies.starting_torque(AGEING, rest_time=times, impacts=1, tolerance=tolerance)


def main() -> None:
    """Draw the picture into the folder that the command line names."""
    ax = gd.plot.starting_rests(torques())
    ax.figure.savefig(Path(sys.argv[1]) / "starting_rests.png", dpi=110, metadata={"Software": None})
    plt.close(ax.figure)


if __name__ == "__main__":
    main()
