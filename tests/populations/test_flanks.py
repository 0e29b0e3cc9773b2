"""Asperities of each flank: drawn as the recipe says, or listed; and what covers them."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.populations.flanks import flanks_digest, flanks_of
from gearidae.populations.materials import along_path, materials_at
from gearidae.scene import MATERIAL_NAMES, preset
from gearidae.scene.coating_table import fraction_at
from gearidae.scene.strip import flank_strip
from reference.population import NUMBERS

GEARS = preset("teodorescu2009").replace({"contact.roughness": "discrete"})
ROLLER = preset("roller_slow").replace({"contact.roughness": "discrete"})


def test_the_preset_s_surface_is_the_one_that_a_prototype_drew():
    expected, flanks = NUMBERS["drawing_seed_0"], flanks_of(GEARS)
    counts = [flank.arc.size for flank in flanks]
    assert counts[:6] == expected["counts"]
    assert sum(counts) == expected["total"]
    first = flanks[0]
    np.testing.assert_allclose(first.arc[:3], np.array(expected["first_arc_um"]) * 1e-6, rtol=1e-14)
    np.testing.assert_allclose(first.height[:3], np.array(expected["first_height_nm"]) * 1e-9, rtol=1e-14)
    np.testing.assert_allclose(first.q[:3], expected["first_q"], rtol=1e-14)
    highest = [flank.height.max() * 1e9 for flank in flanks[:6]]
    np.testing.assert_allclose(highest, expected["highest_nm"], rtol=1e-14)


def test_flanks_do_not_depend_on_coverage_or_torque_but_on_the_seed():
    other = GEARS.replace({"coating.sam_fraction": 0.3, "drive.torque": 1e-12})
    digest = flanks_digest(flanks_of(GEARS))
    assert flanks_digest(flanks_of(other)) == digest
    assert flanks_digest(flanks_of(GEARS.replace({"contact.seed": 1}))) != digest


def test_a_rougher_surface_has_a_longer_strip():
    """1 um is enough for the preset; four times the roughness needs twice the reach sqrt(2 R z)."""
    low, high = flank_strip(GEARS)
    path = np.array([6.934453944348284e-08, 6.655528073827888e-06])  # of the prototype
    np.testing.assert_allclose([low, high], path + np.array([-1e-6, 1e-6]), rtol=1e-12)
    rough = flank_strip(GEARS.replace({"surface.roughness": 24e-9}))
    reach = np.sqrt(2.0 * NUMBERS["geometry"]["R_end"] * 5.0 * 24e-9)
    assert path[0] - rough[0] >= reach > 1e-6
    assert rough[1] - path[1] == pytest.approx(path[0] - rough[0], rel=1e-9, abs=0)


def test_radii_are_lognormal_about_their_mean():
    radii = np.concatenate(
        [flank.radius for flank in flanks_of(GEARS.replace({"contact.radius_spread": 0.3}))]
    )
    mean, error = 450e-9, 0.3 / np.sqrt(radii.size)  # standard error over the mean
    assert abs(radii.mean() / mean - 1.0) < 4.0 * error
    assert abs(radii.std() / (0.3 * mean) - 1.0) < 0.02  # a heavy tail: 4 standard errors by the kurtosis
    assert abs(np.log(radii).std() - np.sqrt(np.log1p(0.09))) < 4.0 * 0.3 / np.sqrt(2.0 * radii.size)


def test_independent_sides_draw_a_second_number_and_leave_the_rest():
    patches, sides = flanks_of(GEARS)[3], flanks_of(GEARS.replace({"coating.pairing": "independent"}))[3]
    for name in ("arc", "height", "q"):
        assert np.array_equal(getattr(patches, name), getattr(sides, name))
    assert not np.array_equal(sides.q, sides.q2)
    scene = GEARS.replace(
        {"coating.pairing": "independent", "coating.pinion_fraction": 0.6, "coating.gear_fraction": 0.3}
    )
    names = np.array(MATERIAL_NAMES)[materials_at(scene, sides, 3)]
    wanted = np.where(
        sides.q < 0.6, np.where(sides.q2 < 0.3, "coated", "mixed"), np.where(sides.q2 < 0.3, "mixed", "bare")
    )
    assert (names == wanted).all()
    assert len(set(names)) == 3


def test_a_table_is_read_at_the_place_of_each_asperity():
    table = [[0.0, 1.0, 0.25]]
    scene = GEARS.replace({"coating.pinion_table": table})
    flank = flanks_of(scene)[0]
    g = scene.geometry
    place = np.sqrt(2.0 * g.base_radius_pinion * np.maximum(flank.arc, 0.0)) - g.tangent_pinion + g.approach
    place = np.clip(place / g.path_length, 0.0, 1.0)
    np.testing.assert_allclose(along_path(scene, flank), place, rtol=1e-12)
    coated = gd.population(scene).coated.values[: flank.arc.size]
    assert np.array_equal(coated, flank.q < fraction_at(table, 0, place))


def test_a_list_stands_on_the_flanks_that_it_names():
    listed = {"arc": [2e-6, 1e-6, 3e-6], "height": [1e-8, 2e-8, 3e-8], "tooth": [None, 4, None]}
    scene = GEARS.replace(
        {"contact.asperities": {**listed, "flank": [None, None, "coast"], "radius": [None, 1e-7, None]}}
    )
    flanks = {(flank.tooth, flank.flank): flank for flank in flanks_of(scene)}
    assert flanks[0, 0].arc.tolist() == [2e-6]
    assert flanks[4, 0].arc.tolist() == [1e-6, 2e-6]
    assert flanks[4, 1].height.tolist() == [2e-8, 1e-8, 3e-8]
    assert flanks[4, 0].radius.tolist() == [1e-7, 450e-9]
    assert gd.population(scene).sizes["asperity"] == 2 * 19 + 19 + 2
    with pytest.raises(gd.SceneError, match=r"radius_spread.*must be 0"):
        scene.replace({"contact.radius_spread": 0.1})


def test_a_roller_has_one_flank_about_its_middle():
    (flank,) = flanks_of(ROLLER)
    assert -1e-6 <= flank.arc[0] < -0.9e-6 < 0.9e-6 < flank.arc[-1] <= 1e-6
    assert abs(flank.arc.size - 1.69e14 * 2e-6 * 2e-6) < 4.0 * np.sqrt(676.0)
    assert "x" in gd.population(ROLLER)


def test_other_models_have_no_asperities():
    with pytest.raises(gd.SceneError, match=r"contact.roughness = statistical: must be discrete"):
        gd.population(preset("teodorescu2009"))


def test_more_asperities_than_can_be_kept_are_refused():
    with pytest.raises(gd.SceneError, match=r"asperity_density.*5e\+06 at most"):
        GEARS.replace({"surface.asperity_density": 1e17})
