"""Sixty random scenes: a named ending for each, and no sample that the physics does not allow."""

from __future__ import annotations

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.build_torques import ROOT_LIMIT
from gearidae.records import Ending, EventKind
from reference import random_runs, random_scenes, run_checks
from reference.random_runs import draw_and_run, run_one
from reference.random_scenes import SCENES_PER_SURFACE, random_scene, wide_scene

FEW = 500  # steps: the first block of output has more; with elastic bodies, a hundredth of it
NAMED = {ending.status for ending in Ending} | {"budget", "refused"}
SCENES, SEED = (60, pytest.param(300, marks=pytest.mark.by_hand)), 4
PORTABLE_EVERY = 20
"""One scene of so many runs with the portable driver, whose steps take a hundred times as long."""


@pytest.fixture(scope="module", params=SCENES)
def outcomes(request):
    """Of all scenes, those that share a surface one after the other."""
    backends = ["sksundae" if k % PORTABLE_EVERY == 0 else "native" for k in range(request.param)]
    return [draw_and_run(SEED, k, FEW, backend) for k, backend in enumerate(backends)]


def test_random_scenes_end_soundly(outcomes):
    assert [o for o in outcomes if not o.sound] == []
    assert {o.status for o in outcomes} <= NAMED
    assert sum(o.status in ("finished", "budget") for o in outcomes) > 0.9 * len(outcomes)


def test_half_of_all_scenes_stay_within_a_few_tolerances(outcomes):
    """Up to their third impact: 0.3 of two thousand."""
    ratios = [o.ratio for o in outcomes if math.isfinite(o.ratio)]
    assert len(ratios) > 0.5 * len(outcomes)
    assert np.median(ratios) < 5.0
    assert np.quantile(ratios, 0.9) < 50.0


@pytest.mark.parametrize("number", [115, 257])
def test_a_coating_and_a_flank_of_very_different_stretch(number):
    """One material's stretched branch tabulated, the other's integrated."""
    assert run_one(random_scene(1, number)).sound


@pytest.mark.parametrize(
    "number", [90, 460, 546, 671, *(pytest.param(long, marks=pytest.mark.by_hand) for long in (19, 675))]
)
def test_no_event_follows_another_without_end(number):
    """Resistance through zero, slip of little surplus, a thousand mesh marks in a step."""
    outcome = run_one(random_scene(1, number))
    assert outcome.sound
    assert outcome.status in ("finished", "budget")


@pytest.mark.parametrize(("seed", "number"), [(1, 404), (2, 66), (2, 456)])
def test_an_overlap_beyond_the_force_laws_tables_is_named(seed, number):
    """Pressed deeper than forty roughnesses, a run would go on with an extrapolated force."""
    outcome = run_one(random_scene(seed, number))
    assert outcome.sound
    assert outcome.status == "deflection"
    assert 0.0 < outcome.reached < 1.0


def test_a_flank_at_the_end_of_a_long_flight_is_met():
    """A start in flight might take a step so long that Newton's iteration fails in the tooth."""
    outcome = run_one(random_scene(2, 281), budget=FEW)
    assert outcome.sound
    assert outcome.status in ("finished", "budget")


def test_ringing_fast_against_the_loads_own_time_is_no_chatter():
    """Teeth that ring in their adhesive well turn round thousands of times in a time unit."""
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {
            "surface.roughness": 1e-9,
            "coating.sam_fraction": 0.0,
            "contact.bodies": "rigid",
            "initial.gap": 5e-9,
            "run.duration": 1.4e-5,
            "run.samples": 11,
        }
    )
    run = solve(scene)
    turned = np.count_nonzero(run.events.kind == EventKind.TURNING_POINT)
    assert run.status == "finished"
    assert turned > 2 * ROOT_LIMIT
    assert turned > 10_000 * scene.run.duration / make_problem(scene).time_unit


@pytest.mark.parametrize("number", [0, 3, 12, 15, 17, 984])
def test_scenes_with_later_keys_are_sound(number):
    """Laws, sides, tables of coverage, held speeds and exposures together; the last has a very stiff drive."""
    outcome = run_one(wide_scene(1, number), budget=FEW)
    assert outcome.sound, outcome.complaint
    assert outcome.status in NAMED


# -- what the scenes and checks are worth ----------------------------------------------------------------------------


def test_the_same_numbers_give_the_same_scene():
    assert wide_scene(3, 17) == wide_scene(3, 17)
    assert random_scene(3, 17) != random_scene(3, 18)
    assert 17 // SCENES_PER_SURFACE == 18 // SCENES_PER_SURFACE
    assert random_scene(3, 17).surface.roughness == random_scene(3, 18).surface.roughness


def test_half_of_the_scenes_have_later_keys(monkeypatch):
    """Each key is drawn in some of a hundred scenes, whatever their durations, which take a force law each."""
    monkeypatch.setattr(random_scenes, "_duration", lambda scene, units: units * 1e-9)
    drawn = {n: wide_scene(3, n) for n in range(100)}
    assert 30 < sum(scene == random_scene(3, n) for n, scene in drawn.items()) < 70
    gears = [scene for scene in drawn.values() if scene.roller is None]
    for has_it in (
        lambda scene: scene.contact.asperity == "maugis",
        lambda scene: scene.coating.by_place,
        lambda scene: scene.coating.pairing == "independent",
        lambda scene: scene.coating.thickness > 0.0,
        lambda scene: scene.drive.speed is not None,
        lambda scene: scene.load.viscous > 0.0,
        lambda scene: scene.run.exposures > 0,
        lambda scene: scene.run.stop != "time",
    ):
        assert any(map(has_it, gears))


@pytest.mark.parametrize("law", ["jkr", "maugis"])
def test_a_wrong_force_would_be_seen(law, monkeypatch):
    """The envelope of what a contact can do is narrow enough to catch forces that are off by a part in a thousand."""
    scene = gd.preset("roller_slow").replace(
        {"contact.bodies": "rigid", "contact.asperity": law, "run.samples": 401}
    )
    assert run_one(scene).sound
    honest = run_checks.line_force
    monkeypatch.setattr(run_checks, "line_force", lambda *a: 1.001 * honest(*a))
    assert "force is" in run_one(scene).complaint


def test_an_unbalanced_ledger_is_a_complaint(monkeypatch):
    monkeypatch.setattr(random_runs, "BALANCE_TOLERANCES", 0.0)
    outcome = run_one(gd.preset("roller_slow").replace({"contact.bodies": "rigid"}))
    assert "energy balance" in outcome.complaint


def test_any_other_exception_is_a_defect(monkeypatch):
    def broken(scene):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(random_runs, "make_problem", broken)
    outcome = run_one(gd.preset("roller_slow"))
    assert outcome.status == "raised"
    assert "ZeroDivisionError" in outcome.message
    assert not outcome.sound
