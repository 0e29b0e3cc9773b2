"""The paper's numbers, and the list of all keys."""

import math
from pathlib import Path
from typing import Any

import pytest

from gearidae.errors import SceneError
from gearidae.scene import PRESETS, Scene, describe_key, describe_keys, load_case, preset

# Every key that users' scripts rely on.
CASES = Path(__file__).parents[2] / "cases"
CONTRACT = {
    "gears": "density pinion_inertia gear_inertia pinion_base_radius module pinion_teeth gear_teeth pressure_angle "
    "pinion_spring gear_spring pinion_spring_damping gear_spring_damping pinion_spring_play gear_spring_play "
    "face_width hub_friction hub_friction_rise hub_ageing_time hub_memory_length pinion_hub_radius gear_hub_radius "
    "pinion_hub_clearance pinion_hub_adhesion gear_hub_adhesion "
    "pinion_axial_load gear_axial_load pinion_dimple_radius gear_dimple_radius",
    "mesh": "backlash tip_relief_radius radius_force damping film_damping film_gap static_error static_error.order "
    "static_error.amplitude static_error.phase pinion_pitch_error gear_pitch_error pitch_error_rms pitch_error_seed "
    "pinion_runout pinion_runout.amplitude pinion_runout.phase gear_runout gear_runout.amplitude gear_runout.phase "
    "module driver_base_radius pressure_angle face_width",
    "surface": "youngs_modulus poisson_ratio energy asperity_density asperity_radius roughness interaction_range "
    "hamaker provenance humidity contact_angle bridged temperature",
    "coating": "sam_fraction energy hamaker pairing thickness pinion_fraction gear_fraction pinion_table gear_table "
    "friction shear_strength contact_angle",
    "drive": "shaft torque harmonic schedule harmonic.amplitude harmonic.frequency harmonic.order harmonic.phase law "
    "law.name law.parameters orientation pin_friction pin_friction_rise pin_ageing_time pin_memory_length "
    "pin_radius speed speed_gain",
    "load": "shaft torque harmonic drag viscous schedule harmonic.amplitude harmonic.frequency harmonic.order "
    "harmonic.phase law law.name law.parameters",
    "initial": "gear_speed gap mesh_phase rest_time",
    "run": "judged asperity_events balance impacts passages exposures duration samples rtol method stop checkpoints "
    "largest_step",
    "roller": "radius mass width speed height",
    "contact": "model bodies roughness asperity seed radius_spread asperities friction friction_law shear_strength",
}

SHAFT = (
    "inertia density teeth gears gears.NAME hub_friction hub_friction_rise hub_ageing_time hub_memory_length "
    "hub_radius hub_adhesion axial_load dimple_radius resistance viscous drag"
)
MESH = "driver driven angle phase offset coating surface contact contact.seed contact.radius_spread contact.asperities"


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_valid_and_bear_their_name(name: str) -> None:
    assert preset(name).name == name


@pytest.mark.parametrize("name", ["teodorescu", "", None, 5, [], "roller"])
def test_unknown_presets(name: Any) -> None:
    with pytest.raises(SceneError, match="known are teodorescu2009, teodorescu2009_low_speed, roller_slow"):
        preset(name)


def test_high_speed_starts_in_its_steady_state() -> None:
    """M10 = (R1/R2) (M20 + alpha w^2), to the four digits that the speed is given with."""
    scene = preset("teodorescu2009")
    assert scene.drive is not None
    assert scene.load is not None
    assert scene.initial is not None
    at_gear = scene.drive.torque * scene.geometry.base_radius_gear / scene.geometry.base_radius_pinion
    speed = math.sqrt((at_gear - scene.load.torque) / scene.load.drag)
    assert scene.initial.gear_speed == pytest.approx(speed, rel=1e-4, abs=0)


def test_low_speed_torque_balances_the_drag() -> None:
    scene = preset("teodorescu2009_low_speed")
    assert scene.drive is not None
    assert scene.load is not None
    assert scene.initial is not None
    at_gear = scene.drive.torque * scene.geometry.base_radius_gear / scene.geometry.base_radius_pinion
    assert at_gear == pytest.approx(
        scene.load.drag * scene.initial.gear_speed**2, rel=1e-12, abs=0
    )  # rounding alone
    assert scene.initial.gap == pytest.approx(6 * scene.surface.roughness, rel=1e-12, abs=0)


def test_equivalent_mass_of_the_pair() -> None:
    """1 / (R1^2/I1 + R2^2/I2) = 2.53e-12 kg, to the digits stated."""
    scene = preset("teodorescu2009")
    assert scene.gears is not None
    mass = 1 / (
        scene.geometry.base_radius_pinion**2 / scene.gears.pinion_inertia
        + scene.geometry.base_radius_gear**2 / scene.gears.gear_inertia
    )
    assert mass == pytest.approx(2.53e-12, abs=5e-15)


def test_presets_share_one_surface() -> None:
    assert len({preset(name).surface for name in PRESETS}) == 1


def test_every_key_is_described() -> None:
    keys = describe_keys()
    tables = dict(CONTRACT) | {"shafts.NAME": SHAFT, "meshes.NAME": f"{MESH} {CONTRACT['mesh']}"}
    tables |= {f"meshes.NAME.{table}": CONTRACT[table] for table in ("coating", "surface")}
    expected = ["name", *(f"{table}.{name}" for table, names in tables.items() for name in names.split())]
    assert sorted(info.key for info in keys) == sorted(expected)
    for info in keys:
        assert info.description, info.key
        assert info.allowed, info.key
        assert info.required == (info.default is None), info.key


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("gears.pinion_inertia", "kg m^2"),
        ("coating.sam_fraction", "1"),
        ("gears.pinion_teeth", "1"),
        ("load.drag", "N m s^2/rad^2"),
        ("drive.harmonic.0.frequency", "Hz"),
        ("contact.bodies", ""),
    ],
)
def test_units_of_keys(key: str, unit: str) -> None:
    assert describe_key(key).unit == unit


def test_described_defaults_are_those_of_scenes() -> None:
    scene = preset("teodorescu2009")
    data = scene.to_dict()
    del data["run"]["rtol"], data["run"]["samples"], data["mesh"]["tip_relief_radius"]
    plain = Scene.from_dict(data)
    assert plain.mesh is not None
    assert plain.run.rtol == describe_key("run.rtol").default
    assert plain.run.samples == describe_key("run.samples").default
    assert plain.mesh.tip_relief_radius == describe_key("mesh.tip_relief_radius").default


def test_unknown_keys_have_no_description() -> None:
    with pytest.raises(SceneError, match=r"did you mean run\.duration\?"):
        describe_key("run.duratoin")


@pytest.mark.parametrize("name", ["start_up", "braking", "alternating", "roller_slow", "roller_fast"])
def test_presets_are_the_cases_of_their_name(name: str) -> None:
    assert preset(name) == load_case(CASES / f"{name}.toml")


# -- the module in place of the base radius ------------------------------------------------------------------


def test_the_module_gives_the_base_radius() -> None:
    """Of a pinion with 20 teeth of 10 um: a pitch diameter of 200 um, a base radius of 100 um times cos 20 deg."""
    data = preset("teodorescu2009").to_dict()
    del data["gears"]["pinion_base_radius"]
    data["gears"] |= {"module": "10 um", "pinion_teeth": 20, "gear_teeth": 40, "pressure_angle": "20 deg"}
    scene = Scene.from_dict(data)
    assert scene.gears is not None
    assert scene.gears.pinion_base_radius == pytest.approx(
        93.96926208e-6, rel=1e-9, abs=0
    )  # 1e-4 m cos 20 deg
    assert scene.geometry.module == pytest.approx(10e-6, rel=1e-14, abs=0)
    assert scene.gears.module is None
    assert "module" not in scene.to_dict()["gears"]


def test_the_module_of_a_geometry_gives_the_same_gears() -> None:
    scene = preset("teodorescu2009")
    again = scene.replace({"gears.module": scene.geometry.module})
    assert scene.gears is not None
    assert again.gears is not None
    assert again.gears.pinion_base_radius == pytest.approx(scene.gears.pinion_base_radius, rel=1e-15, abs=0)
    assert scene.replace({"gears.module": None}) == scene


@pytest.mark.parametrize("changes", [("module", "pinion_base_radius"), ("pinion_base_radius", "module")])
def test_module_and_base_radius_are_never_given_both(changes: tuple[str, str]) -> None:
    scene = preset("teodorescu2009")
    with pytest.raises(SceneError, match=r"gears\.module = 3e-05: cannot be given beside .*base_radius"):
        scene.replace({f"gears.{name}": 3e-5 for name in changes})
    data = scene.to_dict()
    data["gears"]["module"] = 3e-5
    with pytest.raises(SceneError, match=r"gears\.module = 3e-05: cannot be given beside pinion_base_radius"):
        Scene.from_dict(data)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"module": "4 s"}, r"gears\.module = 4 s: the unit 's' does not fit"),
        ({"module": -1.0}, r"gears\.module = -1\.0: must lie in"),
        ({"module": "4 um", "pinion_teeth": 2}, r"gears\.pinion_teeth = 2: must be a whole number in 3"),
        ({"modul": "4 um"}, r"gears\.modul = 4 um: unknown key; did you mean module\?"),
    ],
)
def test_a_wrong_module_is_named(changes: dict[str, Any], message: str) -> None:
    data = preset("teodorescu2009").to_dict()
    del data["gears"]["pinion_base_radius"]
    data["gears"] |= changes
    with pytest.raises(SceneError, match=message):
        Scene.from_dict(data)


def test_density_gives_the_inertias_of_discs() -> None:
    """Silicon, pitch circles of 36.943 and 147.77 um: base radius over cos 20 deg."""
    scene = preset("teodorescu2009")
    discs = scene.replace({"gears.density": "2330 kg/m^3"})
    assert discs.gears is not None
    for inertia, radius in ((discs.gears.pinion_inertia, 34.715e-6), (discs.gears.gear_inertia, 138.86e-6)):
        pitch = radius / math.cos(math.radians(20.0))
        assert inertia == pytest.approx(math.pi / 2 * 2330.0 * 2e-6 * pitch**4, rel=1e-12, abs=0)
    assert "density" not in discs.to_dict()["gears"]
    data = scene.to_dict()
    del data["gears"]["pinion_inertia"], data["gears"]["gear_inertia"], data["gears"]["pinion_base_radius"]
    data["gears"] |= {"density": 2330.0, "module": scene.geometry.module}
    again = Scene.from_dict(data)
    assert again.gears is not None
    assert again.gears.gear_inertia == pytest.approx(discs.gears.gear_inertia, rel=1e-13, abs=0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"density": 2330.0}, r"gears\.density = 2330\.0: cannot be given beside pinion_inertia"),
        (
            {"density": 2330.0, "pinion_inertia": None},
            r"gears\.density = 2330\.0: cannot be given beside gear_inertia",
        ),
        ({"density": "2 g", "pinion_inertia": None, "gear_inertia": None}, r"gears\.density = 2 g: the unit"),
        (
            {"density": 0.0, "pinion_inertia": None, "gear_inertia": None},
            r"gears\.density = 0\.0: must lie in 1",
        ),
        ({"pinion_inertia": None}, r"gears\.pinion_inertia"),
    ],
)
def test_density_and_inertias_are_never_given_both(changes: dict[str, Any], message: str) -> None:
    data = preset("teodorescu2009").to_dict()
    data["gears"] |= changes
    with pytest.raises(SceneError, match=message):
        Scene.from_dict(
            {**data, "gears": {name: value for name, value in data["gears"].items() if value is not None}}
        )
    if changes == {"density": 2330.0}:
        with pytest.raises(SceneError, match=r"cannot be given beside gears\.gear_inertia"):
            preset("teodorescu2009").replace({"gears.density": 2330.0, "gears.gear_inertia": 1e-19})


def test_a_schedule_is_taken_away_by_an_empty_list() -> None:
    scene = preset("start_up").replace({"drive.schedule": [], "drive.torque": 1e-11})
    assert scene.drive is not None
    assert scene.drive.schedule == ()
