"""Scenes that an engine did not survive, or did not come back from: a named ending, or block after block of output."""

import numpy as np
import pytest

import gearidae as gd
from gearidae import engine
from gearidae.engine.integrate import driver
from gearidae.errors import SceneError
from gearidae.records import Ending

STEPS = 20_000
"""After so many a run is left alone, at the end of a block: one that gives no block does not end."""
NAMED = {ending.status for ending in Ending} | {"refused"}

LOW = gd.preset("teodorescu2009_low_speed")
HIGH = gd.preset("teodorescu2009")


def ending(scene, backend):
    """Status of a run, ``stopped`` if it was left alone."""
    steps = [0]

    def take(block, statistics, wall_time):
        steps.append(int(statistics.steps))

    try:
        ended = engine.follow(scene, take, backend=backend, on_block=lambda block: steps[-1] >= STEPS)
    except SceneError:
        return "refused"
    return ended.status


def many_knots(count, duration):
    """A torque that changes at every knot, so that the solver starts anew there."""
    times = np.linspace(0.0, duration, count + 2)[1:-1]
    return [[float(time), 1e-12 * (number % 3)] for number, time in enumerate(times)]


ROWS = 1000
"""Events for which a block has room, in place of 16,384."""


def overrun():
    """1,200 restarts and no block: the portable driver yields events only where it does not restart."""
    return HIGH.replace({"drive.schedule": many_knots(1200, 6e-6), "run.duration": 6e-6, "run.samples": 11})


def close_knots():
    """Knots of drive and load a rounding apart: SUNDIALS finds the next stop behind the time it is at (-22)."""
    return HIGH.replace(
        {
            "drive.schedule": [[1e-5, 1e-12], [2e-5, 0.0]],
            "load.schedule": [[float(np.nextafter(1e-5, 1.0)), 1e-12], [2e-5, 0.0]],
            "run.duration": 3e-5,
            "run.samples": 11,
        }
    )


def wide_reach():
    """Thirty pairs a flank with nodes each: more than a thousand states, and blocks by steps alone last minutes."""
    return LOW.replace(
        {"contact.bodies": "elastic", "mesh.tip_relief_radius": 0.04, "run.duration": 1e-3, "run.samples": 11}
    )


def singular_start():
    """Soft, dense asperities under a wide contact: the search for static deflections meets a singular matrix."""
    return LOW.replace(
        {
            "gears.pinion_base_radius": 1.0,
            "gears.pinion_inertia": 0.0142760185733041,
            "gears.gear_inertia": 4.89369338585981e-12,
            "gears.pinion_teeth": 24,
            "gears.gear_teeth": 286,
            "gears.face_width": 3.1677009998657203e-06,
            "drive.torque": 7.135679518905753e-10,
            "surface": {
                "youngs_modulus": 15594.72124047093,
                "poisson_ratio": 0.23,
                "energy": 0.894948669428804,
                "asperity_density": 1e20,
                "asperity_radius": 0.02067547113562844,
                "roughness": 0.1,
            },
            "coating": {"sam_fraction": 0.4847809169993217, "energy": 1e-15},
            "contact.bodies": "elastic",
            "initial": {
                "gap": 5.512429183253995e-08,
                "gear_speed": 8.9e-6,
                "mesh_phase": 0.44295211130937173,
            },
            "run": {"duration": 0.1, "samples": 101, "rtol": 1e-7},
        }
    )


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("make", [overrun, wide_reach])
def test_the_engine_ends_with_a_name_or_gives_blocks(make, backend, monkeypatch):
    monkeypatch.setattr(driver, "BLOCK_EVENTS", ROWS)
    assert ending(make(), backend) in NAMED


def test_a_singular_start_has_a_name():
    """The search for the deflections of its nodes meets a singular matrix."""
    assert ending(singular_start(), "native") in NAMED


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_knots_a_rounding_apart_are_one(backend):
    """A failure of the solver is a name, and still none that this scene deserves."""
    assert ending(close_knots(), backend) in ("finished", "stopped")


@pytest.mark.parametrize("law", ["roller", "gears"])
@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_elastic_contacts_end_with_a_name_too(law, backend):
    """They have one column more than others: a run that is cut short before its first sample has it as well."""
    preset = gd.preset("roller_slow") if law == "roller" else LOW.replace({"run.duration": "1 ms"})
    scene = preset.replace({"contact.bodies": "elastic", "run.samples": 101})
    assert ending(scene, backend) in ("finished", "stopped")
