"""Texts with a unit ("34.715 um") into SI numbers.

The unit is read by pint, which is loaded only when the first such text comes along. Factors are exact
decimals, so "34.715 um" is the float that ``34.715e-6`` is, to the last bit.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import Decimal, DecimalException
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

_NUMBER_AND_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)
# Only names, products, quotients and one-digit powers reach pint: it would also work out 9**9**9.
_UNIT = re.compile(r"(?:[^\W\d_]|[ _*/()%])*")
_POWER = re.compile(r"(?:\^|\*\*)\s*[+-]?\s*[1-9](?![\w.^])(?!\s*(?:\*\*|\^))")
_LONE_ONE = re.compile(r"(?<![\w.])1(?![\w.])")
_EXPONENT = re.compile(r"(?<=[^\W\d_])(?=-?\d)")
"""Where an exponent begins in a unit as CF writes it (``s-1``)."""
_DECIMAL_COMMA = re.compile(r",\d")
_SUPERSCRIPT = re.compile("(\u207b?)([\u00b9\u00b2\u00b3\u2074])")
_PLAIN = str.maketrans(
    {
        "\u2212": "-",
        "\u00b7": "*",
        "\u22c5": "*",
        "\u00d7": "*",
        "\u00b0": " deg ",
        "\u2103": "degC",
        "\u2109": "degF",
        "\u00a0": " ",
        "\u202f": " ",
    }
)
_DIGITS = {"\u00b9": "1", "\u00b2": "2", "\u00b3": "3", "\u2074": "4"}
_DEGREES = re.compile("\u00b0\\s*([CF])(?!\\w)")
_OWN_ZERO = re.compile("\u00b0 *[CF]|deg[CF]|celsius|fahrenheit|\u2103|\u2109", re.IGNORECASE)
"""Units of temperature whose zero is not that of the kelvin."""
_LONGEST = 100
_TURNS = ("rpm", "u/min", "upm", "rev/min", "r/min", "tr/min")
"""Revolutions per minute as data sheets and the programs of sensors write them, in small letters."""

# pint holds angles to be pure numbers, so that 1 rpm would be 0.105 Hz, 1 Hz and 1/min would be 1 rad/s and 1/60 of it.
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


def from_text(text: str, unit: str, *, difference: bool = False) -> float:
    """Read a number with a unit and turn it into SI.

    An angular speed without an angle counts radians where it is per second, and turns where it is ``1/min``. Other
    rates, and other units of time, need the angle named ("25 turn/s").

    Parameters
    ----------
    text : str
        Such as ``"34.715 um"``, ``"169 / um^2"`` or ``"20 deg"``; pure numbers need no unit.
    unit : str
        The SI unit wanted; ``"1"`` for a pure number.
    difference : bool, optional
        Whether it is the difference of two values, such as a standard deviation: of temperatures, one in degC is one
        in K.

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
    factor, offset = _scale(own_unit, unit, difference)
    try:
        value = Decimal(number) * factor
        return float(value + offset if offset else value)  # a sum with 0 would take the sign from -0
    except DecimalException:
        raise ValueError("must be a finite number") from None


def refuse_bare(texts: Iterable[object]) -> None:
    """Refuse numbers without a unit beside others with one: a reader takes them for that unit, SI would be another.

    Zero is the same in all units that are no temperature.

    Raises
    ------
    ValueError
        Naming the first of both.
    """
    bare: list[str] = []
    dressed: list[str] = []
    unit, own_unit = "", ""
    for text in texts:
        match = _NUMBER_AND_UNIT.fullmatch(_plain(str(text)))
        own_unit = match[2] if match else ""
        if match is not None:
            (dressed if own_unit else bare).append(str(text).strip())
            unit = unit or own_unit
    if not any(map(_OWN_ZERO.search, dressed)):
        bare = [text for text in bare if float(text) != 0.0]
    if bare and dressed:
        # a single unit at the end of a list is meant for all of it
        meant = f" ({bare[0]} {unit})" if len(dressed) == 1 and own_unit else ""
        raise ValueError(
            f"{bare[0]} has no unit beside {dressed[0]}: give each its unit{meant}, or none for SI units"
        )


def cf_unit(units: str) -> str:
    """Write the exponents of a CF unit (``s-1``) as scenes do (``s^-1``)."""
    return _EXPONENT.sub("^", units)


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
    text = _DEGREES.sub(r"deg\1", text)
    text = _SUPERSCRIPT.sub(lambda m: "^" + ("-" if m[1] else "") + _DIGITS[m[2]], text)
    return text.translate(_PLAIN)


@lru_cache(maxsize=512)
def _scale(own_unit: str, unit: str, difference: bool) -> tuple[Decimal, Decimal]:
    """Return how many `unit` one `own_unit` is, and what its zero is."""
    if not own_unit:
        return Decimal(1), Decimal(0)
    if _DECIMAL_COMMA.match(own_unit):
        raise ValueError(f"has a comma in its number: the decimal sign is a point; expected {_wanted(unit)}")
    own_unit = cf_unit(own_unit)
    if unit == "rad/s" and own_unit.lower().replace(" ", "") in _TURNS:
        own_unit = "rpm"
    bare = _LONE_ONE.sub("", _POWER.sub("", own_unit))
    # a power that begins the unit would be one of the number
    if own_unit.startswith(("^", "**")) or not _UNIT.fullmatch(bare):
        raise ValueError(f"{own_unit[:20]!r} is not a unit; expected {_wanted(unit)}")
    source = f"1 {own_unit}" if own_unit.startswith(("/", "*")) else own_unit
    registry = _registry()
    try:
        parsed = registry.parse_units(source)
        wanted = registry.parse_units("" if unit == "1" else unit)
        if unit == "rad/s" and parsed == registry.parse_units("1/min"):
            parsed = registry.parse_units("rpm")
        single = registry.Quantity(Decimal(1), parsed)
        powers = dict(single.unit_items())
        target = dict(registry.Quantity(Decimal(1), wanted).unit_items())
        fits = single.is_compatible_with(wanted) and _same_turns(powers, target, unit)
        # of temperatures the zero counts, too
        zero = Decimal(registry.Quantity(Decimal(0), parsed).to(wanted).magnitude) if fits else Decimal(0)
        factor = Decimal(single.to(wanted).magnitude) - zero if fits else Decimal(0)
        two = (
            Decimal(registry.Quantity(Decimal(2), parsed).to(wanted).magnitude) - zero if fits else Decimal(0)
        )
        if not math.isclose(two, 2 * factor, rel_tol=1e-9):
            raise ValueError("is a logarithm")  # decibels and nepers
    except Exception:  # pint fails in a dozen ways on what is no unit, and all of them mean this
        raise ValueError(f"{own_unit[:20]!r} is not a known unit; expected {_wanted(unit)}") from None
    if not fits:
        raise ValueError(f"the unit {own_unit[:20]!r} does not fit; expected {_wanted(unit)}")
    if unit == "K" and not difference and any(name.startswith("delta_") for name in powers):
        raise ValueError(
            f"{own_unit[:20]!r} is a difference of temperatures; expected one in K, degC or degF"
        )
    return factor, Decimal(0) if difference else zero


def _wanted(unit: str) -> str:
    return "a number" if unit == "1" else f"a number with a unit that fits {unit}"


def _same_turns(powers: dict[str, Any], wanted: dict[str, Any], unit: str) -> bool:
    """Keep apart what pint takes for the same: numbers and angles, cycles per second and angular speeds.

    Parameters
    ----------
    powers, wanted : dict of str to number
        Powers of the units by their names.
    unit : str
        As text, what `wanted` is of.
    """
    angles = {name: power for name, power in powers.items() if name.endswith(_ANGLES)}
    if unit in ("1", "Hz"):
        return not angles
    radians = wanted.get("radian", 0)
    if radians and any(_registry().Unit(name).dimensionless for name in powers if name not in angles):
        return False  # counts, parts and bits are no angles
    if sum(angles.values()) == radians:
        return True
    # A radian may be left out. The second goes without one; minutes, hertz and becquerels count cycles.
    only_radians = all(name.endswith("radian") for name in angles)
    return unit != "rad" and only_radians and not any(map(_counts_cycles, powers))


def _counts_cycles(name: str) -> bool:
    """Whether a unit is of time or of a rate, and not the second with a prefix or without."""
    power = dict(_registry().Unit(name).dimensionality)
    return power == {"[time]": -1} or (power == {"[time]": 1} and not name.endswith("second"))


@cache
def _registry() -> pint.UnitRegistry[Decimal]:
    import pint

    registry: pint.UnitRegistry[Decimal] = pint.UnitRegistry(non_int_type=Decimal)
    registry.define("newton_meter = newton * meter = Nm")  # pint would read "Nm" as a number of metres
    return registry
