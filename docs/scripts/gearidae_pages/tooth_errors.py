"""What errors of single teeth do to a run: ``python -m gearidae_pages.tooth_errors [--seeds N] [--picture FILE]``.

Prints the table of ``docs/measurements.md``: a device-like pair of gears at a held speed, with errors of growing
size, each drawn from several seeds (some minutes).
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae.arrays import Floats
from gearidae.scene import require_gears

__all__ = ["DEVICE", "ERRORS", "figures", "markdown"]

ERRORS = (0.0, 1e-9, 3e-9, 10e-9, 30e-9, 100e-9)
"""Rms of the sum of the errors of two teeth [m]."""
_BAND = (5.0, 30.0)
"""Lines of the spectrum that are summed, in mesh frequencies."""
_SETTLED = 0.2
"""Part of a run that is left out at its start."""
DEVICE = gd.Scene.from_dict(
    {
        "gears": {
            "pinion_inertia": "9.6e-21 kg m^2",
            "gear_inertia": "4.2e-18 kg m^2",
            "pinion_base_radius": "34.715 um",
            "pinion_teeth": 19,
            "gear_teeth": 76,
            "pressure_angle": "20 deg",
            "face_width": "2.25 um",
        },
        "mesh": {"backlash": "0.5 um", "tip_relief_radius": "10 um", "radius_force": True},
        "surface": {
            "youngs_modulus": "161 GPa",
            "poisson_ratio": 0.23,
            "energy": "1.2 J/m^2",
            "asperity_density": "169 / um^2",
            "asperity_radius": "130 nm",
            "roughness": "6 nm",
        },
        "coating": {"sam_fraction": 1.0, "energy": "0.02 J/m^2", "thickness": "1 nm"},
        "drive": {
            "torque": "7.5e-12 N m",
            "speed_gain": "1e-12 N m s/rad",
            "speed": [["0 ms", "3770 rad/s"], ["3 ms", "3770 rad/s"]],
        },
        "load": {"torque": "3e-11 N m", "drag": "8e-18 N m s^2/rad^2"},
        "initial": {"gear_speed": "940 rad/s", "gap": "20 nm", "mesh_phase": 0.3},
        "run": {"duration": "3 ms", "samples": 3001, "rtol": 1e-6},
    }
)
"""Gears of the size of Sandia's drive and load gears, coated (see *What the presets are beside a device*).

They begin near the gap at which the load is carried: from 36 nm the first touch would be the largest force
without errors.
"""


def figures(run: xr.Dataset) -> Floats:
    """Smallest and largest speed of the gear [rad/s], largest force [N], rms of the band of its spectrum [rad/s]."""
    settled = run.isel(time=slice(int(_SETTLED * run.sizes["time"]), None))
    speed, time = settled["gear_speed"].values, settled["time"].values
    mesh = float(speed.mean()) * require_gears(DEVICE).gears.gear_teeth / (2.0 * np.pi)
    taper = np.hanning(speed.size)
    line = np.fft.rfft((speed - speed.mean()) * taper)
    frequency = np.fft.rfftfreq(speed.size, float(time[1] - time[0])) / mesh
    inside = (frequency >= _BAND[0]) & (frequency <= _BAND[1])
    band = np.sqrt(2.0 * (np.abs(line[inside]) ** 2).sum() / (speed.size * (taper**2).sum()))
    return np.array([speed.min(), speed.max(), float(run["largest_mesh_force"]), band])


def markdown(seeds: int, scene: gd.Scene = DEVICE, errors: Sequence[float] = ERRORS) -> str:
    """Make the table: means over the seeds, and in brackets the smallest and the largest of the draws.

    Draws whose teeth would jam are left out: others follow them.
    """
    columns = []
    for rms in errors:
        drawn, fit = _fitting(scene, rms, seeds if rms > 0.0 else 1)
        runs = gd.sweep(drawn, {"mesh.pitch_error_seed": fit}, progress=False)
        columns.append(np.array([figures(runs.isel(pitch_error_seed=k)) for k in range(len(fit))]))
    heads = ["0" if rms == 0.0 else f"{1e9 * rms:g} nm" for rms in errors]
    rows = [
        ("gear speed, rad/s", [f"{c[:, 0].mean():.0f} to {c[:, 1].mean():.0f}" for c in columns]),
        ("largest force of the teeth, µN", [_spread(1e6 * c[:, 2], 2) for c in columns]),
        ("rms of speed at 5 to 30 times the mesh frequency, rad/s", [_spread(c[:, 3], 2) for c in columns]),
    ]
    lines = [["rms of the sum of two teeth", *heads], ["---"] * (len(heads) + 1)]
    lines += [[name, *cells] for name, cells in rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _fitting(scene: gd.Scene, rms: float, count: int) -> tuple[gd.Scene, list[int]]:
    """Find the first seeds that the backlash has room for, and the scene of the first."""
    fit: list[int] = []
    first = scene
    for seed in itertools.count():
        if len(fit) == count:
            return first, fit
        try:
            drawn = scene.replace({"mesh.pitch_error_rms": rms, "mesh.pitch_error_seed": seed})
        except gd.SceneError:
            continue
        first = first if fit else drawn
        fit.append(seed)
    raise AssertionError("counts on")


def _spread(values: Floats, digits: int) -> str:
    mean = f"{values.mean():.{digits}f}"
    return mean if values.size == 1 else f"{mean} ({values.min():.{digits}f} to {values.max():.{digits}f})"


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--picture", help="draw the picture of docs/howto_errors.md in place of the table")
    options = parser.parse_args()
    if options.picture is None:
        sys.stdout.write(f"{markdown(options.seeds)}\n")
        return
    run = gd.simulate(DEVICE.replace({"mesh.pitch_error_rms": 1e-8, "mesh.pitch_error_seed": 3}))
    gd.plot.write(gd.plot.tooth_errors(run), options.picture, overwrite=True)


if __name__ == "__main__":
    _main()
