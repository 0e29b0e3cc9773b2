"""A pinion that the force of its drive carries round in its hub: closed forms, at rest, energy, in parts and refusals.

`properties.test_gears_without_adhesion` has its motion on both flanks beside that of the two shafts whose centres move.
"""

import math

import numpy as np
import pytest

import gearidae as gd
from balances import assert_closes
from gearidae.engine import solve
from gearidae.engine.model.state import COAST, DRIVE
from gearidae.engine.pairs.orbit import follow_orbit
from gearidae.engine.pairs.tooth_pairs import path_gap
from gearidae.engine.setup.build import make_problem
from gearidae.engine.teeth import states_at

BACKENDS = ["native", "sksundae"]
ENGINE = gd.preset("teodorescu2009").replace(
    {
        "contact.asperity": "hertz",
        "contact.bodies": "rigid",
        "mesh.backlash": "0.5 um",
        "drive.torque": 0.0,
        "drive.harmonic": None,
        "drive.law": {"name": "microengine", "radius": "10 um", "force": "10 uN", "frequency": "600 Hz"},
        "drive.orientation": 0.3,
        "gears.pinion_hub_clearance": "0.5 um",
        "load.torque": 0.0,
    }
)
"""An engine whose pin pushes with 10 uN on the pinion."""
CLEARANCE, ALPHA = 0.5e-6, math.radians(20.0)


def gaps_of(scene, t):
    """Gaps of pair 0 on the path of contact of both flanks at a time [m], at u = 0."""
    m = make_problem(scene).model
    follow_orbit(m, t / float(m.scene.time_unit))
    length = float(m.scene.length_unit)
    return [path_gap(m, flank, 0, np.zeros(4)) * length for flank in (DRIVE, COAST)]


def test_gears_that_come_nearer_have_less_play_and_other_ones_more():
    """The sum of both gaps is the backlash less ``2 sin(alpha)`` times the way along the centres, as geometry has it.

    Two involutes whose centres come nearer by x lose ``2 x sin(alpha)`` of their play along the line of action; a way
    across the centres shifts the play from one flank to the other and takes none.
    """
    still = ENGINE.replace({"drive.law.frequency": 0.0})
    for phase in (-90.0, 90.0, 0.0, 37.0):
        # the force is (-sin, cos) of the phase, turned by the orientation
        scene = still.replace({"drive.law.phase": f"{phase} deg"})
        way = CLEARANCE * math.cos(math.radians(90.0 + phase) + 0.3)
        drive, coast = gaps_of(scene, 0.0)
        assert drive == 0.25e-6  # u counts from the drive flank
        assert drive + coast == pytest.approx(0.5e-6 - 2.0 * math.sin(ALPHA) * way, rel=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_pinion_that_is_held_carries_its_teeth_along_those_of_the_gear(backend):
    """At rest ``u' = -dE/dt``: u follows the way of the centre along the drive flank, and nothing turns."""
    scene = ENGINE.replace(
        {
            "gears.hub_friction": 0.5,
            "gears.pinion_hub_radius": "10 um",
            "gears.gear_hub_radius": "6 um",
            "drive.pin_radius": "4 um",
            "drive.pin_friction": 0.5,
            # hub and pin hold 7 um of the 10 um of the arm: what a force has that is within 44 degrees of the pin's arm
            "drive.law.phase": "57 deg",
            "initial.gear_speed": 0.0,
            "initial.gap": "1 um",
            "mesh.backlash": "2 um",
            "run.duration": 3e-4,
            "run.samples": 21,
            "run.rtol": 1e-10,
        }
    )
    run = solve(scene, backend=backend)
    assert run.status == "finished"
    angle = 2.0 * math.pi * 600.0 * run.time + math.radians(57.0 + 90.0) + scene.drive.orientation
    along = CLEARANCE * (np.cos(angle) * math.sin(ALPHA) + np.sin(angle) * math.cos(ALPHA))
    u = run.samples["transmission_error"]
    assert np.ptp(u) > 0.1e-6
    np.testing.assert_allclose(u - u[0], along - along[0], rtol=0.0, atol=1e-9 * np.ptp(u))
    np.testing.assert_array_equal(run.samples["gear_speed"], 0.0)
    # what is left is the error of the integration of u' alone
    assert (
        np.abs(run.samples["pinion_speed"]).max() * scene.gears.pinion_base_radius < 1e-8 * CLEARANCE * 3770.0
    )


def test_the_gear_swings_by_the_clearance_over_its_radius():
    """A pinion that turns with the force: ``R2 w2`` swings by ``c w1``, 1.44 % of itself for 0.5 um."""
    scene = ENGINE.replace(
        {
            "gears.pinion_inertia": 1e-15,  # so large that it turns as it does
            "initial.gear_speed": 600.0 * 2.0 * math.pi / 4.0,
            "initial.gap": "15 nm",
            "mesh.damping": 1e-5,
            "load.torque": 1e-11,
            "run.duration": 1.0 / 600.0,
            "run.samples": 401,
            "run.rtol": 1e-8,
        }
    )
    run = solve(scene)
    assert run.status == "finished"
    assert_closes(scene, run)
    ratio = run.samples["gear_speed"] * 4.0 / run.samples["pinion_speed"] - 1.0
    own = CLEARANCE / scene.gears.pinion_base_radius
    turned = 2.0 * math.pi * 600.0 * run.time + 0.5 * math.pi + scene.drive.orientation
    # the rate of the centre's way along the drive flank
    swing = own * (-np.sin(turned) * math.sin(ALPHA) + np.cos(turned) * math.cos(ALPHA))
    assert own == pytest.approx(0.0144, abs=1e-4)
    # contacts ring at each tooth that enters: the harmonic of the turn is what counts
    amplitude = np.trapezoid(ratio * swing, run.time) / np.trapezoid(swing * swing, run.time)
    assert amplitude == pytest.approx(1.0, abs=0.02)


def test_a_run_in_parts_is_the_whole():
    scene = ENGINE.replace(
        {"initial.gap": "20 nm", "run.duration": 2.0**-13, "run.samples": 17, "run.checkpoints": [2.0**-14]}
    )
    half = scene.replace({"run.duration": 2.0**-14, "run.samples": 9, "run.checkpoints": None})
    first = gd.simulate(half)
    rest = gd.simulate(half, start=first)
    whole = gd.simulate(scene)
    for name in ("pinion_speed", "gear_speed", "transmission_error", "coast_gap", "mesh_force"):
        parts = np.concatenate([first[name].values, rest[name].values[1:]])
        np.testing.assert_array_equal(parts, whole[name].values, err_msg=name)


def test_a_look_at_the_teeth_changes_nothing():
    scene = ENGINE.replace({"initial.gap": "20 nm", "run.duration": 1e-4, "run.samples": 11})
    run = solve(scene)
    states = states_at(scene, [3, 7], backend="native")
    for state, sample in zip(states, (3, 7), strict=True):
        assert state.mesh_force == run.samples["mesh_force"][sample]
        assert state.transmission_error == run.samples["transmission_error"][sample]


# -- refusals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"drive.law": None, "drive.torque": 1e-11, "drive.orientation": 0.0}, "a couple leaves the pinion"),
        ({"gears.pinion_hub_clearance": "0.8 um"}, "teeth would jam: the orbit takes 5.472e-07 m"),
        ({"mesh.pitch_error_rms": "60 nm"}, "teeth would jam"),
        ({"drive.law.stiffness_x": 0.5}, "must depend on time alone"),
    ],
)
def test_what_has_no_orbit_is_refused(changes, words):
    with pytest.raises(gd.SceneError, match=words) as refused:
        ENGINE.replace(changes)
    assert refused.value.key == "gears.pinion_hub_clearance"


def test_a_force_that_vanishes_or_jumps_is_refused():
    @gd.register_torque(
        "turning_pin", parameters=("jump", "size"), force=True, knots=lambda p, t_end: [0.5 * t_end]
    )
    def turning_pin(t, speed, p):
        angle = 1e4 * t + (p[0] if t > 1e-5 else 0.0)
        return 1e-12, p[1] * math.cos(angle), p[1] * math.sin(angle)

    try:
        law = {"name": "turning_pin", "jump": 0.0, "size": 1e-5}
        scene = ENGINE.replace({"drive.law": law, "run.duration": 2e-5})
        assert scene.gears.pinion_hub_clearance == CLEARANCE
        with pytest.raises(gd.SceneError, match=r"a jump or a kink at 1e-05 s"):
            scene.replace({"drive.law.jump": 0.01})
        with pytest.raises(gd.SceneError, match=r"vanishes at 0 s"):
            scene.replace({"drive.law.size": 0.0})
    finally:
        gd.unregister_torque("turning_pin")
