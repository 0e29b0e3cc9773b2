"""What is known of a record beside its samples: where it begins, and how its sensor measures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from gearidae.analysis.signal import CALIBRATION
from gearidae.errors import SceneError
from gearidae.scene.quantity import Quantity

_HISTORIES: Final = ("auto", "start", "unknown")
_CALIBRATION: Final = Quantity(unit="1", at_least=0.0, at_most=0.1)
_CUTOFF: Final = Quantity(unit="Hz", above=0.0)
_OFFSET: Final = Quantity(unit="rad/s", at_least=0.0)


@dataclass(frozen=True, slots=True)
class Sensor:
    """What is known of a record.

    Attributes
    ----------
    history : str
        ``auto``, ``start`` or ``unknown``.
    cutoff : float
        Cut-off frequency of the filter before the sampling [Hz]; infinite if none is known.
    calibration : float
        Relative standard uncertainty of the speed [1].
    offset : float
        Standard uncertainty of the speed's zero [rad/s].
    """

    history: str
    cutoff: float
    calibration: float
    offset: float

    def uncertainty(self, speed: float) -> float:
        """Relative standard uncertainty at a speed [rad/s]."""
        return math.hypot(self.calibration, self.offset / speed if speed > 0.0 else 0.0)


def check_sensor(
    history: str = "auto",
    anti_alias_filter: float | str | None = None,
    calibration: float | str = CALIBRATION,
    offset: float | str = 0.0,
) -> Sensor:
    """Refuse what a sensor cannot be.

    Parameters
    ----------
    history, anti_alias_filter, calibration, offset
        As for `gearidae.analysis.assess`.

    Raises
    ------
    SceneError
        Naming the setting.
    """
    if history not in _HISTORIES:
        raise SceneError("history", history, f"must be one of {', '.join(_HISTORIES)}")
    return Sensor(
        history,
        math.inf if anti_alias_filter is None else _CUTOFF.take("anti_alias_filter", anti_alias_filter),
        _CALIBRATION.take("calibration", calibration),
        _OFFSET.take("offset", offset),
    )
