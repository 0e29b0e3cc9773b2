"""Derivatives of runs: closed forms, another method, and the trap of small steps."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import gearidae as gd
from gearidae.errors import SceneError

I1, I2, W0, T = 1.5263e-20, 6.1052e-20, 1.5, 0.004
LOW = gd.preset("teodorescu2009_low_speed")
FLIGHT = LOW.replace(
    {
        "mesh.backlash": 4e-6,
        "initial.gap": 2e-6,
        "run.duration": T,
        "run.samples": 2,
        "load.drag": 0.0,
        "load.viscous": 200 * I2,
    }
)


def last(name):
    return lambda ds: float(ds[name][-1])


def test_a_linear_and_a_curved_dependence_in_flight():
    """dw1/dM1 = T/I1, and d/dc of w0 exp(-c T/I2)."""
    torque = gd.studies.sensitivity(FLIGHT, "drive.torque", of=last("pinion_speed"))
    assert abs(torque.value - T / I1) <= torque.uncertainty <= 1e-2 * T / I1
    exact = -T / I2 * W0 * math.exp(-200 * T)
    with ThreadPoolExecutor(2) as executor:
        drag = gd.studies.sensitivity(
            FLIGHT, "load.viscous", of=last("gear_speed"), accuracy=1e-4, executor=executor
        )
    assert abs(drag.value - exact) <= drag.uncertainty <= 1e-4 * abs(exact)
    assert drag.figure == pytest.approx(W0 * math.exp(-200 * T), rel=1e-5)


def test_the_trap_of_a_small_step():
    """In a ringing contact at rtol 1e-6 a relative step of 1e-7 finds noise; the study does not."""
    scene = LOW.replace({"run.duration": 0.004, "run.samples": 2, "coating.sam_fraction": 0.6})
    derivative = gd.studies.sensitivity(scene, "drive.torque", of=last("gear_speed"))
    torque = scene.drive.torque
    tight = scene.replace({"run.rtol": 1e-11})
    values = [
        float(gd.simulate(tight.replace({"drive.torque": torque * (1 + s * 1e-4)})).gear_speed[-1])
        for s in (1, -1)
    ]
    reference = (values[0] - values[1]) / (2e-4 * torque)
    assert abs(derivative.value - reference) <= derivative.uncertainty
    assert derivative.uncertainty <= 0.05 * abs(reference)
    naive = [
        float(gd.simulate(scene.replace({"drive.torque": torque * (1 + s * 1e-7)})).gear_speed[-1])
        for s in np.linspace(-1, 1, 5)
    ]
    slopes = np.diff(naive) / (0.5e-7 * torque)
    assert np.abs(slopes - reference).max() > 10 * derivative.uncertainty


def test_a_jump_is_told_by_its_uncertainty():
    """A figure that jumps at the input has no derivative."""
    torque = LOW.drive.torque

    def step(ds):
        return float(float(ds.pinion_speed[-1]) > 4 * W0 + torque * T / I1)

    derivative = gd.studies.sensitivity(FLIGHT, "drive.torque", of=step)
    assert derivative.uncertainty >= 0.25 * abs(derivative.value)


@pytest.mark.parametrize(
    ("corner", "slope"), [(0.8, None), (0.8003, -1.0), (0.79999, 1.0), (0.806, -1.0), (0.83, -1.0)]
)
@pytest.mark.parametrize("smooth", [lambda x: 0.0, lambda x: x**3])
def test_a_corner_at_the_input_or_beside_it(corner, slope, smooth):
    """|x - corner| at 0.8: central differences agree over all steps that meet the corner, and are no derivative."""
    scene = FLIGHT.replace({"coating.sam_fraction": 0.8, "run.duration": 1e-9})
    derivative = gd.studies.sensitivity(
        scene,
        "coating.sam_fraction",
        of=lambda ds: abs(float(ds.sam_fraction) - corner) + smooth(float(ds.sam_fraction)),
    )
    rest = smooth(0.8 + 1e-6) - smooth(0.8 - 1e-6)
    if slope is None:
        assert derivative.uncertainty >= 1.0
    else:
        assert abs(derivative.value - slope - rest / 2e-6) <= derivative.uncertainty + 1e-9
        assert derivative.uncertainty < 0.02


@pytest.mark.parametrize(
    ("key", "of", "message"),
    [
        ("drive.nothing", "final_speed", "drive.nothing"),
        ("contact.bodies", "final_speed", "must hold a number"),
        ("load.torque", "final_speed", "is zero"),
        ("drive.torque", "nothing", "must be one of"),
        ("drive.torque", "gear_speed", "must be one of"),
    ],
)
def test_bad_input(key, of, message):
    with pytest.raises(SceneError, match=message):
        gd.studies.sensitivity(FLIGHT, key, of=of)
