"""The table of the page "The mean and the gear on the bench": gears of one design with real asperities.

``python -m gearidae_pages.specimens [seeds]`` prints it: speeds and losses of 1 ms at high speed, undamped, and
starting torques without dry resistance. Twenty gears take about two minutes on two cores.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np

import gearidae as gd

COVERAGES = (1.0, 0.5, 0.0)
SCENE = gd.preset("teodorescu2009").replace(
    {
        "contact.roughness": "discrete",
        "run.duration": 1e-3,
        "run.samples": 2001,
        "run.asperity_events": False,
    }
)
KEPT = ("extremes", "energy_balance", "gear_angle", "asperities_in_contact")
ATTEMPTS = (1e-11, 3e-12)
"""Torques that are there at once [N m]."""


def rows(seeds: int) -> Iterator[tuple[str, ...]]:
    """Make the rows of the table, a cell for each coverage after the name.

    Parameters
    ----------
    seeds : int
        Number of gears.
    """
    over = {"coating.sam_fraction": COVERAGES, "contact.seed": range(seeds)}
    ds = gd.sweep(SCENE, over, keep=KEPT, progress=True)
    turned = ds.gear_angle.isel(time=-1) - ds.gear_angle.isel(time=0)
    assert SCENE.gears is not None
    cycles = turned / (2.0 * np.pi / SCENE.gears.gear_teeth)
    speed = (turned / SCENE.run.duration).values
    yield "mean speed of 1 ms, rad/s", *map(with_error, speed)
    yield "scatter between gears, rad/s", *(f"{gears.std(ddof=1):.2g}" for gears in speed)
    yield (
        "adhesion loss over drive work, %",
        *map(with_error, 100.0 * (ds.adhesion_loss / ds.drive_work).values),
    )
    joined = ds.asperities_in_contact
    yield "asperities joined, mean", *map(with_error, joined.mean("time").values)
    yield "asperities joined, largest", *(f"{gears:.0f}" for gears in joined.max(("time", "seed")).values)
    events = ((ds.asperity_onsets + ds.asperity_detachments) / cycles).values
    yield "joinings and detachments per mesh cycle", *map(with_error, events)
    free = SCENE.replace({"load.torque": 0.0, "drive.torque": ATTEMPTS[0]})
    torques = gd.studies.starting_torque(free, COVERAGES, seeds=seeds, progress=True)
    quantiles = torques.quantiles.values
    yield (
        "starting torque, 10 / 50 / 90 %, N m",
        *(" / ".join(f"{q:.2g}" for q in gears) for gears in quantiles),
    )
    yield "rate of the torque, N m per ms", *(f"{1e-3 * rate:.2g}" for rate in torques.rate.values)
    for torque in ATTEMPTS:
        if torque != ATTEMPTS[0]:
            torques = gd.studies.starting_torque(
                free.replace({"drive.torque": torque}), COVERAGES, seeds=seeds, progress=True
            )
        starts = (f"{int(gears.sum())} of {seeds}" for gears in torques.starts.values)
        yield f"start at {torque:g} N m, there at once", *starts


def with_error(values: np.ndarray) -> str:
    """Write a mean with its standard error in brackets."""
    error = values.std(ddof=1) / np.sqrt(values.size)
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{values.mean():.{digits}f} ({error:.{digits}f})"


def main() -> None:
    """Print the table."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    sys.stdout.write("| | coated | half coated | bare |\n|---|---|---|---|\n")
    for row in rows(seeds):
        sys.stdout.write(f"| {' | '.join(row)} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
