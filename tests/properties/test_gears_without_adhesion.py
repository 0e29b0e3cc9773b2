"""The engine against the same gears in other coordinates, by another integrator: no adhesion, every other term."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind
from reference.hertz_gears import HertzGears

BASE = gd.preset("teodorescu2009").replace(
    {
        "contact.asperity": "hertz",
        "contact.bodies": "rigid",
        "initial.gap": 2e-8,
        "run.duration": 1.5e-5,
        "run.samples": 61,
        "run.rtol": 1e-10,
    }
)

# sigma is 6 nm: the force reaches out to some 9 sigma on either flank
CASES = {
    "as it is": {},
    "static error": {
        "mesh.static_error": [
            {"order": 19, "amplitude": 3e-8, "phase": 0.4},
            {"order": 1, "amplitude": 1e-6, "phase": 1.0},
        ]
    },
    "runout of both gears": {
        "mesh.pinion_runout": {"amplitude": 1e-6, "phase": 1.0},
        "mesh.gear_runout": {"amplitude": 3e-6, "phase": -0.5},
    },
    "errors of single teeth, on both flanks": {
        "mesh.pinion_pitch_error": (4e-9 * np.cos(np.arange(19) ** 2)).tolist(),
        "mesh.gear_pitch_error": (5e-9 * np.sin(np.arange(76) ** 2)).tolist(),
        "mesh.backlash": 5e-8,
        "initial.gap": 1.5e-8,
        "run.duration": 3e-5,
    },
    "orbit of the pinion, on both flanks": {
        "drive.law": {
            "name": "microengine",
            "radius": 1e-5,
            "force": 4e-7,
            "phase": 0.3,
            "frequency": 4e4,
        },
        "drive.orientation": 0.7,
        "gears.pinion_hub_clearance": 6e-8,
        "mesh.backlash": 7e-8,
        "mesh.damping": 2e-6,
        "mesh.film_damping": 2e-6,
        "mesh.film_gap": 2e-8,
        "initial.gap": 2e-8,
    },
    "mesh damping": {"mesh.damping": 5e-6},
    "films of gas": {"mesh.film_damping": 2e-4, "mesh.film_gap": 1e-9},
    "load harmonics": {
        "load.harmonic": [
            {"amplitude": 1e-11, "frequency": 2e5, "phase": 0.3},
            {"amplitude": 4e-12, "frequency": 9e5, "phase": 2.0},
        ]
    },
    "no backlash": {"mesh.backlash": 0.0, "initial.gap": 0.0, "run.duration": 4e-7},
    "backlash below the range of the force": {"mesh.backlash": 4e-8, "initial.gap": 1.5e-8},
    "gap starts on the coast flank": {"initial.gap": 1.9e-7, "drive.torque": 0.0},
    "contact ratio near one": {
        "gears.pressure_angle": 0.61,
        "gears.pinion_teeth": 14,
        "gears.gear_teeth": 14,
    },
    "contact ratio above two": {
        "gears.pressure_angle": 0.2618,
        "gears.pinion_teeth": 90,
        "gears.gear_teeth": 110,
    },
    "tip relief at work": {"initial.mesh_phase": 0.6, "mesh.tip_relief_radius": 2e-5, "run.duration": 2.5e-5},
}


def reach_of_films(scene):
    """Gap at which the engine leaves a pair, which is no part of the law [m]."""
    s = make_problem(scene).model.scene
    return float(s.cutoff * s.length_unit)


@pytest.mark.parametrize("name", CASES)
def test_motion_is_that_of_the_two_shafts(name):
    scene = BASE.replace(CASES[name])
    ours = solve(scene)
    assert ours.status == "finished"
    u, pinion, gear = HertzGears(scene, reach_of_films(scene)).run(ours.time)
    assert np.isin(ours.events.kind, [EventKind.ONSET, EventKind.TURNING_POINT]).any()  # teeth have met
    # 1e-10 per step over some hundreds of steps on our side; the angles of the other form resolve a gap to 1e-8 of
    # the roughness, which stiff contact turns into some 1e-6 of what the speeds change by
    np.testing.assert_allclose(
        ours.samples["transmission_error"], u, atol=3e-6 * scene.surface.roughness + 1e-6 * np.ptp(u)
    )
    for column, values in (("pinion_speed", pinion), ("gear_speed", gear)):
        np.testing.assert_allclose(ours.samples[column], values, atol=3e-6 * np.ptp(values))


def test_contact_ratios_are_what_the_names_say():
    assert 1.0 < BASE.replace(CASES["contact ratio near one"]).geometry.contact_ratio < 1.25
    assert BASE.replace(CASES["contact ratio above two"]).geometry.contact_ratio > 2.0
