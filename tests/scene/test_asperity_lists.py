"""Lists of asperities in a scene: files, frames and columns, and everything that is none."""

import json

import pandas as pd
import pytest

from gearidae.errors import SceneError
from gearidae.scene import Scene, dump_case, load_case, preset

GEARS = preset("teodorescu2009").replace({"contact.roughness": "discrete"})
TEXT = "arc [um],height [nm],radius [nm],flank\n1,10,450,\n2,12,,coast\n"
PLACES, HEIGHTS = (1e-6, 2e-6), (10e-9, 12e-9)


def listed(value):
    return GEARS.replace({"contact.asperities": value}).contact.asperities


def assert_listed(rows):
    assert [row.place for row in rows] == pytest.approx(PLACES, rel=1e-15, abs=0)
    assert [row.height for row in rows] == pytest.approx(HEIGHTS, rel=1e-15, abs=0)
    assert [row.radius for row in rows] == [pytest.approx(450e-9, rel=1e-15, abs=0), None]
    assert [row.flank for row in rows] == [None, "coast"]


def test_a_file_beside_the_case(tmp_path, monkeypatch):
    (tmp_path / "list.csv").write_text(TEXT)
    case = dump_case(GEARS).replace("[contact]", '[contact]\nasperities = { file = "list.csv" }', 1)
    (tmp_path / "case.toml").write_text(case)
    monkeypatch.chdir("/")
    assert_listed(load_case(tmp_path / "case.toml").contact.asperities)


def test_a_frame_and_columns_in_si_units(tmp_path):
    (tmp_path / "list.csv").write_text(TEXT)
    frame = pd.read_csv(tmp_path / "list.csv")
    assert_listed(listed(frame))
    assert_listed(listed({"data": frame}))
    columns = {"arc": PLACES, "height": HEIGHTS, "radius": [450e-9, None], "flank": ["", "coast"]}
    assert_listed(listed(columns))


def test_the_list_travels_with_its_scene(tmp_path):
    scene = GEARS.replace(
        {"contact.asperities": {"arc": PLACES, "height": HEIGHTS, "tooth": [3, None], "q": [0.1, 0.2]}}
    )
    assert Scene.from_dict(json.loads(json.dumps(scene.to_dict()))) == scene
    (tmp_path / "case.toml").write_text(dump_case(scene))
    assert load_case(tmp_path / "case.toml") == scene
    assert scene.replace({"contact.asperities": []}) == GEARS
    assert "2 cells" in repr(scene)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"arc": [1e-6]}, "needs the columns arc"),
        ({"arc": [1e-6], "height": [1e-8, 2e-8]}, "as many rows"),
        ({"arc": [1e-6], "height": [None]}, "column 'height', row 1 is empty"),
        ({"arc": [1e-6], "height": ["a"]}, "row 1 is a, no number"),
        ({"arc": [1e-6], "height": [1.0]}, "row 1 is 1; must lie in"),
        ({"arc": [1e-6], "height": [1e-8], "q": [1.5]}, "column 'q', row 1 is 1.5"),
        ({"arc": [1e-6], "height": [1e-8], "tooth": [1.5]}, "whole number"),
        ({"arc": [1e-6], "height": [1e-8], "tooth": [19]}, "must be below 19"),
        ({"arc": [1e-6], "height": [1e-8], "flank": ["left"]}, "must be drive, coast or empty"),
        ({"arc": [1e-6], "height": [1e-8], "colour": [1]}, "unknown column 'colour'"),
        ({"x": [1e-6], "height": [1e-8]}, "must have the column arc in place of x"),
        ({"file": "none.csv"}, "there is no file none.csv"),
        ({"file": "none.csv", "arc": [1.0]}, "file is enough"),
        (pd.DataFrame({"arc": [1.0], "height [nm]": [1.0]}), "needs its unit in the heading"),
        (pd.DataFrame({"arc [s]": [1.0], "height [nm]": [1.0]}), "does not fit"),
        ({"data": pd.DataFrame({"arc [um]": [], "height [nm]": []})}, "must have 1..100000 rows"),
        (7, "must be a table with a file"),
    ],
)
def test_what_is_no_list_is_refused_by_column_and_row(value, message):
    with pytest.raises(SceneError, match=r"contact\.asperities") as refused:
        listed(value)
    assert message in str(refused.value)


def test_a_list_needs_the_model_that_reads_it():
    with pytest.raises(SceneError, match=r'needs contact\.roughness = "discrete"'):
        preset("teodorescu2009").replace({"contact.asperities": {"arc": [1e-6], "height": [1e-8]}})
    with pytest.raises(SceneError, match="a roller has no coast flank"):
        preset("roller_slow").replace(
            {
                "contact.roughness": "discrete",
                "contact.asperities": {"x": [0.0], "height": [1e-8], "flank": ["coast"]},
            }
        )


def test_a_list_with_decimal_commas_and_bad_rows(tmp_path):
    """Read by the reader of all tables: no comma is lost, and no row is shifted."""
    path = tmp_path / "list.csv"
    path.write_text("arc [um];height [nm];flank\n4,5;1,25;drive\n5;-2;\n")
    first, second = listed({"file": str(path)})
    assert (first.place, first.height, first.flank) == (
        pytest.approx(4.5e-6, rel=1e-12, abs=0),
        pytest.approx(1.25e-9, rel=1e-12, abs=0),
        "drive",
    )
    assert second.flank is None
    for row, reason in (
        ("4;1.234;drive", r"row 3 is '1.234'; ',' is taken for the decimal sign"),
        ("4;1;drive;2", "line 4: row 3 has 4 cells, but there are 3 headings"),
    ):
        path.write_text(f"arc [um];height [nm];flank\n4,5;1,25;drive\n5;-2;\n{row}\n")
        with pytest.raises(SceneError, match=rf"contact\.asperities.*{reason}"):
            listed({"file": str(path)})
