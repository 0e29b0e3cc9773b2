"""Attraction across the gap in runs: closed forms, both flanks, the materials' shares, and the energy balance."""

import math

import numpy as np
import pytest
from scipy.integrate import simpson

import gearidae as gd
from gearidae.contact import attraction_energy, attraction_force, line_force
from gearidae.mesh.involute import curvature_radii
from gearidae.runs.plausibility import doubts

HAMAKER = 5e-20
ROLLER = gd.preset("roller_slow").replace(
    {
        "surface.hamaker": HAMAKER,
        "surface.roughness": "1 nm",
        "contact.bodies": "rigid",
        "roller.height": "60 nm",
        "roller.mass": 1e-14,
        "run.duration": 2.1e-6,
        "run.samples": 201,
        "run.rtol": 1e-9,
    }
)
GEARS = gd.preset("teodorescu2009").replace(
    {
        "surface.hamaker": HAMAKER,
        "coating.hamaker": 2e-20,
        "coating.sam_fraction": 0.6,
        "coating.thickness": "1 nm",
        "coating.pairing": "independent",
        "mesh.radius_force": True,
        "contact.bodies": "rigid",
        "run.samples": 51,
    }
)
TABLE = [[1.0, 0.4, 0.8]] + [[0.5, 0.9, 0.3]] * 18


def balance(ds):
    energies = ds.gearidae.energy_balance
    assert abs(energies["residual"]) <= energies["residual_bound"]
    return energies


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("model", ["asperity", "population"])
def test_a_roller_that_falls_towards_a_plane(backend, model):
    """Beyond the asperities force and energy of motion are closed forms; 30 nm are 30 roughnesses, where none touch.

    The energy of motion doubles on the way, and a run at 1e-9 keeps it to 1e-7.
    """
    scene = ROLLER.replace({"contact.model": model})
    ds = gd.simulate(scene, backend=backend)
    far = ds.height.values > 30e-9
    assert np.count_nonzero(far) > 190
    pair = (scene.roller.radius, scene.roller.width, HAMAKER)
    height, speed = ds.height.values[far], ds.speed.values[far]
    np.testing.assert_allclose(ds.force.values[far], attraction_force(height, *pair), rtol=1e-10)
    stored = attraction_energy(height, *pair)
    energy = 0.5 * scene.roller.mass * speed**2 + stored
    assert np.ptp(energy) < 1e-6 * np.ptp(stored)
    assert np.ptp(stored) > 1e-19
    balance(ds)


def pairs_of(scene, phase, u):
    """Gap and reduced radius of every pair of both flanks, ten on either side, from the gears' geometry."""
    geometry, b, rho = scene.geometry, 0.5 * scene.mesh.backlash, scene.mesh.tip_relief_radius
    for number in range(-10, 11):
        place = (phase - number) * geometry.base_pitch
        mirrored = 2.0 * geometry.approach + (0.5 + number - phase) * geometry.base_pitch
        for sign, along in ((1, place), (-1, mirrored)):
            inside = min(max(along, 0.0), geometry.path_length)
            gap = b - sign * u + (along - inside) ** 2 / (2.0 * rho)
            yield gap, float(curvature_radii(geometry, inside)[2])


def energy_of(scene, phase, u):
    return sum(
        part.share
        * float(
            attraction_energy(gap + part.gap_offset, radius, scene.gears.face_width, part.surface.hamaker)
        )
        for gap, radius in pairs_of(scene, phase, u)
        for part in scene.materials()
    )


@pytest.mark.parametrize("model", ["asperity", "population"])
@pytest.mark.parametrize("phase", [0.3, 0.8])
def test_gears_apart_are_pulled_by_both_flanks_and_along_the_path(model, phase):
    """Forces at the start are slopes of the sum of all pairs' energies in u and in the phase at fixed u.

    Gears leave out what is below 1e-6 of the load for each pair: here, at a millionth of the preset's torque, of 15 pN
    less than 1e-7. The forces are differences of energies, to 1e-5.
    """
    scene = GEARS.replace(
        {
            "contact.model": model,
            "contact.asperity": "hertz",
            "surface.asperity_density": "1 / um^2",
            "initial.gap": "60 nm",
            "initial.mesh_phase": phase,
            "initial.gear_speed": 0.0,
            "drive": {"torque": 2.43e-17},
            "load": {},
            "run.duration": 1e-9,
            "run.samples": 2,
        }
    )
    ds = gd.simulate(scene)
    u, pitch = float(ds.transmission_error[0]), scene.geometry.base_pitch
    force = float(ds.mesh_force[0])
    step = 1e-12
    slope = (energy_of(scene, phase, u + step) - energy_of(scene, phase, u - step)) / (2.0 * step)
    assert force == pytest.approx(slope, rel=2e-5, abs=0)
    along = float(ds.gear_contact_torque[0]) / scene.geometry.base_radius_gear - force
    ahead, behind = (energy_of(scene, phase + way, u) for way in (1e-6, -1e-6))
    expected = -(ahead - behind) / (2e-6 * pitch)
    assert along == pytest.approx(expected, rel=2e-4, abs=0)
    assert abs(along) > 1e-5 * abs(force)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"mesh.radius_force": False},
        {"coating.pinion_table": TABLE},
        {"coating.pairing": "patches", "contact.asperity": "maugis"},
        {"contact.roughness": "discrete"},
        {"contact.roughness": "discrete", "coating.pinion_table": TABLE, "mesh.damping": 7e-6},
    ],
)
def test_energy_is_kept(changes):
    """To what the balance allows itself, and to 1e-5 of what the attraction stores where nothing is lost at random."""
    scene = GEARS.replace({"run.duration": 5e-5, "run.rtol": 1e-7} | changes)
    energies = balance(gd.simulate(scene))
    assert abs(energies["residual"]) < 1e-7 * energies["throughput"]


def test_nothing_changes_where_no_material_has_a_constant():
    """Not a bit: a constant of a material that the flanks do not have is none."""
    bare = GEARS.replace(
        {
            "coating.pairing": "patches",
            "coating.sam_fraction": 1.0,
            "coating.hamaker": 0.0,
            "run.duration": 2e-5,
        }
    )
    without, beside = (gd.simulate(bare.replace({"surface.hamaker": value})) for value in (0.0, HAMAKER))
    assert not bare.attracts
    for name in ("gear_speed", "mesh_force", "event_time"):
        np.testing.assert_array_equal(without[name].values, beside[name].values)


def test_estimates_have_it_too():
    """The static law of a pair and the drawn teeth pull as the run does."""
    scene = GEARS.replace({"coating.thickness": 0.0, "coating.hamaker": HAMAKER})
    from gearidae.mesh.pair_contact import pair_contact
    from gearidae.runs.equilibrium import pair_law

    contact = pair_contact(scene)
    gap = 60e-9  # ten roughnesses
    pull = float(attraction_force(gap, contact.radius, contact.width, HAMAKER))
    assert float(contact.force(gap)) == pytest.approx(pull, rel=1e-10, abs=0)
    assert pair_law(scene)(gap, gap, contact.radius) == pytest.approx(pull, rel=1e-10, abs=0)


@pytest.mark.parametrize("model", ["asperity", "population"])
def test_forces_of_teeth_add_up_to_the_recorded_one(model):
    """To what is left out beyond 1e-6 of the load, for each of some ten pairs."""
    scene = GEARS.replace(
        {"contact.model": model, "run.duration": 5e-5, "coating.pinion_table": TABLE, "run.samples": 5001}
    )
    states = gd.studies.tooth_contacts(gd.simulate(scene), [1e-5, 2e-5, 4e-5])
    load = scene.drive.torque / scene.gears.pinion_base_radius
    for state in states:
        forces = sum(contact.force * (1 - 2 * contact.flank) for contact in state.contacts)
        assert abs(forces - state.mesh_force) < 1e-12 * load
    pulls = [contact.force for state in states for contact in state.contacts if contact.force < 0.0]
    assert min(pulls) < -1e-12


def test_elastic_bodies_are_refused_and_auto_says_that_they_stay_rigid():
    with pytest.raises(gd.SceneError, match=r"contact\.bodies = elastic: cannot be combined with attraction"):
        GEARS.replace({"contact.bodies": "elastic"})
    assert any(
        "keeps the teeth rigid" in words for words in doubts(GEARS.replace({"contact.bodies": "auto"}))
    )
    assert not doubts(GEARS)


def test_a_pull_that_reaches_too_many_teeth_is_refused():
    weak = gd.preset("teodorescu2009_low_speed").replace(
        {
            "surface.hamaker": 1e-17,
            "coating.sam_fraction": 0.0,
            "contact.bodies": "rigid",
            "drive.torque": 1e-22,
            "load.drag": 0.0,
        }
    )
    with pytest.raises(
        gd.SceneError, match=r"surface\.hamaker = 1e-17: attraction is felt .* away"
    ) as caught:
        gd.simulate(weak)
    assert caught.value.key == "surface.hamaker"
    assert math.isfinite(caught.value.value)


@pytest.mark.parametrize("model", ["asperity", "population"])
def test_a_run_goes_on_with_another_constant_and_books_the_change(model):
    """What is stored more is the closed form of all pairs, but for what they would store at the cut-off: 5 %."""
    changes = {"run.duration": 2e-5, "run.samples": 21, "coating.sam_fraction": 1.0, "coating.thickness": 0.0}
    scene = GEARS.replace({"contact.model": model} | changes)
    first = gd.simulate(scene)
    more = scene.replace({"coating.hamaker": 7e-20})
    energies = balance(gd.simulate(more, start=first))
    turned = float(first.gear_angle[-1]) * scene.geometry.base_radius_gear / scene.geometry.base_pitch
    phase = scene.initial.mesh_phase + turned
    stored = 2.5 * energy_of(scene, phase, float(first.transmission_error[-1]))
    assert energies["model_change"] == pytest.approx(stored, rel=0.06, abs=0)
    assert abs(energies["residual"]) < 0.1 * abs(stored)


# -- with friction ---------------------------------------------------------------------------------------------------


def friction_power(scene, ds):
    """Power of the flanks' friction at every sample, from gaps, law of the contact and sliding speeds."""
    geometry, gears = scene.geometry, scene.gears
    pitch, path = geometry.base_pitch, geometry.path_length
    along = scene.initial.mesh_phase * pitch + ds.gear_angle.values * geometry.base_radius_gear
    u, power = ds.transmission_error.values, np.zeros(ds.time.size)
    for number in range(-3, 4):
        for sign, place in (
            (1.0, along - number * pitch),
            (-1.0, 2.0 * geometry.approach + (0.5 + number) * pitch - along),
        ):
            inside = np.clip(place, 0.0, path)
            relief = (place - inside) ** 2 / (2.0 * scene.mesh.tip_relief_radius)
            gap = 0.5 * scene.mesh.backlash - sign * u + relief
            near = np.flatnonzero(gap < 8.0 * scene.surface.roughness)
            r1 = geometry.tangent_pinion - geometry.approach + inside
            r2 = geometry.tangent_pinion + geometry.tangent_gear - r1
            slide = r1 * ds.pinion_speed.values - r2 * ds.gear_speed.values
            for part in np.array_split(near, max(near.size // 2000, 1)):
                load = line_force(
                    gap[part],
                    0.0,
                    pitch,
                    gears.face_width,
                    scene.coated_surface,
                    asperity=scene.contact.asperity,
                )
                load = load * np.sqrt(r1[part] * r2[part] / (r1[part] + r2[part]) / pitch)
                power[part] += scene.contact.friction * np.maximum(load, 0.0) * np.abs(slide[part])
    return power


def test_friction_of_a_coated_pair_that_attracts_acts_on_its_contacts_alone():
    """Work of friction by Simpson's rule from dense samples; asperities without memory, so that gaps are enough.

    To 1e-6: the run keeps 1e-9, and between samples the power bends at reversals only.
    """
    scene = gd.preset("teodorescu2009").replace(
        {
            "coating.hamaker": 5e-20,
            "contact.bodies": "rigid",
            "contact.asperity": "dmt",
            "contact.friction": 0.1,
            "initial.gap": 1.5e-8,
            "run.duration": 5e-6,
            "run.samples": 40_001,
            "run.rtol": 1e-10,
        }
    )
    ds = gd.simulate(scene)
    energies = balance(ds)
    loss = energies["drive_friction_loss"] + energies["coast_friction_loss"]
    assert loss == pytest.approx(simpson(friction_power(scene, ds), x=ds.time.values), rel=1e-6, abs=0)
    without = gd.simulate(scene.replace({"coating.hamaker": 0.0})).gearidae.energy_balance
    assert loss != pytest.approx(
        without["drive_friction_loss"] + without["coast_friction_loss"], rel=1e-4, abs=0
    )
