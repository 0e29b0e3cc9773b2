"""Calibration: posteriors that are known in closed form, and of gears that stick."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import gearidae as gd
from gearidae.calibration.declared.predict import posterior_draws
from gearidae.calibration.posterior import LEVELS
from gearidae.studies import Observation

LOW = gd.preset("teodorescu2009_low_speed")
SHORT = LOW.replace({"run.duration": 0.05})
COVERAGE = {"coating.sam_fraction": stats.uniform(0.4, 0.25)}
TORQUE = "drive.torque"


def torque(scene):
    """A model that needs no run: the torque in aN m."""
    return 1e18 * scene.drive.torque


def difference(scene):
    return 1e18 * scene.drive.torque - scene.initial.gear_speed


def normal_posterior(mean, deviation, seen, uncertainty):
    """Product of two normal densities."""
    precision = 1.0 / deviation**2 + len(seen) / uncertainty**2
    return (mean / deviation**2 + sum(seen) / uncertainty**2) / precision, precision**-0.5


@pytest.fixture(scope="module")
def seen():
    return [Observation(of=torque, value=value, uncertainty=0.3) for value in (4.2, 4.5, 4.4)]


def test_a_normal_prior_and_normal_errors_make_a_normal_posterior(seen):
    """The grid integrates a Gaussian by equal cells: spectrally, but for the 0.04 % of the prior left out."""
    posterior = gd.studies.calibrate(LOW, {TORQUE: stats.norm(5e-18, 5e-19)}, seen, points=61)
    mean, deviation = normal_posterior(5.0, 0.5, [4.2, 4.5, 4.4], 0.3)
    assert float(posterior["mean"][0]) == pytest.approx(1e-18 * mean, rel=1e-4, abs=0)
    assert float(posterior.standard_deviation[0]) == pytest.approx(1e-18 * deviation, rel=2e-3, abs=0)
    exact = 1e-18 * stats.norm(mean, deviation).ppf(LEVELS)
    np.testing.assert_allclose(posterior.quantiles[0], exact, atol=0.02 * 1e-18 * deviation)
    assert float(posterior.weight.sum()) == pytest.approx(1.0, rel=1e-12)


def test_a_posterior_finer_than_its_grid_has_the_spread_of_a_cell(caplog):
    look = Observation(of=torque, value=5.01, uncertainty=1e-6)
    posterior = gd.studies.calibrate(LOW, {TORQUE: stats.uniform(4e-18, 2e-18)}, [look], points=41)
    cell = float(np.diff(posterior.torque[:2])[0])
    assert float(posterior.standard_deviation[0]) == pytest.approx(cell / np.sqrt(12.0), rel=1e-6, abs=0)
    assert "narrower than a cell" in caplog.text
    assert "no run comes near" not in caplog.text


def test_an_observation_beyond_every_run_is_named(caplog):
    look = Observation(of=torque, value=50.0, uncertainty=0.1)
    gd.studies.calibrate(LOW, {TORQUE: stats.uniform(4e-18, 2e-18)}, [look], points=41)
    assert "no run comes near torque = 50: theirs are 4.0" in caplog.text
    assert f"the most likely {TORQUE} is at the edge of its prior" in caplog.text


def test_two_keys_that_only_their_difference_is_seen_of_are_correlated():
    """Prior unit normals, one look at x - y: covariance (I + a a^T / u^2)^-1 with a = (1, -1)."""
    priors = {TORQUE: stats.norm(5e-18, 1e-18), "initial.gear_speed": stats.norm(6.0, 1.0)}
    posterior = gd.studies.calibrate(
        LOW, priors, [Observation(of=difference, value=-0.5, uncertainty=0.5)], points=41
    )
    a = np.array([[1.0], [-1.0]])
    covariance = np.linalg.inv(np.eye(2) + a @ a.T / 0.25)
    mean = np.array([5.0, 6.0]) + covariance @ a[:, 0] / 0.25 * (-0.5 + 1.0)
    np.testing.assert_allclose(posterior["mean"] / [1e-18, 1.0], mean, rtol=2e-3)
    np.testing.assert_allclose(
        posterior.standard_deviation / [1e-18, 1.0], np.sqrt(np.diag(covariance)), rtol=1e-2
    )
    x, y = xr.broadcast(1e18 * posterior.torque, posterior.initial_gear_speed)
    shared = float((posterior.weight * (x - mean[0]) * (y - mean[1])).sum())
    assert shared == pytest.approx(covariance[0, 1], rel=2e-2)


def test_the_sampler_finds_the_same(seen):
    """6,000 draws, one in 54 of them independent: the mean to 0.1 of the deviation, that to 7 %."""
    pytest.importorskip("emcee")
    priors = {
        TORQUE: stats.norm(5e-18, 5e-19),
        "initial.gear_speed": stats.uniform(1.0, 1.0),
        "load.drag": stats.lognorm(0.1, scale=8e-18),
    }
    posterior = gd.studies.calibrate(LOW, priors, seen, steps=500, seed=3)
    short = [
        gd.studies.calibrate(LOW, priors, seen, steps=20, seed=3, method=method)
        for method in ("auto", "emcee")
    ]
    assert np.array_equal(short[0].torque, short[1].torque)
    mean, deviation = normal_posterior(5.0, 0.5, [4.2, 4.5, 4.4], 0.3)
    assert float(posterior["mean"][0]) == pytest.approx(1e-18 * mean, abs=0.25 * 1e-18 * deviation)
    assert float(posterior.standard_deviation[0]) == pytest.approx(1e-18 * deviation, rel=0.15, abs=0)
    assert float(posterior["mean"][1]) == pytest.approx(1.5, abs=0.08)  # nothing was seen of it: its prior
    assert float(posterior.initial_gear_speed.min()) >= 1.0
    assert float(posterior.initial_gear_speed.max()) <= 2.0
    assert 0.1 < posterior.attrs["acceptance"] < 0.9
    draws = posterior_draws(posterior, 500, seed=1)
    assert draws[TORQUE].std() == pytest.approx(1e-18 * deviation, rel=0.2, abs=0)


def test_without_the_sampler_it_says_what_to_install(seen, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "emcee", None)
    with pytest.raises(gd.SceneError, match=r"gearidae\[calibrate\]"):
        gd.studies.calibrate(LOW, {TORQUE: stats.norm(5e-18, 5e-19)}, seen, method="emcee")


@pytest.fixture(scope="module")
def coverage():
    """Two gears that differ in speed at the start; nobody knows their coverage."""
    stuck = [Observation(value=True, misjudged=0.01), Observation(value=True, conditions={TORQUE: 4.2e-18})]
    return gd.studies.calibrate(LOW, COVERAGE, stuck, points=5), stuck


def test_gears_that_stuck_say_that_the_coverage_is_low(coverage):
    """Of a uniform prior the weights are the likelihoods: 0.99 or 0.01 by one run, 0.98 or 0.02 by the other."""
    posterior, _ = coverage
    likelihood = np.ones(5)
    for value, share in ((4.5e-18, 0.01), (4.2e-18, 0.02)):
        runs = gd.sweep(
            LOW.replace({TORQUE: value}), {"coating.sam_fraction": posterior.sam_fraction.values}, keep=[]
        )
        likelihood *= np.where(np.isin(runs.verdict, ("sticks", "runs back")), 1.0 - share, share)
    assert 0 < (likelihood > 0.5).sum() < 5
    np.testing.assert_allclose(posterior.weight, likelihood / likelihood.sum(), rtol=1e-9)
    assert posterior.attrs["calibration"].count('"of": "sticks"') == 2


def test_predictions_are_runs_with_draws_from_the_posterior(coverage):
    posterior, _ = coverage
    ds = gd.studies.predict(SHORT, posterior, 12, seed=5)
    drawn = posterior_draws(posterior, 12, seed=5)["coating.sam_fraction"]
    assert np.array_equal(ds.sam_fraction, drawn)
    assert float(ds.isel(member=3).min_gear_speed) == float(
        gd.simulate(SHORT.replace({"coating.sam_fraction": drawn[3]})).min_gear_speed
    )
    assert int(gd.studies.sticking_probability(ds).members) == 12
    many = posterior_draws(posterior, 20_000, seed=1)["coating.sam_fraction"]
    assert many.mean() == pytest.approx(float(posterior["mean"][0]), abs=4.0 * many.std() / np.sqrt(20_000))


def test_a_ring_frequency_finds_the_stiffness_that_made_it():
    """The frequency of a run at a coverage of 0.85 is given back to the calibration: the posterior holds 0.85."""
    scene = LOW.replace({"run.duration": 0.06, "run.samples": 6001})
    run = gd.simulate(scene.replace({"coating.sam_fraction": 0.85}))
    measured = float(gd.analysis.characteristic_frequency(run))
    rung = Observation(of="ring_frequency", value=f"{measured / 1e3} kHz", uncertainty="50 Hz")
    posterior = gd.studies.calibrate(scene, {"coating.sam_fraction": "uniform(0.7, 1)"}, [rung], points=12)
    assert abs(float(posterior["mean"][0]) - 0.85) < 2.0 * float(posterior.standard_deviation[0]) + 0.0125
    assert float(posterior.standard_deviation[0]) < 0.06  # of the prior it was 0.087


def test_an_unfinished_run_says_nothing_and_no_ring_is_impossible():
    stuck = Observation(value=True, misjudged=0.1)
    likelihoods = np.exp(stuck.log_likelihood(np.array([1.0, 0.0, np.nan])))
    np.testing.assert_allclose(likelihoods, [0.9, 0.1, 0.5], rtol=1e-12)
    rung = Observation(of="ring_frequency", value=5e3, uncertainty=100.0)
    density = np.exp(rung.log_likelihood(np.array([5.1e3, np.nan])))
    np.testing.assert_allclose(density, [stats.norm(5e3, 100.0).pdf(5.1e3), 0.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        ({"value": 1.0}, "value"),
        ({"value": True, "misjudged": 0.0}, "misjudged"),
        ({"value": 5e3, "of": "ring_frequency"}, "uncertainty"),
        ({"value": "5 km", "of": "ring_frequency", "uncertainty": "1 Hz"}, "value"),
        ({"value": np.nan, "of": torque, "uncertainty": 1.0}, "value"),
        ({"value": 1.0, "of": torque, "uncertainty": 0.0}, "uncertainty"),
        ({"value": 1870.0, "of": "ring_frequency", "uncertainty": "0.01 kHz"}, "uncertainty"),
        ({"value": True, "misjudged": "50.1 %"}, "misjudged"),
        ({"value": True, "misjudged": True}, "misjudged"),
        ({"value": True, "conditions": 3}, "conditions"),
        ({"value": True, "of": 3}, "of"),
    ],
)
def test_bad_observations(settings, key):
    with pytest.raises(gd.SceneError) as refused:
        Observation(**settings)
    assert refused.value.key == key


STUCK = Observation(value=True)
RUNG = Observation(of="ring_frequency", value=5e3, uncertainty=1e2, conditions={"run.duration": 0.1})


@pytest.mark.parametrize(
    ("priors", "observations", "settings", "key"),
    [
        (COVERAGE, [], {}, "observations"),
        (COVERAGE, [True], {}, "observations"),
        (COVERAGE, [Observation(of="min_gear_sped", value=1.0, uncertainty=1.0)], {}, "of"),
        (COVERAGE, [Observation(value=True, conditions={"coating.sam_fraction": 0.5})], {}, "conditions"),
        (
            COVERAGE,
            [Observation(value=True, conditions={"coating.sam_frction": 0.5})],
            {},
            "coating.sam_frction",
        ),
        (COVERAGE, [STUCK], {"method": "nuts"}, "method"),
        (COVERAGE, [RUNG], {}, "conditions"),
        (COVERAGE, [STUCK], {"points": 2}, "points"),
        ({"drive.torque": stats.randint(1, 5)}, [STUCK], {}, "drive.torque"),
        ({"coating.sam_fraction": "normal(0.9, 0.1)"}, [STUCK], {}, "coating.sam_fraction"),
        (COVERAGE, [Observation(of=torque, value=1e6, uncertainty=1e-160)], {}, "observations"),
    ],
)
def test_bad_requests_are_refused(priors, observations, settings, key):
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.calibrate(SHORT, priors, observations, **({"points": 5} | settings))
    assert refused.value.key == key


def test_what_is_no_posterior():
    with pytest.raises(gd.SceneError, match="posterior"):
        gd.studies.predict(SHORT, xr.Dataset(), 4)
