"""Starts and events on the edge: exactly on a guard, grazing, several at once, nothing between the flanks."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.backend import run_blocks
from gearidae.engine.events.histories import begin
from gearidae.engine.integrate.driver import Ending
from gearidae.engine.model.state import PHASE
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind, Statistics

BASE = gd.preset("teodorescu2009").replace(
    {"contact.bodies": "rigid", "run.duration": 1e-5, "run.samples": 41, "run.rtol": 1e-8}
)
FREE = BASE.replace(
    {
        "mesh.backlash": 2e-6,
        "initial.gap": 1e-6,
        "drive.torque": 0.0,
        "drive.harmonic": [],
        "load.torque": 0.0,
        "load.drag": 0.0,
        "run.duration": 3e-4,
    }
)


def passages(scene):
    """Every mesh entry and exit of gears that turn evenly, from the geometry alone: time, kind, pair, flank."""
    g, start = scene.geometry, scene.initial
    pace = start.gear_speed * g.base_radius_gear / g.base_pitch  # pitches per second
    ratio, mirror = g.contact_ratio, 2 * g.approach / g.base_pitch + 0.5
    entry, exit_ = (
        (EventKind.MESH_ENTRY, EventKind.MESH_EXIT)
        if pace > 0
        else (EventKind.MESH_EXIT, EventKind.MESH_ENTRY)
    )
    events = []
    for pair in range(-200, 201):
        for phase, kind, flank in (
            (pair, entry, 0),
            (pair + ratio, exit_, 0),
            (pair + mirror - ratio, entry, 1),
            (pair + mirror, exit_, 1),
        ):
            time = (phase - start.mesh_phase) / pace
            if 0.0 < time < scene.run.duration:
                events.append((time, int(kind), pair, flank))
    return sorted(events)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("speed", [2898.0, -2898.0])
def test_every_entry_and_exit_within_one_step_is_told_in_order(speed, backend):
    """Nothing touches, so a single step crosses many marks; those of a coast pair stand in the order it meets them."""
    run = solve(FREE.replace({"initial.gear_speed": speed}), backend=backend)
    expected = passages(FREE.replace({"initial.gear_speed": speed}))
    assert run.statistics.steps < len(expected)
    times = np.array([e[0] for e in expected])
    np.testing.assert_allclose(run.events.time, times, rtol=1e-9, atol=1e-12 * 3e-4)
    for column, field in ((1, "kind"), (2, "pair"), (3, "flank")):
        np.testing.assert_array_equal(getattr(run.events, field), [e[column] for e in expected])


def test_an_entry_and_an_exit_at_the_same_time_are_both_told():
    """Equal gears whose contact ratio is 3/2: a pair leaves one flank just as one comes in on the other."""

    def excess(angle):
        return (
            FREE.replace(
                {"gears.pinion_teeth": 40, "gears.gear_teeth": 40, "gears.pressure_angle": angle}
            ).geometry.contact_ratio
            - 1.5
        )

    angle = brentq(excess, 0.36, 0.55, xtol=1e-15)
    scene = FREE.replace(
        {
            "gears.pinion_teeth": 40,
            "gears.gear_teeth": 40,
            "gears.pressure_angle": angle,
            "run.duration": 1e-3,
        }
    )
    run = solve(scene)
    expected = passages(scene)
    times = np.array([e[0] for e in expected])
    assert np.count_nonzero(np.diff(times) < 1e-9 * times[-1]) > 5  # they do coincide
    assert len(run.events) == len(expected)
    np.testing.assert_allclose(run.events.time, times, rtol=1e-9)
    ours = zip(run.events.kind, run.events.pair, run.events.flank, strict=True)
    assert sorted(map(tuple, ours)) == sorted(e[1:] for e in expected)


def test_two_pairs_that_touch_together_are_both_told_each_time():
    """On the path of contact all gaps of a flank are one: pairs 0 and -1 of a gear that hardly moves do all at once."""
    scene = BASE.replace(
        {
            "gears.gear_inertia": 1e-12,
            "initial.gear_speed": 1e-3,
            "initial.gap": 5e-8,
            "coating.sam_fraction": 0.5,
            "run.duration": 2e-6,
        }
    )
    run = solve(scene)
    events = run.events
    for kind in (EventKind.ONSET, EventKind.TURNING_POINT, EventKind.FULL_STRETCH):
        chosen = events.kind == kind
        assert np.count_nonzero(chosen) >= 2
        # the pinion's radius of curvature differs, the gaps do not: equal to the last bits of their sums
        np.testing.assert_allclose(events.time[chosen][::2], events.time[chosen][1::2], rtol=1e-9)
        assert sorted(events.pair[chosen]) == [-1] * (chosen.sum() // 2) + [0] * (chosen.sum() // 2)


@pytest.mark.parametrize("pitches", [1, 2, 5, -3])
def test_which_pair_is_called_which_does_not_matter(pitches):
    """Started some pitches on, the same happens to pairs of other numbers, whose histories lie in other places."""
    runs = []
    for shift in (0, pitches):
        problem = make_problem(BASE.replace({"initial.gap": 3e-8, "coating.sam_fraction": 0.5}))
        problem.start[PHASE] += shift
        begin(problem.addresses.base, 0.0, problem.start)
        statistics = Statistics()
        blocks = list(run_blocks(problem, 1e-8, 41, "native", statistics))
        assert statistics.ending is Ending.FINISHED
        runs.append(np.concatenate([block.events for block in blocks]))
    ours, theirs = runs
    assert np.count_nonzero(ours[:, 1] == EventKind.TURNING_POINT) > 5
    assert len(set(ours[:, 2])) > 1
    np.testing.assert_array_equal(theirs[:, [1, 3]], ours[:, [1, 3]])
    flank = ours[:, 3] >= 0
    np.testing.assert_array_equal(theirs[flank, 2], ours[flank, 2] + pitches)
    # the phase rounds otherwise, which impacts magnify
    np.testing.assert_allclose(theirs[:, 0], ours[:, 0], rtol=1e-5)


def on_a_guard():
    head = make_problem(BASE).model.scene
    sigma = BASE.surface.roughness
    return {
        "onset": {"initial.gap": float(head.contact_gap) * sigma},
        "cut-off": {"initial.gap": float(head.cutoff) * sigma},
        "onset of the coast flank": {"initial.gap": BASE.mesh.backlash - float(head.contact_gap) * sigma},
        "mesh entry": {"initial.mesh_phase": 0.0, "initial.gap": 3e-8},
        "mesh exit": {"initial.mesh_phase": float(head.contact_ratio) - 1.0, "initial.gap": 3e-8},
        "coast passage": {"initial.mesh_phase": float(head.coast_phase % 1.0), "initial.gap": 3e-8},
        "rest": {"initial.gear_speed": 0.0, "initial.gap": 3e-8},
        "rest, torque just holding": {
            "initial.gear_speed": 0.0,
            "initial.gap": 1e-7,
            "drive.torque": 0.0,
            "drive.harmonic": [],
        },
    }


@pytest.mark.parametrize("speed", [2898.0, -2898.0])
@pytest.mark.parametrize("name", on_a_guard())
def test_a_start_exactly_on_a_guard_is_a_start_beside_it(name, speed):
    change = on_a_guard()[name]
    runs = []
    for nudge in (0.0, 1e-12, -1e-12):
        scene = BASE.replace({"initial.gear_speed": speed} | change)
        scene = scene.replace({"initial.gap": scene.initial.gap * (1 + nudge)})
        if scene.initial.mesh_phase + nudge >= 0.0:
            scene = scene.replace({"initial.mesh_phase": scene.initial.mesh_phase + nudge})
        runs.append(solve(scene))
    assert {run.status for run in runs} == {"finished"}
    for run in runs[1:]:
        for column in ("gear_speed", "transmission_error"):
            values = runs[0].samples[column]
            np.testing.assert_allclose(run.samples[column], values, atol=1e-5 * np.ptp(values) + 1e-17)


@pytest.mark.parametrize(("margin", "touches"), [(0.05, False), (-0.05, True), (0.0, None)])
def test_a_grazing_contact_is_seen_if_it_is_one(margin, touches):
    """A pinion that swings freely comes within a hair of the onset and turns round, with no force to speak of."""
    swing = 2 * math.pi * 2e4
    problem = make_problem(FREE.replace({"drive.harmonic": [{"amplitude": 1e-11, "frequency": 2e4}]}))
    engage = float(problem.model.scene.contact_gap) * FREE.surface.roughness
    # u'' = R1 M/I1 cos(swing t): the gap falls from its start by twice the amplitude
    fall = 2 * 34.715e-6 * 1e-11 / 1.5263e-20 / swing**2
    scene = FREE.replace(
        {
            "gears.gear_inertia": 1e-12,  # stands still
            "initial.gear_speed": 0.0,
            "mesh.backlash": 5e-6,
            "initial.gap": engage + margin * FREE.surface.roughness + fall,
            "drive.harmonic": [{"amplitude": 1e-11, "frequency": 2e4}],
            "run.duration": 5e-5,
            "run.samples": 201,
        }
    )
    run = solve(scene)
    assert run.status == "finished"
    drive = run.events.flank == 0
    onsets = np.count_nonzero(drive & (run.events.kind == EventKind.ONSET))
    if touches is not None:
        assert (onsets > 0) == touches
    assert onsets == np.count_nonzero(drive & (run.events.kind == EventKind.SEPARATION))
    turning = run.events.time[drive & (run.events.kind == EventKind.TURNING_POINT)]
    assert turning == pytest.approx(np.full(len(turning), 2.5e-5), rel=1e-3, abs=0)
    assert len(turning) >= 1


@settings(max_examples=15)
@given(
    backlash=st.sampled_from([0.0, 1e-9, 2e-8, 5e-8]),
    share=st.floats(0.0, 1.0),
    fraction=st.sampled_from([0.0, 0.4, 1.0]),
    torque=st.floats(-3e-11, 3e-11).map(lambda torque: torque if abs(torque) > 1e-30 else 0.0),
)
def test_flanks_that_touch_together(backlash, share, fraction, torque):
    """Backlash below the reach of adhesion: both flanks in contact, and every onset has its flank."""
    scene = BASE.replace(
        {
            "mesh.backlash": backlash,
            "initial.gap": round(share, 6) * backlash,
            "coating.sam_fraction": fraction,
            "drive.torque": torque,
            "run.rtol": 1e-6,
        }
    )
    run = solve(scene)
    assert run.status == "finished"
    u = run.samples["transmission_error"]
    np.testing.assert_allclose(run.samples["drive_gap"] + run.samples["coast_gap"], backlash, atol=1e-15)
    assert np.all(np.isfinite(u))
    assert np.all(run.samples["pairs_in_contact"] >= 1)
    assert np.all(np.diff(run.events.time) >= 0.0)
