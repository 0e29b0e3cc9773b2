"""Whatever a user gets wrong becomes one line that names the key, what it held and what is allowed."""

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.errors import SceneError
from gearidae.scene import Coating, Drive, Scene, Surface, describe_keys, preset
from gearidae.scene.knots import PACKED_ABOVE

NAN, INF = float("nan"), float("inf")

WRONG = [
    # what no number is
    ("coating.sam_fraction", "abc", "must be a number"),
    ("coating.sam_fraction", True, "must be a number in 0..1"),
    ("coating.sam_fraction", np.True_, "must be a number in 0..1"),
    ("coating.sam_fraction", [0.5], "must be a number in 0..1"),
    ("coating.sam_fraction", {}, "must be a number in 0..1"),
    ("coating.sam_fraction", {1, 2}, "must be a number in 0..1"),
    ("coating.sam_fraction", None, "must be a number in 0..1"),
    ("coating.sam_fraction", 0.5j, "must be a number in 0..1"),
    ("coating.sam_fraction", np.array([0.5, 0.6]), "must be a number in 0..1"),
    ("coating.sam_fraction", NAN, "must be a finite number"),
    ("gears.face_width", INF, "must be a finite number"),
    pytest.param("gears.face_width", 10**5000, "must be a finite number", id="huge"),
    # units
    ("gears.pinion_base_radius", "34.7", "lacks a unit"),
    ("gears.pinion_base_radius", "34.7 kg", "'kg' does not fit"),
    ("gears.pinion_base_radius", "34.7 parsnip", "'parsnip' is not a known unit"),
    ("initial.gear_speed", "10 Hz", "'Hz' does not fit"),
    # limits
    ("coating.sam_fraction", 1.3, "must lie in 0..1"),
    ("coating.sam_fraction", -1e-9, "must lie in 0..1"),
    ("coating.energy", -0.1, "must lie in 0..100 J/m^2"),
    ("gears.pinion_inertia", 0, "must lie in 1e-40..1 kg m^2"),
    ("gears.gear_inertia", -1e-20, "must lie in 1e-40..1 kg m^2"),
    ("gears.pinion_base_radius", 34.715, "must lie in 1e-08..1 m"),  # the micro forgotten
    ("gears.pressure_angle", 20, "below 1.5 rad"),  # degrees forgotten
    ("gears.face_width", 0, "must lie in 1e-10..1 m"),
    ("mesh.backlash", "-1 nm", "must lie in 0..1 m"),
    ("mesh.tip_relief_radius", 0, "must lie in 1e-10..1 m"),
    ("mesh.damping", -1, "must lie in 0..1e+09 N s/m"),
    ("surface.youngs_modulus", 161, "must lie in 1000..1e+14 Pa"),  # the giga forgotten
    ("surface.poisson_ratio", 0.5, "must be above -1 and below 0.5"),
    ("surface.energy", -1, "must lie in 0..100"),
    ("surface.asperity_density", 0, "must lie in 1..1e+20"),
    ("surface.asperity_radius", 0, "must lie in 1e-10..0.1 m"),
    ("surface.roughness", 0, "must lie in 1e-12..0.1 m"),
    ("load.torque", -1e-11, "must lie in 0..1e+09 N m"),
    ("load.drag", -1e-18, "must lie in 0..1e+12 N m s^2/rad^2"),
    ("initial.mesh_phase", 10_000, "must be at least 0 and below 10000"),
    ("run.duration", 0, "must lie in 1e-20..1e+12 s"),
    ("run.rtol", 1e-13, "must lie in 1e-12..0.1"),
    ("run.rtol", 1, "must lie in 1e-12..0.1"),
    # what doubles cannot hold, or the engine cannot keep
    ("gears.pinion_inertia", 1e-41, "must lie in 1e-40..1"),
    ("gears.face_width", 1e-300, "must lie in 1e-10..1"),
    ("surface.asperity_radius", 1e-300, "must lie in 1e-10..0.1"),
    ("surface.roughness", 1e-13, "must lie in 1e-12..0.1"),
    ("surface.energy", 1e-16, "0 or at least 1e-15 in size"),
    ("drive.torque", 1e-300, "0 or at least 1e-40 in size"),
    ("drive.torque", -1e300, "must lie in -1e+09..1e+09 N m"),
    ("load.torque", 1e-41, "0 or at least 1e-40 in size"),
    ("mesh.damping", 1e10, "must lie in 0..1e+09"),
    ("initial.gear_speed", 1e13, "must lie in -1e+12..1e+12 rad/s"),
    ("initial.gear_speed", 1e-31, "0 or at least 1e-30 in size"),
    ("initial.gap", 1e-24, "cannot be resolved beside backlash and roughness"),
    ("run.duration", 1e-300, "must lie in 1e-20..1e+12 s"),
    ("run.duration", 1e13, "must lie in 1e-20..1e+12 s"),
    ("drive.schedule", [[1.0, 1.0], [1.0 + 1e-15, 2.0]], "too close to step between"),
    ("drive.schedule", [[float(i), 1.0] for i in range(100_001)], "has 100001 knots; there may be 100000"),
    ("drive.harmonic", [{"amplitude": 1, "frequency": 1}] * 1001, "has 1001 entries; there may be 1000"),
    ("surface.roughness", 1e-12, "asperities stretch"),
    ("mesh.tip_relief_radius", "90 mm", "tooth pairs would be in touch at a time"),
    # whole numbers
    ("gears.pinion_teeth", 19.5, "must be a whole number"),
    ("gears.pinion_teeth", "19", "must be a whole number in 3..10000, without quotes"),
    ("run.balance", "true", "must be true or false, without quotes"),
    ("gears.pinion_teeth", True, "must be a whole number"),
    ("gears.pinion_teeth", NAN, "must be a whole number"),
    ("gears.pinion_teeth", 2, "must be a whole number in 3..10000"),
    pytest.param("gears.gear_teeth", 10**5000, "must be a whole number", id="huge-count"),
    ("run.samples", 1, "must be a whole number in 2.."),
    ("run.samples", 10**12, "must be a whole number in 2.."),
    # choices and names
    ("contact.bodies", "elastc", "must be 'auto', 'rigid' or 'elastic'"),
    ("contact.asperity", 5, "must be one of dmt, hertz, jkr, maugis, meniscus"),
    ("name", 5, "must be a printable line"),
    ("name", "two\nlines", "must be a printable line"),
    ("name", " ", "must be a printable line"),
    # lists
    ("drive.schedule", 5, "must be a list of [time, value] pairs"),
    ("drive.schedule", "x", "must be a list of [time, value] pairs"),
    ("drive.schedule", [1, 2], "must be a [time, value] pair"),
    ("drive.schedule", [[0, 1, 2]], "must be a [time, value] pair"),
    ("drive.schedule", [[0, 1], [0, 2]], "times must strictly increase"),
    ("drive.schedule", [["2 ms", 1], ["1 ms", 2]], "times must strictly increase"),
    ("load.schedule", {}, "must be a list of [time, value] pairs"),
    ("drive.harmonic", "x", "must be a table {amplitude, frequency or order, phase}"),
    ("mesh.static_error", 5, "must be a table {order, amplitude, phase}"),
    # tables
    ("gears", 5, "must be a table"),
    ("gears", [], "must be a table"),
    ("gears", {1: 2}, "keys must be texts"),
    ("run", None, "must be a table"),
    # what only the whole shows
    ("gears.pinion_teeth", 15, "would undercut the pinion"),
    ("gears.gear_teeth", 5, "would undercut the gear"),
    ("gears.pressure_angle", "45 deg", "come to a point"),
    ("mesh.backlash", "6 um", "must be below half a base pitch"),
    ("mesh.static_error", {"order": 35, "amplitude": "1 um"}, "must add up to less than R1"),
    ("initial.gap", "1 um", "flanks would overlap"),
    ("initial.gap", "-0.1 um", "flanks would overlap"),
]


WRONG_KNOTS: list[Any] = [
    ("load.schedule", [[0, 1e-12], [1e-3, -1e-12]], "[1][1]", "must lie in 0..1e+09 N m"),
    ("load.schedule", [["0 s", "-1 pN m"]], "[0][1]", "must lie in 0..1e+09 N m"),
    ("load.schedule", {"time": [0, 1], "value": [0.0, -1e-12]}, "[1][1]", "must lie in 0..1e+09 N m"),
    ("drive.schedule", [[0, 1e-12], [NAN, 1e-12]], "[1][0]", "must be a finite number"),
    ("drive.schedule", [[0, 1e-12], [1e13, 1e-12]], "[1][0]", "must lie in 0..1e+12 s"),
    ("drive.schedule", [[0, 1e-12], [1e-3, 1e-300]], "[1][1]", "0 or at least 1e-40 in size"),
    ("drive.schedule", [[0, True]], "[0][1]", "must be a number in N m"),
    ("drive.schedule", [[0, 10**400]], "[0][1]", "must be a finite number"),
    ("drive.speed", [[0, 1.0], [1, 1e13]], "", "must lie in -1e+12..1e+12 rad/s"),
]


@pytest.mark.parametrize(("key", "value", "place", "reason"), WRONG_KNOTS)
def test_wrong_knot_is_named(gears: Scene, key: str, value: Any, place: str, reason: str) -> None:
    """Plain numbers are checked all at once; what is wrong is named all the same."""
    with pytest.raises(SceneError) as caught:
        gears.replace({key: value, "drive.speed_gain": 1e-15} if key == "drive.speed" else {key: value})
    assert caught.value.key.startswith(f"{key}{place}")
    assert reason in str(caught.value)


@pytest.mark.parametrize(("key", "value", "reason"), WRONG)
def test_names_key_and_what_is_allowed(gears: Scene, key: str, value: Any, reason: str) -> None:
    with pytest.raises(SceneError) as caught:
        gears.replace({key: value})
    error = caught.value
    assert error.key == key
    assert reason in error.allowed
    assert str(error).startswith(f"{error.key} = ")
    assert "\n" not in str(error)
    assert len(str(error)) < 250


def test_too_small_an_angle_is_told_as_too_few_teeth(gears: Scene) -> None:
    with pytest.raises(SceneError, match="more teeth or a larger pressure angle") as caught:
        gears.replace({"gears.pressure_angle": "10 deg"})
    assert caught.value.key == "gears.pinion_teeth"


@pytest.mark.parametrize(
    ("key", "value", "where"),
    [
        ("drive.schedule", [[0, 1], [1, NAN]], "drive.schedule[1][1]"),
        ("drive.schedule", [["1 kg", 1]], "drive.schedule[0][0]"),
        ("drive.schedule", [[-1, 1]], "drive.schedule[0][0]"),
        ("drive.schedule", [[1e-21, 1]], "drive.schedule[0][0]"),
        ("drive.harmonic", [{"amplitude": 1, "frequency": "1 m"}], "drive.harmonic[0].frequency"),
        ("drive.harmonic", [{"amplitude": 1}], "drive.harmonic[0].frequency"),
        ("drive.harmonic", {"amplitude": 1, "frequency": 1, "fase": 0}, "drive.harmonic[0].fase"),
        ("drive.harmonic", ["x"], "drive.harmonic[0]"),
        ("drive.harmonic", [{1: 2}], "drive.harmonic"),
        ("load.harmonic", [{"amplitude": 1, "frequency": -1}], "load.harmonic[0].frequency"),
        ("mesh.static_error", [{"order": 0, "amplitude": 0}], "mesh.static_error[0].order"),
        ("coating", {"sam_fraction": 2}, "coating.sam_fraction"),
        ("coating", {}, "coating.sam_fraction"),
    ],
)
def test_names_the_entry_within_lists_and_tables(gears: Scene, key: str, value: Any, where: str) -> None:
    with pytest.raises(SceneError) as caught:
        gears.replace({key: value})
    assert caught.value.key == where


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("coating.sam_frction", "coating.sam_fraction"),
        ("coating.sam", "coating.sam_fraction"),
        ("sam_fraction", "coating.sam_fraction"),
        ("gear.pinion_teeth", "gears.pinion_teeth"),
        ("coatng", "coating"),
        ("drive.harmonic.fase", "drive.harmonic.phase"),
        ("drive.harmonic.0.amplitud", "drive.harmonic.0.amplitude"),
        ("mesh.static_error.12.ordr", "mesh.static_error.12.order"),
        ("energy", "surface.energy or coating.energy"),
    ],
)
def test_suggests_the_key_that_was_meant(gears: Scene, key: str, meant: str) -> None:
    with pytest.raises(SceneError, match=f"unknown key; did you mean {meant}\\?") as caught:
        gears.replace({key: 1})
    assert caught.value.key == key


@pytest.mark.parametrize(
    "key", ["", "x", ".", "..", "gears.", "gears..x", "0", "drive.harmonic.²", "a" * 9999, 5, ("x",), None]
)
def test_nonsense_keys(gears: Scene, key: Any) -> None:
    with pytest.raises(SceneError):
        gears.replace({key: 1})


def test_unknown_keys_in_tables(gears: Scene) -> None:
    data = gears.to_dict()
    data["gears"]["pinion_inerta"] = 1
    with pytest.raises(
        SceneError, match=r"gears\.pinion_inerta = 1: unknown key; did you mean pinion_inertia\?"
    ):
        Scene.from_dict(data)


def test_unknown_tables(gears: Scene) -> None:
    with pytest.raises(SceneError, match=r"surfce = .*: unknown key; did you mean surface\?"):
        Scene.from_dict({**gears.to_dict(), "surfce": {}})
    with pytest.raises(
        SceneError, match=r"sam_fraction = 1: unknown key; did you mean coating\.sam_fraction\?"
    ):
        Scene.from_dict({**gears.to_dict(), "sam_fraction": 1})


@pytest.mark.parametrize(
    ("table", "name", "meant"),
    [
        ("drive", "duration", r"run\.duration"),
        ("mesh", "sam_fraction", r"coating\.sam_fraction"),
        ("run", "torque", r"drive\.torque or load\.torque"),
        ("drive", "pin_frictoin", "pin_friction"),
    ],
)
def test_a_key_in_the_wrong_table_is_named_with_its_own(table, name, meant):
    tables = preset("teodorescu2009").to_dict()
    tables[table] = tables[table] | {name: 0.5}
    with pytest.raises(SceneError, match=rf"^{table}\.{name} = 0\.5: unknown key; did you mean {meant}\?$"):
        Scene.from_dict(tables)


REQUIRED = [
    info.key
    for info in describe_keys()
    if info.required and info.key.count(".") == 1 and "roller" not in info.key
]


@pytest.mark.parametrize("key", REQUIRED)
def test_missing_keys_are_named(gears: Scene, key: str) -> None:
    data = gears.to_dict()
    table, name = key.split(".")
    del data[table][name]
    with pytest.raises(SceneError, match="is required") as caught:
        Scene.from_dict(data)
    assert caught.value.key == key


@pytest.mark.parametrize("table", ["gears", "mesh", "drive", "initial", "surface", "run"])
def test_missing_tables_are_named(gears: Scene, table: str) -> None:
    data = gears.to_dict()
    del data[table]
    with pytest.raises(SceneError, match="is required") as caught:
        Scene.from_dict(data)
    assert caught.value.key == table


@pytest.mark.parametrize("table", ["gears", "mesh", "drive", "load", "initial"])
def test_roller_and_gears_exclude_each_other(gears: Scene, roller: Scene, table: str) -> None:
    with pytest.raises(SceneError, match="a scene has a roller or gears, not both") as caught:
        Scene.from_dict({**roller.to_dict(), table: gears.to_dict()[table]})
    assert caught.value.key == table


def test_neither_roller_nor_gears(roller: Scene) -> None:
    with pytest.raises(SceneError, match="is required in a scene without a roller"):
        roller.replace({"roller": None})


def test_roller_has_no_gears_to_change(roller: Scene) -> None:
    with pytest.raises(SceneError, match=r"gears\.pinion_teeth = 20: this scene has no such table"):
        roller.replace({"gears.pinion_teeth": 20})
    with pytest.raises(SceneError, match="no mesh geometry"):
        _ = roller.geometry


def test_counts_the_other_errors(gears: Scene) -> None:
    data = gears.to_dict()
    data["gears"]["pinion_inertia"] = data["gears"]["gear_inertia"] = data["run"]["duration"] = -1
    with pytest.raises(SceneError, match=r"gears\.pinion_inertia = -1: .* \(and 2 more errors\)$"):
        Scene.from_dict(data)
    data["run"]["duration"] = 1
    with pytest.raises(SceneError, match=r"\(and 1 more error\)$"):
        Scene.from_dict(data)


@pytest.mark.parametrize("data", [None, [], "x", 5, {1: 2}, {}])
def test_from_dict_wants_tables(data: Any) -> None:
    with pytest.raises(SceneError):
        Scene.from_dict(data)


@pytest.mark.parametrize("changes", [None, [], "x", 5])
def test_replace_wants_a_mapping(gears: Scene, changes: Any) -> None:
    with pytest.raises(SceneError, match="must be a mapping"):
        gears.replace(changes)


def test_construction_speaks_the_same_language() -> None:
    with pytest.raises(SceneError, match=r"^surface = .*is required"):
        Scene()
    with pytest.raises(SceneError, match=r"sam_fraction = 2: must lie in 0\.\.1"):
        Coating(sam_fraction=2)
    with pytest.raises(SceneError, match="unknown key"):
        Drive(tork=1)  # type: ignore[call-arg]


def test_values_that_cannot_be_shown(gears: Scene) -> None:
    class Rude:
        def __repr__(self) -> str:
            raise RuntimeError

    with pytest.raises(SceneError, match=r"run\.rtol = \(Rude\): must be a number"):
        gears.replace({"run.rtol": Rude()})
    with pytest.raises(SceneError, match=r"run\.rtol = \(int\): must be a finite number"):
        gears.replace({"run.rtol": 10**5000})
    with pytest.raises(SceneError, match=r"run\.rtol = \['x{55}\.\.\.: must be a number"):
        gears.replace({"run.rtol": ["x" * 10_000]})
    with pytest.raises(SceneError, match=r"contact\.bodies = '\\x1b\[2J'"):
        gears.replace({"contact.bodies": "\x1b[2J"})


def test_scenes_cannot_be_changed_in_place(gears: Scene) -> None:
    with pytest.raises(SceneError, match="cannot be changed in place"):
        gears.name = "other"
    with pytest.raises(SceneError, match="cannot be changed in place"):
        gears.surface.roughness = 1e-9  # type: ignore[misc]
    assert gears == preset("teodorescu2009")


def test_errors_survive_the_trip_between_processes(gears: Scene) -> None:
    with pytest.raises(SceneError) as caught:
        gears.replace({"coating.sam_fraction": 2})
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.key, again.value, again.allowed) == ("coating.sam_fraction", 2, "must lie in 0..1")


def test_an_interrupt_stays_one(gears: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where pydantic writes the scene, which makes an error of its own out of what it calls."""

    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    ramp = [(0.1 * number, 1e-18 * number) for number in range(PACKED_ABOVE + 1)]
    scene = gears.replace({"drive.schedule": ramp})
    monkeypatch.setattr("gearidae.scene.knots.pack_knots", interrupted)
    with pytest.raises(KeyboardInterrupt):
        scene.to_dict()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)


@given(st.sampled_from([*(info.key for info in describe_keys()), *Scene.model_fields]), JSON)
def test_anything_is_taken_or_refused(key: str, value: Any) -> None:
    """No key and no value brings out any other exception."""
    scene = preset("teodorescu2009")
    try:
        changed = scene.replace({key: value})
    except SceneError as error:
        lines = str(error).splitlines()
    else:
        lines = [str(changed.name)]
        assert Scene.from_dict(changed.to_dict()) == changed
    assert len(lines) == 1


def test_surfaces_are_checked_on_their_own(gears: Scene) -> None:
    with pytest.raises(SceneError, match="roughness = -1"):
        Surface(**{**gears.surface.model_dump(), "roughness": -1})


def test_all_missing_keys_are_named_at_once(gears: Scene) -> None:
    data = gears.to_dict()
    del data["gears"]["face_width"], data["mesh"]["backlash"], data["run"]
    with pytest.raises(SceneError, match=r"is required: .*; so are mesh\.backlash, run$") as caught:
        Scene.from_dict(data)
    assert caught.value.key == "gears.face_width"


def test_a_misspelt_law_is_called_so(gears: Scene) -> None:
    """And not its parameters."""
    law = {"name": "microengin", "radius": "17 um", "force": "1 uN"}
    with pytest.raises(SceneError, match=r"^drive\.law\.name = microengin: .*did you mean microengine\?$"):
        gears.replace({"drive.law": law})
    with pytest.raises(SceneError, match=r"did you mean hertz\?$"):
        gears.replace({"contact.asperity": "herz"})
    with pytest.raises(SceneError, match=r"drive\.law\.name = 7: must be one of"):
        gears.replace({"drive.law": {"name": 7}})
