"""Types of the numbers in a scene: each carries its SI unit and what it may be.

Used as ``Annotated`` metadata, so that a model's fields hold plain floats and ints, and the list of keys, the
messages and the written case files all come from one place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.errors import SceneError
from gearidae.scene.carried import number_of
from gearidae.scene.group import shorten
from gearidae.scene.units import from_text


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bounded:
    """Shared by `Quantity` and `Count`: limits, and their wording.

    Attributes
    ----------
    above, at_least, below, at_most : float, optional
        Limits, the first and third exclusive.
    least : float, optional
        Smallest size of a number that is not zero: below it, products of scaled numbers leave the range of a double.
    """

    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    least: float | None = None

    def admits(self, value: float) -> bool:
        """Whether `value` keeps to the limits."""
        return (
            (self.above is None or value > self.above)
            and (self.at_least is None or value >= self.at_least)
            and (self.below is None or value < self.below)
            and (self.at_most is None or value <= self.at_most)
            and (self.least is None or value == 0.0 or abs(value) >= self.least)
        )

    def admits_all(self, values: NDArray[np.float64]) -> bool:
        """Whether each of several values keeps to the limits: those of their range and size decide."""
        if not np.isfinite(values).all():
            return False
        smallest = np.abs(values[values != 0.0]).min(initial=math.inf)
        return self.admits(values.min()) and self.admits(values.max()) and smallest >= (self.least or 0.0)

    def range(self) -> str:
        """Return the limits in words, empty without any."""
        if self.at_least is not None and self.at_most is not None:
            return f"in {self.at_least:g}..{self.at_most:g}"
        words = (
            ("above", self.above),
            ("at least", self.at_least),
            ("below", self.below),
            ("at most", self.at_most),
        )
        return " and ".join(f"{word} {limit:g}" for word, limit in words if limit is not None)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic call `read` in place of its own conversion."""
        return core_schema.no_info_plain_validator_function(self.read)

    def limits(self) -> dict[str, float]:
        """Return the limits as JSON Schema has them."""
        named = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        return {name: limit for name, limit in named.items() if limit is not None}

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here: a number within the limits."""
        return {"type": "integer", **self.limits()}

    def read(self, value: object) -> float:
        """Turn what the user gave into a number within the limits."""
        raise NotImplementedError

    def take(self, name: str, value: object) -> float:
        """Read a setting of this name as `read` does; a `SceneError` says what is wrong with it."""
        try:
            return self.read(value)
        except ValueError as error:
            raise SceneError(name, shorten(value), str(error)) from None


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity(_Bounded):
    """A float in SI units.

    Attributes
    ----------
    unit : str
        SI unit in pint's spelling, ``"1"`` for a pure number.
    shown : tuple of (str, int), optional
        Unit in which `dump_case` writes it, and the power of ten that this unit is.
    """

    unit: str
    shown: tuple[str, int] | None = None

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here: a number in SI units, or a text with a unit."""
        unit = "no unit" if self.unit == "1" else f"a unit of {self.unit}"
        number = {"type": "number", **self.limits(), "description": self.unit}
        return {"anyOf": [number, {"type": "string", "description": f"a number with {unit}"}]}

    def read(self, value: object) -> float:
        """Read a number in SI or a text with a unit.

        Parameters
        ----------
        value : object
            What the user gave.

        Raises
        ------
        ValueError
            Saying what is allowed.
        """
        number = from_text(value, self.unit) if isinstance(value, str) else number_of(value, self.unit)
        if number is None:
            raise ValueError(self.allowed())
        if not math.isfinite(number):
            raise ValueError("must be a finite number")
        if not self.admits(number):
            raise ValueError(f"must {self._wanted()}")
        return number

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        if self.unit == "1":
            return "must be a number" + (f" {self.range()}" if self.range() else "")
        return f"must be a number in {self.unit} or a text with a unit" + (
            f", {self.range()} {self.unit}{self._small()}" if self.range() else ""
        )

    def _wanted(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{'lie' if self.range().startswith('in ') else 'be'} {self.range()}{unit}{self._small()}"

    def _small(self) -> str:
        """Say how small a number may be that is not zero."""
        return f", 0 or at least {self.least:g} in size" if self.least is not None else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Count(_Bounded):
    """A whole number."""

    def read(self, value: object) -> int:
        """Read a whole number, also one written as 1e4.

        Parameters
        ----------
        value : object
            What the user gave.

        Raises
        ------
        ValueError
            Saying what is allowed.
        """
        number = number_of(value, "1")
        if number is None or not number.is_integer() or not self.admits(number):
            quoted = isinstance(value, str) and value.strip().isdecimal()
            raise ValueError(self.allowed() + ", without quotes" * quoted)
        return int(number)

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        bare = self.at_most is None and self.at_least is not None
        return f"must be a whole number{f', {self.at_least:g} or more' if bare else f' {self.range()}'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling(Count):
    """How often to sample: a whole number of samples, a rate, ``"off"`` or ``"ringing"``."""

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here."""
        number = {"type": "integer", **self.limits()}
        rate = {"type": "string", "description": "a rate with its unit"}
        return {"anyOf": [number, {"enum": ["off", "ringing"]}, rate]}

    def read(self, value: object) -> int | str:  # type: ignore[override]
        """Read a number of samples, or a text that is a rate, ``"off"`` or ``"ringing"``.

        Parameters
        ----------
        value : object
            What the user gave.

        Returns
        -------
        int or str
            A rate in the form ``"20000.0 Hz"``, `rate` of which is the float that was given.

        Raises
        ------
        ValueError
            Saying what is allowed.
        """
        if not isinstance(value, str):
            # Count's own method by name: slots make a class anew, and super() would look for the old one
            return Count.read(self, value)
        if (word := value.strip().lower()) in ("off", "ringing"):
            return word
        rate = from_text(value, "Hz")
        if not (math.isfinite(rate) and rate > 0.0):
            raise ValueError("must be a rate above 0 Hz")
        return f"{rate!r} Hz"

    def allowed(self) -> str:
        """Return what may stand here, in words."""
        return f'must be a whole number {self.range()}, a rate ("20 kHz"), "ringing", or "off"'

    @staticmethod
    def rate(text: str) -> float:
        """Return the rate [Hz] in a text as `read` makes it."""
        return float(text.removesuffix(" Hz"))


def whole(name: str, value: object, least: int, most: int | None = None) -> int:
    """Read a setting that is a whole number from `least` to `most`; a `SceneError` says what is wrong with it."""
    return int(Count(at_least=least, at_most=most).take(name, value))


Phase = Annotated[float, Quantity(unit="rad", at_least=-1e9, at_most=1e9)]
"""Phase of a harmonic; a larger one would be known to less than a millionth of a radian."""


def _read_switch(value: object) -> bool:
    """Read true or false, also numpy's; what is merely like one of them, such as 0 or "no", is refused."""
    value = value.item() if isinstance(value, np.bool_) else value
    if not isinstance(value, bool):
        quoted = isinstance(value, str) and value.strip().lower() in ("true", "false")
        raise ValueError("must be true or false" + ", without quotes" * quoted)
    return value


def number(name: str, value: object, unit: str = "1") -> float:
    """Read a setting that is a finite number, or a text with a unit; a `SceneError` says what is wrong with it."""
    return Quantity(unit=unit).take(name, value)


def switch(name: str, value: object) -> bool:
    """Read a setting that is true or false; a `SceneError` says what is wrong with it."""
    try:
        return _read_switch(value)
    except ValueError as error:
        raise SceneError(name, shorten(value), str(error)) from None


Switch = Annotated[bool, BeforeValidator(_read_switch)]
"""True or false."""
