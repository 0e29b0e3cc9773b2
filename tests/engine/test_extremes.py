"""Extremes that the engine keeps: against dense samples, an independent quadrature, and across checkpoints."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae import engine
from gearidae.asperities.registry import law_of_tip
from gearidae.contact import asperity_of
from gearidae.contact.psi import psi
from gearidae.contact.rough import adhesion_loss_per_asperity
from gearidae.mesh import curvature_radii
from gearidae.records import EventKind, Flank

LOW = gd.preset("teodorescu2009_low_speed")
HIGH = gd.preset("teodorescu2009").replace({"run.duration": 2e-4})
HALF = LOW.replace({"coating.sam_fraction": 0.5, "run.duration": 0.02})
STUCK = LOW.replace({"coating.sam_fraction": 0.45, "run.duration": 0.22})

# Peaks of the samples lie at most half an interval beside the true ones, some 1e-4 of a peak at these rates.
PEAK = 1e-3


def dense(scene, samples=1_000_001):
    return engine.solve(scene.replace({"run.samples": samples}))


@pytest.mark.parametrize(
    "scene",
    [
        HALF,
        STUCK,
        HIGH,
        HIGH.replace({"coating.sam_fraction": 0.0}),
        HIGH.replace({"mesh.damping": 1e-8}),
        HIGH.replace({"mesh.static_error": [{"order": 1, "amplitude": "20 nm", "phase": 0.3}]}),
        HIGH.replace({"contact.friction": 0.3, "gears.hub_friction": 0.5, "gears.pinion_hub_radius": 2e-5}),
    ],
    ids=["half worn", "stuck", "high", "bare", "damped", "static error", "friction"],
)
def test_extremes_are_those_of_a_million_samples(scene):
    solution = dense(scene)
    kept, x = solution.extremes, solution.samples
    force, speed = x["mesh_force"], x["gear_speed"]
    largest = np.abs(force).max()
    assert kept.largest_mesh_force == pytest.approx(force.max(), rel=PEAK, abs=0)
    assert kept.smallest_mesh_force == pytest.approx(force.min(), abs=PEAK * largest)
    assert kept.min_gear_speed == pytest.approx(speed.min(), rel=1e-5, abs=1e-6 * speed.max())
    assert kept.max_gear_speed == pytest.approx(speed.max(), rel=1e-4)
    smallest = min(x["drive_gap"].min(), x["coast_gap"].min())
    # of the roughness: the samples miss the depth of an impact by less
    assert kept.smallest_separation == pytest.approx(smallest, abs=1e-3 * scene.surface.roughness)
    settled = speed[round(0.05 * (speed.size - 1)) :]
    assert kept.settled_spread == pytest.approx(np.ptp(settled), rel=1e-4, abs=1e-6 * speed.max())
    # one period of the harmonic is 1e-4 s, and the start-up 1e-5 s of 2e-4 s
    whole = settled[: round((speed.size - 1) / 2) + 1] if scene.drive.harmonic else settled
    assert kept.settled_gear_speed == pytest.approx(np.trapezoid(whole) / (whole.size - 1), rel=1e-6)
    fall = np.max(np.maximum.accumulate(settled) - settled)
    assert kept.speed_fall == pytest.approx(fall, rel=1e-4, abs=1e-6 * speed.max())


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_nothing_depends_on_the_samples_nor_mesh_exits_on_the_driver(backend):
    scene = LOW.replace({"run.duration": 0.05})
    runs = [engine.solve(scene, samples=samples, backend=backend) for samples in (2, 501)]
    assert repr(runs[0].extremes) == repr(runs[1].extremes)  # to the last bit, NaN too
    events = runs[1].events
    exits = (events.kind == EventKind.MESH_EXIT) & (events.flank == Flank.DRIVE)
    assert runs[0].extremes.mesh_exits == exits.sum() > 0


def test_a_gear_sticks_where_its_speed_first_falls_to_zero():
    solution = dense(STUCK, 200_001)
    speed, time = solution.samples["gear_speed"], solution.time
    first = int(np.argmax(speed <= 0.0))
    # the samples bracket it
    assert time[first - 1] <= solution.extremes.stick_time <= time[first]
    assert solution.extremes.reversals > 1
    assert math.isnan(dense(HALF, 2).extremes.stick_time)


def test_a_resumed_run_keeps_the_same_extremes():
    scene = STUCK.replace({"run.duration": 0.4})
    points = []
    ended = engine.follow(scene, lambda block, *_: points.append(block), backend="native")
    start = next(block for block in points if block.checkpoint is not None)
    assert start.time < scene.run.duration
    again = engine.follow(
        scene,
        lambda *_: None,
        backend="native",
        start=engine.Start(checkpoint=start.checkpoint, reached=start.time),
    )
    assert repr(again.extremes) == repr(ended.extremes)  # to the last bit, NaN too


def test_elastic_flanks_stay_apart_where_rigid_ones_would_not():
    """Fig. 3 of the paper: smallest elastic separation 3.51 nm, rigid distance -2.87 nm (independent integrator)."""
    ds = gd.simulate(gd.load_case("cases/roller_fast.toml").replace({"contact.bodies": "elastic"}))
    assert ds.min_separation.dims == ("time",)
    assert float(ds.min_separation.min()) == pytest.approx(3.51e-9, abs=0.01e-9)
    assert float(ds.smallest_separation) == pytest.approx(float(ds.min_separation.min()), abs=1e-12)
    assert float(ds.height.min()) == pytest.approx(-2.87e-9, abs=0.01e-9)


@pytest.mark.parametrize(
    ("model", "asperity", "rtol", "error"),
    [
        # seven times as sensitive to the depth of a turning point as that is known; the error is that of four hundred
        # thousand trapezoids over tens of oscillations: 1e-7
        ("asperity", "jkr", 1e-12, 1e-6),
        ("asperity", "maugis", 1e-12, 1e-6),
        # forces of 1e-13 N deflect the teeth by 1e-18 m, so that the elastic contact loses the same
        ("elastic", "jkr", 1e-10, 1e-6),
    ],
)
def test_adhesion_loss_is_the_integral_of_the_contact_length(model, asperity, rtol, error):
    """Sum over all closing motions of the length times dPsi, from dense samples of one pair's gap and angle."""
    scene = LOW.replace(
        {
            "coating.sam_fraction": 0.5,
            "contact.model": model,
            "contact.asperity": asperity,
            "initial.mesh_phase": 0.8,  # one pair on the path of contact, no other within reach
            "initial.gap": 5.5 * 6e-9,
            "run.duration": 3e-3,
            "run.rtol": rtol,
        }
    )
    solution = dense(scene, 400_001)
    geometry, sigma = scene.geometry, scene.surface.roughness
    gap = (0.5 * scene.mesh.backlash - solution.samples["transmission_error"]) / sigma
    place = 0.8 * geometry.base_pitch + geometry.base_radius_gear * solution.samples["gear_angle"]
    radius = curvature_radii(geometry, place)[2]
    lost = at_last_length = 0.0
    for surface in (scene.surface, scene.coated_surface):
        law = law_of_tip(asperity, asperity_of(surface), sigma)
        count = surface.asperity_density * scene.gears.face_width * np.sqrt(2 * radius * sigma)
        cost = 0.5 * adhesion_loss_per_asperity(surface, asperity)  # either material has half of the surface
        total, adhered_energy = joined_along(gap - law.join, law.detach - law.join, count)
        lost += cost * total
        at_last_length += cost * adhered_energy
    assert solution.balance.adhesion_loss == pytest.approx(lost, rel=error, abs=0)
    assert at_last_length != pytest.approx(lost, rel=2e-5, abs=0)
    balance = solution.balance
    assert_balanced(balance, scene)


def joined_along(gap, limit, count):
    """Asperities joined over a motion: with the count at each instant, and with that of the turning points."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(gap)))) + 1
    edges = [0, *turns.tolist(), gap.size - 1]
    joined, total, adhered_energy = gap[0], 0.0, 0.0
    for first, last in pairwise(edges):
        if gap[last] > gap[first]:
            joined = max(joined, gap[last] - limit)
            continue
        path = np.minimum(gap[first : last + 1], joined)
        density = psi(path)
        step = -np.diff(path)
        whole = count[first : last + 1] * density
        total += np.sum(0.5 * (whole[1:] + whole[:-1]) * step)
        adhered_energy += count[last] * np.sum(0.5 * (density[1:] + density[:-1]) * step)
        joined = min(joined, gap[last])
    return total, adhered_energy


def test_the_force_holds_the_mesh_damping():
    """With damping the pinion's momentum is that of its torque and the force: without, 17 % of it are missing."""
    scene = HIGH.replace({"mesh.damping": 1e-8, "drive.harmonic": [], "run.duration": 2e-5})
    solution = dense(scene, 200_001)
    gears, force = scene.gears, solution.samples["mesh_force"]
    step = solution.time[1]
    impulse = scene.drive.torque * solution.time[-1] / gears.pinion_base_radius
    impulse -= step * (np.sum(force) - 0.5 * (force[0] + force[-1]))
    speed = solution.samples["pinion_speed"]
    momentum = gears.pinion_inertia * (speed[-1] - speed[0]) / gears.pinion_base_radius
    assert np.abs(momentum) > 0.0
    assert impulse == pytest.approx(momentum, abs=1e-5 * step * np.sum(np.abs(force)))


HERTZ = gd.load_case("cases/start_up.toml").replace({"contact.asperity": "hertz", "contact.bodies": "rigid"})


def test_a_gear_without_adhesion_is_trapped_by_none():
    """Dry resistance stops it a thousand times within half a pitch."""
    kept = engine.solve(HERTZ.replace({"run.samples": "off"})).extremes
    assert kept.reversals > 100
    assert (kept.turn_backs, kept.time_adhering) == (0, 0.0)


def test_a_gear_that_dry_resistance_holds_is_not_trapped_by_adhesion():
    """Adhesion turns a worn gear back, again and again; with a load it does so until dry resistance holds the gear."""
    worn = STUCK.replace({"coating.sam_fraction": 0.4, "run.samples": "off"})
    free, held = (engine.solve(worn.replace({"load.torque": torque})) for torque in (0.0, 2e-16))
    assert free.extremes.turn_backs > 1
    assert free.extremes.time_adhering > 0.0
    stick = held.events.time[held.events.kind == EventKind.STICK][-1]
    assert held.extremes.turn_backs == 0
    assert held.extremes.time_adhering < stick < 0.1 * worn.run.duration
