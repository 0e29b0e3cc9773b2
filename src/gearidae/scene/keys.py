"""Every key a scene has: what it means, its unit, its default; and how to set one by its dotted name."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final, get_args, get_origin

from pydantic.fields import FieldInfo

from gearidae.errors import SceneError
from gearidae.scene.group import Group, did_you_mean, shorten
from gearidae.scene.named import Named
from gearidae.scene.named_tables import NAME, NamedTables
from gearidae.scene.quantity import Count, Quantity

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

_LONGEST_KEY = 200
INSTEAD: Final = {
    "gears.module": ("gears.pinion_base_radius",),
    "contact.model": ("contact.bodies", "contact.roughness"),
    "gears.density": ("gears.pinion_inertia", "gears.gear_inertia"),
}
"""Keys that are given in the place of others, in which a scene keeps what they say."""


@dataclass(frozen=True, slots=True)
class KeyInfo:
    """Description of one key of a scene.

    Attributes
    ----------
    key : str
        Dotted name; entries of a list of tables go without their number (``drive.harmonic.amplitude``), and ``NAME``
        stands for a name of the user's own (``shafts.NAME.inertia``).
    unit : str
        SI unit, ``"1"`` for pure numbers and counts, empty for texts and lists.
    required : bool
        Whether it must be given once its table is.
    default : object
        Its value when not given; None if required, an empty tuple for a list or a table that is not there.
    allowed : str
        What it may hold, in words.
    description : str
        What it means.
    """

    key: str
    unit: str
    required: bool
    default: Any
    allowed: str
    description: str


@cache
def keys_of(model: type[Group]) -> tuple[KeyInfo, ...]:
    """List every key of a table and of the tables in it, in the order of a case file."""
    return tuple(_walk(model, ""))


def find_key(model: type[Group], key: str, value: object = "(key)") -> KeyInfo:
    """Look up one dotted key, ignoring the numbers of list entries; `value` is what the message shows.

    Raises
    ------
    SceneError
        If there is no such key.
    """
    if not isinstance(key, str) or len(key) > _LONGEST_KEY:
        raise SceneError(
            str(shorten(key)), shorten(value), "is no key; a key is a short text, such as run.duration"
        )
    plain = _plain(model, key)
    known = {info.key: info for info in keys_of(model)}
    if plain not in known and (info := _open_key(model, plain)) is not None:
        return info
    if plain not in known:
        names = plain != key and NAME in plain.split(".")
        if names and plain.count(".") == 1:
            raise SceneError(key, shorten(value), "is a table and no key: name one of its keys")
        alike = [name for name in known if (NAME in name.split(".")) == names]
        said = _unknown(plain if names else key, [*alike, *model.model_fields])
        raise SceneError(
            str(shorten(key)), shorten(value), said.replace(NAME, key.split(".")[1]) if names else said
        )
    return known[plain]


def _plain(model: type[Group], key: str) -> str:
    """Write a key as the list of all keys has it: without numbers of list entries, NAME for names of tables."""
    parts: list[str] = []
    inside: Any = model
    for part in key.split("."):
        if (named := _named(inside)) is not None:
            parts.append(NAME)
            inside = named
        elif not part.isdecimal():
            parts.append(part)
            table = inside if inside is model else _table(inside)[0]
            field = table.model_fields.get(part) if table else None
            inside = field.annotation if field else None
    return ".".join(parts)


def _named(annotation: Any) -> Any:
    """Find what a field holds by names of the user's own; None where it is something else."""
    for inner in (annotation, *get_args(annotation)):
        if get_origin(inner) is NamedTables:
            return get_args(inner)[0]
    return None


def _open_key(model: type[Group], key: str) -> KeyInfo | None:
    """Look up a key of a table that has more keys than fields."""
    *path, last = key.split(".")
    table: type[Group] | None = model
    for part in path:
        table = (
            _table(table.model_fields[part].annotation)[0] if table and part in table.model_fields else None
        )
    entry = table.open_key(last) if table else None
    if entry is None:
        return None
    unit, description = entry
    allowed = f"a number in {unit or 'SI'} or a text with a unit"
    return KeyInfo(key, unit, required=False, default=None, allowed=allowed, description=description)


def put(model: type[Group], data: dict[str, Any], key: str, value: object) -> None:
    """Set one dotted key, or a whole table, in the plain tables of a scene.

    Parameters
    ----------
    model : type of Group
        The scene's model.
    data : dict
        Tables as ``Scene.to_dict`` gives them; changed in place.
    key : str
        Dotted name. ``drive.harmonic.0.amplitude`` names a list's entry; a list of one needs no number.
    value : object
        What to put there; None for a table takes it away, and None or an empty list takes away a list that need
        not be given (a schedule, harmonics).

    Raises
    ------
    SceneError
        If there is no such key, or the scene lacks the table it belongs to.
    """
    value = value.plain_tables(exclude_none=True) if isinstance(value, Group) else value
    if isinstance(key, str) and key in model.model_fields:
        try:  # dotted keys may change a table later
            data[key] = deepcopy(value) if isinstance(value, dict) else value
        except RecursionError:
            raise SceneError(key, shorten(value), "is nested too deeply") from None
        return
    if isinstance(key, str) and _is_own_table(model, key):
        _put_own_table(data, key, value)
        return
    info = find_key(model, key, value)
    *path, last = key.split(".")
    inside: Any = data
    for depth, part in enumerate(path):
        if depth > 1 and isinstance(inside, dict) and not _is_nothing(value):
            inside.setdefault(part, {})  # a table in one of a train's, of keys that need not be given
        inside = _entry(inside, part)
    if isinstance(inside, list) and len(inside) == 1 and not last.isdecimal():
        inside = inside[0]
    if isinstance(inside, dict) and key in INSTEAD and not _is_nothing(value):
        for other in INSTEAD[key]:
            inside.pop(other.rpartition(".")[2], None)
    if isinstance(inside, dict) and info.default == () and _is_nothing(value):
        inside.pop(last, None)
    elif isinstance(inside, dict):
        inside[last] = value
    elif isinstance(inside, list) and _entry(inside, last) is not None:
        inside[int(last)] = value
    else:
        raise SceneError(key, shorten(value), _nothing_there(data, key))


def _is_own_table(model: type[Group], key: str) -> bool:
    """Whether a key names a whole table by a name of the user's own, as ``shafts.idler``."""
    table, _, name = key.partition(".")
    field = model.model_fields.get(table)
    return bool(name) and "." not in name and field is not None and _named(field.annotation) is not None


def _put_own_table(data: dict[str, Any], key: str, value: object) -> None:
    """Set, add or take away one table of a train."""
    table, _, name = key.partition(".")
    tables = data.get(table)
    if not isinstance(tables, dict) or (value is None and name not in tables):
        raise SceneError(key, shorten(value), _nothing_there(data, key))
    if value is None:
        del tables[name]
    else:
        tables[name] = deepcopy(value) if isinstance(value, dict) else value


def _nothing_there(data: Mapping[str, Any], key: str) -> str:
    """Say that a scene lacks what a key is to change, and what it has where the key leads nowhere."""
    inside: Any = data
    there = "the scene"
    for part in key.split("."):
        if not isinstance(inside, Mapping) or part not in inside:
            break
        inside, there = inside[part], part if there == "the scene" else f"{there}.{part}"
    words = "this scene has no such table or entry to change"
    return (
        f"{words}; in {there} there are {', '.join(map(str, inside))}"
        if isinstance(inside, Mapping)
        else words
    )


def scene_value(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in SI units, as plain data; None where the scene has none."""
    inside: Any = scene.to_dict()
    for part in key.split("."):
        if isinstance(inside, list) and len(inside) == 1 and not part.isdecimal():
            inside = inside[0]  # a list of one may go without its number
        inside = _entry(inside, part)
    return inside


def _is_nothing(value: object) -> bool:
    """Whether a value is None, or a list or an array without entries."""
    return value is None or (isinstance(value, (list, tuple)) and not value) or getattr(value, "size", 1) == 0


def _entry(inside: Any, part: str) -> Any:
    """Go one step down a dotted key; None where that leads nowhere."""
    if isinstance(inside, dict):
        return inside.get(part)
    if isinstance(inside, list) and part.isdecimal() and int(part) < len(inside):
        return inside[int(part)]
    return None


def _walk(model: type[Group], prefix: str) -> Iterator[KeyInfo]:
    for name, field in model.model_fields.items():
        key = f"{prefix}{name}"
        table, is_list = _table(field.annotation)
        if (named := _named(field.annotation)) is not None:
            if prefix:
                yield _describe(key, field)
                yield _describe(f"{key}.{NAME}", FieldInfo.from_annotation(named), field)
            else:
                yield from _walk(named, f"{key}.{NAME}.")
            continue
        if table is None or is_list or prefix:  # tables of the scene itself are no keys
            yield _describe(key, field)
        if table is not None:
            yield from _walk(table, f"{key}.")


def _table(annotation: Any) -> tuple[type[Group] | None, bool]:
    """Find the model that a field holds, alone or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, Group):
        return annotation, False
    if get_origin(annotation) is not NamedTables:
        for inner in get_args(annotation):
            table, is_list = _table(inner)
            if table is not None:
                return table, is_list or Ellipsis in get_args(annotation)
    return None, False


def _describe(key: str, field: FieldInfo, within: FieldInfo | None = None) -> KeyInfo:
    """Describe a field, or an entry of the numbers that another holds by names."""
    number = next((entry for entry in field.metadata if isinstance(entry, (Quantity, Count))), None)
    named = next((entry for entry in field.metadata if isinstance(entry, Named)), None)
    args = get_args(field.annotation)
    choices = [entry for arg in args for entry in (get_args(arg) or (arg,)) if isinstance(entry, str)]
    if number is not None:
        allowed = number.allowed().removeprefix("must be ")
    elif named is not None:
        allowed = named.allowed().removeprefix("must be ")
    elif choices:
        allowed = "one of " + ", ".join(choices)
    elif field.annotation is bool:
        allowed = "true or false"
    elif _named(field.annotation) or (
        _table(field.annotation)[0] is not None and not _table(field.annotation)[1]
    ):
        allowed = "a table"
    else:
        allowed = "a text" if str in (field.annotation, *args) else "a list"
    return KeyInfo(
        key=key,
        unit=number.unit if isinstance(number, Quantity) else "1" if number else "",
        required=field.is_required() and within is None,
        default=() if within or field.default is None else None if field.is_required() else field.default,
        allowed=allowed,
        description=(within or field).description or "",
    )


def _unknown(key: str, known: list[str]) -> str:
    """Say what an unknown dotted key may have meant."""
    table, number = _numbered(key)
    key = key.replace(f"{table}.{number}", table)  # known keys have no numbers of list entries
    last = key.rpartition(".")[2]
    alike = [name for name in known if name.rpartition(".")[2] == last]
    tables = difflib.get_close_matches(key.rpartition(".")[0], {name.rpartition(".")[0] for name in alike})
    homes = " or ".join(name for name in alike if not tables or name.rpartition(".")[0] in tables)
    within = key.rpartition(".")[0]
    beside = [name.rpartition(".")[2] for name in known if within and name.rpartition(".")[0] == within]
    if homes:
        question = f"did you mean {homes}?"
    elif beside:  # the table is right: no key of another is meant, however alike the whole words are
        meant = did_you_mean(last, beside)
        question = meant.replace("mean ", f"mean {within}.") if meant else f"known are {', '.join(beside)}"
    else:
        question = did_you_mean(key, known)
    if number:
        question = question.replace(f"{table}.", f"{table}.{number}.")
    return f"unknown key; {question or 'gearidae.scene.describe_keys() lists them'}"


def _numbered(key: str) -> tuple[str, str]:
    """Find the list that a key names an entry of, and the entry's number; without one, that is empty."""
    parts = key.split(".")
    index = next((index for index, part in enumerate(parts) if part.isdecimal()), len(parts))
    return ".".join(parts[:index]), "".join(parts[index : index + 1])
