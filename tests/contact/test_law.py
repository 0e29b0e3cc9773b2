"""The compiled force law against the readable one, branch by branch."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.asperities.dmt import Dmt
from gearidae.asperities.hertz import Hertz
from gearidae.asperities.jkr import Jkr
from gearidae.asperities.tip import asperity_of
from gearidae.contact.kernels import law
from gearidae.contact.line import line_force
from gearidae.contact.rough import rough_pressure
from reference.surface import PlainSurface

RADIUS, WIDTH = 10e-6, 2e-6


def surface_with(stretch_limit):
    """Silicon whose stretch limit is so many roughnesses: only the ratio matters to the law."""
    silicon = PlainSurface()
    return PlainSurface(roughness=asperity_of(silicon).stretch_limit / stretch_limit)


def unit_force(surface):
    tip = asperity_of(surface)
    scale = law.force_scale(surface.roughness, tip.hertz_factor, surface.asperity_density, WIDTH)
    return scale * math.sqrt(2 * RADIUS * surface.roughness)


def law_error(stretch_limit, gaps, share):
    """Largest error over the sum of what pushes and what pulls, which is what cancellation leaves to be had."""
    surface = surface_with(stretch_limit)
    table = law.law_table(Jkr(stretch_limit))
    stretch = share * stretch_limit
    sigma = surface.roughness
    exact = line_force(gaps * sigma, stretch * sigma, RADIUS, WIDTH, surface) / unit_force(surface)
    loading = line_force(gaps * sigma, 0 * gaps, RADIUS, WIDTH, surface) / unit_force(surface)
    tabled = np.array([law.law_value(table, g, g - s)[0] for g, s in zip(gaps, stretch, strict=True)])
    return np.max(np.abs(tabled - exact) / (np.abs(loading) + np.abs(exact - loading)))


@pytest.mark.parametrize("stretch_limit", [1e-3, 0.0363, 0.2219, 0.9, 1.1, 5.0, 40.0])
def test_law_is_right_to_1e_9_from_deep_contact_into_the_far_tail(stretch_limit):
    rng = np.random.default_rng(3)
    gaps = rng.uniform(-8.0, 12.0, 200)
    share = np.clip(rng.uniform(-0.2, 1.2, 200), 0.0, 1.0)  # all three branches
    assert law_error(stretch_limit, gaps, share) < 1e-9  # the docstring's bound


@pytest.mark.parametrize("stretch_limit", [1e-3, 0.0363, 0.2219, 0.9, 1.1, 5.0, 40.0])
def test_pressure_between_planes_is_right_to_1e_9(stretch_limit):
    surface = surface_with(stretch_limit)
    sigma = surface.roughness
    unit = surface.asperity_density * asperity_of(surface).hertz_factor * sigma**1.5
    table = law.law_table(Jkr(stretch_limit), kernel="plane")
    rng = np.random.default_rng(4)
    gaps = rng.uniform(-8.0, 12.0, 200)
    stretch = stretch_limit * np.clip(rng.uniform(-0.2, 1.2, 200), 0.0, 1.0)
    exact = rough_pressure(gaps * sigma, stretch * sigma, surface) / unit
    loading = rough_pressure(gaps * sigma, 0 * gaps, surface) / unit
    tabled = np.array([law.law_value(table, g, g - s)[0] for g, s in zip(gaps, stretch, strict=True)])
    assert np.max(np.abs(tabled - exact) / (np.abs(loading) + np.abs(exact - loading))) < 1e-9


def test_deep_contact_is_tabulated_too():
    gaps = np.linspace(law.GAP_LOW, -8.0, 40)
    assert law_error(0.2219, gaps, np.linspace(0, 1, 40)) < 1e-9


@pytest.mark.parametrize("kind", [Dmt(0.2219), Hertz()], ids=lambda kind: kind.name)
def test_asperities_that_do_not_stretch(kind):
    surface = surface_with(0.2219)
    table = law.law_table(kind)
    gaps = np.linspace(-8.0, 12.0, 101)
    exact = line_force(gaps * surface.roughness, 0.0, RADIUS, WIDTH, surface, kind.name) / unit_force(surface)
    pushing = line_force(gaps * surface.roughness, 0.0, RADIUS, WIDTH, surface, "hertz") / unit_force(surface)
    values = np.array([law.law_value(table, g, g - 0.2) for g in gaps])
    assert np.max(np.abs(values[:, 0] - exact) / (np.abs(pushing) + np.abs(exact))) < 1e-9


def test_law_ends_at_the_widest_gap():
    table = law.law_table(Jkr(0.2219))
    widest = law.GAP_HIGH + 0.2219  # where the last stretched asperity lets go
    inside, _ = law.law_value(table, widest - 1e-9, -math.inf)
    assert law.law_value(table, widest, -math.inf) == (0.0, 0.0)
    assert law.law_value(table, law.GAP_HIGH, law.GAP_HIGH) == (0.0, 0.0)
    assert 0 < abs(inside) < 1e-35  # what is cut off there is no force at all


@given(gap=st.floats(-10, 12), share=st.floats(0.02, 0.98), limit=st.sampled_from([0.0363, 0.2219, 0.9, 5.0]))
def test_slope_is_the_derivative_at_fixed_joined_height(gap, share, limit):
    table = law.law_table(Jkr(limit))
    joined = gap - share * limit
    step = 1e-4 * min(share, 1 - share) * limit
    ahead, behind = (law.law_value(table, gap + d, joined)[0] for d in (step, -step))
    value, slope = law.law_value(table, gap, joined)
    # a central difference over this step is off by 1e-8 of the slope, and by rounding over the step
    scale = abs(slope) + abs(value) * (1 + abs(gap))
    assert (ahead - behind) / (2 * step) == pytest.approx(slope, abs=1e-6 * scale + 1e-12 * abs(value) / step)


@given(gap=st.floats(-10, 11), limit=st.sampled_from([0.0363, 0.2219, 0.9, 5.0]))
def test_branches_join_without_a_step(gap, limit):
    table = law.law_table(Jkr(limit))
    touch = law.law_value(table, gap, gap)[0]
    touch_after = law.law_value(table, gap, math.nextafter(gap, -math.inf))[0]
    full_before = law.law_value(table, gap, gap - limit * (1 - 1e-15))[0]
    full = law.law_value(table, gap, gap - limit)[0]
    size = abs(touch) + abs(full - touch)
    assert abs(touch_after - touch) < 1e-9 * size  # the tables' own error, stated in the docstring
    assert abs(full_before - full) < 1e-9 * size


@pytest.mark.parametrize("branch", ["loading", "stretched"])
def test_three_derivatives_are_continuous_at_every_knot(branch):
    """Septic Hermite pieces share three derivatives: one-sided differences must agree to their own error."""
    table = law.law_table(Jkr(0.2219))
    joined = (lambda g: g) if branch == "loading" else (lambda g: -math.inf)
    shift = 0.0 if branch == "loading" else 0.2219

    def third(at, side):
        h = side * 2e-3
        f = [law.law_value(table, at + i * h, joined(at + i * h))[0] for i in range(6)]
        # six points on one side: error of third order in h
        return (-17 * f[0] + 71 * f[1] - 118 * f[2] + 98 * f[3] - 41 * f[4] + 7 * f[5]) / (4 * h**3)

    for knot in (-4.0, -0.125, 0.0, 0.125, 2.0, 6.0):
        at = knot + shift
        left, right = third(at, -1), third(at, 1)
        assert left == pytest.approx(right, rel=2e-2, abs=2e-2 * abs(law.law_value(table, at, joined(at))[0]))


@given(joined=st.floats(-10, 11), share=st.just(0.0) | st.just(1.0) | st.floats(1e-9, 1 - 1e-9))
def test_a_kept_branch_is_the_law(joined, share):
    table = law.law_table(Jkr(0.2219))
    branch = np.empty(law.branch_length(table))
    law.set_branch(table, joined, branch)
    stretch = share * 0.2219
    value, slope = law.branch_value(branch, stretch)
    gap = joined + stretch
    expected, expected_slope = law.stretched_value(table, gap, gap - stretch)
    size = abs(branch[2])  # t at full stretch
    assert value == pytest.approx(expected, abs=1e-9 * size)
    if 0 < share < 1:
        assert slope == pytest.approx(expected_slope, abs=1e-6 * size * (10 + abs(gap)))


def test_no_adhesion_is_hertz():
    np.testing.assert_array_equal(law.law_table(Dmt(0.0)), law.law_table(Hertz()))
    assert Jkr.of(asperity_of(PlainSurface(energy=0.0)), 1e-9) == Hertz()


def test_negligible_stretch_keeps_no_branches():
    table = law.law_table(Jkr(1e-5))
    assert law.branch_length(table) == 0
    assert law.law_value(table, 3.0, -math.inf) == law.law_value(table, 3.0, 3.0)
    # what is skipped is below the table's own error
    surface = surface_with(1e-5)
    gaps = np.linspace(-4, 8, 20)
    full = line_force(gaps * surface.roughness, 1.0, RADIUS, WIDTH, surface)
    loading = line_force(gaps * surface.roughness, 0.0, RADIUS, WIDTH, surface)
    assert np.max(np.abs(full / loading - 1)) < 1e-8


def test_tables_are_shared_and_protected():
    assert law.law_table(Jkr(0.2219)) is law.law_table(Jkr(0.2219))
    with pytest.raises(ValueError, match="read-only"):
        law.law_table(Jkr(0.2219))[0] = 1.0


def test_asperities_that_stretch_far_hold_beyond_the_widest_gap():
    """What is joined within the tables pulls until it lets go, however wide the gap is by then."""
    surface = surface_with(5.0)
    table = law.law_table(Jkr(5.0))
    for gap in (12.9, 13.0, 13.1):
        exact = line_force(gap * surface.roughness, (gap - 8.5) * surface.roughness, RADIUS, WIDTH, surface)
        assert law.law_value(table, gap, 8.5)[0] == pytest.approx(
            float(exact) / unit_force(surface), rel=1e-8, abs=0
        )
