"""Pairs of teeth reconstructed from a record: against what the engine recorded, and against slow twins."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gearidae as gd
from gearidae.archive.select import run_scene
from gearidae.contact import line_force
from gearidae.contact.history import joined_height
from gearidae.records import EventKind, Flank
from gearidae.studies._tooth_contacts import tooth_contacts
from gearidae.studies.tooth_record import joined_heights
from gearidae.studies.tooth_states import ContactState

WORN = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})


@pytest.fixture(scope="module")
def slow():
    return gd.simulate(WORN, t_end=0.1, samples=10001)


@pytest.fixture(scope="module")
def fast():
    return gd.simulate(gd.preset("teodorescu2009"), t_end=5e-4, samples=5001)


@given(st.lists(st.integers(-40, 40), min_size=1, max_size=60), st.integers(1, 20))
def test_joined_heights_are_those_followed_step_by_step(path, limit):
    gaps = np.array(path, dtype=np.float64)
    followed = [gaps[0]]
    for gap in gaps[1:]:
        followed.append(joined_height(followed[-1], gap, float(limit)))
    # every step is monotone, so that the operator may be applied at each of them: the same numbers exactly
    np.testing.assert_array_equal(joined_heights(gaps, np.arange(len(gaps)), float(limit)), followed)


@pytest.mark.parametrize("name", ["slow", "fast"])
def test_gaps_and_contacts_are_the_recorded_ones(name, request):
    ds = request.getfixturevalue(name)
    some = np.linspace(0, ds.sizes["time"] - 1, 300).astype(int)
    for at, state in zip(some, tooth_contacts(ds, ds.time.values[some]), strict=True):
        recorded = ds.isel(time=at)
        assert state.time == recorded.time
        for flank, gap in ((Flank.DRIVE, recorded.drive_gap), (Flank.COAST, recorded.coast_gap)):
            smallest = min(one.gap for one in state.contacts if one.flank == flank)
            # sums of lengths of 1e-7 m, rounded
            assert smallest == pytest.approx(gap.item(), rel=1e-12, abs=1e-21)
        touching = sum(one.state != ContactState.OPEN for one in state.contacts)
        assert touching == recorded.pairs_in_contact


@pytest.mark.parametrize(("name", "error"), [("slow", 2e-3), ("fast", 2e-5)])
def test_forces_of_the_pairs_add_up_to_the_recorded_one(name, error, request):
    """The record has no part in them; they differ by the cubic between samples at turning points of the gap."""
    ds = request.getfixturevalue(name)
    states = tooth_contacts(ds, np.linspace(0.0, float(ds.time[-1]), 400))
    assert all(state.recovered for state in states)
    forces = np.array([state.mesh_force for state in states])
    mismatch = np.array([state.mismatch for state in states])
    assert np.sqrt(np.mean(mismatch**2)) < error * np.sqrt(np.mean(forces**2))


def test_force_of_a_pair_is_that_of_the_contact_law(slow):
    compared = 0
    for state in tooth_contacts(slow, [0.004, 0.05, 0.0773]):
        for one in state.contacts:
            if one.flank != Flank.DRIVE:
                continue
            parts = ((0.5, WORN.surface, "bare"), (0.5, WORN.coated_surface, "coated"))
            law = sum(
                share * line_force(one.gap, one.gap - one.joined[part], one.radius, 2e-6, surface)
                for share, surface, part in parts
            )
            # the tables' own error and the cancellation of pushing and pulling asperities
            assert one.force == pytest.approx(float(law), rel=1e-6, abs=0.0)
            compared += 1
    assert compared >= 4


def test_states_follow_the_events(slow):
    """After a full stretch and until the pair turns round, some part of it is fully stretched.

    Samples less than a hundredth of their distance after the event are not asked: the joined height at the turning
    point comes from the cubic between two samples, which is good to about a thousandth of the stretch limit.
    """
    checked = 0
    of_pair = {}
    for time, kind, pair, flank in zip(
        slow.event_time.values,
        slow.event_kind.values,
        slow.event_pair.values,
        slow.event_flank.values,
        strict=True,
    ):
        if flank == Flank.DRIVE:
            of_pair.setdefault(pair, []).append((time, kind))
    step = float(slow.time[1])
    asked = []
    for pair, events in of_pair.items():
        for (time, kind), (after, _) in itertools.pairwise(events):
            sample = math.ceil(time / step + 0.01) * step
            if kind == EventKind.FULL_STRETCH and sample < after:
                asked.append((sample, pair))
    for (_, pair), state in zip(asked, tooth_contacts(slow, [time for time, _ in asked]), strict=True):
        (one,) = (one for one in state.contacts if (one.pair, one.flank) == (pair, Flank.DRIVE))
        if one.state != ContactState.OPEN:
            assert one.state == ContactState.FULLY_STRETCHED
            checked += 1
    assert checked > 5


def test_a_state_does_not_depend_on_what_else_is_asked(fast):
    """Histories are followed from before a pair came near; what came earlier does not matter."""
    times = np.linspace(1e-4, 5e-4, 40)
    together = tooth_contacts(fast, times)
    assert [tooth_contacts(fast, time)[0] for time in times[::8]] == together[::8]
    backwards = tooth_contacts(fast, times[::-1])
    assert backwards[::-1] == together


def test_what_a_record_does_not_tell_is_not_made_up(slow):
    coarse = slow.isel(time=slice(None, None, 200), event=slice(0, 0))
    states = tooth_contacts(coarse, coarse.time.values)
    unrecovered = [state for state in states if not state.recovered]
    assert unrecovered
    for state in unrecovered:
        for one in state.contacts:
            assert math.isnan(one.force)
            assert set(one.states.values()) <= {ContactState.UNRECOVERABLE, ContactState.OPEN}
            assert math.isfinite(one.gap)


def test_static_error_is_part_of_the_recorded_motion():
    scene = WORN.replace(
        {"mesh.static_error": [{"order": 19, "amplitude": "5 nm", "phase": 0.4}], "run.samples": 4001}
    )
    ds = gd.simulate(scene, t_end=0.02)
    states = tooth_contacts(ds, np.linspace(0.0, 0.02, 50))
    assert all(state.recovered for state in states)
    assert sum(abs(state.mismatch) for state in states) < 0.01 * sum(
        abs(state.mesh_force) for state in states
    )


def test_runs_of_a_sweep_have_their_own_scene():
    swept = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [4e-18, 4.5e-18]}
    ds = gd.sweep(WORN, swept, t_end=1e-3, samples=101)
    run = ds.isel(sam_fraction=0, torque=1)
    scene = run_scene(run)
    assert (scene.coating.sam_fraction, scene.drive.torque) == (1.0, 4.5e-18)
    (state,) = tooth_contacts(run, 0.0)
    assert set(state.contacts[0].states) == {"coated"}
    with pytest.raises(gd.SceneError, match="single run"):
        tooth_contacts(ds, 0.0)


def test_refusals(slow):
    with pytest.raises(gd.SceneError, match="must lie in the record"):
        tooth_contacts(slow, 0.2)
    with pytest.raises(gd.SceneError, match="no teeth"):
        tooth_contacts(gd.simulate(gd.preset("roller_slow"), samples=11), 0.0)
    empty = slow.copy()
    empty["transmission_error"] = empty.transmission_error * np.nan
    with pytest.raises(gd.SceneError, match="no samples"):
        tooth_contacts(empty, 0.0)
