"""The table of impacts: force, impulse and loss of each contact of a pair, from its onset to its separation."""

from functools import partial

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import native, portable, solve
from gearidae.engine.backend import run_blocks
from gearidae.engine.integrate import driver
from gearidae.engine.observers.impacts import IMPACTS_AT_ONCE
from gearidae.engine.setup.build import make_problem
from gearidae.records import EventKind, Impacts, Statistics

RATTLE = gd.load_case("cases/alternating.toml").replace(
    {
        "contact.bodies": "rigid",
        "initial.mesh_phase": 0.9,  # one pair alone on the path of contact: the mesh force is its own
        "run.duration": 3.6e-6,
        "run.samples": "off",
        "run.rtol": 1e-7,
        "run.impacts": True,
    }
)
"""Two impacts with flight before, between and behind them."""
FRICTION = {"contact.friction": 0.1, "contact.friction_law": "coulomb", "run.duration": 3.5e-6}
DISCRETE = {"contact.roughness": "discrete", "run.duration": 2e-6}
LAWS = {
    "adhesion": {},
    "a film of gas": {"mesh.film_damping": 1e-7, "mesh.film_gap": 2e-8},
    "the changing radius": {"mesh.radius_force": True},
    "elastic bodies": {"contact.bodies": "elastic"},
    "discrete asperities": DISCRETE,
}
TURNING = RATTLE.replace({"initial.mesh_phase": 0.3, "run.duration": 1.2e-4, "run.rtol": 1e-6})
"""Through several passages."""
near = partial(pytest.approx, abs=0.0)


@pytest.fixture(params=["native", "sksundae"])
def backend(request):
    return request.param


def tables_equal(a, b):
    np.testing.assert_array_equal(a.table(), b.table())


def contacts(events):
    """Onsets and separations of each contact: (pair, flank, begin, end)."""
    begun, found = {}, []
    for time, kind, pair, flank in zip(events.time, events.kind, events.pair, events.flank, strict=True):
        if kind == EventKind.ONSET:
            begun[pair, flank] = time
        elif kind == EventKind.SEPARATION:
            found.append((pair, flank, begun.pop((pair, flank)), time))
    return found


# -- rows ------------------------------------------------------------------------------------------------------------


def test_a_row_for_each_contact(backend):
    run = solve(TURNING if backend == "native" else TURNING.replace({"run.duration": 5e-6}), backend=backend)
    rows, wanted = run.impacts, contacts(run.events)
    assert len(rows) == len(wanted) >= 4
    found = [*zip(rows.pair, rows.flank, rows.begin, rows.time, strict=True)]
    np.testing.assert_allclose(found, wanted, rtol=1e-14)
    np.testing.assert_allclose(rows.duration, rows.time - rows.begin, rtol=1e-9)
    onsets = {
        (time, pair): -rate
        for time, kind, pair, rate in zip(
            run.events.time, run.events.kind, run.events.pair, run.events.gap_rate, strict=True
        )
        if kind == EventKind.ONSET
    }
    wanted_speeds = [onsets[key] for key in zip(rows.begin, rows.pair, strict=True)]
    np.testing.assert_allclose(rows.approach_speed, wanted_speeds, rtol=1e-12)
    assert (rows.approach_speed > 0.0).all()
    assert (rows.largest_force >= rows.smallest_force).all()
    assert ((rows.begin <= rows.largest_force_time) & (rows.largest_force_time <= rows.time)).all()


@pytest.mark.parametrize("law", LAWS)
def test_against_integrals_of_a_densely_sampled_run(law, backend):
    """With one pair alone, the mesh force and the gap give each number, by the trapezoidal rule over 85 ps.

    Steps of the portable driver are shorter. What the force along the path takes does not show in the gap, and every
    join and detachment of an asperity is a jump of the force, which a sample misses by up to its interval. Where the
    samples lie on a contact depends on how the processor rounds: they miss up to 2e-5.
    """
    samples = 40_001 if backend == "native" else 10_001
    run = solve(RATTLE.replace(LAWS[law]), backend=backend, samples=samples)
    rows, time = run.impacts, run.time
    force, gap = run.samples["mesh_force"], run.samples["drive_gap"]
    discrete = law == "discrete asperities"
    accuracy = 2e-3 if discrete else 5e-5 if backend == "native" else 1e-4
    assert len(rows) == (1 if discrete else 2)
    for i in range(len(rows)):
        inside = time[(time > rows.begin[i]) & (time < rows.time[i])]
        at = np.concatenate([[rows.begin[i]], inside, [rows.time[i]]])
        pushed, moved = np.interp(at, time, force), np.interp(at, time, gap)
        assert rows.impulse[i] == near(np.trapezoid(pushed, at), rel=accuracy)
        assert rows.largest_force[i] == near(pushed.max(), rel=1e-4)
        assert rows.smallest_force[i] == near(pushed.min(), rel=1e-3)
        assert rows.largest_force_time[i] == pytest.approx(at[pushed.argmax()], abs=2e-3 * rows.duration[i])
        if not discrete and law != "the changing radius":
            assert rows.energy_lost[i] == near(-np.trapezoid(pushed, moved), rel=accuracy)


@pytest.mark.parametrize("law", [*LAWS, "friction", "friction of discrete asperities"])
def test_impulses_and_losses_add_up_to_momentum_and_energy(law):
    """Through flight at both ends: momentum of the pinion, energy balance of the run.

    Of the mean law flanks pull a little beyond the gap at which they are in contact: 5e-5 of the impulse, 2e-5 of the
    loss by friction, 2e-3 of the loss where a film is there, too. Asperities one by one do not.
    """
    changes = {**LAWS, "friction": FRICTION, "friction of discrete asperities": FRICTION | DISCRETE}[law]
    scene = RATTLE.replace(changes)
    run, rubs = solve(scene, samples=2), "friction" in law
    rows, balance, pinion = run.impacts, run.balance, run.samples["pinion_speed"]
    discrete = scene.contact.is_discrete
    assert len(rows) == len(contacts(run.events))
    assert run.events.kind[run.events.flank >= 0][-1] != EventKind.ONSET
    if not rubs:  # which acts on the pinion, too
        radius = scene.geometry.base_radius_pinion
        momentum = scene.gears.pinion_inertia * (pinion[-1] - pinion[0]) / radius
        driven = run.samples["drive_torque"][0] * run.time[-1] / radius
        impulses = np.where(rows.flank == 0, rows.impulse, -rows.impulse).sum()
        assert impulses == near(driven - momentum, rel=1e-5 if discrete else 1e-4)
    friction = balance.drive_friction_loss + balance.coast_friction_loss
    taken = balance.adhesion_loss + balance.film_loss + friction + balance.stored_change - balance.radius_work
    assert rows.energy_lost.sum() == near(taken, rel=1e-5 if discrete else 3e-3)
    assert rows.friction_loss.sum() == near(friction, rel=1e-12 if discrete else 1e-4)
    assert (friction > 0.0) == rubs


def test_both_drivers_agree():
    a, b = (solve(TURNING, backend=name, rtol=1e-8, t_end=5e-6).impacts for name in ("native", "sksundae"))
    assert len(a) == len(b) >= 4
    for name in Impacts.columns:
        first, second = getattr(a, name), getattr(b, name)
        # a thousand tolerances over the largest of the numbers; the loss is what is left of ten times as much work
        np.testing.assert_allclose(first, second, rtol=0.0, atol=1e-4 * np.abs(first).max(), err_msg=name)


def test_a_roller_has_impacts(backend):
    roller = gd.preset("roller_slow").replace(
        {"contact.bodies": "rigid", "run.impacts": True, "run.samples": 20_001}
    )
    run = solve(roller, backend=backend)
    (impact,) = run.impacts.table()
    row = dict(zip(Impacts.columns, impact, strict=True))
    inside = (run.time >= row["begin"]) & (run.time <= row["time"])
    force = run.samples["force"][inside]
    assert row["impulse"] == near(np.trapezoid(force, run.time[inside]), rel=1e-4)
    assert row["largest_force"] == near(force.max(), rel=1e-4)
    # the momentum of the roller: nothing but its contact acts on it
    change = roller.roller.mass * (run.samples["speed"][-1] - run.samples["speed"][0])
    assert row["impulse"] == near(change, rel=1e-3)


# -- what it does not depend on --------------------------------------------------------------------------------------


def test_sampling_and_blocks_do_not_matter(backend, monkeypatch):
    scene = RATTLE.replace({"run.rtol": 1e-5})
    wanted = solve(scene, backend=backend)
    sampled = solve(scene, samples=3001, backend=backend)
    tables_equal(sampled.impacts, wanted.impacts)
    monkeypatch.setattr(driver, "BLOCK_IMPACTS", 2 * IMPACTS_AT_ONCE)
    monkeypatch.setattr(native, "FIRST_STEPS", 1)
    monkeypatch.setattr(native, "BLOCK_STEPS", 1)
    monkeypatch.setattr(portable, "BLOCK_SECONDS", 0.0)
    tables_equal(solve(scene, backend=backend).impacts, wanted.impacts)


def test_without_impacts_the_run_is_the_same(backend):
    with_table, without = (
        solve(RATTLE.replace({"run.impacts": on}), backend=backend) for on in (True, False)
    )
    assert len(with_table.impacts) > 0
    assert len(without.impacts) == 0
    assert with_table.statistics.steps == without.statistics.steps
    assert dict(with_table.balance) == dict(without.balance)
    np.testing.assert_array_equal(with_table.events.table(), without.events.table())


def test_without_a_balance_the_loss_by_friction_is_not_known():
    rows = solve(RATTLE.replace(FRICTION | {"run.balance": False})).impacts
    assert np.isnan(rows.friction_loss).all()
    assert np.isnan(rows.energy_lost).all()
    assert (rows.impulse > 0.0).all()
    assert (solve(RATTLE.replace({"run.balance": False})).impacts.energy_lost > 0.0).all()


# -- runs that go on -------------------------------------------------------------------------------------------------


def middle_of_an_impact(run):
    return float(run.impacts.begin[-1] + 0.4 * run.impacts.duration[-1])


def test_a_run_that_goes_on_keeps_the_contact_that_it_began(backend):
    scene = RATTLE.replace({"run.rtol": 1e-8})
    whole = solve(scene, backend=backend)
    cut = middle_of_an_impact(whole)
    first = gd.simulate(scene, t_end=cut, backend=backend)
    rest = gd.simulate(scene, t_end=3.6e-6, start=first, backend=backend)
    table = gd.concat([first, rest], dim="time").gearidae.impacts()
    assert len(first.gearidae.impacts()) + len(rest.gearidae.impacts()) == len(table) == len(whole.impacts)
    assert rest.gearidae.impacts().begin[0] < cut
    for name in Impacts.columns:
        if name != "flank":
            # a run that begins anew within a contact is another to some hundred tolerances, and has other steps, so
            # that the cubic at the sharp end of the pull is another
            accuracy = 1e-3 if name == "smallest_force" else 1e-5
            np.testing.assert_allclose(table[name], getattr(whole.impacts, name), rtol=accuracy, atol=0.0)


def test_a_contact_that_a_run_meets_begins_with_it():
    scene = RATTLE.replace({"run.rtol": 1e-8})
    cut = middle_of_an_impact(solve(scene))
    first = gd.simulate(scene.replace({"run.impacts": False}), t_end=cut)
    with pytest.raises(gd.SceneError, match=r"run.impacts = true"):
        first.gearidae.impacts()
    row = gd.simulate(scene, t_end=3.6e-6, start=first).gearidae.impacts().iloc[0]
    assert row["begin"] == near(cut, rel=1e-12)
    assert np.isnan(row["approach_speed"])
    assert row["impulse"] > 0.0


def test_a_resumed_run_has_the_same_rows(monkeypatch):
    """From a checkpoint within a contact, to the last bit."""
    monkeypatch.setattr(portable, "CHECKPOINT_STEPS", 9)
    scene = RATTLE.replace({"run.rtol": 1e-5})

    def blocks_from(checkpoint=None):
        return list(run_blocks(make_problem(scene), 1e-5, 0, "sksundae", Statistics(), checkpoint))

    def table(blocks):
        return np.concatenate([block.impacts for block in blocks])

    whole = blocks_from()
    rows = Impacts.of_table(table(whole))
    inside = [
        place
        for place, block in enumerate(whole)
        if block.checkpoint is not None and rows.begin[-1] < block.time < rows.time[-1]
    ]
    assert len(inside) > 2
    for place in (inside[0], inside[len(inside) // 2]):
        resumed = [*whole[: place + 1], *blocks_from(whole[place].checkpoint)]
        np.testing.assert_array_equal(table(resumed), rows.table())


# -- archives, tables and pictures -----------------------------------------------------------------------------------


def test_archives_and_sweeps_keep_them(tmp_path):
    path = tmp_path / "run.nc"
    run = gd.simulate(RATTLE, samples=11, archive=path)
    again = gd.open_archive(path)
    for name in ("begin", "duration", "largest_force", "impulse", "energy_lost", "approach_speed"):
        np.testing.assert_array_equal(again[f"tooth_impact_{name}"], run[f"tooth_impact_{name}"])
    sweep = gd.sweep(RATTLE, {"coating.sam_fraction": [0.6, 1.0]}, keep=["impacts"])
    table = sweep.gearidae.impacts()
    assert set(table["sam_fraction"]) == {0.6, 1.0}
    alone = sweep.gearidae.run(sam_fraction=0.6).gearidae.impacts()
    np.testing.assert_array_equal(alone["impulse"], run.gearidae.impacts()["impulse"])
    assert table["flank"].dtype == "category"


def test_two_runs_are_compared_by_their_impacts():
    run, other = (gd.simulate(RATTLE.replace({"run.rtol": rtol}), samples=11) for rtol in (1e-8, 1e-7))
    table = gd.compare(run, other)
    assert 0.0 < table.loc["tooth_impact_impulse", "relative"] < 1e-3
    fewer = gd.simulate(RATTLE, samples=11, t_end=2e-6)
    assert np.isinf(gd.compare(fewer.isel(time=[0]), run.isel(time=[0])).loc["impacts", "relative"])


def test_a_histogram_of_forces():
    run = gd.simulate(TURNING)
    ax = gd.plot.impact_forces(run)
    heights = sum(patch.get_height() for patch in ax.patches)
    assert heights == len(run.gearidae.impacts()) > 3
    assert ax.get_xlabel() == "largest force of an impact (µN)"
    sweep = gd.sweep(RATTLE, {"coating.sam_fraction": [0.6, 1.0]})
    curves, counts = (
        gd.plot.impact_forces(sweep).patches,
        sweep.gearidae.impacts()["sam_fraction"].value_counts(),
    )
    assert [curve.get_data().values.sum() for curve in curves] == [counts[0.6], counts[1.0]]
    with pytest.raises(gd.SceneError, match=r"run.impacts = false: must be true"):
        gd.plot.impact_forces(gd.simulate(RATTLE.replace({"run.impacts": False}), t_end=1e-7))
