"""Stress-assisted loss: a law times Arrhenius' factor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.references import Reference
from gearidae.wear.base import Exposure, LossLaw, parameter

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

BOLTZMANN = 1.380649e-23
"""J/K, exact (SI)."""

_ZHURKOV = Reference(
    "zhurkov1965",
    ("S. N. Zhurkov",),
    "Kinetic concept of the strength of solids",
    1965,
    "International Journal of Fracture Mechanics",
    "1",
    "311-323",
)
_GOTSMANN = Reference(
    "gotsmann2008",
    ("B. Gotsmann", "M. A. Lantz"),
    "Atomistic wear in a single asperity sliding contact",
    2008,
    "Physical Review Letters",
    "101",
    "125501",
    doi="10.1103/PhysRevLett.101.125501",
)


@dataclass(frozen=True)
class Arrhenius(LossLaw):
    r"""Another law times :math:`\exp(-(E_a - p V_a) / k_B T)`; the factor is at most one.

    The pressure p is the largest nominal pressure of the place. The pressure of a single asperity is larger by the
    ratio of nominal to real contact area, which the activation volume has to include.
    """

    name: ClassVar[str] = "arrhenius"
    references: ClassVar[tuple[Reference, ...]] = (_ZHURKOV, _GOTSMANN)
    source: ClassVar[str] = (
        f"{_ZHURKOV.source}; {_GOTSMANN.source}, who found 0.98 eV and 5.5e-29 m^3 for a tip on a polymer"
    )

    law: LossLaw
    activation_energy: float = parameter("J", "energy barrier of a loss, Ea")
    activation_volume: float = parameter("m^3", "decrease of that barrier per pressure, Va")
    temperature: float = parameter("K", "temperature", above=0.0)

    def __post_init__(self) -> None:
        """Read the parameters."""
        super().__post_init__()
        if not isinstance(self.law, LossLaw):
            raise SceneError("arrhenius.law", type(self.law).__name__, "must be a loss law")

    def factor(self, pressure: Floats) -> Floats:
        """Return the factor at pressures [Pa]."""
        barrier = np.maximum(self.activation_energy - np.asarray(pressure) * self.activation_volume, 0.0)
        return np.asarray(np.exp(-barrier / (BOLTZMANN * self.temperature)))

    def check(self, scene: Scene) -> None:
        """See `LossLaw.check`."""
        self.law.check(scene)

    def rate(self, fraction: Floats, exposure: Exposure) -> Floats:
        """See `LossLaw.rate`."""
        return self.factor(exposure.pressure) * self.law.rate(fraction, exposure)

    def describe(self) -> dict[str, Any]:
        """Return name and parameters, with those of the law."""
        return {**super().describe(), "law": self.law.describe()}
