"""A law of one's own: springs that join before they touch and detach farther out, registered and simulated with."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from numba.core import event
from scipy import integrate, special

import gearidae as gd
from balances import assert_balanced
from gearidae.asperities import (
    AsperityLaw,
    asperity,
    asperity_load,
    law_names,
    law_of,
    register,
    unregister,
)
from gearidae.asperities.ranges import check_reach
from gearidae.asperities.tip import asperity_of, contact_modulus
from gearidae.contact.bulk import line_grid
from gearidae.contact.elastic import elastic_line_curve
from gearidae.contact.kernels.energy import energy_table, joining_energy, number_table, stretched_energy
from gearidae.contact.kernels.law import HEADER, law_table, law_value, loading_value
from gearidae.contact.kernels.layout import H_MODE, MODE_INTEGRATED, MODE_TABLE
from gearidae.contact.line import line_force
from gearidae.contact.psi import psi
from gearidae.contact.rough import adhesion_loss_per_asperity, rough_pressure
from gearidae.engine import solve
from gearidae.errors import SceneError

JOIN = 1e-9  # metres, of the springs of any surface


@dataclass(frozen=True)
class Spring(AsperityLaw):
    """A linear spring: load over displacement from letting go on, through zero, into compression."""

    name: ClassVar[str] = "spring"
    stiffness: float
    near: float
    far: float

    @classmethod
    def of(cls, tip, unit):
        """As stiff as pull-off load over stretch limit, which it stretches by beyond joining."""
        stiffness = tip.pull_off / tip.stretch_limit * unit / (tip.hertz_factor * unit**1.5)
        return cls(stiffness, JOIN / unit, (JOIN + tip.stretch_limit) / unit)

    @property
    def join(self):
        return self.near

    @property
    def detach(self):
        return self.far

    @property
    def pull_off(self):
        return self.stiffness * self.far

    def load(self, displacement):
        delta = np.asarray(displacement, dtype=np.float64)
        return np.where(delta < -self.far, 0.0, self.stiffness * delta)


@pytest.fixture
def spring():
    register(Spring)
    yield Spring
    unregister("spring")


def above(z):
    """Share of Gaussian heights above z."""
    return 0.5 * special.erfc(z / math.sqrt(2))


def density(z):
    return np.exp(-0.5 * z**2) / math.sqrt(2 * math.pi)


def closed_pressure(law, gap, stretch):
    """Closed form of ``int k Delta phi(H + Delta)`` from -S, and of the same for the load's absolute value."""

    def part(z):  # int_z k (y - H) phi(y) dy
        return law.stiffness * (density(z) - gap * above(z))

    return part(gap - stretch), 2 * part(gap) - part(gap - stretch)


def closed_energy(law, gap, stretch):
    """Closed form of ``int k/2 (Delta^2 - b^2) phi(H + Delta)`` from -S."""
    z = gap - stretch
    return 0.5 * law.stiffness * ((1 + gap**2 - law.far**2) * above(z) + (z - 2 * gap) * density(z))


# -- the registry ----------------------------------------------------------------------------------------------------


def test_laws_of_the_package_are_found():
    assert law_names() == ("dmt", "hertz", "jkr", "maugis", "meniscus")
    for name in law_names():
        # a tip of no surface has no water about it
        assert asperity(name).name == ("dmt" if name == "meniscus" else name)


@pytest.mark.parametrize(
    ("name", "join", "detach", "pull_off", "loss"),
    [("jkr", 0.0, 0.90856, 1.5, 1.27494), ("dmt", 0.0, 0.0, 2.0, 0.0), ("hertz", 0.0, 0.0, 0.0, 0.0)],
)
def test_laws_in_the_units_of_adhesion(name, join, detach, pull_off, loss):
    """JKR's figures are printed with five digits; 2 pi beta dgamma is DMT's pull-off."""
    law = gd.contact.asperity(name)
    assert law.join == join
    assert law.detach == pytest.approx(detach, abs=5e-6)
    assert law.pull_off == pytest.approx(pull_off, rel=1e-14, abs=0)
    assert law.loss == pytest.approx(loss, abs=5e-6)
    assert not np.signbit(law.loss)
    assert law.load(-law.detach - 1e-9) == 0.0


def test_loads_in_the_units_of_adhesion():
    """Of the contact radius A: JKR as A^2 - 2/3 sqrt(6A) and A^3 - A sqrt(6A), Hertz, and DMT below it by 2."""
    radius = np.linspace(1.0, 6.0, 11)
    pull = np.sqrt(6 * radius)
    displacement, load = radius**2 - 2 / 3 * pull, radius**3 - radius * pull
    np.testing.assert_allclose(gd.contact.asperity("jkr").load(displacement), load, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(gd.contact.asperity("hertz").load(radius**2), radius**3, rtol=1e-14)
    np.testing.assert_allclose(gd.contact.asperity("dmt").load(radius**2), radius**3 - 2, rtol=1e-13)


def test_a_name_is_given_once(spring):
    with pytest.raises(SceneError, match=r"contact\.asperity = spring: is the name of another asperity law"):
        register(Spring)


def test_unknown_laws_are_named_with_those_that_are_known(silicon, spring):
    known = "must be one of dmt, hertz, jkr, maugis, meniscus, spring"
    for call in (
        lambda: asperity("sphere"),
        lambda: asperity_load(0.0, asperity_of(silicon), "sphere"),
        lambda: rough_pressure(0.0, 0.0, silicon, "sphere"),
        lambda: unregister("sphere"),
        lambda: gd.preset("roller_slow").replace({"contact.asperity": "sphere"}),
    ):
        with pytest.raises(SceneError, match=rf"contact\.asperity = sphere: {known}"):
            call()


def test_a_law_is_gone_once_it_is_taken_out():
    register(Spring)
    unregister("spring")
    with pytest.raises(
        SceneError, match=r"contact\.asperity = spring: must be one of dmt, hertz, jkr, maugis, meniscus"
    ):
        gd.preset("roller_slow").replace({"contact.asperity": "spring"})


def test_a_reach_beyond_the_tables_is_refused():
    with pytest.raises(
        SceneError, match=r"surface\.roughness = 1e-09: asperities join over 4\.5 roughnesses"
    ):
        check_reach(Spring(1.0, 4.5, 5.0), 1e-9)
    with pytest.raises(SceneError, match=r"surface\.roughness = 1e-09: asperities stretch 130 roughnesses"):
        check_reach(Spring(1.0, 0.5, 130.0), 1e-9)


# -- what follows from the law alone ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("near", "far"), [(0.0, 0.2), (0.3, 0.5), (1.0, 3.0)])
def test_energy_and_loss_follow_from_the_load(near, far):
    law = Spring(2.5, near, far)
    displacement = np.linspace(-far, 3.0, 7)
    # the inherited quadrature: exact for polynomials, to rounding
    np.testing.assert_allclose(
        law.energy(displacement), 0.5 * 2.5 * (displacement**2 - far**2), rtol=0, atol=1e-13 * 2.5 * 9
    )
    assert law.loss == pytest.approx(0.5 * 2.5 * (far**2 - near**2), rel=1e-13, abs=0)


def test_planes_and_lines_of_springs(silicon, spring):
    """SI laws against a closed form and against adaptive quadrature, for all stretches."""
    law, sigma = law_of("spring", silicon), silicon.roughness
    unit = silicon.asperity_density * asperity_of(silicon).hertz_factor * sigma**1.5
    line_unit = unit * 2e-6 * math.sqrt(2 * 5e-6 * sigma)
    for gap in (-6.0, -0.4, 2.0, 5.5):
        for stretch in (0.0, law.near, 0.5 * (law.near + law.far), law.far, math.inf):
            counted = min(max(stretch, law.near), law.far)
            wanted, size = closed_pressure(law, gap, counted)
            got = rough_pressure(gap * sigma, stretch * sigma, silicon, "spring") / unit
            assert got == pytest.approx(wanted, rel=0, abs=1e-12 * size)
            wanted, _ = integrate.quad(
                lambda d, gap=gap: law.stiffness * d * psi(gap + d),
                -counted,
                9.5 - min(gap, 0.0),
                epsabs=0,
                epsrel=1e-11,
                limit=200,
                points=[0.0],
            )
            got = line_force(gap * sigma, stretch * sigma, 5e-6, 2e-6, silicon, "spring") / line_unit
            assert got == pytest.approx(wanted, rel=1e-9, abs=0)  # nothing cancels by more than ten here


LAWS = [Spring(1.7, 0.0, 0.3), Spring(1.7, 0.1, 0.35), Spring(1.7, 0.9, 1.4), Spring(1.7, 0.6, 3.0)]


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_tables_hold_the_closed_forms(law):
    table = law_table(law, "plane")
    width = law.far - law.near
    assert table[H_MODE] == (MODE_TABLE if width < 1 else MODE_INTEGRATED)
    rng = np.random.default_rng(5)
    for gap in rng.uniform(-8.0, 10.0, 100):
        share = min(max(rng.uniform(-0.2, 1.2), 0.0), 1.0)
        wanted, size = closed_pressure(law, gap, law.near + share * width)
        value, _ = law_value(table, gap, gap - share * width)
        assert value == pytest.approx(wanted, rel=0, abs=1e-9 * size)  # the tables' stated error


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_energy_tables_hold_the_closed_forms(law):
    table, force, number = (
        energy_table(law, "plane"),
        law_table(law, "plane"),
        number_table("plane", law.join),
    )
    width = law.far - law.near
    for joined in (-5.0, -0.3, 1.1, 4.2, 7.0):
        # what joining took of the asperities above the height that the joined height stands for
        assert loading_value(number, 0, joined)[0] == pytest.approx(above(joined - law.near), rel=1e-9, abs=0)
        adhered_energy = -joining_energy(law) * above(joined - law.near)
        for share in (0.0, 1e-3, 0.4, 0.999, 1.3):
            gap = joined + share * width
            potential, push = loading_value(table, HEADER, gap)
            energy, slope = stretched_energy(table, adhered_energy, gap, joined)
            wanted = closed_energy(law, gap, law.near + min(share, 1.0) * width)
            size = abs(potential) + abs(energy) + abs(adhered_energy)
            assert potential + energy == pytest.approx(wanted, rel=0, abs=1e-9 * size)
            value, _ = law_value(force, gap, joined)
            _, size = closed_pressure(law, gap, law.near + min(share, 1.0) * width)
            assert -(push + slope) == pytest.approx(value, rel=0, abs=1e-8 * size)


# -- with everything else --------------------------------------------------------------------------------------------


def springs_above(gap):
    """Asperities above a height over those per psi's unit."""
    return integrate.quad(psi, gap, 16.0, epsabs=0, epsrel=1e-11, limit=200)[0]


def test_elastic_bodies_lose_what_their_springs_cost(silicon, spring):
    """The static curve of a rough roller encloses the loss of the springs that it has joined: bodies lose nothing."""
    radius, width, lowest, sigma = 5e-6, 2e-6, 9e-9, silicon.roughness
    node, weight = np.polynomial.legendre.leggauss(16)
    # Gauss panels, small near the turning point where the stretch grows to its limit over some nanometres
    edges = lowest + np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 40.0, 70.0]) * 1e-9
    half = 0.5 * np.diff(edges)[:, None]
    gap, measure = (edges[:-1, None] + half * (1 + node)).ravel(), (half * weight).ravel()
    path = np.concatenate([gap[::-1], [lowest], gap])
    curve = elastic_line_curve(path, radius, width, silicon, asperity="spring", nodes=20)
    loop = measure @ (curve.force[: gap.size][::-1] - curve.force[-gap.size :])
    modulus = contact_modulus(silicon.youngs_modulus, silicon.poisson_ratio)
    grid = line_grid(curve.x[-1], width, modulus, 20)
    closest = curve.node_gap[gap.size]
    joined = width * grid.weights @ above((closest - JOIN) / sigma) * silicon.asperity_density
    # kinks of the force where nodes reach full stretch limit the quadrature, as for JKR
    assert loop == pytest.approx(adhesion_loss_per_asperity(silicon, "spring") * joined, rel=3e-4, abs=0)


@pytest.fixture
def impact(spring):
    """A roller on springs, half of them coated."""
    scene = gd.preset("roller_slow").replace(
        {"coating.sam_fraction": 0.5, "contact.bodies": "rigid", "contact.asperity": "spring"}
    )
    return scene.replace({"run.duration": 3e-5, "run.samples": 40_001, "run.rtol": 1e-9})


def expected_loss(scene, deepest):
    """Loss of all springs that a roller has joined when its gap was `deepest` roughnesses."""
    surface, roller = scene.surface, scene.roller
    count = surface.asperity_density * roller.width * math.sqrt(2 * roller.radius * surface.roughness)
    shares = ((scene.surface, 0.5), (scene.coated_surface, 0.5))
    cost = sum(share * adhesion_loss_per_asperity(which, "spring") for which, share in shares)
    return count * cost * springs_above(deepest - JOIN / surface.roughness)


def test_an_impact_on_springs_loses_what_they_cost(impact):
    # by hand: k/2 (b^2 - a^2)
    tip = asperity_of(impact.surface)
    by_hand = 0.5 * tip.pull_off / tip.stretch_limit * ((JOIN + tip.stretch_limit) ** 2 - JOIN**2)
    assert adhesion_loss_per_asperity(impact.surface, "spring") == pytest.approx(by_hand, rel=1e-12, abs=0)
    run = solve(impact)
    balance = run.balance
    assert run.samples["height"][-1] > 15 * impact.surface.roughness  # it has come free
    lost = expected_loss(impact, run.samples["height"].min() / impact.surface.roughness)
    # the lowest sample lies near a turning point, so that its error enters squared
    assert balance.adhesion_loss == pytest.approx(lost, rel=1e-6, abs=0)
    speed = run.samples["speed"]
    assert 0.5 * impact.roller.mass * (speed[0] ** 2 - speed[-1] ** 2) == pytest.approx(lost, rel=1e-6, abs=0)
    assert_balanced(balance, impact)
    assert abs(balance.stored_change) < 1e-8 * lost


def test_nothing_is_compiled_for_a_new_law(impact):
    solve(impact.replace({"contact.asperity": "jkr"}))
    with event.install_recorder("numba:compile") as compiled:
        dataset = gd.simulate(impact)
    assert compiled.buffer == []
    assert "spring" in dataset.attrs["scene"]


def broken(**changes):
    """A law with one fault, registered while it is tested."""
    return type("Broken", (Spring,), {"name": "broken"} | changes)


def fails(cls, tip, unit):
    return tip.no_such_property


FAULTS = {
    "an attribute that is not there": ({"of": classmethod(fails)}, "of fails: AttributeError"),
    "a division by zero": (
        {"of": classmethod(lambda cls, tip, unit: 1 / 0)},
        "of fails: ZeroDivisionError",
    ),
    "other arguments": ({"of": classmethod(lambda cls, tip: None)}, "of fails: TypeError"),
    "nothing": (
        {"of": classmethod(lambda cls, tip, unit: None)},
        "of must return an AsperityLaw, not None",
    ),
    "no hash": ({"__hash__": None}, "__hash__ fails: TypeError"),
    "a distance that fails": ({"detach": property(lambda law: law.no_such)}, "detach fails: AttributeError"),
    "a distance that is none": ({"join": property(lambda law: None)}, "join fails: TypeError"),
    "a load that fails": ({"load": lambda law, displacement: law.no_such}, "load fails: AttributeError"),
    "a load of another shape": ({"load": lambda law, displacement: np.zeros(3)}, "load fails: ValueError"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_law_that_fails_is_named_with_its_function(fault):
    changes, words = FAULTS[fault]
    register(broken(**changes))
    try:
        with pytest.raises(SceneError, match=rf"contact\.asperity = broken: Broken\.{words}"):
            solve(gd.preset("roller_slow").replace({"contact.asperity": "broken"}))
    finally:
        unregister("broken")
