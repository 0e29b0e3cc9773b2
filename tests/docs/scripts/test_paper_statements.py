"""What the paper says beside its figures: closed forms, and the numbers that the page prints."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.asperities.tip import tabor_parameter
from gearidae_pages.paper_statements import (
    STATEMENTS,
    coast_contact,
    contact_time,
    root_stress,
    tip_radius_of_tabor,
)

PAGE = (Path(__file__).parents[3] / "docs" / "validation.md").read_text(encoding="utf-8")


def test_every_row_of_the_page_has_its_run():
    rows = [
        line for line in PAGE.splitlines() if line[:4] in {f"| {number} |"[:4] for number in range(1, 11)}
    ]
    listed = {int(line.split("|")[1]) for line in rows if line.split("|")[1].strip().isdigit()}
    assert set(STATEMENTS) == set(range(1, 11)) <= listed


def test_the_tip_radius_is_where_tabors_parameter_has_the_value():
    surface = gd.preset("roller_slow").surface
    radius = tip_radius_of_tabor(5.0, 161e9 / (2.0 * (1.0 - 0.23**2)), 3.0)
    assert tabor_parameter(surface.model_copy(update={"asperity_radius": radius})) == pytest.approx(
        5.0, rel=1e-12
    )
    assert f"{1e9 * radius:.0f} nm on" in PAGE


def test_the_root_stress_is_that_of_a_beam():
    """The same moment and section from coordinates: the load's line crosses the middle plane at the arm's end."""
    geometry = gd.preset("teodorescu2009").geometry
    base, module = geometry.base_radius_pinion, geometry.module
    angle = geometry.pressure_angle
    tip = base / math.cos(angle) + module
    half_base = 0.5 * math.pi / geometry.pinion_teeth + (math.tan(angle) - angle)
    roll = math.sqrt(
        (tip / base) ** 2 - 1.0
    )  # where the involute ends: the normal there touches the base circle
    theta = half_base - (roll - math.atan(roll))
    corner = np.array([tip * math.sin(theta), tip * math.cos(theta)])
    touched = half_base - roll
    foot = base * np.array([math.sin(touched), math.cos(touched)])
    normal = (foot - corner) / np.linalg.norm(foot - corner)
    crossing = corner - normal * corner[0] / normal[0]
    root = base / math.cos(angle) - 1.25 * module
    moment = abs(normal[0]) * (crossing[1] - root)
    thickness = 2.0 * root * math.sin(half_base)
    expected = 40e-6 * moment * 6.0 / (2e-6 * thickness**2)
    assert root_stress(geometry, 2e-6, 40e-6) == pytest.approx(expected, rel=1e-9)
    assert f"{1e-6 * expected:.0f} MPa" in PAGE


def test_contact_and_coast_of_a_drawn_run():
    import xarray as xr

    run = xr.Dataset(
        {
            "force": ("time", [0.0, 0.005, 0.5, 1.0, -0.2, -0.001]),
            "mesh_force": ("time", [1.0, 1.0, -1.0, 0.0, 1.0, 1.0]),
            "event_flank": ("event", [0, 1, 1, 1]),
            "event_kind": ("event", [0, 0, 4, 0]),
        },
        {"time": np.arange(6.0)},
    )
    assert contact_time(run) == 2.0
    assert coast_contact(run) == (2, pytest.approx(1.0 / 6.0))


@pytest.mark.parametrize(
    ("row", "printed"), [(1, "14.1, stretch 3.75 nm"), (7, "2.92 us bare, 2.11 us"), (9, "295.5 um")]
)
def test_cheap_rows_print_what_the_page_says(row, printed):
    assert any(printed in line for line in STATEMENTS[row]())


@pytest.mark.parametrize("radius_force", [False, True])
def test_only_freshly_broken_silicon_sticks(radius_force):
    """Row 10, within the 0.3 s of the figure, with either form of the changing radius."""
    bare = gd.preset("teodorescu2009_low_speed").replace(
        {"coating.sam_fraction": 0.0, "run.samples": "off", "mesh.radius_force": radius_force}
    )
    verdicts = []
    for energy in (1.0, 0.8, 0.072):
        run = gd.simulate(bare.replace({"surface.energy": energy}))
        verdicts += [outcome.verdict for outcome in gd.outcomes(run)]
    assert verdicts == ["sticks", "turns smoothly", "turns smoothly"]
    assert float(run.min_gear_speed) > 1.45  # of the last
