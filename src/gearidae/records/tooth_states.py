"""Plain records of what pairs of teeth did at one time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from gearidae.records.events import Flank


class ContactState(IntEnum):
    """State of the asperities in a pair of teeth; of elastic bodies, of those in the middle of the contact."""

    OPEN = 0
    """Too far apart to count as contact."""
    LOADING = 1
    """None is stretched."""
    PARTLY_STRETCHED = 2
    """Some are stretched, none has come to its limit."""
    FULLY_STRETCHED = 3
    """The most stretched are detaching."""


@dataclass(frozen=True, slots=True)
class ToothContact:
    """One pair of teeth at one time.

    Attributes
    ----------
    pair : int
        Number of the pair, as in ``event_pair``.
    flank : Flank
        Drive or coast.
    place : float
        Position xi along the path of contact of that flank [m]; outside it the rounded tooth ends meet.
    radius : float
        Reduced radius of curvature [m].
    gap : float
        Gap along the line of action [m].
    force : float
        Force along the line of action by all laws of the scene [N]; positive pushes apart.
    joined : dict of str to float
        By ``bare``, ``coated`` and ``mixed``, as far as there are such parts: height above which asperities are joined
        [m]; NaN where the bodies deflect, so that each point along the contact has a height of its own. Empty for a
        population.
    states : dict of str to ContactState
        State of each part.
    asperities : tuple of int, optional
        Joined asperities of a population, by their numbers on the pinion's flank; None of other models.
    """

    pair: int
    flank: Flank
    place: float
    radius: float
    gap: float
    force: float
    joined: dict[str, float]
    states: dict[str, ContactState]
    asperities: tuple[int, ...] | None = None

    @property
    def state(self) -> ContactState:
        """State of the part of the pair that is stretched furthest."""
        return max(self.states.values())


@dataclass(frozen=True, slots=True)
class MeshState:
    """All pairs of teeth near contact at one sample.

    Attributes
    ----------
    time : float
        Of the sample [s].
    travel : float
        R2 phi2 [m], so counted that it is the position of pair 0 along its path of contact.
    transmission_error : float
        u [m].
    gear_speed : float
        [rad/s].
    mesh_force : float
        Force along the line of action, of all pairs and the damping of the mesh [N].
    contacts : tuple of ToothContact
        Pairs on the path of contact of either flank, and those beside it that are near enough for a force.
    """

    time: float
    travel: float
    transmission_error: float
    gear_speed: float
    mesh_force: float
    contacts: tuple[ToothContact, ...]
