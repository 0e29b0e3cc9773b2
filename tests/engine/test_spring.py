"""A spring with play on either shaft, against closed forms: free flight, contact, and flight again."""

import math

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.analysis.verdict import outcomes
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.laws.law import DRIVE, LOAD
from gearidae.laws.shaft.spring import SPRING
from gearidae.records import EventKind
from gearidae.records.energy import GEAR_BOUND
from gearidae.runs.estimates import balanced_speed
from reference.own_pair import OWN_PAIR

DRIVERS = ("native", "sksundae")
SPEEDS = {"pinion": 6.0, "gear": 1.5}
INERTIAS = {"pinion": 1.5263e-20, "gear": 6.1052e-20}
KINDS = {
    "pinion": (EventKind.PINION_SPRING_CONTACT, EventKind.PINION_SPRING_RELEASE),
    "gear": (EventKind.GEAR_SPRING_CONTACT, EventKind.GEAR_SPRING_RELEASE),
}
HIT, OMEGA, RATIO = 2e-4, 1e3, 0.2
TIED = gd.Scene.from_dict(
    OWN_PAIR
    | {
        "surface": {
            "youngs_modulus": 161e9,
            "poisson_ratio": 0.23,
            "energy": 1.5,
            "asperity_density": 169e12,
            "asperity_radius": 450e-9,
            "roughness": 6e-9,
        },
        "coating": {"sam_fraction": 1.0, "energy": 0.1},
        "drive": {"torque": 1.2e-17},
        "run": {"duration": 10.0, "samples": 3, "rtol": 1e-6},
    }
)


def spring(shaft, play=None):
    """Keys of a spring that is hit at `HIT`, with this frequency and damping ratio."""
    inertia = INERTIAS[shaft]
    return {
        f"gears.{shaft}_spring": inertia * OMEGA**2,
        f"gears.{shaft}_spring_damping": 2.0 * RATIO * inertia * OMEGA,
        f"gears.{shaft}_spring_play": SPEEDS[shaft] * HIT if play is None else play,
    }


def closed_form(shaft, time):
    """Angle, speed, torque of the spring and energy that its damper has taken, of a shaft that flies into it."""
    speed, inertia = SPEEDS[shaft], INERTIAS[shaft]
    play, fade, ringing = speed * HIT, RATIO * OMEGA, OMEGA * math.sqrt(1.0 - RATIO**2)
    release = HIT + math.pi / ringing
    s = np.clip(time, HIT, release) - HIT
    decay = np.exp(-fade * s)
    deflection = speed / ringing * decay * np.sin(ringing * s)
    w = speed * decay * (np.cos(ringing * s) - fade / ringing * np.sin(ringing * s))
    w_left = -speed * math.exp(-fade * (release - HIT))
    touches, left = (time > HIT) & (time < release), time >= release
    angle = np.where(
        time < HIT, speed * time, np.where(left, play + w_left * (time - release), play + deflection)
    )
    w = np.where(time < HIT, speed, np.where(left, w_left, w))
    torque = np.where(touches, -inertia * (OMEGA**2 * deflection + 2.0 * fade * w), 0.0)
    energy = 0.5 * inertia * (w**2 + np.where(touches, OMEGA * deflection, 0.0) ** 2)
    return angle, w, torque, 0.5 * inertia * speed**2 - energy, release


@pytest.mark.parametrize("backend", DRIVERS)
@pytest.mark.parametrize("shaft", ["gear", "pinion"])
def test_a_shaft_flies_into_its_spring_and_out_again(flight, shaft, backend):
    scene = flight.replace({**spring(shaft), "run.duration": 4e-3, "run.rtol": 1e-12, "run.samples": 81})
    run = solve(scene, backend=backend)
    angle, speed, torque, lost, release = closed_form(shaft, run.time)
    # twenty tolerances of a step, over some hundred steps and two restarts
    for name, values in (
        (f"{shaft}_angle", angle),
        (f"{shaft}_speed", speed),
        (f"{shaft}_spring_torque", torque),
    ):
        # the event at the sample of the hit itself may lie to either side of it
        there = np.abs(run.time - HIT) > 1e-9
        np.testing.assert_allclose(
            run.samples[name][there], values[there], rtol=0, atol=2e-11 * np.abs(values).max(), err_msg=name
        )
    assert run.balance.spring_loss == pytest.approx(lost[-1], rel=1.5e-11, abs=0)
    assert_balanced(run.balance, scene)
    touched, let_go = (run.events.time[run.events.kind == kind] for kind in KINDS[shaft])
    np.testing.assert_allclose(touched, [HIT], rtol=2e-11)
    np.testing.assert_allclose(let_go, [release], rtol=2e-11)


@pytest.mark.parametrize("backend", DRIVERS)
def test_without_play_a_spring_rings_from_the_start_and_has_no_events(flight, backend):
    scene = flight.replace({**spring("gear", 0.0), "run.duration": 4e-3, "run.rtol": 1e-10})
    run = solve(scene, backend=backend)
    fade, ringing = RATIO * OMEGA, OMEGA * math.sqrt(1.0 - RATIO**2)
    angle = SPEEDS["gear"] / ringing * np.exp(-fade * run.time) * np.sin(ringing * run.time)
    # a hundred tolerances
    np.testing.assert_allclose(run.samples["gear_angle"], angle, rtol=0, atol=1e-8 * angle.max())
    assert not set(KINDS["gear"]) & set(run.events.kind)
    assert_balanced(run.balance, scene)


def test_energy_of_a_spring_stays_what_it_is_without_a_damper(flight):
    keys = spring("gear") | {"gears.gear_spring_damping": 0.0}
    run = solve(flight.replace({**keys, "run.duration": 2e-3, "run.rtol": 1e-10}))
    assert run.balance.spring_loss == 0.0
    moving = 0.5 * INERTIAS["gear"] * (run.samples["gear_speed"][-1] ** 2 - SPEEDS["gear"] ** 2)
    assert run.balance.shaft_change == pytest.approx(-moving, rel=1e-8, abs=0)
    assert run.balance.shaft_change > 0.1 * abs(moving)


def test_a_step_under_way_has_no_corner_and_free_gears_have_no_memory(flight):
    """Within a step the force goes on beyond the play; asked of other shafts, it follows the angle alone."""
    m = make_problem(flight.replace(spring("gear", 0.1))).model
    assert SPRING.force(m, LOAD, 0.0, 0.2, 0.0, 0.0) == 0.0
    m.work.elsewhere = 1
    force = SPRING.force(m, LOAD, 0.0, 0.2, 0.0, 0.0)
    assert force == pytest.approx(-0.1 * float(m.scene.torque[LOAD].spring), rel=1e-12, abs=0)
    assert SPRING.force(m, LOAD, 0.0, -0.2, 0.0, 0.0) == -force
    assert SPRING.force(m, DRIVE, 0.0, 0.2, 0.0, 0.0) == 0.0
    step = 1e-6
    change = SPRING.force(m, LOAD, 0.0, 0.2 + step, 0.0, 0.0) - force
    assert SPRING.by_angle(m, LOAD, 0.2, 0.0, 0.0) == pytest.approx(change / step, rel=1e-6)


@pytest.mark.parametrize("key", ["gears.gear_spring", "gears.pinion_spring_play"])
def test_negative_numbers_are_refused(flight, key):
    with pytest.raises(gd.SceneError, match=key.rpartition(".")[2]):
        flight.replace({key: -1.0})


def test_units_are_read(flight):
    scene = flight.replace({"gears.gear_spring": "2 pN m/rad", "gears.gear_spring_play": "1 deg"})
    assert scene.gears.gear_spring == pytest.approx(2e-12, rel=1e-15, abs=0)
    assert scene.gears.gear_spring_play == pytest.approx(math.radians(1.0), rel=1e-15)


@pytest.mark.parametrize(
    "tie",
    [
        {"gears.gear_spring": 2e-17, "gears.gear_spring_damping": 1e-18},
        {"gears.gear_spring": 2e-17, "gears.gear_spring_damping": 1e-18, "gears.gear_spring_play": 1.0},
        {"gears.pinion_spring": 2e-18, "gears.pinion_spring_damping": 5e-20, "gears.pinion_spring_play": 0.5},
    ],
)
@pytest.mark.parametrize("load", [0.0, 3e-18])
def test_a_coated_pair_that_a_spring_holds_stops(tie, load):
    """The drive goes on to exceed the load, but free gears hang in the same spring."""
    scene = TIED.replace(tie | {"load.torque": load})
    ds = gd.simulate(scene)
    (outcome,) = outcomes(ds)
    assert outcome.verdict == "stops"
    assert not outcome.holding.by_adhesion
    assert balanced_speed(scene, scene.drive.torque) == 0.0
    balance = ds.gearidae.energy_balance
    assert abs(balance["residual"]) < GEAR_BOUND * scene.run.rtol * balance["drive_work"]
    if load == 0.0:
        assert outcome.held_by == "a shaft's tie to the ground"
        shaft = "gear" if "gears.gear_spring" in tie else "pinion"
        ratio = 3.0 if shaft == "gear" else 1.0
        rest = tie.get(f"gears.{shaft}_spring_play", 0.0) + ratio * 1.2e-17 / tie[f"gears.{shaft}_spring"]
        assert float(ds[f"{shaft}_angle"][-1]) == pytest.approx(rest, rel=1e-2)
        assert float(ds[f"{shaft}_spring_torque"][-1]) == pytest.approx(-ratio * 1.2e-17, rel=1e-2, abs=0)


def test_without_its_spring_the_coated_pair_turns():
    (outcome,) = outcomes(gd.simulate(TIED))
    assert outcome.verdict == "turns smoothly"
    assert 0.0 < balanced_speed(TIED, TIED.drive.torque) < math.inf
