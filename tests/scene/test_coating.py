"""The materials of an interface: shares, works of adhesion and gaps of patches and of independent sides."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.errors import SceneError
from gearidae.scene.coating_table import fraction_at

LOW = gd.preset("teodorescu2009_low_speed")


def independent(first, second, **more):
    keys = {"pairing": "independent", "pinion_fraction": first, "gear_fraction": second, **more}
    return LOW.replace({f"coating.{key}": value for key, value in keys.items()})


def test_independent_sides_make_three_materials():
    materials = {
        material.name: material for material in independent(0.3, 0.6, thickness="2.5 nm").materials()
    }
    assert list(materials) == ["bare", "coated", "mixed"]
    shares = [materials[name].share for name in ("coated", "mixed", "bare")]
    assert shares == pytest.approx([0.18, 0.3 * 0.4 + 0.6 * 0.7, 0.28], rel=1e-15)
    assert math.fsum(shares) == pytest.approx(1.0, rel=1e-15)
    assert [materials[name].gap_offset for name in materials] == [5e-9, 0.0, 2.5e-9]
    assert materials["mixed"].surface.energy == pytest.approx(math.sqrt(1.5 * 0.1), rel=1e-15)
    assert (materials["bare"].surface, materials["coated"].surface) == (LOW.surface, LOW.coated_surface)


def test_sides_without_a_fraction_of_their_own_have_that_of_the_scene():
    scene = LOW.replace({"coating.pairing": "independent", "coating.sam_fraction": 0.4})
    assert scene.coating.fractions == (0.4, 0.4)
    assert scene.replace({"coating.gear_fraction": 0.1}).coating.fractions == (0.4, 0.1)
    again = scene.replace({"coating.gear_fraction": 0.1}).replace({"coating.gear_fraction": None})
    assert again == scene


def test_thickness_recesses_bare_patches():
    bare, coated = LOW.replace({"coating.sam_fraction": 0.5, "coating.thickness": "2 nm"}).materials()
    assert (bare.gap_offset, coated.gap_offset) == (4e-9, 0.0)


def test_sides_swapped_are_the_same_interface():
    assert [material.share for material in independent(0.3, 0.6).materials()] == pytest.approx(
        [material.share for material in independent(0.6, 0.3).materials()], rel=1e-15
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pairing": "both"}, r"coating\.pairing = both: must be 'patches' or 'independent'"),
        ({"thickness": -1e-9}, r"coating\.thickness = -1e-09: must lie in 0\.\.1e-06 m"),
        ({"thickness": "2.5 J"}, r"coating\.thickness = 2\.5 J: the unit 'J' does not fit"),
        ({"thickness": "19 nm"}, r"coating\.thickness = 1\.9e-08: must be at most 3 roughnesses, 1\.8e-08 m"),
        (
            {"pairing": "independent", "gear_fraction": 1.1},
            r"coating\.gear_fraction = 1\.1: must lie in 0\.\.1",
        ),
        (
            {"pinion_fraction": 0.5},
            r'coating\.pinion_fraction = 0\.5: needs coating\.pairing = "independent"',
        ),
        ({"gear_fraction": 0.5}, r'coating\.gear_fraction = 0\.5: needs coating\.pairing = "independent"'),
    ],
)
def test_bad_input_names_the_key_and_what_is_allowed(changes, message):
    with pytest.raises(SceneError, match=message):
        LOW.replace({f"coating.{key}": value for key, value in changes.items()})


def test_case_files_hold_the_new_keys(tmp_path):
    scene = independent(0.3, 0.6, thickness="2.5 nm")
    path = tmp_path / "case.toml"
    path.write_text(gd.dump_case(scene))
    assert 'thickness = "2.5 nm"' in path.read_text()
    assert gd.load_case(path) == scene


# -- tables ----------------------------------------------------------------------------------------------------------

RIGID = LOW.replace({"contact.bodies": "rigid"})


def tables(pinion=None, gear=None, **more):
    keys = {"pairing": "independent", "pinion_table": pinion, "gear_table": gear, **more}
    return RIGID.replace({f"coating.{key}": value for key, value in keys.items() if value is not None})


def test_a_table_keeps_to_its_numbers_between_its_places():
    table = [[0.2, 0.8, 0.8, 0.1]]
    middles = (np.arange(4) + 0.5) / 4
    assert fraction_at(table, 0, middles) == pytest.approx(table[0], rel=1e-15)
    assert fraction_at(table, 0, [-1.0, 0.0, 0.1]) == pytest.approx([0.2] * 3)
    assert fraction_at(table, 0, [0.25, 0.75]) == pytest.approx([0.5, 0.45])  # half way, by symmetry
    fine = fraction_at(table, 0, np.linspace(0, 1, 2001))
    assert (fine.min(), fine.max()) == pytest.approx((0.1, 0.8), rel=1e-15)
    # the mean is that of straight lines between the middles: 1.9 / 4 of the numbers; 2001 points give 1e-3
    assert fine.mean() == pytest.approx(1.9 / 4, abs=1e-3)


def test_teeth_go_round():
    table = [[0.1], [0.2], [0.3]]
    assert fraction_at(table, [0, 4, -1], 0.5) == pytest.approx([0.1, 0.2, 0.3])


def test_means_are_over_the_teeth_that_meet():
    """Of 19 and 76 teeth the pinion's tooth i meets the gear's i, i + 19, ...: covered on covered or bare on bare."""
    pinion, gear = np.zeros((19, 1)), np.zeros((76, 1))
    pinion[:10], gear[np.arange(76) % 19 < 10] = 1.0, 1.0
    shares = {material.name: material.share for material in tables(pinion, gear).materials()}
    assert shares == pytest.approx({"coated": 10 / 19, "bare": 9 / 19, "mixed": 0.0}, abs=1e-15)
    gear = 1.0 - gear
    assert {material.name: material.share for material in tables(pinion, gear).materials()}[
        "mixed"
    ] == pytest.approx(1.0)


def test_tables_are_given_in_many_ways_and_kept(tmp_path):
    scene = tables(np.full((19, 2), 0.5), [0.25])
    assert scene.coating.gear_table == ((0.25,),)
    assert scene.coating.fractions == (0.5, 0.25)
    path = tmp_path / "case.toml"
    path.write_text(gd.dump_case(scene))
    assert gd.load_case(path) == scene
    assert gd.Scene.from_dict(scene.to_dict()) == scene
    assert "pinion_table" not in scene.replace({"coating.pinion_table": None}).to_dict()["coating"]


def test_patches_may_have_the_share_of_the_interface_by_the_pinions_tooth():
    scene = RIGID.replace({"coating.pinion_table": [[0.2, 0.6]]})
    assert [(material.name, round(material.share, 12)) for material in scene.materials()] == [
        ("bare", 0.6),
        ("coated", 0.4),
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"pinion_table": [[0.5]] * 18},
            r"coating\.pinion_table = \(18 rows\): must have 19 rows, one for each",
        ),
        ({"gear_table": [[0.5]] * 19}, r"coating\.gear_table = \(19 rows\): must have 76 rows, one for each"),
        (
            {"pinion_table": [[0.5, 0.4], [0.5]]},
            r"coating\.pinion_table = .*: row 2 has 1 places and the first 2",
        ),
        ({"pinion_table": [[0.5] * 65]}, r"coating\.pinion_table = .*: has 65 places; there must be 1\.\.64"),
        ({"pinion_table": [[]]}, r"coating\.pinion_table = .*: has 0 places; there must be 1\.\.64"),
        ({"pinion_table": [[0.5, 1.5]]}, r"coating\.pinion_table\[0\]\[1\] = 1\.5: must lie in 0\.\.1"),
        ({"pinion_table": [[0.5, float("nan")]]}, r"coating\.pinion_table\[0\]\[1\] = nan: must be a finite"),
        ({"gear_table": [[-0.1]]}, r"coating\.gear_table\[0\]\[0\] = -0\.1: must lie in 0\.\.1"),
        ({"pinion_table": 0.5}, r"coating\.pinion_table = 0\.5: must be a list of teeth"),
        (
            {"pinion_table": [[0.5]], "pinion_fraction": 0.5},
            r"coating\.pinion_fraction = 0\.5: cannot be given besid",
        ),
        (
            {"gear_table": [[0.5]], "pairing": "patches"},
            r"coating\.gear_table = .*: needs coating\.pairing = \"indep",
        ),
    ],
)
def test_bad_tables_name_the_key_and_what_is_allowed(changes, message):
    with pytest.raises(SceneError, match=message):
        tables(**changes)


def test_tables_need_gears():
    with pytest.raises(SceneError, match=r"coating\.pinion_table = .*: needs gears: a roller has no teeth"):
        gd.preset("roller_slow").replace({"coating.pinion_table": [[0.5]]})
