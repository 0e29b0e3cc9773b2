"""Distributions as texts, designs, and Sobol' indices of functions whose indices are known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

import gearidae as gd
from gearidae.studies.design import DESIGNS, check_design, pick_freeze_design, plain_design
from gearidae.studies.distributions import Distribution, read_distribution, read_distributions
from gearidae.studies.indices import indices_of

LOW = gd.preset("teodorescu2009_low_speed")


def of_functions(*frozen):
    return [Distribution(f"x{number}", "of a test", function) for number, function in enumerate(frozen)]


@pytest.mark.parametrize(
    ("text", "frozen"),
    [
        ("normal(450 nm, 50 nm)", stats.norm(450e-9, 50e-9)),
        ("Normal( 0.45um,50nm )", stats.norm(450e-9, 50e-9)),
        ("uniform(400 nm, 0.5 um)", stats.uniform(400e-9, 100e-9)),
        ("lognormal(450 nm, 1.2)", stats.lognorm(np.log(1.2), scale=450e-9)),
        ("truncnormal(450 nm, 50 nm, 400 nm, 600 nm)", stats.truncnorm(-1.0, 3.0, 450e-9, 50e-9)),
    ],
)
def test_texts_with_units_are_the_distributions_of_scipy(text, frozen):
    (distribution,) = read_distributions(LOW, {"surface.asperity_radius": text})
    share = np.linspace(0.01, 0.99, 7)
    np.testing.assert_allclose(distribution.quantiles(share), frozen.ppf(share), rtol=1e-12)
    values = frozen.ppf(share)
    np.testing.assert_allclose(distribution.log_density(values), frozen.logpdf(values), rtol=1e-9)


@pytest.mark.parametrize(
    ("text", "frozen"),
    [
        ("normal(25 degC, 2 degC)", stats.norm(298.15, 2.0)),
        ("truncnormal(77 degF, 9 degF, 20 degC, 30 degC)", stats.truncnorm(-1.0, 1.0, 298.15, 5.0)),
        ("uniform(20 degC, 30 degC)", stats.uniform(293.15, 10.0)),
    ],
)
def test_a_spread_of_temperatures_has_no_zero(text, frozen):
    """Quantiles to 1e-12: sums with 273.15 are rounded."""
    share = np.linspace(0.01, 0.99, 7)
    distribution = read_distribution("temperature", text, "K")
    np.testing.assert_allclose(distribution.quantiles(share), frozen.ppf(share), rtol=1e-12)


def test_a_lognormal_has_two_thirds_within_its_geometric_deviation():
    (distribution,) = read_distributions(LOW, {"surface.energy": "lognormal(1.5 J/m^2, 1.2)"})
    within = distribution.frozen.cdf(1.5 * 1.2) - distribution.frozen.cdf(1.5 / 1.2)
    assert within == pytest.approx(stats.norm.cdf(1.0) - stats.norm.cdf(-1.0), rel=1e-12)
    assert distribution.frozen.median() == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize(
    ("key", "text", "words"),
    [
        ("surface.asperity_radius", "normal(450 nm, 50 J)", "standard deviation"),
        ("surface.asperity_radius", "normal(450 nm, 5e-8)", "5e-8 has no unit beside 450 nm"),
        ("drive.torque", "uniform(4.4 aN m, 4.6)", "4.6 has no unit beside 4.4 aN m"),
        (
            "drive.torque",
            "truncnormal(4.5e-18, 0.1 aN m, 4 aN m, 5 aN m)",
            "4.5e-18 has no unit beside 0.1 aN m",
        ),
        ("coating.sam_fraction", "uniform(0.5, 60 %)", "0.5 has no unit beside 60 %"),
        ("surface.asperity_radius", "normal(450 nm)", "2 values, not 1"),
        ("surface.asperity_radius", "normal(450 nm, -1 nm)", "above 0"),
        ("surface.asperity_radius", "normal(nan, 1 nm)", "standard deviation"),
        ("surface.asperity_radius", "uniform(2 nm, 1 nm)", "lowest below highest"),
        ("surface.asperity_radius", "lognormal(450 nm, 50 nm)", "geometric"),
        ("surface.asperity_radius", "lognormal(450 nm, 0.9)", "above 1"),
        ("surface.asperity_radius", "norml(450 nm, 50 nm)", "did you mean normal"),
        ("surface.asperity_radius", "450 nm", "normal(mean"),
        ("surface.asperity_radius", "normal(1, 2); import os", "must be one of"),
        ("surface.asperity_radius", 450e-9, "scipy.stats"),
        ("surface.asperity_radius", "truncnormal(1 nm, 1 nm, 3 nm, 2 nm)", "lowest below highest"),
        ("surface.asprity_radius", "normal(450 nm, 50 nm)", "did you mean"),
        ("contact.bodies", "uniform(0, 1)", "no key of a number"),
        ("run.duration", "uniform(0.1, 0.2)", "same time"),
    ],
)
def test_malformed_distributions_name_the_key_and_what_is_allowed(key, text, words):
    with pytest.raises(gd.SceneError) as refused:
        read_distributions(LOW, {key: text})
    assert refused.value.key == key
    assert words in str(refused.value)


@pytest.mark.parametrize("vary", [{}, None, "normal(1, 2)"])
def test_nothing_to_vary(vary):
    with pytest.raises(gd.SceneError, match="vary"):
        read_distributions(LOW, vary)


@pytest.mark.parametrize("design", DESIGNS)
def test_marginals_are_the_distributions_and_the_seed_decides(design):
    """500 members; Kolmogorov and Smirnov's distance exceeds 0.073 in one of a hundred random draws."""
    distributions = of_functions(stats.norm(3.0, 2.0), stats.uniform(0.0, 5.0))
    made = plain_design(distributions, 500, design, seed=4)
    for column, distribution in zip(made.values.T, distributions, strict=True):
        assert stats.kstest(column, distribution.frozen.cdf).statistic < 0.073
    assert abs(np.corrcoef(made.values.T)[0, 1]) < 0.12  # 2.7 standard deviations of random draws
    assert np.array_equal(made.values, plain_design(distributions, 500, design, seed=4).values)
    assert not np.array_equal(made.values, plain_design(distributions, 500, design, seed=5).values)
    assert made.drawn.all()


def test_sobol_points_fill_evenly():
    (column,) = plain_design(of_functions(stats.uniform(0.0, 1.0)), 64, "sobol", seed=1).values.T
    assert np.array_equal(np.sort(np.floor(64 * column)), np.arange(64))  # one in each of 64 intervals


def test_a_pick_freeze_design_takes_one_column_from_the_other_matrix():
    made = pick_freeze_design(of_functions(*[stats.norm()] * 3), 16, "sobol", seed=2)
    blocks = made.values.reshape(5, 16, 3)
    for key in range(3):
        mixed = blocks[2 + key]
        assert np.array_equal(mixed[:, key], blocks[1][:, key])
        others = [number for number in range(3) if number != key]
        assert np.array_equal(mixed[:, others], blocks[0][:, others])
    assert made.matrix[::16].tolist() == ["A", "B", "AB0", "AB1", "AB2"]
    assert made.drawn.sum() == 32
    assert abs(np.corrcoef(blocks[0].ravel(), blocks[1].ravel())[0, 1]) < 0.5


def agrees(indices, first, total):
    """Within four of its own standard uncertainties, which are themselves below 0.06."""
    for values, spread, exact in (
        (indices.first_order, indices.first_order_uncertainty, first),
        (indices.total_order, indices.total_order_uncertainty, total),
    ):
        assert (np.abs(values - exact) <= 4.0 * spread).all()
        assert (spread < 0.06).all()


@pytest.mark.parametrize("design", DESIGNS)
def test_indices_of_a_linear_function(design):
    """f = sum a x of independent x: both indices are a^2 var(x) over their sum."""
    weights, deviations = np.array([1.0, -2.0, 0.5]), np.array([1.0, 1.0, 3.0])
    made = pick_freeze_design(
        of_functions(*(stats.norm(2.0, deviation) for deviation in deviations)), 1024, design, seed=1
    )
    exact = (weights * deviations) ** 2 / np.sum((weights * deviations) ** 2)
    agrees(indices_of(made.values @ weights, 3, seed=1), exact, exact)


@pytest.mark.parametrize("design", DESIGNS)
def test_indices_of_the_ishigami_function(design):
    """sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 (doi:10.1109/ISUMA.1990.151285): variances in closed form."""
    a, b = 7.0, 0.1
    alone = np.array([0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, 0.0])
    both = b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    variance = alone.sum() + both
    total = (alone + np.array([both, 0.0, both])) / variance
    made = pick_freeze_design(of_functions(*[stats.uniform(-np.pi, 2.0 * np.pi)] * 3), 2048, design, seed=6)
    x1, x2, x3 = made.values.T
    indices = indices_of(np.sin(x1) + a * np.sin(x2) ** 2 + b * x3**4 * np.sin(x1), 3, seed=6)
    agrees(indices, alone / variance, total)
    assert indices.rows == 2048


def test_a_single_key_has_all_of_the_variance():
    made = pick_freeze_design(of_functions(stats.norm()), 512, "sobol", seed=3)
    agrees_alone = indices_of(np.exp(made.values[:, 0]), 1, seed=3)
    assert agrees_alone.total_order[0] == pytest.approx(1.0, abs=0.1)
    assert agrees_alone.first_order[0] == pytest.approx(1.0, abs=0.2)


def test_a_figure_that_varies_by_rounding_has_no_indices():
    """A sum of the same numbers in other orders: it differs in its last places."""
    numbers = np.random.default_rng(3).normal(size=64)
    orders = [np.random.default_rng(seed).permutation(numbers) for seed in range(5 * 32)]
    figure = 1.0 + np.array([np.cumsum(order)[-1] for order in orders])
    assert np.ptp(figure) > 0.0
    indices = indices_of(figure, 3)
    assert np.isnan(indices.first_order).all()
    assert np.isnan(indices.total_order).all()
    assert np.isfinite(indices_of(1.0 + 1e-9 * numbers.repeat(5)[: 5 * 32], 3).total_order).all()


def test_rows_that_are_incomplete_do_not_count():
    """Of 64 rows one has failed: the first 32 complete ones are used, as if there were no others."""
    made = pick_freeze_design(of_functions(stats.norm(), stats.norm()), 64, "sobol", seed=3)
    figures = made.values @ [1.0, 2.0]
    figures[64 + 3] = np.nan  # row 3 of B
    indices = indices_of(figures, 2, seed=9)
    assert indices.rows == 32
    rows = [row for row in range(33) if row != 3]
    alone = indices_of(figures.reshape(4, 64)[:, rows].ravel(), 2, seed=9)
    assert np.array_equal(indices.total_order, alone.total_order)
    assert np.isnan(indices_of(np.full(256, 1.0), 2).total_order).all()  # nothing varies
    assert np.isnan(indices_of(np.full(256, np.nan), 2).first_order).all()


@pytest.mark.parametrize(
    ("size", "design", "seed", "indices", "key"),
    [
        (0, "sobol", 0, False, "size"),
        (2.5, "sobol", 0, False, "size"),
        (100, "sobol", 0, True, "size"),
        (1, "sobol", 0, True, "size"),
        (64, "latin", 0, False, "design"),
        (64, "sobol", -1, False, "seed"),
        (64, "sobol", None, False, "seed"),
    ],
)
def test_designs_that_cannot_be_made(size, design, seed, indices, key):
    with pytest.raises(gd.SceneError) as refused:
        check_design(size, design, seed, indices=indices)
    assert refused.value.key == key
