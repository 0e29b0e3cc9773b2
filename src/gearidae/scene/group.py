"""The common frame of every table of a scene: frozen, no unknown keys, one-line errors."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator, Mapping
from numbers import Real
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import PydanticSerializationError

from gearidae.errors import SceneError

_LONGEST_VALUE = 60
_MISSING = "(missing)"
_UNKNOWN = "unknown key; "
_NOT_NOTED: set[str] = set()
"""Shared by all tables, and never changed."""


class Group(BaseModel):
    """A table of a scene. Instances are immutable, comparable and hashable.

    Raises
    ------
    SceneError
        On construction, if a key is unknown, missing or holds what it may not.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __init__(self, **data: Any) -> None:
        known = type(self).known_keys(data)
        for key, value in data.items():
            if key not in known:
                raise SceneError(key, shorten(value), self._unknown(key, known))
            for table in value if isinstance(value, (list, tuple)) else (value,):
                if isinstance(table, Mapping) and not all(isinstance(inner, str) for inner in table):
                    raise SceneError(key, shorten(table), "keys must be texts")
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise _scene_error(error, self._elsewhere) from error
        # pydantic notes which fields were given, which nobody asks: as sets of their own most of a scene's memory
        object.__setattr__(self, "__pydantic_fields_set__", _NOT_NOTED)

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse: scenes are frozen."""
        raise SceneError(name, shorten(value), "scenes cannot be changed in place; use scene.replace({...})")

    @classmethod
    def known_keys(cls, data: Mapping[str, Any]) -> list[str]:
        """Return the keys that a table with this content may have."""
        return list(cls.model_fields)

    @classmethod
    def open_key(cls, name: str) -> tuple[str, str] | None:
        """Return unit and description of a key that is no field; None where every key is a field."""
        return None

    def plain_tables(self, **options: Any) -> dict[str, Any]:
        """Return pydantic's dump: plain tables, lists, texts and numbers, ready for JSON.

        pydantic makes an error of its own out of whatever a field's serializer raises, of a `KeyboardInterrupt` too.
        """
        try:
            return self.model_dump(mode="json", **options)
        except PydanticSerializationError as error:
            raise (error.__cause__ or error) from None

    @classmethod
    def _unknown(cls, key: str, known: list[str]) -> str:
        """Say what to write in place of an unknown `key`."""
        meant = did_you_mean(key, known) or _meant(cls._elsewhere(key))
        return _UNKNOWN + (meant or "known are " + ", ".join(known))

    @classmethod
    def _elsewhere(cls, name: str) -> list[str]:
        """Return the dotted keys of this name in the tables of a scene; a table alone knows no other."""
        return []


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return a question naming the known word that begins with `word` or is closest to it, empty if none is close."""
    known = list(known)
    begun = [name for name in known if name.startswith(word)]
    close = begun if len(begun) == 1 else difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return _meant(close)


def _meant(keys: list[str]) -> str:
    return f"did you mean {' or '.join(keys)}?" if keys else ""


def shorten(value: object) -> object:
    """Return `value` fit for a message: numbers as they are, anything else as a short printable text."""
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**_LONGEST_VALUE):
        return value
    try:
        readable = isinstance(value, Real) or (
            isinstance(value, str) and value.isprintable() and value.strip()
        )
        text = str(value) if readable else repr(value)
    except Exception:  # rude objects, integers too long for Python to spell: the message must still come out
        text = f"({type(value).__name__})"
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def _scene_error(error: ValidationError, elsewhere: Callable[[str], list[str]]) -> SceneError:
    """Turn pydantic's report into one line: its first complaint, all missing keys, and how many there are besides.

    A key that stands in the wrong table is named with its tables, from `elsewhere`.
    """
    (key, value, allowed), *others = _complaints(error)
    if allowed.startswith(_UNKNOWN):
        homes = _meant(elsewhere(key.rpartition(".")[2]))
        allowed = _UNKNOWN + homes if homes else allowed
    if value == _MISSING and (also := [other for other, what, _ in others if what == _MISSING]):
        allowed += f"; so {'is' if len(also) == 1 else 'are'} {', '.join(also)}"
        others = [other for other in others if other[0] not in also]
    if others:
        allowed += f" (and {len(others)} more {'error' if len(others) == 1 else 'errors'})"
    return SceneError(key, value, allowed)


def _complaints(error: ValidationError) -> Iterator[tuple[str, object, str]]:
    """Yield key, value and what is allowed for every complaint, those of nested tables too."""
    for complaint in error.errors(include_url=False):
        where = "".join(
            f"[{part}]" if isinstance(part, int) else f".{part}" for part in complaint["loc"]
        ).lstrip(".")
        reason = complaint.get("ctx", {}).get("error")
        if isinstance(reason, SceneError | ValidationError):
            inner = reason if isinstance(reason, ValidationError) else reason.__cause__
            nested: Iterable[tuple[str, object, str]] = ()
            if isinstance(inner, ValidationError):
                nested = _complaints(inner)
            elif isinstance(reason, SceneError):
                nested = [(reason.key, reason.value, reason.allowed)]
            for key, value, allowed in nested:
                inside = key if key.startswith("[") or not key else f".{key}"
                yield f"{where}{inside}".lstrip("."), value, allowed
        elif complaint["type"] == "missing":
            yield where, _MISSING, f"is required: {_description(error.title, where)}"
        elif complaint["type"] in ("model_type", "dict_type"):
            yield where, shorten(complaint["input"]), "must be a table"
        elif complaint["type"] == "literal_error":
            yield where, shorten(complaint["input"]), f"must be {complaint['ctx']['expected']}"
        else:
            yield where, shorten(complaint["input"]), str(reason or complaint["msg"])


def _description(title: str, name: str) -> str:
    """Look up what a field of the table class `title` means."""
    model = next(model for model in _tables_of(Group) if model.__name__ == title)
    return model.model_fields[name].description or name


def _tables_of(base: type[Group]) -> Iterator[type[Group]]:
    """Yield every class of tables."""
    for table in base.__subclasses__():
        yield table
        yield from _tables_of(table)
