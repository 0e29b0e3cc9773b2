"""One asperity, compiled: the tables of its load and energy are those of its law; closed forms of many."""

import math

import numpy as np
import pytest
from scipy import special

from gearidae.asperities import asperity, law_of
from gearidae.asperities.tip import asperity_of
from gearidae.contact.asperity_statistics import asperities_for_mean, expected_asperities
from gearidae.contact.kernels.single import asperity_energy, asperity_table, asperity_value
from gearidae.contact.psi import psi
from gearidae.mesh import curvature_radii, flank_arc, position_of_arc
from gearidae.scene import preset
from reference.population import NUMBERS, Contact, Tip, drop

SCENE = preset("teodorescu2009")
LAWS = [
    ("jkr", 5.0),
    ("dmt", 1.0),
    ("hertz", 1.0),
    *(("maugis", mu) for mu in (0.3, 0.45, 0.82, 1.0, 5.0, 50.0)),
]
ERROR = 1e-10
"""Of the larger of load and pull-off, as the module says; a table of degree seven leaves some 1e-11."""


@pytest.mark.parametrize(("name", "tabor"), LAWS)
def test_tables_have_the_load_and_the_energy_of_the_law(name, tabor):
    law = asperity(name, tabor=tabor)
    table = asperity_table(law, 1000.0)
    near = -law.detach + np.geomspace(1e-9, 1.0, 101)
    displacement = np.concatenate(
        [near, np.linspace(-law.detach, 1.0, 301)[1:], np.geomspace(1e-3, 999.0, 101)]
    )
    load, energy = law.load(displacement), law.detachment_energy + law.energy(displacement)
    values = np.array([asperity_value(table, 0, float(x)) for x in displacement])
    scale = np.maximum(abs(load), max(law.pull_off, 1e-3))
    assert (abs(values[:, 0] - load) <= ERROR * scale).all()
    energies = np.array([asperity_energy(table, 0, float(x)) for x in displacement])
    assert (abs(energies - energy) <= ERROR * np.maximum(abs(energy), max(law.pull_off, 1e-3))).all()
    # slope: central differences over a hundredth of the way from the fold, whose own error is 1e-4 of the change
    inner = displacement[displacement > -law.detach + 1e-6]
    step = 1e-4 * (inner + law.detach)
    rise = (law.load(inner + step) - law.load(inner - step)) / (2.0 * step)
    slopes = np.array([asperity_value(table, 0, float(x))[1] for x in inner])
    inside = abs(inner - law.touch) > 2.0 * step  # no difference over a kink
    assert (abs(slopes - rise)[inside] <= 1e-4 * np.maximum(abs(rise), 1.0)[inside]).all()


def test_beyond_its_table_a_load_goes_on_as_hertz_s_and_below_the_fold_it_stays():
    law = asperity("jkr")
    table = asperity_table(law, 100.0)
    near, far = (asperity_value(table, 0, x)[0] for x in (1000.0, 4000.0))
    assert far / near == pytest.approx(8.0, rel=0.05)  # (1 + w)^3 in place of w^3
    ends = [asperity_value(table, 0, -law.detach - x) for x in (0.0, 0.1, 10.0)]
    assert [end[1] for end in ends] == [0.0, 0.0, 0.0]
    assert [end[0] for end in ends] == pytest.approx([float(law.load(-law.detach))] * 3, rel=1e-10)


def test_energies_of_one_asperity():
    """Joining loses 0.84661 and letting go 4/45 of pull-off load times stretch limit; Maugis tends to that."""
    expected, law = NUMBERS["one_asperity"], law_of("jkr", SCENE.surface)
    unit = law.pull_off * law.detach
    assert law.loss / unit == pytest.approx(expected["loss"], rel=1e-12)
    assert law.detachment_energy / unit == pytest.approx(expected["letting_go"], rel=1e-12)
    assert (law.loss - law.detachment_energy) / unit == pytest.approx(expected["joining"], rel=1e-12)
    jkr, soft = asperity("jkr"), asperity("maugis", tabor=1e5)
    assert soft.detachment_energy == pytest.approx(jkr.detachment_energy, rel=1e-6)
    # where it lets go before it touches, P = -pi/2 lambda C^2 on the whole branch: pi lambda (8 lambda/3 pi)^4 / 24
    hard = asperity("maugis", tabor=0.3)
    fold = 8.0 * hard.zone / (3.0 * math.pi)
    assert hard.detachment_energy == pytest.approx(math.pi * hard.zone * fold**4 / 24.0, rel=1e-12)
    for surface, name in ((SCENE.surface, "bare"), (SCENE.coated_surface, "coated")):
        tip = Tip(surface, 450e-9)
        assert tip.joining + tip.letting_go == pytest.approx(expected[name]["loss"], rel=1e-12, abs=0)
        assert tip.detach == pytest.approx(expected[name]["dc"], rel=1e-12, abs=0)


def test_arcs_and_radii_along_the_path():
    expected, g = NUMBERS["geometry"], SCENE.geometry
    ends = [0.0, g.path_length]
    np.testing.assert_allclose(flank_arc(g, ends), [expected["s_lo"], expected["s_hi"]], rtol=1e-12)
    np.testing.assert_allclose(flank_arc(g, g.approach), expected["pitch_point_arc"], rtol=1e-12)
    at = [0.0, g.approach, g.path_length]
    np.testing.assert_allclose(
        curvature_radii(g, at)[2], [expected["R_start"], expected["R_pitch"], expected["R_end"]], rtol=1e-12
    )
    inside = np.linspace(0.0, g.path_length, 7)
    np.testing.assert_allclose(position_of_arc(g, flank_arc(g, inside)), inside, rtol=1e-12, atol=1e-18)
    outside = flank_arc(g, [-1e-6, g.path_length + 1e-6])
    np.testing.assert_allclose(outside, [expected["s_lo"], expected["s_hi"]], rtol=1e-12)


@pytest.mark.parametrize("xi", [2e-6, 9e-6, 18e-6])
def test_an_overlap_s_slope_along_the_path_is_its_derivative(xi):
    contact, h = Contact(SCENE), 1e-11
    arc = contact.at(xi)["arc"] + 0.3e-6
    before, after = (contact.overlap(xi + d, 12e-9, arc, 17e-9)[0] for d in (-h, h))
    assert contact.overlap(xi, 12e-9, arc, 17e-9)[1] == pytest.approx((after - before) / (2 * h), rel=1e-6)


@pytest.mark.parametrize(("name", "kappa"), [("coated", 1.726), ("bare", 3.020)])
def test_forces_of_drawn_asperities_scatter_about_the_mean_law(name, kappa):
    """Mean and scatter of 4,000 drawn contacts at a gap of two roughnesses: standard errors 1/sqrt(4000) of either."""
    surface = SCENE.surface if name == "bare" else SCENE.coated_surface
    sigma, gap, radius, width = surface.roughness, 2.0, 1e-5, 2e-6
    law = law_of("jkr", surface)
    assert asperities_for_mean(gap * sigma, [(surface, 1.0, 0.0)], "jkr") == pytest.approx(
        (10.0 * kappa) ** 2, rel=1e-3
    )
    n = float(expected_asperities(gap * sigma, radius, width, surface))
    rng, reach, draws = np.random.default_rng(5), 1e-6, 4000
    counts = rng.poisson(surface.asperity_density * width * 2.0 * reach, draws)
    x, z = reach * rng.uniform(-1.0, 1.0, counts.sum()), rng.standard_normal(counts.sum())
    overlap = z - gap - x**2 / (2.0 * radius * sigma)
    loads = np.where(overlap > 0.0, law.load(np.maximum(overlap, 0.0)), 0.0)
    forces = np.array([part.sum() for part in np.split(loads, np.cumsum(counts)[:-1])])
    root, weight = np.polynomial.legendre.leggauss(80)
    root = 1.75 * (root + 1.0)
    integral = float((1.75 * weight * 2.0 * root * law.load(root**2) * psi(gap + root**2)).sum())
    mean = surface.asperity_density * width * math.sqrt(2.0 * radius * sigma) * integral
    scatter = kappa * mean / math.sqrt(n)
    assert abs(forces.mean() - mean) < 4.0 * abs(scatter) / math.sqrt(draws)
    assert forces.std() == pytest.approx(abs(scatter), rel=0.1)  # of so few the fourth moment leaves 3 %


@pytest.mark.parametrize("name", ["bare", "coated"])
def test_rolling_at_a_fixed_gap_costs_each_asperity_its_loss(name):
    """The compiled load over 8,000 stratified heights; per arc 0.93550 Pc dc N L Q(g/sigma) in closed form."""
    surface = SCENE.surface if name == "bare" else SCENE.coated_surface
    law, gap = law_of("jkr", surface), 2.0
    expected = next(
        row
        for row in NUMBERS["rolling_at_fixed_gap"]
        if row["surface"] == name and row["g_over_sigma"] == gap
    )
    table, strata = asperity_table(law, 10.0), 8000
    above = 0.5 * math.erfc(gap / math.sqrt(2.0))
    heights = special.ndtri(1.0 - above * (np.arange(strata) + 0.5) / strata) - gap
    x, w = np.polynomial.legendre.leggauss(12)
    force = 0.0
    for top in heights.tolist():
        # from the asperity's joining at overlap 0 to the highest overlap and on to detachment, in roots of the overlap
        for low, high, sign in ((0.0, top, 1.0), (-law.detach, top, -1.0)):
            last = math.sqrt(high - low)
            root = 0.5 * last * (x + 1.0)
            loads = [asperity_value(table, 0, low + r * r)[0] for r in root.tolist()]
            force += sign * float((0.5 * last * w * 2.0 * root * loads).sum())
    unit = asperity_of(surface).hertz_factor * surface.roughness**2.5
    rolling = surface.asperity_density * 2e-6 * above * unit * abs(force) / strata
    assert rolling == pytest.approx(expected["rolling_force_closed"], rel=1e-6, abs=0)


def test_approach_and_parting_of_a_roller():
    """Events by quadrature in 30 digits; whatever happens between, each asperity costs 0.93550 Pc dc."""
    expected = NUMBERS["roller"]["bare"]
    tips = [Tip(SCENE.surface, radius) for radius in (450e-9, 300e-9, 600e-9)]
    places, heights = [0.0, 0.12e-6, -0.2e-6], [15e-9, 14e-9, 17.5e-9]
    events, (_, speed), loss = drop(tips, places, heights, 5e-6, 6e-10, 0.01, 40e-9)
    assert [(kind, a) for _, kind, a, _ in events] == [
        (event["kind"], event["asperity"]) for event in expected["events"]
    ]
    for (t, _, _, v), event in zip(events, expected["events"], strict=True):
        assert t == pytest.approx(event["t"], rel=1e-10, abs=0)
        assert v == pytest.approx(event["speed"], rel=1e-9, abs=0)
    assert 6e-10 * speed**2 == pytest.approx(6e-10 * 0.01**2 - 2.0 * loss, rel=1e-9, abs=0)
