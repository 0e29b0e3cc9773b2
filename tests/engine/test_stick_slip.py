"""Set-valued dry resistance, with no contact in the way."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.records import EventKind

I2 = 6.1052e-20


def free_gear(**changes):
    """A gear in the middle of a wide backlash: nothing touches it."""
    return gd.preset("teodorescu2009").replace(
        {
            "mesh.backlash": 4e-6,
            "initial.gap": 2e-6,
            "drive.torque": 0.0,
            "drive.harmonic": [],
            "load.drag": 0.0,
            "run.samples": 2001,
            **changes,
        }
    )


def test_dry_resistance_brings_a_gear_to_rest_and_keeps_it_there():
    """The speed falls evenly by M20/I2 and stops at w0 I2 / M20."""
    stop = 1.5 * I2 / 3e-17
    scene = free_gear(**{"load.torque": 3e-17, "initial.gear_speed": 1.5, "run.duration": 4e-3})
    run = solve(scene)
    stick = run.events.time[run.events.kind == EventKind.STICK]
    assert stick == pytest.approx([stop], rel=1e-6, abs=0)
    expected = np.maximum(1.5 - 3e-17 / I2 * run.time, 0.0)
    np.testing.assert_allclose(run.samples["gear_speed"], expected, atol=1e-6 * 1.5)
    assert not run.samples["gear_speed"][run.time > stop * 1.000001].any()


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_driven_gear_breaks_away_when_contact_has_wound_up_to_the_resistance(backend):
    scene = gd.preset("teodorescu2009").replace(
        {
            "drive.torque": 0.0,
            "drive.harmonic": [],
            "drive.schedule": [[0.0, 0.0], [2e-3, 2.4e-11]],
            "mesh.damping": 1e-6,
            "initial.gear_speed": 0.0,
            "initial.gap": 3.6e-8,
            "run.duration": 1e-3,
            "run.samples": 4001,
        }
    )
    run = solve(scene, backend=backend)
    slip = run.events.time[run.events.kind == EventKind.SLIP]
    assert len(slip) >= 1
    first = slip[0]
    assert not run.samples["gear_speed"][run.time < first].any()
    before = np.searchsorted(run.time, first) - 1
    # the mesh force carries the pinion's torque at least, and holds until R2 F = M20 = 3e-11
    assert run.samples["gear_contact_torque"][: before + 1].max() <= 3e-11 * (1 + 1e-3)
    assert first < 2e-3 * (3e-11 / 4) / 2.4e-11 * 1.01  # quasi-static wind-up is the latest it can happen


def test_a_gear_at_rest_without_load_stays_at_rest():
    scene = free_gear(**{"load.torque": 3e-17, "initial.gear_speed": 0.0, "run.duration": 1e-3})
    run = solve(scene)
    assert not run.samples["gear_speed"].any()
    assert not len(run.events)


def test_resistance_that_comes_and_goes_holds_a_gear_that_nothing_pushes():
    changes = {"load.torque": 0.0, "load.harmonic": {"amplitude": 1.2e-20, "frequency": 1e3, "phase": 1.57}}
    run = solve(free_gear(**changes, **{"initial.gear_speed": 0.0, "run.duration": 0.01}))
    assert run.status == "finished"
    assert not run.samples["gear_speed"].any()
    assert not len(run.events)
