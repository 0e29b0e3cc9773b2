"""Fractions by tooth and place between elastic bodies: limits, both drivers, energy, and its slope along the path."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.laws.pairs import radius_power, stored_energy
from gearidae.engine.model.state import PHASE, V, W
from gearidae.engine.motion.static_solve import settle_nodes
from gearidae.engine.setup.build import make_problem

SHORT = gd.preset("teodorescu2009_low_speed").replace(
    {
        "contact.bodies": "elastic",
        "initial.mesh_phase": 0.6,
        "run.duration": "3 ms",
        "run.samples": 31,
        "run.rtol": 1e-8,
    }
)
RANDOM = np.random.default_rng(7)
PINION, GEAR = RANDOM.uniform(0.2, 0.8, (19, 5)), RANDOM.uniform(0.1, 0.9, (76, 3))


def sides(scene, pinion, gear, **more):
    keys = {"pairing": "independent", "pinion_table": pinion, "gear_table": gear, **more}
    return scene.replace({f"coating.{key}": value for key, value in keys.items()})


@pytest.mark.parametrize("method", ["auto", "bdf"])
def test_a_table_of_one_fraction_is_that_fraction(method):
    """Same numbers, summed in another order: to the tolerance, amplified over the oscillations of the contact."""
    changes = {"coating.sam_fraction": 0.6, "coating.pairing": "independent", "run.method": method}
    duration = "3 ms" if method == "auto" else "0.4 ms"
    uniform = SHORT.replace(
        {**changes, "run.duration": duration, "run.rtol": 1e-8 if method == "auto" else 1e-10}
    )
    tables = {"coating.pinion_table": np.full((19, 4), 0.6), "coating.gear_table": [[0.6]]}
    single, table = solve(uniform), solve(uniform.replace(tables))
    swing = np.ptp(single.samples["gear_speed"])
    np.testing.assert_allclose(table.samples["gear_speed"], single.samples["gear_speed"], atol=1e-5 * swing)
    taken, expected = (
        solution.balance.adhesion_loss - solution.balance.radius_work for solution in (table, single)
    )
    # Adams' steps are longer: there the errors of both balances' quadratures, by their own estimates
    errors = single.balance.quadrature_error + table.balance.quadrature_error
    allowed = errors if method == "auto" else 1e-6 * expected
    assert taken == pytest.approx(expected, rel=0, abs=allowed)
    assert allowed < 1e-4 * expected


@pytest.mark.parametrize("phase", [0.9, 0.5])
def test_power_of_the_change_along_the_path_is_what_the_stored_energy_gains(phase):
    """At fixed gap, deflections settled: radius, shares and bodies of all pairs, against differences of the energy."""
    scene = sides(SHORT, PINION, GEAR, thickness="1 nm")
    problem = make_problem(scene.replace({"initial.gap": "12 nm", "initial.mesh_phase": phase}))
    m, y = problem.model, problem.start.copy()
    y[V], y[W] = 0.0, 1.0

    def stored(travel):
        moved = y.copy()
        moved[PHASE] += m.scene.phase_rate * travel
        assert settle_nodes(m, 0.0, moved)
        return stored_energy(m, moved)[0]

    step = 1e-2 / m.scene.phase_rate
    differences = [(stored(by * step) - stored(-by * step)) / (2.0 * by * step) for by in (0.05, 0.1)]
    settle_nodes(m, 0.0, y)
    # differences of second order, extrapolated to fourth: 1e-3 of a pitch against places of a third
    gained = (4.0 * differences[0] - differences[1]) / 3.0
    assert radius_power(m, 0.0, y, 0.0)[0] == pytest.approx(gained, rel=1e-6, abs=0)


def test_the_model_of_rigid_bodies_ends_where_the_softest_material_would_deflect_them():
    """A place may be bare however much is covered on average: the limit of a table is that of bare flanks."""
    table = np.full((19, 4), 0.95)
    scene = SHORT.replace({"contact.bodies": "auto"})
    worn = make_problem(scene.replace({"coating.pinion_table": table})).model.scene.lowest_gap
    bare, whole = (
        make_problem(scene.replace({"coating.sam_fraction": f})).model.scene.lowest_gap for f in (0.0, 1.0)
    )
    assert worn == max(bare, whole)
    assert bare != whole
