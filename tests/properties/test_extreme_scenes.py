"""Extreme but valid scenes end with a name within a bound on steps; what cannot be computed is refused by its key."""

import math
import os
import signal
import time
from dataclasses import replace
from datetime import date

import numpy as np
import pytest

import gearidae as gd
from gearidae.asperities.ranges import GAP_LOW
from gearidae.engine.integrate.driver import Ending
from gearidae.errors import SceneError
from gearidae.scene.limits import MOST_PAIRS, check_reach, pairs_within_reach
from gearidae_bench.attack import run_attack
from gearidae_bench.attack_report import balance_rows, ending_rows, page, warned_rows
from gearidae_bench.attack_worker import FAULTS, Outcome, judge, run_scene
from gearidae_bench.extreme_scenes import extreme_friction, extreme_population, extreme_scene
from gearidae_bench.random_scenes import random_scene

NAMED = {ending.status for ending in Ending} | {"budget", "refused"}
STEPS = 5_000
LOW = gd.preset("teodorescu2009_low_speed")


def by_hand(numbers, *long):
    """Numbers of scenes, of which some take long and are tested before a release."""
    return [pytest.param(k, marks=pytest.mark.by_hand if k in long else ()) for k in numbers]


@pytest.mark.parametrize("number", by_hand(range(24), 18))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow on the way to a named ending
def test_an_extreme_scene_ends_with_a_name(number):
    extreme = extreme_scene(1, number)
    reports = []
    outcome = judge(extreme.scene, extreme.backend, STEPS, lambda: reports.append(time.monotonic()))
    assert outcome.status not in FAULTS, outcome.message
    assert outcome.status in NAMED
    assert reports or outcome.status == "refused"


@pytest.mark.parametrize("number", [1, 3, 5, 9, 25, 27])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_an_extreme_population_ends_with_a_name(number):
    """Drawn surfaces and a list; the same numbers give the same scene."""
    extreme = extreme_population(1, number)
    assert extreme == extreme_population(1, number)
    assert extreme.scene.contact.is_discrete
    followed = run_scene(extreme.scene, extreme.backend, 500, lambda: None)
    assert followed.status in NAMED


@pytest.mark.parametrize("number", by_hand([1, 2, 4, 5, 6, 7], 7))
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_extreme_friction_ends_with_a_name(number):
    """Even numbers are of the mean law, odd ones of real asperities."""
    extreme = extreme_friction(1, number)
    friction, gears = extreme.scene.contact.friction, extreme.scene.gears
    assert friction > 0.0 or extreme.scene.contact.shear_strength > 0.0
    assert gears is not None
    followed = run_scene(extreme.scene, extreme.backend, 500, lambda: None)
    assert followed.status in NAMED


@pytest.mark.parametrize("law", ["roller", "gears"])
@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_elastic_contacts_are_attacked_too(law, backend):
    """They have one column more than others: a run that is cut short before its first sample has it as well."""
    preset = gd.preset("roller_slow") if law == "roller" else LOW.replace({"run.duration": "1 ms"})
    scene = preset.replace({"contact.bodies": "elastic", "run.samples": 101})
    outcome = judge(scene, backend, STEPS, lambda: None)
    assert outcome.status in ("finished", "budget"), outcome.message


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_drawing_a_scene_is_reported():
    """Thousands of tries with 20,000 knots each are not to count as a hang."""
    tries = []
    assert extreme_scene(3, 17, lambda: tries.append(0)) == extreme_scene(3, 17)
    assert tries


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_the_same_numbers_give_the_same_scene():
    assert extreme_scene(3, 17) == extreme_scene(3, 17)
    assert extreme_scene(3, 17) != extreme_scene(3, 18)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow on the way to a refusal of the scene
def test_the_generator_reaches_what_it_is_for():
    """Both drivers, both kinds of scene, all laws and models, wide tolerances, jumps, many knots, corners."""
    drawn = [extreme_scene(2, number) for number in range(80)]
    scenes = [one.scene for one in drawn]
    gears = [scene for scene in scenes if scene.gears is not None]
    knots = [scene.drive.schedule for scene in gears]
    apart = [np.diff([time for time, _ in some]) / some[-1][0] for some in knots if len(some) > 1]
    assert {one.backend for one in drawn} == {"native", "sksundae"}
    assert {scene.contact.asperity for scene in scenes} == {"jkr", "dmt", "hertz", "maugis"}
    assert {scene.contact.bodies for scene in scenes} == {"auto", "rigid", "elastic"}
    assert 4 < len(scenes) - len(gears) < 20
    assert min(scene.run.rtol for scene in scenes) == 1e-12
    assert max(scene.run.rtol for scene in scenes) == 0.1
    assert max(scene.gears.gear_teeth for scene in gears) == 10_000
    assert max(map(len, knots)) > 10_000
    assert min(some.min() for some in apart) < 1e-8
    assert any(len(scene.mesh.static_error) == 8 for scene in gears)
    stiffness = [scene.surface.youngs_modulus for scene in scenes]
    assert max(stiffness) > 1e6 * min(stiffness)


# -- limits that no key has alone ------------------------------------------------------------------------------------


def test_pairs_within_reach_are_those_that_geometry_brings_near():
    """Counted one by one: pairs whose relief is less than the depth of the tables, over a pitch of the mesh's turn."""
    scene = LOW.replace({"mesh.tip_relief_radius": "30 mm"})
    geometry, sigma = scene.geometry, scene.surface.roughness
    place = np.arange(-200, 201) * geometry.base_pitch
    outside = np.maximum(0.0, np.maximum(-place, place - geometry.path_length))
    near = outside**2 / (2.0 * scene.mesh.tip_relief_radius) < -GAP_LOW * sigma
    assert abs(np.count_nonzero(near) - pairs_within_reach(scene, 0.0)) <= 1.0


def test_the_relief_that_a_refusal_names_is_the_limit():
    with pytest.raises(SceneError, match=r"tip_relief_radius.*pairs would be in touch") as caught:
        LOW.replace({"mesh.tip_relief_radius": 0.5})
    most = float(caught.value.allowed.split("must be below ")[1].split(" m")[0])
    assert pairs_within_reach(LOW.replace({"mesh.tip_relief_radius": 0.99 * most}), 0.0) < MOST_PAIRS
    with pytest.raises(SceneError):
        LOW.replace({"mesh.tip_relief_radius": 1.01 * most})


def test_a_larger_cut_off_brings_more_pairs_within_reach():
    scene = LOW.replace({"mesh.tip_relief_radius": "55 mm"})
    check_reach(scene)
    with pytest.raises(SceneError, match="tip_relief_radius"):
        check_reach(scene, cutoff=13.0)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"surface.roughness": 1e-12, "coating.sam_fraction": 0.0}, "surface.roughness"),
        ({"surface.youngs_modulus": 1e3, "coating.sam_fraction": 0.0}, "surface.roughness"),
        ({"gears.pinion_base_radius": 0.9, "gears.pinion_teeth": 30, "mesh.backlash": 0.09, "surface.roughness": 1e-11,
          "contact.asperity": "hertz"}, "mesh.backlash"),
        ({"initial.gap": 1e-23}, "initial.gap"),
    ],
)  # fmt: skip
def test_what_cannot_be_computed_names_its_key(changes, key):
    with pytest.raises(SceneError) as caught:
        LOW.replace(changes)
    assert caught.value.key == key


@pytest.mark.parametrize("key", ["roller.radius", "roller.width", "roller.mass"])
def test_a_roller_of_no_size_is_refused(key):
    """Found by an attack: a radius or width of 1e-300 m hung."""
    with pytest.raises(SceneError, match=key):
        gd.preset("roller_slow").replace({key: 1e-300})


def test_only_laws_that_stretch_have_a_limit_of_stretch():
    soft = {"surface.roughness": 1e-12, "contact.asperity": "hertz", "initial.gap": 1e-8}
    assert LOW.replace(soft).surface.roughness == 1e-12


def test_knots_may_jump_within_a_step_but_no_closer_than_a_double_can_step():
    LOW.replace({"drive.schedule": [[0.1, 1e-18], [0.1 + 1e-12, 2e-18]]})
    with pytest.raises(SceneError, match="too close to step between"):
        LOW.replace({"drive.schedule": [[0.1, 1e-18], [math.nextafter(0.1, 1.0), 2e-18]]})


@pytest.mark.parametrize("number", range(0, 60, 7))
def test_limits_leave_the_random_scenes_alone(number):
    scene = random_scene(1, number)
    assert scene.from_dict(scene.to_dict()) == scene


# -- the watchdog ----------------------------------------------------------------------------------------------------


def die(seed, number, budget, reports, trace):
    os.kill(os.getpid(), signal.SIGABRT)


def sleep(seed, number, budget, reports, trace):
    reports.send("begun")
    time.sleep(60.0)


def fail(seed, number, budget, reports, trace):
    reports.send(Outcome(number, "raised", "KeyError: -60"))


@pytest.mark.parametrize(
    ("target", "patience", "status", "message"),
    [
        (die, 300.0, "killed", "SIGABRT"),
        (sleep, 10.0, "silent", "no report for"),
        (fail, 300.0, "raised", "KeyError"),
    ],
)
def test_a_process_that_dies_or_hangs_is_a_fault(target, patience, status, message):
    heard = []
    outcomes = run_attack(range(2, 4), 1, 2, budget=1, patience=patience, report=heard.append, target=target)
    assert [(o.number, o.status, o.sound) for o in outcomes] == [(2, status, False), (3, status, False)]
    assert all(message in o.message for o in outcomes)
    assert len(heard) == 2


def test_the_page_counts_endings_and_warnings():
    sound = Outcome(0, "finished", rtol=1e-6, error=1e-6, balance=0.5, longest=2.0)
    outcomes = [
        sound,
        replace(sound, number=1, balance=3.0),
        replace(sound, number=2, error=1.0, balance=9.0),
        Outcome(3, "killed", "SIGSEGV, in a|b"),
    ]
    assert [(status, count) for status, count, _ in ending_rows(outcomes)] == [("finished", 3), ("killed", 1)]
    assert balance_rows(outcomes)[-1] == ("warned of", "50 %")  # the third's motion does not agree
    assert [row.split("|")[1].strip() for row in warned_rows(outcomes)[2:-1]] == ["1"]
    text = page(outcomes, 7, date(2026, 1, 2), 9)
    assert "--runs 9 --seed 7" in text
    assert "**Faults: 1.**" in text
    assert "a\\|b" in text
