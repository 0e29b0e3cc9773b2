"""The type of a text in a scene that names one of several things known by their names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.scene.group import did_you_mean


@dataclass(frozen=True, slots=True)
class Named:
    """A name out of a list that may grow while the program runs.

    Attributes
    ----------
    names : callable
        Returns the names that are known now.
    """

    names: Callable[[], tuple[str, ...]]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic call `read` before it takes the value for a text."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here: one of the names that are known now."""
        return {"type": "string", "enum": list(self.names())}

    def read(self, value: object) -> str:
        """Return a name that is known.

        Parameters
        ----------
        value : object
            What the user gave.

        Raises
        ------
        ValueError
            Saying which names are known.
        """
        if not isinstance(value, str) or value not in self.names():
            meant = did_you_mean(value, self.names()) if isinstance(value, str) else ""
            raise ValueError("; ".join(filter(None, (self.allowed(), meant))))
        return value

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        return "must be one of " + ", ".join(self.names())
