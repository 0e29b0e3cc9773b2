"""Which columns of a table are the time and the speed: given, by their names, or by their units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from gearidae.scene.text_table import column_of, listed, split_unit
from gearidae.scene.units import from_text

_NAMES: Final = {"time": ("time", "t"), "gear_speed": ("gear_speed", "speed")}
_UNITS: Final = {"time": "s", "gear_speed": "rad/s"}
_TURNS: Final = ("u/min", "upm", "rev/min", "r/min", "tr/min")
"""Revolutions per minute as sensors' programs write them."""
_EXAMPLE: Final = "name them (columns=..., --columns), or head them such as: time [s], gear_speed [rad/s]"


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
    place: int
    unit: str
    recognised: bool = False


def has_columns(headings: Sequence[str], wanted: tuple[str, str] | None) -> bool:
    """Whether texts are headings of a table with a time and a speed."""
    if wanted is not None:
        return all(column_of(headings, name) is not None for name in wanted)
    named = [_named(headings, meaning) for meaning in _NAMES]
    return all(named) or all(len(_measured(headings, meaning)) == 1 for meaning in _NAMES)


def find_columns(headings: Sequence[str], wanted: tuple[str, str] | None) -> tuple[Column, Column]:
    """Find the columns of time and speed.

    Parameters
    ----------
    wanted : pair of str or None
        Headings of both, with their units where the headings of the table have none.

    Returns
    -------
    tuple of Column
        Time and speed.

    Raises
    ------
    ValueError
        If one of them is not found, is there twice, or states no unit.
    """
    time, speed = (
        _given(headings, meaning, name) if name is not None else _recognised(headings, meaning)
        for meaning, name in zip(_NAMES, wanted or (None, None), strict=True)
    )
    return time, speed


def _given(headings: Sequence[str], meaning: str, name: str) -> Column:
    place = column_of(headings, name)
    if place is None:
        raise ValueError(f"has no column {name!r}, or more than one, among {listed(headings)}")
    unit = split_unit(headings[place])[1] or split_unit(name)[1]
    if not unit:
        raise ValueError(f"{name!r} states no unit: give it in brackets, as in {name + ' [ms]'!r}")
    return Column(meaning, headings[place], place, _spelt(unit))


def _recognised(headings: Sequence[str], meaning: str) -> Column:
    """Find a column by its name, or else as the only one with a unit that fits."""
    named = _named(headings, meaning)
    if len(named) > 1:
        raise ValueError(f"has two columns for {meaning}, {listed([headings[place] for place in named])}")
    if named:
        bare, unit = split_unit(headings[named[0]])
        if not unit:
            raise ValueError(f"{bare!r} states no unit; {_EXAMPLE}")
        return Column(meaning, headings[named[0]], named[0], _spelt(unit))
    measured = _measured(headings, meaning)
    if len(measured) != 1:
        among = f"among {listed(headings)}"
        raise ValueError(
            f"has no column {meaning} {among}, nor one column alone in {_UNITS[meaning]}; {_EXAMPLE}"
        )
    return Column(
        meaning, headings[measured[0]], measured[0], _spelt(split_unit(headings[measured[0]])[1]), True
    )


def _named(headings: Sequence[str], meaning: str) -> list[int]:
    bare = [split_unit(heading)[0].lower().replace(" ", "_") for heading in headings]
    return [place for place, name in enumerate(bare) if name in _NAMES[meaning]]


def _measured(headings: Sequence[str], meaning: str) -> list[int]:
    units = [split_unit(heading)[1] for heading in headings]
    return [place for place, unit in enumerate(units) if unit and _fits(_spelt(unit), _UNITS[meaning])]


def _fits(unit: str, wanted: str) -> bool:
    try:
        from_text(f"1 {unit}", wanted)
    except ValueError:
        return False
    return True


def _spelt(unit: str) -> str:
    return "rpm" if unit.lower().replace(" ", "") in _TURNS else unit
