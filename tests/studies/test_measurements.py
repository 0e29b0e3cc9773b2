"""Numbers of the page on measurements that no other test holds: what one contact and one loss law can do."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ndtr

import gearidae as gd
from gearidae.contact import attraction_force, line_force, rough_pressure
from gearidae.wear import Exposure, loss_law

SCENE = gd.preset("teodorescu2009")
BARE, COATED = SCENE.surface, SCENE.coated_surface
DRAWN = gd.load_case("cases/microengine.toml").replace({"gears.face_width": "2 um"})


@pytest.mark.parametrize(("radius", "tension"), [(1e-6, 560e-9), (10e-6, 1780e-9)])
def test_the_mean_law_of_a_side_wall(radius, tension):
    """To the two or three digits of the page; a coated one never pulls."""
    gaps = np.linspace(-4.0, 12.0, 801) * 6e-9
    assert -line_force(gaps, math.inf, radius, 2e-6, BARE).min() == pytest.approx(tension, rel=0.01, abs=0)
    assert -line_force(gaps, math.inf, radius, 2e-6, COATED).min() < 1e-30


@pytest.mark.parametrize(("surface", "count"), [(BARE, 4.8), (COATED, 0.25)])
def test_asperities_in_touch_at_1_micronewton_on_20_by_20_micrometres(surface, count):
    area = 400e-12
    gap = brentq(lambda h: float(rough_pressure(h, 0.0, surface)) * area - 1e-6, 3.7 * 6e-9, 60e-9)
    touching = surface.asperity_density * area * float(ndtr(-gap / surface.roughness))
    assert touching == pytest.approx(count, rel=0.01, abs=0.005)


@pytest.mark.parametrize("pairs", [30, pytest.param(60, marks=pytest.mark.by_hand)])
def test_one_asperity_holds_and_its_pull_off_is_that_of_the_side_wall(pairs):
    """1.5 pi beta W = 30.2 nN; as many pairs hold by one alone as 96 in a hundred allow."""
    ds = gd.studies.pull_off(DRAWN, pairs, load=1e-6)
    assert np.quantile(ds.pull_off.values, (0.1, 0.5, 0.9)) == pytest.approx(
        np.full(3, 1.5 * math.pi * 160e-9 * 0.04), rel=1e-9, abs=0
    )
    assert (ds.asperities_holding == 1).mean() > 0.85
    spread = DRAWN.replace({"contact.roughness": "discrete", "contact.radius_spread": 0.3})
    low, high = np.quantile(gd.studies.pull_off(spread, pairs, load=1e-6).pull_off.values, (0.1, 0.9))
    assert low < 24e-9 < 38e-9 < high


def test_the_low_speed_drive_is_far_below_what_the_model_leaves_out():
    rows = gd.studies.validity(gd.preset("teodorescu2009_low_speed"))
    times = rows.number["attraction"] / rows.number["attraction_behind"]
    assert rows.number["attraction"] == pytest.approx(111e-12, rel=0.01, abs=0)
    assert times == pytest.approx((163.55 / 36.45) ** 2.5, rel=0.01, abs=0)
    assert "855 times that force" in rows.verdict["attraction"]
    assert float(attraction_force(36e-9, 5e-6, 2e-6, 5e-20)) == pytest.approx(-80e-12, rel=0.01, abs=0)
    device = gd.studies.validity(gd.load_case("cases/microengine.toml"))
    assert device.number["net_adhesion"] == 0.0
    assert device.number["attraction"] < 0.002 * device.bound["net_adhesion"]


def decades(law, spread=0.0):
    """Rise of the bare share in the three decades after its first 5 %, of impacts that stay alike.

    `spread` is the standard deviation of the logarithm of the rates among places.
    """
    z = np.linspace(-6.0, 6.0, 61)
    weight, rates = np.exp(-0.5 * z**2) / np.exp(-0.5 * z**2).sum(), np.exp(spread * z)
    ones = np.ones_like(rates)
    exposure = Exposure(rates, rates, rates, ones)

    def change(logarithm, fraction):  # d/d ln N
        return math.exp(logarithm) * law.rate(np.clip(fraction, 0.0, 1.0), exposure)

    times = np.linspace(math.log(1e-6), math.log(1e5), 2201)
    solution = solve_ivp(
        change, (times[0], times[-1]), ones, t_eval=times, method="LSODA", rtol=1e-8, atol=1e-10
    )
    bare = 1.0 - weight @ np.clip(solution.y, 0.0, 1.0)
    onset = np.interp(0.05, bare, times)
    return np.diff(np.interp(onset + math.log(10.0) * np.arange(4), times, bare))


@pytest.mark.parametrize(
    ("law", "spread", "expected"),
    [
        (loss_law("contacts", area=1.0), 0.0, [0.35, 0.59, 0.006]),
        (loss_law("adhesion_work", energy=1.0), 0.0, [0.35, 0.59, 0.006]),
        (loss_law("sliding_work", coefficient=1.0), 0.0, [0.45, 0.50, 0.0]),
        (loss_law("contacts", area=1.0), 2.0, [0.18, 0.36, 0.30]),
    ],
)
def test_no_law_is_logarithmic_in_impacts_unless_places_differ(law, spread, expected):
    """First order: 1 - 0.95^10 = 0.401 after a decade, in closed form; the rest to the digits of the page."""
    rise = decades(law, spread)
    assert rise == pytest.approx(expected, rel=0, abs=0.006)
    if spread == 0.0 and law.name != "sliding_work":
        assert rise[0] == pytest.approx(0.95 - 0.95**10, rel=0, abs=1e-4)
