"""The teeth in mesh: involutes that touch where they should, and pictures that say what the record says."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from matplotlib.path import Path as Outline
from PIL import Image

import gearidae as gd
from gearidae.cli import main
from gearidae.plot.asperities import half_width, joined_asperities, rough_sample
from gearidae.plot.teeth_view import TeethView
from gearidae.plot.tooth_shape import contact_points, tooth_outline
from gearidae.records import Flank
from gearidae.studies._tooth_contacts import tooth_contacts

SCENE = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
PICTURE = tooth_outline(SCENE)
GEOMETRY = PICTURE.geometry
PINION, GEAR = PICTURE.pinion, PICTURE.gear
FEW = tooth_outline(
    SCENE.replace({"gears.pinion_teeth": 25, "gears.gear_teeth": 31, "mesh.tip_relief_radius": "1 mm"})
)
WIDE = tooth_outline(SCENE, gaps=7.0)


@pytest.fixture(scope="module")
def run():
    return gd.simulate(SCENE, t_end=0.08, samples=8001)


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    path = tmp_path_factory.mktemp("teeth") / "two.nc"
    gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.002, samples=201, archive=path)
    return path


def involute(angle):
    return math.tan(angle) - angle


def beside_flank(wheel, point, turned, tooth, alpha, sign):
    """Distance of a point from a flank of a tooth, along the base circle, by the polar equation of the involute.

    ``sign`` is 1 for the drive flank; the coast flank is its mirror image, ``turned`` in its own sense.
    """
    x, y = point[0] * sign, point[1] - wheel.centre
    if wheel.turning < 0:  # the gear is the pinion's picture turned upside down
        x, y = -x, -y
    radius = math.hypot(x, y)
    here = math.atan2(x, -y)  # from straight down, counter-clockwise
    # away from the centre the flank bends back from where it crosses the pitch circle
    flank = -(involute(math.acos(wheel.base_radius / radius)) - involute(alpha))
    pitch = 2 * math.pi / wheel.teeth
    off = here - flank - wheel.turning * (turned - tooth * pitch)
    return wheel.base_radius * ((off + math.pi) % (2 * math.pi) - math.pi)


@pytest.mark.parametrize("picture", [PICTURE, FEW, WIDE], ids=["preset", "others", "wide gaps"])
@pytest.mark.parametrize("u", [-6e-8, 3e-8, 9e-8])
def test_contact_points_lie_on_the_line_of_action_and_on_both_flanks(picture, u):
    geometry, gap = picture.geometry, 0.5 * SCENE.mesh.backlash - u
    alpha, pitch = geometry.pressure_angle, geometry.base_pitch
    for travel in np.linspace(0.0, 3.0, 7) * pitch:
        pinion_turned, gear_turned = picture.turned(travel, u)
        for pair in range(-2, 4):
            place = travel - pair * pitch
            if not 0.0 <= place <= geometry.path_length:
                continue
            on_pinion, on_gear = contact_points(picture, Flank.DRIVE, place, gap)
            # on the line through the pitch point, inclined by the pressure angle; lengths of 1e-5 m, rounded
            assert on_gear[1] == pytest.approx(-math.tan(alpha) * on_gear[0], rel=1e-12, abs=1e-19)
            assert math.dist(on_pinion, on_gear) == pytest.approx(picture.gaps * gap, rel=1e-9, abs=0.0)
            # angles of a radian, rounded, times the radius
            assert abs(beside_flank(picture.pinion, on_pinion, pinion_turned, pair, alpha, 1)) < 1e-18
            assert abs(beside_flank(picture.gear, on_gear, gear_turned, pair, alpha, 1)) < 1e-18


@pytest.mark.parametrize("wheel", [PINION, GEAR, FEW.pinion, FEW.gear])
def test_outlines_of_teeth_are_involutes(wheel):
    alpha = GEOMETRY.pressure_angle
    pitch_radius = abs(wheel.centre)
    end = pitch_radius + 2 * pitch_radius / wheel.teeth
    centred = wheel.tooth + np.array([0.0, wheel.centre])
    radii = np.hypot(*wheel.tooth.T)
    half = len(radii) // 2
    flank = [k for k in range(half) if 1.0001 * wheel.base_radius < radii[k] < end]
    assert len(flank) > 20
    for k in flank:
        assert abs(beside_flank(wheel, centred[k], 0.0, 0, alpha, 1)) < 1e-18


def test_whole_wheels_have_all_their_teeth():
    for wheel in (PINION, GEAR, FEW.pinion, FEW.gear):
        outline = wheel.outline()
        assert len(outline) == wheel.teeth * len(wheel.tooth)
        angles = np.unwrap(np.arctan2(outline[:, 1] - wheel.centre, outline[:, 0]))
        assert angles[-1] - angles[0] == pytest.approx(-2 * math.pi, abs=2 * math.pi / wheel.teeth)


@pytest.mark.parametrize("gaps", [0.0, -1.0, math.nan, 30.0])
def test_gaps_that_leave_no_teeth_are_refused(gaps):
    with pytest.raises(gd.SceneError, match="gaps"):
        tooth_outline(SCENE, gaps=gaps)
    with pytest.raises(gd.SceneError, match="gears"):
        tooth_outline(gd.preset("roller_slow"))


def thickness(wheel):
    """Thickness of a tooth at the pitch circle [m]."""
    angles, radii = np.arctan2(*wheel.tooth.T), np.hypot(*wheel.tooth.T)
    turned = np.unwrap(angles) * abs(wheel.centre)
    top = len(radii) // 2
    first, last = (
        np.interp(abs(wheel.centre), radii[side][order], turned[side][order])
        for side, order in ((slice(0, top), slice(None)), (slice(top, None), slice(None, None, -1)))
    )
    return abs(last - first)


@pytest.mark.parametrize("picture", [PICTURE, WIDE], ids=["to scale", "wide gaps"])
def test_teeth_and_backlash_fill_the_pitch(picture):
    pitch = math.pi * GEOMETRY.module
    across = thickness(picture.pinion) + thickness(picture.gear)
    play = picture.gaps * SCENE.mesh.backlash / math.cos(GEOMETRY.pressure_angle)
    # the flanks between drawn points are chords: 40 points on 9 um
    assert across + play == pytest.approx(pitch, abs=2e-9)


@pytest.mark.parametrize("picture", [PICTURE, FEW, WIDE], ids=["preset", "others", "wide gaps"])
def test_teeth_do_not_overlap_unless_the_gap_is_negative(picture):
    pitch, b = picture.geometry.base_pitch, 0.5 * SCENE.mesh.backlash
    for u in (-b, 0.0, b):
        for travel in np.linspace(0.0, 1.0, 13) * pitch:
            turned = picture.turned(travel, u)
            pinion, gear = (
                wheel.outline(angle, 4) / picture.geometry.module
                for wheel, angle in zip((picture.pinion, picture.gear), turned, strict=True)
            )
            # chords of convex flanks stay inside; a thousandth of a module is what the drawing may be off
            assert not Outline(gear).contains_points(pinion, radius=1e-3).any()
            assert not Outline(pinion).contains_points(gear, radius=1e-3).any()
    turned = picture.turned(0.3 * pitch, b + 0.05 * picture.geometry.module)
    pinion = picture.pinion.outline(turned[0], 4)
    assert Outline(picture.gear.outline(turned[1], 4)).contains_points(pinion).any()


def test_drawn_gap_is_the_recorded_one(run):
    for state in tooth_contacts(run, [0.0, 0.02, 0.0773]):
        smallest = min(
            (contact for contact in state.contacts if contact.flank == Flank.DRIVE),
            key=lambda contact: contact.gap,
        )
        at = int(np.argmin(np.abs(run.time.values - state.time)))
        ends = contact_points(PICTURE, Flank.DRIVE, smallest.place, smallest.gap)
        assert math.dist(*ends) == pytest.approx(run.drive_gap.values[at], rel=1e-9, abs=0.0)
        turned, _ = PICTURE.turned(state.travel, state.transmission_error)
        # rounded ends, if it is one, recede by a slope times the gap less: 0.1 of 40 nm at most
        off = beside_flank(PINION, ends[0], turned, smallest.pair, GEOMETRY.pressure_angle, 1)
        assert abs(off) < 4e-9


def test_positive_torque_presses_the_drive_flank(run):
    (state,) = tooth_contacts(run, 0.06)
    touching = [contact for contact in state.contacts if contact.force != 0.0]
    assert {contact.flank for contact in touching} == {Flank.DRIVE}
    view = TeethView(run, [state])
    view.draw(state)
    arrows = [text for text in view.figure.axes[0].texts if getattr(text, "arrow_patch", None) is not None]
    assert len(arrows) == len(touching)
    ways = []
    for arrow in arrows:
        along = np.asarray(arrow.xy) - np.asarray(arrow.xyann)  # from the contact to the head
        assert along[1] == pytest.approx(-math.tan(GEOMETRY.pressure_angle) * along[0], rel=1e-9, abs=0.0)
        ways.append(math.copysign(1.0, along[0]))
    # what pushes drives the gear on, to the right
    assert sorted(ways) == sorted(math.copysign(1.0, contact.force) for contact in touching)


def test_picture_says_what_the_record_says(run):
    (state,) = tooth_contacts(run, 0.0773)
    figure = gd.plot.teeth(run, time=0.0773)
    mesh, *close, strip = figure.axes
    assert mesh.get_title(loc="left").startswith("t = 77.3 ms")
    assert f"{run.mesh_force.sel(time=0.0773, method='nearest').item() * 1e15:.4g} fN" in mesh.get_title(
        loc="left"
    )
    shown = [ax for ax in close if ax.get_visible()]
    pairs = {contact.pair: contact for contact in state.contacts if contact.flank == Flank.DRIVE}
    assert len(shown) == 2
    for ax in shown:
        title = ax.get_title(loc="left")
        contact = pairs[int(title.split()[1].rstrip(","))]
        assert f"gap {contact.gap * 1e9:.4g} nm" in title
        assert (
            f", {'pushes' if contact.force > 0 else 'pulls'} with {abs(contact.force) * 1e12:.4g} pN" in title
        )
        factor = float(ax.get_xlabel().split("\N{MULTIPLICATION SIGN}")[1])
        box, (left, right), (low, high) = ax.get_window_extent(), ax.get_xlim(), ax.get_ylim()
        # micrometres along, nanometres across; printed with two digits
        stretched = (box.height / (high - low) * 1e3) / (box.width / (right - left))
        assert factor == pytest.approx(stretched, rel=0.06)
    assert strip.get_lines()[-1].get_xdata()[0] == pytest.approx(77.3)


@pytest.mark.parametrize("changes", [{}, {"gears.pinion_teeth": 120, "gears.gear_teeth": 240}])
def test_words_have_places_of_their_own(changes):
    """Two close-ups, or three narrow ones: captions overlap neither each other nor the legend, and stay on the page."""
    ds = gd.simulate(SCENE.replace(changes), t_end=0.002, samples=201)
    figure = gd.plot.teeth(ds)
    figure.canvas.draw()
    mesh, *close, _ = figure.axes
    assert len(close) == (3 if changes else 2)
    captions = [ax._left_title.get_window_extent() for ax in close if ax.get_visible()]
    assert len(captions) >= 2
    for caption, following in itertools.pairwise(sorted(captions, key=lambda box: box.x0)):
        assert caption.x1 < following.x0
    assert max(box.x1 for box in captions) < figure.bbox.x1
    assert max(box.y1 for box in captions) < figure.legends[0].get_window_extent().y0
    assert (
        figure.legends[0].get_window_extent().y1 < mesh.get_window_extent().y0 + 1.0
    )  # a pixel for rounding


def test_last_sample_is_shown_by_default(run):
    cut = run.copy(deep=True)
    cut["transmission_error"][5001:] = np.nan
    assert gd.plot.teeth(cut).axes[0].get_title(loc="left").startswith("t = 50 ms")


def test_bodies_that_deflect_have_forces_and_states():
    ds = gd.simulate(SCENE.replace({"contact.bodies": "elastic"}), t_end=1e-3, samples=11)
    figure = gd.plot.teeth(ds, time=5e-4)
    words = " ".join(ax.get_title(loc="left") for ax in figure.axes)
    assert "pulls with" in words
    assert "stretched" in words
    assert "expected asperities" not in words  # joined heights differ along the contact


def test_asperities_are_a_sample_of_the_model():
    heights, coated = [], []
    for pair in range(8):
        x, height, covered = rough_sample(SCENE, pair)
        assert np.all(np.diff(x) > 0.0)
        # in a row, they stand as densely as on the plane
        assert len(x) == pytest.approx(2.1 * half_width(SCENE) * math.sqrt(1.69e14), abs=1)
        heights.append(height)
        coated.append(covered)
    spread = np.std(np.concatenate(heights))
    count = 8 * len(x)
    assert spread == pytest.approx(6e-9, rel=4 / math.sqrt(2 * count), abs=0.0)  # four standard errors
    assert np.mean(np.concatenate(coated)) == pytest.approx(0.5, abs=2 / math.sqrt(count))
    assert np.array_equal(rough_sample(SCENE, 3)[1], rough_sample(SCENE, 11)[1])


def test_number_of_joined_asperities(run):
    """Against heights drawn at random on the footprint of a contact, one that is pressed well."""
    (state,) = tooth_contacts(run, 0.0)
    contact = state.contacts[0]
    joined = dict.fromkeys(contact.joined, 6e-9)
    pressed = type(contact)(
        contact.pair, contact.flank, contact.place, contact.radius, 6e-9, 1.0, joined, contact.states
    )
    random = np.random.default_rng(1)
    half = 6 * math.sqrt(2 * contact.radius * 6e-9)
    x, z = random.uniform(-half, half, 400_000), 6e-9 * random.standard_normal(400_000)
    share = np.mean(z > 6e-9 + x**2 / (2 * contact.radius))
    expected = share * 2 * half * 2e-6 * 1.69e14
    # the sampling error is 1/sqrt(share * number), about a percent
    assert joined_asperities(SCENE, pressed) == pytest.approx(expected, rel=0.04)


def test_moving_picture(run, tmp_path):
    path = gd.plot.animate_teeth(run, tmp_path / "teeth.gif", start=0.07, stop=0.075, frames=3, dpi=40)
    with Image.open(path) as image:
        assert image.n_frames == 3
        assert image.width == 304
    assert [entry.name for entry in tmp_path.iterdir()] == ["teeth.gif"]
    with pytest.raises(gd.SceneError, match="exists already"):
        gd.plot.animate_teeth(run, path, frames=2)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"frames": 1}, "must lie in 2"),
        ({"rate": 0}, "pictures per second"),
        ({"start": 0.05, "stop": 0.05}, "must come after"),
        ({"stop": 1.0}, "must lie in the record"),
    ],
)
def test_moving_pictures_that_make_no_sense(run, tmp_path, options, words):
    with pytest.raises(gd.SceneError, match=words):
        gd.plot.animate_teeth(run, tmp_path / "teeth.gif", **options)
    assert not list(tmp_path.iterdir())


def test_other_endings_are_refused(run, tmp_path, monkeypatch):
    with pytest.raises(gd.SceneError, match=r"must end in one of \.gif"):
        gd.plot.animate_teeth(run, tmp_path / "teeth.txt")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(gd.SceneError, match="needs the program ffmpeg"):
        gd.plot.animate_teeth(run, tmp_path / "teeth.mp4")


def test_command(archive, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    worn = ["plot", str(archive), "--picture", "teeth", "--select", "sam_fraction=0.5"]
    assert main([*worn, "--time", "1 ms", "-o", "one.png"]) == 0
    assert main([*worn, "--from", "0", "--to", "1e-3", "--frames", "2", "-o", "two.webp"]) == 0
    assert capfd.readouterr().out == "Picture: one.png\nPicture: two.webp\n"
    assert main(["plot", str(archive), "--select", "sam_fraction=0.5"]) == 0
    refused = [
        ([*worn[:-2]], "must be a single run"),
        ([*worn[:-1], "sam_fraction=0.7"], "must be one of 1, 0.5"),
        ([*worn[:-1], "torque=1"], "must be one of sam_fraction"),
        ([*worn, "--time", "soon"], "--time = soon: must be"),
        ([*worn, "--time", "1 ms", "--to", "2 ms"], "a moving picture needs --from and --to"),
        ([*worn[:2], "--time", "1 ms"], "--time = 1 ms: needs --picture teeth"),
        ([*worn[:2], "-o", "x.gif"], "needs --picture teeth"),
    ]
    capfd.readouterr()
    for command, words in refused:
        assert main(command) == 2
        assert words in capfd.readouterr().err
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["one.png", "two.png", "two.webp"]


@pytest.mark.parametrize("side", ["pinion", "gear"])
@pytest.mark.parametrize("pair", [0, 17, 40])
@pytest.mark.parametrize(("error", "overlaps"), [(-30e-9, True), (-5e-9, False), (30e-9, False)])
def test_a_tooth_with_an_error_is_drawn_where_it_is(side, pair, error, overlaps):
    """Its drive flank meets the other tooth's if it stands out by more than the gap, and no other tooth does."""
    gap, place, enlarged = 10e-9, 0.4 * GEOMETRY.path_length, 20.0
    for number, meets in ((pair, overlaps), (pair + 3, False)):
        errors = np.zeros(getattr(SCENE.gears, f"{side}_teeth"))
        errors[number % errors.size] = error
        scene = SCENE.replace({f"mesh.{side}_pitch_error": errors})
        picture = tooth_outline(scene, gaps=enlarged, most_play=0.15)
        travel = place + pair * GEOMETRY.base_pitch
        turned = picture.turned(travel, 0.5 * scene.mesh.backlash - gap)
        pinion, gear = contact_points(picture, Flank.DRIVE, place, gap)
        # where the other gear's flank, which has no error, crosses the line of action
        wheel, angle, point = (
            (picture.pinion, turned[0], gear) if side == "pinion" else (picture.gear, turned[1], pinion)
        )
        for count in (None, 5):
            assert Outline(wheel.outline(angle, count)).contains_point(point) == meets


def test_the_view_states_the_factor_and_the_forces_of_teeth_with_errors():
    few = {"run.duration": 0.06, "run.samples": 301, "mesh.pitch_error_rms": "3 nm"}
    run = gd.simulate(SCENE.replace(few))
    texts = [text.get_text() for ax in gd.plot.teeth(run).axes for text in ax.texts]
    (stated,) = (text for text in texts if "errors of single teeth" in text)
    errors = gd.pitch_errors(SCENE.replace(few))
    largest = max(float(np.abs(errors[name]).max()) for name in errors)
    factor = float(stated.split()[-1])
    assert 0.1 <= factor * largest / GEOMETRY.module <= 0.15
    figure = gd.plot.tooth_errors(run)
    upper, _, lower, _ = figure.axes
    drawn = [bar.get_height() for bar in upper.patches]
    np.testing.assert_allclose(drawn, 1e9 * errors.pinion_pitch_error, rtol=1e-9)
    states = tooth_contacts(run, run.time.values)
    most = max(
        contact.force
        for state in states
        for contact in state.contacts
        if contact.flank == Flank.DRIVE and contact.pair % 19 == 1
    )
    unit = {"nN": 1e9, "pN": 1e12, "fN": 1e15, "µN": 1e6}
    factor = next(size for name, size in unit.items() if f"({name})" in lower.get_ylabel())
    assert lower.patches[1].get_height() == pytest.approx(factor * most, rel=1e-9)
    with pytest.raises(gd.SceneError, match="teeth have no errors"):
        gd.plot.tooth_errors(gd.simulate(SCENE, t_end=1e-3, samples=11))
