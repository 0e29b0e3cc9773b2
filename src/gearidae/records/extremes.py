"""Extremes of a run, which the solver keeps at its own steps: they do not depend on the samples."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping
from functools import partial
from typing import Any, Final

from gearidae.records.quantity import FORCE, GEAR_SPEED, INT, LENGTH, SPEED, TIME, Quantity, Totals, count
from gearidae.records.standing import STANDING_NOW

RUN_PARTS = (0.05, 0.5, 0.95)
"""Where the parts of a run begin over which speeds are judged, as shares of it: start-up, half, last twentieth."""

_speed, _force = partial(Quantity, unit=GEAR_SPEED, archive=True), partial(Quantity, unit=FORCE)
_time, _number = partial(Quantity, unit=TIME, archive=True), partial(count, archive=True)

FORCE_EXTREMES: Final = (
    _force(
        "largest_force",
        "largest force along the line of action, or on the roller",
        archive="largest_mesh_force",
    ),
    _time("largest_force_time", "when it acted", archive="largest_mesh_force_time"),
    _force(
        "smallest_force",
        "smallest force along the line of action, or on the roller",
        archive="smallest_mesh_force",
    ),
    _time("smallest_force_time", "when it acted", archive="smallest_mesh_force_time"),
    Quantity(
        "separation",
        "smallest distance of the flanks, deflection included",
        LENGTH,
        archive="smallest_separation",
    ),
)
SPEED_EXTREMES: Final = (
    _speed("lowest_speed", "smallest speed of the gear", archive="min_gear_speed"),
    _speed("highest_speed", "largest speed of the gear", archive="max_gear_speed"),
    _speed(
        "fall",
        "how far its speed fell after the first twentieth of the run below what it had reached",
        archive="speed_fall",
    ),
    _speed("rise", "how far its speed rose from then on above what it had fallen to", archive="speed_rise"),
    _number("reversals", "how often the gear's speed fell to zero"),
    _number("mesh_exits", "mesh exits on the drive flank"),
)
"""Of gears; of a roller the first two are its own speeds, and are not archived."""
ASPERITY_COUNTS: Final = (
    _number("asperity_onsets", "asperities that have joined"),
    _number("asperity_detachments", "asperities that have detached"),
)
"""Of populations."""
SPEEDS_NOW: Final = (
    _speed(
        "settled_gear_speed",
        "mean speed of the gear after the first twentieth of the run",
        comment="over whole periods of the slowest harmonic, as far as there are any",
    ),
    _speed("settled_spread", "its largest speed less its smallest from then on"),
    _speed(
        "late_gear_speed",
        "mean speed of the gear in the second half of the run",
        comment="over whole periods of the slowest harmonic, as far as there are any",
    ),
    _speed("late_spread", "its largest speed less its smallest there"),
    _speed("last_min_gear_speed", "smallest speed of the gear in the last twentieth of the run"),
    _speed("final_speed", "speed of the gear where the run ended"),
    _number("turn_backs", "how often adhesion has turned the gear back where it stands"),
    _time("time_adhering", "time held by adhesion, from one turning back to the next"),
)
"""What follows for gears from the state of a run."""
ROLLER_NOW: Final = (Quantity("final_speed", "speed of the roller where the run ended", SPEED, archive=True),)
"""What follows for a roller."""

ROLLER_EXTREMES: Final = (*FORCE_EXTREMES, *ROLLER_NOW, *ASPERITY_COUNTS)
GEAR_EXTREMES: Final = (*SPEED_EXTREMES, *SPEEDS_NOW, *STANDING_NOW, *FORCE_EXTREMES, *ASPERITY_COUNTS)
"""All extremes of a roller, and of gears."""
_MISSING: Final[Mapping[str, Any]] = {
    name: 0 if field.kind == INT else math.nan for field in GEAR_EXTREMES for name in field.names
}


class Extremes(Totals):
    """Extremes of a run: the numbers of `GEAR_EXTREMES` by their names in an archive, in SI units.

    A missing number is NaN, and a missing count 0: the gear's speeds for a roller, a part of the run that has not been
    reached, the sticking time of a gear that does not stick.

    ``exposures`` is an array of the exposures of the flanks, in the order flank, tooth of the pinion, quantity, place:
    for each material asperities joined over those of a unit contact length, for each the energy they lost [J], sliding
    work [J], largest force over contact length [N], and where flanks have friction its work [J]; empty if
    ``run.exposures`` is 0. ``standstill_list`` has the `gearidae.records.standing.COLUMNS` of each standstill in the
    order of time; of more than 64 the longest.
    """

    __slots__ = ()

    def __init__(self, numbers: Mapping[str, Any] | None = None, **others: Any) -> None:
        arrays = {"exposures": array("d"), "standstill_list": array("d")}
        super().__init__({**_MISSING, **arrays, **(numbers or {}), **others})
