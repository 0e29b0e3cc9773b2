"""What the table of errors of teeth counts, on a speed in closed form."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from gearidae_pages.tooth_errors import DEVICE, figures, markdown


def test_figures_are_those_of_a_speed_in_closed_form():
    """Two lines, one inside the band: its rms is its amplitude over the root of two."""
    time = np.linspace(0.0, 3e-3, 3001)
    mesh = 940.0 * DEVICE.gears.gear_teeth
    speed = 940.0 + 20.0 * np.sin(mesh * time) + 3.0 * np.sin(10.0 * mesh * time)
    run = xr.Dataset({"gear_speed": ("time", speed), "largest_mesh_force": 2e-6}, {"time": time})
    low, high, force, band = figures(run)
    assert (low, high, force) == (speed[600:].min(), speed[600:].max(), 2e-6)
    # a Hann window leaks a ten thousandth of a line of 20 rad/s over four mesh frequencies
    assert band == pytest.approx(3.0 / np.sqrt(2.0), rel=2e-3)


def test_the_table_has_a_column_for_each_error_and_ranges_of_the_draws():
    short = DEVICE.replace({"run.duration": "50 us", "run.samples": 201})
    lines = markdown(2, short, (0.0, 10e-9)).splitlines()
    assert lines[0] == "| rms of the sum of two teeth | 0 | 10 nm |"
    assert all(line.count("|") == 4 for line in lines)
    assert "(" not in lines[3].split("|")[2]
    assert " to " in lines[3].split("|")[3]
