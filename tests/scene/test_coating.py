"""The materials of an interface: shares, works of adhesion and gaps of patches and of independent sides."""

import math

import pytest

import gearidae as gd
from gearidae.errors import SceneError

LOW = gd.preset("teodorescu2009_low_speed")


def independent(first, second, **more):
    keys = {"pairing": "independent", "pinion_fraction": first, "gear_fraction": second, **more}
    return LOW.replace({f"coating.{key}": value for key, value in keys.items()})


def test_independent_sides_make_three_materials():
    materials = {one.name: one for one in independent(0.3, 0.6, thickness="2.5 nm").materials()}
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
    assert [one.share for one in independent(0.3, 0.6).materials()] == pytest.approx(
        [one.share for one in independent(0.6, 0.3).materials()], rel=1e-15
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
