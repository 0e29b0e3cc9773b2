"""Lengths that may be given as a number of roughnesses: ``"6 sigma"``.

A scene keeps what was given, so that the length follows when the roughness is changed, swept or drawn.
"""

from __future__ import annotations

from decimal import Decimal, DecimalException
from typing import Any, Final

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.scene.quantity import Quantity

_UNIT: Final = "sigma"


class InRoughnesses(float):
    """A length [m] that was given as a number of roughnesses.

    Parameters
    ----------
    number : decimal.Decimal
        Of roughnesses.
    roughness : float, optional
        The rms roughness [m]; without one the length is NaN, as it is until the scene sets it.
    """

    number: Decimal

    def __new__(cls, number: Decimal, roughness: float | None = None) -> InRoughnesses:
        """Multiply in decimals: six times 6 nm is the float nearest to 36 nm."""
        length = "nan" if roughness is None else number * Decimal(repr(roughness))
        made = super().__new__(cls, length)
        made.number = number
        return made

    def __reduce__(self) -> Any:
        """Let copies and pickles keep both, to the last bit."""
        return _restored, (self.number, float(self))

    def __str__(self) -> str:
        """Return the text that it is read from."""
        return f"{self.number.normalize():f} {_UNIT}"


def _restored(number: Decimal, length: float) -> InRoughnesses:
    made = float.__new__(InRoughnesses, length)
    made.number = number
    return made


class Length(Quantity):
    """A length in SI units, or in roughnesses."""

    def read(self, value: object) -> float:
        """Read a number, a text with a unit, or a number of roughnesses.

        Parameters
        ----------
        value : object
            What the user gave.

        Returns
        -------
        float
            An `InRoughnesses` of such a number.

        Raises
        ------
        ValueError
            Saying what is allowed.
        """
        if isinstance(value, InRoughnesses):
            return value
        if not isinstance(value, str) or not value.strip().endswith(_UNIT):
            return Quantity.read(self, value)
        try:
            number = Decimal(value.strip().removesuffix(_UNIT).strip())
        except DecimalException:
            raise ValueError(self.allowed()) from None
        if not number.is_finite() or abs(number) > 1_000_000_000:
            raise ValueError("must be a finite number")
        return InRoughnesses(number)

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        return f'{Quantity.allowed(self)}, or in roughnesses ("6 {_UNIT}")'

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic call `read`, and write what was given."""

        def write(value: float) -> Any:
            return str(value) if isinstance(value, InRoughnesses) else value

        return core_schema.no_info_plain_validator_function(
            self.read, serialization=core_schema.plain_serializer_function_ser_schema(write)
        )

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here."""
        number = {"type": "number", **self.limits(), "description": self.unit}
        text = f"a number with a unit of {self.unit}, or with {_UNIT}, the roughness"
        return {"anyOf": [number, {"type": "string", "description": text}]}
