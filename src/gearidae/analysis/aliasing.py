"""Records sampled too slowly for the oscillation of the loaded contact, which then shows at wrong frequencies."""

from __future__ import annotations

import math
import warnings

import numpy as np
import xarray as xr

from gearidae.archive.select import is_roller, run_scene, runs
from gearidae.mesh.pair_contact import pair_contact
from gearidae.scene import GearScene, require_gears


def warn_of_aliasing(data: xr.Dataset | xr.DataArray, rate: float) -> None:
    """Warn of a record whose sampling rate is below twice the frequency of the contact.

    Parameters
    ----------
    data : Dataset or DataArray
        Runs of gears with their drive torque; nothing is known of others.
    rate : float
        Sampling rate [Hz].
    """
    if not isinstance(data, xr.Dataset) or "scene" not in data.attrs or "drive_torque" not in data:
        return
    if is_roller(data):
        return
    frequency = max(_frequency(require_gears(run_scene(run)), run) for _, run in runs(data))
    if rate < 2.0 * frequency:
        warnings.warn(
            f"sampling at {rate:.4g} Hz is below twice the frequency of the loaded contact, {frequency:.4g} Hz: the "
            "spectrum may show oscillations of the contact at lower frequencies (aliasing)",
            stacklevel=3,
        )


def _frequency(scene: GearScene, run: xr.Dataset) -> float:
    """Frequency of one pair about the gap at which it carries the mean drive torque [Hz]; 0 if it carries none."""
    contact, geometry = pair_contact(scene), scene.geometry
    pinion, gear = geometry.base_radius_pinion, geometry.base_radius_gear
    torque = float(np.nan_to_num(np.abs(run["drive_torque"]).mean()))
    gap = contact.resting_gap(torque / pinion, 1e-3)
    if math.isnan(gap):
        return 0.0
    inverse_mass = pinion**2 / scene.gears.pinion_inertia + gear**2 / scene.gears.gear_inertia
    return math.sqrt(max(contact.joined_stiffness(gap), 0.0) * inverse_mass) / (2.0 * math.pi)
