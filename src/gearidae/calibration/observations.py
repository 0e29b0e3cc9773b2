"""What was observed of real gears, and how probable it is for what a model predicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.quantity import Quantity
from gearidae.scene.units import refuse_bare

if TYPE_CHECKING:
    from gearidae.scene import Scene

Model = Callable[["Scene"], float]

STICKS: Final = "sticks"
RING: Final = "ring_frequency"
_MISJUDGED: Final = 0.02
_MISJUDGED_SHARE: Final = Quantity(unit="1", above=0.0, at_most=0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """One observation of a pair of gears.

    Attributes
    ----------
    of : str or callable
        ``sticks``; ``ring_frequency``, that of the first impact response; another figure that the solver keeps of a
        run, such as ``min_gear_speed``; or a function that takes a scene and returns a number, in place of a run.
    value : bool, float or str
        Whether the gear stuck, or what was measured, in SI units; a frequency also with its unit.
    uncertainty : float or str, optional
        Standard uncertainty of what was measured, that of the model included. Not of ``sticks``.
    conditions : mapping of str to object, optional
        Keys of the scene under which it was made.
    misjudged : float or str, optional
        Of ``sticks``: how probable it is that a gear does other than the model says, above 0 and up to 0.5, or
        ``"5 %"``.

    Raises
    ------
    SceneError
        On construction, if something is not allowed.
    """

    of: str | Model = STICKS
    value: bool | float | str
    uncertainty: float | str | None = None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    misjudged: float | str = _MISJUDGED

    def __post_init__(self) -> None:
        if not isinstance(self.conditions, Mapping):
            raise SceneError("conditions", shorten(self.conditions), "must be a table of keys and values")
        if not isinstance(self.of, str) and not callable(self.of):
            raise SceneError("of", shorten(self.of), "must be the name of a figure, or a function of a scene")
        if self.of == STICKS:
            if not isinstance(self.value, bool | np.bool_):
                raise SceneError(
                    "value", shorten(self.value), "must be True or False: whether the gear stuck"
                )
            object.__setattr__(self, "misjudged", _MISJUDGED_SHARE.take("misjudged", self.misjudged))
            return
        try:
            refuse_bare((self.value, self.uncertainty))
        except ValueError as error:
            raise SceneError("uncertainty", shorten(self.uncertainty), str(error)) from None
        for name in ("value", "uncertainty"):
            kind = Quantity(unit="Hz" if self.of == RING else "1")
            object.__setattr__(self, name, kind.take(name, getattr(self, name)))
        if not self.spread > 0.0:
            raise SceneError("uncertainty", self.spread, "must be above 0")

    @property
    def spread(self) -> float:
        """Standard uncertainty [SI]; NaN of ``sticks``."""
        return math.nan if self.of == STICKS else float(self.uncertainty or 0.0)

    @property
    def figure(self) -> str:
        """Name of what was observed."""
        return self.of if isinstance(self.of, str) else getattr(self.of, "__name__", "function")

    def check(self, known: tuple[str, ...]) -> None:
        """Refuse a figure that runs do not have.

        Raises
        ------
        SceneError
        """
        if isinstance(self.of, str) and self.of not in (*known, STICKS, RING):
            meant = did_you_mean(self.of, known) or f"known are {STICKS}, {RING}, {', '.join(known)}"
            raise SceneError("of", shorten(self.of), f"is no figure of a run; {meant}")

    def log_likelihood(self, predicted: Floats) -> Floats:
        r"""Logarithm of the probability (density) of the observation.

        Parameters
        ----------
        predicted : ndarray
            By the model [SI]: 1 or 0 of ``sticks``; NaN where it has none.

        Returns
        -------
        ndarray
            Of ``sticks``, :math:`\ln(1 - m)` where the model agrees and :math:`\ln m` where it does not, with m
            `misjudged`, and ln 1/2 where the run was not finished, which says nothing. Of a number, that of a normal
            distribution about the prediction; -inf without a prediction, such as of a contact that does not ring.
        """
        if self.of == STICKS:
            share = np.where(predicted == float(self.value), 1.0 - float(self.misjudged), self.misjudged)
            return np.asarray(np.log(np.where(np.isnan(predicted), 0.5, share)))
        with np.errstate(over="ignore"):  # impossible, which it may be
            squares = ((predicted - float(self.value)) / self.spread) ** 2
        logarithm = -0.5 * squares - math.log(self.spread * math.sqrt(2.0 * math.pi))
        return np.where(np.isnan(logarithm), -math.inf, logarithm)
