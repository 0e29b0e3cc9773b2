"""The engine against its slow readable twin: other integrator, readable force law, no scaling."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from reference.gears import SlowGears

SIDES = {
    "sam_fraction": 1.0,
    "pairing": "independent",
    "pinion_fraction": 0.3,
    "gear_fraction": 0.6,
    "thickness": 1e-9,
}


@pytest.mark.parametrize(
    ("name", "coating", "duration"),
    [
        ("teodorescu2009_low_speed", {"sam_fraction": 1.0}, 4e-3),
        pytest.param("teodorescu2009_low_speed", {"sam_fraction": 0.5}, 3e-3, marks=pytest.mark.by_hand),
        ("teodorescu2009", {"sam_fraction": 0.0}, 4e-6),
        ("teodorescu2009_low_speed", SIDES, 3e-3),
    ],
)
def test_motion_is_the_twins(name, coating, duration):
    # phase 0.8: one pair on the path of contact, no other within reach during the run
    scene = gd.preset(name).replace(
        {
            "coating": coating,
            "initial.mesh_phase": 0.8,
            "initial.gap": 5.5 * 6e-9 if "low" in name else 4 * 6e-9,
            "run.duration": duration,
            "run.samples": 41,
            "run.rtol": 1e-10,
        }
    )
    ours = solve(scene)
    twin = SlowGears(scene).run(ours.time)
    assert np.count_nonzero(ours.events.kind == 2) >= 2  # the history has been used
    sigma = scene.surface.roughness
    # the tolerance of both is 1e-10 per step; some hundred steps and a growth of errors over the cycles lie between
    np.testing.assert_allclose(ours.samples["transmission_error"], twin[0], atol=2e-7 * sigma)
    swing = np.ptp(twin[3])
    np.testing.assert_allclose(ours.samples["gear_speed"], twin[3], atol=1e-6 * swing)
    np.testing.assert_allclose(ours.samples["gear_angle"], twin[2] - twin[2][0], atol=1e-9)


def test_fast_gears_in_very_humid_air_are_pulled_together_at_once():
    """At 95 % menisci that form at their breaking distance let the gear dip to 155 rad/s; none holds a history."""
    scene = gd.preset("teodorescu2009").replace(
        {
            "contact.bodies": "rigid",
            "contact.asperity": "meniscus",
            "surface.humidity": 0.95,
            "coating.sam_fraction": 0.0,
            "run.duration": 0.5e-6,
            "run.samples": 1001,
            "run.rtol": 1e-9,
        }
    )
    twin = SlowGears(scene)
    assert {limit for _, _, limit, _, _ in twin.materials} == {0.0}
    expected = twin.run(np.linspace(0.0, 0.5e-6, 1001), 1e-8)[3]
    assert expected.min() == pytest.approx(155.3, abs=0.05)
    for backend, atol in (("auto", 2e-3), ("sksundae", 0.05)):  # IDA's own formulas are less accurate
        ours = solve(scene, backend=backend)
        np.testing.assert_allclose(ours.samples["gear_speed"], expected, rtol=0.0, atol=atol)
