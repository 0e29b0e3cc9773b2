"""Tables that a case file names itself, such as ``[shafts.input]``: kept in their order, and never changed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeVar, get_args

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from gearidae.scene.group import Group, shorten

NAME: Final = "NAME"
"""What stands for a name in the list of all keys."""
_NAME: Final = re.compile(r"[A-Za-z0-9_]{1,40}")

T = TypeVar("T")


class NamedTables(Mapping[str, T]):
    """What a case file holds by names of its own: tables, or numbers.

    Two are equal if names, contents and order are: the order of shafts is that of a result.
    """

    __slots__ = ("_items",)

    def __init__(self, tables: Mapping[str, T]) -> None:
        self._items = dict(tables)

    def __getitem__(self, name: str) -> T:
        """Return what stands under a name."""
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        """Go through the names."""
        return iter(self._items)

    def __len__(self) -> int:
        """Return the number of names."""
        return len(self._items)

    def __eq__(self, other: object) -> bool:
        """Compare names, contents and order."""
        return isinstance(other, NamedTables) and list(self.items()) == list(other.items())

    def __hash__(self) -> int:
        """Hash names and contents."""
        return hash(tuple(self.items()))

    def __repr__(self) -> str:
        """Return the tables as a dictionary is shown."""
        return repr(self._items)

    def __reduce__(self) -> Any:
        """Let copies and pickles be made of the contents."""
        return type(self), (self._items,)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic read and write a dictionary, with names of letters, digits and ``_``."""
        inner = handler.generate_schema(dict[str, get_args(source)[0]])  # type: ignore[misc]
        return core_schema.no_info_after_validator_function(
            cls,
            core_schema.no_info_before_validator_function(_with_names, inner),
            serialization=core_schema.plain_serializer_function_ser_schema(dict, return_schema=inner),
        )


def _with_names(value: object) -> object:
    """Refuse what has no names, and names that could not stand in a key."""
    if isinstance(value, Group) or not isinstance(value, Mapping):
        raise ValueError("must be a table of tables, each with its name")
    for name in value:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise ValueError(f"has the name {shorten(name)}; names have 1..40 letters, digits and _")
    if not value:
        raise ValueError("must not be empty")
    return dict(value)
