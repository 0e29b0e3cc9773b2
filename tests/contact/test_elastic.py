import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, optimize, special
from scipy.interpolate import make_interp_spline

from gearidae.asperities.tip import asperity_of, contact_modulus
from gearidae.contact.bulk import line_grid
from gearidae.contact.elastic import ElasticFoldError, elastic_line_curve, elastic_line_force
from gearidae.contact.line import line_force
from gearidae.contact.rough import adhesion_loss_per_asperity, rough_pressure
from gearidae.errors import SceneError, SolverError
from reference.strip import strip_deflection

R, L = 5e-6, 2e-6


def modulus_of(surface):
    return contact_modulus(surface.youngs_modulus, surface.poisson_ratio)


@pytest.fixture(scope="module")
def smooth(silicon):
    """Silicon without adhesion, so smooth and so densely covered that only the bodies give way."""
    return replace(silicon, energy=0.0, roughness=1e-10, asperity_density=5e17)


def test_smooth_limit_is_hertz(smooth):
    width = 1e-4  # long against the contact's 0.25 um, as Hertz's line contact is
    curve = elastic_line_curve([-40e-9], R, width, smooth, nodes=48)
    modulus = modulus_of(smooth)
    load = curve.force[0] / width
    half_width = math.sqrt(4 * load * R / (math.pi * modulus))
    peak = 2 * load / (math.pi * half_width)
    # What is left of the asperities gives way by 0.1 nm: 0.3 % of the approach.
    assert curve.pressure[0, 0] == pytest.approx(peak, rel=0.01, abs=0)
    inside = curve.pressure[0] > 0.3 * peak
    slope, square = np.polyfit(curve.x[inside] ** 2, curve.pressure[0][inside] ** 2, 1)
    assert math.sqrt(-square / slope) == pytest.approx(half_width, rel=0.01, abs=0)
    # Approach of a Hertzian strip of finite length: the averaged kernel 2 [log(2L/xi) - 1 + xi/L] under a semi-ellipse,
    # whose mean logarithm is log(a/2) - 1/2 and whose mean distance from the middle is 4a/(3 pi).
    logarithm = math.log(4 * width / half_width) - 0.5 + 4 * half_width / (3 * math.pi * width)
    assert 2 * load / (math.pi * modulus) * logarithm == pytest.approx(40e-9, rel=0.01, abs=0)


def test_smooth_limit_of_a_short_roller(smooth):
    # Here the kernel's |xi|/L counts (peak 5 % above Hertz). Frictionless contact as a problem of least squares with
    # p >= 0 on uniform strips: no asperities, no Newton.
    modulus = modulus_of(smooth)
    edges = np.linspace(-4.2e-7, 4.2e-7, 202)
    x = 0.5 * (edges[1:] + edges[:-1])
    matrix = strip_deflection(x[:, None], edges[:-1], edges[1:], L, modulus) * 1e18
    factor = np.linalg.cholesky(0.5 * (matrix + matrix.T))
    overlap = (40e-9 - x**2 / (2 * R)) * 1e9
    pressure, _ = optimize.nnls(factor.T, np.linalg.solve(factor, overlap))
    force = pressure.sum() * 1e9 * np.diff(edges)[0] * L
    curve = elastic_line_curve([-40e-9], R, L, smooth)
    assert curve.force[0] == pytest.approx(force, rel=0.01, abs=0)
    assert curve.pressure[0, 0] == pytest.approx(pressure.max() * 1e9, rel=0.01, abs=0)


def test_silicon_roller_pulls_off_at_1_26_micronewton(silicon):
    closest = optimize.brentq(
        lambda gap: elastic_line_force([gap], R, L, silicon)[0] - 16.6e-6, 5e-9, 20e-9, xtol=1e-13
    )
    assert closest == pytest.approx(10.8e-9, abs=0.05e-9)
    force = elastic_line_force(np.linspace(closest, 50e-9, 120), R, L, silicon)
    assert -force.min() == pytest.approx(1.26e-6, abs=0.005e-6)  # printed with three digits


def test_coated_roller_does_not_pull(coated):
    path = np.concatenate([np.linspace(30e-9, 12e-9, 20), np.linspace(12e-9, 60e-9, 40)])
    force = elastic_line_force(path, R, L, coated)
    assert force.min() > -1e-9 * force.max()


@pytest.mark.parametrize("deepest", [-60e-9, -10e-9, 10e-9])
def test_few_nodes_are_enough(silicon, deepest):
    inward, outward = np.linspace(40e-9, deepest, 16), np.linspace(deepest, 40e-9, 31)
    path = np.concatenate([inward, outward])
    converged = elastic_line_force(path, R, L, silicon, nodes=72)
    loading = np.abs(np.interp(outward, inward[::-1], converged[:16][::-1]))
    sixteen, twenty_four = (elastic_line_force(path, R, L, silicon, nodes=nodes) for nodes in (16, 24))
    # Loading pressure is analytic and converges at once; on the way out the pressure has a kink where the asperities
    # begin to let go, and the error shows while that front passes the nodes.
    assert np.abs(sixteen / converged - 1)[:16].max() < 1e-6
    assert (np.abs(twenty_four - converged)[16:] / loading).max() < 1e-5


def test_each_node_carries_its_own_equation(silicon):
    path = np.array([20e-9, -20e-9])
    curve = elastic_line_curve(path, R, L, silicon)
    modulus = contact_modulus(silicon.youngs_modulus, silicon.poisson_ratio)
    # On the way in nothing is stretched, whatever the path.
    assert curve.pressure == pytest.approx(rough_pressure(curve.node_gap, 0.0, silicon), rel=1e-9, abs=0)
    # Deflection in the middle by adaptive quadrature of the pressure through the nodes.
    x, pressure, width = curve.x * 1e6, curve.pressure[1] / 1e9, L * 1e6
    spline = make_interp_spline(
        np.concatenate([-x[:0:-1], x]), np.concatenate([pressure[:0:-1], pressure]), k=7
    )

    def integrand(t):
        xi = t**3
        kernel = 2 * (math.asinh(width / xi) - width / (math.hypot(xi, width) + xi)) if xi > 0 else 0.0
        return 2 * float(spline(xi)) * kernel * 3 * t * t

    deflection = integrate.quad(integrand, 0, x[-1] ** (1 / 3), epsrel=1e-10, limit=200)[0] / (
        math.pi * modulus / 1e9
    )
    assert curve.node_gap[1, 0] - path[1] == pytest.approx(deflection * 1e-6, rel=1e-5, abs=0)


def test_stiff_bodies_leave_the_asperity_model(silicon):
    # Ten thousand times fewer asperities: the bodies hardly feel them.
    sparse = replace(silicon, asperity_density=1.69e10)
    path = np.array([30e-9, 10e-9, -5e-9])
    rigid = line_force(path, 0.0, R, L, sparse)
    assert elastic_line_force(path, R, L, sparse) == pytest.approx(rigid, rel=2e-3, abs=0)
    assert np.all(elastic_line_force(path, R, L, sparse) < rigid)


@pytest.mark.parametrize(("asperity", "loses"), [("jkr", True), ("dmt", False), ("hertz", False)])
def test_closed_loop_loses_what_its_asperities_lose(silicon, asperity, loses):
    sigma, reach = silicon.roughness, asperity_of(silicon).stretch_limit
    node, weight = np.polynomial.legendre.leggauss(16)
    lowest, far = 5e-9, 75e-9
    # Gauss panels, small near the turning point where S grows to its limit over some nanometres.
    edges = lowest + np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 40.0, 70.0]) * 1e-9
    half = 0.5 * np.diff(edges)[:, None]
    gap, measure = (edges[:-1, None] + half * (1 + node)).ravel(), (half * weight).ravel()
    assert edges[-1] == pytest.approx(far, rel=1e-6, abs=0)
    path = np.concatenate([gap[::-1], [lowest], gap])
    curve = elastic_line_curve(path, R, L, silicon, asperity=asperity, nodes=20)
    inward, outward = curve.force[: gap.size][::-1], curve.force[-gap.size :]
    loop = measure @ (inward - outward)
    grid = line_grid(curve.x[-1], L, modulus_of(silicon), 20)
    closest = curve.node_gap[gap.size]
    joined = L * grid.weights @ special.ndtr(-closest / sigma) * silicon.asperity_density
    work = measure @ np.abs(inward)
    if loses:
        # Bodies give all their energy back. Kinks of the force where nodes reach full stretch limit the quadrature.
        assert loop == pytest.approx(adhesion_loss_per_asperity(silicon) * joined, rel=3e-4, abs=0)
        assert reach < sigma
    else:
        assert loop == pytest.approx(0.0, abs=1e-9 * work)


def test_path_in_between_does_not_matter(silicon):
    short = elastic_line_force([0.0, 25e-9], R, L, silicon)
    many = elastic_line_force(
        np.concatenate([np.linspace(40e-9, 0.0, 23), np.linspace(0.0, 25e-9, 17)]), R, L, silicon
    )
    assert short[0] == pytest.approx(many[22], rel=1e-8, abs=0)
    assert short[1] == pytest.approx(many[-1], rel=1e-8, abs=0)


def test_interface_of_two_materials(silicon, coated):
    path = np.array([20e-9, 5e-9, 22e-9])
    bare = elastic_line_force(path, R, L, silicon)
    covered = elastic_line_force(path, R, L, coated)
    assert np.array_equal(elastic_line_force(path, R, L, silicon, coated_surface=coated), bare)
    full = elastic_line_force(path, R, L, silicon, coated_surface=coated, sam_fraction=1.0)
    assert full == pytest.approx(covered, rel=1e-9, abs=0)
    half = elastic_line_force(path, R, L, silicon, coated_surface=coated, sam_fraction=0.5)
    assert np.all((bare < half) & (half < covered))


@pytest.fixture(scope="module")
def sticky(silicon):
    return replace(silicon, roughness=0.5e-9)


def test_fold_is_found_where_the_middle_gap_says(sticky):
    # Prescribe the middle node's gap instead of the rigid one and ask which rigid gap goes with it: that curve has no
    # fold, and the jump into contact is where the rigid gap stops falling.
    with pytest.raises(ElasticFoldError, match=r"folds: adhesion outgrows .* while closing") as caught:
        elastic_line_force([2e-9, 0.0], R, L, sticky, nodes=16)
    grid = line_grid(caught.value.curve.x[-1], L, modulus_of(sticky), 16)

    def rigid_gap(middle, guess):
        def residual(unknown):
            gap = np.concatenate([[middle], middle + unknown[1:] * 1e-9])
            rigid = unknown[0] * 1e-9
            deflection = grid.compliance @ rough_pressure(gap, 0.0, sticky)
            return (gap - grid.x**2 / (2 * R) - rigid - deflection) * 1e9

        solution = optimize.root(residual, guess, tol=1e-10)
        assert solution.success
        return solution.x

    state = np.concatenate([[2.0], grid.x[1:] ** 2 / (2 * R) * 1e9])
    rigid = []
    for middle in np.arange(2e-9, 0.3e-9, -0.01e-9):
        state = rigid_gap(middle, state)
        rigid.append(state[0])
        if len(rigid) > 2 and rigid[-1] > rigid[-2]:
            break
    parabola = np.polynomial.Polynomial.fit([0, 1, 2], rigid[-3:], 2)
    fold = float(parabola(parabola.deriv().roots()[0])) * 1e-9
    # It is followed to 1e-4 roughnesses of the fold.
    assert caught.value.gap == pytest.approx(fold, abs=3e-4 * sticky.roughness)
    assert caught.value.gap >= fold - 1e-13


def test_fold_keeps_what_was_reached(sticky):
    path = np.array([3e-9, 1e-9, 0.0, 3e-9])
    with pytest.raises(ElasticFoldError) as caught:
        elastic_line_force(path, R, L, sticky)
    fold = caught.value
    assert isinstance(fold, SolverError)
    assert np.isfinite(fold.curve.force).tolist() == [True, True, False, False]
    short_of_it = [3e-9, fold.gap + 1e-3 * sticky.roughness]
    assert np.isfinite(elastic_line_force(short_of_it, R, L, sticky)).all()
    copy = pickle.loads(pickle.dumps(fold))
    assert (copy.gap, copy.motion, str(copy)) == (fold.gap, "closing", str(fold))


def test_fold_on_the_way_out(silicon):
    # Rougher: closes smoothly, but stretched asperities pull the bodies along until they let go at once.
    path = np.concatenate([np.linspace(8e-9, -5e-9, 10), np.linspace(-5e-9, 8e-9, 10)])
    with pytest.raises(ElasticFoldError) as caught:
        elastic_line_force(path, R, L, replace(silicon, roughness=1e-9))
    assert caught.value.motion == "opening"
    assert np.isfinite(caught.value.curve.force[:10]).all()


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ({"gap": []}, "gap"),
        ({"gap": 1e-9}, "gap"),
        ({"gap": [np.nan]}, "gap"),
        ({"radius": -1.0}, "radius"),
        ({"width": 0.0}, "width"),
        ({"nodes": 2}, "nodes"),
        ({"sam_fraction": 0.3}, r"coating\.sam_fraction = 0\.3: needs a coated_surface"),
        ({"sam_fraction": 1.3}, r"coating\.sam_fraction = 1\.3: must lie in 0\.\.1"),
        ({"asperity": "none"}, r"contact\.asperity"),
    ],
)
def test_bad_input_is_named(silicon, arguments, key):
    with pytest.raises(SceneError, match=key):
        elastic_line_force(**{"gap": [0.0], "radius": R, "width": L, "surface": silicon, **arguments})


def test_coating_changes_nothing_but_the_energy(silicon, coated):
    with pytest.raises(SceneError, match=r"coated_surface\.roughness"):
        elastic_line_force(
            [0.0], R, L, silicon, coated_surface=replace(coated, roughness=2e-9), sam_fraction=0.5
        )
