"""Where gears stand: the pair of a start-up of seconds, and drawn runs beside a judge that has samples alone."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.mesh import friction
from reference.own_pair import OWN_PAIR
from reference.standing import Plant, free_way, judge

SURFACE = {
    "youngs_modulus": 161e9,
    "poisson_ratio": 0.23,
    "energy": 1.5,
    "asperity_density": 169e12,
    "asperity_radius": 450e-9,
    "roughness": 6e-9,
}
RAMP = [(0.0, 0.0), (5.0, 1.2e-17), (7.0, 1.2e-17), (9.0, 0.0)]
PAIR = gd.Scene.from_dict(
    OWN_PAIR
    | {
        "surface": SURFACE,
        "coating": {"sam_fraction": 0.5, "energy": 0.1},
        "drive": {"schedule": RAMP},
        "run": {"duration": 10.0, "samples": "off", "rtol": 1e-6},
    }
)


def held_by_hubs(coefficient, radii, dry, top, ramp):
    """Changes of a scene: friction of hubs and a dry load hold gears under a torque that rises to `top` [N m]."""
    return {
        "gears.hub_friction": coefficient,
        "gears.pinion_hub_radius": radii[0],
        "gears.gear_hub_radius": radii[1],
        "load.torque": dry,
        "coating.sam_fraction": 1.0,
        "run.duration": ramp,
        "run.samples": "off",
        "drive.schedule": [(0.0, 0.0), (ramp, top)],
    }


def ended(duration, **changes):
    return gd.simulate(PAIR.replace({"run.duration": duration} | changes))


def last_slip(ds, before):
    """Time of the gear's last slip before another [s]."""
    slips = ds.gearidae.events().query("kind == 'slip' and time < @before")
    return slips.time.iloc[-1]


@pytest.mark.parametrize("duration", [1.6, 2.2, 2.4, 7.0])
def test_a_gear_that_stands_sticks_whenever_the_run_ends(duration):
    """Free gears move on; the gear has stood since 1.5175 s."""
    (outcome,) = outcomes(ended(duration))
    assert outcome.verdict == "sticks"
    assert outcome.stick_time == pytest.approx(1.5175, abs=5e-4)
    assert outcome.words.startswith("sticks at 1.52 s (6 mesh exits): free gears would have turned on by ")


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_the_tolerance_has_no_part_in_where_it_stands(rtol):
    ds = ended(2.0, **{"run.rtol": rtol})
    assert float(ds.stick_time) == pytest.approx(1.5175, abs=5e-4)
    assert float(ds.free_advance) == pytest.approx(4.187, rel=1e-3)


def test_a_run_up_that_begins_to_move_and_sticks_has_two_standstills():
    """The drive exceeds the dry load from 5 s / 12 on; its teeth ring, and let it slip a little before."""
    ds = ended(2.4)
    table = ds.gearidae.standstills()
    assert table.verdict.tolist() == ["stops", "sticks"]
    assert table.end[0] == pytest.approx(5.0 / 12.0, rel=1e-2)
    assert table.end[0] == last_slip(ds, 0.5)
    assert math.isnan(table.end[1])
    assert table.held_torque[1] == pytest.approx(3.0 * 2.4e-18 * 2.4 - 3e-18, rel=1e-6, abs=0)


def test_what_belongs_to_the_standstills_adds_up():
    ds = ended(2.4)
    assert int(ds.standstills) == 2
    end = last_slip(ds, 0.5)
    assert float(ds.standing_time) == pytest.approx(end + 2.4 - float(ds.stick_time))
    assert float(ds.start_time) == pytest.approx(end, rel=1e-6)
    assert float(ds.breakaway_torque) == pytest.approx(2.4e-18 * end, rel=1e-6, abs=0)


def test_a_chain_has_the_standstill_of_a_single_run():
    whole = ended(2.0)
    rest = gd.simulate(PAIR.replace({"run.duration": 0.3}), start=ended(1.7))
    assert outcomes(rest)[0].words == outcomes(whole)[0].words
    assert float(rest.free_advance) == pytest.approx(float(whole.free_advance), rel=1e-3)
    assert float(rest.standing_time) == pytest.approx(float(whole.standing_time), rel=1e-4)


def test_a_run_ends_where_it_sticks_and_nothing_drives_harder_any_more():
    """The torque rises until 5 s: what was held before does not tell whether the rest is held."""
    ds = ended(8.0, **{"run.stop": "sticks"})
    assert float(ds.attrs["t_end"]) == pytest.approx(5.0, rel=1e-6)
    assert outcomes(ds)[0].verdict == "sticks"


def test_a_start_from_rest_is_not_ended_by_its_first_knock():
    ds = ended(1.2, **{"run.stop": "sticks"})
    assert ds.attrs["t_end"] == 1.2
    assert outcomes(ds)[0].verdict == "runs"


def test_the_same_torque_as_a_constant_and_as_a_schedule_sticks_alike():
    low = gd.preset("teodorescu2009_low_speed").replace({"run.samples": "off", "coating.sam_fraction": 0.4})
    ramp = {"drive.torque": 0.0, "drive.schedule": [(0.0, 4.4e-18), (0.01, 4.5e-18)]}
    assert (
        outcomes(gd.simulate(low))[0].verdict
        == outcomes(gd.simulate(low.replace(ramp)))[0].verdict
        == "sticks"
    )


def test_an_undriven_gear_that_its_dry_load_stops_has_not_stuck():
    off = {"drive.schedule": [], "initial.gear_speed": 1.0, "coating.sam_fraction": 1.0}
    (outcome,) = outcomes(ended(0.5, **off))
    assert outcome.verdict == "stops"
    assert outcome.free_advance == 0.0


def test_a_gear_that_is_driven_back_turns_back():
    drive = {"drive.schedule": [(0.0, 3e-18), (0.3, 3e-18), (0.4, -4e-18)], "coating.sam_fraction": 1.0}
    (outcome,) = outcomes(ended(2.0, **drive))
    assert outcome.verdict == "turns back"
    assert outcome.words.endswith("pitches, as driven")


@pytest.mark.parametrize("seed", range(8))
def test_drawn_runs_are_judged_as_from_samples_alone(seed):
    """A judge with its own free gears, which sees samples only, and no zero between two of them."""
    random = np.random.default_rng(seed)
    duration, torque = 1.0, 4.5e-18 * float(random.uniform(0.3, 3.0))
    times = np.sort(random.uniform(0.0, duration, 4))
    values = torque * random.uniform(-0.5, 1.5, 4)
    changes = {
        "run.samples": 20_001,
        "coating.sam_fraction": float(random.choice([1.0, 0.6, 0.45, 0.2])),
        "drive.schedule": [(float(t), float(v)) for t, v in zip(times, values, strict=True)],
        "load.torque": float(random.choice([0.0, 1e-18, 3e-18])),
    }
    if seed % 2:
        changes["drive.harmonic"] = [{"amplitude": torque, "frequency": 20.0, "phase": 1.0}]
    scene = PAIR.replace(changes | {"run.duration": duration})
    ds = gd.simulate(scene)
    (outcome,) = outcomes(ds)
    moves = outcome.verdict not in ("sticks", "stops", "turns back", "runs back")
    wanted, _ = judge(
        ds.time.values,
        ds.gear_angle.values,
        ds.gear_speed.values,
        Plant.of(scene),
        2.0 * math.pi / 54,
        0.05 if seed % 2 else 0.0,
    )
    assert ("moves" if moves else outcome.verdict) == wanted, json.dumps(scene.to_dict()["drive"])


CLOSE_KNOTS = [
    (0.0, 0.0),
    (2e-8, 1e-20),
    (3e-8, 5e-21),
    (5e-8, 2e-20),
    (2.0, 4.8e-18),
    (2.0001, 3e-18),
    (5.0, 1.2e-17),
]
"""A wiggle and a narrow dip, far faster than anything that moves."""


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_free_gears_follow_a_schedule_with_close_knots_and_seconds_after_them(interpolation):
    schedule = {"knots": CLOSE_KNOTS, "interpolation": interpolation}
    (outcome,) = outcomes(ended(2.4, **{"drive.schedule": schedule}))
    (angle,) = free_way(
        Plant.of(PAIR.replace({"drive.schedule": schedule})), outcome.stick_time, np.array([2.4])
    )
    assert outcome.verdict == "sticks"
    assert outcome.free_advance == pytest.approx(angle / (2.0 * math.pi / 54), rel=1e-3)
    stopped = ended(2.4, **{"drive.schedule": schedule, "run.stop": "sticks"})
    assert float(stopped.stick_time) == pytest.approx(outcome.stick_time, rel=1e-6)


def test_a_gear_that_starts_as_free_gears_do_has_not_stood():
    """It leaves two zeros, the later one by a standstill that has ended earlier."""
    sizes = {"pinion": 40e-6, "gear": 100e-6}
    solid = {f"gears.{name}_inertia": 0.5 * math.pi * 2330.0 * 2e-6 * r**4 for name, r in sizes.items()}
    geometry = {"gears.pinion_teeth": 24, "gears.gear_teeth": 60, "gears.pinion_base_radius": 40e-6, **solid}
    start = {
        "initial.gear_speed": 0.0,
        "initial.gap": "0.1 um",
        "coating.sam_fraction": 0.5,
        "run.samples": "off",
    }
    ramp = {"drive.torque": 0.0, "drive.schedule": [(0.0, 0.0), (2.0, 4.8e-18), (2.1, 3.8e-16)]}
    scene = gd.preset("teodorescu2009_low_speed").replace(geometry | start | ramp | {"load.torque": 3e-18})
    table = gd.simulate(scene.replace({"run.duration": 2.1})).gearidae.standstills()
    np.testing.assert_allclose(table["begin"], [0.0, 1.824], atol=1e-3)
    np.testing.assert_allclose(
        table["end"], [0.5, 2.0191], atol=1e-3
    )  # 0.5 s: the torque is that of the dry load; then as it lets go of the gear for the last time
    assert table["verdict"].tolist() == ["stops", "sticks"]
    assert (table["held_torque"] > 0.0).tolist() == (table["free_advance"] > 0.0).tolist() == [False, True]


def test_a_gear_that_creeps_past_half_a_pitch_stands_on_from_a_later_zero():
    """A harmonic above the mean pushes it on a little in each period; free gears have long gone on."""
    drive = {
        "drive.schedule": [(0.0, 5.4417e-18), (0.13725, 1.9657e-18), (0.25869, 5.4417e-18)],
        "drive.harmonic": [{"amplitude": 1.07855e-17, "frequency": 37.0, "phase": 1.73814}],
    }
    rubs = {
        "contact.friction": 0.05,
        "gears.hub_friction": 0.3,
        "gears.pinion_hub_radius": 3e-6,
        "gears.gear_hub_radius": 6e-6,
    }
    start = {"coating.sam_fraction": 0.6, "initial.mesh_phase": 0.47193}
    ds = ended(0.3, **drive, **rubs, **start)
    (outcome,) = outcomes(ds)
    assert outcome.verdict == "sticks"
    assert outcome.stick_time == pytest.approx(0.061, abs=1e-3)
    table = ds.gearidae.standstills()
    assert table["verdict"].tolist() == ["sticks", "sticks"]
    assert table["begin"][1] == table["end"][0] == pytest.approx(0.2831, abs=1e-3)


DEVICE = PAIR.replace(
    {
        "surface.asperity_radius": 160e-9,
        "coating.sam_fraction": 1.0,
        "coating.energy": 0.05,
        "load.torque": 2e-12,
        "load.drag": 0.0,
        "load.viscous": 1e-14,
        "drive.schedule": [(0.0, 0.0), (20e-3, 4e-12)],
        "run.duration": 6e-3,
    }
)
"""Under the torques of a device: the drive overcomes the dry load at 10 ms / 3."""


def same_standstills(table, other):
    assert table.verdict.tolist() == other.verdict.tolist()
    assert table.held_by.tolist() == other.held_by.tolist()
    for column, rel in (
        ("begin", 1e-6),
        ("end", 1e-5),  # a slip of gears whose teeth ring, at a tolerance of 1e-6
        ("rest_time", 1e-3),
    ):  # the last by the ringing's steps
        assert table[column].to_numpy() == pytest.approx(other[column].to_numpy(), rel=rel, nan_ok=True)


@pytest.mark.parametrize("cut", [2e-3, 3.5e-3, 3.9e-3, 5e-3])
@pytest.mark.parametrize("knots", [2, 3])
def test_a_run_that_is_cut_has_the_standstills_of_one_that_is_not(cut, knots):
    """Also where it has begun to move and not left half a pitch; a third knot after the end is another schedule."""
    whole = gd.simulate(DEVICE)
    first = gd.simulate(DEVICE, t_end=cut)
    schedule = [*DEVICE.drive.schedule, (30e-3, 4e-12)][:knots]
    rest = gd.simulate(DEVICE.replace({"drive.schedule": schedule}), start=first, t_end=6e-3)
    table = whole.gearidae.standstills()
    assert table.end[0] == last_slip(whole, 4e-3) == pytest.approx(10e-3 / 3.0, rel=1e-3)
    same_standstills(rest.gearidae.standstills(), table)
    assert float(rest.start_time) == pytest.approx(float(whole.start_time), rel=1e-5)


def test_what_a_standstill_held_is_what_drove_until_its_end():
    """A step of the torque that is not over where the gear begins to move: the plateau after it was not held."""
    step = [(0.0, 0.0), (1e-3, 0.0), (1.01e-3, 2e-12), (2e-3, 2e-12), (2.01e-3, 0.0)]
    table = gd.simulate(DEVICE.replace({"drive.schedule": step, "initial.gap": 28e-9})).gearidae.standstills()
    begins = table[table.end < 1.01e-3]
    assert len(begins) == 1
    time = begins.end.iloc[0]
    assert begins.held_torque.iloc[0] <= max(3.0 * 2e-12 * (time - 1e-3) / 1e-5 - 2e-12, 0.0) + 1e-18


HUBS = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": 8e-6, "gears.gear_hub_radius": 20e-6}
RESISTANCE = 4.6194e-16
"""Dry load of gears that break away at 1.8297e-16 N m by closed form."""


def hubs_alone(ramp, end):
    """Gears that a drive ramped up to 4e-16 N m starts against a dry load and the friction of their hubs."""
    changes = {"load.torque": RESISTANCE, "coating.sam_fraction": 1.0, "run.duration": end}
    return PAIR.replace(HUBS | changes | {"drive.schedule": [(0.0, 0.0), (ramp, 4e-16)]})


@pytest.mark.parametrize("ramp", [0.3, 3.0, pytest.param(30.0, marks=pytest.mark.by_hand)])
def test_gears_break_away_at_the_closed_form_whatever_the_ramp(ramp):
    """Its teeth ring, by a few parts of ten thousand of the force at the fastest ramp."""
    scene = hubs_alone(ramp, ramp)
    ds = gd.simulate(scene)
    wanted = friction.hub_starting_torque(scene.geometry, RESISTANCE, 0.3, (8e-6, 20e-6))
    assert wanted == pytest.approx(1.8297e-16, rel=1e-5, abs=0)
    assert float(ds.breakaway_torque) == pytest.approx(wanted, rel=5e-4, abs=0)
    assert float(ds.start_time) == last_slip(ds, ramp)


@pytest.mark.parametrize(
    ("coefficient", "radii", "dry", "top", "ramp"),
    [
        (0.20567, (3.2319e-6, 7.1414e-6), 7.069e-17, 6.803e-17, 0.3725),
        (0.12606, (5.6950e-6, 9.5894e-6), 5.3198e-17, 3.839e-17, 0.34424),
        # these stick and slip once more, within a vibration of the slip from rest
        (0.368521, (3.14140e-6, 6.52365e-6), 4.137185e-17, 4.18929e-17, 0.160106),
        (0.271178, (5.25682e-6, 7.13930e-6), 3.937554e-17, 3.75105e-17, 0.158250),
    ],
)
def test_gears_whose_hubs_hold_little_break_away_at_the_closed_form(coefficient, radii, dry, top, ramp):
    """Free gears go no farther than teeth that give way: what was at rest up to its slip has stood until then."""
    scene = PAIR.replace(held_by_hubs(coefficient, radii, dry, top, ramp))
    wanted = friction.hub_starting_torque(scene.geometry, dry, coefficient, radii)
    without = dry * scene.geometry.base_radius_pinion / scene.geometry.base_radius_gear
    assert without < 0.96 * wanted
    ds = gd.simulate(scene)
    # its teeth ring, by some parts of ten thousand of the force
    assert float(ds.breakaway_torque) == pytest.approx(wanted, rel=2e-3, abs=0)
    assert ds.gearidae.standstills().rest_time.iloc[0] > 0.9 * float(ds.start_time)


def rigid_way(scene, coefficient, radii, top, ramp):
    """Way of rigid gears at rest up to their starting torque, whose hubs rub, in pitches at the end of the ramp.

    The tooth force F moves the gear, ``I2 w' / R2 = (R2 - mu r2) F - M - c w^2`` with the speed of the base circles
    ``R2 w``, and takes ``(R1 + mu r1) F`` from the torque at the pinion.
    """
    pinion, gear, load = scene.geometry.base_radius_pinion, scene.geometry.base_radius_gear, scene.load
    ratio = (pinion + coefficient * radii[0]) / (gear - coefficient * radii[1])
    inertia = scene.gears.pinion_inertia / pinion + ratio * scene.gears.gear_inertia / gear
    begin = ratio * load.torque / top * ramp

    def rates(t, y):
        return y[1], (top / ramp * t - ratio * load.drag * (y[1] / gear) ** 2) / inertia

    way = solve_ivp(rates, (0.0, ramp - begin), (0.0, 0.0), rtol=1e-9, atol=1e-20).y[0, -1]
    return way / (2.0 * math.pi * gear / scene.gears.gear_teeth)


@pytest.mark.parametrize(
    ("coefficient", "radii", "dry", "top", "ramp"),
    [
        (0.167078, (2.479284e-6, 1.956728e-5), 4.946886e-17, 2.680208e-17, 0.183796),  # 0.29 pitches
        (0.211848, (5.735133e-6, 1.619656e-5), 4.920720e-17, 2.891127e-17, 0.217327),  # 0.493
        (0.316425, (3.596843e-6, 1.502417e-5), 3.511062e-17, 2.260507e-17, 0.211830),  # 0.504
    ],
)
def test_gears_have_broken_away_once_they_have_turned_on_by_half_a_pitch(coefficient, radii, dry, top, ramp):
    scene = PAIR.replace(held_by_hubs(coefficient, radii, dry, top, ramp) | {"run.samples": 3})
    way = rigid_way(scene, coefficient, radii, top, ramp)
    ds = gd.simulate(scene)
    # teeth give way, and ring, by less than a thousandth of a pitch
    assert float(ds.gear_angle[-1]) * 54 / (2.0 * math.pi) == pytest.approx(way, abs=1e-3)
    assert math.isnan(float(ds.breakaway_torque)) == math.isnan(float(ds.start_time)) == (way < 0.5)


def test_a_gear_breaks_away_at_the_force_that_holds_it_where_its_pinion_overshoots():
    """The pinion's hub lets go 0.5 ms before: it comes with a speed, so that 0.998 of the torque at rest are enough."""
    coefficient, radii, dry = 0.322378, (7.518600e-6, 1.453094e-5), 4.082401e-17
    scene = PAIR.replace(held_by_hubs(coefficient, radii, dry, 4.650566e-17, 0.151405))
    early = gd.simulate(scene)
    share = float(early.breakaway_torque) / friction.hub_starting_torque(
        scene.geometry, dry, coefficient, radii
    )
    assert 0.9975 < share < 0.9985
    at_slip = gd.simulate(scene.replace({"run.samples": 3}), t_end=float(early.start_time))
    by_hub = coefficient * radii[1] * float(at_slip.gear_hub_load[-1])
    assert float(at_slip.gear_contact_torque[-1]) - by_hub == pytest.approx(dry, rel=1e-6, abs=0)


def test_the_end_of_a_standstill_does_not_depend_on_where_the_run_is_cut():
    """As long as it has not come half as far as free gears it stands; from then on it has broken away at one time."""
    whole = gd.simulate(hubs_alone(0.3, 0.3))
    cuts = [gd.simulate(hubs_alone(0.3, 0.3), t_end=end) for end in (0.15, 0.18, 0.2, 0.25)]
    ends = [cut.gearidae.standstills().end.iloc[0] for cut in cuts]
    known = [end for end in ends if not math.isnan(end)]
    assert len(known) >= 3
    assert known == pytest.approx(
        [float(whole.start_time)] * len(known), rel=1e-4
    )  # slips of teeth that ring


def spring(t, angle, speed, p):
    return -p[0] * (angle - p[2]) - p[1] * speed


@pytest.fixture
def spring_law():
    gd.register_torque("drawn_spring", parameters=("stiffness", "damping", "rest"))(spring)
    yield
    gd.unregister_torque("drawn_spring")


WELLS = {
    "order": {"drive.harmonic": [{"amplitude": 8e-18, "order": 1.0, "phase": 0.5}]},
    "law": {"drive.law": {"name": "drawn_spring", "stiffness": 5e-17, "damping": 2e-18, "rest": 0.3}},
}


@pytest.mark.parametrize("well", WELLS)
@pytest.mark.parametrize("end", [3.0, 6.0])
def test_a_gear_that_settles_in_a_well_of_its_drive_stops(spring_law, well, end):
    """Free gears lie in the same well: nothing but the drive holds it."""
    damped = {"drive.schedule": [], "load.torque": 0.0, "load.viscous": 1e-18, "coating.sam_fraction": 1.0}
    (outcome,) = outcomes(ended(end, **damped, **WELLS[well]))
    assert outcome.verdict == "stops"
    assert outcome.settled == 2
    assert outcome.held_by == "the drive's own well"
    assert not outcome.holding.by_adhesion
    assert not outcome.holding.by_friction
    assert outcome.words.endswith("as free gears do, held by the drive's own well")


def swing(stiffness, viscous):
    """Half period [s] of free gears under a spring on the pinion, and the part of a swing that the next one has."""
    plant = Plant.of(PAIR)
    decay = viscous / (2.0 * plant.inertia)
    half = math.pi / math.sqrt(plant.ratio**2 * stiffness / plant.inertia - decay**2)
    return half, math.exp(-decay * half)


@pytest.mark.parametrize(("viscous", "gap"), [(2e-18, "100 nm"), (5e-19, "60 nm"), (2e-18, "20 nm")])
def test_a_gear_that_swings_in_a_well_never_sticks_and_stops_after_its_first_period(spring_law, viscous, gap):
    """Just after it turns the pinion passes the backlash, and free gears are ahead of the gear for that time.

    From a gap of 20 nm the gear rings before it follows them, and free gears are ahead by 0.11 to 0.13 pitches.
    """
    half, ratio = swing(1e-17, viscous)
    rest = 0.24  # pitches
    law = {"name": "drawn_spring", "stiffness": 1e-17, "damping": 0.0, "rest": rest * 2.0 * math.pi / 18}
    damped = {"load.torque": 0.0, "load.drag": 0.0, "load.viscous": viscous, "drive.law": law}
    start = {"initial.gear_speed": 0.0, "initial.gap": gap, "coating.sam_fraction": 1.0}
    for halves in (1.02, 1.04, 1.06, 1.08, 1.5, 2.05, 2.5, 3.02, 3.06, 5.04):
        ds = ended(halves * half, **{"drive.schedule": []}, **damped, **start)
        (outcome,) = outcomes(ds)
        assert (outcome.verdict == "stops") is (halves > 2.0), halves
        # the first 3 % are those of the initial gap, before it has moved
        late = ds.gearidae.standstills().query("not end < 0.03 * @half")
        assert "sticks" not in [outcome.verdict, *late.verdict], halves
        # of free gears, to 1e-6 of the step response
        assert float(ds.free_advance) == pytest.approx(rest * (1.0 + ratio), rel=1e-5)


def test_a_gear_that_turns_round_in_the_well_of_an_order_does_not_stick():
    """At 1 s it has moved by 7e-4 pitches in the 2 % of the run since its speed was zero, free gears by 1.8e-3.

    Three exits lie behind it, which multiply rounding: it stops from 0.987 s on with one processor, with another from
    between 1 and 1.01 s on.
    """
    damped = {"drive.schedule": [], "load.torque": 0.0, "load.viscous": 1e-18, "coating.sam_fraction": 1.0}
    for end, allowed in ((0.95, ["irregular"]), (1.0, ["irregular", "stops"]), (1.03, ["stops"])):
        ds = ended(end, **damped, **WELLS["order"])
        assert outcomes(ds)[0].verdict in allowed, end
        assert "sticks" not in ds.gearidae.standstills().get("verdict", []).tolist(), end


def test_a_microengine_that_brakes_its_gears_stops_them():
    """Free gears would follow its field on by 0.4 pitches, and settle in it."""
    scene = gd.load_case("cases/microengine.toml").to_dict()
    scene["drive"]["law"]["frequency"] = [(0.0, 0.0), (2e-3, 600.0), (3e-3, 600.0), (4.5e-3, 0.0)]
    del scene["load"]["schedule"]
    scene["run"] |= {"duration": 6e-3, "samples": "off"}
    (outcome,) = outcomes(gd.simulate(gd.Scene.from_dict(scene)))
    assert outcome.verdict == "stops"
    assert outcome.held_by == "dry resistance and hub friction and pin friction"
    assert outcome.holding.by_friction
    assert outcome.words.startswith("came to rest at 4.5 ms (31 mesh exits), 0.422 pitches before free gears")


@pytest.mark.parametrize(
    ("rtol", "drive", "load", "until"),
    [(3e-7, 3e-18, 4e-17, 1.6), (3e-4, 3e-18, 1.2e-17, 2.0), (1e-3, 6e-18, 4e-17, 2.0)],
)
def test_pairs_that_stick_at_once_end_the_motion(rtol, drive, load, until):
    """Their friction sets the speed to 0, which does not pass it."""
    braked = {"load.torque": 0.0, "load.schedule": [(0.0, 0.0), (1.0, 0.0), (until, load)]}
    driven = {"drive.schedule": [], "drive.torque": drive, "contact.friction": 0.1}
    ds = ended(3.5, **braked, **driven, **{"coating.sam_fraction": 1.0, "run.rtol": rtol})
    (outcome,) = outcomes(ds)
    assert outcome.verdict == "stops"
    assert 3.5 - outcome.stick_time == pytest.approx(float(ds.rest_time), rel=1e-3)
