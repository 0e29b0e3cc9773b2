"""Free gears: against scipy in the tests and closed forms, however they are asked for, and only where needed."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.model.state import STATE
from gearidae.engine.observers.standing.free_gears import FreeGears, Zero
from gearidae.engine.setup.build import make_problem
from reference.own_pair import OWN_PAIR
from reference.standing import Plant, free_way

PITCH = 2.0 * math.pi / 54
BLANK = Zero(*np.zeros((), STATE)["standing"]["zero"][0].item())
SURFACE = {"youngs_modulus": 161e9, "poisson_ratio": 0.23, "energy": 1.5, "asperity_density": 169e12}
SURFACE |= {"asperity_radius": 450e-9, "roughness": 6e-9}
PAIR = gd.Scene.from_dict(
    OWN_PAIR | {"surface": SURFACE, "drive": {"torque": 4.5e-18}, "run": {"duration": 1.0, "samples": "off"}}
)


@pytest.fixture(scope="module", autouse=True)
def _ready():
    """Compiled functions are made ready by a run."""
    gd.simulate(PAIR.replace({"run.duration": 1e-6}))


PROBLEMS = []
"""Free gears know their model by its address."""


def free_gears(changes, start=0.0):
    """Free gears of a scene from rest at a time [s], and the scene."""
    scene = PAIR.replace(changes)
    problem = make_problem(scene)
    problem.prepare(1e-6, 2)
    PROBLEMS.append(problem)
    zero = BLANK._replace(time=start, free_time=start, free_grown=start, grown=start)
    return FreeGears(problem.model, problem.addresses.base, zero, problem.judge.knots()), scene


DRIVES = {
    "constant": {"drive.torque": 4.5e-18},
    "ramp": {"drive.torque": 0.0, "drive.schedule": [(0.0, 0.0), (0.8, 1.2e-17)]},
    "cubic": {
        "drive.torque": 0.0,
        "drive.schedule": {"knots": [(0.0, 0.0), (0.3, 9e-18), (0.6, 0.0)], "interpolation": "cubic"},
    },
    "harmonic": {
        "drive.torque": 4.5e-18,
        "drive.harmonic": [{"amplitude": 2e-17, "frequency": 20.0, "phase": 1.0}],
    },
    "held": {"drive.torque": 0.0, "drive.speed": [(0.0, 0.0), (1.0, 5.0)], "drive.speed_gain": 1e-17},
}


def test_a_zero_has_the_fields_of_its_record_in_their_order():
    assert Zero._fields == STATE["standing"]["zero"].base.names


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("start", [0.0, 0.37])
def test_free_gears_are_those_of_scipy(drive, start):
    gears, scene = free_gears(DRIVES[drive], start)
    times = np.linspace(start, 1.0, 2001)[1:]
    wanted = free_way(Plant.of(scene), start, times) / PITCH
    way = gears.until(1.0)
    assert way.travel == pytest.approx(wanted[-1], rel=5e-6)
    assert way.farthest == pytest.approx(np.abs(wanted).max(), rel=1e-5)  # of samples


@pytest.mark.parametrize("drive", ["ramp", "harmonic"])
def test_what_free_gears_have_done_does_not_depend_on_when_they_are_asked(drive):
    """Blocks end by the time on the wall; what is written of a run must not."""
    gears, _ = free_gears(DRIVES[drive])
    bit_by_bit = [gears.until(t) for t in np.linspace(0.0, 1.0, 301).tolist()]
    again, _ = free_gears(DRIVES[drive])
    assert again.until(1.0) == bit_by_bit[-1]
    assert [again.until(t) for t in np.linspace(0.0, 1.0, 301).tolist()] == bit_by_bit


PULSE, FIRST, APART, COUNT = 1e-5, 0.1, 0.2, 3


def pulses(t, speed, p):
    k = math.floor((t - FIRST) / APART)
    return p[0] if 0 <= k < COUNT and t - FIRST - k * APART < PULSE else 0.0


def ends(p, t_end):
    return [FIRST + k * APART + after for k in range(COUNT) for after in (0.0, PULSE)]


@pytest.mark.parametrize("knots", [ends, None])
def test_free_gears_stop_at_the_knots_of_laws(knots):
    """Pulses of a hundred thousandth of the run: each adds its impulse, also where the law says nothing of them."""
    gd.register_torque("short_pulses", parameters=1, knots=knots)(pulses)
    try:
        law = {"drive.law": {"name": "short_pulses", "parameters": [2e-15]}, "drive.torque": 0.0}
        gears, scene = free_gears(law | {"load.torque": 0.0, "load.drag": 0.0})
        plant = Plant.of(scene)
        gain = plant.ratio * 2e-15 * PULSE / plant.inertia / PITCH
        wanted = sum(gain * (1.0 - FIRST - k * APART - 0.5 * PULSE) for k in range(COUNT))
        way = gears.until(1.0)
        assert way.travel == pytest.approx(wanted, rel=1e-6)
        assert way.driven_time == pytest.approx(COUNT * PULSE, rel=1e-6)
        assert way.onset == pytest.approx(FIRST, rel=1e-6)
    finally:
        gd.unregister_torque("short_pulses")


def test_free_gears_settle_as_they_approach_their_rest():
    """A viscous load stops what one pulse has set in motion within a few times I/c = 0.02 s."""
    damped = {"load.torque": 0.0, "load.drag": 0.0, "load.viscous": Plant.of(PAIR).inertia / 0.02}
    pulse = {"drive.torque": 0.0, "drive.schedule": [(0.0, 1e-17), (0.1, 1e-17), (0.1001, 0.0)]}
    gears, _ = free_gears(damped | pulse)
    way = gears.until(1.0)
    assert 0.1 < way.grown < 0.1 + 10.0 * 0.02
    assert way.mark < way.farthest < 1.01 * way.mark
    assert way.driven_time == pytest.approx(0.1001, rel=1e-9)


def test_the_bound_of_their_way_is_one():
    for drive in ("constant", "ramp", "harmonic", "held"):
        gears, _ = free_gears(DRIVES[drive])
        for t in (1e-3, 1e-2, 0.1, 1.0):
            assert gears.bound(t) >= gears.until(t).farthest * (1.0 - 1e-6)
    gears, _ = free_gears({"drive.torque": 1e-19})
    assert gears.bound(1.0) == gears.until(1.0).farthest == 0.0


def test_where_nothing_stands_no_equation_of_free_gears_is_solved(monkeypatch):
    def refuse(*_):
        raise AssertionError("free gears have been followed")

    monkeypatch.setattr(FreeGears, "_solution", refuse)
    running = {"coating.sam_fraction": 1.0, "run.samples": "off", "run.duration": 5e-3}
    ds = gd.simulate(gd.preset("teodorescu2009_low_speed").replace(running))
    assert float(ds.standstills) == 0


def test_a_gear_that_starts_at_once_leaves_nothing_to_solve_behind(monkeypatch):
    """It has stood too short a time to have stood, whatever free gears do: only blocks that end there ask for them."""
    solved, solution = [], FreeGears._solution

    def count(self, *arguments):
        solved.append(arguments)
        return solution(self, *arguments)

    monkeypatch.setattr(FreeGears, "_solution", count)
    starting = {"coating.sam_fraction": 1.0, "run.samples": "off", "initial.gear_speed": 0.0}
    gd.simulate(gd.preset("teodorescu2009_low_speed").replace(starting | {"run.duration": 20e-3}))
    assert len(solved) <= 1
