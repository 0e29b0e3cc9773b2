"""Where a run starts and how long it is, and the roller that may take the gears' place."""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from gearidae.errors import SceneError
from gearidae.scene.group import Group
from gearidae.scene.knots import Time
from gearidae.scene.quantity import Count, Quantity, Sampling, Switch
from gearidae.scene.roughnesses import Length

MOST_SAMPLES: Final = 100_000_000
MOST_TURNS: Final = 1e9
MOST_CHECKPOINTS: Final = 10_000


class Initial(Group):
    """How the gears start; the pinion turns just so fast that the gap does not change at first."""

    gear_speed: Annotated[float, Quantity(unit="rad/s", at_least=-1e12, at_most=1e12, least=1e-30)] = Field(
        default=0.0, description="speed of the gear (of a train: the loaded shaft)"
    )
    gap: Annotated[float, Length(unit="m", shown=("nm", -9))] = Field(
        description="gap of the drive flank from the summits' mean plane, a length or in roughnesses"
    )
    mesh_phase: Annotated[float, Quantity(unit="1", at_least=0, below=10_000)] = Field(
        default=0.3,
        description="position of pair 0 on the path of contact, in base pitches; with whole pitches another pair, and "
        "tooth of the pinion, is in mesh",
    )
    rest_time: Annotated[float, Quantity(unit="s", at_least=0, at_most=1e12, shown=("ms", -3))] = Field(
        default=0.0,
        description="how long the device has stood before, for hubs and a pin whose friction ages",
    )


def _read_stop(value: object) -> str:
    """Read ``time``, ``sticks`` or ``turns N``."""
    words = value.split() if isinstance(value, str) else []
    if words in (["time"], ["sticks"]):
        return words[0]
    try:
        turns = float(words[1]) if len(words) == 2 and words[0] in ("turns", "turn") else math.nan
    except ValueError:
        turns = math.nan
    if not 0.0 < turns <= MOST_TURNS:
        raise ValueError(f'must be "time", "sticks" or "turns N", with N above 0 and at most {MOST_TURNS:g}')
    return f"turns {turns!r}"


def _read_times(value: object) -> object:
    """Accept one time, a list of them or an array; what it holds is read later."""
    value = value.tolist() if hasattr(value, "tolist") else value
    times = tuple(value) if isinstance(value, (list, tuple)) else (value,)
    if len(times) > MOST_CHECKPOINTS:
        raise ValueError(f"has {len(times)} times; there may be {MOST_CHECKPOINTS} at most")
    return times


SMALLEST_RTOL = 1e-12
"""Smallest relative tolerance: rounding of a state is a hundredth of it where gears have turned by a pitch."""


class Run(Group):
    """How long, how finely sampled, how accurate."""

    duration: Annotated[float, Quantity(unit="s", at_least=1e-20, at_most=1e12, shown=("ms", -3))] = Field(
        description="simulated time"
    )
    samples: Annotated[int | str, Sampling(at_least=2, at_most=MOST_SAMPLES)] = Field(
        default=10_001,
        description="uniform samples, both ends included: a number, a rate, ringing (as many as show how the contacts "
        "ring), or off",
    )
    rtol: Annotated[float, Quantity(unit="1", at_least=SMALLEST_RTOL, at_most=0.1)] = Field(
        default=1e-6,
        description="relative tolerance of the solver; 1e-4 gives the adhesion loss of the shipped cases to 0.1 %",
    )
    largest_step: Annotated[float | None, Quantity(unit="s", at_least=1e-30, at_most=1e12)] = Field(
        default=None, description="longest step of the solver; by default as long as the tolerance allows"
    )
    method: Literal["auto", "bdf"] = Field(
        default="auto",
        description="bdf: IDA's own formulas, iteration and root search throughout; auto: Adams' where they are better",
    )

    exposures: Annotated[int, Count(at_least=0, at_most=1000)] = Field(
        default=0,
        description="places along the flank at which contacts, adhesion and sliding work are kept; 0 for none",
    )
    balance: Switch = Field(
        default=True, description="whether the energy balance is kept; exposures and a life need it"
    )
    passages: Switch = Field(
        default=True,
        description="whether a table of passages is kept, with works, losses and forces at each mesh exit",
    )
    impacts: Switch = Field(
        default=False,
        description="whether a table of impacts is kept, with force, impulse and loss of each contact of a tooth pair",
    )
    asperity_events: Switch = Field(
        default=True,
        description="whether each joining and detachment of a population's asperities is an event kept",
    )
    stop: Annotated[str, BeforeValidator(_read_stop)] = Field(
        default="time",
        description="what ends the run before its time: sticks, or turns N of the gear (of a train: the loaded shaft)",
    )
    judged: str | None = Field(
        default=None, description="shaft of a train by which a run is judged; default that of the load"
    )
    checkpoints: Annotated[tuple[Time, ...], BeforeValidator(_read_times)] = Field(
        default=(), description="times at which the solver starts afresh and keeps a checkpoint"
    )

    @model_validator(mode="after")
    def _countable(self) -> Self:
        """Refuse a rate that gives too few samples in this duration, or too many."""
        if isinstance(self.samples, str) and self.samples not in ("off", "ringing"):
            wanted = self.duration * Sampling.rate(self.samples) + 1.0
            if not 1.5 <= wanted < MOST_SAMPLES + 0.5:
                raise SceneError(
                    "samples",
                    self.samples,
                    f"gives {wanted:.4g} samples in {self.duration:g} s; there must be 2..{MOST_SAMPLES:g}",
                )
        return self

    @model_validator(mode="after")
    def _balance_for_exposures(self) -> Self:
        """Refuse exposures without the balance, whose losses by joining they are part of."""
        if self.exposures and not self.balance:
            raise SceneError("balance", self.balance, "must be true where run.exposures are kept")
        return self

    @property
    def sample_count(self) -> int:
        """Number of samples; 0 if they are off, or until those of the ringing are known, when a run is prepared."""
        if isinstance(self.samples, int):
            return self.samples
        return (
            0
            if self.samples in ("off", "ringing")
            else round(self.duration * Sampling.rate(self.samples)) + 1
        )


class Roller(Group):
    """A roller dropped on a flat, both with the scene's surface: ``m z'' = W(z)``."""

    radius: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = Field(
        description="radius, R"
    )
    mass: Annotated[float, Quantity(unit="kg", at_least=1e-30, at_most=1e3)] = Field(description="mass, m")
    width: Annotated[float, Quantity(unit="m", at_least=1e-10, at_most=1, shown=("um", -6))] = Field(
        description="length along the axis, L"
    )
    speed: Annotated[float, Quantity(unit="m/s", at_least=0, at_most=1e9, least=1e-30)] = Field(
        description="speed towards the flat"
    )
    height: Annotated[float, Quantity(unit="m", at_least=1e-15, at_most=1, shown=("nm", -9))] = Field(
        description="mean gap at the start"
    )
