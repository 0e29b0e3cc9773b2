"""One scene, scaled and ready to run: what the drivers work with."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from gearidae.engine.laws.statistical import set_all_branches
from gearidae.engine.model.addresses import Addresses
from gearidae.engine.model.state import (
    DRIVE,
    LOAD,
    PHASE,
    SPEED,
    Floats,
    Model,
    U,
    V,
    assign,
    blank_work,
    copied,
)
from gearidae.engine.observers.exposures.bins import exposures_of
from gearidae.engine.observers.extremes.units import extremes_in_si
from gearidae.engine.observers.finish import finish_for_look
from gearidae.engine.observers.standing.judge import Judge
from gearidae.engine.pairs.orbit import orbit_anew
from gearidae.engine.setup import checkpoint as checkpoints
from gearidae.engine.setup.kept_asperities import restore_asperities
from gearidae.errors import SceneError
from gearidae.laws.shaft.harmonic import fastest_harmonic
from gearidae.laws.shaft.schedule import fastest_schedule
from gearidae.records import EnergyBalance, Extremes, first_sample
from gearidae.records.energy import ENERGY_NOW, ENERGY_SUMS
from gearidae.records.quantity import in_si
from gearidae.scene.run import SMALLEST_RTOL

ERRORS = 5.0  # in relative tolerances: where the energy balance may be out by more, it integrates over single steps
PARTS_RTOL = 1e-6  # relative tolerance below which it divides steps in flight
PARTS_OF_PERIOD = 24
"""Steps of free gears in a period of the fastest harmonic at least,"""
PARTS_OF_LAW = 4096
"""and in a run whose torques follow a law that nothing is known of."""
PERIODS = 1e6
OWN_SAFETY = 16.0
"""Tolerance of a run over that of a step by IDA's own formulas: they damp vibrations, and what they take adds up.
Gears that ring in their adhesion for 10^5 steps miss the bound of the energy balance with 1 by up to 3.6, with 8 by up
to 1.3; with 16 they keep to 0.7 of it, in a seventh more steps."""
PHASE_HIGH = 16.0
"""Pitches at most at which whole ones are taken out of the phase: it is held to absolute tolerances, down to 1e-15, and
IDA refuses states that are known no better than that."""
FELT = 0.1  # of the tolerance of a speed
FOLLOWED = (
    1.25  # radians of the fastest harmonic in a step at most; Adams' formulas have about one of their own
)


@dataclass(slots=True)
class Problem:
    """One scene, scaled and ready to run; a driver changes its model in place.

    Attributes
    ----------
    model : Model
        See `gearidae.engine.model.state`.
    start : ndarray, shape (n,)
        Scaled state at time 0.
    tolerance_scale : ndarray, shape (n,)
        What an error of 1 means for each state: times rtol, the absolute tolerances.
    columns : tuple of str
        What `observe` writes.
    skipped : dict
        What this scene does not need.
    digest : tuple of four floats
        Identifies this scene's checkpoints.
    depth : int
        0 for the asperity model, 1 and more for the layouts of the elastic model.
    elastic : callable, optional
        Makes the elastic problem for the time when the automatically chosen asperity model is no longer sufficient.
    deeper : callable, optional
        Makes the same elastic problem with nodes laid out for deeper contacts, if there can be any.
    method : str
        ``run.method`` of the scene.
    addresses : Addresses
        Where the model lies in this process, for compiled functions that are called from Python.
    judge : Judge
        Says where the gear stands.
    """

    model: Model
    start: Floats
    tolerance_scale: Floats
    columns: tuple[str, ...]
    skipped: dict[str, int]
    digest: tuple[float, ...] = ()
    depth: int = 0
    elastic: Callable[[], Problem] | None = None
    deeper: Callable[[], Problem] | None = None
    method: str = "auto"
    addresses: Addresses = field(init=False)
    judge: Judge = field(init=False)

    def __post_init__(self) -> None:
        """Note where the model lies."""
        self.addresses = Addresses(self.model)
        self.judge = Judge(self.model, self.addresses.base)

    @property
    def time_unit(self) -> float:
        """The scene's tau [s]."""
        return float(self.model.scene.time_unit)

    def shortened(self, end: float) -> Problem:
        """Copy of this problem that ends early, at a time over tau, and has no knots."""
        m = self.model
        scene, state, work = (np.array([record])[0] for record in (m.scene, m.state, m.work))
        copy = Model(scene, state, work, m.tables.copy(), m.rows.copy())
        copy.scene.start, copy.scene.end = 0.0, min(float(m.scene.end), end)
        copy.scene.knot_count = copy.scene.stop = 0
        return replace(self, model=copy, start=self.start.copy())

    def prepare(self, rtol: float, samples: int, *, as_ida: bool = False) -> Model:
        """Set the tolerance and the number of samples of a run, and return the model.

        `as_ida` says that IDA's own formulas are used throughout.

        Every state's error counts in absolute tolerances, `rtol` times its scale. At tight ones the energy balance
        divides steps in flight: the error of its quadrature goes with the fourth power of a step, and a step with no
        more than the eighth root of the tolerance. Torques that shake a gear by less than a share of the tolerance
        need not be followed.
        """
        m = self.model
        s, first = m.scene, m.scene.error_weights_at
        s.rtol, s.samples = rtol, samples
        s.first_sample = first_sample(float(s.start), float(s.end), samples)
        of_step = max(rtol / OWN_SAFETY, min(rtol, SMALLEST_RTOL)) if as_ida else rtol
        weights = 1.0 / (of_step * self.tolerance_scale)
        m.rows[first : first + self.start.size] = weights
        s.phase_high = min(PHASE_HIGH, 1.0 / (float(weights[PHASE]) * sys.float_info.epsilon))
        s.balance_error = ERRORS * rtol
        s.flight_parts = math.ceil((PARTS_RTOL / rtol) ** (1.0 / 8.0))
        s.friction.gap_tolerance = rtol * float(self.tolerance_scale[U])
        felt = FELT * rtol * float(self.tolerance_scale[V])
        s.torque_omega = max(
            self._fastest(shaft, felt / float(share) if share > 0.0 else math.inf)
            for shaft, share in ((DRIVE, s.pinion_inverse_mass), (LOAD, s.gear_inverse_mass))
        )
        steepest = max(fastest_schedule(schedule, m.tables, 0.0) for schedule in s.schedule)
        fastest = max(steepest, float(s.torque_omega) / FOLLOWED)
        s.longest_step = 1.0 / fastest if fastest > 0.0 else 0.0
        if s.largest_step > 0.0:
            s.longest_step = min(float(s.largest_step), float(s.longest_step) or math.inf)
        s.free_step = self._longest_free_step()
        return m

    def _longest_free_step(self) -> float:
        """Longest step of free gears: a part of a period of the fastest harmonic; 0 where it need not be bounded.

        Harmonics of more than `PERIODS` periods in a run are not followed one by one. Steps end at knots of schedules
        anyway, and at parts of a cubic one.
        """
        s, longest = self.model.scene, math.inf
        span = float(s.end - s.start)
        for shaft in (DRIVE, LOAD):
            omega = fastest_harmonic(self._harmonics(shaft), 0.0)
            if omega > 0.0:
                longest = min(longest, max(2.0 * math.pi / omega, span / PERIODS) / PARTS_OF_PERIOD)
            if self.model.work.torque_law[shaft] != 0:
                longest = min(longest, span / PARTS_OF_LAW)
        return longest if longest < math.inf else 0.0

    def _harmonics(self, shaft: int) -> Floats:
        torque = self.model.scene.torque[shaft]
        return self.model.tables[torque.harmonics_at : torque.harmonics_at + 3 * torque.harmonic_count]

    def _fastest(self, shaft: int, felt: float) -> float:
        scene, tables = self.model.scene, self.model.tables
        fastest = max(
            fastest_harmonic(self._harmonics(shaft), felt),
            fastest_schedule(scene.schedule[shaft], tables, felt),
        )
        gain = float(scene.torque[shaft].speed_gain)
        if gain > 0.0:
            fastest = max(fastest, fastest_schedule(scene.schedule[SPEED], tables, felt / gain))
        return float(fastest)

    def kept(self, time: float, state: Floats, rates: Floats) -> tuple[EnergyBalance | None, Extremes | None]:
        """Return the energy balance and the extremes of the run up to an accepted time; None of what is not followed.

        The model is restored afterwards: intervals are not split by a look at what they have added up to.

        Parameters
        ----------
        time : float
            Over tau.
        state, rates : ndarray, shape (n,)
            Scaled state there, and its rate.
        """
        self.judge.follow(time)
        m, exposures, balance, extremes = self.model, exposures_of(self.model), None, None
        before, exposed = (copied(m.state), copied(m.work)), exposures.copy()
        finish_for_look(self.addresses.base, time, state, rates)
        if m.scene.follow.balance:
            energies = in_si(ENERGY_SUMS, m.state.energy, m.scene) | in_si(
                ENERGY_NOW, m.work.energy_now, m.scene
            )
            balance = EnergyBalance(energies, time=time * self.time_unit)
        if m.scene.follow.extremes:
            extremes = extremes_in_si(m, self.judge, time, state)
        for record, copy in zip((m.state, m.work), before, strict=True):
            assign(record, copy)
        if m.scene.orbit != 0.0:
            orbit_anew(m)
        exposures[:] = exposed
        return balance, extremes

    def checkpoint(self, time: float, state: Floats) -> Floats:
        """Everything that changes in a run, as one vector.

        Parameters
        ----------
        time : float
            Time reached, over tau.
        state : ndarray, shape (n,)
            Scaled state there.
        """
        self.judge.follow(time)
        self.model.state.time = time
        return checkpoints.pack(self.model, self.digest, self.depth, state)

    def of_checkpoint(self, checkpoint: Floats) -> Problem:
        """Return this scene's problem with the contact model that a checkpoint has.

        Raises
        ------
        SceneError
            If the checkpoint is not of this scene.
        """
        depth, problem = checkpoints.depth_of(checkpoint, self.digest), self
        if depth > 0 and problem.elastic is not None:
            problem = problem.elastic()
        while problem.depth < depth and problem.deeper is not None:
            problem = problem.deeper()
        if problem.depth != depth:
            raise SceneError("checkpoint", f"contact model {depth}", "not one that this scene has")
        return problem

    def restore(self, checkpoint: Floats, state: Floats) -> float:
        """Take a checkpoint of this problem back, in place, and return its time over tau.

        Nothing is left of a run of this problem before: its work records are blank as for a start.

        Raises
        ------
        SceneError
            If a number is none that a run of this scene could have left.
        """
        m = self.model
        joined = checkpoints.unpack(m, checkpoint, state)
        blank_work(m.work)
        restore_asperities(m, state, joined)
        set_all_branches(m)
        time = float(m.state.time)
        m.work.quadrature.time = m.work.resistance.time = m.work.adhesion_lag_time = time
        m.work.driver.time = time
        return time

    def restored(self, checkpoint: Floats) -> tuple[float, Floats]:
        """Take a checkpoint of this problem back, as `restore` does; return its time over tau and the state vector."""
        state = np.empty(self.start.size)
        return self.restore(checkpoint, state), state

    def outgrown(self, checkpoint: Floats) -> bool:
        """Whether a checkpoint of this problem stands where the model's bound has been exceeded."""
        return checkpoints.exceeded(checkpoint)

    def has_been_elastic(self, checkpoint: Floats) -> bool:
        """Whether bodies have been elastic in the run of a checkpoint of this problem."""
        return self.depth > 0 or checkpoints.elastic_so_far(checkpoint)

    def rigid_again(self, checkpoint: Floats) -> bool:
        """Whether a checkpoint stands where the asperity model would do again."""
        return checkpoints.rigid_again(checkpoint)
