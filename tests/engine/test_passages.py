"""The table of passages: rows at mesh exits, running sums of the energy balance, forces and impacts in between."""

import numpy as np
import pytest

import gearidae as gd
from balances import assert_balanced
from gearidae.engine import native, portable, solve
from gearidae.engine.backend import run_blocks
from gearidae.engine.integrate import driver
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind, Passages, Statistics
from gearidae.records.energy import TERMS

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"coating.sam_fraction": 0.5, "contact.bodies": "rigid", "run.duration": 0.08, "run.samples": "off"}
)
FAST = gd.preset("teodorescu2009").replace(
    {
        "coating.sam_fraction": 0.6,
        "contact.bodies": "rigid",
        "run.duration": 1e-4,
        "run.samples": "off",
        "mesh.damping": 1e-7,
        "load.viscous": 1e-16,
    }
)
LOSSES = {
    "adhesion and drag": {},
    "the changing radius": {"mesh.radius_force": True},
    "a film of gas": {"mesh.film_damping": 1e-7, "mesh.film_gap": 2e-8},
    "friction of flanks and hubs": {
        "contact.friction": 0.1,
        "contact.friction_law": "coulomb",
        "gears.hub_friction": 0.05,
        "gears.pinion_hub_radius": 5e-6,
        "gears.gear_hub_radius": 5e-6,
    },
    "attraction": {"surface.interaction_range": 2e-9},
    "elastic bodies": {"contact.bodies": "elastic", "run.duration": 3e-5},
    "discrete asperities": {
        "contact.roughness": "discrete",
        "mesh.radius_force": True,
        "run.duration": 1.2e-5,
    },
}
"""What loses energy besides, one by one."""


@pytest.fixture(params=["native", "sksundae"])
def backend(request):
    return request.param


def blocks_of(scene, backend, resume=None):
    problem = make_problem(scene)
    return list(run_blocks(problem, scene.run.rtol, 0, backend, Statistics(), resume))


def every_step(monkeypatch):
    """A block for each accepted step."""
    monkeypatch.setattr(native, "FIRST_STEPS", 1)
    monkeypatch.setattr(native, "BLOCK_STEPS", 1)
    monkeypatch.setattr(portable, "BLOCK_SECONDS", 0.0)


def mesh_exits(events):
    return np.flatnonzero(events.kind == EventKind.MESH_EXIT)


# -- rows ------------------------------------------------------------------------------------------------------------


def test_a_row_for_each_mesh_exit(backend):
    run = solve(FAST.replace({"run.duration": 3e-4 if backend == "native" else 8e-5}), backend=backend)
    rows, exits = run.passages, mesh_exits(run.events)
    assert len(rows) > (8 if backend == "native" else 2)
    for name in ("time", "pair", "flank"):
        np.testing.assert_array_equal(getattr(rows, name), getattr(run.events, name)[exits])
    for flank in (0, 1):
        on_flank = rows.flank == flank
        onsets = run.events.time[(run.events.kind == EventKind.ONSET) & (run.events.flank == flank)]
        made = np.searchsorted(onsets, rows.time[on_flank], side="right")
        np.testing.assert_array_equal(rows.impacts[on_flank], np.diff(made, prepend=0))


def test_both_drivers_agree():
    native_run, other = (solve(FAST, backend=name, rtol=1e-8, t_end=6e-5) for name in ("native", "sksundae"))
    assert len(native_run.passages) == len(other.passages) > 2
    for name in Passages.columns:
        first, second = getattr(native_run.passages, name), getattr(other.passages, name)
        # a thousand tolerances, over the largest of the numbers; peaks of the force as accurate as the step's formula
        accuracy = 1e-4 if name.endswith("_force") else 1e-5
        np.testing.assert_allclose(first, second, rtol=0.0, atol=accuracy * max(np.abs(first).max(), 1e-300))


def test_without_passages_the_run_is_the_same(backend):
    until = 1e-4 if backend == "native" else 5e-5
    with_table, without = (
        solve(FAST.replace({"run.passages": on}), backend=backend, t_end=until) for on in (True, False)
    )
    assert len(with_table.passages) > 0
    assert len(without.passages) == 0
    assert with_table.statistics.steps == without.statistics.steps
    assert dict(with_table.balance) == dict(without.balance)
    np.testing.assert_array_equal(with_table.events.table(), without.events.table())


def test_without_a_balance_the_sums_are_missing():
    whole, rows = solve(FAST).passages, solve(FAST.replace({"run.balance": False})).passages
    for name in Passages.columns:
        first, second = getattr(whole, name), getattr(rows, name)
        np.testing.assert_array_equal(np.full(len(first), np.nan) if name in TERMS else first, second)


# -- running sums ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("losses", "backend"), [("adhesion and drag", "sksundae"), *((name, "native") for name in LOSSES)]
)
def test_the_sums_are_those_of_the_energy_balance(losses, backend, monkeypatch):
    """The balance is looked at after each step: at a mesh exit it has the numbers of the row, but for rounding."""
    scene = FAST.replace({"run.duration": 3e-5, "run.rtol": 1e-5} | LOSSES[losses])
    every_step(monkeypatch)
    blocks = blocks_of(scene, backend)
    rows = Passages.of_table(np.concatenate([block.passages for block in blocks]))
    balances = {block.time: block.balance for block in blocks if block.balance is not None}
    assert len(rows) > 0
    seen = 0
    for place, time in enumerate(rows.time):
        if time not in balances:  # a step that ends behind a root within it
            continue
        seen += 1
        balance = balances[time]
        for name in TERMS:
            rounding = 1e-13 * (balance.throughput + abs(balance.stored_change) + balance.largest)
            assert getattr(rows, name)[place] == pytest.approx(balance[name], rel=1e-12, abs=rounding)
    assert seen > 0
    # every row closes as well as the run, whose bound grows with the energy exchanged
    closes = sum(term.sign * getattr(rows, name) for name, term in TERMS.items())
    last = blocks[-1].balance
    assert_balanced(last, scene)
    assert np.abs(closes).max() <= last.bound(scene.run.rtol, roller=False)


def test_all_terms_of_the_balance_are_there():
    assert set(TERMS) <= set(Passages.columns)


def test_energy_per_tooth_needs_no_chain_of_runs():
    """Over a start-up from rest: the differences of the rows, and of the balances of runs from exit to exit."""
    scene = LOW.replace({"initial.gear_speed": 0.0, "run.duration": 0.2, "run.rtol": 1e-8})
    rows = solve(scene).passages
    drive = np.flatnonzero(rows.flank == 0)[:3]
    assert len(drive) == 3
    ends, part, before, sums = rows.time[drive], None, 0.0, []
    for end in ends:
        piece = scene.replace({"run.duration": float(end - before)})
        part = gd.simulate(piece) if part is None else gd.simulate(piece, start=part)
        sums.append({name: float(part[name]) for name in TERMS})
        before = end
    for name in ("drive_work", "adhesion_loss", "damping_loss", "kinetic_change"):
        chain = np.diff([energies[name] for energies in sums])
        table = np.diff(getattr(rows, name)[drive])
        # the motion of the chain is another one within the tolerance, after which vibrations have decayed or not
        np.testing.assert_allclose(table, chain, rtol=1e-4, atol=1e-6 * sums[-1]["drive_work"])


# -- forces and impacts ----------------------------------------------------------------------------------------------


def test_forces_are_those_between_mesh_exits():
    """Against the samples in between, which miss the peak of an impact by little; 0 where the flank has not touched."""
    run = solve(FAST.replace({"run.samples": 200_001}))
    rows, force = run.passages, run.samples["mesh_force"]
    scale = np.abs(force).max()
    contact = np.isin(run.events.kind, (EventKind.ONSET, EventKind.SEPARATION))
    for flank in (0, 1):
        exits = np.flatnonzero(rows.flank == flank)
        met = run.events.time[contact & (run.events.flank == flank)]
        assert len(exits) > 1
        bounds = np.searchsorted(run.time, [0.0, *rows.time[exits]])
        for place, low, high in zip(exits, bounds[:-1], bounds[1:], strict=True):
            piece = force[low:high]
            if rows.largest_force[place] == rows.smallest_force[place] == 0.0:
                assert not ((met > run.time[low]) & (met < run.time[high - 1])).any()
                continue
            assert -1e-6 * scale <= rows.largest_force[place] - piece.max() <= 1e-3 * scale
            assert -1e-6 * scale <= piece.min() - rows.smallest_force[place] <= 1e-3 * scale


def test_a_flank_that_never_touches_has_no_force_and_no_impact():
    """At low speed, without wear, the gears never cross the backlash."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.06, "run.samples": "off"})
    run = solve(scene)
    on_coast = run.passages.flank == 1
    assert on_coast.any()
    assert not (run.events.flank[run.events.kind == EventKind.ONSET] == 1).any()
    for name in ("largest_force", "smallest_force", "impacts"):
        assert not getattr(run.passages, name)[on_coast].any()
    assert run.passages.largest_force[~on_coast].max() > 0.0


def test_extremes_of_the_run_are_among_those_of_its_passages():
    run = solve(FAST)
    until = min(run.passages.time[run.passages.flank == flank][-1] for flank in (0, 1))
    assert max(run.extremes.largest_mesh_force_time, run.extremes.smallest_mesh_force_time) <= until
    assert run.passages.largest_force.max() == run.extremes.largest_mesh_force
    assert run.passages.smallest_force.min() == run.extremes.smallest_mesh_force


def test_force_at_onsets_and_separations(backend):
    """That of the only contact: the roller's force as it is sampled there."""
    scene = gd.preset("roller_slow").replace(
        {"contact.bodies": "rigid", "coating.sam_fraction": 0.0, "run.duration": 1e-5, "run.samples": 2001}
    )
    run = solve(scene, backend=backend)
    events, force = run.events, run.samples["force"]
    contact = np.isin(events.kind, (EventKind.ONSET, EventKind.SEPARATION))
    assert contact.sum() > 1
    assert np.isnan(events.force[~contact]).all()
    interpolated = np.interp(events.time[contact], run.time, force)
    # between two samples the force is no straight line
    np.testing.assert_allclose(events.force[contact], interpolated, rtol=0.0, atol=1e-4 * np.abs(force).max())


# -- in pieces -------------------------------------------------------------------------------------------------------


def test_blocks_of_few_passages_hold_the_same_table(backend, monkeypatch):
    scene = FAST if backend == "native" else FAST.replace({"run.duration": 8e-5})
    whole = np.concatenate([block.passages for block in blocks_of(scene, backend)])
    assert len(whole) > 2  # of at most two in a block
    monkeypatch.setattr(driver, "BLOCK_PASSAGES", 5)
    blocks = blocks_of(scene, backend)
    assert max(len(block.passages) for block in blocks) <= 2
    np.testing.assert_array_equal(np.concatenate([block.passages for block in blocks]), whole)


def test_a_chain_goes_on_with_its_sums():
    """Cut between two exits; forces since the last exit go on, too."""
    whole = gd.simulate(FAST)
    cut = float(whole.passage_time[2:4].mean())
    first = gd.simulate(FAST.replace({"run.duration": cut}))
    rest = gd.simulate(FAST.replace({"run.duration": FAST.run.duration - cut}), start=first)
    chain = gd.concat([first, rest], "time")
    assert chain.sizes["passage"] == whole.sizes["passage"]
    for name in ("pair", "flank", "impacts", "drive_work", "largest_force", "smallest_force"):
        # a start in between changes the steps, and chaotic impacts a little
        joined, expected = chain[f"passage_{name}"].values, whole[f"passage_{name}"].values
        np.testing.assert_allclose(joined[:4], expected[:4], rtol=1e-3)


def test_passages_begin_where_they_are_asked_for():
    """A run without them has not followed the forces: those since its start are no numbers of the next."""
    first = gd.simulate(FAST.replace({"run.passages": False}))
    rest = gd.simulate(FAST.replace({"run.samples": 20_001}), start=first)
    assert "passage" not in first.dims
    assert float(rest.passage_largest_force[0]) <= float(rest.mesh_force.max()) * 1.001
    of_flank = rest.event_flank.values == rest.passage_flank.values[0]
    onsets = rest.event_time.values[(rest.event_kind.values == EventKind.ONSET) & of_flank]
    assert int(rest.passage_impacts[0]) == int((onsets <= float(rest.passage_time[0])).sum())
