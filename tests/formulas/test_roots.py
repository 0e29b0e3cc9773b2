"""One bisection: it brackets the end of a condition, on cubics to the accuracy that its halvings give."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.compiled import compiled
from gearidae.formulas.interpolation import cubic, cubic_slope
from gearidae.formulas.roots import (
    HALVINGS,
    bisected,
    departure_of_cubic,
    extremum_of_cubic,
    zero_of_cubic,
)

WIDTH = 2.0**-HALVINGS


@compiled
def _below(x, bound):
    return x * x < bound


below = bisected(_below)


@given(bound=st.floats(1e-6, 3.9))
def test_a_condition_is_bracketed_where_it_ends(bound):
    low, high = below(0.0, 2.0, HALVINGS, 0.0, bound)
    assert low * low < bound <= high * high
    assert high - low == 2.0 * WIDTH


@pytest.mark.parametrize("least", [1e-3, 1e-9])
def test_it_ends_where_the_bracket_is_sharp_enough(least):
    """A halving after the last bracket that was wider than the share would make one of half of it at least."""
    low, high = below(0.0, 2.0, 60, least, 2.0)
    assert 0.5 * least * high < high - low <= least * high * (1.0 + 1e-6)
    assert low <= np.sqrt(2.0) <= high


@given(zero=st.floats(0.01, 0.99), h=st.floats(0.1, 10.0), slope=st.sampled_from([-2.0, 0.3, 5.0]))
def test_a_straight_cubic_has_the_zero_of_its_line(zero, h, slope):
    ends = -slope * zero * h, slope, slope * (1.0 - zero) * h, slope
    low, high = zero_of_cubic(0.0, 1.0, HALVINGS, 0.0, -slope, h, *ends)
    # rounding of the cubic, over its slope in the share
    assert low - 1e-14 <= zero <= high + 1e-14
    assert high - low == WIDTH


@given(rise=st.floats(0.1, 3.0), fall=st.floats(0.1, 3.0), h=st.floats(0.1, 10.0))
def test_an_extremum_lies_where_the_slope_is_zero(rise, fall, h):
    """That of a parabola with slopes `rise` at its beginning and -`fall` at its end."""
    ends = 0.0, rise, 0.5 * h * (rise - fall), -fall
    low, high = extremum_of_cubic(0.0, 1.0, HALVINGS, 0.0, 1.0, h, *ends)
    # rounding of the slope, over its own slope in the share; both are h (rise + fall)
    assert low - 1e-14 <= rise / (rise + fall) <= high + 1e-14
    assert cubic_slope(low, h, *ends) > 0.0 >= cubic_slope(high, h, *ends)


@given(place=st.floats(-1.0, 1.0), most=st.floats(0.01, 1.9), sense=st.sampled_from([-1.0, 1.0]))
def test_a_place_is_left_by_a_distance_to_either_side(place, most, sense):
    ends = place, 2.0 * sense, place + 2.0 * sense, 2.0 * sense
    low, high = departure_of_cubic(0.0, 1.0, HALVINGS, 0.0, place, most, 1.0, *ends)
    assert abs(cubic(low, 1.0, *ends) - place) <= most < abs(cubic(high, 1.0, *ends) - place)
    assert low - 1e-14 <= 0.5 * most <= high + 1e-14
