"""The slow twin of a train against an independent prototype: what an engine for trains has to give."""

from __future__ import annotations

import numpy as np
import pytest
from tests.reference.slow_train import SlowTrain
from tests.reference.trains import chain, split

from gearidae.scene import Scene

MICROENGINE = {
    "law": {"name": "microengine", "radius": "10 um", "force": "10 uN", "frequency": "600 Hz", "phase": 1.4},
    "orientation": 0.3,
    "pin_radius": "1.25 um",
}


def offset():
    """A split path in which one wheel stands 3 nm back."""
    tables = split()
    tables["meshes"]["two"]["offset"] = "3 nm"
    return tables


def idle():
    """The load on the idler, and a second mesh 2 um apart on either side, which is never touched."""
    tables = chain(load={"torque": 3e-12, "drag": 8e-18, "shaft": "idler"})
    tables["initial"]["gear_speed"] = 1880.0
    tables["meshes"]["second"] |= {"backlash": "4 um", "offset": 2e-6 - 36e-9, "damping": 0.0}
    return tables


def back():
    """From rest, driven back: the coast flanks carry."""
    initial = {"gear_speed": 0.0, "gap": "0.25 um", "mesh_phase": 0.3}
    return chain(hubs=0.3, drive={"torque": -1e-11}, load={"drag": 8e-18}, initial=initial)


# Speeds [rad/s], forces with damping [N], loads of the hubs [N], of a prototype with its own laws and integrator.
ROWS = {
    "chain": (
        chain(),
        50e-6,
        [4161.282544, 2080.366133, 1042.259530],
        [3.193079e-7, 2.174674e-7],
        [3.192505e-7, 4.168902e-7, 2.183324e-7],
    ),
    "hubs": (
        chain(hubs=0.3),
        50e-6,
        [4015.933091, 2011.210885, 1015.084236],
        [3.176108e-7, 2.633059e-7],
        [3.182865e-7, 4.497483e-7, 2.672545e-7],
    ),
    "split": (
        offset(),
        50e-6,
        [4125.602850, 2061.807619, 2066.516208, 1031.338538],
        [2.579289e-7, 8.733144e-8, 2.530263e-7, 9.072880e-8],
        None,
    ),
    "idle": (idle(), 50e-6, [3241.187837, 1620.649379, 940.0], [3.457531e-7, 0.0], None),
    "back": (
        back(),
        60e-6,
        [-1888.720378, -940.200039, -446.545279],
        [-2.419784e-7, -1.424346e-7],
        [2.411119e-7, 3.737341e-7, 1.326222e-7],
    ),
    "microengine": (
        chain(hubs=0.1, drive=MICROENGINE),
        40e-6,
        [4201.626281, 2098.808480, 1048.687568],
        [4.679560e-7, 6.440387e-7],
        [1.0282047e-5, 8.5879017e-7, 6.4374015e-7],
    ),
}


@pytest.mark.parametrize("name", ROWS)
def test_motion_is_that_of_the_prototype(name):
    """Speeds to 3e-8 (at this tolerance they are off by 5e-9 at most), forces to 3e-6."""
    tables, time, speeds, forces, hubs = ROWS[name]
    (end,) = SlowTrain(Scene.from_dict(tables)).run(np.array([time]), rtol=1e-10)
    np.testing.assert_allclose(end["speed"], speeds, rtol=3e-8)
    np.testing.assert_allclose(end["force"], forces, rtol=5e-6)
    if hubs is not None:
        np.testing.assert_allclose(end["hub"], hubs, rtol=5e-6)
