"""The play operator and the turning point within a step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.contact.history import extreme_gap, joined_height

heights = st.floats(-10, 10)
limits = st.floats(1e-3, 5)


@given(joined=heights, gap=heights, limit=limits)
def test_stretch_stays_between_nothing_and_the_limit(joined, gap, limit):
    stretch = gap - joined_height(joined, gap, limit)
    assert 0 <= stretch <= limit * (1 + 1e-12)


@given(
    joined=heights, start=heights, way=st.lists(st.floats(0, 3), max_size=5), limit=limits, up=st.booleans()
)
def test_monotone_motion_needs_no_stops(joined, start, way, limit, up):
    """Rate independence: any way of cutting a monotone motion up gives the same, exactly."""
    joined = joined_height(joined, start, limit)
    path = start + np.cumsum(way) * (1 if up else -1)
    stepwise = joined
    for gap in path:
        stepwise = joined_height(stepwise, gap, limit)
    end = path[-1] if len(way) else start
    assert stepwise == joined_height(joined, end, limit)


@given(joined=heights, gap=heights, swing=st.floats(0, 1), limit=limits)
def test_small_cycles_are_free(joined, gap, swing, limit):
    """A swing inside the stretch that is there comes back to the same joined height: nothing lost."""
    joined = joined_height(joined, gap, limit)
    stretch = gap - joined
    closer = gap - swing * stretch
    again = joined_height(joined_height(joined, closer, limit), gap, limit)
    assert again == pytest.approx(joined, abs=1e-12)


@given(gap0=heights, rate0=st.floats(-2, -0.01), rate1=st.floats(0.01, 2), span=st.floats(1e-3, 10))
def test_turning_point_of_a_parabola_is_exact(gap0, rate0, rate1, span):
    acceleration = (rate1 - rate0) / span
    gap1 = gap0 + span * (rate0 + rate1) / 2
    lowest = gap0 - rate0**2 / (2 * acceleration)
    assert extreme_gap(span, gap0, rate0, gap1, rate1) == pytest.approx(lowest, abs=1e-12 * (10 + span))
    assert extreme_gap(span, -gap0, -rate0, -gap1, -rate1) == pytest.approx(-lowest, abs=1e-12 * (10 + span))


def test_turning_point_converges_with_the_fourth_power():
    errors = []
    for span in (0.4, 0.2, 0.1):
        a, b = -0.6 * span, 0.4 * span  # around the turning point of cosh - 1 + a cubic, at 0
        f = lambda t: np.cosh(t) + t**5  # noqa: E731
        df = lambda t: np.sinh(t) + 5 * t**4  # noqa: E731
        errors.append(abs(extreme_gap(span, f(a), df(a), f(b), df(b)) - 1.0))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 3.5
