"""Statics of trains against an independent prototype: shares of a split path, modes, starting torques."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.reference.trains import HUBS, chain, compound, split

import gearidae as gd
from gearidae.mesh.train_modes import levers, natural_frequencies
from gearidae.runs import train_statics
from gearidae.runs.train_statics import (
    hub_loads,
    mesh_forces,
    overlapping,
    ratios,
    resisting_torques,
    starting_torque,
    steady_speed,
)
from gearidae.scene import Scene


def test_forces_of_a_chain_are_those_of_its_drive():
    scene = Scene.from_dict(chain())
    assert mesh_forces(scene) == pytest.approx([3.456719e-7] * 2, rel=1e-7)
    # R1/R3 M1 = M_load + alpha w3^2
    assert steady_speed(scene) == pytest.approx(4.0 * math.sqrt((4.8e-11 - 3e-11) / 8e-18), rel=1e-12)


def test_a_shaft_that_takes_its_own_torque_leaves_less():
    """The balance of every shaft holds, and an idler that takes half leaves half of the power."""
    scene = Scene.from_dict(chain(load={"torque": 3e-11})).replace({"shafts.idler.resistance": 6e-11})
    torque, taken = resisting_torques(scene)
    forces = mesh_forces(scene)
    outside = -taken
    outside[0] += torque
    assert levers(scene.train).T @ forces == pytest.approx(outside, abs=1e-12 * torque)
    power = [
        forces[0] * levers(scene.train)[0, 0],
        forces[1] * levers(scene.train)[1, 1] * ratios(scene.train)[1],
    ]
    assert power == pytest.approx([1.2e-11, 1.2e-11 * 7.5 / 37.5], rel=1e-9)


@pytest.mark.parametrize(
    ("offset", "share"), [(0.0, 0.50077532), (3e-9, 0.73834591), (-3e-9, 0.26284935), (6e-9, 0.89144772)]
)
def test_a_split_path_of_rough_teeth_shares_to_the_nanometre(offset, share):
    tables = split()
    tables["meshes"]["two"]["offset"] = offset
    forces = mesh_forces(Scene.from_dict(tables))
    assert forces[:2].sum() == pytest.approx(3.456719e-7, rel=1e-7, abs=0.0)
    assert forces[0] / forces[:2].sum() == pytest.approx(share, abs=6e-9)
    assert forces[2:] == pytest.approx(forces[:2], rel=1e-9)


def test_forces_of_a_loop_that_are_not_found_are_no_numbers(monkeypatch):
    monkeypatch.setattr(train_statics, "_NEWTON", 2)
    with pytest.raises(gd.SolverError, match=r"^forces of a train with a loop were not found"):
        mesh_forces(Scene.from_dict(split()))


def test_forces_of_a_loop_that_adhesion_presses_are_found():
    """Bare teeth that an offset sets against each other: thousands of times the drive's force, of which rounding is."""
    tables = split(
        coating={"sam_fraction": 0.0, "energy": 0.02}, contact={"bodies": "rigid", "asperity": "jkr"}
    )
    tables["surface"] |= {
        "youngs_modulus": "53 GPa",
        "roughness": "2.2 nm",
        "asperity_density": "278 / um^2",
        "asperity_radius": "280 nm",
    }
    tables["meshes"]["two"]["offset"] = "-3.2 nm"
    torque = 1e-12
    tables["load"], tables["drive"] = {"torque": 0.0}, {"torque": torque}
    scene = Scene.from_dict(tables)
    forces, radius = mesh_forces(scene), scene.train.meshes[0].geometry.base_radius_pinion
    assert np.abs(forces).max() > 1000.0 * torque / radius
    # the inertia of the train takes the torque, that of the input its part of it
    inertia = np.array([shaft.inertia * float(shaft.ratio) ** 2 for shaft in scene.train.shafts])
    passed_on = torque * inertia[1:].sum() / inertia.sum()
    assert (forces[0] + forces[1]) * radius == pytest.approx(passed_on, rel=1e-6, abs=0.0)


def test_a_loop_without_torques_carries_nothing():
    still = Scene.from_dict(split()).replace({"drive": {"torque": 0.0}, "load": None})
    assert mesh_forces(still).tolist() == [0.0] * 4


def test_modes_are_coupled_by_the_idler():
    scene = Scene.from_dict(chain())
    modes = 2.0 * math.pi * np.array(natural_frequencies(scene, mesh_forces(scene)))
    assert modes == pytest.approx([2.532629e6, 6.053399e6], rel=1e-6)
    closed = Scene.from_dict(split())
    assert len(natural_frequencies(closed, mesh_forces(closed))) == 3


@pytest.mark.parametrize(
    ("angle", "first", "idler", "torque"),
    [
        ("0 deg", 2.2610960e-7, 4.1816285e-7, 8.0528934e-12),
        ("-40 deg", 2.2658146e-7, 4.4546370e-7, 8.0696985e-12),
        ("40 deg", 2.2475638e-7, 3.3986788e-7, 8.0046985e-12),
        ("90 deg", 2.2210376e-7, 1.8639161e-7, 7.9102254e-12),
        ("140 deg", 2.1888224e-7, 0.0, 7.7954910e-12),
    ],
)
def test_hubs_of_a_chain_start_by_the_angle_of_its_idler(angle, first, idler, torque):
    """At 180 deg less twice the pressure angle the idler's hub takes nothing."""
    scene = Scene.from_dict(chain(angle, hubs=0.3, load={"torque": 3e-11}))
    start, forces = starting_torque(scene)
    assert start == pytest.approx(torque, rel=1e-7, abs=0.0)
    assert forces[0] == pytest.approx(first, rel=1e-7, abs=0.0)
    assert math.hypot(*hub_loads(scene.train, forces)[1]) == pytest.approx(idler, rel=1e-7, abs=1e-15)


@pytest.mark.parametrize(
    ("angles", "torque", "loads"),
    [
        ((0.0, 0.0, 0.0), 1.0826690e-11, [3.0399243e-7, 1.4019489e-6, 4.2339603e-6, 3.2832336e-6]),
        ((0.0, "60 deg", "-30 deg"), 1.0521435e-11, [2.9542144e-7, 1.1204068e-6, 2.6982513e-6, 3.2832336e-6]),
    ],
)
def test_starting_torque_of_a_reduction(angles, torque, loads):
    tables = compound(angles, load={"torque": 4.5e-10})
    for shaft, radius in zip(tables["shafts"].values(), (3e-6, 5e-6, 5e-6, 6e-6), strict=True):
        shaft |= {"hub_friction": 0.3, "hub_radius": radius}
    scene = Scene.from_dict(tables)
    start, forces = starting_torque(scene)
    assert start == pytest.approx(torque, rel=1e-7, abs=0.0)
    assert np.hypot(*hub_loads(scene.train, forces).T) == pytest.approx(loads, rel=1e-7)


@pytest.mark.parametrize(
    ("coefficient", "torque"),
    [(3.0, 1.506792e-11), (12.0, 1.597654e-10), (17.0, 5.936390e-9), (17.36, math.inf)],
)
def test_hubs_lock(coefficient, torque):
    """From 17.3575 on; coefficients above 2 are written into the radii, of which only the product counts."""
    tables = chain("0 deg", load={"torque": 3e-11})
    for shaft, radius in zip(tables["shafts"].values(), HUBS, strict=True):
        shaft |= {"hub_friction": 2.0, "hub_radius": 0.5 * coefficient * radius}
    assert starting_torque(Scene.from_dict(tables))[0] == pytest.approx(torque, rel=1e-6, abs=0.0)


def test_gears_that_overlap_are_named():
    assert not list(overlapping(Scene.from_dict(chain()).train))
    assert ("input", "output") in overlapping(Scene.from_dict(chain("180 deg")).train)


def test_validity_has_rows_for_each_mesh():
    rows = gd.studies.validity(Scene.from_dict(chain()))
    first, second = rows.number["first.expected_asperities"], rows.number["second.expected_asperities"]
    assert 0.0 < first < second
    assert not any("disc_drag" in name or "inertia" in name for name in rows.index)
