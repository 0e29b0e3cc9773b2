"""Base class of loss laws: the change of coverage in one passage, from the exposure of the flank."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.references import Reference
from gearidae.scene.quantity import Quantity

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class Exposure:
    """Exposure of places of the flanks in one passage of a tooth through mesh; arrays of one shape.

    Attributes
    ----------
    contacts : ndarray
        Asperity contacts made on coated flank, per area of it [1/m^2].
    adhesion_work : ndarray
        Energy lost to adhesion on coated flank, per area of it [J/m^2].
    sliding_work : ndarray
        Normal force times sliding distance, per area [J/m^2].
    pressure : ndarray
        Largest nominal pressure [Pa].
    friction_work : ndarray
        Energy lost to friction of the flanks, per area [J/m^2]; 0 without friction.
    """

    contacts: Floats
    adhesion_work: Floats
    sliding_work: Floats
    pressure: Floats
    friction_work: Floats = field(default_factory=lambda: np.zeros(()))


def parameter(unit: str, description: str, **limits: Any) -> Any:
    """Declare a parameter of a law, with its SI unit, its meaning and its limits (as `Quantity` has them)."""
    quantity = Quantity(unit=unit, **({"at_least": 0.0} | limits))
    return field(metadata={"quantity": quantity, "description": description})


@dataclass(frozen=True)
class LossLaw(ABC):
    """A law of the loss of a coating; its fields are its parameters, declared with `parameter`.

    Parameters may be given as texts with a unit.

    Attributes
    ----------
    name : str
        Name of the law.
    source : str
        Its source, and the knowledge of its parameters.
    references : tuple of Reference
        Publications of the law, which `gearidae.cite` names.

    Raises
    ------
    SceneError
        If a parameter is not a number within its limits.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    references: ClassVar[tuple[Reference, ...]] = ()

    def __post_init__(self) -> None:
        """Read the parameters."""
        for entry in fields(self):
            if "quantity" not in entry.metadata:
                continue
            value = getattr(self, entry.name)
            try:
                number = entry.metadata["quantity"].read(value)
            except ValueError as error:
                raise SceneError(f"{self.name}.{entry.name}", value, str(error)) from None
            object.__setattr__(self, entry.name, number)

    @classmethod
    def parameter_units(cls) -> dict[str, str]:
        """Return the SI units of the parameters, without those of a nested law."""
        known = {entry.name: entry.metadata.get("quantity") for entry in fields(cls)}
        return {name: quantity.unit for name, quantity in known.items() if quantity is not None}

    @abstractmethod
    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """Return the change of coverage in one passage, negative for a loss.

        Parameters
        ----------
        fraction : ndarray
            Share of each place that is covered [1].
        exposure : Exposure
            Of one passage, in the same shape.
        """

    def check(self, scene: Scene) -> None:  # noqa: B027  # most laws need nothing
        """Refuse a scene whose flanks are not exposed to what the law needs; all are accepted unless a law says so.

        Raises
        ------
        SceneError
            Naming the key.
        """

    def describe(self) -> dict[str, Any]:
        """Return name and parameters, ready for JSON."""
        return {"name": self.name, **{entry.name: getattr(self, entry.name) for entry in fields(self)}}
