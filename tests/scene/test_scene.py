"""Scenes as values: replaced, compared, hashed, pickled, written and read back."""

import copy
import json
import math
import pickle
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearidae.scene import MATERIAL_NAMES, Contact, Harmonic, Scene, dump_case, load_case, preset


def small(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_subnormal=False)


def sized(low: float, high: float, least: float) -> st.SearchStrategy[float]:
    """Numbers of at least some size, and zeros of both signs."""
    return small(low, high).map(lambda x: x if abs(x) >= least else math.copysign(0.0, x))


def apart(times: list[float]) -> bool:
    """Whether knots are far enough apart for steps between them."""
    return all(after - before >= 1e-12 * after for before, after in pairwise(times))


def harmonics() -> st.SearchStrategy[list[dict[str, float]]]:
    table = st.fixed_dictionaries(
        {"amplitude": sized(-1e-10, 1e-10, 1e-40), "frequency": small(0, 1e6), "phase": small(-10, 10)}
    )
    return st.lists(table, max_size=2)


def schedules() -> st.SearchStrategy[list[list[float]]]:
    times = st.lists(sized(0, 1, 1e-20), min_size=1, max_size=4, unique=True).map(sorted).filter(apart)
    return times.flatmap(
        lambda t: st.lists(sized(-1e-10, 1e-10, 1e-40), min_size=len(t), max_size=len(t)).map(
            lambda v: [list(pair) for pair in zip(t, v, strict=True)]
        )
    )


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """Valid scenes of awkward floats."""
    changes: dict[str, Any] = {
        "name": draw(st.text(st.characters(categories=("L", "N", "P", "S")), min_size=1, max_size=20)),
        "surface.youngs_modulus": draw(small(1e9, 1e12)),
        "surface.poisson_ratio": draw(small(-0.9, 0.49)),
        "surface.energy": draw(sized(0, 10, 1e-15)),
        "surface.asperity_density": draw(small(1e10, 1e18)),
        "surface.asperity_radius": draw(small(1e-9, 1e-6)),
        "surface.roughness": draw(small(1e-9, 1e-8)),
        "coating.sam_fraction": draw(small(0, 1)),
        "contact": {"bodies": draw(st.sampled_from(["auto", "rigid", "elastic"])), "asperity": "dmt"},
        "run.duration": draw(small(1e-9, 1)),
        "run.samples": draw(st.integers(2, 10**6)),
        "run.rtol": draw(small(1e-12, 0.1)),
    }
    if draw(st.booleans()):
        return preset("roller_slow").replace(
            {**changes, "roller.radius": draw(small(1e-9, 1e-3)), "roller.mass": draw(small(1e-15, 1))}
        )
    changes |= {
        "gears.pinion_inertia": draw(small(1e-25, 1e-15)),
        "gears.pinion_base_radius": draw(small(1e-5, 1e-4)),
        "gears.pressure_angle": draw(small(math.radians(20), math.radians(25))),
        "mesh.static_error": [{"order": 2, "amplitude": draw(small(-1e-9, 1e-9))}],
        "drive.harmonic": draw(harmonics()),
        "load.harmonic": draw(harmonics()),
        "initial.gap": draw(sized(0, 1e-7, 1e-22)),
        "initial.gear_speed": draw(sized(-1e4, 1e4, 1e-30)),
    }
    if draw(st.booleans()):
        changes["drive.schedule"] = draw(schedules())
    return preset("teodorescu2009").replace(changes)


def assert_same_bits(first: Any, second: Any) -> None:
    """Equality calls 0.0 and -0.0 the same; their texts differ."""
    assert first == second
    assert json.dumps(first) == json.dumps(second)


@given(scenes())
@settings(max_examples=60)
def test_round_trip_through_json_is_exact(scene: Scene) -> None:
    again = Scene.from_dict(json.loads(json.dumps(scene.to_dict())))
    assert again == scene
    assert hash(again) == hash(scene)
    assert_same_bits(again.to_dict(), scene.to_dict())


@given(scene=scenes())
@settings(max_examples=60)
def test_round_trip_through_a_case_file_is_exact(
    scene: Scene, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "scene.toml"
    path.write_text(dump_case(scene), encoding="utf-8")
    again = load_case(path)
    assert again == scene
    assert_same_bits(again.to_dict(), scene.to_dict())


@given(scenes())
@settings(max_examples=20)
def test_copies_are_equal(scene: Scene) -> None:
    for again in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene), scene.replace({})):
        assert again == scene
        assert hash(again) == hash(scene)


def test_case_files_carry_units_and_comments(gears: Scene) -> None:
    text = dump_case(gears)
    assert 'pinion_base_radius = "34.715 um"' in text
    assert 'pressure_angle = "20 deg"' in text
    assert 'asperity_density = "169 1/um^2"' in text
    assert "# rms height of the asperities, sigma" in text


def test_schedules_are_written(gears: Scene, tmp_path: Path) -> None:
    scene = gears.replace({"drive.schedule": [["0 ms", 0], ["1 ms", "1 pN*m"]], "drive.harmonic": []})
    path = tmp_path / "scene.toml"
    path.write_text(dump_case(scene))
    assert load_case(path).drive == scene.drive


def test_values_are_si_floats(gears: Scene) -> None:
    scene = gears.replace(
        {
            "drive.harmonic": {"amplitude": "3 pN m", "frequency": "10 kHz", "phase": "90 deg"},
            "drive.schedule": np.array([[0, 0], [1e-3, 1e-11]]),
            "load.schedule": (("1 us", 0), ("2 us", "1e-12 N m")),
            "mesh.static_error": {"order": 1, "amplitude": "2 nm", "phase": 1},
            "gears.pinion_teeth": np.int64(20),
            "gears.face_width": np.float32(0.5),
            "run.samples": 1e4,
        }
    )
    assert scene.drive is not None
    assert scene.load is not None
    assert scene.mesh is not None
    assert scene.gears is not None
    assert scene.drive.harmonic == (Harmonic(amplitude=3e-12, frequency=1e4, phase=math.pi / 2),)
    assert scene.drive.schedule == ((0.0, 0.0), (1e-3, 1e-11))
    assert scene.load.schedule == ((1e-6, 0.0), (2e-6, 1e-12))
    assert scene.mesh.static_error[0].amplitude == 2e-9
    assert type(scene.mesh.static_error[0].phase) is float
    assert type(scene.gears.pinion_teeth) is int
    assert type(scene.gears.face_width) is float
    assert scene.run.samples == 10_000


def test_replace_leaves_the_original_alone(gears: Scene) -> None:
    worn = gears.replace({"coating.sam_fraction": 0.5})
    assert (worn.coating.sam_fraction, gears.coating.sam_fraction) == (0.5, 1.0)
    assert worn != gears
    assert worn.replace({"coating.sam_fraction": 1}) == gears


def test_replace_reaches_into_lists(gears: Scene) -> None:
    by_number = gears.replace({"drive.harmonic.0.amplitude": 1e-12})
    assert by_number.drive is not None
    assert by_number.drive.harmonic[0].amplitude == 1e-12
    assert gears.replace({"drive.harmonic.amplitude": 1e-12}) == by_number
    scheduled = gears.replace({"drive.schedule": [[0, 0], [1, 1e-12]], "drive.schedule.1.0": 2})
    assert scheduled.drive is not None
    assert scheduled.drive.schedule == ((0.0, 0.0), (2.0, 1e-12))
    two = gears.replace({"drive.harmonic": [{"amplitude": a, "frequency": 1} for a in (1e-12, 2e-12)]})
    second = two.replace({"drive.harmonic.1.amplitude": 0}).drive
    assert second is not None
    assert [harmonic.amplitude for harmonic in second.harmonic] == [1e-12, 0.0]


@pytest.mark.parametrize("nothing", [None, [], (), np.empty((0, 2))])
def test_replace_takes_schedules_and_harmonics_away(gears: Scene, nothing: object) -> None:
    scheduled = gears.replace({"drive.schedule": [[0, 0], [1, 1e-12]], "load.schedule": [[0, 0]]})
    assert scheduled != gears
    assert scheduled.replace({"drive.schedule": nothing, "load.schedule": nothing}) == gears
    assert gears.replace({"drive.schedule": nothing}) == gears  # there was none
    idle = gears.replace({"drive.harmonic": nothing}).drive
    assert idle is not None
    assert idle.harmonic == ()


def test_replace_takes_whole_tables(gears: Scene, roller: Scene) -> None:
    assert gears.replace({"contact": Contact(bodies="rigid")}).contact.bodies == "rigid"
    assert gears.replace({"contact": {"asperity": "dmt"}}).contact == Contact(asperity="dmt")
    tables = {"gears": None, "mesh": None, "drive": None, "load": None, "initial": None}
    as_roller = gears.replace({**tables, "roller": roller.roller})
    assert as_roller.roller == roller.roller
    assert as_roller.gears is as_roller.load is None


def test_replace_leaves_what_it_was_given_alone(gears: Scene) -> None:
    drive = {"torque": 1e-11, "harmonic": [{"amplitude": 1e-12, "frequency": 1.0}]}
    gears.replace({"drive": drive, "drive.torque": 0, "drive.harmonic.amplitude": 0})
    assert drive == {"torque": 1e-11, "harmonic": [{"amplitude": 1e-12, "frequency": 1.0}]}


def test_coated_surface_differs_in_energy_and_contact_angle_alone(gears: Scene) -> None:
    coated, bare = gears.coated_surface.model_dump(), gears.surface.model_dump()
    assert (coated.pop("energy"), bare.pop("energy")) == (0.1, 1.5)
    assert (coated.pop("contact_angle"), bare.pop("contact_angle")) == (math.radians(110.0), 0.0)
    assert coated == bare


@pytest.mark.parametrize("fraction", [0.0, 0.3, 1.0])
def test_materials_are_the_bare_and_the_coated_part_of_the_flanks(gears: Scene, fraction: float) -> None:
    scene = gears.replace({"coating.sam_fraction": fraction})
    bare, coated = scene.materials()
    assert MATERIAL_NAMES == ("bare", "coated", "mixed")
    assert (bare.name, coated.name) == ("bare", "coated")
    assert (bare.gap_offset, coated.gap_offset) == (0.0, 0.0)
    assert (bare.surface.energy, coated.surface.energy) == (1.5, 0.1)
    assert (bare.share, coated.share) == (1.0 - fraction, fraction)


def test_defaults(gears: Scene) -> None:
    data = gears.to_dict()
    for table in ("coating", "contact", "load"):
        del data[table]
    scene = Scene.from_dict(data)
    assert scene.coating.sam_fraction == 0  # without a coating the flanks are bare
    assert (scene.contact.bodies, scene.contact.asperity) == ("auto", "jkr")
    assert scene.load is not None
    assert (scene.load.torque, scene.load.drag, scene.load.schedule) == (0, 0, ())


def test_geometry_is_that_of_the_gears(gears: Scene) -> None:
    assert gears.geometry.contact_ratio == pytest.approx(1.681, abs=5e-4)
