"""A film of gas between two flanks: a free approach has a closed form, and what the film takes is a loss."""

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from reference.own_pair import OWN_PAIR, TEETH_27_50

PRESET = gd.preset("teodorescu2009").replace({"contact.model": "asperity"})
APPROACH = PRESET.replace(
    {
        "contact.asperity": "hertz",
        "mesh.backlash": 4e-7,
        "mesh.film_damping": 2e-5,
        "mesh.film_gap": 2e-8,
        "drive.torque": 0.0,
        "drive.harmonic": [],
        "drive.schedule": [[0.0, 1e-11], [1e-6, 1e-11], [1.0001e-6, 0.0]],
        "load.torque": 0.0,
        "load.drag": 0.0,
        "initial.gap": 8e-8,
        "initial.gear_speed": 0.0,
        "run.duration": 1e-5,
        "run.samples": 2_001,
        "run.rtol": 1e-10,
    }
)
"""The pinion is pushed and let go before the film acts, and flies at the gear."""


def reduced_mass(scene):
    gears, geometry = scene.gears, scene.geometry
    pinion = gears.pinion_inertia / geometry.base_radius_pinion**2
    gear = gears.gear_inertia / geometry.base_radius_gear**2
    return pinion * gear / (pinion + gear)


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_free_approach_has_its_closed_form(backend, method):
    """m (v - v_a) = n (c g_0^3/2) ((g + g_0)^-2 - (g_a + g_0)^-2) with n pairs on the path of contact."""
    scene = APPROACH.replace({"run.method": method})
    run = solve(scene, backend=backend)
    gap, sigma, mesh = run.samples["drive_gap"], scene.surface.roughness, scene.mesh
    within = (gap < 8.0 * sigma) & (gap > 6.5 * sigma)  # the film acts, and no asperity touches
    within &= np.arange(len(gap)) < np.argmin(gap)
    assert within.sum() > 20
    geometry = scene.geometry
    closing = geometry.base_radius_pinion * run.samples["pinion_speed"]
    closing = (closing - geometry.base_radius_gear * run.samples["gear_speed"])[within]
    gap = gap[within]
    inverse = 1.0 / (gap + mesh.film_gap) ** 2
    slowed = reduced_mass(scene) * (closing[0] - closing)
    pairs = 2 if scene.initial.mesh_phase + 1.0 < geometry.contact_ratio else 1
    taken = pairs * 0.5 * mesh.film_damping * mesh.film_gap**3 * (inverse - inverse[0])
    assert slowed[-1] > 0.01 * reduced_mass(scene) * closing[0]
    np.testing.assert_allclose(slowed, taken, rtol=1e-6, atol=1e-8 * taken[-1])


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_film_ends_at_the_cut_off(backend):
    """Flanks that part are slowed down by the film up to the cut-off, and fly freely from there on.

    It is so high that it damps there with a third of what it does in contact.
    """
    scene = APPROACH.replace(
        {
            "drive.schedule": [[0.0, 0.0], [1e-8, -1e-10], [1e-7, -1e-10], [1.1e-7, 0.0]],
            "mesh.film_gap": 1e-7,
            "mesh.film_damping": 1e-5,
            "initial.gap": 4e-8,
            "run.duration": 3e-6,
        }
    )
    run, sigma, mesh = solve(scene, backend=backend), scene.surface.roughness, scene.mesh
    cutoff = float(make_problem(scene).model.scene.cutoff) * sigma
    gap, geometry = run.samples["drive_gap"], scene.geometry
    opening = geometry.base_radius_gear * run.samples["gear_speed"]
    opening = opening - geometry.base_radius_pinion * run.samples["pinion_speed"]
    free = gap > cutoff
    begin = int(np.searchsorted(run.time, 1.1e-7, side="right"))
    assert gap[begin] < 0.9 * cutoff
    assert free.sum() > 100
    np.testing.assert_allclose(opening[free], opening[-1], rtol=1e-9)
    pairs = 2 if scene.initial.mesh_phase + 1.0 < geometry.contact_ratio else 1
    taken = (gap[begin] + mesh.film_gap) ** -2 - (cutoff + mesh.film_gap) ** -2
    taken *= pairs * 0.5 * mesh.film_damping * mesh.film_gap**3 / reduced_mass(scene)
    assert taken > 0.01 * opening[begin]
    assert opening[begin] - opening[-1] == pytest.approx(taken, rel=1e-6, abs=0)
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("sam", [1.0, 0.5])
def test_what_the_film_takes_is_a_loss_of_the_balance(sam, rtol):
    changes = {
        "coating.sam_fraction": sam,
        "mesh.film_damping": 1e-4,
        "mesh.film_gap": 2e-8,
        "run.rtol": rtol,
    }
    scene = PRESET.replace({**changes, "run.duration": 3e-5, "run.samples": "off"})
    run = solve(scene)
    assert run.balance.film_loss > 5e-4 * run.balance.throughput
    assert_balanced(run.balance, scene)


@pytest.mark.parametrize(
    ("duration", "torque", "rtol"), [(4e-3, 1.6e-18, 1e-7), (4e-3, 1.6e-18, 1e-9), (0.14, 5.9e-18, 1e-10)]
)
@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_hubs_carry_the_force_of_a_film(backend, duration, torque, rtol):
    """It changes with the acceleration of the gap, and not with the length of the contact.

    Hubs were booked without the one, by 6.4 bounds where the film begins to act, and with the other, by 2.7 where
    pairs come and go.
    """
    tables = {
        **OWN_PAIR,
        "surface": PRESET.to_dict()["surface"],
        "contact": {"bodies": "rigid", "asperity": "hertz"},
        "drive": {"torque": torque},
        "run": {"duration": duration, "samples": "off", "rtol": rtol},
    }
    changes = {
        "mesh.film_damping": 6.4e-6,
        "mesh.film_gap": 3e-8,
        "gears.hub_friction": 0.2,
        "gears.pinion_hub_radius": 3e-6,
        "gears.gear_hub_radius": 6e-6,
        "load.torque": 1e-21,
    }
    balance = solve(gd.Scene.from_dict(tables).replace({**TEETH_27_50, **changes}), backend=backend).balance
    assert balance.film_loss > 0.02 * balance.drive_work
    assert balance.pinion_hub_loss > 0.01 * balance.drive_work
    assert abs(balance.residual) <= 0.1 * balance.bound(rtol, roller=False)


def test_a_film_needs_a_height():
    with pytest.raises(gd.SceneError, match="film_gap"):
        PRESET.replace({"mesh.film_damping": 1e-5})
