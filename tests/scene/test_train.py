"""Scenes of shafts and meshes: how a train lies, what closes, what is refused, and the short form."""

from __future__ import annotations

import copy
import math
import pickle
from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from tests.reference.trains import SPLIT, chain, compound, split

import gearidae as gd
from gearidae.errors import SceneError
from gearidae.scene import GearScene, Scene, TrainScene, dump_case, load_case, preset, require_gears
from gearidae.scene.gears import disc_inertia
from gearidae.scene.joints import joints
from gearidae.scene.keys import find_key, scene_value


def scene_of(tables):
    return Scene.from_dict(tables)


@pytest.mark.parametrize(("angle", "phase"), [("40 deg", 0.0613738378), ("0 deg", 0.8391516156)])
def test_a_gear_in_two_meshes_links_their_phases(angle, phase):
    """To the ten digits of an independent prototype."""
    second = scene_of(chain(angle)).train.mesh("second")
    assert second.phase == pytest.approx(phase, abs=6e-11)
    assert second.angle == pytest.approx(math.radians(float(angle.split()[0])), abs=1e-15)


def test_the_gap_at_the_start_shifts_the_phase_of_a_driver():
    initial = {"gear_speed": 0.0, "gap": "0.25 um", "mesh_phase": 0.3}
    assert scene_of(chain(initial=initial)).train.mesh("second").phase == pytest.approx(
        0.0800148863, abs=6e-11
    )


def test_senses_ratios_and_centres_of_a_chain():
    train = scene_of(chain("90 deg")).train
    assert [shaft.sense for shaft in train.shafts] == [1, -1, 1]
    assert [shaft.ratio for shaft in train.shafts] == [1, Fraction(1, 2), Fraction(1, 4)]
    pitch = [0.5 * train.meshes[0].geometry.module * teeth for teeth in (19, 38, 76)]
    idler, output = train.shafts[1].centre, train.shafts[2].centre
    assert idler == pytest.approx((pitch[0] + pitch[1], 0.0), rel=1e-12, abs=1e-18)
    assert output == pytest.approx((pitch[0] + pitch[1], pitch[1] + pitch[2]), rel=1e-12)
    assert (train.drive, train.load, train.loops) == (0, 2, ())


def test_a_split_path_closes():
    """Phases, closing angle and the distance of the centres, to the digits of an independent prototype."""
    train = scene_of(split()).train
    phases = [0.3, 0.7564891147, 0.9442403915, 0.1905519543]
    assert [mesh.phase for mesh in train.meshes] == pytest.approx(phases, abs=6e-11)
    assert [mesh.closes for mesh in train.meshes] == [False, False, False, True]
    assert train.meshes[3].angle == pytest.approx(SPLIT[1], abs=1e-10)
    assert math.hypot(*train.shafts[3].centre) == pytest.approx(272.5840433e-6, rel=2e-10)
    assert train.meshes[3].residual == pytest.approx(0.0, abs=1e-10)
    assert [sorted(loop) for loop in train.loops] == [["four", "one", "three", "two"]]
    theta, closing = SPLIT
    assert ((19 + 38) * theta + (38 + 76) * closing) / math.pi == pytest.approx(31.0, abs=1e-10)


def near_split(theta=0.9022):
    return theta, math.asin(57 * math.sin(theta) / 114)


def test_what_is_left_where_a_loop_closes_is_an_offset():
    last = scene_of(split(near_split())).train.meshes[3]
    assert last.residual == pytest.approx(4.253811e-4, rel=2e-7)
    assert last.offset == pytest.approx(4.883392e-9, rel=2e-7)


def test_a_loop_that_would_have_to_be_pressed_together_is_refused():
    with pytest.raises(gd.SceneError, match=r"^meshes\.four = .*cannot be assembled: the loop closes"):
        scene_of(split(near_split(0.95)))


def test_the_order_of_the_tables_does_not_matter():
    """Centres, phases and angles by name; a sum in another order is off by rounding."""
    tables = compound()
    tables["meshes"]["m2"]["phase"] = 0.55
    first = scene_of(tables).train
    for shafts in permutations(("first", "second")):
        for meshes in permutations(tables["meshes"]):
            names = ("engine", *shafts, "output")
            other = scene_of(
                tables
                | {"shafts": {name: tables["shafts"][name] for name in names}}
                | {"meshes": {name: tables["meshes"][name] for name in meshes}}
            ).train
            for mesh in first.meshes:
                assert other.mesh(mesh.name).phase == pytest.approx(mesh.phase, abs=1e-12)
            for shaft in first.shafts:
                there = other.shaft(shaft.name)
                assert (there.sense, there.ratio) == (shaft.sense, shaft.ratio)
                assert there.centre == pytest.approx(shaft.centre, abs=1e-17)


def test_a_mesh_without_an_angle_closes_its_loop_wherever_it_is_listed():
    tables = split()
    tables["meshes"]["one"]["phase"] = 0.3
    first = scene_of(tables).train
    for meshes in permutations(tables["meshes"]):
        other = scene_of(tables | {"meshes": {name: tables["meshes"][name] for name in meshes}}).train
        assert [mesh.name for mesh in other.meshes if mesh.closes] == ["four"]
        for mesh in first.meshes:
            assert other.mesh(mesh.name).angle == pytest.approx(mesh.angle, abs=1e-12)
            assert other.mesh(mesh.name).phase == pytest.approx(mesh.phase, abs=1e-12)


def test_gears_of_one_shaft_are_mounted_at_any_angle():
    """So that their phases are free; and a reduction has the product of its ratios."""
    tables = compound()
    for name, phase in (("m1", 0.3), ("m2", 0.55), ("m3", 0.8)):
        tables["meshes"][name]["phase"] = phase
    train = scene_of(tables).train
    assert [mesh.phase for mesh in train.meshes] == [0.3, 0.55, 0.8]
    assert train.shafts[3].ratio == Fraction(1, 48)


def with_mesh(**entry):
    tables = chain()
    tables["meshes"]["third"] = entry
    return tables


def changed(tables, table, name, **entry):
    return tables | {table: tables[table] | {name: tables[table][name] | entry}}


REFUSED = {
    "both forms": (
        preset("teodorescu2009").to_dict() | {"shafts": chain()["shafts"]},
        r"^shafts = \(given\): a scene has gears or shafts",
    ),
    "no meshes": ({k: v for k, v in chain().items() if k != "meshes"}, r"^meshes = \(missing\)"),
    "a size of its own": (
        changed(chain(), "meshes", "second", module="4 um"),
        r"^meshes\.second = \(idler\): gives idler the base radius .* meshes\.first",
    ),
    "another pressure angle": (
        changed(chain(), "meshes", "second", pressure_angle="21 deg", module=4.0e-6),
        r"^meshes\.second = \(idler\): gives idler",
    ),
    "no such gear": (
        changed(chain(), "meshes", "second", driver="idle"),
        r"^meshes\.second\.driver = idle: did you mean idler\?",
    ),
    "its own shaft": (
        changed(compound(), "meshes", "m2", driven="first.wheel"),
        r"^meshes\.m2\.driven = first\.wheel: must be a gear of another shaft",
    ),
    "a drive that is driven": (
        changed(chain(), "meshes", "first", driver="idler", driven="input"),
        r"^meshes\.first\.driven = input: is on input, the shaft of the drive",
    ),
    "a shaft that is not driven": (
        chain() | {"meshes": {"first": chain()["meshes"]["first"]}},
        r"^shafts = output: must be driven",
    ),
    "a loop of an odd number": (
        with_mesh(driver="input", driven="output"),
        r"^meshes\.third = .*: the loop .* has an odd number of meshes \(3\), and cannot turn",
    ),
    "two ratios": (
        changed(
            compound()
            | {
                "meshes": compound()["meshes"]
                | {
                    "m4": {"driver": "engine", "driven": "fourth"},
                    "m5": {"driver": "fourth", "driven": "output"},
                }
                | {"m6": {"driver": "fourth", "driven": "second.wheel"}},
                "shafts": compound()["shafts"] | {"fourth": {"teeth": 30, "inertia": 1e-19}},
            },
            "meshes",
            "m5",
            driven="output",
        ),
        r"cannot turn",
    ),
    "two meshes of the same gears": (
        with_mesh(driver="input", driven="idler"),
        r"^meshes\.third\.driven = idler: meets input in meshes\.first already",
    ),
    "a load on the shaft of the drive": (
        chain(load={"shaft": "input"}),
        r"^load\.shaft = input: must be a shaft that a mesh drives",
    ),
    "an offset beyond the backlash": (
        changed(chain(), "meshes", "first", offset="2 um"),
        r"^meshes\.first\.offset = 2e-06: with it initial\.gap must lie in",
    ),
    "teeth that stand too far back": (
        changed(chain(), "meshes", "first", pitch_error_rms="1 um"),
        r"^meshes\.first\.pitch_error_rms = \(tooth .*\): has an error of .* m on input: must be",
    ),
    "keys of a run": (
        chain(run={"duration": "1 us", "impacts": True}),
        r"^run\.impacts = True: cannot be combined with several meshes",
    ),
    "centres that do not fit": (
        split((0.9, 0.4)),
        r"^meshes\.four = .*: the loop does not close: the centres are",
    ),
    "an angle that does not fit": (
        changed(split(), "meshes", "four", angle=0.41),
        r"^meshes\.four\.angle = 0\.41: must be 0\.403185736",
    ),
    "a phase that follows": (
        chain() | {"meshes": {name: mesh | {"phase": 0.1} for name, mesh in chain()["meshes"].items()}},
        r"^meshes\.second\.phase = 0\.1: must be left out: it follows from meshes\.first, by the gear idler",
    ),
    "driven through itself": (
        chain()
        | {
            "shafts": chain()["shafts"] | {"extra": {"teeth": 38, "inertia": 1e-19}},
            "meshes": {
                "first": {"driver": "input", "driven": "idler"},
                "second": {"driver": "extra", "driven": "output"},
                "third": {"driver": "output", "driven": "extra"},
            },
        },
        r"is driven through itself",
    ),
    "no inertia": (
        changed(chain(), "shafts", "idler", inertia=None),
        r"^shafts\.idler\.inertia = .*",
    ),
    "two inertias": (
        changed(chain(), "shafts", "idler", density=2330.0),
        r"^shafts\.idler\.inertia = 1\.536e-19: cannot be given beside density",
    ),
    "two kinds of gears": (
        changed(chain(), "shafts", "idler", gears={"wheel": 38}),
        r"^shafts\.idler\.teeth = 38: cannot be given beside gears",
    ),
    "few teeth": (
        changed(chain(), "shafts", "idler", teeth=2),
        r"^shafts\.idler\.teeth = 2: must be a whole number",
    ),
    "undercut": (
        changed(chain(), "shafts", "input", teeth=8),
        r"^meshes\.first\.driver = input: the gear's tips",
    ),
    "no module": (
        chain() | {"mesh": {k: v for k, v in chain()["mesh"].items() if k != "module"}},
        r"^meshes\.first\.module = \(missing\): is required, here or in mesh",
    ),
    "backlash": (
        changed(chain(), "meshes", "second", backlash="6 um"),
        r"^meshes\.second\.backlash = 6e-06: must be below half a base pitch",
    ),
    "coating": (
        changed(chain(), "meshes", "second", coating={"sam_fraction": 1.5}),
        r"^meshes\.second\.coating\.sam_fraction = 1\.5: must lie in 0\.\.1",
    ),
    "a table of a coating": (
        changed(chain(), "meshes", "second", coating={"pinion_table": [[0.5]] * 7}),
        r"^meshes\.second\.coating\.pinion_table = \(7 rows\): must have 38 rows, one for each tooth, or one row",
    ),
    "a misspelt key": (
        changed(chain(), "meshes", "second", coating={"sam_fractoin": 0.5}),
        r"^meshes\.second\.coating\.sam_fractoin = 0\.5: unknown key; did you mean sam_fraction\?",
    ),
    "no such shaft": (chain(load={"shaft": "outptu"}), r"^load\.shaft = outptu: did you mean output\?"),
    "a name": (chain() | {"shafts": {"a-b": {"teeth": 19}}}, r"^shafts = .*has the name a-b"),
    "too many shafts": (
        chain() | {"shafts": {f"s{n}": {"teeth": 19, "inertia": 1e-20} for n in range(17)}},
        r"^shafts = \(17 tables\): there may be 16 at most",
    ),
    "a hub without a radius": (
        changed(chain(), "shafts", "idler", hub_friction=0.3),
        r"^shafts\.idler\.hub_radius = 0\.0: a hub or a dimple must have a radius",
    ),
    "elastic bodies": (
        chain(contact={"bodies": "elastic", "asperity": "hertz"}),
        r"^contact\.bodies = elastic: cannot be combined with several meshes",
    ),
    "exposures": (
        chain(run={"duration": 1e-4, "exposures": 5}),
        r"^run\.exposures = 5: cannot be combined with several meshes",
    ),
    "sizes of a pair": (
        {
            name: table | ({"module": 1e-6} if name == "mesh" else {})
            for name, table in preset("teodorescu2009").to_dict().items()
            if isinstance(table, dict)
        },
        r"^mesh\.module = 1e-06: is of a train",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_makes_no_train_is_refused_by_its_key(name):
    tables, said = REFUSED[name]
    with pytest.raises(gd.SceneError, match=said):
        scene_of(tables)


def test_a_shaft_of_a_pair_is_refused():
    with pytest.raises(gd.SceneError, match=r"^load\.shaft = gear: is of a train"):
        preset("teodorescu2009").replace({"load.shaft": "gear"})


CHANGES = {
    "meshes.second.coating.sam_fraction": 0.5,
    "meshes.second.surface.roughness": "7 nm",
    "meshes.first.static_error": {"order": 1, "amplitude": "3 nm"},
    "meshes.first.offset": "2 nm",
    "shafts.idler.hub_radius": "4 um",
    "shafts.idler.hub_friction": 0.2,
    "mesh.backlash": "0.4 um",
}


def test_keys_of_shafts_and_meshes_are_replaced():
    scene = scene_of(chain()).replace(CHANGES)
    first, second = scene.train.meshes
    assert isinstance(scene, TrainScene)
    assert (first.coating.sam_fraction, second.coating.sam_fraction) == (1.0, 0.5)
    assert (first.surface.roughness, second.surface.roughness) == (6e-9, 7e-9)
    assert second.coating.thickness == 1e-9
    assert (first.mesh.backlash, first.mesh.static_error[0].amplitude, first.offset) == (4e-7, 3e-9, 2e-9)
    assert scene.shafts["idler"].hub_radius == 4e-6
    assert scene_value(scene, "meshes.second.coating.sam_fraction") == 0.5
    assert (
        scene.replace({"meshes.second.coating.sam_fraction": None}).train.meshes[1].coating.sam_fraction
        == 1.0
    )
    assert scene_of(compound()).replace({"shafts.first.gears.wheel": 95}).train.shafts[3].ratio == Fraction(
        1, 60
    )


def test_shafts_and_meshes_are_added_and_taken_away():
    scene = scene_of(chain())
    longer = scene.replace(
        {
            "shafts.last": {"teeth": 19, "inertia": 1e-20},
            "meshes.third": {"driver": "output", "driven": "last"},
        }
    )
    assert longer.train.shafts[3].ratio == 1
    assert longer.replace({"shafts.last": None, "meshes.third": None}) == scene


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"shafts.output": None}, r"^meshes\.second\.driven = output: must be one of input, idler"),
        ({"meshes.fourth": None}, r"no such table or entry to change; in meshes there are first, second"),
        (
            {"shafts.idle.inertia": 1e-20},
            r"^shafts\.idle\.inertia = .*; in shafts there are input, idler, output",
        ),
        (
            {"shafts.input.spring": 1e-7},
            r"^shafts\.input\.spring = 1e-07: unknown key; known are inertia, density",
        ),
        ({"shafts.input.inertai": 1e-20}, r"did you mean shafts\.input\.inertia\?"),
    ],
)
def test_changes_of_what_is_not_there_say_what_there_is(changes, said):
    with pytest.raises(gd.SceneError, match=said):
        scene_of(chain()).replace(changes)


@pytest.mark.parametrize("tables", [chain(), split(), compound()], ids=["chain", "split", "compound"])
def test_round_trips_are_exact(tables, tmp_path):
    scene = scene_of(tables)
    path = tmp_path / "train.toml"
    path.write_text(dump_case(scene))
    for again in (
        Scene.from_dict(scene.to_dict()),
        load_case(path),
        pickle.loads(pickle.dumps(scene)),
        copy.deepcopy(scene),
        scene.replace({}),
    ):
        assert again == scene
        assert hash(again) == hash(scene)
        assert again.to_dict() == scene.to_dict()
        assert list(again.to_dict()["shafts"]) == list(tables["shafts"])


def test_changes_survive_a_case_file(tmp_path):
    scene = scene_of(chain()).replace(CHANGES)
    path = tmp_path / "train.toml"
    path.write_text(dump_case(scene))
    assert load_case(path) == scene


def test_another_order_of_shafts_is_another_scene():
    tables = chain()
    other = tables | {
        "shafts": dict(reversed(tables["shafts"].items())),
        "drive": {"torque": 1e-11, "shaft": "input"},
    }
    other["load"] = tables["load"] | {"shaft": "output"}
    assert scene_of(other) != scene_of(tables)
    assert scene_of(other).train.drive == 2


def test_keys_are_described():
    assert find_key(Scene, "shafts.idler.inertia").unit == "kg m^2"
    assert (
        gd.describe_key("meshes.second.coating.sam_fraction").description
        == gd.describe_key("coating.sam_fraction").description
    )
    assert gd.describe_key("shafts.first.gears.wheel").unit == "1"
    with pytest.raises(gd.SceneError, match=r"did you mean shafts\.idler\.hub_radius\?"):
        gd.describe_key("shafts.idler.hub_radis")


def test_how_a_train_shows_itself():
    scene = scene_of(chain())
    assert repr(scene) == "<Scene 'train': train of 3 shafts, 2 meshes, SAM 100 %, 150 us>"
    assert "meshes" in scene._repr_html_()


def test_a_density_makes_discs_of_all_gears_of_a_shaft():
    tables = compound()
    tables["shafts"]["first"] = {"gears": {"wheel": 76, "small": 19}, "density": 2330.0}
    train = scene_of(tables).train
    geometry = train.mesh("m1").geometry
    expected = sum(
        disc_inertia(2330.0, 2.25e-6, radius, geometry.pressure_angle)
        for radius in (geometry.base_radius_gear, geometry.base_radius_pinion)
    )
    assert train.shaft("first").inertia == pytest.approx(expected, rel=1e-12, abs=0.0)


def short(**changes):
    return preset("teodorescu2009").replace(changes) if changes else preset("teodorescu2009")


def long_form(scene):
    """A pair written as a train."""
    data, gears = scene.to_dict(), scene.gears
    del data["gears"]
    data["shafts"] = {
        "pinion": {"teeth": gears.pinion_teeth, "inertia": gears.pinion_inertia},
        "gear": {"teeth": gears.gear_teeth, "inertia": gears.gear_inertia},
    }
    data["mesh"] |= {
        "driver_base_radius": gears.pinion_base_radius,
        "pressure_angle": gears.pressure_angle,
        "face_width": gears.face_width,
    }
    data["meshes"] = {"mesh": {"driver": "pinion", "driven": "gear"}}
    return data


def test_a_train_of_one_mesh_is_a_pair():
    scene = short()
    train = scene_of(long_form(scene))
    assert train.gears is None
    assert train.pair("mesh") == scene
    assert require_gears(train) == scene
    assert isinstance(train.pair("mesh"), GearScene)


def test_hubs_and_angles_of_a_train_of_one_mesh():
    law = {"name": "microengine", "radius": "10 um", "force": "10 uN", "frequency": "600 Hz", "phase": 0.0}
    scene = short(
        **{"gears.hub_friction": 0.3, "gears.pinion_hub_radius": "3 um", "gears.gear_hub_radius": "6 um"}
    ).replace({"drive": {"law": law, "orientation": 0.3, "pin_radius": "1 um"}})
    data = long_form(scene)
    data["shafts"]["pinion"] |= {"hub_friction": 0.3, "hub_radius": "3 um"}
    data["shafts"]["gear"] |= {"hub_friction": 0.3, "hub_radius": "6 um"}
    data["meshes"]["mesh"]["angle"] = 0.5
    data["drive"]["orientation"] = 0.8
    assert scene_of(data).pair("mesh").drive.orientation == pytest.approx(0.3)
    assert scene_of(data).pair("mesh").gears == scene.gears
    data["shafts"]["gear"]["hub_friction"] = 0.2
    with pytest.raises(
        gd.SceneError, match=r"^shafts\.gear\.hub_friction = 0\.2: must be that of the other shaft"
    ):
        scene_of(data)


def test_a_pair_has_shafts_meshes_and_a_train():
    scene = short()
    assert [*scene.shafts] == ["pinion", "gear"]
    assert scene.shafts["gear"].teeth == 76
    mesh = scene.meshes["mesh"]
    assert (mesh.driver, mesh.driven, mesh.backlash) == ("pinion", "gear", scene.mesh.backlash)
    assert scene.train.meshes[0].geometry == scene.geometry
    assert scene.train.meshes[0].phase == scene.initial.mesh_phase
    assert [shaft.ratio for shaft in scene.train.shafts] == [1, Fraction(1, 4)]
    assert "shafts" not in scene.to_dict()
    with pytest.raises(gd.SceneError, match="a scene with a roller has no train"):
        _ = preset("roller_slow").train


@pytest.mark.parametrize(
    ("keys", "refused"),
    [
        ({"gear_spring": 1e-13}, "gear_spring"),
        ({"pinion_spring": 1e-12, "pinion_spring_damping": 1e-18}, "pinion_spring"),
    ],
)
def test_what_shafts_of_a_train_lack_is_not_lost(keys, refused):
    """Springs are keys of a pair alone."""
    scene = short(**{f"gears.{key}": value for key, value in keys.items()})
    for table in ("shafts", "train"):
        with pytest.raises(
            gd.SceneError, match=rf"^gears\.{refused} = .*: must be 0 where a pair is to be a train"
        ):
            getattr(scene, table)


ENGINE = {
    "drive.law": {
        "name": "microengine",
        "radius": "10 um",
        "force": "10 uN",
        "frequency": "600 Hz",
        "phase": 1.4,
    }
}
HUBS_THAT_AGE = {
    "hub_friction": 0.2,
    "hub_friction_rise": 0.1,
    "hub_ageing_time": 1e-3,
    "hub_memory_length": 5e-8,
}


def test_hubs_of_a_pair_age_in_a_train_too():
    keys = {f"gears.{key}": value for key, value in (HUBS_THAT_AGE | {"gear_hub_radius": 6e-6}).items()}
    scene = short(**keys)
    there = scene.shafts["gear"].hub_of("gear")
    assert (there.rise, there.ageing_time, there.memory_length) == (0.1, 1e-3, 5e-8)
    assert scene.shafts["pinion"].hub_friction_rise == 0.0  # it has no hub


@pytest.mark.parametrize(
    ("changes", "key", "allowed"),
    [
        (
            {"shafts.idler.hub_ageing_time": None},
            "shafts.idler.hub_ageing_time",
            "is required with shafts.idler",
        ),
        (
            {"shafts.idler.hub_memory_length": None},
            "shafts.idler.hub_memory_length",
            "is required with shafts",
        ),
        (
            {"shafts.idler.hub_radius": 0.0, "shafts.idler.hub_friction": 0.0},
            "shafts.idler.hub_radius",
            "_rise",
        ),
        ({"shafts.idler.hub_friction_rise": 6.0}, "shafts.idler.hub_friction_rise", "must lie in 0..5"),
        ({"drive.pin_radius": "1 um"}, "drive.pin_radius", "a couple has no pin"),
        ({"drive.orientation": 0.3}, "drive.orientation", "a couple has no pin"),
        ({**ENGINE, "drive.pin_friction_rise": 0.2}, "drive.pin_radius", "must be above 0"),
        (
            {**ENGINE, "drive.pin_radius": "1 um", "drive.pin_friction": 0.1, "drive.pin_friction_rise": 0.2},
            "drive.pin_ageing_time",
            "is required with drive.pin_friction_rise",
        ),
        (
            {**ENGINE, "shafts.input.hub_friction": 2.0, "shafts.input.hub_radius": "6 um"},
            "drive.pin_radius",
            "must be below drive.law.radius",
        ),
        ({"load.law": ENGINE["drive.law"]}, "load.law.name", "has a force, which only a drive has"),
    ],
)
def test_joints_of_a_train_are_checked_as_those_of_a_pair(changes, key, allowed):
    idler = {f"shafts.idler.{key}": value for key, value in (HUBS_THAT_AGE | {"hub_radius": 4e-6}).items()}
    scene = scene_of(chain()).replace(idler)
    with pytest.raises(gd.SceneError, match=allowed) as caught:
        scene.replace(changes)
    assert caught.value.key == key


def test_a_pin_ages_as_the_hub_of_its_shaft():
    scene = scene_of(chain()).replace(ENGINE | {"drive.pin_radius": "1 um"})
    pin = {joint.name: joint for joint in joints(scene)}["pin"]
    assert (pin.coefficient, pin.rise) == (0.0, 0.0)
    hub = {f"shafts.input.{key}": value for key, value in (HUBS_THAT_AGE | {"hub_radius": 3e-6}).items()}
    both = {joint.name: joint for joint in joints(scene.replace(hub))}
    assert [*both] == ["hub of input", "pin"]
    for name in ("coefficient", "rise", "ageing_time", "memory_length"):
        assert getattr(both["pin"], name) == getattr(both["hub of input"], name)
    own = {joint.name: joint for joint in joints(scene.replace(hub | {"drive.pin_friction": 0.4}))}
    assert (own["pin"].coefficient, own["pin"].rise) == (0.4, 0.0)


def test_hubs_of_a_train_of_one_mesh_age_alike():
    tables = chain()
    tables["shafts"].pop("output")
    tables["meshes"].pop("second")
    for shaft in tables["shafts"].values():
        shaft |= {**HUBS_THAT_AGE, "hub_radius": 3e-6}
    scene = scene_of(tables)
    pair = scene.pair("first")
    assert (pair.gears.hub_friction_rise, pair.gears.hub_ageing_time) == (0.1, 1e-3)
    with pytest.raises(
        gd.SceneError, match=r"that of the other shaft, 0\.1, in a train of one mesh"
    ) as caught:
        scene.replace({"shafts.idler.hub_friction_rise": 0.2})
    assert caught.value.key == "shafts.idler.hub_friction_rise"


def test_stages_are_pairs_with_their_own_tables():
    scene = scene_of(chain()).replace(CHANGES)
    stage = scene.pair("second")
    assert (stage.gears.pinion_teeth, stage.gears.gear_teeth) == (38, 76)
    assert stage.coating.sam_fraction == 0.5
    assert stage.surface.roughness == 7e-9
    with pytest.raises(gd.SceneError, match=r"^mesh = third: must be one of first, second"):
        scene.pair("third")


def test_most_studies_take_no_several_meshes():
    scene = scene_of(chain())
    with pytest.raises(
        gd.SceneError, match=r"^meshes = \(2 meshes\): must be one here: .*scene\.pair\(NAME\)"
    ):
        gd.studies.coating_map(scene)
    with pytest.raises(gd.SceneError, match=r"see scene\.train\.meshes"):
        _ = scene.geometry


@pytest.mark.parametrize("tables", [chain(), chain("-130 deg"), split()])
def test_the_teeth_of_a_gear_have_one_place_in_all_of_its_meshes(tables):
    """The middle of a tooth lies a quarter of a pitch ahead of its driven flank, and as far behind its driving one."""
    scene = Scene.from_dict(tables)
    train, gap = scene.train, float(scene.initial.gap)
    places = {}
    for mesh in train.meshes:
        geometry = mesh.geometry
        for driven, mount, shaft in ((False, mesh.mounts[0], mesh.a), (True, mesh.mounts[1], mesh.b)):
            teeth = geometry.gear_teeth if driven else geometry.pinion_teeth
            back = 0.0 if driven else 0.5 * mesh.mesh.backlash - gap
            position = mesh.phase - (geometry.approach - back) / geometry.base_pitch - mount.shift
            turned = (
                (position + (0.25 if driven else -0.25)) * 2.0 * math.pi / teeth * train.shafts[shaft].sense
            )
            place = mesh.angle + math.pi * driven + turned
            places.setdefault(mount.gear, []).append(place)
    assert sum(len(found) > 1 for found in places.values()) >= 1
    for first, *others in places.values():
        for other in others:
            # of the mesh that closes a loop the phase is that of its driven gear: a residual of 1e-12 here
            assert math.remainder(other - first, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_errors_of_teeth_are_drawn_once_for_each_gear():
    scene = Scene.from_dict(chain()).replace({"mesh.pitch_error_rms": "2 nm", "mesh.pitch_error_seed": 3})
    first, second = (gd.pitch_errors(scene.pair(name)) for name in ("first", "second"))
    for gear, drawn in enumerate((first.pinion_pitch_error, first.gear_pitch_error)):
        expected = np.random.default_rng([3, gear]).standard_normal(drawn.size) * 2e-9 / math.sqrt(2.0)
        np.testing.assert_allclose(drawn, expected, rtol=1e-15)
    # the idler drives in the second mesh: a tooth that stands forward opens one gap and closes the other
    shift = scene.train.mesh("second").mounts[0].shift
    np.testing.assert_array_equal(second.pinion_pitch_error, -np.roll(first.gear_pitch_error, shift))
    own = np.random.default_rng([3, 2]).standard_normal(76) * 2e-9 / math.sqrt(2.0)
    np.testing.assert_allclose(second.gear_pitch_error, own, rtol=1e-15)
    one = Scene.from_dict(chain()).replace({"meshes.second.pitch_error_rms": "2 nm"})
    assert not gd.pitch_errors(one.pair("first")).gear_pitch_error.any()
    with pytest.raises(SceneError, match="jam") as refused:
        one.replace({"meshes.second.pitch_error_rms": "130 nm"})
    assert refused.value.key == "meshes.second.pitch_error_rms"
