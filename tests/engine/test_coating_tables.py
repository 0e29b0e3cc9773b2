"""Fractions by tooth and place: which tooth and place the engine takes, limits, energy, an independent integrator."""

import math

import numpy as np
import pytest

import gearidae as gd
from balances import assert_closes
from gearidae.engine import solve
from gearidae.engine.laws.pairs import joining_losses
from gearidae.engine.pairs.coverage import loading_of, potential_of, potentials_of, share_changes, shares_of
from gearidae.engine.pairs.lengths import weighed_length
from gearidae.engine.setup.build import make_problem
from gearidae.scene.coating import interface_shares
from gearidae.scene.coating_table import fraction_at, met_teeth
from reference.gears import SlowGears

LOW = gd.preset("teodorescu2009_low_speed").replace({"contact.bodies": "rigid", "run.samples": "off"})
SHORT = LOW.replace({"initial.mesh_phase": 0.6, "run.duration": "15 ms", "run.samples": 31})
RANDOM = np.random.default_rng(7)
PINION, GEAR = RANDOM.uniform(0.2, 0.8, (19, 5)), RANDOM.uniform(0.1, 0.9, (76, 3))


def sides(scene, pinion, gear, **more):
    keys = {"pairing": "independent", "pinion_table": pinion, "gear_table": gear, **more}
    return scene.replace({f"coating.{key}": value for key, value in keys.items()})


# -- tooth and place -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("coast", [0, 1])
def test_the_engine_reads_the_tooth_and_place_of_a_pair(coast):
    """Shares of pairs far from the start, with pitches taken out of the phase, against the readable table."""
    m = make_problem(sides(SHORT, PINION, GEAR)).model
    ratio = SHORT.geometry.contact_ratio
    for turns, pair, place in [(0, 0, 0.0), (5, 3, 0.31), (1900, -2, 0.5), (77, -40, 0.73), (10**9, 7, 1.0)]:
        m.state.whole_pitches = turns
        teeth = met_teeth(turns + pair, coast=bool(coast))
        fractions = [
            fraction_at(table, tooth, place) for table, tooth in zip((PINION, GEAR), teeth, strict=True)
        ]
        expected = interface_shares("independent", *fractions)
        ours = shares_of(m, coast, pair, place * ratio)
        assert ours == pytest.approx(
            [expected[name].item() for name in ("bare", "coated", "mixed")], abs=1e-13
        )


def test_the_gears_tooth_of_the_coast_flank_is_the_one_behind():
    """By geometry: at the pitch point, tooth spaces and teeth of the gear pass in the order of their numbers."""
    geometry = LOW.geometry
    at_pitch_point = geometry.approach / geometry.base_pitch
    coast_phase = 2.0 * at_pitch_point + 0.5
    # the back of the pinion's tooth 0 passes half a pitch after its front, and meets the front of the gear's tooth
    # whose own back is pushed half a pitch later still: by the pinion's tooth 1
    passes = {
        "drive 0": at_pitch_point,
        "coast 0": coast_phase - at_pitch_point,
        "drive 1": 1 + at_pitch_point,
    }
    assert passes["coast 0"] == pytest.approx(0.5 * (passes["drive 0"] + passes["drive 1"]))
    assert [int(tooth) for tooth in met_teeth(0, coast=True)] == [0, 1]


def test_shares_are_smooth_and_their_derivatives_true():
    m = make_problem(sides(SHORT, PINION, GEAR)).model
    step = 1e-5
    for inside in np.linspace(0.01, SHORT.geometry.contact_ratio - 0.01, 57):
        low, here, high = (np.array(shares_of(m, 0, 4, inside + by * step)) for by in (-1, 0, 1))
        value, slope, bend = (np.array(row) for row in share_changes(m, 0, 4, inside))
        np.testing.assert_allclose(value, here, atol=1e-15)
        # differences of second order: the third and fourth derivatives times step^2, and rounding over step
        np.testing.assert_allclose((high - low) / (2 * step), slope, atol=1e-6)
        np.testing.assert_allclose((high - 2 * here + low) / step**2, bend, atol=1e-3)
        assert here.sum() == pytest.approx(1.0, abs=1e-14)
        assert here.min() >= 0.0


@pytest.mark.parametrize("tables", [True, False])
@pytest.mark.parametrize(
    "values", [*np.eye(3).tolist(), [0.3, -0.7, 2.0]], ids=["bare", "coated", "mixed", "all"]
)
def test_weighed_lengths_change_as_said(tables, values):
    """Rates of length times share against differences along the motion, on both flanks; shares may never change."""
    m = make_problem(sides(SHORT, PINION, GEAR) if tables else SHORT).model
    w, w_rate, dt, values = 3.0, 0.7, 1e-3, tuple(values)
    travel = [m.scene.phase_rate * (w * t + 0.5 * w_rate * t * t) for t in (-dt, 0.0, dt)]
    for coast, pair, phase in [(0, 0, 0.4), (0, -1, 0.1), (1, 0, 1.9)]:
        near = [weighed_length(m, (coast, pair, phase + by), w, w_rate, values, values) for by in travel]
        low, here, high = (lengths[0] for lengths in near)
        _, rate, bend, by_gap = near[1]
        np.testing.assert_allclose((high - low) / (2 * dt), rate, rtol=1e-5, atol=1e-12)
        np.testing.assert_allclose((high - 2 * here + low) / dt**2, bend, rtol=1e-3, atol=1e-7)
        assert by_gap == pytest.approx(rate, rel=1e-13, abs=0)


@pytest.mark.parametrize("gap", [-3.3, 0.4, 5.9, 40.0])
def test_branches_are_mixed_by_their_shares(gap):
    """Those of one material alone with its share, and slopes by differences."""
    m = make_problem(sides(SHORT, PINION, GEAR, thickness="2 nm")).model
    shares = (0.2, 0.5, 0.3)
    alone = [loading_of(m, gap, tuple(unit_shares)) for unit_shares in np.eye(3).tolist()]
    np.testing.assert_allclose(loading_of(m, gap, shares), shares @ np.array(alone), rtol=1e-12, atol=1e-15)
    potentials, slopes = potentials_of(m, gap)
    assert potential_of(m, gap, shares) == pytest.approx(np.dot(shares, potentials), rel=1e-12, abs=1e-15)
    np.testing.assert_allclose(np.negative(slopes), [force for force, _ in alone], rtol=1e-8, atol=1e-12)


# -- limits ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("pairing", ["patches", "independent"])
def test_a_table_of_one_fraction_is_that_fraction(pairing):
    """Same numbers, summed in another order: to the tolerance, amplified over the oscillations of the contact."""
    uniform = SHORT.replace({"coating.sam_fraction": 0.6, "coating.pairing": pairing, "run.rtol": 1e-9})
    tables = {"coating.pinion_table": np.full((19, 4), 0.6)}
    if pairing == "independent":
        tables["coating.gear_table"] = [[0.6]]
    single, table = solve(uniform), solve(uniform.replace(tables))
    swing = np.ptp(single.samples["gear_speed"])
    np.testing.assert_allclose(table.samples["gear_speed"], single.samples["gear_speed"], atol=1e-5 * swing)
    assert table.balance.adhesion_loss == pytest.approx(single.balance.adhesion_loss, rel=1e-5, abs=0)
    taken, expected = (
        solution.balance.adhesion_loss - solution.balance.radius_work for solution in (table, single)
    )
    assert taken == pytest.approx(expected, rel=1e-6, abs=0)


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
def test_impacts_lose_the_same_with_a_table(rtol):
    """Both motions differ by some tens of tolerances; the work of the changing radius is a tenth of the loss."""
    uniform = gd.preset("teodorescu2009").replace(
        {"coating.sam_fraction": 0.6, "run.rtol": rtol, "run.duration": "0.1 ms", "run.samples": "off"}
    )
    single, table = solve(uniform), solve(uniform.replace({"coating.pinion_table": np.full((19, 4), 0.6)}))
    error = 1000.0 * rtol
    assert table.balance.adhesion_loss == pytest.approx(single.balance.adhesion_loss, rel=error, abs=0)
    assert table.balance.radius_work == pytest.approx(single.balance.radius_work, rel=10.0 * error, abs=0)


def test_only_the_teeth_that_meet_count():
    """During 15 ms pairs 0 and -1 come near: fractions of other teeth change nothing, theirs do."""
    base = sides(SHORT, PINION, GEAR)
    far, near = PINION.copy(), PINION.copy()
    far[5:15], near[0] = 0.0, 0.0
    expected = solve(base).samples["gear_speed"]
    np.testing.assert_array_equal(solve(sides(SHORT, far, GEAR)).samples["gear_speed"], expected)
    assert np.abs(solve(sides(SHORT, near, GEAR)).samples["gear_speed"] - expected).max() > 1e-6


# -- energy ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "backend"),
    [
        ({"run.duration": "0.1 s"}, "auto"),
        ({"contact.asperity": "hertz"}, "auto"),
        ({"mesh.backlash": "60 nm", "initial.gap": "25 nm", "run.duration": "10 ms"}, "auto"),
    ],
)
def test_energy_closes(changes, backend):
    scene = sides(SHORT, PINION, GEAR, thickness="1 nm").replace(changes)
    assert_closes(scene, solve(scene, backend=backend))


def test_the_work_of_changing_shares_is_the_sum_of_what_they_store():
    """A steep table without a change of radius to speak of: the radius work is that of the shares, and the sum closes.

    Left out, the residual would be the work itself, a hundred times the bound.
    """
    steep = np.tile([1.0, 0.2, 1.0, 0.2], (19, 1))
    scene = SHORT.replace({"coating.pinion_table": steep, "run.duration": "0.1 s", "run.rtol": 1e-8})
    balance = assert_closes(scene, solve(scene))
    assert abs(balance.radius_work) > 100 * balance.bound(scene.run.rtol, roller=False)


def test_losses_of_the_materials_add_up():
    problem = make_problem(sides(SHORT, PINION, GEAR))
    m, k = problem.model, 0
    m.state.history[k].joined[:] = 6.0
    losses, slopes = joining_losses(m, k, problem.start, 4.0)
    near, _ = joining_losses(m, k, problem.start, 4.0 - 1e-5)
    for material in range(3):
        assert losses[material] > 0.0
        assert (losses[material] - near[material]) / 1e-5 == pytest.approx(slopes[material], rel=1e-4)


# -- independent integrator ------------------------------------------------------------------------------------------


def test_motion_is_the_twins():
    """DOP853 with the readable law and the readable table, two pairs, history and a gap offset."""
    scene = sides(SHORT, PINION, GEAR, thickness="1 nm").replace(
        {
            "initial.mesh_phase": 0.8,
            "initial.gap": 5.5 * 6e-9,
            "run.duration": 1e-3,
            "run.samples": 21,
            "run.rtol": 1e-10,
        }
    )
    ours, twin = solve(scene), SlowGears(scene).run(np.linspace(0.0, 1e-3, 21))
    assert np.count_nonzero(ours.events.kind == 2) >= 2  # the history has been used
    # as in `test_twin`: tolerance of both and the growth of errors over the cycles
    np.testing.assert_allclose(ours.samples["transmission_error"], twin[0], atol=2e-7 * 6e-9)
    np.testing.assert_allclose(ours.samples["gear_speed"], twin[3], atol=1e-6 * np.ptp(twin[3]))


# -- cut and continued -----------------------------------------------------------------------------------------------


def test_a_run_goes_on_with_worn_teeth():
    """The same table goes on as the whole run; another one is booked as a change of the model."""
    whole = sides(SHORT, PINION, GEAR)
    first = gd.simulate(whole.replace({"run.duration": "6 ms"}))
    rest = gd.simulate(whole.replace({"run.duration": "9 ms"}), start=first)
    expected = gd.simulate(whole.replace({"run.checkpoints": ["6 ms"]}))
    assert rest.gear_speed[-1].item() == pytest.approx(expected.gear_speed[-1].item(), rel=1e-12)
    worn = gd.simulate(sides(SHORT, 0.7 * PINION, GEAR).replace({"run.duration": "9 ms"}), start=first)
    balance = worn.gearidae.energy_balance
    assert balance["model_change"] != 0.0
    assert abs(balance["residual"]) <= balance["residual_bound"]
    assert math.isfinite(float(worn.min_gear_speed))
