"""Registered laws that jump, in time, angle and speed: their impulse and work arrive, in motion and at rest.

Whatever the teeth do, ``n I1 w1 + I2 w2`` changes by ``n`` times the impulse of the drive, less that of the load.
"""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.errors import SceneError

I1, I2, RATIO = 1.5263e-20, 6.1052e-20, 4.0
TORQUE = 2e-16
PERIOD, WIDTH, COUNT = 1.37e-3, 1e-4, 4


def pulses(t, speed, p):
    """Four pulses, each of a fourteenth of its period."""
    k = math.floor(t / PERIOD)
    return p[0] if 1 <= k <= COUNT and t - k * PERIOD < WIDTH else 0.0


def pulse_ends(p, t_end):
    return [t for k in range(1, COUNT + 1) for t in (k * PERIOD, k * PERIOD + WIDTH)]


def sectors(t, angle, speed, p):
    return p[0] if math.cos(p[1] * angle) > 0.3 else 0.0


def sector_ends(t, angle, speed, p):
    return math.cos(p[1] * angle) - 0.3


def bang(t, speed, p):
    return p[0] if speed < p[1] else -p[0]


def wanted_speed(t, angle, speed, p):
    return speed - p[1]


def push(t, angle, speed, p):
    return p[0] if speed < p[1] else 0.0


def governor(t, speed, p):
    """A slope, and nothing beyond the speed."""
    return p[0] * max(p[1] - speed, 0.0)


def rubbing_spring(t, angle, speed, p):
    return -p[0] * (angle - p[2] * t) + (p[1] if speed < p[2] else 0.0)


LAWS = {
    "rubbing_spring": (rubbing_spring, 3, {}),
    "push": (push, 2, {}),
    "push_with_switch": (push, 2, {"switch": wanted_speed}),
    "governor": (governor, 2, {}),
    "pulses": (pulses, 1, {}),
    "pulses_with_knots": (pulses, 1, {"knots": pulse_ends}),
    "sectors": (sectors, 2, {}),
    "sectors_with_switch": (sectors, 2, {"switch": sector_ends}),
    "bang": (bang, 2, {}),
    "bang_with_switch": (bang, 2, {"switch": wanted_speed}),
}


@pytest.fixture(autouse=True)
def _registered():
    for name, (function, count, declared) in LAWS.items():
        gd.register_torque(name, parameters=count, **declared)(function)
    yield
    for name in LAWS:
        gd.unregister_torque(name)


def law(name, *parameters):
    return {"name": name, "parameters": parameters}


def schedule(torque):
    """The same pulses by knots; their flanks take a picosecond."""
    rows = [[0.0, 0.0]]
    for begin, end in zip(pulse_ends((), 0.0)[::2], pulse_ends((), 0.0)[1::2], strict=True):
        rows += [[begin, 0.0], [begin + 1e-12, torque], [end, torque], [end + 1e-12, 0.0]]
    return rows


MOTION = gd.preset("teodorescu2009_low_speed").replace(
    {"load.drag": 0.0, "drive.torque": 0.0, "run.duration": 8e-3, "run.samples": 9}
)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("name", ["pulses", "pulses_with_knots"])
@pytest.mark.parametrize("shaft", ["drive", "load"])
def test_pulses_arrive_in_motion(name, backend, shaft):
    """Teeth ring in their adhesion all the time; the gear never comes to rest."""
    torque = TORQUE if shaft == "drive" else 0.2 * TORQUE
    run = solve(MOTION.replace({f"{shaft}.law": law(name, torque)}), backend=backend)
    momentum = RATIO * I1 * run.samples["pinion_speed"] + I2 * run.samples["gear_speed"]
    impulse = (RATIO if shaft == "drive" else -1.0) * torque * COUNT * WIDTH
    assert momentum[-1] - momentum[0] == pytest.approx(impulse, rel=1e-4, abs=0)


@pytest.mark.parametrize("name", ["pulses", "pulses_with_knots"])
def test_pulses_push_gears_at_rest_as_a_schedule_does(name):
    """A dry load holds the gears between the pulses."""
    rest = MOTION.replace(
        {"initial.gear_speed": 0.0, "load.torque": 6e-18, "coating.sam_fraction": 1.0, "initial.gap": 2e-8}
    )
    by_law = solve(rest.replace({"drive.law": law(name, 1e-16)}))
    by_schedule = solve(rest.replace({"drive.schedule": schedule(1e-16)}))
    assert by_schedule.samples["gear_angle"][-1] > 1e-6
    np.testing.assert_allclose(
        by_law.samples["gear_angle"], by_schedule.samples["gear_angle"], rtol=1e-3, atol=1e-9
    )


WAYS = [("native", "auto"), ("native", "bdf"), ("sksundae", "auto")]


def within(turned, order, least):
    """Part of an angle [rad] from 0 in which the cosine of a multiple of it is larger than a number."""
    half = math.acos(least)
    whole, rest = divmod(order * turned, 2.0 * math.pi)
    return (whole * 2.0 * half + min(rest, half) + max(0.0, rest - (2.0 * math.pi - half))) / order


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["sectors", "sectors_with_switch"])
def test_sectors_of_the_angle_keep_their_work(flight, name, way):
    """In flight the energy of the pinion grows by the torque times the angle within the sectors."""
    order, torque = 400.0, 1e-17
    backend, method = way
    changes = {"drive.law": law(name, torque, order), "run.rtol": 1e-7, "run.method": method}
    run = solve(flight.replace(changes), backend=backend)
    angle, speed = run.samples["pinion_angle"], run.samples["pinion_speed"]
    work = np.array([torque * within(x - angle[0], order, 0.3) for x in angle])
    assert order * (angle[-1] - angle[0]) > 10.0
    np.testing.assert_allclose(0.5 * I1 * (speed**2 - speed[0] ** 2), work, rtol=0, atol=2e-4 * work[-1])


def few_sectors(t, angle, speed, p):
    return p[0] if math.cos(p[1] * angle) > 0.64 else 0.0


def few_sector_ends(t, angle, speed, p):
    return math.cos(p[1] * angle) - 0.64


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("rtol", [1e-5, 1e-7])
def test_no_step_passes_over_sectors_as_a_whole(flight, method, rtol):
    """Steps of a flight grow from nothing until one begins and ends within the same sides, with whole turns between."""
    torque, order = 9.43e-18, 577.0
    gd.register_torque("few_sectors", parameters=2, switch=few_sector_ends)(few_sectors)
    try:
        changes = {"drive.law": law("few_sectors", torque, order), "run.method": method, "run.duration": 4e-3}
        run = solve(flight.replace(changes | {"run.rtol": rtol, "initial.gear_speed": 1.5}))
    finally:
        gd.unregister_torque("few_sectors")
    turned = run.samples["pinion_angle"][-1] - run.samples["pinion_angle"][0]
    speed = run.samples["pinion_speed"]
    energy = 0.5 * I1 * (speed[-1] ** 2 - speed[0] ** 2)
    assert energy == pytest.approx(torque * within(turned, order, 0.64), rel=1e-4, abs=0)


def sectors_anywhere(t, angle, speed, p):
    return p[0] if math.cos(p[1] * angle) > p[2] else 0.0


def sectors_at_speed(t, angle, speed, p):
    return p[0] if speed > 2.0 and math.cos(p[1] * angle) > p[2] else 0.0


@pytest.mark.parametrize(
    ("name", "least", "order", "torque", "rtol"),
    [
        ("sectors_anywhere", 0.3, 2000.0, 1e-17, 1e-7),
        ("sectors_anywhere", 0.3, 5000.0, 1e-17, 1e-6),
        ("sectors_anywhere", 0.99, 2000.0, 1e-17, 1e-6),
        ("sectors_at_speed", 0.3, 2000.0, 1e-17, 1e-7),
        ("sectors_at_speed", 0.3, 5000.0, 1e-18, 1e-5),
    ],
)
def test_no_step_passes_over_sectors_of_which_a_law_says_nothing(flight, name, least, order, torque, rtol):
    """Sectors that a look around the shaft shows, and those that only a turning shaft has.

    Up to 18 % of the work was lost in steps that begin and end in sectors of one kind.
    """
    gd.register_torque(name, parameters=3)(globals()[name])
    try:
        changes = {"drive.law": law(name, torque, order, least), "run.rtol": rtol}
        run = solve(flight.replace(changes), backend="native")
    finally:
        gd.unregister_torque(name)
    angle, speed = run.samples["pinion_angle"], run.samples["pinion_speed"]
    energy = 0.5 * I1 * (speed[-1] ** 2 - speed[0] ** 2)
    assert energy == pytest.approx(torque * within(angle[-1] - angle[0], order, least), rel=1e-3, abs=0)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("rtol", [1e-5, 1e-6])
@pytest.mark.parametrize("name", ["bang", "bang_with_switch"])
def test_a_law_that_chatters_is_named(flight, name, rtol, way):
    """A bang-bang controller of the speed without a hysteresis switches for ever once it has reached its speed.

    Steps by which it changes the speed by less than the tolerance stay on one side of the jump at both of their ends:
    200,000 to 3,000,000 of them were no chatter.
    """
    backend, method = way
    changes = {"drive.law": law(name, 1e-17, 6.5), "run.rtol": rtol, "run.method": method}
    run = solve(flight.replace(changes), backend=backend)
    assert run.status == "law_chatter"
    assert run.reached < 0.8e-3
    assert run.statistics.steps < 2_000
    assert "hysteresis" in run.message


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["push", "push_with_switch"])
def test_a_law_that_a_small_force_drives_back_over_its_jump_chatters(name, way):
    """The pinion is at its speed in flight, and closing contacts brake it by far less than the law pushes.

    Many steps lie between two jumps: they grow on the way back and shrink before the jump. `reached` is when the first
    asperities come into reach.
    """
    backend, method = way
    touching = {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "run.duration": 0.1, "run.samples": "off"}
    scene = MOTION.replace(touching | {"drive.law": law(name, 5e-17, 7.0), "run.method": method})
    run = solve(scene, backend=backend)
    assert run.status == "law_chatter"
    assert 0.056 < run.reached < 0.0568
    assert run.statistics.steps < 5_000  # a run that crawls takes millions


def test_a_chattering_law_is_said_with_time_speed_and_what_helps():
    """The speed is that of the last sample, of which there is one in 3 us."""
    touching = {"mesh.backlash": 4e-6, "initial.gap": 2e-6, "run.duration": 0.1, "run.samples": 30_001}
    with pytest.raises(gd.SolverError, match="hysteresis") as raised:
        gd.simulate(MOTION.replace(touching | {"drive.law": law("push", 5e-17, 7.0)}))
    assert raised.value.state["pinion_speed"] == pytest.approx(7.0, rel=1e-5)
    assert "rtol" not in raised.value.advice


@pytest.mark.parametrize("way", WAYS)
def test_a_law_with_a_kink_at_its_speed_does_not_chatter(flight, way):
    """In flight the pinion runs up to the kink, ``w = w0 - d exp(-k t / I)``, within the run to the tolerance."""
    backend, method = way
    slope, wanted = 1e-16, 6.5
    changes = {"drive.law": law("governor", slope, wanted), "run.method": method, "run.rtol": 1e-7}
    run = solve(flight.replace(changes), backend=backend)
    speed, time = run.samples["pinion_speed"], run.time
    expected = wanted - (wanted - speed[0]) * np.exp(-slope / I1 * time)
    np.testing.assert_allclose(speed, expected, rtol=1e-5)
    assert run.status == "finished"


@pytest.mark.parametrize("way", WAYS)
def test_a_law_that_a_vibration_passes_each_time_does_not_chatter(flight, way):
    """80 jumps within 1.6 ms: of each vibration about a speed, the half against a torque p takes 2 p/k of its size."""
    backend, method = way
    stiffness, torque, mean, count = I1 * (2.0 * math.pi * 25e3) ** 2, 5e-18, 6.5, 40
    changes = {
        "drive.law": law("rubbing_spring", stiffness, torque, mean),
        "run.samples": 1_601,
        "run.duration": 1.6e-3,
    }
    run = solve(flight.replace(changes | {"run.method": method, "run.rtol": 1e-7}), backend=backend)
    assert run.status == "finished"
    omega = math.sqrt(stiffness / I1)
    swing = (mean - run.samples["pinion_speed"][0]) / omega - 2.0 * count * torque / stiffness
    # over the last vibration, which has 40 samples
    wanted = 2.0 * omega * swing + omega * torque / stiffness
    assert np.ptp(run.samples["pinion_speed"][-41:]) == pytest.approx(wanted, rel=1e-2)


def test_the_largest_step_bounds_steps(flight):
    free, bound = solve(flight), solve(flight.replace({"run.largest_step": 1e-5}))
    assert bound.statistics.steps >= 800 > free.statistics.steps


@pytest.mark.parametrize("declared", [{"knots": lambda p: ()}, {"switch": lambda t, p: 0.0}, {"knots": 3.0}])
def test_declarations_of_other_arguments_are_refused(declared):
    with pytest.raises(SceneError, match=next(iter(declared))):
        gd.register_torque("another", **declared)


def test_a_law_that_says_nothing_and_jumps_is_named_before_a_run(caplog):
    with caplog.at_level("WARNING"):
        gd.simulate(MOTION.replace({"drive.law": law("pulses", TORQUE), "run.duration": 1.5e-3}))
    assert "pulses jumps at 0.00137 s" in caplog.text
    assert "knots=" in caplog.text


def test_a_law_that_jumps_with_the_angle_is_named_before_a_run(caplog):
    """At ``acos(0.3) / 2000`` first, and twice in each of 2000 parts of a turn."""
    with caplog.at_level("WARNING"):
        gd.simulate(MOTION.replace({"drive.law": law("sectors", TORQUE, 2000.0), "run.duration": 1e-5}))
    assert "drive.law = sectors jumps at an angle of 0.000633052 rad and 3999 more in a turn" in caplog.text
    assert "register it with switch=" in caplog.text
    caplog.clear()
    with caplog.at_level("WARNING"):
        gd.simulate(
            MOTION.replace({"drive.law": law("sectors_with_switch", TORQUE, 400.0), "run.duration": 1e-5})
        )
        gd.simulate(
            MOTION.replace({"drive.law": law("rubbing_spring", 1e-14, 0.0, 6.0), "run.duration": 1e-5})
        )
    assert "angle" not in caplog.text
