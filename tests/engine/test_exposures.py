"""Exposures of the flanks: against samples and readable laws, against the energy balance, and through interruptions."""

import itertools
import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import gearidae as gd
from gearidae.archive.exposures import flank_areas
from gearidae.asperities.jkr import JOINING
from gearidae.contact import asperity_of, line_force
from gearidae.engine import solve
from gearidae.records import EventKind

LOW = gd.preset("teodorescu2009_low_speed")
OFF = {"run.samples": "off"}
NAMES = ("asperity_contacts", "adhesion_work", "sliding_work", "largest_pressure")


def total(ds, name="adhesion_work"):
    """What a run adds up to over all flanks [J], from the values per area of each material."""
    shares = np.array([material.share for material in ds.gearidae.scene.materials()])
    return float((ds[name] * ds.flank_area).sum(("flank", "tooth", "place")).values @ shares)


@pytest.fixture(scope="module")
def worn():
    """Half coated, over three mesh exits."""
    return gd.simulate(
        LOW.replace({**OFF, "run.exposures": 12, "run.duration": 0.16, "coating.sam_fraction": 0.5})
    )


@pytest.fixture(scope="module")
def sampled():
    """Without adhesion, so that forces follow from the samples alone; 200 samples to a vibration of the contact."""
    changes = {"contact.asperity": "hertz", "contact.bodies": "rigid", "run.exposures": 9}
    return gd.simulate(
        LOW.replace({**changes, "run.duration": 0.08, "run.samples": 80_001, "run.rtol": 1e-8})
    )


@pytest.fixture(scope="module")
def damped():
    """The same with so much damping that nothing vibrates and steps are long; pairs relieve each other seven times."""
    changes = {
        "contact.asperity": "hertz",
        "contact.bodies": "rigid",
        "run.exposures": 9,
        "mesh.damping": 1e-8,
    }
    return gd.simulate(LOW.replace({**changes, "run.duration": 0.4, "run.samples": 160_001}))


def pairs_of(ds):
    """Force [N], joined asperities over those of unit length, place [pitches] and sliding speed of each pair."""
    scene = ds.gearidae.scene
    g, sigma = scene.geometry, scene.surface.roughness
    pitch, ratio = g.base_pitch, g.contact_ratio
    phase = scene.initial.mesh_phase + ds.gear_angle.values * g.base_radius_gear / pitch
    phase -= ds.gear_angle.values[0] * g.base_radius_gear / pitch
    gap = 0.5 * scene.mesh.backlash - ds.transmission_error.values
    grid = np.linspace(-1.0, 8.0, 4001) * sigma
    law = np.log(line_force(grid, 0.0, 1.0, scene.gears.face_width, scene.surface, asperity="hertz"))
    for pair in range(math.floor(phase[0] - ratio), math.ceil(phase[-1]) + 1):
        along = phase - pair
        inside = np.clip(along, 0.0, ratio)
        relief = ((along - inside) * pitch) ** 2 / (2 * scene.mesh.tip_relief_radius)
        first = g.base_radius_pinion * math.tan(scene.gears.pressure_angle) - g.approach + inside * pitch
        both = (g.base_radius_pinion + g.base_radius_gear) * math.tan(scene.gears.pressure_angle)
        radius = first * (both - first) / both
        distance = gap + relief
        force = np.exp(np.interp(distance, grid, law, right=-math.inf)) * np.sqrt(radius)
        speed = (ds.pinion_speed.values + ds.gear_speed.values) * (inside * pitch - g.approach)
        yield pair, inside / ratio, force, speed, distance / sigma, np.sqrt(radius / pitch)


def places_of(where, values, places):
    """Sum values into places."""
    return np.bincount(np.minimum((where * places).astype(int), places - 1), values, minlength=places)


@pytest.mark.parametrize(
    ("name", "error"),
    [
        # in most places the largest is passed between two ends of intervals;
        # 200 samples to a vibration: less than 1e-4 of its amplitude beside an extremum
        ("sampled", 1e-4),
        # largest where a contact leaves its place, between the ends of steps of a hundredth of a place and more
        ("damped", 1e-3),
    ],
)
def test_sliding_work_and_pressure_are_those_of_the_samples(name, error, request):
    run = request.getfixturevalue(name)
    scene, places = run.gearidae.scene, 9
    work, pressure = np.zeros((19, places)), np.zeros((19, places))
    step = float(run.time[1] - run.time[0])
    width = scene.gears.face_width * math.sqrt(2 * scene.geometry.base_pitch * scene.surface.roughness)
    for pair, where, force, speed, _, length in pairs_of(run):
        work[pair % 19] += places_of(where, force * np.abs(speed) * step, places)
        pressing = force / length / width
        np.maximum.at(pressure[pair % 19], np.minimum((where * places).astype(int), places - 1), pressing)
        # on its way from one place to the next the pressure changes by percents between two samples
        within = (where > 0.0) & (where < 1.0)
        passed = [
            k
            for k in range(1, places)
            if np.any(where[within] < k / places) and np.any(where[within] > k / places)
        ]
        if passed:
            there = CubicSpline(where[within], pressing[within])(np.array(passed) / places)
            for before in (1, 0):
                np.maximum.at(pressure[pair % 19], np.array(passed) - before, there)
    ours = (run.sliding_work * run.flank_area).sel(flank="drive").values
    # the sum over samples is good to 1e-5; a contact on its way from one place to the next is divided between them
    assert ours.sum() == pytest.approx(work.sum(), rel=1e-4, abs=0)
    np.testing.assert_allclose(ours, work, rtol=0, atol=1e-3 * work.max())
    assert run.sliding_work.sel(flank="coast").sum() == 0.0
    largest = run.largest_pressure.sel(flank="drive").values
    assert largest.max() == pytest.approx(pressure.max(), rel=1e-6, abs=0)  # that of the start
    np.testing.assert_allclose(largest, pressure, rtol=0, atol=error * pressure.max())


def test_contacts_are_those_of_the_samples(sampled):
    """Without stretch an asperity is in contact while the gap is below its height: contacts are what closing adds."""
    scene = sampled.gearidae.scene
    x, w = np.polynomial.legendre.leggauss(60)
    knots = np.linspace(-1.0, 9.0, 2001)
    # int psi from a height on: expected asperities over a parabola of unit width, by plain quadrature
    heights = knots[:, None] + 0.5 * (1 + x) * 8.0
    from gearidae.contact.psi import psi

    number = (psi(heights) * w).sum(axis=1) * 4.0
    made = np.zeros(19)
    for pair, _, _, _, gap, length in pairs_of(sampled):
        rise = np.maximum(np.diff(np.exp(np.interp(gap, knots, np.log(number)))), 0.0)
        made[pair % 19] += np.sum(rise * 0.5 * (length[1:] + length[:-1]))
    surface, area = scene.surface, sampled.flank_area
    unit = math.sqrt(2 * scene.geometry.base_pitch * surface.roughness) * scene.gears.face_width
    ours = (sampled.asperity_contacts * area).sel(flank="drive", material="coated").sum("place").values
    expected = surface.asperity_density * unit * made
    assert ours.sum() == pytest.approx(
        expected.sum(), rel=1e-3, abs=0
    )  # linear interpolation of its logarithm
    np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-3 * expected.max())


def test_sums_at_a_usual_tolerance_are_those_at_a_tight_one():
    """Also where contacts vibrate between pushing and pulling, whose forces are far from smooth."""
    scene = LOW.replace({**OFF, "run.exposures": 4, "run.duration": 0.005, "coating.sam_fraction": 0.3})
    usual, tight = (gd.simulate(scene.replace({"run.rtol": rtol})) for rtol in (1e-6, 1e-9))
    for name in NAMES:
        ours, other = (float(ds[name].sum()) for ds in (usual, tight))
        assert ours == pytest.approx(other, rel=2e-4, abs=0)  # the error of the motion at 1e-6 is 1e-4


@pytest.fixture(scope="module")
def rebounding():
    """Driven so lightly that the gears fly apart, beyond all forces, and touch for a few steps at a time."""
    changes = {**OFF, "run.exposures": 4, "run.duration": 1e-3, "run.rtol": 1e-4, "contact.bodies": "rigid"}
    light = {"drive.torque": 1e-17, "load.torque": 0.0, "mesh.backlash": "0.2 um", "initial.gap": "90 nm"}
    return gd.simulate(gd.preset("teodorescu2009").replace({**changes, **light}))


def test_contacts_count_that_come_and_turn_between_two_looks(rebounding):
    """A contact that is new, or was beyond all forces since the last look, begins with nothing joined."""
    assert (rebounding.event_kind == EventKind.SEPARATION).sum() > 200
    assert total(rebounding) == pytest.approx(_loss(rebounding), rel=1e-12, abs=0)


LIGHT = {**OFF, "load.torque": 0.0, "run.exposures": 4, "contact.bodies": "rigid"}
SLOW = {"drive.torque": 1e-20, "initial.gap": "90 nm", "run.duration": 0.05}
FAST = {
    "drive.torque": 1.5e-16,
    "initial.gap": "0.26 um",
    "initial.gear_speed": 27.0,
    "mesh.backlash": "0.87 um",
    "coating.sam_fraction": 0.3,
    "run.duration": 6e-4,
}


@pytest.mark.parametrize(
    ("name", "changes", "error"),
    [("teodorescu2009_low_speed", SLOW, 1e-3), ("teodorescu2009", FAST, 5e-3)],
)
def test_sliding_work_of_short_contacts(name, changes, error):
    """The integral begins at the onset and ends at the separation, whichever steps there are."""
    scene = gd.preset(name).replace({**LIGHT, **changes})
    usual, tight = (gd.simulate(scene.replace({"run.rtol": rtol})) for rtol in (1e-4, 1e-8))
    # the motion's error at 1e-4 makes 2e-4 and 1e-3
    assert float(usual.sliding_work.sum()) == pytest.approx(float(tight.sliding_work.sum()), rel=error, abs=0)


def test_adhesion_work_adds_up_to_the_loss(worn):
    """Both take how a contact's length changes while it closes from the same integral: they differ by rounding."""
    assert total(worn) == pytest.approx(_loss(worn), rel=1e-12, abs=0)


def _loss(ds):

    return ds.gearidae.energy_balance["adhesion_loss"]


def test_each_contact_costs_its_loss(worn):
    scene = worn.gearidae.scene
    for name, surface in (("bare", scene.surface), ("coated", scene.coated_surface)):
        tip = asperity_of(surface)
        cost = JOINING * tip.pull_off * tip.stretch_limit
        exposure = worn.sel(material=name)
        contacts = float(exposure.asperity_contacts.sum())
        assert contacts > 0.0
        assert float(exposure.adhesion_work.sum()) == pytest.approx(cost * contacts, rel=1e-6, abs=0)


def test_labels_and_areas(worn):
    assert worn.adhesion_work.dims == ("flank", "material", "tooth", "place")
    assert worn.sliding_work.dims == worn.largest_pressure.dims == ("flank", "tooth", "place")
    assert worn.sizes["tooth"] == 19
    assert worn.sizes["place"] == 12
    scene = worn.gearidae.scene
    # an involute from roll angle a to b has the length rb (b^2 - a^2) / 2
    g = scene.geometry
    start = g.base_radius_pinion * math.tan(scene.gears.pressure_angle) - g.approach
    end = start + g.contact_ratio * g.base_pitch
    length = (end**2 - start**2) / (2 * g.base_radius_pinion)
    assert flank_areas(scene).sum() == pytest.approx(length * scene.gears.face_width, rel=1e-12, abs=0)
    # 0.16 s at 1.5 rad/s are 2.9 pitches; with 1.6 of the start, at most six teeth have been in mesh
    touched = (worn.sliding_work.sum(("flank", "place")) > 0).values
    assert 3 <= touched.sum() <= 6


def test_places_only_divide(worn):
    """More places keep all sums, and the motion to the last bit."""
    finer = gd.simulate(worn.gearidae.scene.replace({"run.exposures": 60}))
    none = gd.simulate(worn.gearidae.scene.replace({"run.exposures": 0}))
    for name in NAMES[:3]:
        ours, other = ((ds[name] * ds.flank_area).sum("place").values for ds in (worn, finer))
        np.testing.assert_allclose(ours, other, rtol=1e-9, atol=0)
    assert float(none.final_speed) == float(finer.final_speed) == float(worn.final_speed)
    assert "adhesion_work" not in none
    assert "place" not in none.dims


def test_elastic_bodies_have_them():
    changes = {**OFF, "run.exposures": 4, "run.duration": 0.02, "coating.sam_fraction": 0.3, "run.rtol": 1e-5}
    rigid, elastic = (
        gd.simulate(LOW.replace({**changes, "contact.model": m})) for m in ("asperity", "elastic")
    )
    assert total(elastic) == pytest.approx(_loss(elastic), rel=1e-4, abs=0)
    # so lightly pressed that deflections matter little, but for when adhesion lets go
    assert total(elastic) == pytest.approx(total(rigid), rel=0.05, abs=0)


def test_a_table_of_one_fraction_is_that_fraction(worn):
    """By tooth and place the materials' values are those of whole flanks, which the shares then divide."""
    scene = worn.gearidae.scene.replace({"contact.bodies": "rigid", "run.duration": 0.1, "run.rtol": 1e-9})
    plain, table = gd.simulate(scene), gd.simulate(scene.replace({"coating.pinion_table": [[0.5]]}))
    for name in NAMES:
        ours, other = plain[name].values, table[name].values
        # the runs take other steps, and contacts at the edge of a place are divided there from step to step: 3e-5
        np.testing.assert_allclose(ours, other, rtol=0, atol=1e-4 * np.abs(ours).max())


def test_an_archive_and_a_resumed_run_have_them(worn, tmp_path, monkeypatch):
    from gearidae.engine import native

    path = tmp_path / "run.nc"
    scene = worn.gearidae.scene
    whole = gd.simulate(scene, archive=path)
    for name in NAMES:
        np.testing.assert_array_equal(whole[name], worn[name])
    monkeypatch.setattr(native, "BLOCK_STEPS", 2_000)

    stopped = itertools.count()
    part = gd.simulate(scene.replace({"run.checkpoints": [0.05, 0.1]}))
    broken = tmp_path / "broken.nc"
    with pytest.raises(gd.Interrupted):
        gd.simulate(
            scene.replace({"run.checkpoints": [0.05, 0.1]}),
            archive=broken,
            on_block=lambda block: _interrupt() if block.time > 0.12 and next(stopped) == 0 else False,
        )
    resumed = gd.simulate(scene.replace({"run.checkpoints": [0.05, 0.1]}), archive=broken, resume=True)
    for name in NAMES:
        np.testing.assert_array_equal(resumed[name], part[name])


def _interrupt():
    raise KeyboardInterrupt


def test_a_continued_run_goes_on_with_them(worn):
    scene = worn.gearidae.scene
    first = gd.simulate(scene.replace({"run.duration": 0.1}))
    second = gd.simulate(scene.replace({"run.duration": 0.06}), start=first)
    assert total(second) == pytest.approx(total(worn), rel=1e-5, abs=0)  # it restarts once more
    assert total(second) == pytest.approx(_loss(second), rel=1e-12, abs=0)  # nothing is lost where one ends
    other = gd.simulate(scene.replace({"run.duration": 0.06, "drive.torque": 1e-17}), start=first)
    assert total(other) > total(first)  # other units of force and time
    assert total(other) == pytest.approx(_loss(other), rel=1e-12, abs=0)
    coated = gd.simulate(scene.replace({"run.duration": 0.06, "coating.sam_fraction": 0.6}), start=first)
    assert total(coated) == pytest.approx(_loss(coated) - _loss(first), rel=0.05, abs=0)


def test_nothing_is_lost_where_a_run_ends():
    """The contact may be closing there: what it has joined since its turning point is in the sums, and in the state."""
    scene = LOW.replace({**OFF, "run.exposures": 4, "coating.sam_fraction": 0.3, "run.duration": 0.1})
    stuck = gd.simulate(scene.replace({"run.stop": "sticks"}))
    assert float(stuck.stick_time) < 0.03
    for first in (
        stuck,
        *(gd.simulate(scene.replace({"run.duration": end})) for end in (0.024, 0.028, 0.04)),
    ):
        assert total(first) == pytest.approx(_loss(first), rel=1e-12, abs=0)
        second = gd.simulate(scene.replace({"run.duration": 1e-2}), start=first)
        assert total(second) == pytest.approx(_loss(second), rel=1e-12, abs=0)


def test_sweeps_have_them_along_their_dimension(worn):
    ds = gd.sweep(worn.gearidae.scene, {"coating.sam_fraction": [0.5, 0.7]}, keep=["exposures", "scene"])
    assert ds.sliding_work.dims == ("sam_fraction", "flank", "tooth", "place")
    for name in NAMES:
        np.testing.assert_array_equal(ds[name].sel(sam_fraction=0.5), worn[name])


@pytest.mark.parametrize("value", [-1, 2000, 1.5, True, "many"])
def test_a_number_of_places(value):
    with pytest.raises(gd.SceneError, match="whole number") as error:
        LOW.replace({"run.exposures": value})
    assert error.value.key == "run.exposures"


def test_what_has_no_places():
    with pytest.raises(gd.SceneError, match="roller"):
        gd.preset("roller_slow").replace({"run.exposures": 3})
    with pytest.raises(gd.SceneError, match="952 at most for 21 teeth"):
        LOW.replace({"run.exposures": 1000, "gears.pinion_base_radius": 80e-6, "gears.pinion_teeth": 21})


def test_forged_exposures_are_refused(worn):
    scene = worn.gearidae.scene.replace({"run.duration": 0.02})
    words = solve(scene).checkpoint
    for value in (math.nan, math.inf):
        forged = words.copy()
        forged[-5] = value
        with pytest.raises(gd.SceneError, match="exposures"):
            gd.engine.kept_at(scene, forged)
