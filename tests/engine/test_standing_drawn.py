"""Start-up and braking runs of every kind, drawn and cut at earlier ends, beside a judge that has samples alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from reference.own_pair import OWN_PAIR
from reference.standing import Plant, judge

PITCH = 2.0 * math.pi / 54
PAIR = gd.Scene.from_dict(
    gd.preset("teodorescu2009").to_dict() | OWN_PAIR | {"drive": {"torque": 0.0}, "run": {"duration": 1.0}}
)
HUBS = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}
TORQUE = 4.5e-18
"""About what takes coated gears through the mesh [N m]."""
SAMPLES = 20_000
"""In a second."""


def motor(t, speed, p):
    """Torque that rises, and falls with the speed: a law that the engine does not know."""
    return p[0] * (1.0 - speed / p[1]) * (0.5 - 0.5 * math.cos(2.0 * math.pi * min(t / p[2], 1.0)))


@pytest.fixture(autouse=True)
def drawn_motor():
    gd.register_torque("drawn_motor", parameters=("stall", "free", "rise"))(motor)
    yield
    gd.unregister_torque("drawn_motor")


def ramp(random, end, torque):
    t = np.sort(random.uniform(0.0, end, 3))
    return {
        "drive.schedule": [
            (0.0, 0.0),
            (t[0] + 0.1 * end, torque),
            (t[1] + 0.11 * end, torque),
            (1.2 * end, 0.0),
        ]
    }


def reversal(random, end, torque):
    t = np.sort(random.uniform(0.0, end, 2))
    return {
        "drive.schedule": [(0.0, torque), (t[0], torque), (t[1] + 1e-3, -torque * random.uniform(0.2, 1.2))]
    }


def steps_of_both(random, end, torque):
    t = np.sort(random.uniform(0.0, end, 3))
    drive = [(0.0, 0.2), (t[0], 0.2), (t[0] + 1e-4, 1.0), (t[2] + 2e-4, 1.0), (t[2] + 4e-4, 0.3)]
    load = [(0.0, 0.0), (t[1], 0.0), (t[1] + 1e-4, random.uniform(0.5, 3.0) * 3e-18)]
    return {"drive.schedule": [(time, share * torque) for time, share in drive], "load.schedule": load}


def alternation(random, end, torque):
    return {"drive.schedule": [(end * i / 6, torque * (-1) ** i) for i in range(7)]}


def harmonic_above_the_mean(random, end, torque):
    t = np.sort(random.uniform(0.0, end, 2))
    wave = {
        "amplitude": torque * random.uniform(0.8, 2.0),
        "frequency": float(random.choice([10.0, 20.0, 37.0])),
        "phase": random.uniform(0.0, 6.0),
    }
    knots = [(0.0, torque), (t[0], torque * random.uniform(0.2, 1.0)), (t[1] + 1e-3, torque)]
    return {"drive.schedule": knots, "drive.harmonic": [wave]}


def switched_off(random, end, torque):
    off = random.uniform(0.0, end)
    return {
        "drive.schedule": [(0.0, torque), (off, torque), (off + 1e-3, 0.0)],
        "initial.gear_speed": float(random.choice([0.0, 1.0])),
    }


def held_speed(random, end, torque):
    t = np.sort(random.uniform(0.0, end, 3))
    w = random.uniform(0.3, 3.0)
    knots = [(0.0, 0.0), (t[0] + 0.05, w), (t[1] + 0.06, w), (t[2] + 0.1, 0.0)]
    return {"drive.speed": knots, "drive.speed_gain": 10.0 ** random.uniform(-18.0, -17.0)}


def law(random, end, torque):
    numbers = {"stall": torque, "free": random.uniform(3.0, 20.0), "rise": end * random.uniform(0.2, 0.9)}
    return {"drive.law": {"name": "drawn_motor", **numbers}}


KINDS = (ramp, reversal, steps_of_both, alternation, harmonic_above_the_mean, switched_off, held_speed, law)
FRICTION = ({}, {"contact.friction": 0.2}, HUBS, HUBS | {"contact.friction": 0.05})


def drawn(seed):
    """Scene of a number: its remainders decide on the torque, on what rubs and on the asperities."""
    random = np.random.default_rng(seed)
    end, torque = float(random.choice([0.3, 1.0])), TORQUE * random.uniform(0.3, 3.0)
    changes = {
        "run.duration": end,
        "coating.sam_fraction": float(random.choice([1.0, 0.6, 0.45, 0.2, 0.0])),
        "load.torque": float(random.choice([0.0, 1e-18, 3e-18])),
        "initial.mesh_phase": random.uniform(0.0, 1.0),
    }
    changes |= KINDS[seed % 8](random, end, torque) | FRICTION[seed // 8 % 4]
    if seed % 11 == 10:
        changes["contact.model"] = "population"
    return PAIR.replace(changes)


def law_of(scene):
    """Registered law of a scene, of the time and the pinion's speed; None without one."""
    if scene.drive.law is None:
        return None
    numbers = tuple(scene.drive.law.model_extra[name] for name in ("stall", "free", "rise"))
    return lambda t, speed: motor(t, speed, numbers)


def track_of(scene, samples):
    """Verdict of a run, and its samples of time, angle and speed."""
    ds = gd.simulate(scene.replace({"run.samples": samples}))
    (outcome,) = outcomes(ds)
    return outcome, np.array([ds.time.values, ds.gear_angle.values, ds.gear_speed.values])


def assert_judged_alike(scene):
    """The verdict is that of the judge, and so is the time of sticking.

    An impact may turn the speed round for less than the interval of the judge's samples: up to a time of sticking that
    the judge has not seen, it gets a hundred times as many.
    """
    end = scene.run.duration
    samples = max(int(SAMPLES * end), 2_000) + 1
    outcome, track = track_of(scene, samples)
    moves = outcome.verdict not in ("sticks", "stops", "turns back", "runs back")
    period = max((1.0 / wave.frequency for wave in scene.drive.harmonic), default=0.0)
    plant, close = Plant.of(scene, law_of(scene)), max(3e-3 * end, 6.0 / SAMPLES)
    wanted, since = judge(*track, plant, PITCH, period)
    if outcome.stick_time < since - close:
        behind = outcome.stick_time + end / samples
        _, dense = track_of(scene.replace({"run.duration": behind}), math.ceil(100 * samples * behind / end))
        wanted, since = judge(*np.hstack([dense, track[:, track[0] > behind]]), plant, PITCH, period)
    assert ("moves" if moves else outcome.verdict) == wanted
    if not math.isnan(since):
        assert outcome.stick_time == pytest.approx(since, abs=close)


SEEDS = (0, 1, 3, 8)
"""Runs that take a second or two of computing."""


def cut_short(seed):
    """Scene of a number with an earlier end."""
    scene, share = drawn(seed), np.random.default_rng(seed + 1_000_000).uniform(0.05, 0.98)
    return scene.replace({"run.duration": share * scene.run.duration})


@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_runs_are_judged_as_from_samples_alone(seed):
    assert_judged_alike(drawn(seed))
    assert_judged_alike(cut_short(seed))


@pytest.mark.by_hand
@pytest.mark.parametrize("seed", range(len(KINDS) * len(FRICTION)))
def test_every_kind_of_run_with_every_friction(seed):
    assert_judged_alike(drawn(seed))
    assert_judged_alike(cut_short(seed))


PARTS = (
    *("settled_gear_speed", "settled_spread", "speed_fall", "speed_rise", "late_gear_speed", "late_spread"),
    *("last_min_gear_speed", "standing_time", "start_time"),
)


@pytest.mark.parametrize("seed", [2, 6])
@pytest.mark.parametrize("cuts", [(0.5, 1.0), (0.25, 0.6, 1.0)])
def test_a_chain_has_the_words_and_standstills_of_the_whole_run(seed, cuts):
    """Parts of the chain begin in earlier runs; 2e-2: the motion differs within its tolerance, times what it rings:
    with the rounding of one processor by less than 1e-3, with that of another by 5e-3.
    """
    scene = drawn(seed).replace({"run.samples": "off"})
    whole, run, before = gd.simulate(scene), None, 0.0
    for cut in cuts:
        piece = scene.replace({"run.duration": (cut - before) * scene.run.duration})
        run, before = gd.simulate(piece, start=run), cut
    assert outcomes(run)[0].words.replace(" of the chain", "") == outcomes(whole)[0].words
    assert int(run.standstills) == int(whole.standstills)
    for name in PARTS:
        assert float(run[name]) == pytest.approx(float(whole[name]), rel=2e-2, nan_ok=True), name


LONG_CHAINS = {
    "ramp": {"drive.schedule": [(0.0, 0.0), (1.1, 1.1e-17)], "coating.sam_fraction": 1.0},
    "wave": {
        "drive.torque": 9e-18,
        "drive.schedule": [],
        "drive.harmonic": [{"amplitude": 4e-18, "frequency": 3.0, "phase": 0.0}],
        "coating.sam_fraction": 0.8,
    },
    "steady": {"drive.torque": 1.1e-17, "drive.schedule": [], "coating.sam_fraction": 0.6},
}


@pytest.mark.parametrize("cuts", [(0.1, 1.0), (0.25, 0.5, 0.75, 1.0)])
@pytest.mark.parametrize("drive", LONG_CHAINS)
def test_a_chain_of_eighty_exits_has_the_words_of_the_whole_run(drive, cuts):
    """Four seconds: a gear that turns irregularly as a whole turns irregularly in pieces, too."""
    scene = PAIR.replace({"run.duration": 4.0, "run.samples": "off", **LONG_CHAINS[drive]})
    whole, run, before = gd.simulate(scene), None, 0.0
    for cut in cuts:
        run, before = gd.simulate(scene.replace({"run.duration": (cut - before) * 4.0}), start=run), cut
    assert int(run.mesh_exits) == int(whole.mesh_exits) > 40
    assert outcomes(run)[0].words.replace(" of the chain", "") == outcomes(whole)[0].words
    assert int(run.standstills) == int(whole.standstills)
