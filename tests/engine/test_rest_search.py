"""A gear at rest: the first time at which it begins to move is found, and the rest before costs nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.events.rest_search import rest_until
from gearidae.engine.model.record_types import HELD_GEAR
from gearidae.engine.model.state import LOAD, U
from gearidae.engine.motion.shafts import forces_at_shafts
from gearidae.engine.setup.build import make_problem
from gearidae.laws.shaft.harmonic import common_period
from gearidae.records import EventKind
from reference import train
from reference.own_pair import OWN_PAIR

PRESET = gd.preset("teodorescu2009").to_dict()
PAIR = gd.Scene.from_dict(
    PRESET
    | OWN_PAIR
    | {
        "mesh": OWN_PAIR["mesh"] | {"damping": 2e-8, "radius_force": False},
        "drive": {"torque": 4e-18},
        "initial": OWN_PAIR["initial"] | {"gap": 26e-9},
        "run": {"duration": 1.0, "samples": 41},
    }
)
"""An own pair of gears, whose mesh damping ends the vibration of the pinion on a gear that is held.

One body has no force of a contact whose length changes, which is 7e-5 of the push.
"""
RATIO = 3.0
INERTIA = PAIR.gears.gear_inertia + RATIO**2 * PAIR.gears.pinion_inertia
ADVANCE = 0.006
"""About how far [rad] the gear turns in a slip: four of them within the path of one tooth pair, without the loss by
adhesion of a pair that leaves."""
LARGEST = 5e-12
"""Torque of the drive [N m] at which teeth are still rigid."""
DAMPING = 2e-9
"""Of the mesh, per frequency of the load [N s^2/m]: vibrations die out in a hundredth of a period."""
HUBS = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}


def dipping(frequency, depth, width, periods=4, shaft="load", **changes):
    """Scene whose load dips below its constant push, or whose drive rises above its load, once a period.

    By a share `depth` of the push, for a share `width` of the period.
    """
    drive = min(ADVANCE * INERTIA * frequency**2 / (0.5 * RATIO * depth * width**2), LARGEST)
    swing = depth / (1.0 - math.cos(math.pi * width))
    wave = {"frequency": frequency, "phase": 0.0}
    if shaft == "load":
        push = RATIO * drive
        torques = {"drive.torque": drive, "load.torque": push * (1.0 - depth + swing)}
        wave["amplitude"] = push * swing
    else:
        assert swing < 1.0 + 0.5 * depth  # it does not drive the gear back
        torques = {"drive.torque": drive * (1.0 + depth - swing), "load.torque": RATIO * drive}
        wave |= {"amplitude": drive * swing, "phase": math.pi}
    run = {
        "run.duration": periods / frequency,
        "run.samples": 10 * periods + 1,
        "mesh.damping": DAMPING * frequency,
    }
    return PAIR.replace({**torques, f"{shaft}.harmonic": wave, **run, **changes})


def slip_times(run):
    return run.events.time[run.events.kind == EventKind.SLIP]


def turned(run):
    """Angle since the pinion's landing: from the second tenth of the first period."""
    return run.samples["gear_angle"][-1] - run.samples["gear_angle"][2]


def assert_all_slips(run, scene, frequency, within=1e-6, rel=2e-3):
    """Each due slip comes when it is due, and the gear turns as far.

    At 20 kHz teeth vibrate in a slip, which takes 1e-3 of its work.
    """
    due, angle = train.slips(scene, frequency)
    times = slip_times(run)
    assert len(due) >= 3
    for time in due:
        assert np.abs(times - time).min() < within / frequency
    assert turned(run) == pytest.approx(angle, rel=rel)


# -- dips of the load and pulses of the drive ------------------------------------------------------------------------

DIPS = [
    (50.0, 0.01, 0.06),
    (50.0, 0.9, 0.12),
    (90.5, 0.85, 0.12),
    (100.0, 0.3, 0.1),
    (119.0, 0.055, 0.076),
    (200.0, 0.6, 0.14),
    (267.8, 0.08, 0.062),
    (296.6, 0.62, 0.058),
    (305.1, 0.014, 0.055),
    (361.2, 0.015, 0.097),
    (500.0, 0.1, 0.08),
    (735.3, 0.18, 0.077),
    (1145.1, 0.063, 0.057),
    (2024.1, 0.12, 0.063),
    (2e3, 0.3, 0.1),
    (3363.3, 0.16, 0.097),
    (5e3, 0.05, 0.06),
    (6310.6, 0.39, 0.05),
    (2e4, 0.01, 0.14),
    (2e4, 0.9, 0.1),
]
"""Frequency [Hz], share of the push, share of the period."""


def often(cases, step):
    """Cases of which one in some is tested always, and all before a release."""
    marks = pytest.mark.by_hand
    return [pytest.param(case, marks=() if k % step == 0 else marks) for k, case in enumerate(cases)]


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("dip", often(DIPS, 4))
def test_no_dip_of_the_load_is_missed(dip, method):
    """Against the train as one body, solved from rest to rest by an independent method.

    With ``bdf`` the pinion may vibrate by a tolerance until a slip, which changes its push by 1e-4.
    """
    scene = dipping(*dip, **{"run.method": method})
    run = solve(scene)
    assert_all_slips(run, scene, dip[0], within=1e-6 if method == "auto" else 1e-4)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("method", ["auto", pytest.param("bdf", marks=pytest.mark.by_hand)])
@pytest.mark.parametrize("dip", often([(500.0, 0.05, 0.06), (100.0, 0.3, 0.1), (2e4, 0.01, 0.14)], 3))
def test_no_dip_is_missed_by_the_portable_driver(dip, method):
    scene = dipping(*dip, **{"run.method": method})
    assert_all_slips(solve(scene, backend="sksundae"), scene, dip[0], within=1e-4)


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("frequency", [100.0, 2e3])
def test_no_pulse_of_the_drive_is_missed(frequency, method):
    """The pinion follows the drive on its teeth, so that steps are integrated: they are short enough.

    Its motion changes the push by a 10,000th, which shifts the slips by as much of a period.
    """
    scene = dipping(frequency, 0.04, 0.1, shaft="drive", **{"run.method": method})
    assert_all_slips(solve(scene), scene, frequency, within=5e-4, rel=0.01)


def wave(t, speed, p):
    """A harmonic that the engine does not know as one."""
    return p[0] + p[1] * math.cos(2.0 * math.pi * p[2] * t)


@pytest.fixture
def rest_wave():
    gd.register_torque("rest_wave", parameters=("middle", "amplitude", "frequency"))(wave)
    yield
    gd.unregister_torque("rest_wave")


@pytest.mark.usefixtures("rest_wave")
@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_no_dip_of_a_registered_law_is_missed(backend):
    scene = dipping(200.0, 0.3, 0.1)
    harmonic = scene.load.harmonic[0]
    law = {
        "name": "rest_wave",
        "middle": scene.load.torque,
        "amplitude": harmonic.amplitude,
        "frequency": harmonic.frequency,
    }
    by_law = scene.replace({"load.harmonic": [], "load.torque": 0.0, "load.law": law})
    assert_all_slips(solve(by_law, backend=backend), scene, 200.0, within=1e-4)


KINDS = {
    "flanks": {"contact.friction": 0.1},
    "hubs": HUBS,
    "gear hub": HUBS | {"gears.pinion_hub_radius": 0.0},
    "flanks and hubs": HUBS | {"contact.friction": 0.1},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shaft", ["load", "drive"])
def test_stops_on_the_way_change_nothing(kind, shaft):
    """Knots of a schedule that is zero: the solver stops and restarts at each, so that it cannot pass over a dip."""
    scene = dipping(500.0, 0.6 if shaft == "load" else 0.04, 0.1, shaft=shaft, **KINDS[kind])
    end, parts = scene.run.duration, 251
    knots = [[k * end / parts, 0.0] for k in range(parts)]
    free, stopped = solve(scene), solve(scene.replace({"load.schedule": knots}))
    starts = []
    for run in (free, stopped):
        times = slip_times(run)
        starts.append(times[np.diff(times, prepend=-1.0) > 0.3 / 500.0])
    assert len(starts[0]) >= 3
    np.testing.assert_allclose(starts[0], starts[1], rtol=0, atol=1e-4 / 500.0)
    assert turned(free) == pytest.approx(turned(stopped), rel=0.01)
    assert_balanced(free.balance, scene)


# -- what a rest costs -----------------------------------------------------------------------------------------------

STEPS = 50_000  # of the landing of the pinion and of its vibration, which dies out
LOOKS = 100_000  # half as many as there are periods in the shortest of these rests
LANDED = 0.1
"""Until the pinion has landed [s], whose impact may push the gear on."""


def rests(*seconds):
    """Lengths of a rest [s], of which the shortest is always tested and the longest before a release."""
    return [pytest.param(rest, marks=() if rest == min(seconds) else pytest.mark.by_hand) for rest in seconds]


@pytest.mark.parametrize("seconds", rests(10.0, 1e4))
@pytest.mark.parametrize(
    ("backend", "friction"),
    [("native", {}), ("native", {"contact.friction": 0.1}), ("native", HUBS), ("sksundae", HUBS)],
)
def test_a_long_rest_under_a_load_of_twenty_kilohertz(backend, friction, seconds):
    """The load never falls to the push: no step and hardly a look is needed for 200,000 periods or 200 million."""
    wave = {"amplitude": 4e-18, "frequency": 2e4}
    changes = {"load.torque": 2e-17, "load.harmonic": wave, "run.duration": seconds}
    run = solve(PAIR.replace(changes | friction), backend=backend)
    assert run.status == "finished"
    assert run.statistics.steps < STEPS
    assert run.statistics.guard_evaluations < LOOKS
    assert not run.samples["gear_speed"].any()
    assert (slip_times(run) < LANDED).all()


@pytest.mark.parametrize("seconds", rests(3.0, 1e4))
def test_a_long_rest_in_which_bounds_say_nothing(seconds):
    """Two harmonics whose amplitudes together exceed what the load has above the push, and whose sum never does.

    ``cos x + cos 2 x`` is -9/8 at least: one common period shows it.
    """
    waves = [{"amplitude": 4e-18, "frequency": f} for f in (2e4, 4e4)]
    changes = {"load.torque": 1.8e-17, "load.harmonic": waves, "run.duration": seconds}
    run = solve(PAIR.replace(changes))
    assert run.status == "finished"
    assert run.statistics.steps < STEPS
    assert run.statistics.guard_evaluations < min(LOOKS, 0.5 * 2e4 * seconds)
    assert (slip_times(run) < LANDED).all()


@pytest.mark.parametrize("seconds", rests(10.0, 1e3))
def test_a_ramp_of_the_load_ends_a_long_rest_in_the_right_period(seconds):
    """A load of 20 kHz that falls to the push in 8 s or 800 s: its periods, 160,000 and more, are bisected."""
    push, amplitude, frequency = 3 * 4e-18, 2e-18, 2e4
    # the least of a period passes below the push when the middle is an amplitude above it; the push is known to 1e-4
    slope = 2e-17 / seconds
    due, known = (3e-17 - push - amplitude) / slope, 1e-4 * push / slope
    changes = {
        "load.torque": 0.0,
        "load.schedule": [[0.0, 3e-17], [seconds, 1e-17]],
        "load.harmonic": {"amplitude": amplitude, "frequency": frequency},
        "run.duration": due + known,
        "run.samples": 2,
    }
    run = solve(PAIR.replace(changes))
    times = slip_times(run)
    first = times[times > LANDED][0]
    assert first == pytest.approx(due, abs=known)
    assert (first * frequency) % 1.0 == pytest.approx(0.5, abs=0.02)


# -- the search alone ------------------------------------------------------------------------------------------------


PUSH = 1.2e-17


def resting(harmonics, knots):
    """Model of a gear that is held, and a state in which the pinion pushes by about `PUSH`; that push [N m]."""
    load = [{"amplitude": a, "frequency": f, "phase": p} for a, f, p in harmonics]
    scene = PAIR.replace(
        {"load.torque": 0.0, "load.schedule": knots, "load.harmonic": load, "drive.torque": PUSH / RATIO}
    )
    problem = make_problem(scene)
    m, y = problem.model, problem.start.copy()
    m.state.hold, m.state.slip, m.state.segment[LOAD] = HELD_GEAR, 0.0, 1
    unit = float(m.scene.force_unit * m.scene.gear_radius)

    def push(u):
        y[U] = u
        return forces_at_shafts(m, 0.0, y)[2] * unit - PUSH

    y[U] = brentq(push, y[U] - 10.0, y[U] + 4.0)
    return m, y, PUSH + push(y[U])


waves = st.lists(
    st.tuples(
        st.floats(1e-19, 2e-17), st.sampled_from([3.0, 10.0, 16.0, 23.5, 31.4159]), st.floats(0.0, 6.28)
    ),
    min_size=1,
    max_size=3,
)


@settings(max_examples=40)
@given(waves, st.floats(1e-17, 6e-17), st.floats(0.5e-17, 6e-17))
def test_the_first_dip_is_that_of_a_dense_scan(harmonics, first, last):
    """In a second of rest under a ramp with harmonics, with a common period and without one."""
    knots = [[0.0, first], [1.0, last]]
    m, y, push = resting(harmonics, knots)
    tau, now, moves = float(m.scene.time_unit), 0.0, False
    while not moves and now < m.scene.end:
        now, moves = rest_until(m, now, y, float(m.scene.end))
    grid = np.linspace(0.0, 1.0, 400_001)
    load = np.interp(grid, *zip(*knots, strict=True))
    for a, f, p in harmonics:
        load += a * np.cos(2.0 * np.pi * f * grid + p)
    # a slip needs 1e-12 of the reference load more; dips between two places of the grid are that shallow, too
    below = np.flatnonzero(load < push - 1e-10 * push)
    at_least = np.flatnonzero(load < push + 1e-6 * push)
    if below.size:
        assert moves
        assert now * tau <= grid[below[0]] + 1e-12
    if moves:
        assert now * tau >= grid[at_least[0]] - 2.5e-6
    elif now >= m.scene.end:
        assert not below.size


def drawn_along(method, rtol, hubs):
    """A gear that is held and a pinion that a rising torque draws along on its teeth, against their friction."""
    knots = [(0.0, 1e-13), (1e-4, 1e-13), (1.1e-3, 4e-13)]
    changes = {
        "contact.bodies": "rigid",
        "contact.friction": 0.3,
        "coating.sam_fraction": 0.0,
        "load.torque": 3e-11,
        "drive.torque": 0.0,
        "drive.schedule": knots,
        "drive.harmonic": None,
        "initial.gear_speed": 0.0,
        "initial.gap": 2e-8,
        "mesh.damping": 1e-7,
        "run.duration": knots[-1][0],
        "run.samples": 5001,
        "run.method": method,
        "run.rtol": rtol,
    }
    run = solve(gd.preset("teodorescu2009").replace(changes | hubs))
    assert run.status == "finished"
    return run


@pytest.mark.parametrize(("method", "rtol"), [("auto", 1e-6), ("auto", 1e-9), ("bdf", 8e-6), ("bdf", 1e-8)])
@pytest.mark.parametrize("hubs", [{}, HUBS], ids=["flanks", "hubs"])
def test_what_a_rising_torque_draws_along_does_not_stick_again(method, rtol, hubs):
    """On teeth as a damped spring its speed is ``v (1 - exp(-d t) cos(w t))`` at most, which is never zero again."""
    run = drawn_along(method, rtol, hubs)
    # as many as the landing of the pinion brings; a thousand if every first step of a slip ends in a rest
    assert 0 < np.count_nonzero(run.events.kind == EventKind.FLANK_STICK) < 100
    slips = run.events.time[run.events.kind == EventKind.FLANK_SLIP]
    assert (run.samples["pinion_speed"][run.time > slips[-1]] > 0.0).all()


@pytest.mark.parametrize(("method", "rtol"), [("auto", 1.25e-7), ("bdf", 1e-6)])
def test_rests_within_the_tolerance_move_nothing(method, rtol):
    """Where the least speed of a vibration is less than its error, each period ends in a rest of no length."""
    fine, coarse = drawn_along("auto", 1e-9, {}), drawn_along(method, rtol, {})
    for name in ("pinion_angle", "pinion_speed"):
        last = [np.mean(run.samples[name][run.time > 2e-4]) for run in (fine, coarse)]
        assert last[1] == pytest.approx(last[0], rel=0.01, abs=0), name


@pytest.mark.parametrize(
    ("frequencies", "period"),
    [((50.0,), 0.02), ((50.0, 75.0), 0.04), ((2e4, 50.0), 0.02), ((2.5, 0.0), 0.4), ((), 0.0)],
)
def test_common_periods(frequencies, period):
    assert common_period(frequencies) == pytest.approx(period, rel=1e-14, abs=0)


def test_frequencies_without_a_common_period():
    assert common_period((1.0, math.sqrt(2.0))) == 0.0
