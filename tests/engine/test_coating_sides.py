"""Interfaces of three materials with gaps of their own: limits, checked numbers, energy, both drivers, both bodies."""

import json

import numpy as np
import pytest
from scipy.integrate import quad

import gearidae as gd
from balances import assert_closes
from gearidae.asperities import law_of
from gearidae.asperities.jkr import JOINING
from gearidae.contact import asperity_of
from gearidae.contact.kernels.energy import loading_pieces
from gearidae.contact.kernels.evaluate import loading_value
from gearidae.contact.psi import psi
from gearidae.engine import solve

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": "off"})
SHORT = LOW.replace({"initial.mesh_phase": 0.6, "run.duration": "15 ms", "run.samples": 31})
ROLLER = gd.preset("roller_slow").replace({"contact.bodies": "rigid", "run.samples": 2, "run.rtol": 1e-9})


def coated(scene, first, second, **more):
    keys = {"pairing": "independent", "pinion_fraction": first, "gear_fraction": second, **more}
    return scene.replace({f"coating.{key}": value for key, value in keys.items()})


# -- the checked numbers ---------------------------------------------------------------------------------------------


def lowest_speed(scene):
    run = gd.simulate(scene)
    balance = run.gearidae.energy_balance
    assert abs(balance["residual"]) <= balance["residual_bound"]
    return float(run.min_gear_speed)


def test_worn_gears_with_independent_sides_dip_less():
    """Smallest speed at f1 = f2 = 0.5 of an independent program: 1.4846 rad/s, all four digits of it."""
    speed = lowest_speed(LOW.replace({"coating.sam_fraction": 0.5, "coating.pairing": "independent"}))
    assert speed == pytest.approx(1.4846, abs=5e-5)


@pytest.mark.parametrize("pairing", ["patches", "independent"])
def test_with_a_thickness_nothing_sticks_at_half(pairing):
    changes = {"coating.sam_fraction": 0.5, "coating.thickness": "2.5 nm", "coating.pairing": pairing}
    assert (
        lowest_speed(LOW.replace(changes)) > 1.45
    )  # patches without a thickness dip to 0.72 and stick at 0.312 s


# -- limits ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fraction", [0.0, 1.0])
def test_whole_and_bare_sides_are_the_patches(fraction):
    """One material alone, whichever way the flanks are paired: the same to the last bit."""
    patches = solve(SHORT.replace({"coating.sam_fraction": fraction}))
    sides = solve(coated(SHORT, fraction, fraction))
    for name, values in patches.samples.items():
        np.testing.assert_array_equal(sides.samples[name], values, err_msg=name)


def test_equal_energies_are_one_material():
    """Three materials that are all alike are one: 1e-12 of the speed's swing, far above the rounding of sums."""
    single = solve(SHORT.replace({"coating.sam_fraction": 1.0, "run.rtol": 1e-9}))
    alike = LOW.surface.model_copy(update={"energy": LOW.coating.energy})
    three = solve(coated(SHORT.replace({"surface": alike, "run.rtol": 1e-9}), 0.3, 0.6))
    swing = np.ptp(single.samples["gear_speed"])
    # rounding is amplified by the oscillation of the contact; 1e-9 a step is the tolerance of both
    np.testing.assert_allclose(three.samples["gear_speed"], single.samples["gear_speed"], atol=1e-5 * swing)


@pytest.mark.parametrize("model", ["asperity", "elastic"])
def test_a_bare_recess_is_a_longer_way(model):
    """Without any monolayer a thickness only takes the bodies apart: by 2 t, from where the roller starts."""
    thickness = 2e-9
    base = ROLLER.replace({"contact.model": model, "coating.sam_fraction": 0.0})
    base = base.replace({"run.rtol": 1e-8, "run.duration": 2e-5 if model == "asperity" else 1.5e-5})
    recessed = base.replace({"coating.thickness": thickness})
    longer = base.replace({"roller.height": base.roller.height + 2 * thickness})
    ours, theirs = solve(recessed), solve(longer)
    sigma = base.surface.roughness
    # nodes reach as far in both, but the layout of the deeper contact is not to the bit the same
    closeness = 1e-6 if model == "asperity" else 1e-4
    shifted = ours.samples["height"] + 2 * thickness
    np.testing.assert_allclose(shifted, theirs.samples["height"], atol=closeness * sigma)
    assert ours.balance.adhesion_loss == pytest.approx(theirs.balance.adhesion_loss, rel=1e-3, abs=0)


@pytest.mark.parametrize("offset", [0.4, 2.0, 6.0])
def test_loading_pieces_are_those_of_the_wider_gap(offset):
    """Force and potential of a material with an offset against the law's own table and its integral."""
    law = law_of("jkr", LOW.surface)
    near, _ = loading_pieces(law)
    loading, potential = loading_pieces(law, "line", offset)
    for gap in np.linspace(-7.0, 9.0, 33):
        expected = loading_value(near, 0, gap + offset)
        size = abs(expected[0]) + abs(expected[1])
        value = loading_value(loading, 0, gap)
        # 1e-8 of the force, or of its slope where that changes sign: the stated error at an offset of 6 roughnesses
        assert value == pytest.approx(expected, rel=0, abs=1e-8 * size + 1e-30)
    for gap in (-3.0, 0.3, 4.0):
        work = quad(lambda at: loading_value(loading, 0, at)[0], gap, 13.0, epsabs=0, epsrel=1e-11, limit=200)
        assert loading_value(potential, 0, gap)[0] == pytest.approx(work[0], rel=1e-7, abs=1e-12)


# -- energy ----------------------------------------------------------------------------------------------------------


def tail(y):
    """int_y^inf psi."""
    return quad(psi, y, y + 12.0, epsabs=0, epsrel=1e-10)[0]


def test_an_impact_loses_what_the_asperities_of_all_materials_cost():
    """N L sqrt(2 R sigma) 0.9355 Pc dc times Psi at the deepest gap of each material, by its share."""
    scene = coated(ROLLER, 0.4, 0.7, thickness=1e-9).replace({"run.duration": 3e-5, "run.samples": 40_001})
    run = solve(scene)
    balance = assert_closes(scene, run)
    surface, roller = scene.surface, scene.roller
    count = surface.asperity_density * roller.width * np.sqrt(2 * roller.radius * surface.roughness)
    lost = 0.0
    for material, share, offset, _ in scene.materials():
        tip = asperity_of(material)
        deepest = (run.samples["height"].min() + offset) / surface.roughness
        lost += share * count * JOINING * tip.pull_off * tip.stretch_limit * tail(deepest)
    # the lowest sample lies near a turning point, so that its error enters squared
    assert balance.adhesion_loss == pytest.approx(lost, rel=2e-6, abs=0)
    assert -balance.kinetic_change == pytest.approx(lost, rel=2e-6, abs=0)


@pytest.mark.parametrize(
    ("changes", "backend"),
    [
        ({"contact.asperity": "dmt"}, "auto"),
        ({"contact.asperity": "hertz"}, "auto"),
        ({"run.method": "bdf"}, "auto"),
    ],
)
def test_energy_closes_with_every_law_driver_and_body(changes, backend):
    scene = coated(SHORT, 1.0, 0.5, thickness="1 nm").replace(changes)
    balance = assert_closes(scene, solve(scene, backend=backend))
    if scene.contact.asperity in ("jkr", "maugis"):
        assert balance.adhesion_loss > 0.0


# -- cut and continued -----------------------------------------------------------------------------------------------


def test_a_run_that_goes_on_is_the_whole_run():
    whole = coated(SHORT, 0.3, 0.5, thickness="1 nm")
    first = gd.simulate(whole.replace({"run.duration": "6 ms"}))
    rest = gd.simulate(whole.replace({"run.duration": "9 ms"}), start=first)
    expected = gd.simulate(whole.replace({"run.checkpoints": ["6 ms"]}))
    assert rest.gear_speed[-1].item() == pytest.approx(expected.gear_speed[-1].item(), rel=1e-12)


def test_another_thickness_and_pairing_may_go_on():
    """What the contacts store changes with the materials, and is booked; the rest closes."""
    first = gd.simulate(SHORT.replace({"coating.sam_fraction": 0.5, "run.duration": "6 ms"}))
    rest = gd.simulate(coated(SHORT, 0.3, 0.5, thickness="1 nm"), start=first)
    balance = rest.gearidae.energy_balance
    assert balance["model_change"] != 0.0
    assert abs(balance["residual"]) <= balance["residual_bound"]


# -- what is reported ------------------------------------------------------------------------------------------------


def test_estimates_count_every_material_at_its_own_gap():
    """The resting gap carries the load by the readable law of each material."""
    from gearidae.contact.line import line_force
    from gearidae.mesh.pair_contact import pair_contact
    from gearidae.runs.equilibrium import pair_law

    scene = coated(LOW, 0.3, 0.5, thickness="1 nm")
    contact = pair_contact(scene)
    load = scene.drive.torque / scene.gears.pinion_base_radius
    gap = contact.resting_gap(load)
    force = sum(
        share * float(line_force(gap + offset, 0.0, contact.radius, contact.width, surface))
        for surface, share, offset, _ in scene.materials()
    )
    assert force == pytest.approx(load, rel=1e-9, abs=0)
    assert pair_law(scene)(gap, gap, contact.radius) == pytest.approx(load, rel=1e-7, abs=0)


def test_the_dataset_names_the_mixed_material():
    ds = gd.simulate(coated(SHORT, 0.3, 0.5).replace({"run.duration": "1 ms"}))
    bare, whole = ds.attrs["tabor_parameter_bare"], ds.attrs["tabor_parameter_coated"]
    # mu goes as the 2/3 power of the work of adhesion, whose geometric mean the mixed material has
    assert ds.attrs["tabor_parameter_mixed"] == pytest.approx(np.sqrt(bare * whole), rel=1e-12)
    assert json.loads(ds.attrs["scene"])["coating"]["pairing"] == "independent"
