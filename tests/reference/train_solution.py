"""What the engine hands up of a train, made of the slow twin's motion: totals are integrals over its samples."""

from __future__ import annotations

import functools

import numpy as np
from scipy.integrate import trapezoid
from tests.reference.slow_train import SlowTrain

from gearidae.records import EventKind, Flank, Statistics
from gearidae.records.train_results import Track, TrainSolution


@functools.cache
def solved(scene, samples=1501):
    """Run a scene by the slow twin."""
    slow, train = SlowTrain(scene), scene.train
    time = np.linspace(0.0, scene.run.duration, samples)
    looks = slow.run(time, rtol=1e-8)
    column = {name: np.array([look[name] for look in looks]).T for name in ("force", "hub", "u", "speed")}
    rates = np.array([slow.arms @ look["speed"] for look in looks]).T
    damping = np.array([mesh.mesh.damping for mesh in train.meshes])[:, None]
    half = np.array([0.5 * mesh.mesh.backlash for mesh in train.meshes])[:, None]
    speed, force, drive = column["speed"], column["force"], np.array([look["drive"] for look in looks])
    shafts, load = list(scene.shafts.values()), scene.load

    def over(power):
        return trapezoid(power, time)

    a, b = [mesh.a for mesh in train.meshes], [mesh.b for mesh in train.meshes]
    into, out = (np.abs(slow.arms[range(len(a)), side])[:, None] * speed[side] for side in (a, b))
    arm = np.array([shaft.hub_friction * shaft.hub_radius for shaft in shafts])[:, None]
    last = speed[train.load]
    turned = np.array([np.append(0.0, np.cumsum(0.5 * (w[1:] + w[:-1]) * np.diff(time))) for w in speed])
    inertia = np.array([shaft.inertia for shaft in train.shafts])
    kinetic = 0.5 * float(inertia @ (speed[:, -1] ** 2 - speed[:, 0] ** 2))
    hub_loss = over(arm * column["hub"] * np.abs(speed))
    damped = over(damping * rates**2)
    load_work = over(load.torque * np.abs(last) + load.drag * np.abs(last) ** 3)
    drive_work = over(drive * speed[train.drive])
    residual = drive_work - load_work - hub_loss.sum() - damped.sum() - kinetic
    zero_shaft, zero_mesh = np.zeros(len(a) + 1 - len(train.loops)), np.zeros(len(a))
    samples_of_run = {
        "shaft_speed": speed,
        "shaft_angle": turned,
        "hub_load": column["hub"],
        "hub_load_angle": 0.0 * column["hub"],
        "hub_friction": np.array([np.full(time.size, shaft.hub_friction) for shaft in shafts]),
        "mesh_force": force,
        "transmission_error": column["u"],
        "drive_gap": half - column["u"],
        "coast_gap": half + column["u"],
        "pairs_in_contact": np.ones_like(force),
        "drive_torque": drive,
        "load_torque": load.torque + load.drag * last**2,
        "pin_load": 0.0 * drive,
        "pin_friction": 0.0 * drive,
    }
    return TrainSolution(
        shafts=tuple(scene.shafts),
        meshes=tuple(scene.meshes),
        time=time,
        samples=samples_of_run,
        track=Track(time, samples_of_run, np.empty(0), np.empty(0)),
        events={
            "time": np.array([27.510296e-6, 57.871869e-6]),
            "kind": np.array([EventKind.MESH_EXIT, EventKind.MESH_EXIT]),
            "mesh": np.array([0, 1]),
            "shaft": np.array([-1, -1]),
            "flank": np.array([Flank.DRIVE, Flank.DRIVE]),
            "pair": np.array([0, 0]),
            "gap_rate": np.full(2, np.nan),
            "asperity": np.array([-1, -1]),
            "force": np.full(2, np.nan),
        },
        shaft_totals={
            "min_speed": speed.min(axis=1),
            "max_speed": speed.max(axis=1),
            "hub_loss": hub_loss,
            "hub_sliding": over(column["hub"] * np.array([[shaft.hub_radius] for shaft in shafts]) * speed),
            "resistance_loss": zero_shaft,
            "drag_loss": zero_shaft,
            "rest_time": zero_shaft,
        },
        mesh_totals={
            "largest_mesh_force": force.max(axis=1),
            "largest_mesh_force_time": time[force.argmax(axis=1)],
            "smallest_mesh_force": force.min(axis=1),
            "smallest_mesh_force_time": time[force.argmin(axis=1)],
            "smallest_separation": (half - column["u"]).min(axis=1),
            "mesh_exits": np.ones(len(a)),
            "asperity_onsets": zero_mesh,
            "asperity_detachments": zero_mesh,
            "adhesion_loss": zero_mesh,
            "damping_loss": damped,
            "film_loss": zero_mesh,
            "friction_loss": zero_mesh,
            "work_in": over(force * into),
            "work_out": over(force * out),
        },
        energy={
            "drive_work": drive_work,
            "radius_work": 0.0,
            "load_work": load_work,
            "kinetic_change": kinetic,
            "stored_change": 0.0,
            "pin_loss": 0.0,
            "throughput": drive_work + load_work,
            "residual": residual,
            "residual_bound": 1e-3 * drive_work,
        },
        rests={name: np.empty(0) for name in ("shaft", "begin", "end")},
        status="finished",
        message="",
        reached=scene.run.duration,
        start=0.0,
        statistics=Statistics(steps=100, backend="twin", method="dop853"),
        checkpoint=np.arange(4.0),
    )
