"""Texts with a unit ("34.715 um") into SI numbers.

The unit is read by pint, which is loaded only when the first such text comes along. Factors are exact
decimals, so "34.715 um" is the float that ``34.715e-6`` is, to the last bit.
"""

from __future__ import annotations

import re
from decimal import Decimal, DecimalException
from functools import cache, lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pint

__all__ = ["from_text", "to_si"]

_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)
# Only names, products, quotients and one-digit powers reach pint: it would also work out 9**9**9.
_UNIT = re.compile(r"(?:[^\W\d_]|[ _*/()%])*")
_POWER = re.compile(r"(?:\^|\*\*)\s*[+-]?\s*[1-9](?![\w.^])(?!\s*(?:\*\*|\^))")
_LONE_ONE = re.compile(r"(?<![\w.])1(?![\w.])")
_SUPERSCRIPT = re.compile("(\u207b?)([\u00b9\u00b2\u00b3\u2074])")
_PLAIN = str.maketrans(
    {
        "\u2212": "-",
        "\u00b7": "*",
        "\u22c5": "*",
        "\u00d7": "*",
        "\u00b0": " deg ",
        "\u00a0": " ",
        "\u202f": " ",
    }
)
_DIGITS = {"\u00b9": "1", "\u00b2": "2", "\u00b3": "3", "\u2074": "4"}
_LONGEST = 100

# pint holds angles to be pure numbers, so that 1 rpm would be 0.105 Hz and 1 Hz would be 1 rad/s.
_ANGLES = (
    "radian",
    "degree",
    "turn",
    "arcminute",
    "arcsecond",
    "grade",
    "revolutions_per_minute",
    "revolutions_per_second",
)


def from_text(text: str, unit: str) -> float:
    """Read a number with a unit and turn it into SI.

    Parameters
    ----------
    text : str
        Such as ``"34.715 um"``, ``"169 / um^2"`` or ``"20 deg"``; pure numbers need no unit.
    unit : str
        The SI unit wanted; ``"1"`` for a pure number.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If the text is no number with a unit, or the unit does not fit. The message says what is allowed.
    """
    match = _NUMBER_AND_UNIT.fullmatch(_plain(text)) if len(text) <= _LONGEST else None
    if match is None:
        raise ValueError(f"must be {_wanted(unit)}")
    number, own_unit = match.groups()
    if not own_unit and unit != "1":
        raise ValueError(f"lacks a unit; expected {_wanted(unit)}")
    try:
        return float(Decimal(number) * _factor(own_unit, unit))
    except DecimalException:
        raise ValueError("must be a finite number") from None


def to_si(text: str) -> float:
    """Read a text with any unit, or none, as a number in SI base units.

    Raises
    ------
    ValueError
        Saying what is wrong with it.
    """
    parts = _NUMBER_AND_UNIT.fullmatch(_plain(text))
    if parts is None:
        raise ValueError("must be a number or a text of a number and a unit")
    registry = _registry()
    try:
        base = registry.parse_units(parts[2]) if parts[2] else registry.dimensionless
        unit = f"{registry.Quantity(Decimal(1), base).to_base_units().units:~}".replace("\u03bb", "")
    except Exception:  # pint fails in a dozen ways on what is no unit
        raise ValueError(f"{parts[2][:20]!r} is not a known unit") from None
    return from_text(text, unit or "1")


def _plain(text: str) -> str:
    """Replace typographic minus signs, dots and superscripts by what can be typed."""
    text = _SUPERSCRIPT.sub(lambda m: "^" + ("-" if m[1] else "") + _DIGITS[m[2]], text)
    return text.translate(_PLAIN)


@lru_cache(maxsize=512)
def _factor(own_unit: str, unit: str) -> Decimal:
    """How many `unit` one `own_unit` is."""
    if not own_unit:
        return Decimal(1)
    bare = _LONE_ONE.sub("", _POWER.sub("", own_unit))
    if not _UNIT.fullmatch(bare):
        raise ValueError(f"{own_unit[:20]!r} is not a unit; expected {_wanted(unit)}")
    source = f"1 {own_unit}" if own_unit.startswith(("/", "*")) else own_unit
    registry = _registry()
    try:
        one = registry.Quantity(Decimal(1), registry.parse_units(source))
        wanted = registry.parse_units("" if unit == "1" else unit)
        fits = one.is_compatible_with(wanted) and _same_turns([name for name, _ in one.unit_items()], unit)
        factor = one.to(wanted).magnitude if fits else None
    except Exception:  # pint fails in a dozen ways on what is no unit, and all of them mean this
        raise ValueError(f"{own_unit[:20]!r} is not a known unit; expected {_wanted(unit)}") from None
    if factor is None:
        raise ValueError(f"the unit {own_unit[:20]!r} does not fit; expected {_wanted(unit)}")
    return Decimal(factor)


def _wanted(unit: str) -> str:
    return "a number" if unit == "1" else f"a number with a unit that fits {unit}"


def _same_turns(names: list[str], unit: str) -> bool:
    """Keep apart what pint takes for the same: numbers and angles, cycles per second and angular speeds."""
    has_angle = any(name.endswith(_ANGLES) for name in names)
    if unit in ("1", "Hz"):
        return not has_angle
    if unit == "rad":
        return has_angle
    return unit != "rad/s" or not any(name.endswith("hertz") for name in names)


@cache
def _registry() -> pint.UnitRegistry[Decimal]:
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)
