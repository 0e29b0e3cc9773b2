r"""One asperity: how it adheres, stretches and lets go (Johnson, Kendall and Roberts).

Scaled by the pull-off load :math:`P_c` and the stretch limit :math:`\delta_c`, every JKR asperity obeys one law.
With s the square root of the scaled contact radius, load and displacement are polynomials,

.. math::

    \frac{\delta}{\delta_c} = 12^{1/3} s^4 - \tfrac43 18^{1/6} s, \qquad
    \frac{P}{P_c} = 2 \left(s^6 - \sqrt2\, s^3\right),

and with :math:`t = s / 18^{-1/6}` simpler still: :math:`\delta/\delta_c = (t^4 - 4t)/3` and
:math:`P/P_c = t^3 (t^3 - 6)/9`. The branch that is stable under given displacement is :math:`t \ge 1`; it ends in a
fold at :math:`\delta = -\delta_c`, where the asperity lets go.

Displacements are positive in compression, loads are positive when they push the bodies apart.

References
----------
K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301-313, doi:10.1098/rspa.1971.0141.
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 7-8,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.errors import SceneError

__all__ = [
    "ADHESION_LOSS",
    "ASPERITY_LAWS",
    "S_FOLD",
    "S_TOUCH",
    "Asperity",
    "AsperityLaw",
    "Surface",
    "asperity_load",
    "asperity_of",
    "contact_modulus",
    "displacement",
    "jkr_load",
    "jkr_root",
    "jkr_slope",
    "load",
    "tabor_parameter",
    "tabor_regime",
]

AsperityLaw: TypeAlias = Literal["jkr", "dmt", "hertz"]
ASPERITY_LAWS: tuple[AsperityLaw, ...] = ("jkr", "dmt", "hertz")

S_FOLD = (1.0 / 18.0) ** (1.0 / 6.0)
"""s at the fold, displacement -1: the end of the stable branch."""
S_TOUCH = (8.0 / 9.0) ** (1.0 / 6.0)
"""s at displacement 0: where an approaching asperity snaps in."""
ADHESION_LOSS = (4.0 / 27.0) * (3.6 * 4.0 ** (1.0 / 3.0) + 0.6)
"""Energy that an asperity loses when it joins, 0.93550, over its pull-off load times its stretch limit.

In closed form: minus the integral of P/P_c over delta/dc from -1 to 0, ``4/45 (1 + 6 * 4^(1/3))``.
"""


class Surface(Protocol):
    """What the contact laws need to know of one of two like rough surfaces (SI units)."""

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
        Stretch at which a JKR asperity lets go, ``(9 beta P_c / (4 E*))**(2/3) / (3 beta)`` [m].
    """

    modulus: float
    radius: float
    work_of_adhesion: float
    pull_off: float
    stretch_limit: float

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


def asperity_of(surface: Surface) -> Asperity:
    """Return the asperity that two surfaces of this kind touch with.

    Parameters
    ----------
    surface : Surface
        Elastic constants, energy and tip radius (SI).

    Returns
    -------
    Asperity
        Pull-off load and stretch limit are zero where the surface energy is.
    """
    modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
    radius = surface.asperity_radius
    adhesion = 2.0 * surface.energy
    pull_off = 1.5 * math.pi * radius * adhesion
    stretch_limit = (9.0 * radius * pull_off / (4.0 * modulus)) ** (2.0 / 3.0) / (3.0 * radius)
    return Asperity(modulus, radius, adhesion, pull_off, stretch_limit)


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
        JKR from 5 up and DMT up to 0.1, as in Johnson and Greenwood's adhesion map; the transition between. The map's
        bounds have one digit, and `mu` is held against them at that: JKR begins at 4.5, DMT ends below 0.15.

    References
    ----------
    K. L. Johnson, J. A. Greenwood, J. Colloid Interface Sci. 192 (1997) 326-333, doi:10.1006/jcis.1997.4984.
    """
    if mu >= 4.5:
        return "jkr"
    return "dmt" if mu < 0.15 else "transition"


def displacement(s: ArrayLike) -> NDArray[np.float64]:
    """Scaled displacement ``delta/dc`` at the root s of the scaled contact radius.

    Parameters
    ----------
    s : array_like
        Square root of the scaled contact radius; stable from `S_FOLD` up.

    Returns
    -------
    ndarray
        ``12^(1/3) s^4 - (4/3) 18^(1/6) s``, the shape of `s`.
    """
    t = np.asarray(s, dtype=np.float64) / S_FOLD
    return np.asarray(t * (t**3 - 4.0) / 3.0)


def load(s: ArrayLike) -> NDArray[np.float64]:
    """Scaled load ``P/P_c`` at the root s of the scaled contact radius.

    Parameters
    ----------
    s : array_like
        Square root of the scaled contact radius; stable from `S_FOLD` up.

    Returns
    -------
    ndarray
        ``2 (s^6 - sqrt(2) s^3)``, the shape of `s`.
    """
    cube = (np.asarray(s, dtype=np.float64) / S_FOLD) ** 3
    return np.asarray(cube * (cube - 6.0) / 9.0)


def _excess(displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return t - 1 on the stable branch; displacements below -1 count as -1.

    ``(t^4 - 4t)/3 = -1 + e`` reads ``u sqrt(u^2 + 4u + 6) = sqrt(3e)`` in u = t - 1: increasing, convex and regular at
    the fold. Newton's method started to the right of the root therefore falls onto it without ever overshooting, and
    e = 1 + displacement loses no digit near the fold.
    """
    q = np.sqrt(3.0 * np.maximum(1.0 + displacement, 0.0))
    u = np.minimum(q / math.sqrt(6.0), np.sqrt(q))
    finite = np.isfinite(q)
    q, root = np.where(finite, q, 0.0), np.where(finite, u, 0.0)
    for _ in range(12):  # 6 suffice from this start; the test on the step ends it
        radicand = root * (root + 4.0) + 6.0
        step = (root * radicand - q * np.sqrt(radicand)) / (2.0 * (root * (root + 3.0) + 3.0))
        root -= step
        if np.all(np.abs(step) <= 4e-16 * root):
            break
    return np.where(finite, root, u)


def jkr_root(displacement: ArrayLike) -> NDArray[np.float64]:
    """Root s of the scaled contact radius at a scaled displacement, stable branch: the inverse of `displacement`.

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, -1 or more; less counts as -1.

    Returns
    -------
    ndarray
        s, `S_FOLD` or more, the shape of `displacement`.
    """
    return (1.0 + _excess(np.asarray(displacement, dtype=np.float64))) * S_FOLD


def jkr_load(displacement: ArrayLike) -> NDArray[np.float64]:
    """Load of a JKR asperity in contact, scaled by its pull-off load (Teodorescu et al. 2009, Eqs. 7-8).

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, displacement over the stretch limit; positive in compression.

    Returns
    -------
    ndarray
        ``P/P_c`` on the stable branch, the shape of `displacement`: -5/9 at the fold -1, never below the pull-off -1,
        -8/9 at 0, towards Hertz's ``displacement^1.5 / sqrt(3)`` in deep compression (``P_c`` is sqrt(3) times the
        Hertz load at a compression of dc). Zero below the fold, where there is no contact; NaN stays NaN.
    """
    d = np.asarray(displacement, dtype=np.float64)
    with np.errstate(over="ignore"):
        cube = (1.0 + _excess(d)) ** 3
        return np.where(d < -1.0, 0.0, cube * (cube - 6.0) / 9.0)


def jkr_slope(displacement: ArrayLike) -> NDArray[np.float64]:
    """Derivative of `jkr_load`: scaled stiffness ``d(P/P_c)/d(delta/dc)`` on the stable branch.

    Parameters
    ----------
    displacement : array_like
        ``delta/dc``, displacement over the stretch limit.

    Returns
    -------
    ndarray
        The shape of `displacement`; -inf at the fold -1 itself, zero below it.
    """
    d = np.asarray(displacement, dtype=np.float64)
    u = _excess(d)  # with t = 1 + u the slope is t^2 (t^3 - 3) / (2 (t^3 - 1))
    with np.errstate(divide="ignore", over="ignore"):
        slope = 0.5 * (1.0 + u) ** 2 * (1.0 - 2.0 / (u * (u * (u + 3.0) + 3.0)))
    return np.where(d < -1.0, 0.0, slope)


def asperity_load(
    displacement: ArrayLike, asperity: Asperity, law: AsperityLaw = "jkr"
) -> NDArray[np.float64]:
    """Load of one asperity in contact, in newtons.

    Parameters
    ----------
    displacement : array_like
        Displacement delta [m], positive in compression.
    asperity : Asperity
        The asperity.
    law : {"jkr", "dmt", "hertz"}, optional
        JKR: `jkr_load` with stretch down to ``-dc``. DMT: Hertz minus ``2 pi beta dgamma`` while delta >= 0, no
        stretch. Hertz: ``4/3 E* sqrt(beta) delta^1.5`` while delta >= 0.

    Returns
    -------
    ndarray
        Load [N], positive pushes apart, the shape of `displacement`; zero where the asperity is out of reach.

    Raises
    ------
    SceneError
        If `law` is none of the three.

    References
    ----------
    B. V. Derjaguin, V. M. Muller, Yu. P. Toporov, J. Colloid Interface Sci. 53 (1975) 314-326,
    doi:10.1016/0021-9797(75)90018-1.
    """
    delta = np.asarray(displacement, dtype=np.float64)
    if law == "jkr" and asperity.stretch_limit > 0.0:
        return asperity.pull_off * jkr_load(delta / asperity.stretch_limit)
    if law not in ASPERITY_LAWS:
        raise SceneError("contact.asperity", law, "must be one of " + ", ".join(ASPERITY_LAWS))
    hertz = asperity.hertz_factor * np.maximum(delta, 0.0) ** 1.5
    if law == "dmt":
        hertz -= np.where(delta >= 0.0, 2.0 * math.pi * asperity.radius * asperity.work_of_adhesion, 0.0)
    return np.asarray(hertz)
