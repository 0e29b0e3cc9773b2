"""Energy balance of a run: its terms, and how far that of a correct run may be out."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from functools import partial
from typing import Final

from gearidae.laws.frictions import FRICTION_LAWS
from gearidae.laws.joints import JOINTS
from gearidae.laws.law import Loss
from gearidae.laws.pairs import MESH_LAWS
from gearidae.laws.shafts import SHAFT_LAWS
from gearidae.records.quantity import ENERGY, Quantity, Totals, Unit

_energy = partial(Quantity, unit=ENERGY)
_work, _loss = partial(_energy, sign=1, archive=True), partial(_energy, sign=-1)


def _of_law(loss: Loss) -> Quantity:
    return _loss(loss.name, loss.meaning, archive=True, since=loss.since, group=loss.group)


ENERGY_SUMS: Final = (
    _work("drive_work", "work of the drive"),
    _work(
        "radius_work",
        "work of the changing radius of curvature",
        remark="from the change of the radii of curvature along the path of contact",
    ),
    _work(
        "model_change",
        "jump of the stored energy where the contact model changed",
        remark="from the change to the elastic contact model",
    ),
    _loss("drag_loss", "energy lost to drag", archive=True, group="useful"),
    *(
        _of_law(loss)
        for laws in (FRICTION_LAWS, MESH_LAWS, SHAFT_LAWS)
        for law in laws
        for loss in law.losses
    ),
    _loss("adhesion_loss", "energy lost to adhesion", archive=True),
    _loss(
        "flank_loss",
        "energy lost to friction of the drive and the coast flank",
        shape=(2,),
        archive={
            "drive_friction_loss": "energy lost to friction of the drive flank",
            "coast_friction_loss": "energy lost to friction of the coast flank",
        },
        group="friction",
        since="0.2",
    ),
    _loss(
        "joint_loss",
        "energy lost to friction of the joints",
        shape=(len(JOINTS),),
        archive={f"{joint.prefix}_loss": f"energy lost to friction of {joint.words}" for joint in JOINTS},
        group="friction",
        since="0.2",
    ),
    Quantity(
        "sliding",
        "loads of the joints, integrated over their sliding distances",
        Unit("F sigma", "N m", force=1, length=1),
        shape=(len(JOINTS),),
        archive={
            f"{joint.prefix}_sliding": f"load of {joint.words}, integrated over its sliding distance"
            for joint in JOINTS
        },
        since="0.3",
    ),
    _energy("throughput", "all works and changes of kinetic energy without regard to sign", archive=True),
    _energy("start_stored", "energy stored in contacts at the start"),
    _energy("start_shafts", "energy stored by laws of the shafts at the start"),
    _energy("start_kinetic", "kinetic energy at the start"),
    _energy("peak_kinetic", "largest kinetic energy"),
    _energy(
        "quadrature_error", "estimated errors of the quadratures of works and losses, without regard to sign"
    ),
    _energy(
        "loss_error", "the same of drag, damping and friction, which do not decide how long intervals are"
    ),
)
"""Sums over a run, which a checkpoint carries."""

ENERGY_NOW: Final = (
    _loss(
        "stored_change",
        "energy stored in contacts, at the end less at the start",
        archive=True,
        remark="stored in contacts",
    ),
    _loss(
        "shaft_change",
        "energy stored by laws of the shafts, at the end less at the start",
        archive=True,
        remark="stored in springs of the shafts",
        since="0.3",
    ),
    _loss(
        "kinetic_change",
        "kinetic energy, at the end less at the start",
        archive=True,
        remark="stored in motion",
    ),
    _energy("largest", "largest kinetic energy, with those stored at the start and at a change of the model"),
    _energy("pitch_work", "work of the reference load on both gears over a base pitch; 0 for a roller"),
    _energy("speed_work", "work of the largest momenta at the unit of speed; 0 for a roller"),
    _energy("torque_work", "work of speed-dependent torques for an error of the speed by its unit"),
)
"""Quantities of a look at the balance: changes of energies up to the present state, and parts of the bound."""

TERMS: Final[Mapping[str, Quantity]] = {
    name: term for term in (*ENERGY_SUMS, *ENERGY_NOW) if term.sign for name in term.names
}
"""Terms of the balance by their names in an archive."""
SLIDING: Final = tuple(name for term in ENERGY_SUMS if term.name == "sliding" for name in term.names)
"""Names of what is summed up with the energies and is none."""
LOSSES: Final[Mapping[str, Quantity]] = {
    name: term for name, term in TERMS.items() if term in ENERGY_SUMS and term.sign < 0
}
"""Those that are lost."""

GEAR_BOUND = 10.0
"""Largest error of a gear pair's energies because of errors of the motion, in tolerances of the energy exchanged: the
error of a step is a fraction of the tolerance, and errors and energies add up over the steps alike."""
TORQUE_BOUND = 0.1
"""Largest error of the balance because of torques that depend on the speed, in tolerances of
`EnergyBalance.torque_work`: errors of the speed have either sign. The largest measured is a seventh of this."""
ROLLER_BOUND = 100.0
"""`GEAR_BOUND` of a roller, whose whole energy goes through the many steps of one impact; the largest measured is
30."""
QUADRATURE_BOUND = 3.0
"""Largest error of the quadratures over their estimate, which is a mean over the positions of an interval."""
TABLE_BOUND = 1e-10
"""Smallest tolerance that improves the balance: stored energy and force have separate tables. Over an impact
of a roller at a tolerance of 1e-12 they differ by a seventh of this."""
ROUNDING_BOUND = 1e3 * sys.float_info.epsilon
"""Rounding errors in sums over the steps of a run, over the sum of the magnitudes."""
TRAVEL_BOUND = 10.0 * sys.float_info.epsilon
"""Rounding errors of a travel over the pitch within which it is counted."""


class EnergyBalance(Totals):
    """Energy balance of a run: the numbers of `ENERGY_SUMS` and `ENERGY_NOW` [J], and their ``time`` [s].

    Travels are counted within a pitch, so that their rounding errors are those of a number of the size of
    ``pitch_work``, however small the energies are. Speeds have absolute tolerances, which are a large energy,
    ``speed_work``, for a gear that is much heavier than the other. A drive that holds its speed stiffly turns errors of
    the speed into work, ``torque_work``.
    """

    __slots__ = ()

    @property
    def residual(self) -> float:
        """Works minus losses and changes of the energies [J]."""
        return float(sum(term.sign * self[name] for name, term in TERMS.items()))

    @property
    def efficiency(self) -> float:
        """What drag and dry resistance at the gear have taken over all that has been lost [1]; NaN without work."""
        lost = sum(self[name] for name in LOSSES)
        useful = sum(self[name] for name, term in LOSSES.items() if term.group == "useful")
        return float(useful / lost) if lost > 0.0 and self.drive_work > 0.0 else math.nan

    @property
    def imbalance(self) -> float:
        """Magnitude of the residual over the throughput [1]; 0 for a run without exchange of energy."""
        return abs(self.residual) / float(self.throughput) if self.throughput > 0.0 else 0.0

    def bound(self, rtol: float, *, roller: bool) -> float:
        r"""Bound of the residual of a correct run [J].

        .. math::

            (a \max(\mathrm{rtol}, a_t) + a_r)\, E + a_w\,\mathrm{rtol}\, W + a_q D + a_p P

        with E the energy exchanged: `throughput`, `largest`, `adhesion_loss`, the magnitudes of `stored_change`
        and `shaft_change`, and `speed_work`; W, `torque_work`; D, `quadrature_error`; and P, `pitch_work`. The
        first two terms are for errors of the motion: speeds and gaps have the tolerance rtol in each step, and the
        tables of force and energy agree no better than :math:`a_t`. The others are for the quadratures of the balance
        and for rounding.

        Parameters
        ----------
        rtol : float
            Relative tolerance of the run.
        roller : bool
            Whether the scene is a roller.

        Returns
        -------
        float
            With a `ROLLER_BOUND` or `GEAR_BOUND`, :math:`a_t` `TABLE_BOUND`, :math:`a_r` `ROUNDING_BOUND`, :math:`a_w`
            `TORQUE_BOUND`, :math:`a_q` `QUADRATURE_BOUND` and :math:`a_p` `TRAVEL_BOUND`.
        """
        of_motion = (ROLLER_BOUND if roller else GEAR_BOUND) * max(rtol, TABLE_BOUND) + ROUNDING_BOUND
        moved = (
            self.throughput
            + self.largest
            + self.adhesion_loss
            + abs(self.stored_change)
            + abs(self.shaft_change)
            + self.speed_work
        )
        of_motion_and_torque = of_motion * moved + TORQUE_BOUND * rtol * self.torque_work
        of_quadratures = QUADRATURE_BOUND * self.quadrature_error
        return float(of_motion_and_torque + of_quadratures + TRAVEL_BOUND * self.pitch_work)
