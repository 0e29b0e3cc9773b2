"""Friction in closed form against reference numbers, textbook formulas, and the balance of torques at one place."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from gearidae.mesh import curvature_radii, friction, mesh_geometry

PAPER = mesh_geometry(34.715e-6, 19, 76, math.radians(20))
TORQUE, RESISTANCE = 2.43e-11, 3e-11
LAST = {"abs": 0.0, "rel": 1e-5}  # of numbers that are printed with six digits


@st.composite
def pairs(draw):
    """Pairs that can run, see test_involute."""
    return mesh_geometry(
        draw(st.floats(1e-6, 1e-3)),
        draw(st.integers(18, 200)),
        draw(st.integers(18, 200)),
        math.radians(draw(st.floats(20, 25))),
    )


def test_numbers_of_the_preset():
    """By a separate program, with quadrature of its own."""
    assert friction.loss_fraction(PAPER, 1.0, equal_shares=True) == pytest.approx(0.153276, **LAST)
    assert friction.loss_fraction(PAPER, 1.0) == pytest.approx(0.145249, **LAST)
    loss = friction.loss_per_pitch(PAPER, 0.1, TORQUE / PAPER.base_radius_pinion)
    assert loss == pytest.approx(1.1672e-13, abs=0.0, rel=5e-5)
    assert friction.efficiency(PAPER, 0.1) == pytest.approx(0.985752, **LAST)
    assert friction.efficiency(PAPER, 0.3) == pytest.approx(0.958771, **LAST)
    assert friction.locking_coefficients(PAPER) == pytest.approx((2.277, 1.615), rel=5e-4)
    started = friction.hub_starting_torque(PAPER, RESISTANCE, 0.3, (3e-6, 6e-6))
    assert started == pytest.approx(7.7955e-12, abs=0.0, rel=1e-5)


@given(pairs())
def test_equal_shares_are_the_textbook_formula(geometry):
    """Two pairs at most, one on each side of the pitch point: a contact ratio below 2 of such gears."""
    pitch, length = geometry.base_pitch, geometry.path_length
    assume(length - pitch <= geometry.approach <= pitch)
    ratios = geometry.approach / pitch, geometry.recess / pitch
    wanted = 1.0 - sum(ratios) + ratios[0] ** 2 + ratios[1] ** 2
    wanted *= math.pi * (1.0 / geometry.pinion_teeth + 1.0 / geometry.gear_teeth)
    assert friction.loss_fraction(geometry, 1.0, equal_shares=True) == pytest.approx(wanted, rel=1e-12)


@given(pairs(), st.floats(0.0, 0.3))
def test_efficiency_is_one_less_the_loss_for_small_coefficients(geometry, coefficient):
    """They differ by less than the square of the largest share of torque that friction takes."""
    kept = friction.efficiency(geometry, coefficient)
    by_loss = 1.0 - friction.loss_fraction(geometry, coefficient)
    pinion, _, _ = curvature_radii(geometry, geometry.path_length)
    assert abs(kept - by_loss) <= (coefficient * float(pinion) / geometry.base_radius_pinion) ** 2 + 1e-12
    assert kept <= 1.0 + 1e-12


@given(pairs(), st.floats(0.0, 1.0), st.floats(0.0, 1.5))
def test_torques_of_one_pair_balance_its_power(geometry, place, coefficient):
    """M1 w1 - M2 w2 is the power of friction, mu W |v|, at w1 R1 = w2 R2."""
    xi = place * geometry.path_length
    pinion, gear, _ = (float(r) for r in curvature_radii(geometry, xi))
    r1, r2 = geometry.base_radius_pinion, geometry.base_radius_gear
    assume(abs(xi - geometry.approach) > 1e-9 * geometry.path_length)
    sign = math.copysign(1.0, xi - geometry.approach)
    gear_torque = r2 + sign * coefficient * gear  # W = 1
    assume(abs(gear_torque) > 1e-6 * r2)
    pinion_torque = float(friction.torque_ratio(geometry, xi, coefficient)) * gear_torque
    sliding = pinion * r2 / r1 - gear
    rubbed = pinion_torque * r2 / r1 - gear_torque
    assert rubbed == pytest.approx(coefficient * abs(sliding), rel=1e-9, abs=1e-12 * r2)


@given(pairs())
def test_locking_is_where_a_torque_vanishes_and_nowhere_before(geometry):
    pinion_drives, gear_drives = friction.locking_coefficients(geometry)
    everywhere = np.linspace(0.0, geometry.path_length, 201)
    pinion, gear, _ = curvature_radii(geometry, everywhere)
    before, after = everywhere < geometry.approach, everywhere > geometry.approach
    left = geometry.base_radius_gear - pinion_drives * gear[before]
    assert left[0] == pytest.approx(0.0, abs=1e-12 * geometry.base_radius_gear)
    assert (left[1:] > 0.0).all()
    left = (
        geometry.base_radius_pinion - gear_drives * pinion[after]
    )  # slides the other way round: gear drives
    assert left[-1] == pytest.approx(0.0, abs=1e-12 * geometry.base_radius_pinion)
    assert (left[:-1] > 0.0).all()


def test_a_free_gear_is_held_by_forces_on_both_sides_of_the_pitch_point():
    """Two pairs: f1 and f2 of the two balances of torque, each at its limit where the torque is the largest held."""
    limits = np.array([2e-9, 3e-9])
    places = PAPER.approach + np.array([-4e-6, PAPER.base_pitch - 4e-6])
    held = friction.adhesive_hold(PAPER, places, limits)
    pinion, gear, _ = curvature_radii(PAPER, places)
    signs = np.array([-1.0, 1.0])
    f = signs * limits
    # the gear is free: R2 W = -sum f r2, and the pinion feels R1 W + sum f r1
    force = -(f @ gear) / PAPER.base_radius_gear
    assert held == pytest.approx(PAPER.base_radius_pinion * force + f @ pinion, rel=1e-12, abs=0.0)
    assert friction.adhesive_hold(PAPER, [PAPER.approach], [1.0]) == 0.0


def test_a_hub_locks():
    radius = PAPER.base_radius_gear / 0.3
    assert friction.hub_starting_torque(PAPER, RESISTANCE, 0.3, (0.0, radius)) == math.inf
    assert friction.hub_starting_torque(PAPER, RESISTANCE, 0.0, (3e-6, 6e-6)) == pytest.approx(
        RESISTANCE * 19 / 76, rel=1e-12, abs=0.0
    )


@settings(max_examples=25)
@given(pairs(), st.floats(0.0, 0.5), st.floats(0.0, 0.5))
@example(PAPER, 0.3, 0.3)
def test_the_worst_place_to_start_from(geometry, coefficient, hub):
    """No place of a grid is worse, some of the preset's is nearly as bad, and hubs alone give their closed form."""
    r1, r2, pitch = geometry.base_radius_pinion, geometry.base_radius_gear, geometry.base_pitch
    hubs = (0.1 * r1, 0.05 * r2)
    ratio = friction.starting_ratio(geometry, coefficient, hub, hubs)
    ratios = []
    for newest in np.linspace(0.0, pitch, 301)[1:-1]:
        places = np.arange(newest, geometry.path_length, pitch)
        pinion, gear, reduced = curvature_radii(geometry, places)
        share = np.sqrt(reduced) / np.sqrt(reduced).sum()
        f = coefficient * np.sign(places - geometry.approach) * share
        carried = math.hypot(1.0, f.sum())
        ratios.append((r1 + f @ pinion + hub * hubs[0] * carried) / (r2 + f @ gear - hub * hubs[1] * carried))
    assert ratio >= max(ratios) * (1.0 - 1e-5)
    if geometry is PAPER:  # others may have the worst place in a piece that the grid misses
        assert ratio == pytest.approx(max(ratios), rel=1e-3)
    alone = friction.starting_ratio(geometry, 0.0, hub, hubs)
    assert alone == pytest.approx(friction.hub_starting_torque(geometry, 1.0, hub, hubs), rel=1e-12)
