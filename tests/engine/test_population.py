"""Real asperities in the engine: reference runs, located events, forces as derivatives of the energy, checkpoints."""

from functools import cache

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import kept_at, solve
from gearidae.engine.continuing import end_of
from gearidae.engine.events.asperity_events import asperity_guard
from gearidae.engine.laws.pairs import stored_energy
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.setup.build import make_problem
from gearidae.errors import SceneError
from gearidae.records import EventKind
from gearidae.scene import preset
from reference.population import NUMBERS, Contact, Tip

GEARS = preset("teodorescu2009").replace({"contact.roughness": "discrete"})
BARE = GEARS.replace({"coating.sam_fraction": 0.0})
LISTED = {
    "arc": [a * 1e-6 for a, _, _ in NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]],
    "height": [h * 1e-9 for _, h, _ in NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]],
    "radius": [r * 1e-9 for _, _, r in NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]],
}
TEN = GEARS.replace({"contact.asperities": LISTED, "run.duration": 50e-6, "run.samples": 11})
ROLLER = preset("roller_slow").replace(
    {
        "contact.roughness": "discrete",
        "contact.asperities": {
            "x": [0.0, 0.12e-6, -0.2e-6],
            "height": [15e-9, 14e-9, 17.5e-9],
            "radius": [450e-9, 300e-9, 600e-9],
        },
        "coating.sam_fraction": 0.0,
        "roller.speed": 0.01,
        "run.duration": 1e-5,
        "run.samples": 101,
    }
)
BACKENDS = ["native", "sksundae"]
KINDS = {"join": EventKind.ASPERITY_ONSET, "off": EventKind.ASPERITY_DETACHMENT}


@cache
def run(scene, backend="native"):
    return solve(scene, backend=backend)


def asperity_events(solution):
    """Kind, pair, flank and asperity of each event of a single asperity, and its time."""
    e = solution.events
    single = e.asperity >= 0
    what = list(
        zip(*(column[single].tolist() for column in (e.kind, e.pair, e.flank, e.asperity)), strict=True)
    )
    return what, e.time[single]


# -- reference runs --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("backend", "rtol", "allowed"), [("native", 1e-11, 1e-8), ("sksundae", 1e-11, 3e-8)])
def test_a_roller_meets_three_asperities(backend, rtol, allowed):
    """Times and speeds by quadrature in 30 digits; what is allowed is a few hundred tolerances."""
    expected = NUMBERS["roller"]["bare"]
    solution = run(ROLLER.replace({"run.rtol": rtol}), backend)
    places = [2, 0, 1]  # of the reference's asperities in the order of places
    wanted = [(KINDS[event["kind"]], 0, 0, places.index(event["asperity"])) for event in expected["events"]]
    what, times = asperity_events(solution)
    assert what == [(int(kind), *rest) for kind, *rest in wanted]
    np.testing.assert_allclose(times, [event["t"] for event in expected["events"]], rtol=allowed)
    speeds = solution.events.gap_rate[solution.events.asperity >= 0]
    np.testing.assert_allclose(speeds, [event["speed"] for event in expected["events"]], rtol=allowed)
    extremes = solution.extremes
    assert extremes.final_speed == pytest.approx(expected["rebound"], rel=allowed)
    assert extremes.largest_mesh_force == pytest.approx(expected["peak_force"], rel=allowed)
    assert extremes.smallest_separation == pytest.approx(expected["h_min"], rel=1e-8)
    assert extremes.asperity_onsets == extremes.asperity_detachments == 3
    tips = [Tip(ROLLER.surface, radius) for radius in (450e-9, 300e-9, 600e-9)]
    lost = sum(tip.joining + tip.letting_go for tip in tips)
    assert solution.balance.adhesion_loss == pytest.approx(lost, rel=1e-9, abs=0)
    assert abs(solution.balance.residual) < 1e-8 * lost


@pytest.mark.parametrize(
    ("backend", "rtol", "allowed"),
    [
        ("native", 1e-10, 1e-6),
        ("sksundae", 1e-6, 1e-3),
        pytest.param("sksundae", 1e-8, 1e-5, marks=pytest.mark.by_hand),
    ],
)
def test_gears_with_ten_listed_asperities(backend, rtol, allowed):
    expected = NUMBERS["gear_explicit"]["coated"]
    solution = run(TEN.replace({"run.rtol": rtol}), backend)
    what, times = asperity_events(solution)
    assert len(what) == expected["n_events"]
    first = expected["events"]
    wanted = [(int(KINDS[e["kind"]]), e["pair"], 0, e["asperity"]) for e in first]
    assert what[: len(first)] == wanted
    np.testing.assert_allclose(times[: len(first)], [e["t"] for e in first], rtol=allowed)
    for column, name in (("gear_speed", "gear_speed"), ("transmission_error", "u")):
        np.testing.assert_allclose(solution.samples[column][1:], expected[name], rtol=allowed)
    force, most = solution.samples["mesh_force"][1:], max(expected["F"])
    # it changes by all of itself over some nanometres, a hundredth of u
    np.testing.assert_allclose(force, expected["F"], rtol=0, atol=10.0 * allowed * most)
    relief = solution.samples["gear_contact_torque"][1:] / GEARS.geometry.base_radius_gear - force
    np.testing.assert_allclose(relief, expected["Fs"], rtol=0, atol=allowed * most)
    assert solution.samples["asperities_in_contact"][1:].tolist() == expected["joined"]
    assert solution.samples["pairs_in_contact"][1:].tolist() == expected["joined"]
    balance = solution.balance
    losses = expected["join_loss"] + expected["letting_go_loss"]
    assert balance.adhesion_loss == pytest.approx(losses, rel=allowed, abs=0)
    assert balance.drive_work == pytest.approx(expected["drive_work"], rel=allowed, abs=0)
    assert balance.drag_loss + balance.dry_loss == pytest.approx(expected["drag_loss"], rel=allowed, abs=0)
    assert balance.kinetic_change == pytest.approx(expected["kinetic_change"], rel=allowed, abs=0)
    assert balance.stored_change == pytest.approx(
        expected["stored_change_from_free_surfaces"], rel=1e-4, abs=0
    )
    if backend == "native":  # the quadratures of the balance keep up with formulas of high order
        assert abs(balance.residual) < 1e-10 * balance.drive_work


def test_gears_with_a_drawn_surface():
    """With 5 % of critical damping the motion is reproducible. The balance closes to 1e-10 of the drive's work."""
    expected = NUMBERS["gear_drawn_seed0_damping_7e-6_f1"]
    scene = GEARS.replace(
        {"mesh.damping": 7e-6, "run.duration": 500e-6, "run.samples": 51, "run.rtol": 1e-10}
    )
    solution = run(scene)
    here = [round(t / 1e-5) for t in expected["time"]]
    np.testing.assert_allclose(solution.samples["gear_speed"][here], expected["gear_speed"], rtol=1e-9)
    np.testing.assert_allclose(solution.samples["transmission_error"][here], expected["u"], rtol=1e-9)
    assert len(asperity_events(solution)[0]) == expected["events"]
    balance = solution.balance
    losses = expected["join_loss"] + expected["letting_go_loss"]
    assert balance.adhesion_loss == pytest.approx(losses, rel=1e-9, abs=0)
    assert balance.damping_loss == pytest.approx(expected["damping_loss"], rel=1e-6, abs=0)
    assert abs(balance.residual) < 1e-10 * balance.drive_work


# -- events ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("changes", [{}, {"coating.sam_fraction": 0.5}, {"contact.asperity": "maugis"}])
def test_shorter_steps_find_the_same_events(changes):
    """A hundredth of the tolerance takes half again as many steps; in 20 us chaos has grown by less than tenfold."""
    scene = BARE.replace({"run.duration": 20e-6, "run.samples": "off", **changes})
    long, short = (run(scene.replace({"run.rtol": rtol})) for rtol in (1e-8, 1e-10))
    assert short.statistics.steps > 1.4 * long.statistics.steps
    (what, times), (other, later) = asperity_events(long), asperity_events(short)
    assert what == other
    assert len(what) > 20
    np.testing.assert_allclose(times, later, rtol=0, atol=1e-4 * scene.run.duration)


@pytest.mark.parametrize("asperity", ["jkr", "maugis", "dmt", "hertz"])
def test_each_asperity_joins_and_lets_go_in_turn(asperity):
    """None joins twice, or lets go without having joined; and what is in contact is what has not let go."""
    scene = BARE.replace(
        {"run.duration": 40e-6, "run.samples": 41, "contact.asperity": asperity, "coating.sam_fraction": 0.5}
    )
    solution = run(scene)
    assert solution.status == "finished"
    joined = set()
    for kind, *which in asperity_events(solution)[0]:
        assert (tuple(which) in joined) == (kind == EventKind.ASPERITY_DETACHMENT)
        joined ^= {tuple(which)}
    assert len(joined) == solution.samples["asperities_in_contact"][-1]
    onsets, detachments = solution.extremes.asperity_onsets, solution.extremes.asperity_detachments
    assert onsets - detachments == len(joined)
    assert onsets > 20
    assert abs(solution.balance.residual) < solution.balance.bound(scene.run.rtol, roller=False)
    if asperity in ("dmt", "hertz"):  # nothing but rounding of the located root
        assert abs(solution.balance.adhesion_loss) < 1e-6 * solution.balance.throughput


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("depth", [1e-15, 1e-13])
def test_an_asperity_that_is_grazed_between_two_steps_is_not_missed(backend, depth):
    """A roller turns back where its highest asperity has dipped below its guard by femtometres.

    Without adhesion and with a second asperity as a spring, the other is overlapped by `depth` for a moment that is far
    shorter than a step.
    """
    spring = ROLLER.replace(
        {"contact.asperity": "hertz", "contact.asperities": {"x": [0.0], "height": [15e-9]}, "run.rtol": 1e-9}
    )
    lowest = run(spring, "native").extremes.smallest_separation
    listed = {"x": [0.0, 1e-11], "height": [15e-9, lowest + depth], "radius": [None, 1e-10]}
    solution = run(spring.replace({"contact.asperities": listed}), backend)
    grazed = [kind for kind, _, _, asperity in asperity_events(solution)[0] if asperity == 1]
    if depth > 1e-14:  # above what the motion's tolerance leaves of the turning point
        assert grazed == [EventKind.ASPERITY_ONSET, EventKind.ASPERITY_DETACHMENT]
    else:
        assert grazed in ([], [EventKind.ASPERITY_ONSET, EventKind.ASPERITY_DETACHMENT])


def test_events_of_asperities_can_be_left_out():
    scene = BARE.replace({"run.duration": 10e-6, "run.samples": 11})
    all_of_them, without = run(scene), run(scene.replace({"run.asperity_events": False}))
    assert (without.events.asperity < 0).all()
    kept = all_of_them.events.asperity < 0
    assert np.array_equal(all_of_them.events.time[kept], without.events.time)
    assert all_of_them.extremes == without.extremes
    assert without.extremes.asperity_onsets > 0


def test_at_a_start_what_overlaps_is_joined():
    scene = TEN.replace({"initial.gap": 12e-9, "run.duration": 1e-9, "run.samples": 2})
    contact, phase = Contact(scene), scene.initial.mesh_phase * scene.geometry.base_pitch
    tips = list(zip(LISTED["arc"], LISTED["height"], strict=True))
    pitch = scene.geometry.base_pitch
    overlaps = [contact.overlap(phase + i * pitch, 12e-9, arc, z)[0] for i in (0, 1) for arc, z in tips]
    solution = run(scene)
    assert solution.samples["asperities_in_contact"][0] == sum(overlap > 0.0 for overlap in overlaps) > 0


# -- forces ----------------------------------------------------------------------------------------------------------


def _loaded(scene, gap, phase=0.3):
    """A model with asperities joined at a state, and that state."""
    problem = make_problem(scene.replace({"initial.gap": gap, "initial.mesh_phase": phase}))
    return problem.model, problem.start


@pytest.mark.parametrize("phase", [0.3, 0.66, 0.69, 0.95])
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("changes", [{}, {"coating.sam_fraction": 0.5, "coating.thickness": 2e-9}])
def test_forces_are_derivatives_of_the_energy_and_slopes_those_of_the_forces(phase, flank, changes):
    """Central differences over 1e-5: their own error is some 1e-9 of the loads; phases on and beyond the path."""
    scene = BARE.replace(changes)
    gap = 9e-9 if flank == "drive" else scene.mesh.backlash - 9e-9
    m, y = _loaded(scene, gap, phase)
    y[1], y[3] = 0.3, 10.0
    step = {0: 1e-5, 2: 1e-6}

    def forces(place, change):
        moved = y.copy()
        moved[place] += change
        return np.array([stored_energy(m, moved)[0], *mesh_forces(m, 0.0, moved, False)])

    force, relief, force_u, force_phase, relief_u, relief_phase, *_ = mesh_forces(m, 0.0, y, False)
    slopes = {}
    for place, h in step.items():
        slopes[place] = (forces(place, h) - forces(place, -h)) / (2.0 * h)
    loads = abs(force) + 1e-3
    assert -slopes[0][0] == pytest.approx(-force, rel=1e-6, abs=1e-6 * loads)
    # the phase turns with the gear's surface: dU/dphase = -Fs / phase_rate
    assert -slopes[2][0] * m.scene.phase_rate == pytest.approx(relief, rel=1e-5, abs=1e-6 * loads)
    assert slopes[0][1] == pytest.approx(force_u, rel=1e-5, abs=1e-6 * loads)
    assert slopes[2][1] == pytest.approx(force_phase, rel=1e-4, abs=1e-5 * loads / m.scene.phase_rate)
    assert slopes[0][2] == pytest.approx(relief_u, rel=1e-4, abs=1e-6 * loads)
    assert slopes[2][2] == pytest.approx(relief_phase, rel=1e-4, abs=1e-4 * loads)
    assert abs(force) > 1.0  # of the reference load: asperities are joined


def test_forces_are_those_of_the_plain_equations():
    gap, phase = 11e-9, 0.3
    m, y = _loaded(TEN, gap, phase)
    force, relief, *_ = mesh_forces(m, 0.0, y, False)
    contact, pitch = Contact(TEN), TEN.geometry.base_pitch
    load = along = 0.0
    for i in (0, -1):
        xi = (phase - i) * pitch
        at = contact.at(xi)
        for arc, height, radius in zip(*LISTED.values(), strict=True):
            tip = Tip(TEN.coated_surface, radius)
            overlap, d = contact.overlap(xi, gap, arc, height)
            if overlap > 0.0:
                load += tip.load(overlap)
                along += tip.load(overlap) * (at["slope"] - d)
    assert force * m.scene.force_unit == pytest.approx(load, rel=1e-9, abs=0)
    assert relief * m.scene.force_unit == pytest.approx(along, rel=1e-9, abs=0)


def test_a_roller_s_force_is_the_derivative_of_its_energy():
    m = make_problem(ROLLER.replace({"roller.height": 10e-9})).model
    y, h, along = np.array([-10.0 / 6.0, 0.0, 0.0, 0.0]), 1e-5, np.eye(4)[0]
    energies = [stored_energy(m, y + change * along)[0] for change in (-h, h)]
    force, _, slope, *_ = mesh_forces(m, 0.0, y, False)  # in u, the negative height
    assert force == pytest.approx((energies[1] - energies[0]) / (2.0 * h), rel=1e-7)
    forces = [mesh_forces(m, 0.0, y + change * along, False).force for change in (-h, h)]
    assert slope == pytest.approx((forces[1] - forces[0]) / (2.0 * h), rel=1e-7)


# -- checkpoints and continued runs -----------------------------------------------------------------------------------

STOPPED = BARE.replace({"run.duration": 1e-5, "run.samples": 2, "run.rtol": 1e-7})


@cache
def end_of_a_run():
    """Checkpoint of a run that ends with joined asperities."""
    return run(STOPPED).checkpoint


def _asperities_begin(checkpoint):
    return checkpoint.size - 64


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda c, k: c.__setitem__(k, c[k] + 1.0), "asperities_sha256"),
        (lambda c, k: c.__setitem__(k + 4, c[k + 4] + 1.0), "indices of asperities in order"),
        (lambda c, k: c.__setitem__(k + 4, 1e300), "a number of them"),
        (lambda c, k: c.__setitem__(k + 4 + int(c[k + 4]), 110_000.0), "those of pairs that are near"),
    ],
)
def test_joined_asperities_that_no_run_has_left_are_refused(change, expected):
    checkpoint = end_of_a_run().copy()
    first = _asperities_begin(checkpoint)
    assert checkpoint[first + 4] > 0.0
    change(checkpoint, first)
    with pytest.raises(SceneError) as refused:
        kept_at(STOPPED, checkpoint)
    assert expected in str(refused.value)


def test_a_block_of_another_length_is_refused():
    checkpoint = end_of_a_run()
    for size in (checkpoint.size - 64, checkpoint.size + 64, checkpoint.size - 1):
        with pytest.raises(SceneError, match="checkpoint"):
            kept_at(STOPPED, np.resize(checkpoint, size))


def test_a_run_goes_on_with_another_coating_and_torque():
    """Nothing but settings: as if it had not ended, to what chaos leaves. Another coating: its energy is booked."""
    first = BARE.replace({"run.duration": 10e-6, "run.samples": 11, "run.rtol": 1e-9})
    end = run(first)
    begin = end_of(first, end.checkpoint, 0.0)
    whole = run(first.replace({"run.duration": 15e-6, "run.samples": 16}))
    more = {"run.duration": 5e-6, "run.samples": 6}
    same = solve(first.replace(more), start=begin)
    np.testing.assert_allclose(same.samples["gear_speed"], whole.samples["gear_speed"][10:], rtol=1e-5)
    assert same.balance.model_change == 0.0
    before = end.samples["asperities_in_contact"][-1]
    for changes in ({"coating.sam_fraction": 1.0}, {"coating.sam_fraction": 0.5}, {"drive.torque": 2e-11}):
        other = solve(first.replace(more | changes), start=begin)
        assert other.status == "finished"
        if changes.get("coating.sam_fraction") != 0.5:  # a half may leave all that are joined bare
            assert (other.balance.model_change != 0.0) == ("coating.sam_fraction" in changes)
        assert abs(other.balance.residual) < 1e-6 * other.balance.drive_work
        assert other.samples["asperities_in_contact"][0] <= before
    with pytest.raises(SceneError, match=r"contact\.seed"):
        solve(first.replace(more | {"contact.seed": 1}), start=begin)


def test_the_guard_of_a_fresh_model_is_positive():
    m, y = _loaded(BARE, 9e-9)
    assert asperity_guard(m, y) > 0.0


def test_more_laws_than_can_be_tabulated_are_refused():
    scene = GEARS.replace({"contact.asperity": "maugis", "contact.radius_spread": 0.1})
    with pytest.raises(SceneError, match=r"contact\.asperity = maugis: has another law for each radius"):
        make_problem(scene)
    make_problem(GEARS.replace({"contact.radius_spread": 0.1}))


def test_the_dataset_names_the_asperities(tmp_path):
    scene = BARE.replace({"run.duration": 10e-6, "run.samples": 11})
    ds = gd.simulate(scene)
    assert ds.attrs["asperities_sha256"] == gd.population(scene).attrs["asperities_sha256"]
    single = ds.event_asperity.values >= 0
    assert single.sum() == int(ds.asperity_onsets + ds.asperity_detachments) > 10
    kinds = ds.event_kind.values[single]
    assert set(kinds.tolist()) == {int(EventKind.ASPERITY_ONSET), int(EventKind.ASPERITY_DETACHMENT)}
    assert np.array_equal(ds.event_tooth.values[single], ds.event_pair.values[single] % 19)
    file = tmp_path / "run.nc"
    gd.simulate(scene, archive=file)
    kept = gd.open_archive(file)
    for name in ("event_tooth", "event_asperity", "event_time", "asperities_in_contact", "asperity_onsets"):
        assert np.array_equal(kept[name].values, ds[name].values)
    assert {"tooth", "asperity"} <= set(kept.gearidae.events().columns)
    plain = gd.simulate(preset("teodorescu2009").replace({"run.duration": 1e-6, "run.samples": 3}))
    assert not {"event_tooth", "asperity_onsets", "asperities_in_contact"} & set(plain.variables)
