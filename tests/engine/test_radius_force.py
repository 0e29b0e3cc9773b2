"""The force that pays for the changing radius: against the energy's slope, closing the balance, and checked numbers."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.laws.pairs import stored_energy
from gearidae.engine.laws.statistical import set_joined
from gearidae.engine.model.state import PHASE, U, V, W
from gearidae.engine.motion.pair_forces import mesh_forces
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.pairs.tooth_pairs import history_of
from gearidae.engine.setup.build import make_problem

LOW, HIGH = gd.preset("teodorescu2009_low_speed"), gd.preset("teodorescu2009")
ON = {"mesh.radius_force": True}


def pressed(direction, *, gap=3.0, joined=None, fraction=0.5):
    """Model and state of two pairs on the path of contact at one gap, closing or opening."""
    changes = {**ON, "coating.sam_fraction": fraction, "initial.mesh_phase": 0.1}
    problem = make_problem(LOW.replace({**changes, "contact.bodies": "rigid"}))
    m, y = problem.model, problem.start.copy()
    y[U], y[V] = m.scene.clearance[0] - gap, -direction * 0.1
    for pair in (0, -1):
        k = history_of(m, 0, pair)
        h = m.state.history[k]
        h.pair, h.direction = pair, direction
        for material in range(2):
            set_joined(m, k, material, gap + 1.0 if joined is None else joined)
    return m, y


@pytest.mark.parametrize(("direction", "joined"), [(-1.0, None), (1.0, 2.6), (1.0, 1.0)])
def test_force_is_the_slope_of_the_energy_along_the_path(direction, joined):
    """Closing; stretched in part; stretched in full. The energy is that of the balance, from its own tables."""
    m, y = pressed(direction, joined=joined)
    ours = mesh_forces(m, 0.0, y, False)[1]  # no pair is on its tip relief

    def energy(step):
        moved = y.copy()
        moved[PHASE] += step
        stored, pending = stored_energy(m, moved)
        return stored - pending

    step = 1e-4  # pitches; the third derivative of the length is of order one
    slope = (energy(step) - energy(-step)) / (2 * step) * m.scene.phase_rate
    assert abs(ours) > 0.0
    assert ours == pytest.approx(-slope, rel=1e-6, abs=0)


@pytest.mark.parametrize(("direction", "joined"), [(-1.0, None), (1.0, 2.6)])
def test_its_slopes_are_in_the_jacobian(direction, joined):
    m, y = pressed(direction, joined=joined)
    n, yp, cj = 4, np.linspace(0.1, 0.4, 4), 2.5

    def differences(on):
        m.scene.curvature_force = on
        matrix = np.empty(n * n)
        jacobian(m, 0.0, cj, y, matrix)
        numeric = np.empty(n)
        for column in range(n):
            out = np.empty((2, n))
            step = 1e-6 * np.eye(n)[column]
            residual(m, 0.0, y + step, yp, out[0])
            residual(m, 0.0, y - step, yp, out[1])
            numeric[column] = (out[0] - out[1])[W] / 2e-6
        return matrix.reshape(n, n).T[W], numeric

    (with_it, numeric), (without, as_numeric) = differences(1), differences(0)
    ours, wanted = (with_it - without)[[U, PHASE]], (numeric - as_numeric)[[U, PHASE]]
    # differences of differences: rounding of 1e-16 over 1e-6, on forces of order 0.1
    np.testing.assert_allclose(ours, wanted, rtol=1e-4, atol=1e-9)
    assert ours[0] != 0.0


@pytest.mark.parametrize(
    ("backend", "changes"),
    [
        ("native", {"coating.sam_fraction": 0.5, "run.duration": 0.05}),
        ("sksundae", {"coating.sam_fraction": 0.5, "run.duration": 0.02}),
        (
            "native",
            {
                "coating.sam_fraction": 0.3,
                "run.duration": 0.03,
                "contact.bodies": "elastic",
                "run.rtol": 1e-5,
            },
        ),
    ],
)
def test_the_balance_closes_without_a_work_of_the_radius(backend, changes):
    scene = LOW.replace({**ON, "run.samples": "off", **changes})
    balance = solve(scene, backend=backend).balance
    assert balance.radius_work == 0.0
    assert balance.adhesion_loss > 1e-3 * balance.throughput
    assert abs(balance.residual) <= balance.bound(scene.run.rtol, roller=False)
    # what no force pays for otherwise is far above this
    other = solve(scene.replace({"mesh.radius_force": False}), backend=backend).balance
    assert abs(other.radius_work) > 100 * abs(balance.residual)


def test_the_balance_closes_where_the_coating_changes_along_the_flank():
    """The force then pays for the changing shares, too."""
    table = {"coating.pinion_table": [[0.3, 0.6, 0.9]], "contact.bodies": "rigid"}
    scene = LOW.replace({**ON, **table, "run.samples": "off", "run.duration": 0.1})
    balance = solve(scene).balance
    assert balance.radius_work == 0.0
    # far below the bound, and below what the changing shares bring in without the force
    assert abs(balance.residual) < 1e-6 * balance.throughput
    other = solve(scene.replace({"mesh.radius_force": False})).balance
    assert abs(other.radius_work) > 1e-4 * balance.throughput


def test_numbers_checked_by_an_independent_integrator():
    """Smallest speed, speed at 0.2 s and the sticking limit with the force and without: three digits are known.

    At 0.2 s the speed falls by 0.02 rad/s in each millisecond, and the other integrator's time has an error of its own.
    """
    off = {"run.samples": "off"}
    for on, dip, at_200_ms in ((True, 0.822, 1.145), (False, 0.725, 0.896)):
        worn = LOW.replace({"mesh.radius_force": on, "coating.sam_fraction": 0.5, **off})
        half = gd.simulate(worn)
        assert float(half.min_gear_speed) == pytest.approx(dip, abs=6e-4)
        assert np.isnan(half.stick_time)
        sticks = gd.simulate(worn.replace({"coating.sam_fraction": 0.47, "run.samples": 301}))
        assert float(sticks.gear_speed.sel(time=0.2, method="nearest")) == pytest.approx(at_200_ms, abs=1e-3)
        assert float(sticks.stick_time) < 0.3


def test_mean_speed_at_high_speed_as_checked():
    for on, wanted in ((True, 1.136), (False, 1.883)):
        coated, bare = (
            gd.simulate(HIGH.replace({"mesh.radius_force": on, "coating.sam_fraction": f})) for f in (1, 0)
        )
        assert float(coated.gear_speed.mean() - bare.gear_speed.mean()) == pytest.approx(wanted, abs=6e-4)


def test_scenes_have_it_and_the_paper_has_not():
    tables = LOW.to_dict()
    assert tables["mesh"].pop("radius_force") is False
    assert gd.Scene.from_dict(tables).mesh.radius_force is True
    assert gd.Scene.from_dict(LOW.replace(ON).to_dict()) == LOW.replace(ON)


@pytest.mark.parametrize("value", [1, 0.0, "yes", None, [True]])
def test_only_true_or_false(value):
    with pytest.raises(gd.SceneError, match="true or false") as error:
        LOW.replace({"mesh.radius_force": value})
    assert error.value.key == "mesh.radius_force"
