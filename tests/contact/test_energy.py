"""The stored energy of a rough contact against the integral it stands for."""

import math

import numpy as np
import pytest

from gearidae.asperities.dmt import Dmt
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.jkr import JOINING, S_FOLD, Jkr, jkr_load, jkr_root
from gearidae.contact.kernels.energy import (
    energy_table,
    joining_energy,
    number_table,
    stretched_energy,
)
from gearidae.contact.kernels.law import HEADER, law_table, law_value, loading_value
from gearidae.contact.psi import psi


def kernel_of(kernel, y):
    return psi(y) if kernel == "line" else np.exp(-0.5 * y**2) / math.sqrt(2 * math.pi)


def panels(low, high, count):
    x, w = np.polynomial.legendre.leggauss(24)
    edges = np.linspace(low, high, count + 1)
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()


def stored(gap, stretch, limit, kernel):
    """int_{-S} E(Delta) kernel(G + Delta) over the root e = sqrt(1 + Delta/D), E the integral of JKR's load."""

    def energy(delta):
        t = jkr_root(delta / limit) / S_FOLD  # E = int P, with P = t^3 (t^3 - 6)/9 and Delta = (t^4 - 4 t)/3
        return math.sqrt(3) * limit**2.5 * 4 / 27 * ((t**10 - 1) / 10 - (t**7 - 1) + 1.5 * (t**4 - 1))

    e, weight = panels(math.sqrt(max(1 - stretch / limit, 0.0)), math.sqrt(1 + 24 / limit), 240)
    delta = limit * (e**2 - 1)
    return np.sum(weight * 2 * limit * e * energy(delta) * kernel_of(kernel, gap + delta))


def test_what_joining_costs_is_the_area_under_the_load():
    e, weight = panels(0.0, 1.0, 4)
    area = np.sum(weight * 2 * e * jkr_load(e**2 - 1))
    assert -area == pytest.approx(JOINING, rel=1e-12, abs=0)
    assert pytest.approx(0.93550, abs=5e-6) == JOINING


@pytest.mark.parametrize("kernel", ["line", "plane"])
@pytest.mark.parametrize("limit", [0.036, 0.22, 0.9, 2.5])  # the last has no tabulated branch
def test_the_potential_is_the_integral_over_the_asperities(limit, kernel):
    table, law, number = (
        energy_table(Jkr(limit), kernel),
        law_table(Jkr(limit), kernel),
        number_table(kernel),
    )
    for joined in (-6.0, -1.03, 0.2, 3.1, 5.7):
        adhered_energy = -joining_energy(Jkr(limit)) * loading_value(number, 0, joined)[0]
        for share in (1e-3, 0.2, 0.9, 0.9999, 1.4):
            gap = joined + share * limit
            potential, push = loading_value(table, HEADER, gap)
            energy, slope = stretched_energy(table, adhered_energy, gap, joined)
            # the table of the law is held to 1e-9, on the scale of what is added up
            expected = stored(gap, min(share, 1.0) * limit, limit, kernel)
            assert potential + energy == pytest.approx(expected, abs=1e-9 * (abs(potential) + abs(energy)))
            # and it falls by the work of the force
            force, _ = law_value(law, gap, joined)
            assert -(push + slope) == pytest.approx(force, rel=1e-8, abs=0)


@pytest.mark.parametrize("asperity", [Dmt(0.22), Hertz(), Jkr(1e-5)], ids=str)
def test_without_stretch_there_is_nothing_beyond_the_loading_branch(asperity):
    table, law = energy_table(asperity), law_table(asperity)
    assert joining_energy(asperity) == 0.0
    assert stretched_energy(table, 0.0, 1.0, 0.5) == (0.0, 0.0)
    gap, weight = panels(0.5, 13.0, 40)
    work = np.sum(weight * [loading_value(law, HEADER, g)[0] for g in gap])
    assert loading_value(table, HEADER, 0.5)[0] == pytest.approx(work, rel=1e-9, abs=0)


def test_number_of_asperities_above_a_height():
    number = number_table("plane")
    for z in (-5.0, -0.3, 0.0, 2.2, 8.0):
        expected = 0.5 * math.erfc(z / math.sqrt(2))
        assert loading_value(number, 0, z)[0] == pytest.approx(expected, rel=1e-10, abs=0)
