import itertools
import math

import numpy as np
import pytest
from scipy import integrate

from gearidae.contact.bulk import bulk_influence, line_grid
from gearidae.errors import SceneError
from reference import love
from reference.strip import averaged_kernel, strip_deflection

L, E = 2e-6, 85e9
X, W = np.polynomial.legendre.leggauss(200)


@pytest.mark.parametrize("distance", [1e-9, 1e-7, 1e-6, 1e-4])
def test_kernel_is_the_mean_of_one_over_r(distance):
    # In units of L; the difference of two uniform ordinates is distributed like 1 - |y|.
    xi = distance / L
    points = [xi] if xi < 1 else None
    mean, _ = integrate.quad(
        lambda y: 2 * (1 - y) / math.hypot(xi, y), 0, 1, points=points, epsabs=0, epsrel=1e-12
    )
    assert averaged_kernel(distance, L) == pytest.approx(mean, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("x", "half"), [(0.0, 1e-8), (3e-8, 1e-8), (0.9e-8, 1e-8), (5e-7, 2e-7), (2e-5, 1e-6)]
)
def test_strip_is_loves_rectangle_averaged_across_the_width(x, half):
    # Love's solution has a logarithm at the rectangle's sides only, integrable: Gauss's rule crowded there.
    y = L / 2 * np.sin(math.pi / 2 * X)
    weight = W * math.pi / 4 * np.cos(math.pi / 2 * X)
    mean = weight @ love.deflection(x, y, half, L / 2, E)
    assert strip_deflection(x, -half, half, L, E) == pytest.approx(mean, rel=1e-7, abs=0)


def test_far_away_only_the_load_counts():
    x, half = 1e-3, 1e-7
    assert strip_deflection(x, -half, half, L, E) == pytest.approx(
        2 * half * L / x / (math.pi * E), rel=1e-6, abs=0
    )


def test_linear_pieces_by_quadrature():
    knots = np.array([0.0, 3e-8, 1e-7, 2.5e-7, 6e-7])
    points = np.array([0.0, 1e-8, 1e-7, 4e-7, 1e-6])
    pressure = np.array([2.0, 1.5, -0.5, 0.7, 0.3])
    got = bulk_influence(points, knots, L, E) @ pressure

    def integrand(t, x):
        return np.interp(abs(t), knots, pressure) * averaged_kernel(np.maximum(np.abs(t - x), 1e-30), L)

    for x, value in zip(points, got, strict=True):
        edges = np.unique(np.concatenate([-knots, knots, [x], [-x]]))
        edges = edges[np.abs(edges) <= knots[-1]]
        want = 0.0
        for left, right in itertools.pairwise(edges):
            # Crowd the nodes at both ends, where the logarithm may sit.
            v = 0.5 * (1 + X)
            t = left + (right - left) * v**4 * (35 - 84 * v + 70 * v**2 - 20 * v**3)
            rate = (right - left) * 140 * v**3 * (1 - v) ** 3
            want += float((0.5 * W * rate) @ integrand(t, x))
        assert value == pytest.approx(want / (math.pi * E), rel=1e-10, abs=0)


def test_uniform_pressure_is_a_sum_of_linear_pieces():
    knots = np.linspace(0.0, 5e-7, 11)
    points = np.linspace(0.0, 2e-6, 9)
    strip = strip_deflection(points, -5e-7, 5e-7, L, E)
    assert bulk_influence(points, knots, L, E) @ np.ones(11) == pytest.approx(strip, rel=1e-12, abs=0)


@pytest.mark.parametrize("knots", [[0.0], [1e-8, 2e-8], [0.0, 2e-8, 2e-8], [0.0, np.nan]])
def test_bad_knots_are_named(knots):
    with pytest.raises(SceneError, match=r"knots = .*must increase from 0"):
        bulk_influence([0.0], knots, L, E)


@pytest.mark.parametrize("breadth", [7e-8, 2e-7])
def test_twenty_nodes_carry_a_smooth_pressure(breadth):
    # Nodes reach 5 standard deviations of the wider bell, where it has fallen to 4e-6 and its integral lacks 6e-7.
    grid = line_grid(1e-6, L, E, 20)
    bell = np.exp(-0.5 * (grid.x / breadth) ** 2)
    assert grid.weights @ bell == pytest.approx(breadth * math.sqrt(2 * math.pi), rel=1e-6, abs=0)
    fine = line_grid(1e-6, L, E, 160)
    middle = fine.compliance[0] @ np.exp(-0.5 * (fine.x / breadth) ** 2)
    assert grid.compliance[0] @ bell == pytest.approx(middle, rel=3e-6, abs=0)


def test_work_is_reciprocal():
    # Maxwell-Betti: the work of one pressure on the other's deflection does not ask which came first.
    grid = line_grid(1e-6, L, E, 24)
    first, second = np.exp(-0.5 * (grid.x / 1e-7) ** 2), np.exp(-0.5 * ((grid.x - 3e-7) / 9e-8) ** 2)
    there = (grid.weights * first) @ grid.compliance @ second
    back = (grid.weights * second) @ grid.compliance @ first
    assert there == pytest.approx(
        back, rel=1e-4, abs=0
    )  # the second bell is not even, so its cosines end in a corner


@pytest.mark.parametrize(
    ("change", "key"), [({"reach": 0.0}, "reach"), ({"nodes": 3}, "nodes"), ({"modulus": np.nan}, "modulus")]
)
def test_bad_grid_is_named(change, key):
    with pytest.raises(SceneError, match=key):
        line_grid(**{"reach": 1e-6, "width": L, "modulus": E, "nodes": 20, **change})


def test_deflection_agrees_with_tamaas():
    tamaas = pytest.importorskip("tamaas", reason="wheels of tamaas exist for Linux only")
    # The whole square of 2 um is loaded: uniform across, a bell along; tamaas's own non-periodic Boussinesq operator.
    n = 256
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [2.0, 2.0], [n, n])
    model.E, model.nu = 85.0, 0.0  # units of um and GPa; E* is E/(1 - nu^2)
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    x = (np.arange(n) + 0.5) / n * 2 - 1
    model.traction[:] = np.exp(-0.5 * (x / 0.2) ** 2)[:, None]
    model.operators["dcfft"](model.traction, model.displacement)
    theirs = model.displacement.mean(axis=1)
    grid = line_grid(1e-6, L, E, 24)
    ours = grid.compliance @ (1e9 * np.exp(-0.5 * (grid.x * 1e6 / 0.2) ** 2)) * 1e6
    # Their pixels of 8 nm limit the agreement to 1e-4; the last node lies beyond their last pixel.
    assert ours[:-1] == pytest.approx(np.interp(grid.x[:-1] * 1e6, x, theirs), rel=3e-4, abs=0)
