"""Which columns of a table are the time and the speed: given, by their names, or by their units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from gearidae.scene.text_table import column_of, listed, split_unit
from gearidae.scene.units import from_text

_NAMES: Final = {"time": ("time", "t"), "gear_speed": ("gear_speed", "speed")}
_UNITS: Final = {"time": "s", "gear_speed": "rad/s"}
_EXAMPLE: Final = (
    "name them, or their numbers with units (columns=..., --columns '1 [s]' '2 [rad/s]'), or head them such as: "
    "time [s], gear_speed [rad/s]"
)
_UNTIMED: Final = "; without times, give their distance (interval=..., --interval)"
_LONGEST_NUMBER: Final = 6
Wanted = Mapping[str, str | None]
"""Columns that are looked for by their meanings: their headings or numbers, None where they are recognised."""


class Column(NamedTuple):
    """A column of a table.

    Attributes
    ----------
    meaning : str
        ``time`` or ``gear_speed``.
    recognised : bool
        By its unit alone.
    """

    meaning: str
    heading: str
    position: int
    unit: str
    recognised: bool = False


def has_columns(headings: Sequence[str], wanted: Wanted) -> bool:
    """Whether texts are headings of a table with the wanted columns."""
    asked = [name for name in wanted.values() if name is not None]
    if asked:
        return all(_position_of(headings, name) is not None for name in asked)
    named = [_named(headings, meaning) for meaning in wanted]
    return all(named) or all(len(_measured(headings, meaning)) == 1 for meaning in wanted)


def numbered_positions(wanted: Wanted) -> list[int] | None:
    """Return the positions of columns that are all given by their numbers; else None."""
    numbers = [None if name is None else _number(name) for name in wanted.values()]
    return None if None in numbers else [number - 1 for number in numbers if number is not None]


def find_columns(headings: Sequence[str], wanted: Wanted) -> tuple[Column, ...]:
    """Find the wanted columns.

    Parameters
    ----------
    wanted : mapping of str to str or None
        ``time`` and ``gear_speed`` or the latter alone; the heading of each, or its number from 1, with the unit where
        the heading of the table has none. None where it is to be recognised.

    Returns
    -------
    tuple of Column

    Raises
    ------
    ValueError
        If one of them is not found, is there twice, or states no unit.
    """
    return tuple(
        _recognised(headings, meaning) if name is None else _given(headings, meaning, name)
        for meaning, name in wanted.items()
    )


def _number(name: str) -> int | None:
    """Read the number of a column, from 1; None of a heading."""
    bare = split_unit(name)[0]
    return int(bare) if bare.isdecimal() and 0 < len(bare) < _LONGEST_NUMBER and int(bare) else None


def _position_of(headings: Sequence[str], name: str) -> int | None:
    """Find a column by its heading, by that without its unit, or by its number."""
    position, number = column_of(headings, name), _number(name)
    if position is None:
        position = column_of([split_unit(heading)[0] for heading in headings], name)
    if position is None and number is not None and (not headings or number <= len(headings)):
        return number - 1
    return position


def _given(headings: Sequence[str], meaning: str, name: str) -> Column:
    position = _position_of(headings, name)
    if position is None:
        raise ValueError(f"has no column {name!r}, or more than one, among {listed(headings)}")
    heading, unit = headings[position] if headings else f"column {position + 1}", split_unit(name)[1]
    heading_unit = split_unit(heading)[1]
    # the unit of a voltage is replaced
    if heading_unit and unit and heading_unit != unit and _fits(heading_unit, _UNITS[meaning]):
        raise ValueError(f"the column {heading!r} is not in {unit}: leave the unit out")
    if not (unit := unit or heading_unit):
        raise ValueError(f"{name!r} states no unit: give it in brackets, as in {name + ' [ms]'!r}")
    return Column(meaning, heading, position, unit)


def _recognised(headings: Sequence[str], meaning: str) -> Column:
    """Find a column by its name, or else as the only one with a unit that fits."""
    named = _named(headings, meaning)
    if len(named) > 1:
        raise ValueError(
            f"has two columns for {meaning}, {listed([headings[position] for position in named])}"
        )
    if named:
        bare, unit = split_unit(headings[named[0]])
        if not unit:
            raise ValueError(f"{bare!r} states no unit; {_EXAMPLE}")
        return Column(meaning, headings[named[0]], named[0], unit)
    measured = _measured(headings, meaning)
    if len(measured) != 1:
        among = f"among {listed(headings)}"
        raise ValueError(
            f"has no column {meaning} {among}, nor one column alone in {_UNITS[meaning]}; {_EXAMPLE}"
            f"{_UNTIMED if meaning == 'time' else ''}"
        )
    return Column(meaning, headings[measured[0]], measured[0], split_unit(headings[measured[0]])[1], True)


def _named(headings: Sequence[str], meaning: str) -> list[int]:
    bare = [split_unit(heading)[0].lower().replace(" ", "_") for heading in headings]
    return [position for position, name in enumerate(bare) if name in _NAMES[meaning]]


def _measured(headings: Sequence[str], meaning: str) -> list[int]:
    units = [split_unit(heading)[1] for heading in headings]
    return [position for position, unit in enumerate(units) if unit and _fits(unit, _UNITS[meaning])]


def _fits(unit: str, wanted: str) -> bool:
    try:
        from_text(f"1 {unit}", wanted)
    except ValueError:
        return False
    return True
