"""Asperities with a Dugdale zone: printed figures, the limits, an independent solution, and the tables."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from scipy import integrate, optimize

import gearidae as gd
from balances import assert_balanced
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.maugis import Maugis
from gearidae.asperities.tip import asperity_of
from gearidae.contact.heights import Heights
from gearidae.contact.kernels.law import law_table, law_value
from gearidae.contact.psi import psi
from gearidae.engine import solve
from gearidae.errors import SceneError
from reference.surface import PlainSurface

# Tabor's parameter (lambda over 1.157), distances of joining and of letting go, pull-off, loss; computed independently
# and printed with these digits
PRINTED = [
    (0.10, 5.50233, 5.50715, 1.93986, 0.00002),
    (0.45, 1.22274, 1.32040, 1.71046, 0.04420),
    (0.82, 0.67102, 0.99511, 1.60802, 0.45066),
    (2.5, 0.22009, 0.92394, 1.51793, 0.99997),
    (5.0, 0.11005, 0.91260, 1.50478, 1.13339),
    (20.0, 0.02751, 0.90882, 1.50031, 1.23860),
]


@pytest.mark.parametrize(("tabor", "join", "detach", "pull_off", "loss"), PRINTED)
def test_printed_figures(tabor, join, detach, pull_off, loss):
    law = Maugis(1.0, 1.157 * tabor)
    got = (law.join, law.detach, law.pull_off, law.loss)
    assert got == pytest.approx((join, detach, pull_off, loss), rel=0, abs=6e-6)  # the last digit


@pytest.mark.parametrize("tabor", [0.1, 0.82, 5.0])
def test_zone_is_tabors_parameter_times_a_constant(tabor):
    law = gd.contact.asperity("maugis", tabor=tabor)
    assert law.zone == pytest.approx(1.157 * tabor, rel=5e-4, abs=0)  # printed with four digits
    assert law.join == pytest.approx(2 / (math.pi * law.zone), rel=1e-14, abs=0)


def test_limits():
    """Bradley's rigid spheres at one end, JKR at the other, approached as 0.55 over Tabor's parameter."""
    assert gd.contact.asperity("maugis", tabor=0.05).pull_off == pytest.approx(1.977, abs=5e-4)
    jkr, near = gd.contact.asperity("jkr"), gd.contact.asperity("maugis", tabor=100.0)
    assert near.pull_off == pytest.approx(1.500012, abs=1e-6)
    assert 1 - near.loss / jkr.loss == pytest.approx(0.0055, rel=0.05, abs=0)
    place = np.linspace(-0.85, 5.0, 9)
    nearer = gd.contact.asperity("maugis", tabor=1000.0)
    gap = np.max(np.abs(near.load(place) - jkr.load(place)))
    assert np.max(np.abs(nearer.load(place) - jkr.load(place))) < 0.15 * gap


def by_equations(zone, displacement):
    """Load at a displacement from the equations as Maugis has them, in m = c/a; None if the tip does not touch."""

    def radius(m):
        t, q = math.sqrt(m * m - 1), math.atan(math.sqrt(m * m - 1))
        square, linear = zone / 2 * (t + (m * m - 2) * q), 4 / 3 * zone**2 * (t * q - m + 1)
        return (-linear + math.sqrt(linear**2 + 4 * square)) / (2 * square), t, q

    def excess(m):
        a, t, _ = radius(m)
        return a * a - 4 / 3 * zone * a * t - displacement

    m = 1 + np.geomspace(1e-5, 1e4, 4000)
    values = np.array([excess(ratio) for ratio in m])
    crossing = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
    if crossing.size == 0:
        return None
    root = optimize.brentq(excess, m[crossing[0]], m[crossing[0] + 1], xtol=1e-14, rtol=1e-14)
    a, t, q = radius(root)
    return a**3 - zone * a * a * (t + root**2 * q)


@pytest.mark.parametrize("zone", [0.1157, 0.9487, 5.785, 23.14])
def test_load_solves_the_printed_equations(zone):
    law = Maugis(1.0, zone)
    places = [place for place in np.linspace(-0.6, 4.0, 12) if by_equations(zone, place) is not None]
    assert len(places) >= 8
    wanted = [by_equations(zone, place) for place in places]
    # t + (m^2 - 2) q loses up to seven digits where m is near 1
    np.testing.assert_allclose(law.load(places), wanted, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("zone", [0.1157, 0.5207, 0.93, 0.9487, 5.785])
def test_the_branch_is_one_continuous_fold(zone):
    law = Maugis(0.3, zone)
    place = np.concatenate(
        [-law.detach + np.geomspace(1e-13, 1e-3, 60), np.linspace(-law.detach + 2e-3, 1.0, 400)]
    )
    load = law.load(place)
    assert law.load(-law.detach * (1 + 1e-12)) == 0.0
    assert np.max(-load) <= law.pull_off * (1 + 1e-9)
    steps = np.abs(np.diff(load)) / np.sqrt(np.diff(place))
    assert np.max(steps) < 20 * law.pull_off / math.sqrt(law.detach)  # no jump: a root at the steepest
    # no load is exerted where an approaching asperity joins, on the other branch; on the stable one it pulls
    assert float(law.load(-law.join)) < 0.0


@pytest.mark.parametrize("zone", [0.1157, 0.5207, 0.9487, 5.785])
def test_quadrature_follows_both_branches(zone):
    law, rule = Maugis(0.3, zone), np.polynomial.legendre.leggauss(48)
    low, high = -law.detach, 0.4
    place, weight = law.nodes(low, high, *rule)
    marks = sorted({low, -law.join, law.length * law._marks[1], 0.0, high})
    total = sum(
        np.sum(AsperityLaw.nodes(law, a, b, *np.polynomial.legendre.leggauss(200))[1])
        for a, b in itertools.pairwise(marks)
    )
    # the rule in sqrt(displacement + detach) meets the square root's cousin where the tip begins to touch
    assert np.sum(weight) == pytest.approx(float(total), rel=1e-8, abs=0)
    assert np.all((place > low - 1e-12) & (place < high + 1e-12))


@pytest.mark.parametrize("length", [0.04, 0.244])
@pytest.mark.parametrize("zone", [0.5207, 0.68, 0.722, 0.9375, 0.9385, 0.9487, 5.785, 23.14])
def test_force_table_against_quadrature(length, zone):
    law = Maugis(length, zone)
    table, heights = law_table(law), Heights(1.0, 1.0, law)
    rng = np.random.default_rng(6)
    gap, share = rng.uniform(-8.0, 8.0, 150), np.clip(rng.uniform(-0.2, 1.2, 150), 0.0, 1.0)
    width = law.detach - law.join
    exact = heights.integral(psi, gap, law.join + share * width, decays_left=False)
    loading = heights.integral(psi, gap, np.full(150, law.join), decays_left=False)
    values = np.array([law_value(table, g, g - s * width)[0] for g, s in zip(gap, share, strict=True)])
    size = np.abs(loading) + np.abs(exact - loading)
    # 1e-9 as for other laws; 5e-9 where fold and touch lie close to each other or to joining
    assert np.max(np.abs(values - exact) / size) < (1e-9 if zone > 0.94 or zone < 0.6 else 5e-9)
    # the readable law against adaptive quadrature of the load itself
    top = math.sqrt(9.5 - min(gap[0], 0.0) + law.detach + 2)
    bend = [math.sqrt(max(law.length * law._marks[1] + law.detach, 0.0)), math.sqrt(law.detach)]
    first = math.sqrt(max(law.detach - law.join - share[0] * width, 0.0))
    by_hand, _ = integrate.quad(
        lambda e: 2 * e * float(law.load(e * e - law.detach)) * float(psi(gap[0] + e * e - law.detach)),
        first,
        top,
        points=[place for place in bend if place > first],
        epsabs=0,
        epsrel=1e-10,
        limit=300,
    )
    assert exact[0] == pytest.approx(by_hand, rel=0, abs=1e-10 * size[0])


def test_without_adhesion_it_is_hertz():
    assert Maugis.of(asperity_of(PlainSurface(energy=0.0)), 1e-9) == Hertz()


def test_what_is_no_range_is_refused():
    with pytest.raises(
        SceneError, match=r"surface\.interaction_range = 0\.0: must be above 0 and at most 1e-06 m"
    ):
        gd.preset("roller_slow").replace({"surface.interaction_range": 0.0})
    with pytest.raises(SceneError, match=r"tabor = -1\.0: must be a positive number"):
        gd.contact.asperity("maugis", tabor=-1.0)


@pytest.mark.parametrize("fraction", [0.0, 0.5, 1.0])
def test_an_impact_loses_what_its_asperities_cost(fraction):
    scene = gd.preset("roller_slow").replace(
        {"coating.sam_fraction": fraction, "contact.bodies": "rigid", "contact.asperity": "maugis"}
    )
    scene = scene.replace({"run.duration": 3e-5, "run.samples": 40_001, "run.rtol": 1e-9})
    run = solve(scene)
    sigma, roller = scene.surface.roughness, scene.roller
    count = scene.surface.asperity_density * roller.width * math.sqrt(2 * roller.radius * sigma)
    lost = 0.0
    for surface, share in ((scene.surface, 1 - fraction), (scene.coated_surface, fraction)):
        first = (run.samples["height"].min() - Maugis.of(asperity_of(surface), 1.0).join) / sigma
        above = integrate.quad(psi, first, 16.0, epsabs=0, epsrel=1e-11, limit=200)[0]
        lost += share * count * above * gd.contact.adhesion_loss_per_asperity(surface, "maugis")
    # the lowest sample lies near a turning point, so that its error enters squared
    assert run.balance.adhesion_loss == pytest.approx(lost, rel=1e-6, abs=0)
    speed = run.samples["speed"]
    assert 0.5 * roller.mass * (speed[0] ** 2 - speed[-1] ** 2) == pytest.approx(lost, rel=1e-5, abs=0)
    assert_balanced(run.balance, scene)


def test_gears_on_coated_teeth_run_as_an_independent_integrator_has_them():
    """Speed at 0.1 s, printed with seven digits; the rough law's error of 1e-10 and the tolerance are far below."""
    scene = gd.preset("teodorescu2009_low_speed").replace(
        {"contact.asperity": "maugis", "contact.bodies": "rigid", "coating.sam_fraction": 1.0}
    )
    run = solve(scene.replace({"run.duration": 0.1, "run.samples": 10_001, "run.rtol": 1e-8}))
    assert run.samples["gear_speed"][-1] == pytest.approx(1.499738, abs=2e-6)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("energy", "distance"), [(0.05, 1e-90), (1e-300, 3e-10)], ids=["no range", "no energy"]
)
def test_absurd_surfaces_overflow_nowhere(energy, distance):
    tip = dataclasses.replace(asperity_of(PlainSurface(energy=energy)), interaction_range=distance)
    law = Maugis.of(tip, 6e-9)
    assert np.isfinite([law.detach, law.join, law.pull_off, law.loss]).all()
    assert np.isfinite(law.load(np.linspace(-5.0, 60.0, 14))).all()
