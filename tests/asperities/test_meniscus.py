"""Asperities in humid air: the closed forms of one meniscus, checked numbers of a line, and its tables."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

import gearidae as gd
from gearidae.asperities import law_of, law_of_tip
from gearidae.asperities.dmt import Dmt
from gearidae.asperities.meniscus import TENSION, kelvin_radius
from gearidae.asperities.tip import asperity_of
from gearidae.contact.heights import heights_of
from gearidae.contact.kernels.law import law_table, law_value
from gearidae.contact.psi import psi

HIGH = gd.preset("teodorescu2009").replace({"contact.bodies": "rigid"})
HUMID = {"contact.asperity": "meniscus", "surface.humidity": 0.5}


def wet(humidity, **keys):
    return HIGH.surface.model_copy(update={"humidity": humidity, **keys})


@pytest.mark.parametrize(
    ("humidity", "radius"), [(0.5, 0.757175e-9), (0.8, 2.352e-9), (0.9, 4.98131e-9), (0.95, 10.232e-9)]
)
def test_kelvin_radius(humidity, radius):
    """Checked numbers, to the digits given."""
    assert kelvin_radius(humidity) == pytest.approx(radius, rel=2e-6, abs=0)


@pytest.mark.parametrize(
    ("humidity", "gap", "stretch", "load"),
    [
        (0.5, 3, 0.0, 6.578135e-7),
        (0.5, 3, 1.0, 6.332500e-7),
        (0.8, 3, 0.75, 5.357836e-7),
        (0.8, 4, 1.0, 4.158579e-9),
        (0.95, 3, 1.0, -9.057407e-6),
    ],
)
def test_a_line_has_the_checked_loads(humidity, gap, stretch, load):
    """At the given stretch, by parting and by forming there: the digits of an independent prototype."""
    surface = wet(humidity, bridged=0.0)
    reach = 2.0 * kelvin_radius(humidity)
    apart = gd.contact.line_force(gap * 6e-9, stretch * reach, 5e-6, 2e-6, surface, "meniscus")
    assert apart == pytest.approx(load, rel=2e-7, abs=0)
    formed = gd.contact.line_force(gap * 6e-9, 0.0, 5e-6, 2e-6, wet(humidity, bridged=stretch), "meniscus")
    assert formed == pytest.approx(float(apart), rel=1e-11, abs=0)


@given(humidity=st.floats(0.01, 0.99), angle=st.floats(0.0, 1.5), share=st.floats(0.0, 1.0))
def test_one_meniscus_by_its_closed_forms(humidity, angle, share):
    surface = wet(humidity, contact_angle=angle, bridged=share)
    tip = asperity_of(surface)
    law = law_of_tip("meniscus", tip, 1.0)  # in metres
    reach, pull = (
        2.0 * kelvin_radius(humidity) * math.cos(angle),
        4.0 * math.pi * 450e-9 * TENSION * math.cos(angle),
    )
    newtons = tip.hertz_factor
    assert law.detach == pytest.approx(reach, rel=1e-12, abs=0)
    assert law.join == pytest.approx(share * reach, rel=1e-12, abs=0)
    assert newtons * law.pull_off == pytest.approx(pull, rel=1e-12, abs=0)
    assert newtons * float(law.load(np.array(-0.25 * reach))) == pytest.approx(-0.75 * pull, rel=1e-12, abs=0)
    assert newtons * law.loss / (pull * reach) == pytest.approx(0.5 * (1.0 - share) ** 2, rel=1e-9, abs=1e-14)
    deep = 3e-9
    hertz = newtons * 0.4 * deep**2.5
    assert newtons * float(law.energy(np.array(deep))) == pytest.approx(
        hertz - pull * (0.5 * reach + deep), rel=1e-9, abs=0
    )
    # the rule of quadrature gives the same energy as the closed form
    nodes = law.nodes(np.array([-reach]), np.array([deep]), *np.polynomial.legendre.leggauss(48))[1]
    assert float(nodes.sum()) == pytest.approx(float(law.energy(np.array(deep))), rel=1e-10, abs=0)
    area = law.area_nodes(np.array([-reach]), np.array([deep]), *np.polynomial.legendre.leggauss(48))[1]
    assert float(area.sum()) == pytest.approx(
        quad(lambda d: max(d, 0.0), -reach, deep, points=[0.0])[0], rel=1e-6, abs=0
    )


def test_hydrophobic_places_are_dry():
    """From 90 degrees on DMT's law, with the dry pull of the surface."""
    for angle in (math.radians(90), math.radians(110), math.pi):
        assert isinstance(law_of("meniscus", wet(0.5, contact_angle=angle)), Dmt)
    scene = HIGH.replace({**HUMID, "coating.sam_fraction": 0.5, "coating.pairing": "independent"})
    laws = {part.name: law_of("meniscus", part.surface) for part in scene.materials()}
    assert isinstance(laws["coated"], Dmt)
    # between unlike flanks a meniscus is drawn by the mean of the cosines of 0 and 110 degrees
    assert laws["mixed"].pull / laws["bare"].pull == pytest.approx(
        0.5 * (1.0 + math.cos(math.radians(110.0)))
    )


@pytest.mark.parametrize("humidity", [0.5, 0.95])
@pytest.mark.parametrize("bridged", [0.0, 0.75, 1.0])
def test_the_tables_hold_it(humidity, bridged):
    """Of the integral of the absolute load, as of every law with a kink."""
    surface = wet(humidity, bridged=bridged)
    heights = heights_of(surface, "meniscus")
    table = law_table(heights.law).copy()
    rng = np.random.default_rng(0)
    gap, stretch = rng.uniform(-8.0, 8.0, 200), rng.uniform(0.0, heights.law.detach - heights.law.join, 200)
    right = heights.integral(psi, gap, stretch + heights.law.join, decays_left=False)
    dry = heights_of(surface.model_copy(update={"humidity": None}), "hertz").integral(
        psi, gap, 0.0 * gap, decays_left=False
    )
    found = np.array([law_value(table, g, g - s)[0] for g, s in zip(gap, stretch, strict=True)])
    assert np.max(np.abs(found - right) / (np.abs(dry) + np.abs(right - dry))) < 1e-8


def test_the_keys_go_together():
    with pytest.raises(gd.SceneError, match=r"surface\.humidity = \(missing\): is required"):
        HIGH.replace({"contact.asperity": "meniscus"})
    with pytest.raises(
        gd.SceneError, match=r"surface\.humidity = 0\.5: has no effect with contact\.asperity = \"jkr\""
    ):
        HIGH.replace({"surface.humidity": 0.5})
    with pytest.raises(gd.SceneError, match="attract twice"):
        HIGH.replace({**HUMID, "coating.sam_fraction": 0.5, "surface.hamaker": 5e-20})
    with pytest.raises(gd.SceneError, match="menisci pull across the gap"):
        HIGH.replace({**HUMID, "contact.bodies": "elastic"})
    with pytest.raises(gd.SceneError, match=r"asperities join|asperities stretch"):
        HIGH.replace({**HUMID, "surface.humidity": 0.98, "coating.sam_fraction": 0.0})


def test_menisci_that_merge_are_a_row_of_validity():
    def row(humidity):
        scene = HIGH.replace({**HUMID, "surface.humidity": humidity, "coating.sam_fraction": 0.5})
        return gd.studies.validity(scene).loc["menisci_bare"]

    assert row(0.5).holds
    assert not row(0.95).holds


def test_humid_air_makes_bare_flanks_less_sticky_than_broken_silicon():
    """One asperity by 15.6, the energy of the surface by 20.8; a rough line below 80 % by far more."""
    dry = asperity_of(HIGH.surface)
    bridge = law_of_tip("meniscus", asperity_of(wet(0.5)), 1.0).pull_off * dry.hertz_factor
    assert dry.pull_off / bridge == pytest.approx(3.0 * 1.5 / (4.0 * TENSION), rel=1e-9)
    assert dry.pull_off / bridge == pytest.approx(15.6, abs=0.05)
    assert HIGH.surface.energy / TENSION == pytest.approx(20.8, abs=0.05)
    gaps = np.linspace(-1.0, 8.0, 181) * HIGH.surface.roughness

    def pull(surface, stretch, law):
        return -gd.contact.line_force(gaps, stretch, 5e-6, 2e-6, surface, law).min()

    broken = pull(HIGH.surface, dry.stretch_limit, "jkr")
    assert broken == pytest.approx(1.257e-6, rel=1e-3)
    for humidity in (0.3, 0.5, 0.7, 0.8):
        assert pull(wet(humidity), 0.0, "meniscus") < 1e-4 * broken


@pytest.mark.parametrize(
    ("humidity", "mean", "slowest", "later"),
    [(0.5, 2892.1, 2424.1, 2638.4), (0.9, 2891.6, 2283.1, 2642.0), (0.95, 2859.5, 155.1, 2443.5)],
)
def test_fast_bare_gears_in_humid_air_run_as_the_page_says(humidity, mean, slowest, later):
    """As coated ones, 2892.1 rad/s, up to 90 %; at 95 % they are pulled together at the first touch."""
    ds = gd.simulate(
        HIGH.replace({**HUMID, "surface.humidity": humidity, "coating.sam_fraction": 0.0, "run.rtol": 1e-7})
    )
    assert float(ds.gear_speed.mean()) == pytest.approx(mean, abs=0.1)
    assert float(ds.min_gear_speed) == pytest.approx(slowest, abs=0.1)
    assert float(ds.gear_speed.sel(time=slice(10e-6, None)).min()) == pytest.approx(later, abs=0.2)
