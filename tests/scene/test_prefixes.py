"""Engineering prefixes."""

from __future__ import annotations

import math

import pytest

from gearidae.scene.prefixes import with_prefix


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (46.61e-9, "m", "46.6 nm"),
        (6e-10, "m", "600 pm"),
        (0.0, "N", "0 N"),
        (-1.26e-6, "N", "-1.26 uN"),
        (9.999e-7, "m", "1 um"),  # rounding reaches the next prefix
        (1e-6, "m", "1 um"),
        (1e3, "Hz", "1 kHz"),
        (1.42e-4, "N/m", "142 uN/m"),
        (1.8e-17, "N m", "18 aN m"),
        (-3.36059e-19, "J", "-336 zJ"),
        (2.2e-26, "J", "2.2e-26 J"),
        (1e-25, "N m", "1e-25 N m"),
        (1e15, "Hz", "1e+15 Hz"),
        (6.1052e-20, "kg m^2", "6.11e-20 kg m^2"),
        (5.13e-8, "1", "5.13e-08"),
        (math.nan, "m", "-"),
        (math.inf, "m", "inf m"),
    ],
)
def test_prefixes(value, unit, text):
    assert with_prefix(value, unit) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-4.8e-19, "-480 zJ"),
        (9.96e-17, "100 aJ"),
        (9.96e-19, "1 aJ"),
        (1.26e-17, "13 aJ"),
        (1.26e-18, "1.3 aJ"),
    ],
)
def test_fewer_digits_than_places_before_the_point(value, text):
    assert with_prefix(value, "J", 2) == text
