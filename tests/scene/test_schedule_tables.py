"""Schedules from tables: files, frames, arrays and packed knots, and everything that is none."""

import json
import pickle

import numpy as np
import pandas as pd
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.archive.attributes import readable_scene
from gearidae.errors import SceneError
from gearidae.scene import Knots, Scene, dump_case, load_case, preset
from gearidae.scene.schedule_table import pack_knots, unpack_knots

LOW = preset("teodorescu2009_low_speed")
TIMES, TORQUES = [0.0, 1.5, 4.0], [0.0, 2.0, 1.0]  # ms, pN m
SI = tuple((t * 1e-3, v * 1e-12) for t, v in zip(TIMES, TORQUES, strict=True))
NAMES = {"time": "t [ms]", "value": "M [pN m]"}


def frame():
    return pd.DataFrame({"t [ms]": TIMES, "M [pN m]": TORQUES, "note": ["a", "b", "c"]})


@pytest.fixture
def csv(tmp_path):
    frame().to_csv(tmp_path / "drive.csv", index=False)
    return tmp_path / "drive.csv"


def schedule(value):
    return LOW.replace({"drive.schedule": value}).drive.schedule


def assert_knots(knots, interpolation="linear"):
    np.testing.assert_allclose(np.array(knots), np.array(SI), rtol=1e-15)
    assert knots.interpolation == interpolation


def test_a_file_beside_the_case(csv, tmp_path, monkeypatch):
    table = '{ file = "drive.csv", time = "t [ms]", value = "M [pN m]", interpolation = "cubic" }'
    (tmp_path / "case.toml").write_text(
        dump_case(LOW).replace("[drive]", f"[drive]\nschedule = {table}").replace("torque = ", "torque = ", 1)
    )
    monkeypatch.chdir("/")
    assert_knots(load_case(tmp_path / "case.toml").drive.schedule, "cubic")


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_tables_in_python(csv, interpolation):
    registry = pint.UnitRegistry()
    quantities = {"time": TIMES * registry.ms, "value": TORQUES * registry("pN m")}
    arrays = {"time": np.array(TIMES) * 1e-3, "value": np.array(TORQUES) * 1e-12}
    for table in (
        {"file": str(csv), **NAMES},
        {"data": frame(), **NAMES},
        {"data": frame().rename(columns={"t [ms]": "t"}), **NAMES},
        {"data": frame()[["t [ms]", "M [pN m]"]]},
        quantities,
        arrays,
        {"knots": [[f"{t} ms", f"{v} pN m"] for t, v in zip(TIMES, TORQUES, strict=True)]},
    ):
        assert_knots(schedule(table | {"interpolation": interpolation}), interpolation)
    assert_knots(schedule(frame()[["t [ms]", "M [pN m]"]]))


def test_a_speed_may_be_a_number_or_a_schedule():
    held = LOW.replace({"drive.speed": "60 rpm", "drive.speed_gain": 1e-15})
    assert held.drive.speed == pytest.approx(2 * np.pi, rel=1e-15)
    assert held.drive.speed_knots() == ((0.0, held.drive.speed),)
    ramp = held.replace({"drive.speed": {"time": [0, 1], "value": [1, 2], "interpolation": "cubic"}})
    assert ramp.drive.speed.interpolation == "cubic"
    for scene in (held, ramp):
        assert Scene.from_dict(json.loads(json.dumps(scene.to_dict()))) == scene


@pytest.mark.parametrize("count", [3, 700])
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_scene_goes_through_json_case_and_pickle_exactly(count, interpolation, tmp_path):
    rng = np.random.default_rng(3)
    knots = np.column_stack([np.cumsum(rng.uniform(1e-6, 2e-6, count)), 1e-12 * rng.standard_normal(count)])
    scene = LOW.replace({"drive.schedule": {"knots": knots, "interpolation": interpolation}})
    assert Scene.from_dict(json.loads(json.dumps(scene.to_dict()))) == scene
    (tmp_path / "case.toml").write_text(dump_case(scene))
    assert load_case(tmp_path / "case.toml").drive == scene.drive
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene
    assert again.drive.schedule.interpolation == interpolation
    other = scene.replace({"drive.schedule": {"knots": knots, "interpolation": "linear"}})
    assert (other == scene) == (interpolation == "linear")


def test_many_knots_take_little_room():
    """10,000 knots at even times: less than a fifth of the half megabyte that decimals take."""
    times = np.linspace(0, 0.02, 10_000)
    smooth = 1e-12 * np.sin(2000 * times)
    scene = LOW.replace({"drive.schedule": {"time": times, "value": smooth, "interpolation": "cubic"}})
    assert len(json.dumps(scene.to_dict())) < 110_000
    assert len(json.dumps([list(pair) for pair in scene.drive.schedule])) > 400_000


@given(st.lists(st.tuples(st.floats(), st.floats()), min_size=1, max_size=50))
def test_packing_keeps_every_bit(pairs):
    knots = np.array(pairs, "<f8")
    assert np.array(unpack_knots(pack_knots(knots.tolist()))).tobytes() == knots.tobytes()


BAD = [
    ({"t [ms]": [0, 1, 1]}, "times must strictly increase.*knot 3"),
    ({"t [ms]": [0, 2, 1]}, "times must strictly increase.*knot 3"),
    ({"M [pN m]": [0, np.nan, 1]}, r"column 'M \[pN m\]', row 2 is nan"),
    ({"M [pN m]": [0, None, 1]}, r"column 'M \[pN m\]', row 2"),
    ({"M [pN m]": [0, "x", 1]}, r"column 'M \[pN m\]', row 2 is 'x', no number"),
    ({"t [ms]": [0, "", 1]}, r"column 't \[ms\]', row 2 is empty"),
    ({"M [pN m]": [0, np.inf, 1]}, r"column 'M \[pN m\]', row 2 is inf"),
]


@pytest.mark.parametrize(("change", "message"), BAD)
@pytest.mark.parametrize("source", ["data", "file"])
def test_a_bad_cell_is_named_with_column_and_row(change, message, source, tmp_path):
    bad = frame().assign(**{name: pd.Series(cells, dtype=object) for name, cells in change.items()})
    if source == "file":
        bad.to_csv(tmp_path / "bad.csv", index=False)
        message = message.replace(" is nan", " is empty")
    value = {"data": bad} if source == "data" else {"file": str(tmp_path / "bad.csv")}
    with pytest.raises(SceneError, match=f"^drive.schedule.*{message}"):
        schedule(value | NAMES)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"data": frame(), "time": "t [ms]", "value": "M"}, "column 'M' is not among the columns"),
        ({"data": frame(), "time": "t [ms]"}, "value must be the name of a column"),
        ({"data": frame().rename(columns={"t [ms]": "t [kg]"}), "time": "t [kg]", "value": "M [pN m]"}, "kg"),
        (
            {"data": frame(), "time": "M [pN m]", "value": "t [ms]"},
            "column 'M .pN m.': the unit .* does not fit",
        ),
        ({"file": "none.csv", **NAMES}, "there is no file none.csv"),
        ({"file": 5, **NAMES}, "file must be the name of a CSV file"),
        ({"data": 5, **NAMES}, "data must be a DataFrame"),
        ({"fiel": "x"}, "unknown key 'fiel'"),
        ({"knots": [[0, 1]], "interpolation": "quintic"}, "interpolation 'quintic'"),
        ({"knots": [[0, 1]], "file": "x"}, "one of them is enough"),
        ({"time": [0, 1], "value": [1, 2, 3]}, "time has 2 rows and value 3"),
        ({"time": [[0, 1]], "value": [1]}, "must be one-dimensional"),
        ({"time": [0.0]}, "needs file, data or knots"),
        ({"packed": "x"}, "packed knots are damaged"),
        ({"packed": 5}, "packed knots are damaged"),
    ],
)
def test_a_bad_table_is_named(table, message):
    with pytest.raises(SceneError, match=f"^drive.schedule.*{message}"):
        schedule(table)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"drive.speed": 5.0}, "drive.speed_gain.*above 0"),
        ({"drive.speed_gain": 1e-15}, "drive.speed = .*required"),
        ({"drive.speed": "5 m", "drive.speed_gain": 1.0}, "drive.speed"),
        ({"drive.speed": [[0, 1], [0, 2]], "drive.speed_gain": 1.0}, "drive.speed.*strictly increase"),
        ({"drive.speed": [[0, np.nan]], "drive.speed_gain": 1.0}, r"drive.speed\[0\]\[1\]"),
        ({"load.viscous": -1.0}, "load.viscous"),
        ({"load.viscous": "1 N m"}, "load.viscous"),
    ],
)
def test_bad_speeds_and_drags(changes, message):
    with pytest.raises(SceneError, match=message):
        LOW.replace(changes)


def test_an_archive_cannot_make_a_reader_open_a_file():
    data = LOW.to_dict()
    data["drive"]["schedule"] = {"file": "/etc/hostname"}
    assert readable_scene(json.dumps(data)) is None
    assert readable_scene(json.dumps(LOW.to_dict())) is not None


def test_knots_equal_plain_tuples_only_if_linear():
    assert Knots(SI) == SI
    assert Knots(SI, "cubic") != SI
    assert hash(Knots(SI, "cubic")) == hash(SI)
    assert Knots((), "cubic") == ()


@pytest.mark.parametrize(
    "knots",
    [[["0 ms", "1 pN m"], [5, "2 pN m"]], [[0, "1 pN m"], ["5 ms", 2]], [[0, 1e-18], ["5 ms", 0], [6, 0]]],
)
def test_a_bare_number_beside_a_unit_is_refused(knots):
    with pytest.raises(SceneError, match=r"drive\.schedule.*has no unit beside"):
        schedule(knots)
