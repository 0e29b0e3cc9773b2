"""Branches at a table's knots, against quadrature of the kernel itself: no interpolation, no shared panels."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad

from gearidae.asperities.dmt import Dmt
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.jkr import Jkr
from gearidae.asperities.maugis import Maugis
from gearidae.contact.gauss import gauss_rule
from gearidae.contact.kernels.densities import kernel_at_knots
from gearidae.contact.kernels.knots import loading_derivatives, stretched_derivatives
from gearidae.contact.kernels.layout import KNOTS_PER_SIGMA

SOFT = (Jkr(1e-3), Jkr(0.3), Jkr(0.95), Jkr(4.0), Maugis(0.06, 1.6), Maugis(0.24, 9.5))
KERNELS = ("line", "plane")
LOW = -6.0
"""Gap below which so much is pressed that the derivatives lose more digits to cancellation."""


def by_rule(places, law, edges, kernel):
    """Integral of the load times the kernel at each place plus the displacement, by 60 nodes between two edges.

    The derivatives of psi lose their digits to cancellation in the far tail, where there is nothing left of them.
    """
    total = np.zeros((4, len(places)))
    for low, high in itertools.pairwise(edges):
        delta, weight = law.nodes(low, high, *gauss_rule(60))
        for i, place in enumerate(places):
            near = place + delta < 9.0
            total[:, i] += kernel_at_knots(kernel, (place + delta)[near]) @ weight[near]
    return total


def assert_same(ours, exact):
    """To 1e-12 of what is largest at any knot, and to 1e-9 of themselves where little is left."""
    scale = np.abs(exact).max(axis=1, keepdims=True)
    np.testing.assert_array_less(np.abs(ours - exact) / scale, 1e-12)
    np.testing.assert_allclose(ours[0], exact[0], rtol=1e-9, atol=0)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("law", [*SOFT, Hertz(), Dmt(0.2)], ids=repr)
def test_loading(law, kernel):
    gaps = LOW + np.arange(0, 12 * KNOTS_PER_SIGMA) / KNOTS_PER_SIGMA
    some = slice(5, None, 13)
    edges = np.unique([-law.join, *np.linspace(-law.join, 0.0, 3), *np.arange(0.0, 9.0 - LOW, 0.25)])
    assert_same(loading_derivatives(gaps, law, kernel)[:, some], by_rule(gaps[some], law, edges, kernel))


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("law", SOFT, ids=repr)
def test_stretched(law, kernel):
    joined, v = np.array([-6.3, -2.0, 0.125, 1.9, 4.25]), np.array([0.0, 0.02, 0.4, 0.97])
    limit = law.detach - law.join
    ours = stretched_derivatives(joined, law, v, kernel)
    for m, part in enumerate(v):
        stretch = limit * (1.0 - part**2)
        edges = np.linspace(max(-stretch - law.join, -law.detach), -law.join, 30)
        assert_same(ours[:, :, m], by_rule(joined + stretch, law, edges, kernel))


def test_the_rule_is_that_of_the_load():
    """`by_rule` rests on `nodes`: here the load itself is integrated, which begins with a square root at its fold."""
    law, place = Jkr(0.3), 0.7

    def product(root):
        delta = root**2 - law.detach
        return 2.0 * root * float(law.load(delta)) * kernel_at_knots("plane", np.array([place + delta]))[0, 0]

    exact = quad(product, 0.0, np.sqrt(law.detach), epsabs=0, epsrel=1e-12)[0]
    ours = stretched_derivatives(np.array([place - 0.3]), law, np.zeros(1), "plane")[0, 0, 0]
    assert ours == pytest.approx(exact, rel=1e-11, abs=0)
