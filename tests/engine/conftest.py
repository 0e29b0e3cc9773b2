"""Scenes that several tests of the engine begin from."""

import pytest

import gearidae as gd


@pytest.fixture
def flight():
    """Gears that do not touch for 8 ms, without torque or drag."""
    return gd.preset("teodorescu2009_low_speed").replace(
        {
            "mesh.backlash": 4e-6,
            "initial.gap": 2e-6,
            "run.duration": 0.008,
            "run.samples": 25,
            "run.rtol": 1e-9,
            "drive.torque": 0.0,
            "load.drag": 0.0,
        }
    )
