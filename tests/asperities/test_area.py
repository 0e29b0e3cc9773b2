"""Contact areas of asperities: closed forms and limits, their quadrature, tables, and laws that have none."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy import integrate, optimize

import gearidae as gd
from gearidae.asperities import law_class, register, unregister
from gearidae.asperities.area import ContactArea
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.dmt import Dmt
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.jkr import Jkr
from gearidae.asperities.maugis import Maugis
from gearidae.contact.kernels.single import asperity_table, asperity_value

HIGH = gd.preset("teodorescu2009")
LAWS = [
    Hertz(),
    Dmt(0.7),
    Jkr(0.7),
    Maugis(1.0, 0.3),  # detaches without touching
    Maugis(1.0, 0.95),  # ceases to touch just before it detaches
    Maugis(0.8, 5.0),
]
SHEAR = {"contact.friction_law": "shear", "contact.shear_strength": 1e7}


def contact_radius(zone, displacement):
    """A of Maugis' equations where the tip touches: the first ratio m = C/A from 1 on that has this displacement."""

    def radius(m):
        root, angle = math.sqrt(m * m - 1.0), math.acos(1.0 / m)
        square = 0.5 * zone * (root + (m * m - 2.0) * angle)
        linear = 4.0 / 3.0 * zone**2 * (root * angle - m + 1.0)
        return (-linear + math.sqrt(linear**2 + 4.0 * square)) / (2.0 * square)

    def excess(m):
        a = radius(m)
        return a**2 - 4.0 / 3.0 * zone * a * math.sqrt(m * m - 1.0) - displacement

    ratios = 1.0 + np.geomspace(1e-4, 1e3, 4000)
    first = int(np.flatnonzero([excess(m) < 0.0 for m in ratios])[0])
    return radius(optimize.brentq(excess, ratios[first - 1], ratios[first], xtol=1e-15, rtol=1e-15))


@pytest.mark.parametrize("zone", [0.3, 0.95, 5.0])
@pytest.mark.parametrize("displacement", [0.5, 2.0, 6.0])
def test_the_area_of_a_tip_with_a_zone_is_that_within_it(zone, displacement):
    """Against Maugis' two equations in the form in which he gives them."""
    area = float(Maugis(1.0, zone).area(displacement))
    assert area == pytest.approx(contact_radius(zone, displacement) ** 2, rel=1e-9, abs=0)


def test_limits_of_the_area():
    """JKR's for soft tips, and for rigid ones that of Hertz, in the units of adhesion."""
    place = np.linspace(-0.7, 5.0, 9)
    jkr, near = gd.contact.asperity("jkr"), gd.contact.asperity("maugis", tabor=2000.0)
    np.testing.assert_allclose(near.area(place), jkr.area(place), rtol=1e-3)
    compressed = np.linspace(0.5, 5.0, 7)
    stiff = Maugis(1.0, 1e-9)
    np.testing.assert_allclose(stiff.area(compressed), compressed, rtol=1e-3)
    np.testing.assert_array_equal(Hertz().area(compressed), compressed)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_the_rule_of_the_area_is_its_integral(law):
    """Between displacements on either side of where the tip touches."""
    x, w = np.polynomial.legendre.leggauss(40)
    low, high = -law.detach, 2.0
    _, weight = law.area_nodes(np.array(low), np.array(high), x, w)
    points = [law.touch] if low < law.touch < high else None
    whole = integrate.quad(lambda d: float(law.area(d)), low, high, points=points, limit=400, epsabs=1e-12)[0]
    # a kink at 0 of laws that join at touch is beyond any rule across it
    assert weight.sum() == pytest.approx(whole, rel=1e-7, abs=0)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_tables_of_single_asperities_hold_the_area(law):
    table = asperity_table(ContactArea(law), 10.0)
    for displacement in np.linspace(-law.detach, 9.0, 60):
        computed = asperity_value(table, 0, float(displacement))[0]
        assert computed == pytest.approx(float(law.area(displacement)), abs=1e-8)


class WithoutAdhesion(AsperityLaw):
    """What laws of one's own without adhesion have in common."""

    @classmethod
    def of(cls, tip, unit):
        return cls()

    @property
    def detach(self):
        return 0.0

    @property
    def pull_off(self):
        return 0.0


def test_laws_without_an_area_are_refused_by_name():
    @register
    @dataclass(frozen=True)
    class Block(WithoutAdhesion):
        """A law that has no contact area."""

        name: ClassVar[str] = "block"

        def load(self, displacement):
            return 0.5 * np.maximum(displacement, 0.0) ** 1.5

    try:
        assert not law_class("block").has_area()
        with pytest.raises(gd.SceneError, match="must be one of dmt, hertz, jkr, maugis, meniscus") as error:
            HIGH.replace(SHEAR | {"contact.asperity": "block"})
        assert error.value.key == "contact.friction_law"
        with pytest.raises(NotImplementedError, match="block has no contact area"):
            Block().area(0.0)
    finally:
        unregister("block")


def test_a_law_that_brings_an_area_rubs_by_it():
    """A law of one's own, with Hertz's load and half of his area: half of the friction."""

    @register
    @dataclass(frozen=True)
    class Halved(WithoutAdhesion):
        """Hertz's law on half of the area."""

        name: ClassVar[str] = "halved"

        def load(self, displacement):
            return np.maximum(displacement, 0.0) ** 1.5

        def area(self, displacement):
            return 0.5 * np.maximum(displacement, 0.0)

    try:
        short = HIGH.replace(
            SHEAR
            | {"run.duration": 1e-6, "run.samples": "off", "initial.gap": 1.5e-8, "drive.harmonic": None}
        )
        losses = [
            gd.simulate(short.replace({"contact.asperity": name, "contact.shear_strength": strength}))
            for name, strength in (("halved", 2e7), ("hertz", 1e7))
        ]
        ours, other = (float(ds.drive_friction_loss) for ds in losses)
        assert ours == pytest.approx(other, rel=1e-9, abs=0)
        assert ours > 0.0
    finally:
        unregister("halved")
