"""Endings of a run, and solver statistics."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import Final

from gearidae.records.quantity import count


class Ending(Enum):
    """Ending of a run: its status in the dataset, and a sentence."""

    FINISHED = ("finished", "")
    CHATTER = ("chatter", "events followed each other while the time did not advance")
    LAW_CHATTER = (
        "law_chatter",
        "a registered torque law chatters at its own switch: give it a hysteresis, or a slope in place of its jump",
    )
    MANY_EVENTS = (
        "many_events",
        "asperities joined and detached more than 100000 times in a mesh cycle, or hundreds at once",
    )
    STEP_UNDERFLOW = ("step_underflow", "the error test failed repeatedly: the steps became too small")
    NO_CONVERGENCE = ("no_convergence", "Newton's iteration did not converge with any step size")
    TOO_ACCURATE = (
        "too_accurate",
        "the tolerance is smaller than double precision allows: raise run.rtol",
    )
    SOLVER_FAILURE = ("solver_failure", "SUNDIALS IDA failed")
    FOLD = (
        "fold",
        "the elastic contact folds: adhesion exceeds the stiffness of the bodies, and the surfaces would jump",
    )
    DEFLECTION = (
        "deflection",
        "tooth-body deflection exceeds the limit of the asperity model; set contact.bodies to elastic",
    )
    TOO_DEEP = (
        "too_deep",
        "the teeth were pressed together by more than 39 roughnesses: use less speed or load, or a rougher surface",
    )
    LIGHT = ("light", "contacts of elastic bodies are so light that the asperity model suffices")
    STOPPED = ("stopped", "ended by on_block")
    NOT_FINITE = ("not_finite", "the solution is no longer a finite number")

    @property
    def status(self) -> str:
        """Name, as in the dataset."""
        return self.value[0]

    @property
    def message(self) -> str:
        """A sentence; empty when finished."""
        return self.value[1]


COUNTERS: Final = (
    count("steps", "solver steps", archive=True),
    count("residual_evaluations", "evaluations of the residual", archive=True),
    count("jacobian_evaluations", "evaluations of the Jacobian", archive=True),
    count("error_test_failures", "steps repeated because the error test failed", archive=True),
    count("convergence_failures", "steps repeated because Newton's method failed", archive=True),
    count("restarts", "restarts of the solver at order one", archive=True),
    count("guard_evaluations", "evaluations of the event functions", archive=True),
    count("flight_steps", "steps in which no pair was in contact"),
)
"""Counters of a driver, which a checkpoint carries."""


@dataclass(slots=True)
class Statistics:
    """Solver statistics, summed over restarts; the driver updates them during a run.

    Attributes
    ----------
    steps, residual_evaluations, jacobian_evaluations, guard_evaluations : int
        Work counters.
    error_test_failures, convergence_failures, restarts : int
        Rejected steps, and restarts at order one.
    wall_time : float
        Wall time in the solver [s].
    backend : str
        The driver that ran: ``native`` or ``sksundae``.
    skipped : dict
        Terms that the scene did not need, by name.
    flight_steps : int
        Steps in which no pair was in contact.
    ending : Ending
        Ending of the driver.
    fold_gap : float, optional
        Gap at which the elastic contact folds, for the ending ``FOLD`` [m].
    method : str
        Formulas at the start of the run: ``adams`` (and IDA's own where these are better), ``bdf``, IDA's own, or
        ``dop853``, of a train.
    """

    steps: int = 0
    residual_evaluations: int = 0
    jacobian_evaluations: int = 0
    error_test_failures: int = 0
    convergence_failures: int = 0
    restarts: int = 0
    guard_evaluations: int = 0
    wall_time: float = 0.0
    backend: str = ""
    skipped: dict[str, int] = field(default_factory=dict)
    flight_steps: int = 0
    ending: Ending = Ending.FINISHED
    fold_gap: float | None = None
    method: str = ""

    def note_fold(self, gap: float) -> None:
        """Set the ending `FOLD` with the gap at which the contact folds [m]; NaN for no fold."""
        if not math.isnan(gap):
            self.ending, self.fold_gap = Ending.FOLD, float(gap)

    @property
    def message(self) -> str:
        """The ending in a sentence; empty when finished."""
        if self.fold_gap is not None:
            return f"{self.ending.message}, at a gap of {self.fold_gap:.6g} m"
        return self.ending.message
