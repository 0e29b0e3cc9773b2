"""A scene written as a case file, with units and a comment on every key."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any

from pydantic.fields import FieldInfo

from gearidae.scene.asperity_list import ListedAsperities
from gearidae.scene.group import Group
from gearidae.scene.keys import keys_of
from gearidae.scene.knots import Knots
from gearidae.scene.named_tables import NamedTables
from gearidae.scene.quantity import Quantity
from gearidae.scene.roughnesses import InRoughnesses
from gearidae.scene.scene import Scene

_LONGEST_BESIDE = 80
"""Characters of an entry that still has its comment beside it."""


def dump_case(scene: Scene, *, every_key: bool = False) -> str:
    """Write a scene as the text of a case file.

    Parameters
    ----------
    scene : Scene
    every_key : bool, optional
        Whether keys that the scene's tables may have, and have not, are written too, as comments.

    Returns
    -------
    str
        TOML; `load_case` makes an equal scene of it, to the last bit.
    """
    lines = [f"name = {_text(scene.name)}"]
    for table, group in scene:
        if isinstance(group, NamedTables):
            for name, entry in group.items():
                lines += ["", f"[{table}.{name}]", *_table(entry)]
                for key in type(entry).model_fields:
                    lines += _list_of_tables(f"{table}.{name}", key, entry, every_key=False)
        if isinstance(group, Group):
            description = Scene.model_fields[table].description
            lines += ["", f"[{table}]  # {description}", *_table(group, table if every_key else "")]
            lines += [
                line
                for name in type(group).model_fields
                for line in _list_of_tables(table, name, group, every_key=every_key)
            ]
    return "\n".join(lines) + "\n"


def dump_keys(table: str, values: Mapping[str, float | str]) -> str:
    """Write some keys of one table of a scene as they stand in a case file.

    Parameters
    ----------
    table : str
        Such as ``"surface"``; of a table that every scene has.
    values : mapping of str to float or str
        Names of keys without that of the table, and what they hold: numbers in SI, or texts.

    Returns
    -------
    str
        TOML: a part of a case file, which `load_case` reads once the other keys are added.
    """
    fields = Scene.model_fields[table].annotation.model_fields  # type: ignore[union-attr]
    entries = [
        (f"{name} = {_value(value, _quantity(fields[name]))}", fields[name].description)
        for name, value in values.items()
    ]
    return "\n".join([f"[{table}]", *_commented(entries)]) + "\n"


def _quantity(field: FieldInfo) -> Quantity | None:
    return next((entry for entry in field.metadata if isinstance(entry, Quantity)), None)


def _table(group: Group, absent_in: str = "") -> Iterator[str]:
    """Write a table's plain keys, and its schedule; also what it lacks, if its name is given."""
    entries = []
    for name, field in type(group).model_fields.items():
        value = getattr(group, name)
        if isinstance(value, tuple):
            if isinstance(value, ListedAsperities):
                if value:
                    entries.append((f"{name} = {_columns(value)}", field.description))
            elif value and isinstance(value[0], float):
                entries.append((f"{name} = {_plain(value)}", field.description))
            elif isinstance(value, Knots) and value:
                entries.append((f"{name} = {_knots(value)}", field.description))
            elif value and not isinstance(value[0], Group):
                entries.append((f"{name} = {_rows(value)}", field.description))
            continue
        if value is None:
            continue
        if isinstance(value, NamedTables):
            numbers = ", ".join(f"{key} = {number}" for key, number in value.items())
            entries.append((f"{name} = {{ {numbers} }}", field.description))
            continue
        if isinstance(value, Group):
            entries.append((f"{name} = {_inline(value)}", field.description))
            continue
        if value == "":
            continue  # a text that need not be given
        entries.append((f"{name} = {_value(value, _quantity(field))}", field.description))
    yield from _commented(entries)
    if absent_in:
        yield from _absent(absent_in, group)


def _commented(entries: Sequence[tuple[str, str | None]]) -> Iterator[str]:
    """Write a comment beside each entry, or above long ones."""
    long = {text for text, _ in entries if "\n" in text or len(text) > _LONGEST_BESIDE}
    width = max((len(text) for text, _ in entries if text not in long), default=0)
    for text, description in entries:
        yield f"# {description}\n{text}" if text in long else f"{text:<{width}}  # {description}"


def _absent(table: str, group: Group) -> Iterator[str]:
    """Write keys that a table does not have as comments, with their units or the keys inside them."""
    for name, field in type(group).model_fields.items():
        if getattr(group, name) not in (None, "", ()):
            continue
        above = f"{table}.{name}."
        inside = [info.key.removeprefix(above) for info in keys_of(Scene) if info.key.startswith(above)]
        quantity = _quantity(field)
        value = _text(f"... {quantity.unit}") if quantity and quantity.unit != "1" else "..."
        if inside:
            value = f"{{ {', '.join(f'{key} = ...' for key in inside)} }}"
        yield f"# {name} = {value}  # {field.description}"


def _knots(knots: Knots) -> str:
    """Write a schedule, one knot in a line."""
    text = "[\n" + "".join(f"    [{time!r}, {value!r}],\n" for time, value in knots) + "]"
    settings = "".join(f"{key} = {_plain(value)}, " for key, value in knots.settings().items())
    return f"{{ {settings}knots = {text} }}" if settings else text


def _columns(listed: ListedAsperities) -> str:
    """Write a list of asperities by its columns, one in a line; a cell without a number is an empty text."""
    lists = {
        name: ", ".join(
            '""' if cell is None else _text(cell) if isinstance(cell, str) else repr(cell) for cell in cells
        )
        for name, cells in listed.columns.items()
    }
    return "{ " + ", ".join(f"{name} = [\n    {cells}\n]" for name, cells in lists.items()) + " }"


def _rows(rows: tuple[tuple[float, ...], ...]) -> str:
    """Write a table of numbers, one row in a line."""
    return "[\n" + "".join(f"    {_plain(row)},\n" for row in rows) + "]"


def _inline(group: Group) -> str:
    """Write a small table in one line, without empty lists."""
    fields = [*((name, getattr(group, name)) for name in type(group).model_fields)]
    fields += (group.model_extra or {}).items()
    return (
        f"{{ {', '.join(f'{name} = {_plain(value)}' for name, value in fields if value not in ((), None))} }}"
    )


def _plain(value: Any) -> str:
    """Write a text, an SI number, a list of numbers or of lists, or one of asperities."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, ListedAsperities):
        return _columns(value)
    return f"[{', '.join(map(_plain, value))}]" if isinstance(value, tuple) else repr(value)


def _list_of_tables(table: str, name: str, group: Group, *, every_key: bool) -> Iterator[str]:
    value = getattr(group, name)
    if isinstance(value, tuple):
        for entry in value:
            if isinstance(entry, Group):
                yield from ("", f"[[{table}.{name}]]", *_table(entry, f"{table}.{name}" if every_key else ""))


def _value(value: Any, quantity: Quantity | None) -> str:
    """Write one value, with a unit that people use where it is exact."""
    if isinstance(value, (str, InRoughnesses)):
        return _text(str(value))
    if isinstance(value, bool):
        return "true" if value else "false"
    if quantity is None or quantity.unit == "1":
        return repr(value)
    if quantity.unit == "rad":
        degrees = f"{math.degrees(value):.12g} deg"
        if quantity.read(degrees) == value:
            return _text(degrees)
    unit, power = quantity.shown or (quantity.unit, 0)
    number = Decimal(repr(value)).scaleb(-power)
    plain = (
        f"{number.normalize():f}" if -5 < number.adjusted() < 12 or not number else f"{number.normalize():e}"
    )
    return _text(f"{plain} {unit}")


def _text(text: str) -> str:
    """Write a text as a TOML basic string; printable ones need no more than JSON's escapes."""
    return json.dumps(text, ensure_ascii=False)
