"""Verdicts of trains: the judged shaft, what free gears would have done, and what holds it by names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.reference.train_solution import solved
from tests.reference.trains import chain, tables

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.headline import headline
from gearidae.analysis.verdict.train import judge_chain
from gearidae.archive.train import train_dataset
from gearidae.engine.train.free_train import FreeTrain
from gearidae.scene import Scene

REST = {"gear_speed": 0.0, "gap": "36 nm", "mesh_phase": 0.3}


def still(scene, since=0.0, place=0.0):
    """A run whose shafts all rest since a time, after they have come that far [rad]."""
    moving = solved(Scene.from_dict(chain(hubs=0.3)))
    time = np.linspace(0.0, scene.run.duration, 1001)
    count, meshes = len(scene.shafts), len(scene.meshes)
    share = np.clip(1.0 - time / since, 0.0, None) if since else np.zeros_like(time)
    ratio = np.array([[float(shaft.ratio / scene.train.shafts[-1].ratio)] for shaft in scene.train.shafts])
    speed, angle = 2.0 * place / max(since, 1e-30) * share, place * (1.0 - share**2)
    samples = {
        **{name: np.zeros((count, time.size)) for name in ("hub_load", "hub_load_angle")},
        **{name: np.zeros(time.size) for name in ("load_torque", "pin_load", "pin_friction")},
        "hub_friction": np.array([np.full(time.size, shaft.hub_friction) for shaft in scene.shafts.values()]),
        **{
            name: np.zeros((meshes, time.size))
            for name in ("mesh_force", "transmission_error", "drive_gap", "coast_gap", "pairs_in_contact")
        },
        "shaft_speed": ratio * speed,
        "shaft_angle": ratio * angle,
        "drive_torque": np.full(time.size, scene.drive.torque),
    }
    rests = {
        "shaft": np.arange(count),
        "begin": np.full(count, since),
        "end": np.full(count, scene.run.duration),
    }
    track = moving.track._replace(time=time, samples=samples)
    return replace(moving, time=time, samples=samples, track=track, rests=rests, reached=scene.run.duration)


def labelled(scene, solution):
    return train_dataset(scene, judge_chain(scene, solution, None)[0])


def test_free_gears_of_a_train_go_as_far_as_by_hand():
    """I w' = rho M - M_L with I = 4.968e-18: 1.799573 pitches of 76 teeth in 1 ms at 7.9e-12 N m."""
    scene = Scene.from_dict(chain("0 deg", drive={"torque": 7.9e-12}, load={"torque": 3e-11}, initial=REST))
    free = FreeTrain(scene)
    assert free.inertia == pytest.approx(4.968e-18, rel=1e-12, abs=0.0)
    (end,) = free.positions(0.0, 0.0, np.array([1e-3]))
    turned = 0.5 * 1.6e-12 / 4.968e-18 * 1e-6
    assert end == pytest.approx(turned, rel=1e-8)
    # the digits of the independent prototype, with the drag of the chain's load
    (end,) = FreeTrain(scene.replace({"load.drag": 8e-18})).positions(0.0, 0.0, np.array([1e-3]))
    assert end * 76 / (2.0 * np.pi) == pytest.approx(1.799573, rel=3e-7)


def test_free_gears_wait_for_a_ramp_and_stop_where_it_falls():
    """Held until 4 M = 3e-11 N m; up, along and down again, symmetric about the top."""
    ramp = {"schedule": [[0.0, 0.0], [1e-3, 1.5e-11], [2e-3, 0.0]]}
    scene = Scene.from_dict(chain(drive=ramp, load={"torque": 3e-11}, initial=REST))
    scene = scene.replace({"run.duration": 4e-3})
    free = FreeTrain(scene)
    times = np.linspace(0.0, 4e-3, 401)
    where = free.positions(0.0, 0.0, times)
    assert where[50] == 0.0
    assert where[51] > 0.0  # from 0.5 ms on
    # speed at 1.5 ms: integral of 4 M - 3e-11 over the millisecond above it, 1.5e-14 N m s
    assert (where[151] - where[149]) / 2e-5 == pytest.approx(1.5e-14 / 4.968e-18, rel=1e-3)
    moving = np.diff(where) > 0.0
    stop = times[1:][moving][-1]
    # below 3e-11 the torque lacks 6e-8 t, and 3e-11 from 2 ms on
    lost = 7.5e-15
    assert stop == pytest.approx(2e-3 + (1.5e-14 - lost) / 3e-11, abs=2e-5)
    assert not moving[times[1:] > stop].any()
    # asked for a time behind the stop alone
    assert free.positions(0.0, 0.0, times[-1:])[0] == pytest.approx(where[-1], rel=1e-6)


def test_the_torques_of_free_gears_are_those_of_the_scene_at_any_time():
    """Schedule that repeats, harmonics of time and of the angle, held speed and drags, written down by hand."""
    drive = {
        "schedule": {"knots": [[0.0, 0.0], [1e-3, 2e-12]], "repeat": 2e-3},
        "harmonic": [
            {"amplitude": 1e-12, "frequency": 300.0, "phase": 0.4},
            {"amplitude": 5e-13, "order": 3},
        ],
    }
    load = {"torque": 1e-12, "schedule": [[0.0, 0.0], [4e-3, 3e-12]], "viscous": 2e-16, "drag": 8e-18}
    scene = Scene.from_dict(chain(drive=drive, load=load)).replace({"run.duration": 5e-3})
    free = FreeTrain(scene)
    for t, angle, speed in ((5e-4, 0.2, 10.0), (1.5e-3, -0.7, -3.0), (3.2e-3, 1.1, 0.0)):
        ramp = 2e-12 * (1.0 - abs(t % 2e-3 - 1e-3) / 1e-3)
        turned = 4.0 * angle
        wave = 1e-12 * np.cos(2.0 * np.pi * 300.0 * t + 0.4) + 5e-13 * np.cos(3.0 * turned)
        drags = (2e-16 + 8e-18 * abs(speed)) * speed
        assert free.push(t, angle, speed) == pytest.approx(4.0 * (ramp + wave) - drags, rel=1e-9, abs=0.0)
        assert free.dry(t, angle, speed) == pytest.approx(1e-12 + 3e-12 * t / 4e-3, rel=1e-12, abs=0.0)


def test_a_train_that_hubs_hold_sticks_by_their_names():
    scene = Scene.from_dict(
        chain("0 deg", hubs=0.3, drive={"torque": 7.9e-12}, load={"torque": 3e-11}, initial=REST)
    ).replace({"run.duration": 1e-3})
    ds = labelled(scene, still(scene))
    (outcome,) = outcomes(ds)
    assert outcome.verdict == "sticks"
    assert outcome.shaft == "output"
    assert outcome.held_by == "hub friction of input, hub friction of idler, hub friction of output"
    assert float(ds["free_advance"]) > 1.7
    assert headline(ds).startswith("output does not start in 1 ms")


def test_a_train_that_its_dry_load_holds_stops():
    """The drive gives 8e-12 N m at the output, less than the load of 3e-11."""
    scene = Scene.from_dict(chain(hubs=0.3, drive={"torque": 2e-12})).replace({"run.duration": 150e-6})
    ds = labelled(scene, still(scene, since=86.247604e-6, place=0.02))
    (outcome,) = outcomes(ds)
    assert (outcome.verdict, outcome.held_by) == ("stops", "dry load of output")
    assert outcome.stick_time == pytest.approx(86.247604e-6, rel=1e-9)
    assert headline(ds) == "output came to rest at 86.2 us (1 mesh exit), held by dry load of output."
    (row,) = ds.gearidae.standstills().to_dict("records")
    assert row["verdict"] == "stops"
    assert row["rest_time"] == pytest.approx(150e-6 - 86.247604e-6, rel=1e-9)


def test_a_train_that_turns_is_judged_by_its_speed():
    scene = Scene.from_dict(chain(hubs=0.3))
    ds = labelled(scene, solved(scene))
    assert headline(ds) == "output turned smoothly through 1 mesh exit in 0.15 ms."
    assert ds.gearidae.standstills().empty


def test_a_train_that_is_pulled_back_runs_back():
    scene = Scene.from_dict(chain()).replace({"run.duration": 1e-3})
    solution = still(scene)
    back = np.linspace(0.0, 1.0, 1001) * -0.2
    samples = {**solution.samples, "shaft_angle": solution.samples["shaft_angle"] + back}
    samples["shaft_speed"] = np.full_like(samples["shaft_angle"], -200.0)
    nothing = {name: np.empty(0) for name in solution.rests}
    ds = labelled(scene, replace(solution, track=solution.track._replace(samples=samples), rests=nothing))
    (outcome,) = outcomes(ds)
    assert outcome.verdict == "runs back"
    assert outcome.turned_back == pytest.approx(0.2 * 76 / (2.0 * np.pi), rel=1e-9)


def spring(t, angle, speed, p):
    return -p[0] * (angle - p[1])


@pytest.fixture
def spring_law():
    gd.register_torque("spring_of_a_train", parameters=("stiffness", "rest"))(spring)
    yield
    gd.unregister_torque("spring_of_a_train")


def swinging(duration, stiffness, viscous, rest):
    """Gears of 18, 54 and 18 teeth without damping: a spring on the first, 200 nm ahead of the second, which drags."""
    teeth = {"input": (18, 4.86e-21), "output": (54, 3.94e-19), "tail": (18, 4.86e-21)}
    return Scene.from_dict(
        tables(
            shafts={name: {"teeth": count, "inertia": inertia} for name, (count, inertia) in teeth.items()},
            meshes={
                "first": {"driver": "input", "driven": "output"},
                "second": {"driver": "output", "driven": "tail"},
            },
            drive={"law": {"name": "spring_of_a_train", "stiffness": stiffness, "rest": rest}},
            load={"shaft": "output", "viscous": viscous},
            initial={"gear_speed": 0.0, "gap": "200 nm", "mesh_phase": 0.3},
            run={"duration": duration, "samples": 2001},
        )
    ).replace({"mesh.damping": 0.0})


def test_a_train_that_turns_round_in_a_well_of_its_drive_does_not_stick(spring_law):
    """Just after it turns, its pinion passes the backlash, and free gears are ahead of the train for that time."""
    stiffness, viscous, pitches = 1e-11, 2e-15, 0.24
    inertia = 3.94e-19 + 2.0 * 9.0 * 4.86e-21
    decay = viscous / (2.0 * inertia)
    half = np.pi / np.sqrt(9.0 * stiffness / inertia - decay**2)
    for halves in (1.02, 1.04, 1.08, 1.5, 2.2, 3.06):
        ds = gd.simulate(swinging(halves * half, stiffness, viscous, pitches * 2.0 * np.pi / 18))
        (outcome,) = outcomes(ds)
        assert outcome.verdict == ("stops" if halves > 2.0 else "irregular"), halves
        assert ds.gearidae.standstills().verdict.tolist() == ["stops"] * (halves > 2.0), halves
