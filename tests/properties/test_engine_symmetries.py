"""What a run may not depend on: when it starts, the units, which flank is called which, where samples are taken."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind

BASE = gd.preset("teodorescu2009").replace(
    {
        "coating.sam_fraction": 0.5,
        "contact.bodies": "rigid",
        "initial.gap": 3e-8,
        "run.duration": 2e-5,
        "run.samples": 101,
        "run.rtol": 1e-8,
    }
)


def test_a_later_start_is_the_same_motion_later():
    """A gear held by dry resistance waits for the torque's schedule; two waits, one motion."""
    runs = []
    for wait in (1e-5, 6e-5):
        ramp = [[wait, 0.0], [wait + 1e-5, 6e-11]]
        runs.append(
            solve(
                BASE.replace(
                    {
                        "initial.gear_speed": 0.0,
                        "initial.gap": 1e-7,
                        "drive.torque": 0.0,
                        "drive.harmonic": [],
                        "drive.schedule": ramp,
                        "run.duration": wait + 5e-5,
                        "run.samples": round((wait + 5e-5) * 1e7) + 1,
                    }
                )
            )
        )
    early, late = runs
    slip = [run.events.time[run.events.kind == EventKind.SLIP] for run in runs]
    assert len(slip[0]) >= 1
    assert slip[1] - slip[0] == pytest.approx(5e-5, rel=1e-6, abs=0)
    for name in ("gear_speed", "pinion_speed"):
        after = early.samples[name][100:]
        assert np.ptp(after) > 0.0
        # the same steps but for what the wait leaves in the step size: some hundred times 1e-8 per step
        np.testing.assert_allclose(late.samples[name][600:], after, atol=3e-6 * np.ptp(after))


def rescaled(scene, length, mass, time):
    """The same scene written in other units."""
    g, m, s, i = scene.gears, scene.mesh, scene.surface, scene.initial
    torque = mass * length**2 / time**2
    return scene.replace(
        {
            "gears.pinion_inertia": g.pinion_inertia * mass * length**2,
            "gears.gear_inertia": g.gear_inertia * mass * length**2,
            "gears.pinion_base_radius": g.pinion_base_radius * length,
            "gears.face_width": g.face_width * length,
            "mesh.backlash": m.backlash * length,
            "mesh.tip_relief_radius": m.tip_relief_radius * length,
            "mesh.damping": m.damping * mass / time,
            "mesh.static_error": [
                {"order": h.order, "amplitude": h.amplitude * length, "phase": h.phase}
                for h in m.static_error
            ],
            "surface.youngs_modulus": s.youngs_modulus * mass / (length * time**2),
            "surface.energy": s.energy * mass / time**2,
            "coating.energy": scene.coating.energy * mass / time**2,
            "surface.asperity_density": s.asperity_density / length**2,
            "surface.asperity_radius": s.asperity_radius * length,
            "surface.roughness": s.roughness * length,
            "drive.torque": scene.drive.torque * torque,
            "drive.harmonic": [
                {"amplitude": h.amplitude * torque, "frequency": h.frequency / time, "phase": h.phase}
                for h in scene.drive.harmonic
            ],
            "load.torque": scene.load.torque * torque,
            "load.drag": scene.load.drag * mass * length**2,
            "initial.gear_speed": i.gear_speed / time,
            "initial.gap": i.gap * length,
            "run.duration": scene.run.duration * time,
        }
    )


@settings(max_examples=8)
@given(length=st.integers(-2, 4), mass=st.integers(-2, 2), time=st.integers(-1, 3))
def test_units_do_not_matter(length, mass, time):
    scene = BASE.replace(
        {"mesh.damping": 1e-7, "mesh.static_error": [{"order": 19, "amplitude": 1e-8}], "run.samples": 41}
    )
    unit = 2.0**length, 2.0**mass, 2.0**time
    original, scaled = solve(scene), solve(rescaled(scene, *unit))
    assert np.isin(original.events.kind, EventKind.TURNING_POINT).sum() >= 2
    # rounding of the scales now and then takes or refuses a step: what the tolerance of 1e-8 per step leaves
    speed, u = original.samples["gear_speed"], original.samples["transmission_error"]
    np.testing.assert_allclose(scaled.samples["gear_speed"] * unit[2], speed, atol=3e-6 * np.ptp(speed))
    np.testing.assert_allclose(scaled.samples["transmission_error"] / unit[0], u, atol=3e-6 * np.ptp(u))
    np.testing.assert_array_equal(scaled.events.kind, original.events.kind)


@pytest.mark.parametrize("phase", [0.1, 0.45, 0.93])
def test_backwards_on_the_other_flank_is_the_mirror_image(phase):
    """All torques and speeds the other way round, the phase mirrored about the pitch point."""
    there = (make_problem(BASE).model.scene.coast_phase - phase) % 1.0
    forward = solve(BASE.replace({"initial.mesh_phase": phase}))
    torque = BASE.drive.torque
    backward = solve(
        BASE.replace(
            {
                "initial.mesh_phase": there,
                "initial.gear_speed": -BASE.initial.gear_speed,
                "initial.gap": BASE.mesh.backlash - BASE.initial.gap,
                "drive.torque": -torque,
                "drive.harmonic": [{"amplitude": -0.3e-11, "frequency": 1e4}],
            }
        )
    )
    assert forward.status == backward.status == "finished"
    assert np.count_nonzero(forward.events.kind == EventKind.TURNING_POINT) >= 3
    for name in ("gear_speed", "pinion_speed", "transmission_error", "mesh_force", "gear_contact_torque"):
        values = forward.samples[name]
        # rounding differs, and is magnified by each impact
        np.testing.assert_allclose(-backward.samples[name], values, atol=1e-5 * np.abs(values).max())
    np.testing.assert_allclose(backward.samples["coast_gap"], forward.samples["drive_gap"], atol=1e-5 * 6e-9)
    flanks = forward.events.flank
    np.testing.assert_array_equal(np.sort(backward.events.kind), np.sort(forward.events.kind))
    np.testing.assert_array_equal(
        np.sort(backward.events.flank), np.sort(np.where(flanks < 0, flanks, 1 - flanks))
    )


def test_where_samples_are_taken_does_not_move_an_event():
    few, many = (solve(BASE.replace({"run.samples": n})) for n in (2, 1001))
    for field in ("time", "kind", "pair", "flank", "gap_rate"):
        np.testing.assert_array_equal(getattr(few.events, field), getattr(many.events, field))
    for name, values in few.samples.items():
        np.testing.assert_array_equal(values, many.samples[name][[0, -1]])
    assert few.statistics.steps == many.statistics.steps
