r"""What the surroundings do to a contact: heat shakes it, and air resists it.

None of this is in the model. The numbers say whether it may be left out.

References
----------
T. Veijola, H. Kuisma, J. Lahdenpera, T. Ryhanen, Sensors and Actuators A 48 (1995) 239-248,
doi:10.1016/0924-4247(95)00995-7: effective viscosity of a rarefied film, ``mu / (1 + 9.638 Kn^1.159)``.
The squeezed film between a cylinder and a plane follows from Reynolds' equation with the film ``h + x^2/(2R)``.
"""

from __future__ import annotations

import math
from typing import Final

BOLTZMANN: Final = 1.380649e-23
"""Boltzmann's constant [J/K], exact in the SI."""
ROOM_TEMPERATURE: Final = 300.0
"""Temperature that estimates are made for [K]."""
AIR_VISCOSITY: Final = 1.85e-5
"""Viscosity of air at 300 K [Pa s]."""
AIR_MEAN_FREE_PATH: Final = 68e-9
"""Mean free path in air at 300 K and one atmosphere [m]."""


def thermal_amplitude(stiffness: float, temperature: float = ROOM_TEMPERATURE) -> float:
    """Root-mean-square motion that heat gives a spring.

    Parameters
    ----------
    stiffness : float
        Stiffness k [N/m].
    temperature : float, optional
        Temperature T [K].

    Returns
    -------
    float
        ``sqrt(kB T / k)`` [m] (equipartition); infinite where nothing holds the spring.
    """
    return math.sqrt(BOLTZMANN * temperature / stiffness) if stiffness > 0.0 else math.inf


def film_damping(gap: float, radius: float, width: float) -> float:
    """Damping coefficient of the film of air between two teeth that approach each other.

    Parameters
    ----------
    gap : float
        Smallest thickness h of the film [m], positive.
    radius : float
        Reduced radius R of the two profiles [m].
    width : float
        Face width L [m].

    Returns
    -------
    float
        ``3 sqrt(2) pi mu L (R/h)^1.5 / (1 + 9.638 Kn^1.159)`` [N s/m] with ``Kn`` the mean free path over h.
    """
    knudsen = AIR_MEAN_FREE_PATH / gap
    viscosity = AIR_VISCOSITY / (1.0 + 9.638 * knudsen**1.159)
    return 3.0 * math.sqrt(2.0) * math.pi * viscosity * width * (radius / gap) ** 1.5


def disc_drag(radius: float, speed: float, distance: float) -> float:
    """Torque of the air under a disc that turns above a plane.

    Parameters
    ----------
    radius : float
        Radius of the disc [m].
    speed : float
        Angular speed [rad/s].
    distance : float
        Distance d between disc and plane [m].

    Returns
    -------
    float
        ``pi mu R^4 w / (2 d)`` [N m] (Couette flow).
    """
    return math.pi * AIR_VISCOSITY * radius**4 * speed / (2.0 * distance)
