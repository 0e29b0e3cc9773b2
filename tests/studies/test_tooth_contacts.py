"""Pairs of teeth at samples of a run, which is repeated for it: against what was recorded, and closed forms."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest

import gearidae as gd
from gearidae import engine
from gearidae.archive.select import run_scene
from gearidae.contact import line_force
from gearidae.records import EventKind, Flank
from gearidae.records.tooth_states import ContactState
from gearidae.studies._tooth_contacts import tooth_contacts

WORN = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})


@pytest.fixture(scope="module")
def slow():
    return gd.simulate(WORN, t_end=0.1, samples=10001)


@pytest.fixture(scope="module")
def fast():
    return gd.simulate(gd.preset("teodorescu2009"), t_end=5e-4, samples=5001)


@pytest.mark.parametrize("name", ["slow", "fast"])
def test_gaps_and_contacts_are_the_recorded_ones(name, request):
    ds = request.getfixturevalue(name)
    some = np.linspace(0, ds.sizes["time"] - 1, 300).astype(int)
    for at, state in zip(some, tooth_contacts(ds, ds.time.values[some]), strict=True):
        recorded = ds.isel(time=at)
        assert state.time == recorded.time
        for flank, gap in ((Flank.DRIVE, recorded.drive_gap), (Flank.COAST, recorded.coast_gap)):
            smallest = min(contact.gap for contact in state.contacts if contact.flank == flank)
            assert smallest == gap
        touching = sum(contact.state != ContactState.OPEN for contact in state.contacts)
        assert touching == recorded.pairs_in_contact


KINDS = {
    "statistical": {},
    "discrete": {"contact.roughness": "discrete", "coating.thickness": 1e-9, "initial.gap": 12e-9},
    "elastic": {"contact.bodies": "elastic"},
    "auto": {"contact.bodies": "auto", "initial.gear_speed": 5.0},
    "friction": {"contact.friction": 0.1, "coating.hamaker": 1e-21},
    "coarser": {"run.method": "bdf"},
}


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_look_at_every_sample_leaves_the_run_as_it_is(kind, backend):
    """To the last bit, also of what comes later; and the forces of the pairs add up to the recorded one."""
    slow = kind == "elastic" or backend == "sksundae"
    scene = gd.preset("teodorescu2009").replace(
        {"coating.sam_fraction": 0.5, "run.duration": 4e-6 if slow else 2e-5, "run.samples": 301}
    )
    scene = scene.replace(KINDS[kind])
    ds = gd.simulate(scene, backend=backend)
    states = engine.states_at(scene, range(301), backend=backend)
    for name in ("transmission_error", "gear_speed", "mesh_force"):
        np.testing.assert_array_equal([getattr(state, name) for state in states], ds[name])
    np.testing.assert_array_equal([state.time for state in states], ds.time)
    sums = [sum(contact.force * (1 - 2 * contact.flank) for contact in state.contacts) for state in states]
    largest = [max((abs(contact.force) for contact in state.contacts), default=0.0) for state in states]
    # a sum of a few numbers, rounded in two orders
    assert (np.abs(np.array(sums) - ds.mesh_force) <= 1e-14 * np.array(largest)).all()
    assert np.abs(ds.mesh_force).max() > 0.0
    touching = [sum(contact.state != ContactState.OPEN for contact in state.contacts) for state in states]
    np.testing.assert_array_equal(touching, ds.pairs_in_contact)


def test_force_of_a_pair_is_that_of_the_contact_law(slow):
    compared = 0
    for state in tooth_contacts(slow, [0.004, 0.05, 0.0773]):
        for contact in state.contacts:
            if contact.flank != Flank.DRIVE:
                continue
            parts = ((0.5, WORN.surface, "bare"), (0.5, WORN.coated_surface, "coated"))
            law = sum(
                share
                * line_force(contact.gap, contact.gap - contact.joined[part], contact.radius, 2e-6, surface)
                for share, surface, part in parts
            )
            # the tables' own error and the cancellation of pushing and pulling asperities
            assert contact.force == pytest.approx(float(law), rel=1e-6, abs=0.0)
            compared += 1
    assert compared >= 4


def test_states_follow_the_events(slow):
    """After a full stretch and until the pair turns round, some part of it is fully stretched."""
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
            sample = math.ceil(time / step) * step
            if kind == EventKind.FULL_STRETCH and sample < after:
                asked.append((sample, pair))
    for (_, pair), state in zip(asked, tooth_contacts(slow, [time for time, _ in asked]), strict=True):
        (contact,) = (
            contact for contact in state.contacts if (contact.pair, contact.flank) == (pair, Flank.DRIVE)
        )
        if contact.state != ContactState.OPEN:
            assert contact.state == ContactState.FULLY_STRETCHED
            checked += 1
    assert checked > 5


def test_a_state_does_not_depend_on_what_else_is_asked(fast):
    """Each time the run begins anew."""
    times = np.linspace(1e-4, 5e-4, 40)
    together = tooth_contacts(fast, times)
    assert [tooth_contacts(fast, time)[0] for time in times[::8]] == together[::8]
    backwards = tooth_contacts(fast, times[::-1])
    assert backwards[::-1] == together


def test_thinned_samples_have_the_states_of_the_whole_run(slow):
    coarse = slow.isel(time=slice(3, None, 200), event=slice(0, 0))
    assert tooth_contacts(coarse, coarse.time.values) == tooth_contacts(slow, coarse.time.values)


def test_a_run_that_moves_otherwise_is_not_taken_for_the_recorded_one(slow):
    other = slow.assign_attrs(scene=json.dumps(WORN.replace({"drive.torque": 4.001e-18}).to_dict()))
    with pytest.raises(
        gd.SceneError, match=r"cannot be repeated here: its scene moves otherwise at t = 0\.05 s"
    ):
        tooth_contacts(other, 0.05)
    changed = slow.copy(deep=True)
    changed["transmission_error"][5000] += 1e-13
    with pytest.raises(gd.SceneError, match="cannot be repeated here"):
        tooth_contacts(changed, 0.05)
    assert tooth_contacts(changed, 0.06) == tooth_contacts(slow, 0.06)
    half = WORN.replace({"run.duration": 0.05, "run.samples": 5001})
    with pytest.raises(gd.SceneError, match=r"cannot be repeated here: its scene ends before t = 0\.1 s"):
        tooth_contacts(slow.assign_attrs(scene=json.dumps(half.to_dict())), 0.1)


def test_runs_that_go_on_from_others(tmp_path):
    """Each from the state that it went on from, whatever has become of the archives before; so do those of a chain."""
    half = 2.0**-6
    scene = WORN.replace({"run.duration": half, "run.samples": 65})
    first = gd.simulate(scene)
    loaded = scene.replace({"drive.torque": 5e-18, "run.samples": 33})
    second = gd.simulate(loaded, start=first, archive=tmp_path / "second.nc")
    third = gd.simulate(scene, start=second)
    chain = gd.concat([first, second, third], "time")
    states = tooth_contacts(chain, chain.time.values)
    assert [state.time for state in states] == chain.time.values.tolist()
    np.testing.assert_array_equal([state.mesh_force for state in states], chain.mesh_force)
    alone = [*tooth_contacts(first, first.time.values), *tooth_contacts(second, second.time.values)[1:]]
    assert states[: len(alone)] == alone
    assert {contact.pair for contact in states[-1].contacts} - {
        contact.pair for contact in states[0].contacts
    }
    older = second.copy()
    del older.attrs["parent"]
    with pytest.raises(gd.SceneError, match="holds neither scene nor end of the run that it goes on from"):
        tooth_contacts(older, half)
    with pytest.raises(gd.SceneError, match="parent: is damaged"):
        tooth_contacts(second.assign_attrs(parent="x"), half)


def test_static_error_is_part_of_the_recorded_motion():
    scene = WORN.replace(
        {"mesh.static_error": [{"order": 19, "amplitude": "5 nm", "phase": 0.4}], "run.samples": 4001}
    )
    ds = gd.simulate(scene, t_end=0.02)
    states = tooth_contacts(ds, np.linspace(0.0, 0.02, 50))
    for state in states:
        forces = sum(contact.force * (1 - 2 * contact.flank) for contact in state.contacts)
        assert forces == pytest.approx(state.mesh_force, rel=1e-9, abs=0.0)


def test_runs_of_a_sweep_have_their_own_scene():
    swept = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [4e-18, 4.5e-18]}
    ds = gd.sweep(WORN, swept, t_end=1e-3, samples=101)
    run = ds.isel(sam_fraction=0, torque=1)
    scene = run_scene(run)
    assert (scene.coating.sam_fraction, scene.drive.torque) == (1.0, 4.5e-18)
    (state,) = tooth_contacts(run, 0.0)
    assert set(state.contacts[0].states) == {"coated"}
    assert state.mesh_force == run.mesh_force[0]
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
