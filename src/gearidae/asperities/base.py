r"""Base class of the law of one asperity; each file of this folder contains one law.

**Units.** Lengths are in units of any length l, and loads in units of the Hertz load at a compression of l,
:math:`\tfrac43 E^*\sqrt\beta\,l^{3/2}`. In these units Hertz's law is :math:`P = \Delta^{3/2}`, and one law serves
for metres, for roughnesses, and for the length by which adhesion deforms a tip.

**Displacement.** Positive in compression, zero where the undeformed tip would just touch. An asperity that approaches
*joins* at the displacement ``-join``; on separation it stretches to ``-detach`` and detaches, with
``detach >= join >= 0``. If the two differ there is hysteresis, and each cycle loses the energy ``loss``.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.tip import Asperity
from gearidae.references import Reference

_X, _W = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, kw_only=True)
class CoatedKey:
    """Key of a law in the table ``coating``, of flanks that the monolayer covers.

    Attributes
    ----------
    default : float
    description : str
    mixed : (coated, bare) -> float
        Its number where a covered flank meets a bare one.
    """

    default: float
    description: str
    mixed: Callable[[float, float], float]


@dataclass(frozen=True, kw_only=True)
class SurfaceKey:
    """A key of an asperity law in the table ``surface`` of a scene.

    Attributes
    ----------
    name : str
    unit : str
        SI unit in pint's spelling.
    description : str
    default : float, optional
        None for one that has to be given.
    at_least, at_most : float
        Bounds, in that unit.
    coated : CoatedKey, optional
        Of a key for which covered flanks have a number of their own.
    """

    name: str
    unit: str
    description: str
    default: float | None
    at_least: float
    at_most: float
    coated: CoatedKey | None = None


class Validity(NamedTuple):
    """A number that must not exceed 1 where a law holds.

    Attributes
    ----------
    name : str
        Of the row of the validity, without the material.
    quantity : str
        Meaning of the number.
    number : float
    holds, fails : str
        Verdicts up to 1 and beyond.
    """

    name: str
    quantity: str
    number: float
    holds: str
    fails: str


_GOES_WITH_ALL: Final = MappingProxyType[str, str]({})


class AsperityLaw(ABC):
    """Load of one asperity over its displacement, with the distances at which it joins and detaches.

    A law is a frozen dataclass: equal laws share their tables. It must define `name`, `of`, `detach`,
    `pull_off` and `load`; the rest follows from these, and is overridden where a closed form is known.
    """

    name: ClassVar[str]
    """Name of the law in ``contact.asperity``."""

    needs: ClassVar[tuple[str, ...]] = ()
    """Keys of the table ``surface`` that this law needs, and without which they have no effect."""

    keys: ClassVar[tuple[SurfaceKey, ...]] = ()
    """Keys of a law in this folder; `of` reads their numbers from `tip.surface`."""

    is_feature: ClassVar[bool] = False
    """Whether `gearidae.combinations` lists scenes with it, as ``NAME asperities``."""

    not_with: ClassVar[Mapping[str, str]] = _GOES_WITH_ALL
    """Other features that no scene with this law can have, each with its reason."""

    references: ClassVar[tuple[Reference, ...]] = ()
    """Publications of the law, which `gearidae.cite` names."""

    @classmethod
    @abstractmethod
    def of(cls, tip: Asperity, unit: float) -> AsperityLaw:
        """Return the law of a tip.

        Parameters
        ----------
        tip : Asperity
            Elastic constants, radius and adhesion (SI).
        unit : float
            The law's unit of length [m].

        Returns
        -------
        AsperityLaw
            Of this kind, or of a simpler one that this kind turns into (without adhesion, say).
        """

    @classmethod
    def validity(cls, surface: Any, gap: float) -> Validity | None:
        """Say how far a law holds on a surface where the flanks rest; None if it always does.

        Parameters
        ----------
        surface : Surface
            Of one material of a scene.
        gap : float
            Of the mean planes at rest [m].
        """
        return None

    @property
    @abstractmethod
    def detach(self) -> float:
        """Distance at which a stretched asperity detaches, d_off; 0 if it does not stretch."""

    @property
    def join(self) -> float:
        """Distance at which an approaching asperity joins, d_on <= d_off; 0 if it must touch."""
        return 0.0

    @property
    @abstractmethod
    def pull_off(self) -> float:
        """Largest tension that an asperity carries; 0 if it carries none."""

    @property
    def pieces(self) -> int:
        """Number of equal pieces, of degree seven, in ``sqrt((displacement + detach) / (detach - join))``."""
        return 4

    @property
    def touch(self) -> float:
        """Displacement of a kink of the load, at which a tip that attracts begins to touch; ``-detach`` without one.

        Above it the load may grow with the power 3/2 of the way.
        """
        return -self.detach

    @property
    def kink(self) -> float:
        """``sqrt((touch + detach) / (detach - join))``, if the kink lies between detachment and joining; 1 else."""
        if not -self.detach < self.touch < -self.join:
            return 1.0
        return math.sqrt((self.touch + self.detach) / (self.detach - self.join))

    @abstractmethod
    def load(self, displacement: ArrayLike) -> Floats:
        """Load of an asperity in contact, on the branch that is stable under given displacement.

        Parameters
        ----------
        displacement : array_like
            Displacement, positive in compression. The load must be smooth above ``-detach``, where it may end in a
            jump or a fold (a square root); without stretching it may begin at 0 with any multiple of half a power.
            Another kink needs `nodes` of its own, with a part on either side of it.

        Returns
        -------
        ndarray
            Positive pushes apart, the shape of `displacement`; zero below ``-detach``.
        """

    def nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a quadrature rule of the load between two displacements.

        The rule is laid out in a variable in which the load is smooth up to the displacement of detachment: here
        ``sqrt(displacement + detach)``, which serves any law that ends in a fold there.

        Parameters
        ----------
        low, high : array_like, one shape
            Displacements between which to integrate, ``-detach`` or more.
        x, w : ndarray, shape (n,)
            Nodes and weights of the rule on -1..1.

        Returns
        -------
        displacement, weight : ndarray, shape (..., n)
            Nodes, and weights times load times measure: ``weight @ f(displacement)`` is the integral of load times f.
        """
        displacement, measure = self._rule_of_fold(low, high, x, w)
        return displacement, measure * self.load(displacement)

    def _rule_of_fold(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        ends = np.sqrt(np.maximum(np.stack(np.broadcast_arrays(low, high)) + self.detach, 0.0))[..., None]
        span = ends[1] - ends[0]
        root = ends[0] + 0.5 * (x + 1.0) * span
        return root**2 - self.detach, 0.5 * span * w * 2.0 * root

    def area(self, displacement: ArrayLike) -> Floats:
        """Contact area of an asperity in contact, on the branch of `load`; a law may leave it out.

        Friction by a shear strength needs it (``contact.friction_law = "shear"``).

        Parameters
        ----------
        displacement : array_like
            As for `load`.

        Returns
        -------
        ndarray
            Over ``pi beta l``, with the tip radius and the law's unit of length, so that Hertz's is the displacement;
            zero below ``-detach``.
        """
        raise NotImplementedError(f"the law {self.name} has no contact area")

    @classmethod
    def has_area(cls) -> bool:
        """Whether the law has a contact area, which friction by a shear strength needs."""
        return cls.area is not AsperityLaw.area

    def area_nodes(self, low: ArrayLike, high: ArrayLike, x: Floats, w: Floats) -> tuple[Floats, Floats]:
        """Lay a quadrature rule of the area between two displacements; as `nodes`, with the area for the load."""
        displacement, measure = self._rule_of_fold(low, high, x, w)
        return displacement, measure * self.area(displacement)

    def energy(self, displacement: ArrayLike) -> Floats:
        """Energy that an asperity in contact stores: the integral of its load from detachment on.

        Parameters
        ----------
        displacement : array_like
            ``-detach`` or more.

        Returns
        -------
        ndarray
            Unit of load times unit of length; zero at ``-detach``. The shape of `displacement`.
        """
        high = np.asarray(displacement, dtype=np.float64)
        return np.asarray(self.nodes(np.full(high.shape, -self.detach), high, _X, _W)[1].sum(axis=-1))

    @property
    def loss(self) -> float:
        """Energy that an asperity loses when it joins, if what it stores counts from detachment: all of a cycle."""
        return 0.0 - float(self.energy(-self.join))  # a law that loses nothing says 0.0, not -0.0

    @property
    def detachment_energy(self) -> float:
        """Energy stored just before detachment, counted from free surfaces, which is lost there.

        It is the integral of the load along the unstable branch, from free surfaces to detachment; joining loses so
        much less. By default 0: a law without such a branch.
        """
        return 0.0
