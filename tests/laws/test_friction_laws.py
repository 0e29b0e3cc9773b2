"""Set-valued laws of a shaft: limits and losses by their formulas, and what a scene says of them."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

import gearidae as gd
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.engine.setup.build import make_problem
from gearidae.formulas.quadrature import Ends
from gearidae.laws.frictions import (
    FRICTION_LAWS,
    book_stop,
    friction_laws_of,
    has_friction_law,
    law_limit,
    least_law_limit,
)
from gearidae.laws.law import DRIVE, LOAD
from gearidae.laws.shaft.dry_load import DRY_LOAD
from gearidae.laws.shafts import driving_force
from gearidae.records.standing import Holding
from reference.compilations import COUNTING

PLAIN = gd.preset("teodorescu2009_low_speed").replace({"load.torque": 0.0})
WAVE = {"load.torque": "20 pN m", "load.harmonic": {"amplitude": "30 pN m", "frequency": 700.0, "phase": 0.3}}
LOADS = {
    "load.torque": "1 pN m",
    "load.harmonic": {"amplitude": "1 pN m", "frequency": 700.0},
    "load.schedule": [[0.0, 0.0], [1.0, 1e-12]],
    "load.law": {"name": "motor", "parameters": [1e-12, 10.0]},
}


@pytest.fixture(scope="module")
def waves():
    """Return a model with a dry load that a harmonic takes below zero in a part of each period."""
    return make_problem(PLAIN.replace(WAVE)).model


@given(t=st.floats(0.0, 1e6))
def test_a_dry_load_resists_by_its_torque_and_never_pushes(waves, t):
    torque = driving_force(waves, LOAD, t, 0.0, 0.0)
    assert law_limit(waves, LOAD, t, 0.0, 0.0) == max(torque, 0.0)
    unit = float(waves.scene.force_unit * waves.scene.gear_radius)
    seconds = t * float(waves.scene.time_unit)
    wanted = 2e-11 + 3e-11 * np.cos(2.0 * np.pi * 700.0 * seconds + 0.3)
    # rounding of an angle of some thousand periods
    assert torque * unit == pytest.approx(wanted, rel=0, abs=3e-11 * 1e-9)


def test_the_smallest_limit_at_rest_is_that_of_harmonics_at_their_worst(waves):
    assert least_law_limit(waves, LOAD, 0.3, 0.0) == 0.0
    steady = make_problem(PLAIN.replace(WAVE | {"load.torque": "50 pN m"})).model
    unit = float(steady.scene.force_unit * steady.scene.gear_radius)
    assert least_law_limit(steady, LOAD, 0.3, 0.0) * unit == pytest.approx(2e-11, rel=1e-12, abs=0)


def model_with(constant):
    """Return a model of a gear that slips forward, with a constant dry load."""
    m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
    m.scene.torque[LOAD].constant, m.scene.torque[LOAD].resists = constant, 1
    m.state.slip = 1.0
    return m


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_constant_dry_load_takes_torque_times_travel(way):
    """Exactly, whatever the speeds; it loses energy in both directions."""
    m = model_with(3.0)
    m.state.slip = way
    DRY_LOAD.begin(m, LOAD, 0.0, 0.0, way, 0.0, True)
    speeds = Ends(way, 0.7 * way, 5.0 * way, -0.2 * way)
    assert DRY_LOAD.loss(m, LOAD, 0.5, 0.5, 0.0, 2.0 * way, speeds, (1.0, 0.25)) == (7.0, 0.25)
    assert float(m.state.energy.dry_loss) == 6.0
    assert book_stop(m, LOAD, 0.5) == 0.0
    assert float(m.state.energy.dry_loss) == 6.5


@pytest.mark.parametrize("first", [2.0, -1.0])
def test_a_dry_load_that_is_cut_off_takes_the_rest_of_a_straight_line(first):
    """From `first` to the constant load at the end of an interval, at a steady speed; the error says it is rough."""
    last = -2.0 if first > 0.0 else 3.0
    m = model_with(last)
    m.work.quadrature.friction[LOAD].dry_force = first
    size, error = DRY_LOAD.loss(m, LOAD, 0.5, 0.5, 0.0, 2.0, Ends(4.0, 0.0, 4.0, 0.0), (0.0, 0.0))
    share = -first / (last - first)  # of the interval where the line passes zero
    wanted = quad(lambda s: 2.0 * max(first + (last - first) * s, 0.0), 0.0, 1.0, points=[share])[0]
    assert size == error == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("key", LOADS)
def test_each_part_of_a_load_makes_it_one_that_holds(key):
    assert friction_laws_of(PLAIN, LOAD) == ()
    loaded = PLAIN.replace({key: LOADS[key]})
    assert friction_laws_of(loaded, LOAD) == (DRY_LOAD,)
    assert not has_friction_law(loaded, DRIVE, DRY_LOAD)
    for scene, number in ((PLAIN, 0), (loaded, 1)):
        s = make_problem(scene).model.scene
        assert [int(torque.resists) for torque in s.torque] == [0, number]
        assert Holding(int(s.friction.holding)) == (Holding["DRY_RESISTANCE"] if number else Holding(0))


def test_what_laws_say_when_they_hold_has_numbers_of_its_own():
    numbers = [holder.number for law in FRICTION_LAWS for holder in law.holders]
    assert len(set(numbers)) == len(numbers)
    assert {Holding(number).words for number in numbers} == {
        holder.name.replace("_", " ") for law in FRICTION_LAWS for holder in law.holders
    }
    assert all(number.bit_count() == 1 for number in numbers)


ALONE = """
import numpy as np
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.laws.shaft.dry_load import DRY_LOAD

m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
m.scene.torque[1].constant = 5.0
begun = count.n
print(DRY_LOAD.limit(m, 1, 0.0, 0.0, -3.0, 1.0))
print(count.n - begun)
"""


def test_a_law_compiles_alone(tmp_path, monkeypatch):
    """Some dozens of functions and not the solver's, and none in a second process."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    lines = [
        subprocess.run(
            [sys.executable, "-c", COUNTING + ALONE], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    ]
    assert [float(line[0]) for line in lines] == [6.0, 6.0]
    assert 0 < int(lines[0][1]) < 100
    assert lines[1][1] == "0"
