"""How a scene shows itself."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest

from gearidae.scene import PRESETS, preset
from gearidae.scene.scene_display import differences, nearest_preset, value_text

WORN = preset("teodorescu2009_low_speed").replace({"name": "worn", "coating.sam_fraction": 0.5})


class Cells(HTMLParser):
    """Rows of a table, as lists of texts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.open: list[str] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data


def test_a_line_says_what_it_is_and_what_differs() -> None:
    line = "<Scene 'worn': gears 19:76, SAM 50 %, 300 ms, as teodorescu2009_low_speed but coating.sam_fraction = 0.5>"
    assert repr(WORN) == str(WORN) == line


@pytest.mark.parametrize("name", PRESETS)
def test_lines_are_short(name: str) -> None:
    """Once 800 characters."""
    assert len(repr(preset(name))) < 120
    assert repr(preset(name)).endswith(f"as {name}>")


def test_what_is_gone_and_what_is_left_out_is_said() -> None:
    scene = preset("start_up").replace(
        {
            "name": "x",
            "drive.schedule": [],
            "drive.torque": 1e-11,
            "gears.pinion_inertia": 3e-20,
            "run.rtol": 1e-7,
        }
    )
    assert differences(scene, "start_up").keys() == {
        "gears.pinion_inertia",
        "drive.torque",
        "drive.schedule",
        "run.rtol",
    }
    assert repr(scene).endswith(
        "as start_up but gears.pinion_inertia = 3e-20 kg m^2, drive.torque = 10 pN m, run.rtol = 1e-07, 1 more>"
    )


def test_a_table_has_every_key_with_its_unit_and_marks_what_differs() -> None:
    rows = Cells(WORN._repr_html_()).rows
    shown = {row[0]: row[1:] for row in rows if len(row) == 3}
    assert shown["pinion_base_radius"] == ["34.715 um", ""]
    assert shown["pressure_angle"] == ["20 deg", ""]
    assert shown["duration"] == ["300 ms", ""]
    assert shown["sam_fraction"] == ["0.5", "preset: 1"]
    assert [row[1] for row in rows if len(row) == 3 and row[2]] == ["0.5"]


def test_names_are_escaped() -> None:
    shown = WORN.replace({"name": "<script>alert(1)</script>"})._repr_html_()
    assert "<script>" not in shown
    assert "&lt;script&gt;" in shown


def test_no_preset_is_near_a_scene_of_its_own() -> None:
    changes = {f"surface.{key}": value for key, value in {"energy": 0.3, "youngs_modulus": 70e9}.items()}
    near = WORN.replace(changes)
    assert nearest_preset(near) == "teodorescu2009_low_speed"
    far = near.replace(
        {
            "gears.pinion_inertia": 1e-20, "gears.gear_inertia": 1e-19, "gears.pinion_base_radius": 30e-6,
            "gears.pinion_teeth": 20, "gears.gear_teeth": 60, "gears.face_width": 3e-6, "mesh.backlash": 3e-7,
            "mesh.tip_relief_radius": 2e-5, "surface.roughness": 7e-9, "initial.gap": 40e-9, "run.duration": 0.1,
        }
    )  # fmt: skip
    assert nearest_preset(far) == ""
    assert " as " not in repr(far)
    assert "compared with" not in far._repr_html_()


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("drive.torque", 4.5e-18, "4.5 aN m"),
        ("surface.youngs_modulus", 161e9, "161 GPa"),
        ("surface.asperity_density", 1.69e14, "1.69e+14 1/m^2"),
        ("initial.gear_speed", 2898.0, "2898 rad/s"),
        ("run.samples", 30001, "30001"),
        ("run.samples", "off", "off"),
        ("drive.schedule", [[0.0, 0.0], [0.01, 1e-11]], "2 knots from 0 s to 10 ms"),
    ],
)
def test_values_have_their_unit(key: str, value: object, text: str) -> None:
    assert value_text(key, value) == text
    assert not re.search(r"\d{9}", text)
