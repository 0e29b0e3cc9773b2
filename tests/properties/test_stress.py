"""The short form of the stress run: random scenes, every ending accounted for."""

import math
from datetime import date

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.build_torques import ROOT_LIMIT
from gearidae.records import Ending, EventKind
from gearidae_bench import stress, stress_checks
from gearidae_bench.__main__ import main
from gearidae_bench.random_scenes import random_scene
from gearidae_bench.stress import Outcome, run_one, run_stress
from gearidae_bench.stress_report import balance_quantiles, counts, page, quantiles, worst
from gearidae_bench.wide_scenes import wide_scene

ONE_BLOCK = 1  # steps: the first block of output has more
NAMED = {ending.status for ending in Ending} | {"budget", "refused"}


def test_random_scenes_end_soundly():
    outcomes = run_stress(30, seed=4, budget=ONE_BLOCK)
    assert [o for o in outcomes if not o.sound] == []
    assert {o.status for o in outcomes} <= NAMED
    assert sum(o.status in ("finished", "budget") for o in outcomes) >= 25
    # half of all scenes stay within a few tolerances up to their third impact: 0.3 of two thousand
    assert quantiles(outcomes)[0.5] < 5.0


@pytest.mark.parametrize("number", [115, 257])
def test_a_coating_and_a_flank_of_very_different_stretch(number):
    """Found by the stress run: one material's stretched branch tabulated, the other's integrated."""
    assert run_one(random_scene(1, number)).sound


BY_HAND = pytest.mark.by_hand


@pytest.mark.parametrize(
    "number", [pytest.param(19, marks=BY_HAND), 90, 460, 546, 671, pytest.param(675, marks=BY_HAND)]
)
def test_no_event_follows_another_without_end(number):
    """Found by the stress run: resistance through zero, slip of little surplus, a thousand mesh marks in a step."""
    outcome = run_one(random_scene(1, number))
    assert outcome.sound
    assert outcome.status in ("finished", "budget")


@pytest.mark.parametrize(("seed", "number"), [(1, 404), (2, 66), (2, 456)])
def test_an_overlap_beyond_the_force_laws_tables_is_named(seed, number):
    """Found by the stress run: pressed deeper than forty roughnesses a run went on with an extrapolated force."""
    outcome = run_one(random_scene(seed, number))
    assert outcome.sound
    assert outcome.status == "deflection"
    assert 0.0 < outcome.reached < 1.0


def test_a_flank_at_the_end_of_a_long_flight_is_met():
    """Found by the stress run: a start in flight took a step so long that Newton's iteration failed in the tooth."""
    outcome = run_one(random_scene(2, 281), budget=ONE_BLOCK)
    assert outcome.sound
    assert outcome.status in ("finished", "budget")


def test_ringing_fast_against_the_loads_own_time_is_no_chatter():
    """Found by the stress run: teeth that ring in their adhesive well turn round thousands of times in a time unit."""
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


def test_the_same_numbers_give_the_same_scene():
    assert random_scene(3, 17) == random_scene(3, 17)
    assert random_scene(3, 17) != random_scene(3, 18)
    assert random_scene(3, 17).surface.roughness == random_scene(3, 18).surface.roughness


def test_half_of_the_wide_scenes_have_later_keys_and_the_others_are_as_before():
    """Each key is drawn in some of fifty scenes; the same numbers give the same scene."""
    drawn = {n: wide_scene(3, n) for n in range(50)}
    assert 15 < sum(scene == random_scene(3, n) for n, scene in drawn.items()) < 35
    assert wide_scene(3, 17) == drawn[17]
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


@pytest.mark.parametrize("number", [0, 3, 12, 15, 17, 984])
def test_scenes_with_later_keys_are_sound(number):
    """Laws, sides, tables of coverage, held speeds and exposures together; the last has a very stiff drive."""
    outcome = run_one(wide_scene(1, number), budget=ONE_BLOCK)
    assert outcome.sound, outcome.complaint
    assert outcome.status in NAMED


@pytest.mark.parametrize("law", ["jkr", "maugis"])
def test_a_wrong_force_would_be_seen(law, monkeypatch):
    """The envelope of what a contact can do is narrow enough to catch forces that are off by a part in a thousand."""
    scene = gd.preset("roller_slow").replace(
        {"contact.bodies": "rigid", "contact.asperity": law, "run.samples": 401}
    )
    assert run_one(scene).sound
    honest = stress_checks.line_force
    monkeypatch.setattr(stress_checks, "line_force", lambda *a: 1.001 * honest(*a))
    assert "force is" in run_one(scene).complaint


def test_processes_share_the_scenes_and_one_that_does_not_come_back_is_a_defect(monkeypatch):
    alone = run_stress(8, seed=4, budget=ONE_BLOCK)
    done = []
    shared = run_stress(8, seed=4, jobs=2, budget=ONE_BLOCK, report=done.extend)
    assert [(o.number, o.status) for o in shared] == [(o.number, o.status) for o in alone]
    assert sorted(o.number for o in done) == list(range(8))
    monkeypatch.setattr(stress, "_PATIENCE", 0.01)  # no process is even started in that time
    hung = run_stress(8, seed=4, jobs=2)
    assert [o.number for o in hung] == list(range(8))
    assert {o.status for o in hung} == {"hung"}
    assert not any(o.sound for o in hung)


def test_an_unbalanced_ledger_is_a_complaint(monkeypatch):
    monkeypatch.setattr(stress, "BALANCE_TOLERANCES", 0.0)
    assert (
        "energy balance" in run_one(gd.preset("roller_slow").replace({"contact.bodies": "rigid"})).complaint
    )


def test_a_defect_is_listed_and_does_not_end_the_run(monkeypatch):
    def broken(scene):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(stress, "make_problem", broken)
    outcome = run_one(gd.preset("roller_slow"))
    assert outcome.status == "raised"
    assert "ZeroDivisionError" in outcome.message
    assert not outcome.sound


def test_the_page_counts_and_lists():
    outcomes = [
        Outcome(0, "finished", rtol=1e-6, error=1e-5, imbalance=3e-6, steps=10, reached=1.0),
        Outcome(1, "budget", rtol=1e-6, error=1e-3),
        Outcome(2, "finished", complaint="force is off", rtol=1e-6),
        Outcome(3, "refused", "surface.roughness = 0: must be above 0"),
    ]
    assert counts(outcomes) == {"finished": 2, "budget": 1, "refused": 1}
    assert quantiles(outcomes)[1.0] == pytest.approx(1000.0)
    assert balance_quantiles(outcomes)[1.0] == pytest.approx(3.0)
    assert [o.number for o in worst(outcomes)] == [2, 1, 0]
    text = page(outcomes, 7, date(2026, 1, 2))
    assert "Failed checks: 1" in text
    assert "2026-01-02" in text
    assert "force is off" in text
    assert "| refused | 1: 3 |" in text
    many = page([Outcome(k, "finished", rtol=1e-6) for k in range(8)], 7, date(2026, 1, 2))
    assert "| finished | 8 |" in many
    assert math.isnan(outcomes[3].ratio)


def test_command_line(tmp_path, capsys):
    assert main(["--stress", "--runs", "3", "--seed", "1", "-o", str(tmp_path / "out")]) == 0
    assert "finished" in capsys.readouterr().out
    assert "seed 1" in (tmp_path / "out" / "stress.md").read_text()
    assert main(["--stress", "--runs", "0"]) == 2
