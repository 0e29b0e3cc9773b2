"""Laws of a shaft: each compiles alone, sums keep the order of the list, and a second process compiles nothing."""

import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.compiled import compiled
from gearidae.engine.setup.build import make_problem
from gearidae.laws.law import DRIVE, LOAD, in_turn
from gearidae.laws.shaft.drag import DRAG
from gearidae.laws.shafts import SHAFT_LAWS, acting, by_speed, driving_force, slowing
from reference.compilations import COUNTING

SPEEDS = st.floats(-1e3, 1e3)


@pytest.fixture(scope="module")
def model():
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "load.viscous": 3e-17,
            "drive.harmonic": [
                {"amplitude": 2e-11, "frequency": 100.0, "phase": 0.4},
                {"amplitude": 1e-11, "order": 3, "phase": 0.2},
            ],
            "drive.speed": 5.0,
            "drive.speed_gain": 1e-13,
        }
    )
    return make_problem(scene).model


@given(speed=SPEEDS, force=SPEEDS)
def test_drags_resist_as_their_formulas_on_the_shaft_that_has_them(model, speed, force):
    """To the last bit, in the order of the terms: tenfold runs differ otherwise."""
    drag, viscous = (float(model.scene.torque[LOAD][name]) for name in ("drag", "viscous"))
    wanted = force - drag * speed * abs(speed) - viscous * speed
    assert DRAG.force(model, LOAD, 0.0, 0.0, speed, force) == wanted
    assert acting(model, LOAD, 0.0, 0.0, speed, force) == wanted
    assert acting(model, DRIVE, 0.0, 0.0, speed, force) == force


@given(t=st.floats(0.0, 10.0), angle=st.floats(-10.0, 10.0), speed=SPEEDS)
def test_a_sum_is_its_laws_one_after_the_other(model, t, angle, speed):
    value = -0.0
    for law in SHAFT_LAWS:
        if law.drives:
            value = law.force(model, DRIVE, t, angle, speed, value)
    assert driving_force(model, DRIVE, t, angle, speed) == value


@given(speed=SPEEDS)
def test_slopes_are_those_of_the_forces(model, speed):
    """Of laws that say one; the others are mild."""
    step = 1e-3 * (1.0 + abs(speed))
    for shaft in (DRIVE, LOAD):
        slope = by_speed(model, shaft, 0.0, speed, 0.0)
        change = 0.0
        for law in SHAFT_LAWS:
            if law.by_speed is not None:
                at = [law.force(model, shaft, 0.0, 0.0, speed + x, 0.0) for x in (step, -step)]
                change += (at[0] - at[1]) / (2.0 * step)
        # the drag has a kink in its slope at rest, within one step of which the difference is off by its change
        kink = 2.0 * float(model.scene.torque[shaft].drag) * step
        assert slope == pytest.approx(change, rel=1e-6, abs=kink + 1e-9)


def test_what_slows_a_shaft_down_is_what_its_keys_say():
    scene = gd.preset("teodorescu2009_low_speed").replace({"load.viscous": 3e-17, "load.drag": 2e-18})
    assert slowing(scene, LOAD) == (3e-17, 2e-18)
    assert slowing(scene, DRIVE) == (0.0, 0.0)


def test_verbs_that_are_left_out_add_nothing():
    @compiled
    def once(value):
        return value + 1.0

    @compiled
    def half(value):
        return 0.5 * value

    assert in_turn((once, None, half))(3.0) == 2.0
    assert in_turn((None, half, once))(3.0) == 2.5


ALONE = """
import numpy as np
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.laws.law import in_turn
from gearidae.laws.shaft.constant import CONSTANT
from gearidae.laws.shaft.drag import DRAG

m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
for name, value in (("drag", 2.0), ("viscous", 3.0), ("constant", 5.0)):
    m.scene.torque[name] = value
begun = count.n
for laws in ((CONSTANT, DRAG), (DRAG, CONSTANT), (DRAG, DRAG)):
    print(in_turn(tuple(law.force for law in laws))(m, 1, 0.0, 0.0, -3.0, 1.0))
print(count.n - begun)
"""


def test_a_sum_of_laws_is_compiled_once_per_machine(tmp_path, monkeypatch):
    """Sums of one shape are entries of their own on disk, and a second process finds all."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    lines = [
        subprocess.run(
            [sys.executable, "-c", COUNTING + ALONE], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    ]
    drags = 2.0 * 9.0 + 3.0 * 3.0
    wanted = [1.0 + 5.0 + drags, 1.0 + 5.0 + drags, 1.0 + 2.0 * drags]
    assert [[float(x) for x in line[:3]] for line in lines] == [wanted, wanted]
    assert int(lines[0][3]) > 0
    assert lines[1][3] == "0"
