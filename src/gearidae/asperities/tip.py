"""One asperity tip of a rough surface: its elastic constants, its adhesion, and the suitable contact law.

References
----------
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 7-8,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Final, Literal, Protocol

INTERACTION_RANGE: Final = 0.165e-9
"""Range of adhesive forces between silicon surfaces [m], for a surface without an ``interaction_range``."""


class Surface(Protocol):
    """Properties of one of two like rough surfaces that the contact laws use (SI units)."""

    @property
    def youngs_modulus(self) -> float:
        """Young's modulus of either body [Pa]."""

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio of either body [1]."""

    @property
    def energy(self) -> float:
        """Surface energy of either body [J/m^2]; the work of adhesion is twice this."""

    @property
    def asperity_density(self) -> float:
        """Asperities per area [1/m^2]."""

    @property
    def asperity_radius(self) -> float:
        """Radius of the asperities' tips [m]."""

    @property
    def roughness(self) -> float:
        """Standard deviation of the asperities' heights [m]."""


@dataclass(frozen=True, slots=True)
class Asperity:
    """One adhering asperity tip against a plane.

    Attributes
    ----------
    modulus : float
        Contact modulus E* [Pa].
    radius : float
        Tip radius beta [m].
    work_of_adhesion : float
        Energy to separate a unit area [J/m^2].
    pull_off : float
        JKR pull-off load, ``1.5 pi beta dgamma`` [N].
    stretch_limit : float
        Stretch at which a JKR asperity detaches, ``(9 beta P_c / (4 E*))**(2/3) / (3 beta)`` [m]: the length by which
        adhesion deforms a tip, under any law.
    interaction_range : float, optional
        Range eps of the adhesive forces, the equilibrium spacing of two atoms [m]; for laws that have one.
    surface : Surface, optional
        Surface that it belongs to, with all of its keys, for laws with keys of their own; None of a tip without one.
    """

    modulus: float
    radius: float
    work_of_adhesion: float
    pull_off: float
    stretch_limit: float
    interaction_range: float = INTERACTION_RANGE
    surface: Any = field(default=None, compare=False, repr=False)

    @property
    def hertz_factor(self) -> float:
        """Hertz load over compression to the power 1.5, ``4/3 E* sqrt(beta)`` [N/m^1.5]."""
        return 4.0 / 3.0 * self.modulus * math.sqrt(self.radius)


def contact_modulus(youngs_modulus: float, poisson_ratio: float) -> float:
    """Contact modulus E* of like on like [Pa], ``1/E* = 2 (1 - nu^2) / E``.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus [Pa].
    poisson_ratio : float
        Poisson's ratio [1].

    Returns
    -------
    float
        E* [Pa].
    """
    return youngs_modulus / (2.0 * (1.0 - poisson_ratio**2))


def asperity_of(surface: Surface, radius: float | None = None) -> Asperity:
    """Return the asperity of the contact between two such surfaces.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and tip radius (SI), and an ``interaction_range`` if it has one.
    radius : float, optional
        Of this tip [m], in place of the surface's.

    Returns
    -------
    Asperity
        Pull-off load and stretch limit are zero if the surface energy is.
    """
    modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
    adhesion = 2.0 * surface.energy
    reach = getattr(surface, "interaction_range", INTERACTION_RANGE)
    tip = make_tip(modulus, surface.asperity_radius if radius is None else radius, adhesion, reach)
    return replace(tip, surface=surface)


def make_tip(
    modulus: float, radius: float, adhesion: float, interaction_range: float = INTERACTION_RANGE
) -> Asperity:
    """Return a tip with its pull-off load and its stretch limit.

    Parameters
    ----------
    modulus : float
        Contact modulus E* [Pa].
    radius : float
        Tip radius [m].
    adhesion : float
        Work of adhesion [J/m^2].
    interaction_range : float, optional
        Range eps of the adhesive forces [m].
    """
    pull_off = 1.5 * math.pi * radius * adhesion
    stretch_limit = (9.0 * radius * pull_off / (4.0 * modulus)) ** (2.0 / 3.0) / (3.0 * radius)
    return Asperity(modulus, radius, adhesion, pull_off, stretch_limit, interaction_range)


def tabor_parameter(surface: Surface, eps: float = 0.165e-9) -> float:
    """Tabor's parameter: elastic deflection at pull-off over the reach of the adhesive forces.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and tip radius (SI).
    eps : float, optional
        Equilibrium spacing of the two solids' atoms [m], 0.165 nm to 0.2 nm.

    Returns
    -------
    float
        ``(beta dgamma^2 / (E*^2 eps^3))**(1/3)`` [1].

    References
    ----------
    D. Tabor, J. Colloid Interface Sci. 58 (1977) 2-13, doi:10.1016/0021-9797(77)90366-6.
    """
    tip = asperity_of(surface)
    return float((tip.radius * (tip.work_of_adhesion / tip.modulus) ** 2 / eps**3) ** (1.0 / 3.0))


def tabor_regime(mu: float) -> Literal["jkr", "transition", "dmt"]:
    """Name the adhesion regime of a Tabor parameter.

    Parameters
    ----------
    mu : float
        Tabor's parameter [1], see `tabor_parameter`.

    Returns
    -------
    {"jkr", "transition", "dmt"}
        JKR from 5 up and DMT up to 0.1, as in Johnson and Greenwood's adhesion map; the transition between. The bounds
        of the map have one digit, and `mu` is rounded to it: JKR begins at 4.5, DMT ends below 0.15.

    References
    ----------
    K. L. Johnson, J. A. Greenwood, J. Colloid Interface Sci. 192 (1997) 326-333, doi:10.1006/jcis.1997.4984.
    """
    if mu >= 4.5:
        return "jkr"
    return "dmt" if mu < 0.15 else "transition"
