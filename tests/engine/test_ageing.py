"""Friction of hubs and pin that ages at rest and is rejuvenated by sliding: rate and state."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import gearidae as gd
from gearidae.archive import unfinished
from gearidae.engine.backend import solve
from gearidae.engine.events.sliding import rest_reserve
from gearidae.engine.friction.ageing import begin_ageing
from gearidae.engine.integrate.start import set_rates
from gearidae.engine.motion.pair_forces import forces_at
from gearidae.engine.observers.friction_losses import note_friction
from gearidae.engine.setup.build import make_problem
from gearidae.laws.joint_law import later_age
from gearidae.scene.joints import joints

CASE = gd.load_case(Path(__file__).parents[2] / "cases" / "microengine.toml")
G = CASE.geometry
R1, R2 = G.base_radius_pinion, G.base_radius_gear
FORCE, ARM, PIN, HUBS = 1e-5, 1e-5, 1.25e-6, (3e-6, 6e-6)
TAU, MEMORY = 1e-3, 50e-9
"""Of the case: ageing time [s], memory length [m]."""


# -- the age of contacts ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lengths", [0.0, 1e-6, 0.3, 0.51, 7.0, 31.9, 33.0, 900.0])
@pytest.mark.parametrize("age", [0.0, 0.2, 40.0])
def test_at_constant_speed_a_step_of_any_length_has_the_closed_form(age, lengths):
    """D/v + (age - D/v) exp(-v h/D); Lobatto's rule is good to some 1e-8 of the age in pieces of half a length."""
    memory, h = 0.7, 2.0
    speed = lengths * memory / h
    settled = memory / speed if speed > 0.0 else 0.0
    left = math.exp(-lengths)
    expected = settled + (age - settled) * left if speed > 0.0 else age + h
    assert later_age(age, h, speed * h, speed, speed, 1.0 / memory) == pytest.approx(
        expected, rel=2e-8, abs=1e-13
    )


def test_ages_of_gears_at_rest_are_times():
    assert later_age(3.0, 1e9, 0.0, 0.0, 0.0, 5.0) == 3.0 + 1e9
    assert later_age(3.0, -1.0, 0.0, 0.0, 0.0, 5.0) == 2.0  # a look back
    assert later_age(3.0, 1.0, 2.0, 2.0, 2.0, 0.0) == 3.0  # what does not age


def test_the_age_converges_with_the_fourth_power_of_the_step():
    """Against an integration of theta' = 1 - |v| theta/D of an uneven motion."""

    def way(t):
        return 1.3 * t + 0.4 * math.sin(2.0 * t) + 0.1 * t * t

    def speed(t):
        return 1.3 + 0.8 * math.cos(2.0 * t) + 0.2 * t

    memory, end = 0.25, 3.0
    exact = solve_ivp(
        lambda t, y: 1.0 - speed(t) * y / memory, (0.0, end), [5.0], method="Radau", rtol=1e-12, atol=1e-14
    ).y[0, -1]
    errors = []
    for steps in (8, 16, 32):
        h, age = end / steps, 5.0
        for i in range(steps):
            t = i * h
            age = later_age(age, h, way(t + h) - way(t), speed(t), speed(t + h), 1.0 / memory)
        errors.append(abs(age - exact) / exact)
    assert errors[-1] < 1e-5
    assert all(first / second > 11.0 for first, second in pairwise(errors))


# -- rest ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rise", "rest", "couple"),
    [(0.1, 0.0, 1.600267e-11), (0.1, 1e-3, 1.868592e-11), (0.1, 1.0, 2.024662e-11), (0.7, 1.0, 4.561181e-11)],
)
def test_a_train_starts_at_the_couple_of_its_time_at_rest(rise, rest, couple):
    """F = M/(R2 - mu r2), N1 = |P - F n|: teeth pressed with just less than F, and a couple of the pin at the limit."""
    mu = 0.2 - rise * math.expm1(-rest / TAU)
    force = 3e-11 / (R2 - mu * HUBS[1]) * (1.0 - 1e-9)
    line = np.array([math.sin(G.pressure_angle), math.cos(G.pressure_angle)])
    lever = couple / (ARM * FORCE)
    pin = FORCE * np.array([math.sqrt(1.0 - lever**2), lever])  # on a pinion that has not turned
    loads = np.hypot(*(pin - force * line)), FORCE
    assert force * R1 + mu * (HUBS[0] * loads[0] + PIN * loads[1]) == pytest.approx(couple, rel=1e-6, abs=0.0)
    still = {
        "gears.hub_friction_rise": rise,
        "drive.law.frequency": 0.0,
        "load.schedule": [],
        "contact.bodies": "rigid",
        "initial.rest_time": rest,
    }
    for beside, holds in ((1.0 - 2e-6, True), (1.0 + 2e-6, False)):
        phase = -math.acos(beside * lever)
        problem = make_problem(CASE.replace(still | {"drive.law.phase": phase}))
        m, y = problem.model, problem.start.copy()

        def surplus(u, m=m, y=y):
            y[0] = u
            return forces_at(m, 0.0, y).force * float(m.scene.force_unit) - force

        surplus(brentq(surplus, y[0], y[0] + 6.0, xtol=1e-14, rtol=1e-15))
        y[1] = y[3] = 0.0
        m.state.initial_pinion_lead = y[0]  # the pinion has not turned
        m.state.ageing.way[0] = y[2] / m.scene.phase_rate + y[0]
        assert (rest_reserve(m, 0.0, y) >= 0.0) == holds


RAMP = [({}, 0.46510e-3), ({"gears.hub_friction_rise": 0.0}, 0.41295e-3)]
"""Changes of the case, and the time at which its ramp breaks rigid gears away [s]."""


@pytest.mark.parametrize(("changes", "time"), RAMP)
def test_the_ramp_breaks_rigid_gears_away_at_the_time_of_the_table(changes, time):
    """Statics of a pin at the angle 0 of the pinion: the force goes round, and hubs and pin age while it does."""
    there = {joint.name: joint for joint in joints(CASE.replace(changes))}
    line = np.array([math.sin(G.pressure_angle), math.cos(G.pressure_angle)])

    def surplus(t):
        mu1, mu2, mup = (there[name].aged(1.0 + t) for name in ("pinion hub", "gear hub", "pin"))
        lag = 2.0 * math.pi * 0.5 * 600.0 * t**2 / 2e-3
        pin = FORCE * np.array([math.cos(lag), math.sin(lag)])
        force = 3e-11 / (R2 - mu2 * HUBS[1])
        taken = mu1 * HUBS[0] * np.hypot(*(pin - force * line)) + mup * PIN * FORCE
        return ARM * pin[1] - taken - force * R1

    assert brentq(surplus, 1e-4, 1e-3, xtol=1e-12) == pytest.approx(time, abs=5e-9)


@pytest.mark.parametrize("backend", ["auto", "sksundae"])
@pytest.mark.parametrize(("changes", "time"), RAMP)
def test_the_ramp_of_the_case_breaks_away_later_after_a_rest(changes, time, backend):
    """Of rigid gears; with teeth that give way 1e-2 ms at most beside it."""
    scene = CASE.replace({"run.duration": 0.48e-3, "run.samples": 4801} | changes)
    ds = gd.simulate(scene, backend=backend)
    assert float(ds.time[np.flatnonzero(ds.gear_speed.values > 0.0)[0]]) == pytest.approx(time, abs=1e-5)


# -- steady motion ---------------------------------------------------------------------------------------------------


def means(ds, turns):
    """Time means over the last whole turns of the pinion, and the efficiency there."""
    angle = ds.pinion_angle.values
    last = ds.isel(time=slice(int(np.searchsorted(angle, angle[-1] - 2.0 * math.pi * turns)), None))
    span = last.time.values

    def mean(values):
        return np.trapezoid(values, span) / (span[-1] - span[0])

    ageing = [name for name in ("pinion_hub_friction", "gear_hub_friction", "pin_friction") if name in last]
    efficiency = mean(last.load_torque * last.gear_speed) / mean(last.drive_torque * last.pinion_speed)
    return [*(mean(last[name].values) for name in (*ageing, "gear_hub_load", "drive_torque")), efficiency]


def driven(hertz, duration, samples):
    ramp = [(0.0, 0.0), (2e-3, hertz)]
    return CASE.replace(
        {"drive.law.frequency": ramp, "load.schedule": [], "run.duration": duration, "run.samples": samples}
    )


def steady(hertz, rise=0.1):
    """Coefficients, tooth force, mean torque and efficiency of steady motion, in closed form."""
    scene = CASE.replace({"gears.hub_friction_rise": rise})
    speed, there = 2.0 * math.pi * hertz, {joint.name: joint for joint in joints(scene)}
    gear_speed = 0.25 * speed
    mu1, mup = (
        there[name].of_age(there[name].sliding_age(speed)).coefficient for name in ("pinion hub", "pin")
    )
    mu2 = there["gear hub"].of_age(there["gear hub"].sliding_age(gear_speed)).coefficient
    load = 3e-11 + 2e-14 * gear_speed + 8e-18 * gear_speed**2
    force, angle = load / (R2 - mu2 * HUBS[1]), np.linspace(0.0, 2.0 * math.pi, 1000, endpoint=False)
    hub = np.hypot(FORCE * np.cos(angle) - force, FORCE * np.sin(angle)).mean()
    torque = force * R1 + mu1 * HUBS[0] * hub + mup * PIN * FORCE
    return [mu1, mu2, mup, force, torque, load * R1 / R2 / torque]


@pytest.mark.parametrize(
    ("hertz", "table"),
    [
        (600, (0.200441, 0.200880, 0.2010554, 4.06493e-7, 2.26403e-11, 0.617877)),
        (60, (None, None, None, None, None, 0.475026)),
        (1, (None, None, None, None, None, 0.372713)),
    ],
)
def test_closed_forms_of_steady_motion_are_those_of_the_table(hertz, table):
    for value, expected in zip(steady(hertz), table, strict=True):
        assert expected is None or value == pytest.approx(expected, rel=2e-6, abs=0.0)


@pytest.mark.parametrize(
    ("hertz", "rise", "efficiency"),
    [(600, 0.0, 0.6186), (60, 0.0, 0.482444), (1, 0.0, 0.467080), (1, 0.7, 0.168)],
)
def test_closed_forms_without_ageing_and_with_much_of_it(hertz, rise, efficiency):
    """To half of the last digit given."""
    digits = 10.0 ** -len(str(efficiency).partition(".")[2])
    assert steady(hertz, rise)[-1] == pytest.approx(efficiency, abs=max(0.5 * digits, 1e-6))


WITHOUT_RISE = {
    "gears.hub_friction_rise": 0.0,
    "gears.hub_ageing_time": None,
    "gears.hub_memory_length": None,
    "initial.rest_time": 0.0,
}


@pytest.mark.parametrize("rise", [0.1, 0.0])
@pytest.mark.parametrize(
    ("hertz", "duration", "samples", "turns", "rel"),
    # what is left of the swing about the steady motion
    [(600, 10e-3, 10_001, 3, 1e-4), (60, 30e-3, 20_001, 1, 1e-5), (1, 1.2, 20_001, 1, 1e-3)],
)
def test_an_engine_settles_to_the_closed_form(rise, hertz, duration, samples, turns, rel):
    """At 1 Hz, below D/tau of hubs and pin, it swings by some per cent, and friction by some thousandths."""
    scene = driven(hertz, duration, samples)
    ds = gd.simulate(scene if rise else scene.replace(WITHOUT_RISE))
    got, closed = means(ds, turns), steady(hertz, rise)
    assert got[-3:] == pytest.approx(closed[3:], rel=rel)
    if rise:
        assert got[:3] == pytest.approx(closed[:3], rel=1e-5 if hertz > 1 else 2e-3)


def turning(duration, samples):
    """Scene of the engine in steady motion from the start."""
    return driven(600, duration, samples).replace(
        {
            "drive.law.frequency": 600.0,
            "drive.law.phase": -math.acos(steady(600)[4] / (ARM * FORCE)),
            "initial.gear_speed": 2.0 * math.pi * 150.0,
            "initial.gap": "3 sigma",
            "initial.rest_time": 3e-6,
        }
    )


@pytest.mark.parametrize("backend", ["auto", "sksundae"])
def test_both_drivers_go_on_in_steady_motion(backend):
    """The teeth do not swing for long, so that the portable driver is quick."""
    scene, closed = turning(1.25 / 600, 2501).replace({"mesh.damping": 1e-5}), steady(600)
    got = means(gd.simulate(scene, backend=backend), 1)
    assert got[:3] == pytest.approx(closed[:3], rel=1e-6)
    assert got[3:] == pytest.approx(closed[3:], rel=1e-4)


def test_slow_gears_with_much_ageing_stick_and_slip():
    """At one turn a second with a rise of 0.7 steady sliding, whose efficiency would be 0.168, is not stable."""
    ds = gd.simulate(driven(1, 0.4, 40_001).replace({"gears.hub_friction_rise": 0.7}))
    late = ds.sel(time=slice(0.2, None))
    assert 0.7 < float((late.gear_speed == 0.0).mean()) < 1.0
    assert float(late.gear_speed.max()) > 100.0 * 0.25 * 2.0 * math.pi


# -- the account -----------------------------------------------------------------------------------------------------


def test_rates_of_the_powers_of_joints_that_age_are_those_along_the_motion():
    """Differences of the second order, from where the ages have been noted."""
    scene = driven(600, 1e-3, 2).replace(
        {
            "gears.pinion_hub_adhesion": 1e-6,
            "gears.gear_axial_load": 3e-6,
            "gears.gear_dimple_radius": 2e-5,
            "gears.hub_ageing_time": 1e-7,
            "gears.hub_friction_rise": 0.8,
            "initial.gear_speed": 900.0,
            "initial.gap": "-1 sigma",
            "initial.rest_time": 1e-8,
        }
    )
    problem = make_problem(scene)
    m, y, time, h = problem.model, problem.start, 1.0, 1e-4
    rates, ends = np.zeros_like(y), []
    begin_ageing(m, time, y)
    set_rates(m, time, y, rates)
    for step in (2.0 * h, h, 0.0):
        note_friction(m, time + step, y + step * rates)
        ends.append(np.array(m.work.friction.power))
    noted = np.array(m.work.friction.power_rate)
    assert np.count_nonzero(noted) == 6
    assert noted == pytest.approx((4.0 * ends[1] - ends[0] - 3.0 * ends[2]) / (2.0 * h), rel=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_balances_of_engines_that_age_close(seed):
    rng = np.random.default_rng(seed)
    scene = driven(rng.uniform(100.0, 900.0), 0.5e-3, 2).replace(
        {
            "gears.hub_friction_rise": rng.uniform(0.1, 0.9),
            "gears.hub_ageing_time": 10.0 ** rng.uniform(-6.0, -4.0),
            "gears.hub_memory_length": rng.uniform(20e-9, 100e-9),
            "initial.rest_time": 10.0 ** rng.uniform(-7.0, -3.0),
            "gears.gear_hub_adhesion": 1e-6,
            "initial.gear_speed": 300.0,
            "contact.friction": float(rng.choice([0.0, 0.2])),
            "drive.pin_friction": 0.1,
            "drive.pin_friction_rise": 0.3,
            "drive.pin_memory_length": 30e-9,
            "run.method": str(rng.choice(["auto", "bdf"])),
        }
    )
    for rtol in (1e-6, 1e-8):
        balance = solve(scene.replace({"run.rtol": rtol})).balance
        assert balance["pinion_hub_loss"] > 0.0
        assert abs(balance.residual) < balance.bound(rtol, roller=False)


# -- accuracy, drivers, and what does not age ------------------------------------------------------------------------

SLIPPING = gd.preset("teodorescu2009").replace(
    {
        "contact.bodies": "rigid",
        "drive.harmonic": None,
        "drive.torque": 3e-11,
        "gears.hub_friction": 0.2,
        "gears.hub_friction_rise": 0.4,
        "gears.hub_ageing_time": 2e-6,
        "gears.hub_memory_length": 40e-9,
        "gears.pinion_hub_radius": 8e-6,
        "gears.gear_hub_radius": 2e-5,
        "initial.gap": "1 sigma",
        "initial.gear_speed": 0.0,
        "initial.rest_time": 1e-6,
        "run.duration": 20e-6,
        "run.samples": 10_001,
    }
)
"""Gears that start from rest, age a little while they are pushed, and forget it."""


@pytest.fixture(scope="module")
def fine():
    return solve(SLIPPING.replace({"run.rtol": 1e-11}))


@pytest.mark.parametrize(
    ("backend", "rtol", "error"), [("auto", 1e-5, 1e-4), ("auto", 1e-8, 3e-7), ("sksundae", 1e-8, 1e-5)]
)
def test_coefficients_converge_with_the_tolerance(fine, backend, rtol, error):
    """Both drivers; IDA's own formulas are less accurate at the same tolerance.

    Processors round differently: at 1e-8 the error is below 1e-7 on one and 1.15e-7 on another.
    """
    got = solve(SLIPPING.replace({"run.rtol": rtol}), backend=backend).samples
    for name in ("pinion_hub_friction", "gear_hub_friction"):
        np.testing.assert_allclose(got[name], fine.samples[name], rtol=error, atol=0.0)
    assert np.ptp(fine.samples["gear_hub_friction"]) > 0.1


def test_sampled_coefficients_are_those_of_the_sampled_motion(fine):
    """An integration of its own along the sampled speed; a spline through the samples is good to 1e-5."""
    from scipy.interpolate import CubicSpline

    for shaft, radius in (("pinion", 8e-6), ("gear", 2e-5)):
        speed = CubicSpline(fine.time, fine.samples[f"{shaft}_speed"])
        age = solve_ivp(
            lambda t, y, speed=speed, radius=radius: 1.0 - abs(speed(t)) * radius * y / 40e-9,
            (0.0, 20e-6),
            [1e-6],
            t_eval=fine.time,
            rtol=1e-8,
            atol=1e-16,
            max_step=1e-8,
        ).y[0]
        mu = 0.2 - 0.4 * np.expm1(-age / 2e-6)
        np.testing.assert_allclose(fine.samples[f"{shaft}_hub_friction"], mu, rtol=2e-4)


def test_joints_without_a_rise_run_to_the_last_bit_as_without_the_keys():
    plain = SLIPPING.replace({"gears.hub_friction_rise": 0.0})
    bare = plain.replace(
        {"gears.hub_ageing_time": None, "gears.hub_memory_length": None, "initial.rest_time": 0.0}
    )
    first, second = solve(plain), solve(bare)
    assert first.samples.keys() == second.samples.keys()
    assert "pinion_hub_friction" not in first.samples
    for name, values in first.samples.items():
        np.testing.assert_array_equal(values, second.samples[name])


def test_a_rise_alone_holds_gears_and_lets_them_go():
    """Fresh contacts have no friction; after a rest the hubs hold what they later do not."""
    held = {
        "gears.hub_friction": 0.0,
        "gears.hub_friction_rise": 1.5,
        "gears.hub_ageing_time": 1e-6,
        "gears.gear_hub_adhesion": 2e-5,
        "drive.torque": 0.0,
        "drive.schedule": [(0.0, 0.0), (20e-6, 2e-11)],
        "initial.gap": "6 sigma",
    }
    rested = gd.simulate(SLIPPING.replace(held | {"initial.rest_time": 1.0}))
    fresh = gd.simulate(SLIPPING.replace(held | {"initial.rest_time": 0.0, "gears.hub_ageing_time": 1e3}))
    assert float(rested.gear_hub_friction[0]) == 1.5
    assert float(rested.gear_angle[-1]) < 1e-3 * float(fresh.gear_angle[-1])


# -- chains ----------------------------------------------------------------------------------------------------------

CHAIN = SLIPPING.replace(
    {"drive.torque": 0.0, "drive.schedule": [(0.0, 3e-11), (8e-6, 3e-11), (9e-6, 0.0)], "load.torque": 3e-11}
)
"""Pushed, then left to come to rest."""


def test_a_chain_of_starts_keeps_what_the_joints_remember():
    """Stopped, at rest, started again with another torque: units change, ages go on and grow by the time at rest."""
    scene = CHAIN.replace({"run.duration": 0.2e-3, "load.torque": 6e-11, "run.samples": 2001})
    stopped = gd.simulate(scene)
    assert float(stopped.gear_speed[-1]) == 0.0
    again = {
        "drive.schedule": [],
        "drive.torque": 2e-10,
        "load.torque": 1e-12,
        "run.duration": 5e-6,
        "run.samples": 501,
    }
    second = gd.simulate(scene.replace(again), start=stopped)
    for name in ("pinion_hub_friction", "gear_hub_friction"):
        assert float(second[name][0]) == pytest.approx(float(stopped[name][-1]), rel=1e-12)
    rest = stopped.time.values[stopped.gear_speed.values == 0.0]
    waited = rest[rest > 20e-6]
    mu = stopped.gear_hub_friction.sel(time=waited).values
    grown = 0.6 - (0.6 - mu[0]) * np.exp(-(waited - waited[0]) / 2e-6)
    np.testing.assert_allclose(mu, grown, rtol=1e-9)
    assert float(second.gear_hub_friction[-1]) < float(second.gear_hub_friction[0])


ENGINE = turning(2.0**-14, 65).replace(
    {"initial.rest_time": 1e-3, "drive.pin_friction": 0.1, "drive.pin_friction_rise": 0.3}
)
"""An engine that turns, so that no law is searched for the end of a rest, and forgets on the way."""


@pytest.mark.parametrize("backend", ["auto", "sksundae"])
def test_a_run_in_two_parts_is_that_in_one_to_the_last_bit(backend):
    half = 2.0**-17
    whole = gd.simulate(
        CHAIN.replace({"run.duration": 2 * half, "run.samples": 65, "run.checkpoints": [half]}),
        backend=backend,
    )
    first = gd.simulate(CHAIN.replace({"run.duration": half, "run.samples": 33}), backend=backend)
    second = gd.simulate(
        CHAIN.replace({"run.duration": half, "run.samples": 33}), start=first, backend=backend
    )
    for name in ("pinion_hub_friction", "gear_hub_friction", "gear_speed", "transmission_error"):
        np.testing.assert_array_equal(np.concatenate([first[name], second[name][1:]]), whole[name])
    assert first.gear_hub_friction[-1] != first.gear_hub_friction[0]


@pytest.mark.xfail(strict=True, reason="units follow the times at which a run of a duration looks at its law")
def test_an_engine_in_two_parts_is_that_in_one_to_the_last_bit():
    half = float(ENGINE.run.duration)
    whole = gd.simulate(
        ENGINE.replace({"run.duration": 2 * half, "run.samples": 129, "run.checkpoints": [half]})
    )
    first = gd.simulate(ENGINE)
    second = gd.simulate(ENGINE, start=first)
    for name in ("pinion_hub_friction", "gear_hub_friction", "pin_friction", "pinion_speed"):
        np.testing.assert_array_equal(np.concatenate([first[name], second[name][1:]]), whole[name])
    assert (whole.gear_speed > 0.0).all()
    assert float(first.pin_friction[0]) == pytest.approx(0.1 - 0.3 * math.expm1(-1.0), rel=1e-12)
    assert float(second.pin_friction[0]) < float(first.pin_friction[0]) - 0.01
    assert second.gearidae.energy_balance == whole.gearidae.energy_balance


@pytest.mark.parametrize("backend", ["auto", "sksundae"])
def test_an_interrupted_engine_is_resumed_to_the_last_bit(backend, tmp_path, monkeypatch):
    """From its file, at the newest checkpoint: ages are part of the state."""
    monkeypatch.setattr(unfinished, "CHECKPOINT_SECONDS", 0.0)
    duration = 2.0**-15
    kept = [duration * share for share in (0.25, 0.5, 0.75)]
    scene = ENGINE.replace({"run.duration": duration, "run.checkpoints": kept})
    whole = gd.simulate(scene, backend=backend)

    def interrupt(reached, _):
        if reached >= kept[1]:
            raise KeyboardInterrupt

    target = tmp_path / "engine.nc"
    with pytest.raises(gd.Interrupted) as stopped:
        gd.simulate(scene, backend=backend, archive=target, progress=interrupt)
    assert kept[1] <= float(stopped.value.dataset.time[-1]) < duration
    resumed = gd.simulate(scene, backend=backend, archive=target, resume=True)
    for name in ("pinion_hub_friction", "gear_hub_friction", "pin_friction", "pinion_speed"):
        np.testing.assert_array_equal(resumed[name], whole[name])
    assert (whole.gear_speed > 0.0).all()
    assert np.ptp(whole.pin_friction.values) > 0.01
    assert resumed.attrs["end_state"] == whole.attrs["end_state"]
