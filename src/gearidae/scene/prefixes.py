"""Numbers with an engineering prefix before their unit, as tables show them."""

from __future__ import annotations

import math

PREFIXES = {
    -24: "y",
    -21: "z",
    -18: "a",
    -15: "f",
    -12: "p",
    -9: "n",
    -6: "u",
    -3: "m",
    0: "",
    3: "k",
    6: "M",
    9: "G",
}
"""Power of ten to prefix."""


def with_prefix(value: float, unit: str, digits: int = 3) -> str:
    """Write a quantity with the prefix that leaves one to three digits before the point.

    Parameters
    ----------
    value : float
        In the unit without a prefix.
    unit : str
        Unit; "1" for a pure number, which takes no prefix. Units that begin with ``kg`` take none either.
    digits : int, optional
        Significant digits.

    Returns
    -------
    str
        ``"46.6 nm"``; without prefix below 1e-24 and from 1e12 times the unit on. "-" if `value` is NaN.
    """
    if math.isnan(value):
        return "-"
    value += 0.0  # which makes 0 of -0
    if unit == "1":
        return f"{value:.{digits}g}"
    if value == 0.0 or math.isinf(value) or unit.startswith("kg"):
        return f"{value:.{digits}g} {unit}"
    rounded = float(f"{value:.{digits - 1}e}")
    order = math.floor(math.log10(abs(rounded)) + 1e-12)
    power = 3 * (order // 3)
    if power not in PREFIXES:
        return f"{value:.{digits}g} {unit}"
    number = rounded / 10.0**power
    return f"{number:.{max(digits, order - power + 1)}g} {PREFIXES[power]}{unit}"
