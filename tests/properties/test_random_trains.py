"""Trains drawn at random: each run ends as it should, and its samples are what mechanics demands."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.reference.random_trains import random_train

from gearidae.engine.train import solve_train
from gearidae.records.train_results import WORKS_OF_MESHES

SEED, FEW, MANY = 1, 40, 400
NUMBERS = [*range(FEW), *(pytest.param(n, marks=pytest.mark.by_hand) for n in range(FEW, MANY))]


@pytest.mark.parametrize("number", NUMBERS)
def test_a_random_train_moves_as_mechanics_demands(number):
    scene = random_train(SEED, number)
    solution = solve_train(scene)
    assert solution.status == "finished"
    for values in (*solution.samples.values(), *solution.shaft_totals.values()):
        assert np.isfinite(values).all()
    assert (np.diff(solution.events["time"]) >= 0.0).all()
    assert_energy_is_kept(solution)
    assert_shafts_turn_as_teeth_let_them(scene, solution)
    assert_hubs_bear_the_teeth(scene, solution)


def assert_energy_is_kept(solution):
    """Whole and mesh by mesh: what a mesh takes and gives apart is lost, or kept in its contacts."""
    energy, meshes = solution.energy, solution.mesh_totals
    assert abs(energy["residual"]) < energy["residual_bound"]
    lost = sum(meshes[name].sum() for name in WORKS_OF_MESHES if name.endswith("_loss"))
    kept = (meshes["work_in"] - meshes["work_out"]).sum() - lost
    kept -= energy["stored_change"] - energy["radius_work"]
    assert abs(kept) < energy["residual_bound"] + 1e-6 * np.abs(meshes["work_in"]).sum()
    assert all(meshes[name].min() >= -energy["residual_bound"] for name in ("damping_loss", "film_loss"))


def assert_shafts_turn_as_teeth_let_them(scene, solution):
    """R_a phi_a - R_b phi_b changes with the transmission error alone, in loops too, where teeth have no errors."""
    if any(mesh.mesh.static_error or mesh.mesh.pitch_error_rms > 0.0 for mesh in scene.train.meshes):
        return
    angle, errors = solution.samples["shaft_angle"], solution.samples["transmission_error"]
    for error, mesh in zip(errors, scene.train.meshes, strict=True):
        radii = mesh.geometry.base_radius_pinion, mesh.geometry.base_radius_gear
        apart = radii[0] * angle[mesh.a] - radii[1] * angle[mesh.b]
        size = np.abs(radii[0] * angle[mesh.a]).max()
        np.testing.assert_allclose(apart, error - error[0], rtol=0.0, atol=1e-15 + 1e-13 * size)


def assert_hubs_bear_the_teeth(scene, solution):
    """Their loads are the vector sums of what the drive flanks of all meshes push with, where those alone touch."""
    meshes, samples = scene.train.meshes, solution.samples
    if any(mesh.mesh.damping > 0.0 or mesh.mesh.film_damping > 0.0 for mesh in meshes):
        return
    far = np.array([15.0 * mesh.surface.roughness for mesh in meshes])[:, None]
    alone = (samples["coast_gap"] > far).all(axis=0)
    load = np.zeros((len(scene.shafts), 2, samples["mesh_force"].shape[1]))
    for force, mesh in zip(samples["mesh_force"], meshes, strict=True):
        alpha, sense = mesh.geometry.pressure_angle, scene.train.shafts[mesh.a].sense
        line = complex(math.sin(alpha), sense * math.cos(alpha)) * complex(
            math.cos(mesh.angle), math.sin(mesh.angle)
        )
        push = np.array([line.real, line.imag])[:, None] * force
        load[mesh.b] += push
        load[mesh.a] -= push
    found, largest = np.hypot(*load.transpose(1, 0, 2)), np.abs(samples["mesh_force"]).max()
    np.testing.assert_allclose(
        samples["hub_load"][:, alone], found[:, alone], rtol=1e-9, atol=1e-12 * largest
    )
    turned = np.arctan2(load[:, 1], load[:, 0]) - samples["hub_load_angle"]
    clear = alone[None, :] & (found > 1e-6 * largest)
    assert np.abs(np.sin(turned[clear])).max(initial=0.0) < 1e-6
    assert np.cos(turned[clear]).min(initial=1.0) > 0.0


def test_the_drawn_trains_are_of_many_kinds():
    scenes = [random_train(SEED, number) for number in range(FEW)]
    assert {len(scene.meshes) for scene in scenes} == {2, 3, 4}
    for has_it in (
        lambda scene: scene.train.loops,
        lambda scene: any(len(shaft.gears) > 1 for shaft in scene.train.shafts),
        lambda scene: scene.drive.torque < 0.0,
        lambda scene: any(shaft.hub_friction > 0.0 for shaft in scene.shafts.values()),
        lambda scene: scene.contact.asperity == "maugis",
        lambda scene: scene.mesh.film_damping > 0.0,
    ):
        assert sum(map(bool, map(has_it, scenes))) > FEW // 20
