"""Event times against closed forms and quadratures: bounces that accumulate, stops and starts under dry resistance."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind
from reference.bouncing import BouncingTooth

I2 = 6.1052e-20
HEAVY = gd.preset("teodorescu2009").replace(
    {
        "contact.bodies": "rigid",
        "mesh.backlash": 4e-6,
        "gears.gear_inertia": 1e-8,  # it stands still
        "initial.gear_speed": 0.0,
        "initial.mesh_phase": 0.84,  # the middle of the path: no other pair is within reach
        "initial.gap": 1e-6,
        "drive.torque": 1e-11,
        "drive.harmonic": [],
        "load.torque": 0.0,
        "load.drag": 0.0,
        "coating.sam_fraction": 1.0,
    }
)


def times(run, kind):
    return run.events.time[run.events.kind == kind]


@pytest.mark.parametrize(
    ("energy", "backend"),
    [
        (0.7, "native"),
        (1.0, "native"),
        (1.0, "sksundae"),
        pytest.param(0.7, "sksundae", marks=pytest.mark.by_hand),
    ],
)
def test_a_bouncing_tooth_keeps_the_times_of_its_bounces_until_one_holds_it(energy, backend):
    """Some ten to twenty bounces, each shorter than the one before, that accumulate at the one that ends them."""
    scene = HEAVY.replace({"coating.energy": energy, "run.rtol": 1e-10, "run.samples": 3})
    head = make_problem(scene).model.scene
    sigma = scene.surface.roughness
    tooth = BouncingTooth(scene, float(head.contact_gap) * sigma, float(head.cutoff) * sigma)
    expected = tooth.bounces(scene.initial.gap)
    end = expected["turning"][-1]
    flights = np.diff(expected["turning"])
    assert len(flights) >= 9
    assert np.all(np.diff(flights) < 0.0)
    assert flights[-1] < 0.5 * flights[0]
    run = solve(scene.replace({"run.duration": 1.1 * end}), backend=backend)
    assert run.status == "finished"
    for name, kind in (
        ("onset", EventKind.ONSET),
        ("full", EventKind.FULL_STRETCH),
        ("separation", EventKind.SEPARATION),
    ):
        bounces = times(run, kind)[: len(expected[name])]
        # 1e-10 per step, and each bounce adds up the errors of all before it
        np.testing.assert_allclose(bounces, expected[name], rtol=0, atol=2e-8 * end)
    turned = times(run, EventKind.TURNING_POINT)
    # the tooth that is held goes on trembling: it turns round in either direction
    nearest = turned[np.abs(turned[:, None] - expected["turning"]).argmin(axis=0)]
    np.testing.assert_allclose(nearest, expected["turning"], rtol=0, atol=2e-8 * end)
    after = times(run, EventKind.SEPARATION)[len(expected["separation"]) :]
    late = run.events.time[-1]
    assert np.all(after > end)
    # what it still rises to is within the range of adhesion: it never flies again
    assert run.samples["drive_gap"][-1] < head.cutoff * sigma
    assert late > end


def free_gear(**changes):
    """A gear in the middle of a wide backlash: nothing touches it."""
    return gd.preset("teodorescu2009").replace(
        {
            "mesh.backlash": 4e-6,
            "initial.gap": 2e-6,
            "drive.torque": 0.0,
            "drive.harmonic": [],
            "load.drag": 0.0,
            "run.samples": 101,
            "run.rtol": 1e-9,
            **changes,
        }
    )


def test_dry_resistance_and_drag_stop_a_gear_at_the_time_of_the_arctangent():
    """I2 w' = -M - alpha w^2 from w0 comes to rest after I2 / sqrt(M alpha) atan(w0 sqrt(alpha / M))."""
    resistance, drag, speed = 3e-17, 8e-18, 1.5
    stop = I2 / math.sqrt(resistance * drag) * math.atan(speed * math.sqrt(drag / resistance))
    run = solve(
        free_gear(
            **{"load.torque": resistance, "load.drag": drag, "initial.gear_speed": speed},
            **{"run.duration": 1.2 * stop},
        )
    )
    # a hundred times the tolerance
    assert times(run, EventKind.STICK) == pytest.approx([stop], rel=1e-7, abs=0)


def test_a_resistance_that_swings_stops_a_gear_when_its_impulse_has_taken_the_momentum():
    """I2 w0 is used up by the integral of M (1 + 0.8 cos(2 pi f t + 1))."""
    mean, swing, frequency, phase, speed = 3e-17, 2.4e-17, 2e3, 1.0, 1.5
    omega = 2 * math.pi * frequency

    def momentum(t):
        return I2 * speed - mean * t - swing / omega * (math.sin(omega * t + phase) - math.sin(phase))

    stop = brentq(momentum, 0.0, 2 * I2 * speed / (mean - swing), xtol=1e-18, rtol=1e-14)
    run = solve(
        free_gear(
            **{"load.torque": mean, "initial.gear_speed": speed, "run.duration": 1.2 * stop},
            **{"load.harmonic": [{"amplitude": swing, "frequency": frequency, "phase": phase}]},
        )
    )
    assert times(run, EventKind.STICK) == pytest.approx([stop], rel=1e-7, abs=0)


def test_a_gear_at_rest_slips_when_the_first_impact_has_risen_to_the_resistance():
    """The pinion falls onto the tooth of a gear held at rest; when R2 F reaches M20 is a matter of quadrature."""
    scene = HEAVY.replace({"coating.energy": 0.3, "load.torque": 2e-10, "run.rtol": 1e-10, "run.samples": 3})
    head = make_problem(scene).model.scene
    sigma, radius = scene.surface.roughness, scene.geometry.base_radius_gear

    far = float(head.cutoff) * sigma
    held = scene.replace({"gears.gear_inertia": 1.0})  # as good as held: it adds nothing to the motion

    def excess(gap):
        return radius * BouncingTooth(held, gap, far).force(gap, 0.0) - scene.load.torque

    gap = brentq(excess, -1.5 * sigma, 4.0 * sigma, xtol=1e-22, rtol=1e-14)
    tooth = BouncingTooth(held, gap, far)
    fall = math.sqrt(2.0 * (scene.initial.gap - far) / tooth.pull)
    expected = fall + tooth.approach(tooth.pull * fall)[0]
    run = solve(scene.replace({"run.duration": 1.01 * expected}))
    assert times(run, EventKind.SLIP) == pytest.approx([expected], rel=1e-8, abs=0)
