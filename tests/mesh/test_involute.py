"""The path of contact against coordinates, textbook limits and the preset's numbers."""

import dataclasses
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.mesh import Geometry, GeometryError, check_geometry, curvature_radii, mesh_geometry, separation

PAPER = (34.715e-6, 19, 76, math.radians(20))

# Closed forms of a few operations: what differs is rounding, a few times 1e-16 of the largest length, which
# exceeds the results by one digit or two.
ROUNDING = 1e-13


@pytest.fixture
def paper() -> Geometry:
    return mesh_geometry(*PAPER)


@st.composite
def runnable(draw: st.DrawFn) -> Geometry:
    """Pairs that can run: 20..25 degrees and at least 18 teeth never undercut."""
    return mesh_geometry(
        draw(st.floats(1e-6, 1e-3)),
        draw(st.integers(18, 200)),
        draw(st.integers(18, 200)),
        math.radians(draw(st.floats(20, 25))),
    )


def tip_crossings(base_radius: float, z1: int, z2: int, angle: float) -> tuple[float, float]:
    """Approach and recess from coordinates: where the line of action cuts the two tip circles."""
    module = 2 * base_radius / (z1 * math.cos(angle))
    pitch1, pitch2 = module * z1 / 2, module * z2 / 2
    direction = np.array(
        [math.sin(angle), math.cos(angle)]
    )  # the line runs through the pitch point, the origin

    def cut(centre: np.ndarray, tip: float) -> np.ndarray:
        # |t direction - centre|^2 = tip^2
        return np.roots([1.0, -2 * direction @ centre, centre @ centre - tip**2])

    approach = -min(cut(np.array([pitch2, 0.0]), pitch2 + module))
    recess = max(cut(np.array([-pitch1, 0.0]), pitch1 + module))
    return float(approach), float(recess)


def test_contact_ratio_of_the_paper(paper: Geometry) -> None:
    assert paper.contact_ratio == pytest.approx(1.681, abs=5e-4)  # to the digits stated


def test_gear_radius_follows_from_the_teeth(paper: Geometry) -> None:
    assert paper.base_radius_gear == pytest.approx(138.86e-6, rel=ROUNDING, abs=0)


@given(runnable())
def test_path_ends_where_the_tip_circles_cut_the_line_of_action(geometry: Geometry) -> None:
    approach, recess = tip_crossings(
        geometry.base_radius_pinion, geometry.pinion_teeth, geometry.gear_teeth, geometry.pressure_angle
    )
    # The quadratic's roots cancel to module over radius, 200 teeth at most: four digits fewer than double.
    assert geometry.approach == pytest.approx(approach, rel=1e-11, abs=0)
    assert geometry.recess == pytest.approx(recess, rel=1e-11, abs=0)


@given(runnable())
def test_flanks_reach_from_tip_to_tip(geometry: Geometry) -> None:
    """At either end one flank's radius of curvature is that of an involute at its tip circle."""
    pinion, gear, _ = curvature_radii(geometry, [0.0, geometry.path_length])

    def at_tip(radius: float) -> float:
        return math.sqrt((radius / math.cos(geometry.pressure_angle) + geometry.module) ** 2 - radius**2)

    assert pinion[1] == pytest.approx(at_tip(geometry.base_radius_pinion), rel=ROUNDING, abs=0)
    assert gear[0] == pytest.approx(at_tip(geometry.base_radius_gear), rel=ROUNDING, abs=0)


@given(runnable())
def test_base_pitch_is_common_to_both_gears(geometry: Geometry) -> None:
    assert geometry.base_pitch * geometry.gear_teeth == pytest.approx(
        2 * math.pi * geometry.base_radius_gear, rel=ROUNDING, abs=0
    )


@given(runnable(), st.floats(-0.5, 1.5))
def test_radii_add_up_along_the_path_and_stay_beyond_it(geometry: Geometry, where: float) -> None:
    xi = where * geometry.path_length
    pinion, gear, reduced = curvature_radii(geometry, xi)
    total = geometry.tangent_pinion + geometry.tangent_gear
    assert pinion > 0
    assert gear > 0
    assert pinion + gear == pytest.approx(total, rel=ROUNDING, abs=0)
    assert 1 / reduced == pytest.approx(1 / pinion + 1 / gear, rel=ROUNDING, abs=0)
    inside = min(max(xi, 0.0), geometry.path_length)
    assert pinion == curvature_radii(geometry, inside)[0]


def test_radii_at_the_pitch_point(paper: Geometry) -> None:
    pinion, gear, _ = curvature_radii(paper, paper.approach)
    assert pinion == pytest.approx(
        paper.base_radius_pinion * math.tan(paper.pressure_angle), rel=ROUNDING, abs=0
    )
    assert gear == pytest.approx(4 * pinion, rel=ROUNDING, abs=0)


@given(runnable(), st.floats(0.1, 10))
def test_geometry_scales_with_the_gears(geometry: Geometry, scale: float) -> None:
    scaled = mesh_geometry(
        geometry.base_radius_pinion * scale,
        geometry.pinion_teeth,
        geometry.gear_teeth,
        geometry.pressure_angle,
    )
    assert scaled.path_length == pytest.approx(
        geometry.path_length * scale, rel=1e-11, abs=0
    )  # cancels as above
    assert scaled.contact_ratio == pytest.approx(geometry.contact_ratio, rel=1e-11, abs=0)


@given(runnable(), st.floats(-1, 2), st.floats(1e-6, 1e-4))
def test_separation_is_a_parabola_beyond_the_ends(geometry: Geometry, where: float, rho: float) -> None:
    xi = where * geometry.path_length
    s, slope = separation(geometry, xi, rho)
    beyond = xi if xi < 0 else max(xi - geometry.path_length, 0.0)
    assert s == pytest.approx(beyond**2 / (2 * rho), rel=ROUNDING, abs=1e-300)
    assert slope == pytest.approx(beyond / rho, rel=ROUNDING, abs=1e-300)


def test_separation_opens_outwards_and_vanishes_on_the_path(paper: Geometry) -> None:
    xi = np.array([[-1e-6, 0.0], [paper.path_length / 2, paper.path_length + 1e-6]])
    s, slope = separation(paper, xi, 10e-6)
    assert s.shape == slope.shape == xi.shape
    assert s[0, 1] == slope[0, 1] == s[1, 0] == slope[1, 0] == 0
    assert slope[0, 0] < 0 < slope[1, 1]
    # (1 um)^2 / (2 * 10 um); at the far end xi - path_length cancels one digit in twenty.
    assert s[[0, 1], [0, 1]] == pytest.approx(0.05e-6, rel=1e-12, abs=0)


@pytest.mark.parametrize(("teeth", "runs"), [(17, False), (18, True)])
def test_undercut_begins_at_the_textbook_number_of_teeth(teeth: int, runs: bool) -> None:
    """Against a rack (a gear of very many teeth) undercut begins below 2 / sin^2(20 deg) = 17.1 teeth."""
    if runs:
        assert mesh_geometry(1e-5, teeth, 1_000_000, math.radians(20)).contact_ratio > 1
    else:
        with pytest.raises(GeometryError, match="undercut the pinion") as caught:
            mesh_geometry(1e-5, teeth, 1_000_000, math.radians(20))
        assert caught.value.parameter == "pinion_teeth"


def test_the_gear_may_be_the_one_that_is_undercut() -> None:
    with pytest.raises(GeometryError, match="undercut the gear") as caught:
        mesh_geometry(1e-5, 76, 10, math.radians(20))
    assert caught.value.parameter == "gear_teeth"


@pytest.mark.parametrize(("degrees", "runs"), [(38.0, True), (38.3, False)])
def test_teeth_come_to_a_point_at_the_textbook_angle(degrees: float, runs: bool) -> None:
    """Rack teeth of full height are pointed where pi/4 = tan(alpha), at 38.15 degrees."""
    if runs:
        assert mesh_geometry(1e-3, 10_000, 10_000, math.radians(degrees)).contact_ratio > 1
    else:
        with pytest.raises(GeometryError, match="come to a point") as caught:
            mesh_geometry(1e-3, 10_000, 10_000, math.radians(degrees))
        assert caught.value.parameter == "pressure_angle"


def test_contact_ratio_below_one_is_refused(paper: Geometry) -> None:
    """Teeth of full height never come to this; stubbed ones do."""
    stubbed = dataclasses.replace(paper, approach=paper.approach / 2, recess=paper.recess / 2)
    with pytest.raises(GeometryError, match=r"contact ratio 0\.841 is below 1") as caught:
        check_geometry(stubbed)
    assert caught.value.parameter == "pressure_angle"


def test_errors_survive_the_trip_between_processes() -> None:
    error = pickle.loads(pickle.dumps(GeometryError("gear_teeth", "too few")))
    assert (error.parameter, error.reason, str(error)) == ("gear_teeth", "too few", "gear_teeth: too few")
