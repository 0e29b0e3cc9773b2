"""Case files: those shipped, and everything that is none."""

from pathlib import Path
from typing import Any

import pytest

from gearidae.errors import SceneError
from gearidae.scene import dump_case, load_case, preset
from gearidae.scene.literal import literal

SHIPPED = [
    *(
        "alternating",
        "braking",
        "high_speed",
        "inspection",
        "low_speed",
        "microengine",
        "roller_fast",
        "roller_slow",
    ),
    *("run_down", "running", "start_up", "transmission"),
]


def test_shipped_cases(cases: Path) -> None:
    assert sorted(path.stem for path in cases.glob("*.toml")) == SHIPPED
    for name in SHIPPED:
        assert load_case(cases / f"{name}.toml").name == name


@pytest.mark.parametrize(
    ("case", "name"),
    [
        ("high_speed", "teodorescu2009"),
        ("low_speed", "teodorescu2009_low_speed"),
        ("roller_slow", "roller_slow"),
        ("roller_fast", "roller_fast"),
    ],
)
def test_cases_are_the_presets(cases: Path, case: str, name: str) -> None:
    assert load_case(str(cases / f"{case}.toml")).replace({"name": name}) == preset(name)


@pytest.mark.parametrize("case", ["start_up", "braking", "alternating"])
def test_long_cases_drive_the_papers_gears_by_schedule(cases: Path, case: str) -> None:
    scene, paper = load_case(cases / f"{case}.toml"), preset("teodorescu2009")
    assert (scene.gears, scene.mesh, scene.surface, scene.load) == (
        paper.gears,
        paper.mesh,
        paper.surface,
        paper.load,
    )
    assert scene.drive is not None
    assert paper.drive is not None
    highest = scene.drive.torque + max(torque for _, torque in scene.drive.schedule)
    assert highest == pytest.approx(paper.drive.torque, rel=1e-12, abs=0)  # a sum of two decimals
    assert scene.drive.schedule[-1][0] < scene.run.duration


def test_a_chain_of_cases_is_of_the_same_gears(cases: Path) -> None:
    scenes = [load_case(cases / f"{name}.toml") for name in ("start_up", "running", "run_down")]
    for scene in scenes[1:]:
        for table in ("gears", "mesh", "surface", "contact", "coating", "load"):
            assert getattr(scene, table) == getattr(scenes[0], table)
    assert scenes[2].drive is not None
    begin = sum(scene.run.duration for scene in scenes[:2])
    assert scenes[2].drive.schedule[0][0] == pytest.approx(begin, rel=1e-12, abs=0)  # a sum of two decimals


def test_name_may_be_given(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(dump_case(preset("roller_slow")))
    assert load_case(path).name == "roller_slow"


@pytest.mark.parametrize("stem", [" ", "a\nb", "x" * 230])
def test_odd_file_names_still_name_a_scene(tmp_path: Path, stem: str) -> None:
    path = tmp_path / f"{stem}.toml"
    path.write_text(dump_case(preset("roller_slow")).partition("\n")[2])
    assert load_case(path).name


def test_byte_order_mark_and_windows_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "roller_slow.toml"
    path.write_bytes(b"\xef\xbb\xbf" + dump_case(preset("roller_slow")).replace("\n", "\r\n").encode())
    assert load_case(path) == preset("roller_slow")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"# nothing but a comment\n", "is empty"),
        (b"[gears\n", "is not TOML"),
        (b"name = 1\nname = 2\n", "is not TOML"),
        (b"x = " + b"[" * 20_000, "is not TOML: nested too deeply"),
        (b"x = " + b"9" * 10_000, "is not TOML"),
        (b"\xff\xfe\x00", "is not a text file in UTF-8"),
        (b"\x00\x01\x02", "is not TOML"),
        (b"#" * 2_000_000, "is longer than"),
        (b"[mesh]\nbacklash = 0.2 um # a remark\n", r"line 2.*: quote a number with its unit, \"0\.2 um\"$"),
        (b"x = {torque = 5 aN m}\n", r": quote a number with its unit, \"5 aN m\"$"),
        (b'x = ["1 um", 2um]\n', r": quote a number with its unit, \"2um\"$"),
        (b"x = 60 %\n", r": quote a number with its unit, \"60 %\"$"),
        (b"x = 05\n", r"column \d+\)$"),
        (b'x = "5 um" y\n', r"column \d+\)$"),
    ],
)
def test_files_that_are_no_case(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=reason) as caught:
        load_case(path)
    assert caught.value.key == "case file"
    assert "\n" not in str(caught.value)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"nowhere\.toml: no such file|\.\.\.: no such file"):
        load_case(tmp_path / "nowhere.toml")
    with pytest.raises(SceneError, match="is a folder"):
        load_case(tmp_path)
    with pytest.raises(SceneError, match="cannot be read"):
        load_case("nul\0byte.toml")
    with pytest.raises(SceneError, match="cannot be read"):
        load_case("x" * 100_000)


@pytest.mark.parametrize("path", [None, 0, b"x.toml", ["x"]])
def test_paths_that_are_none(path: Any) -> None:
    with pytest.raises(SceneError, match="must be a path"):
        load_case(path)


def test_files_that_must_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:  # file modes would not stop a superuser's test run
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(SceneError, match="cannot be read: Permission denied"):
        load_case(tmp_path / "case.toml")


@pytest.mark.parametrize(
    ("line", "wrong", "key"),
    [
        ('roughness = "6 nm"', "roughness = nan", "surface.roughness"),
        ('roughness = "6 nm"', "roughness = -inf", "surface.roughness"),
        ('roughness = "6 nm"', "roughness = 2024-01-01", "surface.roughness"),
        ('roughness = "6 nm"', "roughnes = 6e-9", "surface.roughnes"),
        ("[gears]", "[geers]", "geers"),
        ("[drive]", "[drive]\nschedule = [[0.0, 1e-12], [0.0, 0.0]]", "drive.schedule"),
        ("[drive]", "[drive]\nschedule = []", "drive.schedule"),
        ("[gears]", "gap = 1\n[gears]", "gap"),
    ],
)
def test_wrong_lines_are_named(tmp_path: Path, cases: Path, line: str, wrong: str, key: str) -> None:
    text = (cases / "low_speed.toml").read_text()
    assert line in text
    path = tmp_path / "case.toml"
    path.write_text(text.replace(line, wrong))
    with pytest.raises(SceneError) as caught:
        load_case(path)
    assert caught.value.key == key


@pytest.mark.parametrize(
    "text",
    ["a." * 400_000 + "a = 1", "[" + "'a' . " * 100_000 + "a]", 'x = {"a".' + "b." * 100_000 + "b = 1}"],
)
def test_key_of_very_many_parts_is_refused_and_not_read(
    tmp_path: Path, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """tomllib needs gigabytes and minutes for it."""
    monkeypatch.setattr("tomllib.loads", lambda text: pytest.fail("it was read"))
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(SceneError, match="a key of more than 32 parts"):
        load_case(path)


def test_many_numbers_and_dots_are_no_long_key(tmp_path: Path, cases: Path) -> None:
    text = (cases / "low_speed.toml").read_text()
    knots = ", ".join(f"[0.{i:03}, 1.5e-18]" for i in range(500))
    path = tmp_path / "case.toml"
    path.write_text(
        text.replace("[drive]", f"[drive]\nschedule = [{knots}]  # a.b.c, see gearidae.scene.case")
    )
    scene = load_case(path)
    assert scene.drive is not None
    assert len(scene.drive.schedule) == 500


@pytest.mark.parametrize(
    "text", ["{" + "a." * 50_000 + "a = 1}", "1" * 5000, "[" * 5000, "{a=" * 300 + "1" + "}" * 300]
)
def test_values_that_no_table_holds_are_refused_in_a_line(text: str) -> None:
    with pytest.raises(SceneError) as caught:
        preset("teodorescu2009").replace({"drive": literal(text)})
    assert caught.value.key.startswith("drive")
    assert len(str(caught.value)) < 250
