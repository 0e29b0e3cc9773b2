"""Loads, losses and sliding of hubs and pin of a microengine, beside gears of one freedom with rigid teeth."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearidae as gd
from gearidae.engine.backend import solve
from gearidae.engine.integrate.start import set_rates
from gearidae.engine.observers.friction_losses import note_friction
from gearidae.engine.setup.build import make_problem

CASE = gd.load_case(Path(__file__).parents[2] / "cases" / "microengine.toml")
G = CASE.geometry
R1, R2 = G.base_radius_pinion, G.base_radius_gear
ARM, FORCE, HUBS, PIN = 1e-5, 1e-5, (3e-6, 6e-6), 1.25e-6
RISE = 2e-3
"""Time in which the frequency rises [s]."""


def engine(coefficient, hertz, springs=(0.0, 0.0), pin_coefficient=None, duration=10e-3, **changes):
    """The engine with hubs and pin, at a frequency that it reaches after `RISE`."""
    law = {"name": "microengine", "radius": ARM, "force": FORCE, "phase": -0.5 * math.pi}
    law |= {"stiffness_x": springs[0], "stiffness_y": springs[1], "frequency": [(0.0, 0.0), (RISE, hertz)]}
    return CASE.replace(
        {
            "gears.hub_friction": coefficient,
            "gears.hub_friction_rise": 0.0,
            "gears.pinion_hub_radius": HUBS[0],
            "gears.gear_hub_radius": HUBS[1],
            "gears.pinion_hub_adhesion": 0.0,
            "gears.gear_hub_adhesion": 0.0,
            "drive.pin_radius": PIN,
            "drive.pin_friction": pin_coefficient,
            "drive.law": law,
            "load.schedule": [],
            "run.duration": duration,
            "run.samples": int(duration * 1e6) + 1,
        }
        | changes
    )


# -- steady motion ---------------------------------------------------------------------------------------------------


def means(ds, turns=3):
    """Time means over the last whole turns of the pinion, and the efficiency there."""
    angle = ds.pinion_angle.values
    last = ds.isel(time=slice(int(np.searchsorted(angle, angle[-1] - 2.0 * math.pi * turns)), None))
    span = last.time.values

    def mean(values):
        return np.trapezoid(values, span) / (span[-1] - span[0])

    work = mean(last.drive_torque * last.pinion_speed)
    loads = [mean(last[name].values) for name in ("gear_hub_load", "pinion_hub_load", "pin_load")]
    return [*loads, mean(last.drive_torque.values), mean(last.load_torque * last.gear_speed) / work]


STEADY = [  # coefficient, Hz, springs, of the pin; uN, uN, uN, pN m, 1
    ((0.0, 600, (0.0, 0.0), None), (0.402965, 10.0041, 10.0, 13.9889, 1.0)),
    ((0.3, 600, (0.0, 0.0), None), (0.408257, 10.0042, 10.0, 26.9264, 0.519525)),
    ((0.3, 1200, (0.0, 0.0), None), (0.701325, 10.0123, 10.0, 37.1076, 0.647601)),
    ((0.3, 600, (0.0, 0.0), 0.0), (0.408257, 10.0042, 10.0, 23.1764, 0.603585)),
    ((0.3, 600, (0.5, 0.5), None), (0.408257, 5.22270, 5.21471, 20.8286, 0.671621)),
]
"""Closed form: F = T / (R2 - mu r2), and the mean over a turn of M - mu r1 N1 - mu_p r_p N_p is F R1."""


@pytest.mark.parametrize(("settings", "closed"), STEADY)
def test_a_steady_turn_has_the_loads_of_the_closed_form(settings, closed):
    """What is left of the swing about the steady motion is below 1e-3."""
    got = means(gd.simulate(engine(*settings)))
    units = (1e-6, 1e-6, 1e-6, 1e-12, 1.0)
    assert got == pytest.approx([unit * value for unit, value in zip(units, closed, strict=True)], rel=1e-3)


class Rigid:
    """Gears of one freedom: no contact, no vibration; the drive flank carries a force that may not turn round."""

    def __init__(self, scene):
        self.scene, self.angle = scene, G.pressure_angle + scene.drive.orientation
        self.line = np.array(
            [math.sin(self.angle), math.cos(self.angle)]
        )  # in the axes of the engine's forces
        self.law = scene.drive.law.model_extra

    def pin(self, t, angle):
        hertz = self.law["frequency"][1][1]
        turns = 0.5 * hertz * t * t / RISE if t < RISE else hertz * (t - 0.5 * RISE)
        psi = self.law["phase"] + 2.0 * math.pi * turns
        x = -FORCE * math.sin(psi) - self.law["stiffness_x"] * ARM * math.cos(angle)
        return np.array([x, FORCE * math.cos(psi) - self.law["stiffness_y"] * ARM * math.sin(angle)])

    def at(self, t, angle, speed):
        """Acceleration of the pinion, loads of hubs and pin, torques of drive and load."""
        gears, drive, pin = self.scene.gears, self.scene.drive, self.pin(t, angle)
        mu = gears.hub_friction
        mu_pin = mu if drive.pin_friction is None else drive.pin_friction
        torque = ARM * (pin[1] * math.cos(angle) - pin[0] * math.sin(angle))
        w = speed * R1 / R2
        load, force = 3e-11 + 2e-14 * w + 8e-18 * w * w, 4e-7
        for _ in range(50):
            loads = np.hypot(*(pin - force * self.line)), abs(force), np.hypot(*pin)
            drag = mu * HUBS[0] * (loads[0] + gears.pinion_hub_adhesion) + mu_pin * PIN * loads[2]
            drag += mu * gears.pinion_dimple_radius * gears.pinion_axial_load
            other = mu * HUBS[1] * (loads[1] + gears.gear_hub_adhesion)
            other += mu * gears.gear_dimple_radius * gears.gear_axial_load
            ratio = R2 / R1
            inertia = gears.gear_inertia + gears.pinion_inertia * ratio**2
            acceleration = ((torque - drag) * ratio - load - other) / inertia
            before, force = force, (gears.gear_inertia * acceleration + load + other) / R2
            if abs(force - before) <= 1e-15 * abs(force):
                break
        return acceleration * ratio, loads, torque, load

    def means(self, duration, turns=3):
        """As `means`."""
        hertz = self.law["frequency"][1][1]
        start = [0.5 * RISE * hertz * 2.0 * math.pi - 1.3, 2.0 * math.pi * hertz]
        answer = solve_ivp(
            lambda t, y: (y[1], self.at(t, *y)[0]),
            (RISE, duration),
            start,
            rtol=1e-8,
            atol=1e-8,
            max_step=5e-6,
            dense_output=True,
        )
        time = np.linspace(duration - turns / hertz, duration, 3001)
        angle, speed = answer.sol(time)
        rows = [self.at(*sample) for sample in zip(time, angle, speed, strict=True)]
        loads, torque, load = (np.array([row[k] for row in rows]) for k in (1, 2, 3))

        def mean(values):
            return np.trapezoid(values, time) / (time[-1] - time[0])

        efficiency = mean(load * speed * R1 / R2) / mean(torque * speed)
        return [mean(loads[:, 1]), mean(loads[:, 0]), mean(loads[:, 2]), mean(torque), efficiency]


@pytest.mark.parametrize(
    "settings",
    [
        {"springs": (0.4, 0.2)},
        {
            "gears.pinion_hub_adhesion": 1e-6,
            "gears.gear_hub_adhesion": 2e-6,
            "gears.pinion_axial_load": 2e-6,
            "gears.gear_axial_load": 3e-6,
            "gears.pinion_dimple_radius": 4e-6,
            "gears.gear_dimple_radius": 2e-5,
            "drive.orientation": 0.7,
            "pin_coefficient": 0.2,
        },
    ],
)
def test_engines_settle_to_the_motion_of_rigid_gears(settings):
    """Springs that differ let the speed change by a fifth in each turn; adhesion and axial loads add their torques."""
    scene = engine(0.3, 600, duration=14e-3, **settings)
    assert means(gd.simulate(scene)) == pytest.approx(Rigid(scene).means(14e-3), rel=1e-3)


# -- losses and sliding ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("coefficient", [0.0, 0.3])
def test_sliding_of_the_joints_is_load_times_way(coefficient):
    """Over a steady turn 2 pi r_p F0 of the pin; of the hubs as their mean loads have it; with a coefficient of 0, too.

    The friction takes the coefficient times as much.
    """
    first, second = (gd.simulate(engine(coefficient, 600, duration=5e-3 + turns / 600)) for turns in (0, 2))
    turned = float(second.pinion_angle[-1] - first.pinion_angle[-1])
    expected = {"pin": PIN * FORCE * turned, "pinion_hub": HUBS[0] * 10.0041e-6 * turned}
    expected["gear_hub"] = HUBS[1] * (0.402965e-6 if coefficient == 0.0 else 0.408257e-6) * turned * R1 / R2
    for name, value in expected.items():
        slid = float(second[f"{name}_sliding"] - first[f"{name}_sliding"])
        rel = 3e-3 if name == "gear_hub" else 1e-3  # the swing dies out
        assert slid == pytest.approx(value, rel=rel, abs=0.0)
        lost = float(second[f"{name}_loss"] - first[f"{name}_loss"])
        assert lost == pytest.approx(coefficient * slid, rel=1e-9, abs=0.0)


def test_rates_of_the_powers_of_joints_are_those_along_the_motion():
    """Central differences, with all that joints may have."""
    scene = engine(
        0.3,
        600,
        (0.4, 0.2),
        **{
            "gears.pinion_hub_adhesion": 1e-6,
            "gears.gear_axial_load": 3e-6,
            "gears.gear_dimple_radius": 2e-5,
            "drive.orientation": 0.7,
            "initial.gear_speed": 900.0,
            "initial.gap": "-1 sigma",
        },
    )
    problem = make_problem(scene)
    m, y, time, h = problem.model, problem.start, 1.0, 1e-4
    rates, ends = np.zeros_like(y), []
    set_rates(m, time, y, rates)
    for step in (-h, h, 0.0):
        note_friction(m, time + step, y + step * rates)
        ends.append(np.array(m.work.friction.power))
    noted = np.array(m.work.friction.power_rate)
    assert np.count_nonzero(noted) == 6
    assert noted == pytest.approx((ends[1] - ends[0]) / (2.0 * h), rel=1e-4)


def drawn(seed):
    """An engine with drawn joints."""
    rng = np.random.default_rng(seed)

    def choice(*values):
        return values[rng.integers(len(values))]

    law = {"name": "microengine", "radius": ARM, "force": FORCE, "phase": rng.uniform(-2.0, 2.0)}
    law |= {"stiffness_x": choice(0.0, 0.3), "stiffness_y": choice(0.0, 0.3)}
    return CASE.replace(
        {
            "gears.hub_friction": choice(0.0, 0.1, 0.3, 0.6),
            "gears.hub_friction_rise": 0.0,
            "gears.pinion_hub_radius": choice(0.0, 1.0) * rng.uniform(1e-6, 5e-6) + 1e-9,
            "gears.gear_hub_radius": rng.uniform(1e-6, 2e-5),
            "gears.pinion_hub_adhesion": choice(0.0, 1e-7, 1e-6),
            "gears.gear_hub_adhesion": choice(0.0, 1e-6),
            "gears.pinion_axial_load": choice(0.0, 1e-6),
            "gears.gear_axial_load": choice(0.0, 1e-6),
            "gears.pinion_dimple_radius": 5e-6,
            "gears.gear_dimple_radius": 2e-5,
            "drive.pin_radius": rng.uniform(0.5e-6, 2e-6),
            "drive.pin_friction": choice(None, 0.0, 0.2),
            "drive.orientation": rng.uniform(-3.0, 3.0),
            "drive.law": law | {"frequency": [(0.0, 0.0), (RISE, rng.uniform(100.0, 1500.0))]},
            "contact.friction": choice(0.0, 0.2),
            "coating.sam_fraction": float(choice(1.0, 0.5, 0.0)),
            "load.schedule": [],
            "run.duration": rng.uniform(0.2e-3, 0.6e-3),
            "run.samples": "off",
            "run.method": choice("auto", "bdf"),
        }
    )


def assert_balances(seed):
    for rtol in (1e-6, 1e-8):
        balance = solve(drawn(seed).replace({"run.rtol": rtol})).balance
        assert abs(balance.residual) < balance.bound(rtol, roller=False)


@pytest.mark.parametrize("seed", [2])
def test_balances_of_drawn_engines_close(seed):
    assert_balances(seed)


@pytest.mark.by_hand
@pytest.mark.parametrize("seed", [seed for seed in range(100) if seed != 2])
def test_balances_of_a_hundred_drawn_engines_close(seed):
    assert_balances(seed)


# -- rest ------------------------------------------------------------------------------------------------------------


def test_a_pinion_rests_to_the_last_bit_under_a_force_within_the_set():
    """The force goes round; its torque stays below what hub and pin hold with the loads that it makes."""
    mu = 2.0

    @gd.register_torque("going_round", parameters=("force", "arm"), force=True)
    def law(t, speed, p):
        x, y = p[0] * math.cos(5e4 * t), p[0] * math.sin(5e4 * t)
        return p[1] * y, x, y

    try:
        scene = CASE.replace(
            {
                "drive.law": {"name": "going_round", "force": FORCE, "arm": 0.9 * mu * (HUBS[0] + PIN)},
                "drive.pin_radius": PIN,
                "gears.hub_friction": mu,
                "gears.pinion_hub_radius": HUBS[0],
                "load.schedule": [],
                "run.duration": 1e-3,
                "run.samples": 101,
            }
        )
        ds = gd.simulate(scene)
        moved = gd.simulate(scene.replace({"drive.law.arm": 1.1 * mu * (HUBS[0] + PIN)}))
    finally:
        gd.unregister_torque("going_round")
    assert np.all(ds.pinion_speed == 0.0)
    assert np.all(ds.transmission_error == ds.transmission_error[0])
    # teeth do not touch: the joints hold the drive, and the mean law's tail at six roughnesses is left
    assert ds.largest_mesh_force == ds.smallest_mesh_force
    assert ds.largest_mesh_force < 1e-12
    assert np.any(moved.pinion_speed != 0.0)


@pytest.mark.parametrize(("coefficient", "rough"), [(0.0, 4.0e-10), (0.3, 3.49e-10)])
def test_static_limit_of_an_engine(coefficient, rough):
    """Load at the gear up to which the engine starts it, where its force has the largest arm.

    It is ``(R2/R1) F0 (r - mu (r1 + r_p))`` without the tooth load, which relieves the pinion's hub and loads that of
    the gear.
    """
    pin, line, force = (
        np.array([0.0, FORCE]),
        np.array([math.sin(G.pressure_angle), math.cos(G.pressure_angle)]),
        0.0,
    )
    for _ in range(30):
        hub = HUBS[0] * np.hypot(*(pin - force * line))
        force = (ARM * FORCE - coefficient * (hub + PIN * FORCE)) / R1
    limit = force * (R2 - coefficient * HUBS[1])
    assert limit == pytest.approx(rough, rel=2e-2, abs=0.0)
    turned = []
    for share in (0.995, 1.005):
        scene = engine(coefficient, 50, duration=4e-3)
        scene = scene.replace({"load": {"torque": share * limit}, "drive.law.frequency": 100.0})
        turned.append(float(gd.simulate(scene).gear_angle[-1]))
    assert turned[0] > 0.01 > 1e-3 > turned[1]


def test_what_holds_an_engine_at_rest_names_its_joints():
    """Below the torque that joints hold without a load of the teeth."""
    scene = engine(
        0.3, 600, duration=1e-3, **{"gears.gear_axial_load": 1e-3, "gears.gear_dimple_radius": 1e-4}
    )
    summary = gd.simulate(scene).gearidae.account
    assert summary.held_by == "dry resistance and hub friction and pin friction and axial load"


@pytest.mark.parametrize(("backend", "method"), [("native", "bdf"), ("sksundae", "auto")])
def test_drivers_and_methods_agree(backend, method):
    """Of losses and sliding of an engine that starts, at 1e-8."""
    scene = engine(0.3, 600, duration=0.5e-3, **{"run.rtol": 1e-8, "run.samples": "off"})
    reference = solve(scene).balance
    other = solve(scene.replace({"run.method": method}), backend=backend).balance
    for name in ("pinion_hub_loss", "gear_hub_loss", "pin_loss", "pin_sliding", "pinion_hub_sliding"):
        assert other[name] == pytest.approx(reference[name], rel=1e-5, abs=0.0)
