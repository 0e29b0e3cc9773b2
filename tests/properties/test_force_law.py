"""What the rough line contact's force law must be, whatever the surface and its history."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from gearidae.asperities.hertz import Hertz
from gearidae.asperities.jkr import Jkr
from gearidae.contact.history import extreme_gap, joined_height
from gearidae.contact.kernels.law import law_table, law_value
from gearidae.contact.line import line_force
from gearidae.contact.psi import psi
from reference.asperity import jkr_displacement, jkr_displacement_rate, jkr_fold, jkr_force
from reference.surface import PlainSurface

LIMITS = [0.01, 0.0363, 0.2219, 0.9, 1.3, 5.0]  # tabulated and integrated branches
limits = st.sampled_from(LIMITS)
turns = st.lists(st.floats(-6.0, 9.0), min_size=2, max_size=6)


def walk(limit, gaps):
    """Force and slope along a path, the joined height followed point by point."""
    table, joined = law_table(Jkr(limit)), gaps[0]
    out = []
    for gap in gaps:
        joined = joined_height(joined, gap, limit)
        out.append(law_value(table, gap, joined))
    return np.array(out).T


def path(turning, steps):
    legs = [np.linspace(a, b, steps, endpoint=False) for a, b in itertools.pairwise(turning)]
    return np.concatenate([*legs, turning[-1:]])


@given(limit=limits, turning=turns, share=st.floats(0.0, 1.0), place=st.sampled_from(["way", "turn", "full"]))
def test_force_is_continuous_through_every_branch(limit, turning, share, place):
    """Just before and just after any place of the way: a turning point, full stretch, or anywhere else."""
    last = turning[-1]
    at = {"way": share * 12.0 - 6.0, "turn": last, "full": last + limit}[place]
    step = 1e-6
    near = walk(limit, np.array([*turning, at - step, at]))[0][-2:]
    there = walk(limit, np.array([*turning, at, at + step]))[0][-2:]
    back = walk(limit, np.array([*turning, at, at - step]))[0][-2:]
    pushes = law_value(law_table(Hertz()), at, at)[
        0
    ]  # without adhesion: what the pull takes away may leave little
    size = pushes + np.abs([*near, *there, *back]).max()
    # forces fall by e^6 per roughness and stretched ones change by their own size over a stretch limit
    bound = (20.0 + 5.0 / limit) * size * step + 1e-9 * size
    for pair in (near, there, back):
        assert abs(pair[1] - pair[0]) < bound


@given(gap=st.floats(-10.0, 6.0), limit=st.sampled_from([0.0, 0.001, 0.01, 0.03]))
def test_loading_rises_steadily_where_adhesion_is_weak(gap, limit):
    """Adhesion pulls only where H Dc is of order one: below a tenth of that the approach is met by rising force."""
    table = law_table(Jkr(limit) if limit else Hertz())
    near = min(gap, 0.1 / limit) if limit else gap
    assert law_value(table, near, near)[1] < 0.0
    assert law_value(table, near - 0.01, near - 0.01)[0] > law_value(table, near, near)[0] > 0.0


@given(limit=limits, turning=turns, extra=st.integers(1, 7))
def test_only_turning_points_are_remembered(limit, turning, extra):
    """The law does not know how fast, or in how many steps, a way was gone."""
    coarse = walk(limit, path(turning, 1))[0]
    fine = walk(limit, path(turning, 1 + extra))[0]
    np.testing.assert_array_equal(coarse[-1], fine[-1])


def asperity_loss():
    """Energy lost where one asperity joins and lets go, over Pc dc: minus the integral of P from -dc to 0."""
    surface = PlainSurface()
    fold = jkr_fold(surface)
    touch = fold * (8 / 9 * 18) ** (1 / 3)  # a^3 = 8/9 where it is 1/18 at the fold
    assert jkr_displacement(touch, surface) == pytest.approx(0.0, abs=1e-12 * surface.asperity_radius)
    work = quad(
        lambda a: -jkr_force(a, surface) * jkr_displacement_rate(a, surface), fold, touch, epsrel=1e-12
    )[0]
    pull_off = 1.5 * math.pi * surface.asperity_radius * 2 * surface.energy
    return work / (pull_off * -jkr_displacement(fold, surface))


def test_adhesion_energy_of_one_asperity():
    assert asperity_loss() == pytest.approx(0.93550, abs=5e-6)  # the constant is printed with five digits


@settings(max_examples=25)
@given(limit=limits, deepest=st.floats(-4.0, 6.0))
def test_a_full_loop_loses_exactly_the_adhesion_energy(limit, deepest):
    """0.93550 Pc dc for every asperity higher than the smallest gap, however the gap got there."""
    table = law_table(Jkr(limit))
    edges = np.array([deepest, deepest + limit, *np.arange(deepest + limit + 0.25, 13.0, 0.25), 13.0])
    x, w = np.polynomial.legendre.leggauss(24)

    def lost(low, high):
        # the square root at the end of the stretch is regular in the distance's root from the upper edge
        r = 0.5 * (x + 1.0)
        gaps = high - (high - low) * r**2
        weights = 0.5 * w * (high - low) * 2.0 * r
        back = [law_value(table, g, joined_height(deepest, g, limit))[0] for g in gaps]
        there = [law_value(table, g, g)[0] for g in gaps]
        return float(weights @ (np.array(there) - back))

    loop = sum(lost(low, high) for low, high in itertools.pairwise(edges))
    joined = quad(lambda y: float(psi(y)), deepest, deepest + 20.0, epsabs=0.0, epsrel=1e-11)[0]
    expected = asperity_loss() * math.sqrt(3.0) * limit**2.5 * joined
    # the difference of two forces held to 1e-9 each, which are larger than it by up to 1e3; the tables end at 13
    assert loop == pytest.approx(expected, rel=2e-6, abs=0.0)


@settings(max_examples=40)
@given(limit=limits, low=st.floats(-4.0, 7.0), share=st.floats(0.05, 1.0), steps=st.integers(2, 20))
def test_a_loop_that_tears_nothing_loses_nothing(limit, low, share, steps):
    """Stretched by no more than the limit, all asperities come back the way they went."""
    up = np.linspace(low, low + share * limit, steps)
    force = walk(limit, np.concatenate([up, up[::-1]]))[0]
    size = np.abs(force).max()
    np.testing.assert_allclose(force[:steps], force[steps:][::-1], rtol=0, atol=1e-9 * size)


@given(joined=st.floats(-10.0, 10.0), way=st.floats(0.0, 10.0), limit=st.floats(1e-3, 5.0))
def test_nothing_stretches_beyond_the_limit(joined, way, limit):
    """Parting stretches what is joined up to the limit and tears the rest; closing up joins what it touches."""
    stretched = joined_height(joined, joined + way, limit)
    assert stretched == pytest.approx(
        joined + max(way - limit, 0.0), rel=0, abs=1e-14
    )  # rounding of a few tens
    assert joined_height(joined, joined - way, limit) == joined - way


@given(
    gap=st.floats(-10.0, 10.0),
    span=st.floats(1e-3, 10.0),
    before=st.floats(-2.0, -0.01),
    after=st.floats(0.01, 2.0),
    bend=st.floats(-3.0, 3.0),
)
def test_the_turning_point_of_a_cubic_is_exact(gap, span, before, after, bend):
    """The rate is a parabola from `before` to `after` (scaled by the span), bent either way; it is zero once."""
    place = brentq(lambda s: bend * s**2 + (after - before - bend) * s + before, 0.0, 1.0, xtol=1e-16)

    def moved(s):
        return bend * s**3 / 3 + (after - before - bend) * s**2 / 2 + before * s

    extreme = extreme_gap(span, gap, before / span, gap + moved(1.0), after / span)
    assert extreme == pytest.approx(gap + moved(place), rel=0, abs=1e-12 * 20)
    assert extreme_gap(span, -gap, -before / span, -gap - moved(1.0), -after / span) == pytest.approx(
        -extreme, rel=0, abs=1e-12 * 20
    )


positive = st.floats(0.1, 10.0)


@settings(max_examples=30)
@given(gap=st.floats(-2.0, 7.0), share=st.floats(0.0, 1.0), radius=positive, width=positive, density=positive)
def test_force_scales_with_radius_width_and_density(gap, share, radius, width, density):
    surface = PlainSurface()
    g, s = gap * surface.roughness, share * 1.3e-9
    denser = PlainSurface(asperity_density=density * surface.asperity_density)
    force = line_force(g, s, 1e-5, 2e-6, surface)
    other = line_force(g, s, radius * 1e-5, width * 2e-6, denser)
    assert other == pytest.approx(force * math.sqrt(radius) * width * density, rel=1e-12, abs=0.0)


@settings(max_examples=30)
@given(gap=st.floats(-2.0, 7.0), share=st.floats(0.0, 1.0), length=positive, stiffness=positive)
def test_force_scales_as_its_dimensions_say(gap, share, length, stiffness):
    surface = PlainSurface()
    other = PlainSurface(
        youngs_modulus=stiffness * surface.youngs_modulus,
        energy=stiffness * length * surface.energy,
        asperity_density=surface.asperity_density / length**2,
        asperity_radius=length * surface.asperity_radius,
        roughness=length * surface.roughness,
    )
    g, s = gap * surface.roughness, share * 1.3e-9
    force = line_force(g, s, 1e-5, 2e-6, surface)
    scaled = line_force(length * g, length * s, length * 1e-5, length * 2e-6, other)
    size = abs(line_force(g, 0.0, 1e-5, 2e-6, surface, "hertz")) + abs(
        force
    )  # the two cancel where the force is zero
    assert abs(scaled / (stiffness * length**2) - force) < 1e-10 * size
